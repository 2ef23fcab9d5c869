//! `recommend`: how far to turn the dial for this person, how sure that is, why, and which shift to show next.

mod model;
mod page;
mod percept;
mod scale;
mod trial;

pub use model::{Learned, Preferred, Standard};
pub use percept::{Dial, Percept};
pub use scale::OnTheScale;
pub use trial::{
    DialRehearsal, LearnedFrom, Method, RehearseDialOptions, Score as RecoveryScore, TrialError,
    rehearse_dial,
};

use crate::{
    atomic_write::write_json,
    design::DesignFile,
    error::StudyError,
    outcome::{Outcome, Watch},
    outputs::spare_inputs,
    stages::analyse::read_study,
};
use maveric_analysis::StudyData;
use maveric_domain::ParticipantId;
use maveric_stats::Belief;
use serde::Serialize;
use std::path::PathBuf;

/// Settings that a further trial may show, in ADB points from the own style.
pub(crate) const SETTINGS: [f64; 7] = [-15.0, -10.0, -5.0, 0.0, 5.0, 10.0, 15.0];

/// For whom to recommend.
#[derive(Debug, Clone)]
pub struct RecommendOptions {
    /// The study's design; `study.toml` of the folder one stands in without, else the paper's.
    pub design: Option<PathBuf>,
    /// Folder of results, as the pipeline leaves it.
    pub results: PathBuf,
    /// One participant; everybody without.
    pub participant: Option<String>,
    /// Recommendations to write (JSON).
    pub out: Option<PathBuf>,
}

/// A reason: by how many points it moves the recommendation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reason {
    /// `everybody`, a trait, or `own ratings`.
    pub because: String,
    /// The person's value in SDs from the mean of those learned from; none for `everybody` and `own ratings`.
    pub standardised: Option<f64>,
    /// Effect on the recommended shift, in ADB points.
    pub points: f64,
}

/// What to recommend to one person.
#[derive(Debug, Clone, Serialize)]
pub struct Recommendation {
    /// Who.
    pub participant: ParticipantId,
    /// By their own ratings of the conditions and by who they are; none if the ratings have no top.
    pub preferred: Option<Preferred>,
    /// The same on the scale of the score, with what the drive leaves open of the own style.
    pub on_the_scale: Option<OnTheScale>,
    /// By who they are alone, as for somebody who has not ridden yet.
    pub before_riding: Option<Preferred>,
    /// The reasons, the largest first.
    pub reasons: Vec<Reason>,
    /// The setting whose rating would tell most, in ADB points, and how much, in nats.
    pub next: (f64, f64),
}

/// What was recommended.
#[derive(Debug, Clone, Serialize)]
pub struct Recommended {
    /// People of the study.
    pub participants: usize,
    /// A recommendation each; every person's model was learned from the others.
    pub recommendations: Vec<Recommendation>,
}

/// Recommends a setting of the dial to the people of a study, each by a model learned from all others and by their own ratings.
///
/// # Errors
/// [`StudyError`] if a table cannot be read, the participant is not of the study, or the study is too small to learn from.
pub fn recommend(
    options: &RecommendOptions,
    watch: Watch<'_>,
) -> Result<Outcome<Recommended>, StudyError> {
    spare_inputs(options.design.as_deref(), options.out.as_deref())?;
    let study = DesignFile::find(options.design.as_deref())?;
    let data = read_study(&options.results, &study, None)?;
    let wanted: Vec<&ParticipantId> = match &options.participant {
        None => data.participants.iter().collect(),
        Some(name) => {
            let found = data.participants.iter().find(|p| p.as_str() == name);
            vec![found.ok_or_else(|| unknown(name, &data))?]
        }
    };
    let mut recommendations = Vec::new();
    for (done, p) in wanted.iter().enumerate() {
        watch.step(done, wanted.len(), "people")?;
        let others: Vec<ParticipantId> = data
            .participants
            .iter()
            .filter(|o| o != p)
            .cloned()
            .collect();
        let learned = Learned::from(&data, &others, None)?;
        recommendations.push(recommendation(&learned, &data, p));
    }
    let value = Recommended {
        participants: data.participants.len(),
        recommendations,
    };
    if let Some(out) = &options.out {
        write_json(out, &value)?;
    }
    let mut summary: Vec<String> = value
        .recommendations
        .iter()
        .flat_map(|r| said(r, options.participant.is_some()))
        .collect();
    if data.is_synthetic() {
        summary.push("synthetic participants".to_owned());
    }
    let warnings = value
        .recommendations
        .iter()
        .filter(|r| r.preferred.is_none())
        .map(|r| {
            format!(
                "{}: the ratings have no highest point, so nothing is recommended",
                r.participant
            )
        })
        .collect();
    Ok(Outcome {
        value,
        summary,
        warnings,
    })
}

