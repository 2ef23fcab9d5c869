//! Whose answers count, whose are missed, and who is listed as left out.

use super::{Moments, ScoreAnswers};
use crate::{
    design::DesignFile,
    error::StudyError,
    gate::{Gate, counted},
    once::names,
    tables::drives::{kept_out, listed_rides},
};
use maveric_analysis::Why;
use maveric_domain::{Answer, Moment, ParticipantId, ProbeAnswer, Ride, Scale};
use maveric_measures::{ScoreWarning, survey::SheetTime};
use maveric_report::tables::Exclusion;
use std::collections::{BTreeMap, BTreeSet};
/// Whose answers, when, and why they are left out → how many.
pub(super) type LeftOutAnswers = BTreeMap<(ParticipantId, Moment, Why), usize>;

/// Whose answers are missed where they are not there.
#[derive(Default)]
pub(super) struct Expected {
    /// Those who should have answered something; whoever is listed, where no design says.
    people: Option<BTreeSet<ParticipantId>>,
    /// Who has which ride, of the rides in conditions that are known.
    rides: BTreeMap<Ride, BTreeSet<ParticipantId>>,
    /// Whom and what the design leaves out; none where no design says.
    gate: Option<Gate>,
}

impl Expected {
    pub(super) fn new(
        study: Option<(&DesignFile, Gate)>,
        options: &ScoreAnswers,
        left_out: &LeftOutAnswers,
    ) -> Result<Self, StudyError> {
        let Some((study, gate)) = study else {
            return Ok(Self::default());
        };
        let mut rides: BTreeMap<Ride, BTreeSet<ParticipantId>> = BTreeMap::new();
        for folder in &options.drives {
            for (who, ride) in listed_rides(folder)? {
                if study.design.condition(ride.condition).is_some() {
                    rides.entry(ride).or_default().insert(who);
                }
            }
        }
        let listed = study.people(options.participants.as_deref())?;
        let mut people: BTreeSet<ParticipantId> = match options.moments {
            Moments::All => listed.enrolled.into_iter().map(|p| p.id).collect(),
            Moments::After => listed.tested(),
        };
        people.retain(|who| {
            let rode = rides.is_empty() || rides.values().any(|people| people.contains(who));
            let answered = left_out.keys().any(|(other, ..)| other == who);
            let counts = rode || options.moments == Moments::All;
            counts && !answered && gate.person(who).is_none()
        });
        let people = Some(people);
        Ok(Self { people, rides, gate: Some(gate) })
    }

    /// Whether what a warning says is lacking, if it says so, was to be there.
    pub(super) fn misses(&self, warning: &ScoreWarning) -> bool {
        let people = match warning {
            ScoreWarning::NoAnswers { .. } => self.people.as_ref(),
            ScoreWarning::Unanswered { participant, moment, .. } => {
                let left_out = |gate: &Gate| gate.answer(participant, *moment).is_some();
                if self.gate.as_ref().is_some_and(left_out) {
                    return false;
                }
                match moment {
                    Moment::After(ride) => self.rides.get(ride),
                    _ => None,
                }
            }
            _ => None,
        };
        people.is_none_or(|people| people.contains(warning.participant()))
    }
}

/// Takes out the answers that the design does not let in; with what lets them in.
pub(super) fn let_in(
    study: Option<&DesignFile>,
    options: &ScoreAnswers,
    scales: &[Scale],
    (answers, probes, times): (&mut Vec<Answer>, &mut Vec<ProbeAnswer>, &mut Vec<SheetTime>),
) -> Result<(LeftOutAnswers, Option<Gate>), StudyError> {
    let mut left_out = LeftOutAnswers::new();
    let Some(study) = study else {
        return Ok((left_out, None));
    };
    let mut drives = Vec::new();
    for folder in &options.drives {
        drives.extend(kept_out(folder)?);
    }
    let gate = Gate::new(study, options.participants.as_deref())?;
    let gate = gate.with_sheets(scales, answers, &drives);
    let mut keeps = |who: &ParticipantId, moment: Moment| match gate.answer(who, moment) {
        None => true,
        Some(why) => {
            *left_out.entry((who.clone(), moment, why)).or_default() += 1;
            false
        }
    };
    answers.retain(|a| keeps(&a.participant, a.moment));
    probes.retain(|p| keeps(&p.participant, Moment::Probe(p.ride)));
    times.retain(|t| gate.answer(&t.participant, t.moment).is_none());
    Ok((left_out, Some(gate)))
}

/// Why there is not one answer to score: none was given, or none is let in.
pub(super) fn nothing_to_score(left_out: &LeftOutAnswers) -> StudyError {
    if left_out.is_empty() {
        return StudyError::not_possible("the surveys hold no answers");
    }
    let answers = left_out.iter().flat_map(|((.., why), n)| std::iter::repeat_n(why, *n));
    let rules = counted(["answer", "answers"], answers).join("; ");
    let reasons: BTreeSet<&str> = left_out.keys().map(|(.., why)| why.reason.as_str()).collect();
    let reasons: Vec<&str> = reasons.into_iter().collect();
    StudyError::not_possible(format!("the surveys hold no answers that are let in: {rules}"))
        .with_help(names(&reasons))
}

/// What a warning says, in a line; of a table of answers after rides that it is of these alone.
pub(super) fn line(warning: &ScoreWarning, moments: Moments) -> String {
    match warning {
        ScoreWarning::NoAnswers { .. } if moments == Moments::After => {
            format!("{warning} after a drive")
        }
        _ => warning.to_string(),
    }
}

/// What a list of exclusions calls the answers of a time.
pub(crate) fn of_answers(moment: Moment) -> String {
    format!("answers ({moment})")
}

/// The rows of who and what was left out, or is doubtful and kept.
pub(super) fn exclusions(
    warnings: &[ScoreWarning],
    left_out: &LeftOutAnswers,
    moments: Moments,
) -> Vec<Exclusion> {
    let doubted = warnings.iter().map(|warning| Exclusion {
        who: warning.participant().to_string(),
        what: if warning.is_kept() {
            Exclusion::NOTHING.to_owned()
        } else {
            "questionnaires".to_owned()
        },
        why: line(warning, moments),
    });
    let kept_out = left_out.keys().map(|(who, moment, why)| Exclusion {
        who: who.to_string(),
        what: of_answers(*moment),
        why: why.to_string(),
    });
    doubted.chain(kept_out).collect()
}
