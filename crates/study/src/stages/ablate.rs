//! `ablate`: what each part of the model is worth on drivers that it has not seen.

use super::{
    report::{hashed, write_page},
    validate::LeaveOut,
};
use crate::{
    atomic_write::write_json,
    design::DesignFile,
    error::StudyError,
    judged::Judged,
    mean::mean,
    once::told_once,
    outcome::{Outcome, Watch, threads},
    recordings::{self, Recorded},
    stage::{Files, Stage},
    style_scores::StyleScores,
    tables::{drives::read_drives, surveys::read_scores},
};
use maveric_analysis::{Finding, Part, Question};
use maveric_domain::{Drive, DrivenBy, StyleScore};
use maveric_model::{
    Ablated, AblationSettings, HeldOut, ModelError, TrainSettings, TrainingDrive, VariantResult,
    ablate as compare, variants,
};
use maveric_pages::{ABLATION, PageTexts, cards::ablation};
use maveric_rehearsal::leave_out::people;
use maveric_report::{
    Context, Report,
    figures::ablation::{Ablation, AblationVariant, ablation as figure_of},
    html::Provenance,
    markup,
    tables::Table,
};
use maveric_stats::proportion;
use path_slash::PathExt as _;
use serde::Serialize;
use std::{
    ops::ControlFlow,
    path::{Path, PathBuf},
};

/// Compare embedding sizes, losses, window lengths and baselines on drivers held out in turn
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example: maveric ablate --drives drives/study1 --scores scores.csv --sizes 1,2,5,8 --out ablation"
)]
pub struct Ablate {
    /// Folder of drives
    #[arg(long)]
    pub drives: PathBuf,
    /// Questionnaire scores
    #[arg(long)]
    pub scores: Option<PathBuf>,
    /// Folder to write into: ablation.json and a page
    #[arg(long)]
    pub out: PathBuf,
    /// Embedding sizes beside the default
    #[arg(long, value_delimiter = ',', default_value = "1,2,5,8")]
    pub sizes: Vec<usize>,
    /// Lengths of a window beside the default, in s
    #[arg(long = "windows", value_name = "WINDOWS", value_delimiter = ',', default_value = "2,8")]
    pub windows_s: Vec<f64>,
    /// Parts into which the drivers are split
    #[arg(long, default_value_t = AblationSettings::default().folds)]
    pub folds: usize,
    /// Who is left out in turn, the rest being learned from: one person after the other of a study's own recordings, each drive with the
    /// score of its role
    #[arg(long, value_name = "people", conflicts_with = "folds")]
    pub leave_out: Option<LeaveOut>,
    /// Design of the study whose roles were driven (TOML); study.toml of the current directory when not given
    #[arg(long, value_name = "FILE", requires = "leave_out")]
    pub design: Option<PathBuf>,
    /// Passes over the rows of each training
    #[arg(long, default_value_t = TrainSettings::default().epochs)]
    pub epochs: usize,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads
    #[arg(short, long, default_value_t = crate::outcome::all_cores())]
    pub jobs: usize,
    /// The command that makes the same again, for the page; this one when not given
    #[arg(long, value_name = "TEXT")]
    pub command: Option<String>,
}

type Loss = fn(&HeldOut) -> Option<f64>;

/// What is compared: key of its title, unit, value.
const LOSSES: [(&str, &str, Loss); 3] = [
    ("following_distance", "m", |h| h.following_distance_m),
    ("lane_change", "nats", |h| h.lane_change),
    ("speed", "m/s", |h| h.speed_mps),
];

/// What the texts of the page may ask for.
#[derive(Serialize)]
struct Words<'a> {
    preface: &'a str,
    drives: usize,
    /// Of each loss, the drives in which there is something to predict.
    judged: [usize; 3],
    folds: usize,
    /// Whether each fold is one person.
    people: bool,
    passes: usize,
    /// Share of a drive by which an unseen driver is known.
    known: f64,
}

