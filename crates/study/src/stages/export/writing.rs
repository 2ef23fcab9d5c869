//! Everything of an export in its place.

use super::{
    declared::{self, Declared},
    dictionary, drives,
    left_out::LeftOut,
    material::Material,
    options::{ExportOptions, Exported},
    outcomes, own, people, pipeline,
    place::Place,
    pseudonym::{Ids, Pseudonyms},
    readme::{self, Holds},
    ro_crate::{self, About, METADATA, PipelineRun},
    sources::Sources,
    surveys::{self, Answered},
};
use crate::{
    atomic_write::{atomic_write_bytes, write_json},
    design::DesignFile,
    error::StudyError,
    forget::refuse_learned_from_gone,
    outcome::{Outcome, Watch},
    run_folder::read_scales,
};
use path_slash::PathExt as _;
use std::path::Path;

/// Writes a study under pseudonyms.
///
/// - Participant ids become keyed hashes: with the key the same person has the same pseudonym in every export; without it
///   neither direction can be computed. No table of who is who is written, and rows stand in the order of pseudonyms.
/// - Of a log only the recording is kept: who was where on the road, from time 0 and position 0 on. Dates, positions on a map, other
///   channels and file names are gone.
/// - Whoever the design leaves out by name, was forgotten or has no row in the table of people is in no file of it, and is counted.
/// - The folder is new, or holds nothing but an earlier export, which goes: who has withdrawn since is in none of its files. What
///   was handed out before is not undone, which is said.
/// - `README.md` says what it is; `study.toml`, `scales/`, the codebook and `factors.csv` what was asked and compared;
///   `outcomes_long.csv` and `outcomes_wide.csv` have what was analysed; `dictionary.csv` says what each column means.
/// - `ro-crate-metadata.json` says what it is as a Workflow Run RO-Crate: files with hashes, licence, the pipeline and its stages; no
///   path that names somebody.
/// - Of `participants.csv` only who is learned from and who is tested, population, age in bands of ten years, gender, professional,
///   order, and the factors and covariates of the design. Free text and any other column is left out.
/// - Answers are given away as they are; of those that are numbers (an age, a year) the items are named in a warning and in `README.md`.
///
/// What this cannot do: a driving style, or a rare combination of age, gender and answers, may still single somebody out for who
/// knows them. Groups of fewer than three alike are warned about.
///
/// # Errors
/// [`StudyError`] if a file cannot be read, the key is too short or lies in `out`, `out` holds something else, nothing was
/// asked for, or a text that would be given away names somebody.
pub fn export(
    options: &ExportOptions,
    about: &About,
    watch: Watch<'_>,
) -> Result<Outcome<Exported>, StudyError> {
    let study = DesignFile::find(options.design.as_deref())?;
    for model in about.run.iter().flat_map(PipelineRun::models) {
        refuse_learned_from_gone(&study, &study.resolve(Path::new(model)))?;
    }
    let local_study = DesignFile::here(options.design.as_deref())?;
    let place = Place::new(&options.out)?;
    let out = &place.fresh();
    let sources = Sources::find(options, local_study.as_ref())?;
    let mut material = Material::read(options, &sources, &study, watch)?;
    let mut names = Pseudonyms::read(&options.key, &options.out)?;
    let left_out = match &local_study {
        Some(study) => LeftOut::take_from(study, sources.participants.as_deref(), &mut material)?,
        None => match material.unread.pop() {
            Some((_, error)) => return Err(error),
            None => LeftOut::default(),
        },
    };
    names.add_all(material.ids())?;
    if names.len() == 0 {
        let problem = "nobody is left to export";
        return Err(StudyError::not_possible(problem).with_help(left_out.lines().join("; ")));
    }
    let ids = Ids::new(&names, &left_out.names);
    let mut warnings = left_out.doubts.clone();
    warnings.append(&mut material.doubts);
    let declared = local_study.as_ref().map(|study| Declared::new(study, &ids));
    let declared = declared.transpose()?;
    let design = declared.as_ref().map_or(&study.design, |d| &d.design);
    if let Some(data) = &mut material.outcomes {
        data.design = design.clone();
    }
    let baseline = design.baseline_id().filter(|id| material.has(*id));
    drives::write(out, &material.drives, &names, options, watch)?;
    let people = &material.people;
    let answered = material.answers.iter().map(|a| a.answer);
    let answered = answered.chain(material.probes.iter().map(|p| p.answer));
    let answers = answered.flatten().count();
    warnings.extend(people::write(out, people, &names, design)?);
    let scales = study.resolve(&study.design.files().scales);
    let scales = scales.is_dir().then(|| read_scales(&scales));
    let scales = scales.transpose()?.unwrap_or_default();
    let answered = Answered::new(&scales, &material.answers, &material.probes);
    warnings.extend(answered.warning());
    let responses = (&mut material.answers[..], &mut material.probes[..]);
    surveys::write(out, responses, people, &names)?;
    own::write(out, &material.own, &names)?;
    let observed = outcomes::write(out, material.outcomes.as_ref(), people, &names)?;
    warnings.extend(material.collected.write(out, &names, &left_out.names)?);
    if let (Some(study), Some(declared)) = (&local_study, &declared) {
        declared::write(out, study, declared, &scales, (&ids, people))?;
        warnings.extend(declared.doubt.clone());
    }
    let mut about = about.clone();
    let mut runs_here = false;
    if let Some(run) = about.run.take() {
        about.run = ro_crate::cleared(run, &ids, &sources.logs, &mut warnings);
        if let Some(run) = &about.run {
            let given = local_study.as_ref().map(|study| (study, design));
            runs_here = pipeline::follows_from(given, run);
            let text = pipeline::text(run, given, out);
            let text = text.map_err(|e| StudyError::not_possible(format!("the pipeline: {e}")))?;
            atomic_write_bytes(&out.join(ro_crate::PIPELINE), text.as_bytes())?;
        }
    }
    warnings.extend(place.gone(|name| names.has(name))?);
    dictionary::write(out, &observed, design)?;
    let value = Exported { participants: names.len(), drives: material.drives.len(), answers };
    let flow = material.outcomes.as_ref().map(|data| &data.flow);
    let holds = Holds { counts: &value, flow, baseline, runs_here };
    readme::write(out, design, &about, &holds, &observed, &answered, &left_out)?;
    let metadata = ro_crate::metadata(design, &about, &place.given()?);
    write_json(&out.join(METADATA), &metadata)?;
    place.take()?;
    let summary = summary(&value, options, &left_out);
    Ok(Outcome::new(value, summary, warnings))
}

/// What was written where, and who is not in it.
fn summary(exported: &Exported, options: &ExportOptions, left_out: &LeftOut) -> Vec<String> {
    let mut summary = vec![
        format!(
            "{} participants under pseudonyms, {} drives, {} answers: {}",
            exported.participants,
            exported.drives,
            exported.answers,
            options.out.to_slash_lossy()
        ),
        format!(
            "keep {} apart: with it the pseudonyms can be made again",
            options.key.to_slash_lossy()
        ),
    ];
    summary.extend(left_out.lines());
    summary
}
