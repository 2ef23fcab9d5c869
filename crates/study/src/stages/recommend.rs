//! `recommend`: how far to turn the dial for this person, how sure that is, and why.

use crate::{
    atomic_write::write_json,
    beyond::{self, beyond_in_words},
    design::DesignFile,
    error::StudyError,
    once::told_once,
    outcome::{Outcome, Watch},
    run_folder::{read_study, study_files},
    stage::{Files, Stage},
    tables::{collected::SEAT, dial::read_turns},
};
use maveric_analysis::{Learned, Preferred, Recommendation, StudyData};
use maveric_domain::ParticipantId;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Say how far to turn the dial for a person: the recommended shift, how sure it is, and why
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example: maveric recommend study_data/generated/paper --participant S2P07")]
pub struct Recommend {
    /// Design of the study (TOML); study.toml of the current directory when not given, else the paper's
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Folder of results, as the pipeline leaves it
    pub results: PathBuf,
    /// Whom to recommend to; everybody when not given
    #[arg(long)]
    pub participant: Option<String>,
    /// Recommendations to write (JSON)
    #[arg(long)]
    pub out: Option<PathBuf>,
}

#[derive(Debug, Clone, Serialize)]
pub struct Recommended {
    pub participants: usize,
    /// A recommendation each; every person's model was learned from the others.
    pub recommendations: Vec<Recommendation>,
}

impl Stage for Recommend {
    const NAME: &'static str = "recommend";
    const FAILURE: &'static str = "could not recommend a shift";
    type Result = Recommended;

    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        let study = DesignFile::below_or_paper(root, self.design.as_deref())?;
        let files = Files::default().reads_design(self.design.as_deref());
        Ok(study_files(files, root, &self.results, &study, None)
            .reads_if_there([study.resolve(Path::new(SEAT))])
            .writes(&self.out))
    }

    /// Recommends a setting of the dial to the people of a study, each by a model learned from all others and by their own ratings, and by where they
    /// left the dial in a ride in the seat.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Recommended>, StudyError> {
        let study = DesignFile::find(self.design.as_deref())?;
        let turns = read_turns(&study.resolve(Path::new(SEAT)))?;
        let data = read_study(&self.results, &study, None)?.with_turns(&turns);
        let wanted: Vec<&ParticipantId> = match &self.participant {
            None => data.participants.iter().collect(),
            Some(name) => {
                let person = data.participants.iter().find(|p| p.as_str() == name);
                vec![person.ok_or_else(|| unknown(name, &data))?]
            }
        };
        let mut recommendations = Vec::new();
        for (done, p) in wanted.iter().enumerate() {
            watch.step(done, wanted.len(), "people")?;
            let others: Vec<ParticipantId> =
                data.participants.iter().filter(|o| o != p).cloned().collect();
            let learned = Learned::from(&data, &others)?;
            recommendations.push(learned.recommendation(&data, p));
        }
        let value = Recommended { participants: data.participants.len(), recommendations };
        if let Some(out) = &self.out {
            write_json(out, &value)?;
        }
        let mut summary: Vec<String> = value
            .recommendations
            .iter()
            .flat_map(|r| lines(r, Points::of(&data), self.participant.is_some()))
            .collect();
        if data.is_synthetic() {
            summary.push("synthetic participants".to_owned());
        }
        let warnings = warnings(&value.recommendations);
        Ok(Outcome::new(value, summary, warnings))
    }
}

/// Whoever gets no recommendation, or one from a style that the model has met nobody with.
fn warnings(recommendations: &[Recommendation]) -> Vec<String> {
    let has_top = |r: &&Recommendation, preferred: bool| r.preferred.is_some() == preferred;
    let strangers = |preferred: bool| {
        let these = recommendations.iter().filter(move |r| has_top(r, preferred));
        these.filter_map(|r| Some((r.participant.to_string(), r.beyond.as_ref()?)))
    };
    let no_top =
        recommendations.iter().filter(|r| has_top(r, false) && r.beyond.is_none()).map(|r| {
            let why = "the ratings have no highest point, so nothing is recommended";
            (r.participant.to_string(), why.to_owned())
        });
    let mut warnings = told_once("participant", no_top);
    warnings.extend(beyond::named("participant", strangers(false), ", so nothing is recommended"));
    let turned = "; the dial is turned all the same, as the design asks";
    warnings.extend(beyond::named("participant", strangers(true), turned));
    warnings
}

fn unknown(name: &str, data: &StudyData) -> StudyError {
    let known: Vec<&str> = data.participants.iter().map(ParticipantId::as_str).collect();
    let problem = format!("no participant `{name}` with an own drive in this study");
    let help = format!("participants are {}", known.join(", "));
    StudyError::not_possible(problem).with_help(help)
}

/// Reasons that a line names.
const SHOWN: usize = 5;

#[derive(Debug, Clone, Copy)]
struct Points {
    unit: &'static str,
    /// What counts as near: 5 ADB points, or as large a share of another scale.
    near: f64,
    further: usize,
}

impl Points {
    fn of(data: &StudyData) -> Self {
        let style = data.design.style();
        let is_adb = style.is_none_or(|style| style.score.to_string() == "adb.total");
        Self {
            unit: if is_adb { "ADB points" } else { "points" },
            near: (5.0 * data.adb_point() * 100.0).round() / 100.0,
            further: data.style_scale().decimals(),
        }
    }
}

fn lines(r: &Recommendation, said: Points, at_length: bool) -> Vec<String> {
    let Points { unit, near, further } = said;
    let fine = 1 + further;
    let line = |p: &Preferred| {
        format!(
            "{:+.fine$} {unit} (95% {:+.fine$} to {:+.fine$}; within {near} points with probability {:.2})",
            p.points, p.low, p.high, p.within_5
        )
    };
    let none = || match &r.beyond {
        Some(why) => format!("no recommendation: {}", beyond_in_words(why)),
        None => "no recommendation: the ratings have no highest point".to_owned(),
    };
    let mut lines =
        vec![format!("{}: {}", r.participant, r.preferred.as_ref().map_or_else(none, line))];
    if let Some(s) = &r.on_the_scale {
        lines.push(format!(
            "  on the scale: {:.further$} points (95% {:.further$} to {:.further$}), the own style being {:.further$} ± {:.further$}",
            s.at, s.low, s.high, s.own, s.own_sd
        ));
    }
    if at_length {
        lines
            .push(format!("  before riding: {}", r.before_riding.as_ref().map_or_else(none, line)));
        for reason in r.reasons.iter().take(SHOWN) {
            let z = reason.standardised.map_or_else(String::new, |z| format!(" ({z:+.1} SD)"));
            lines.push(format!("  {:+.fine$} points: {}{z}", reason.points, reason.because));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_the_adb_are_named_and_those_of_a_narrow_scale_have_a_further_decimal() {
        let recommended = Recommendation {
            participant: ParticipantId::new("p").unwrap(),
            beyond: None,
            preferred: Some(Preferred { points: 1.25, low: 0.5, high: 2.0, within_5: 0.75 }),
            on_the_scale: None,
            before_riding: None,
            reasons: Vec::new(),
        };
        let said = |unit, near, further| {
            let points = Points { unit, near, further };
            lines(&recommended, points, false)
        };
        assert_eq!(
            said("points", 0.57, 1),
            ["p: +1.25 points (95% +0.50 to +2.00; within 0.57 points with probability 0.75)"]
        );
        let adb = &said("ADB points", 5.0, 0)[0];
        assert!(adb.contains(" ADB points (95% +0.5 to +2.0; within 5 points with"), "{adb}");
    }
}