fn unknown(name: &str, data: &StudyData) -> StudyError {
    let known: Vec<&str> = data
        .participants
        .iter()
        .map(ParticipantId::as_str)
        .collect();
    StudyError::NotPossible {
        problem: format!("no participant `{name}` with an own drive in this study"),
        help: Some(format!("participants are {}", known.join(", "))),
    }
}

fn recommendation(learned: &Learned, data: &StudyData, p: &ParticipantId) -> Recommendation {
    let traits = learned.traits(data, p);
    let before = learned.belief(data, p, false);
    let after = learned.belief(data, p, true);
    let preferred = learned.preferred(&after, &traits);
    let on_the_scale = preferred.as_ref();
    Recommendation {
        participant: p.clone(),
        on_the_scale: on_the_scale.and_then(|preferred| scale::on_the_scale(data, p, preferred)),
        preferred,
        before_riding: learned.preferred(&before, &traits),
        reasons: reasons(learned, &before, &after, &traits),
        next: next(learned, &after, &traits),
    }
}

/// The setting that is expected to tell most.
pub(crate) fn next(learned: &Learned, belief: &Belief, traits: &[f64]) -> (f64, f64) {
    let mut best = (0.0, f64::NEG_INFINITY);
    for points in SETTINGS {
        let nats = learned.information(belief, traits, points);
        if nats > best.1 + 1e-12 {
            best = (points, nats);
        }
    }
    best
}

/// What each part adds to the recommended shift, at the curvature that is believed.
fn reasons(learned: &Learned, before: &Belief, after: &Belief, traits: &[f64]) -> Vec<Reason> {
    let (linear, square) = model::parabola(traits);
    let g = before.mean_of(&square).min(-0.05);
    // One unit of b in points, on the person's side of the dial.
    let side = -before.mean_of(&linear) / (2.0 * g);
    let unit = {
        let step = if side >= learned.dial.shift[1] {
            0.01
        } else {
            -0.01
        };
        (learned.dial.points_at(side + step) - learned.dial.points_at(side)) / step / (-2.0 * g)
    };
    let mean = before.mean();
    let mut reasons = vec![Reason {
        because: "everybody".to_owned(),
        standardised: None,
        points: learned.dial.points_at(-mean[1] / (2.0 * g)),
    }];
    for (k, (standard, z)) in learned.traits.iter().zip(traits).enumerate() {
        reasons.push(Reason {
            because: standard.name.clone(),
            standardised: Some(*z),
            points: unit * mean[4 + k] * z,
        });
    }
    if let (Some(with), Some(without)) = (
        learned.preferred(after, traits),
        learned.preferred(before, traits),
    ) {
        reasons.push(Reason {
            because: "own ratings".to_owned(),
            standardised: None,
            points: with.points - without.points,
        });
    }
    reasons.sort_by(|a, b| b.points.abs().total_cmp(&a.points.abs()));
    reasons
}

/// Reasons that a line names.
const SHOWN: usize = 5;

fn said(r: &Recommendation, at_length: bool) -> Vec<String> {
    let line = |p: &Preferred| {
        format!(
            "{:+.1} ADB points (95% {:+.1} to {:+.1}; within 5 points with probability {:.2})",
            p.points, p.low, p.high, p.within_5
        )
    };
    let none = || "no recommendation: the ratings have no highest point".to_owned();
    let mut lines = vec![format!(
        "{}: {}",
        r.participant,
        r.preferred.as_ref().map_or_else(none, line)
    )];
    if let Some(s) = &r.on_the_scale {
        lines.push(format!(
            "  on the scale: {:.0} points (95% {:.0} to {:.0}), the own style being {:.0} ± {:.0}",
            s.at, s.low, s.high, s.own, s.own_sd
        ));
    }
    if at_length {
        lines.push(format!(
            "  before riding: {}",
            r.before_riding.as_ref().map_or_else(none, line)
        ));
        for reason in r.reasons.iter().take(SHOWN) {
            let z = reason
                .standardised
                .map_or_else(String::new, |z| format!(" ({z:+.1} SD)"));
            lines.push(format!(
                "  {:+.1} points: {}{z}",
                reason.points, reason.because
            ));
        }
        lines.push(format!(
            "  show next: {:+.0} points (would tell {:.2} nats of the preferred shift)",
            r.next.0, r.next.1
        ));
    }
    lines
}