impl Stage for Ablate {
    const NAME: &'static str = "ablate";
    const FAILURE: &'static str = "could not ablate";
    type Result = Ablated;

    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        let files = Files::default().reads([&self.drives]).reads(&self.scores);
        let design = self.design.as_deref();
        let files = match self.leave_out {
            Some(LeaveOut::People) => files
                .reads_people(root, design, None)
                .reads_style(DesignFile::below(root, design).as_ref()),
            None => files.reads_design(None),
        };
        Ok(files.writes_into(&self.out, &["ablation.json"]))
    }

    fn repeated_by(&mut self, command: &str) {
        self.command.get_or_insert_with(|| command.to_owned());
    }

    /// Holds out each fold of drivers in turn for every variant; writes `ablation.json` and a page with the table and the
    /// figure.
    ///
    /// # Source
    /// Method section 3, "Embedding size"; the paper says that more than three numbers bring nothing.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Ablated>, StudyError> {
        let out = self.out.join("ablation.json");
        let mut warnings = Vec::new();
        let (scored, folds) = match self.leave_out {
            Some(LeaveOut::People) => self.in_roles(&mut warnings)?,
            None => (self.scored()?, self.folds),
        };
        let given: Vec<TrainingDrive<'_>> =
            scored.iter().map(|(drive, adb)| TrainingDrive { drive, adb: *adb }).collect();
        // Unseen drivers judge; nobody is kept back of those learned from.
        let base = TrainSettings {
            epochs: self.epochs,
            validation_fraction: 0.0,
            ..TrainSettings::default()
        };
        let settings = AblationSettings { folds, ..AblationSettings::default() };
        let variants = variants(&base, &self.sizes, &self.windows_s);
        let mut observe = |done, total| match watch.step(done, total, "trainings") {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        };
        let pool = threads(self.jobs)?;
        let ablated =
            pool.install(|| compare(&given, &variants, &settings, self.seed, &mut observe));
        let ablated = match ablated {
            Err(ModelError::Cancelled { .. }) => return Err(StudyError::Interrupted),
            other => other?,
        };
        let synthetic = scored.iter().any(|(d, _)| d.meta().driven_by == DrivenBy::Synthetic);
        let context = Context::of(synthetic, self.seed);
        let words = Words {
            preface: context.preface(),
            drives: ablated.drives.len(),
            judged: LOSSES.map(|(_, _, loss)| {
                let losses = values(&ablated.variants[0], loss);
                losses.iter().flatten().count()
            }),
            folds: ablated.settings.folds,
            people: self.leave_out.is_some(),
            passes: self.epochs,
            known: ablated.settings.known_fraction,
        };
        let texts = PageTexts::new(ABLATION, &words)?;
        let finding = parts(&ablated, &texts)?;
        let judged = Judged { result: &ablated, findings: finding.as_slice() };
        write_json(&out, &judged)?;
        let table = texts.table("ablation", rows(&ablated))?;
        let text = table.to_markdown();
        let page = write_page(
            &self.out,
            &page(&ablated, finding.as_ref(), self, (&texts, table), &context)?,
        )?;
        let short = ablated.drives.iter().zip(&ablated.variants[0].of_each);
        let short = short.filter(|(_, judged)| judged.is_none());
        let why = texts.text("short")?;
        warnings
            .extend(told_once("drive", short.map(|(drive, _)| (drive.to_string(), why.clone()))));
        let mut summary: Vec<String> = text.lines().map(str::to_owned).collect();
        summary.push(format!(
            "{} variants on {} drives, {} folds: {}",
            ablated.variants.len(),
            ablated.drives.len(),
            folds,
            page.to_slash_lossy()
        ));
        Ok(Outcome::new(ablated, summary, warnings))
    }
}

/// A drive with the score that teaches, where it has one.
type Scored = (Drive, Option<StyleScore>);

impl Ablate {
    /// The drives of a folder, each with what its driver answered.
    fn scored(&self) -> Result<Vec<Scored>, StudyError> {
        let scores = self.scores.as_deref().map(read_scores).transpose()?;
        let scores = StyleScores::of(scores.unwrap_or_default(), None)?;
        let baseline = DesignFile::find(None)?.design.baseline_id();
        let scored = |drive: Drive| {
            let score = scores.of_drive(&drive, None, baseline)?;
            Ok((drive, score))
        };
        read_drives(&self.drives)?.into_iter().map(scored).collect()
    }

    /// The drives in roles of a design, each with the score of its role, and how many people drove them.
    fn in_roles(&self, warnings: &mut Vec<String>) -> Result<(Vec<Scored>, usize), StudyError> {
        let study = DesignFile::find(self.design.as_deref())?;
        let files = (&*self.drives, self.scores.as_deref());
        let driven = recordings::read(&study, files, warnings)?;
        let people = people(&driven.drove()).len();
        recordings::enough(people).map_err(|why| {
            StudyError::file(&self.drives, why)
                .with_help("record more people in the roles of the design")
        })?;
        let scored = |recorded: Recorded| {
            let points = recorded.drove.points;
            let score = points.map(|points| driven.range.score(points));
            let score = score.transpose()?;
            Ok((recorded.drive, score))
        };
        let scored: Result<_, StudyError> = driven.rows.into_iter().map(scored).collect();
        Ok((scored?, people))
    }
}

/// A variant's value on every drive.
fn values(variant: &VariantResult, loss: Loss) -> Vec<Option<f64>> {
    variant.of_each.iter().map(|h| h.as_ref().and_then(loss)).collect()
}

/// How far a variant lies above the reference, on the drives of both.
fn differences(variant: &VariantResult, reference: &VariantResult, loss: Loss) -> Vec<f64> {
    let pairs = values(variant, loss).into_iter().zip(values(reference, loss));
    pairs.filter_map(|(v, r)| Some(v? - r?)).collect()
}

/// A variant with each loss: its mean, and on how many of the drives of both it is lower than the reference.
#[derive(Serialize)]
struct Row<'a> {
    name: &'a str,
    losses: [LossRow; 3],
}

#[derive(Serialize)]
struct LossRow {
    mean: Option<f64>,
    better: Option<usize>,
    both: Option<usize>,
}

fn rows(ablated: &Ablated) -> impl Iterator<Item = Row<'_>> {
    let reference = &ablated.variants[0];
    let row = |variant: &VariantResult, loss: Loss| {
        let known: Vec<f64> = values(variant, loss).into_iter().flatten().collect();
        let both = differences(variant, reference, loss);
        let compared = variant.name != reference.name && !both.is_empty();
        LossRow {
            mean: mean(&known),
            better: compared.then(|| both.iter().filter(|d| **d < 0.0).count()),
            both: compared.then_some(both.len()),
        }
    };
    ablated.variants.iter().map(move |variant| Row {
        name: &variant.name,
        losses: LOSSES.map(|(_, _, loss)| row(variant, loss)),
    })
}

fn page(
    ablated: &Ablated,
    finding: Option<&Finding>,
    options: &Ablate,
    (texts, table): (&PageTexts, Table),
    context: &Context,
) -> Result<Report, StudyError> {
    let titles = LOSSES.map(|(key, unit, _)| Ok(format!("{} ({unit})", texts.text(key)?)));
    let figure = Ablation {
        losses: titles.into_iter().collect::<Result<_, StudyError>>()?,
        variants: ablated
            .variants
            .iter()
            .map(|v| AblationVariant {
                name: v.name.clone(),
                losses: LOSSES.iter().map(|(_, _, loss)| values(v, *loss)).collect(),
            })
            .collect(),
        folds: ablated.settings.folds,
    };
    let new = texts.page(context, (options.seed, options.command.as_deref()))?;
    let figures = vec![figure_of(&figure, context)?];
    Ok(Report {
        cards: finding
            .map(|finding| ablation::parts(finding, &ablated.variants[0].name))
            .into_iter()
            .collect::<Result<_, _>>()?,
        sections: vec![texts.section("ablation", figures, vec![table])?],
        provenance: Provenance {
            inputs: hashed(options.scores.iter().cloned())?,
            ..new.provenance
        },
        ..new
    })
}

/// Is the whole model better than it is without each of its parts? For every variant and loss it has to be on more than half of the unseen
/// drives; ties count for neither.
fn parts(ablated: &Ablated, texts: &PageTexts) -> Result<Option<Finding>, StudyError> {
    let Some((reference, others)) = ablated.variants.split_first() else {
        return Ok(None);
    };
    let mut parts = Vec::new();
    for variant in others {
        for (title, _, loss) in LOSSES {
            let mut differences = differences(variant, reference, loss);
            differences.retain(|d| *d != 0.0);
            let worse = differences.iter().filter(|d| **d > 0.0).count();
            let share = proportion(worse, differences.len(), 0.95).ok();
            if let Some(share) = share {
                let title = texts.text(title)?;
                let label = format!("{}: {}", variant.name, markup::plain(&title));
                let ends = (0.5, f64::INFINITY);
                parts.push(Part::share(label, differences.len(), Some(&share), ends));
            }
        }
    }
    Ok(Some(Finding::every(Question::Parts, parts)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recordings::testing::{drives, study};

    fn options(folder: &Path) -> Ablate {
        Ablate {
            drives: folder.join("drives"),
            scores: None,
            out: folder.join("out"),
            sizes: Vec::new(),
            windows_s: Vec::new(),
            folds: 5,
            leave_out: Some(LeaveOut::People),
            design: Some(folder.join("study.toml")),
            epochs: 1,
            seed: 1,
            jobs: 2,
            command: None,
        }
    }

    fn run(options: &Ablate) -> Result<Outcome<Ablated>, StudyError> {
        options.run(Watch::unwatched())
    }

    #[test]
    fn each_person_of_a_study_is_left_out_in_turn_and_taught_with_the_scores_of_the_roles() {
        // The fourth drives in no role, the third has a drive that is too short to be judged.
        let mut kept: Vec<Drive> = drives()[..9].to_vec();
        kept[8] = kept[8].slice(0, 20).unwrap();
        let folder = study(&kept);
        let design = folder.path().join("study.toml");
        let text = std::fs::read_to_string(&design).unwrap();
        let excluded = "[exclude.drives]\nP0-sporty = \"the rig failed\"\n";
        std::fs::write(&design, format!("{text}{excluded}")).unwrap();
        let options = options(folder.path());
        let outcome = run(&options).unwrap();
        let found = outcome.value;
        assert_eq!((found.settings.folds, found.drives.len()), (3, 8));
        let warned = outcome.warnings.join("\n");
        assert!(warned.contains("P0-sporty: left out, the rig failed"), "{warned}");
        assert!(warned.contains("drive P2-calm-again: too short"), "{warned}");
        let by = |name: &str| found.variants.iter().find(|v| v.name == name).unwrap();
        let whole = &found.variants[0];
        assert!(whole.of_each.iter().filter(|h| h.is_some()).count() == 7);
        // Without S nothing is learned of a score, so the scores of the roles did teach.
        assert_ne!(by("without S (no L4)").of_each, whole.of_each);
        let read = |name: &str| std::fs::read_to_string(options.out.join(name)).unwrap();
        let page = read("index.html");
        assert!(page.contains("Each of 3 people left out in turn"));
        let counted = LOSSES.map(|(_, _, loss)| {
            whole.of_each.iter().flatten().filter_map(loss).count().to_string()
        });
        let counted = format!("{}, {} and {} of 8 drives", counted[0], counted[1], counted[2]);
        assert!(page.contains(&counted), "{counted}");
        assert!(read("figures/ablation.svg").contains("own time gap"));
        assert!(!page.contains("NaN") && !read("ablation.json").contains("NaN"));
    }

    #[test]
    fn too_few_people_and_a_design_whose_roles_nobody_drove_are_refused_by_name() {
        let folder = study(&drives()[..6]);
        let error = run(&options(folder.path())).unwrap_err();
        assert!(error.to_string().contains("2 people drove"), "{error}");
        assert!(error.suggestion().unwrap().contains("more people"));
        let design = folder.path().join("study.toml");
        let text = "[study]\ntitle = \"x\"\n[style]\nscore = \"adb.total\"\nrange = [11, 55]\n[[role]]\nid = \"asleep\"\nscore = 15\n";
        std::fs::write(&design, text).unwrap();
        let error = run(&options(folder.path())).unwrap_err();
        assert!(error.to_string().contains("holds no drive in a role"), "{error}");
    }
}
