//! Where each condition of the design lies for each person.

use super::{Steer, Steered, is_beyond, moved_sd, strangers::Strangers, withheld};
use crate::{
    design::DesignFile,
    error::StudyError,
    once::told_once,
    outcome::{Outcome, Watch},
    tables::{
        collected::{LENT, LentRow, consents_of_study},
        conditions::ConditionRow,
        embeddings::{EmbeddingRow, read_styles, style_of},
    },
};
use maveric_domain::{
    BeyondWhy, ConditionId, DriveId, Embedding, Lent,
    design::{Car, Condition, FEWEST_DONORS},
    stream_seed,
};
use maveric_model::{
    Model, ModelError,
    style_space::{LinearHead, PerpendicularEllipse},
};
use maveric_steering::{Lending, PlacedStyle, RideStyle, Seed};
use path_slash::PathExt as _;
use std::collections::BTreeMap;

struct Steering<'a> {
    model: &'a Model,
    /// None where the model has no style head.
    axis: Option<&'a LinearHead>,
    /// Whether there is something across the dial.
    across: bool,
    /// Where somebody else's style is lent.
    lending: BTreeMap<ConditionId, Lending>,
    /// What was lent in the seat.
    ridden: Vec<LentRow>,
    /// How many of the design's steps `--points` is.
    steps: f64,
    seed: u64,
}

/// One row a participant and condition that has a learned car; the person's own turning of the dial has none.
pub(super) fn conditions(
    options: &Steer,
    study: &DesignFile,
    model: &Model,
    axis: Option<&LinearHead>,
    people: &[&EmbeddingRow],
    watch: Watch<'_>,
) -> Result<Outcome<Steered>, StudyError> {
    let design = &study.design;
    let driven: Vec<&Condition> =
        design.conditions().iter().filter(|c| !matches!(c.car, None | Some(Car::Free))).collect();
    if driven.is_empty() {
        return Err(study.wrong(
            "`condition.car`: found no learned car, expected one to steer",
            Some(
                "give a condition a car: { dial = 0 }, { across = true }, { mean = true }"
                    .to_owned(),
            ),
        ));
    }
    let step = design.style().and_then(|style| style.points);
    let steps = options.points.zip(step);
    let mut steering = Steering {
        model,
        axis,
        across: false,
        lending: BTreeMap::new(),
        ridden: study.lent()?,
        steps: steps.map_or(1.0, |(points, step)| points / step),
        seed: options.seed,
    };
    let mut warnings = steering.look_across(&driven)?;
    steering.ask_donors(study, &driven, people)?;
    let mut rows = Vec::new();
    let mut strangers = Strangers::new(options, design);
    let turns = |condition: &Condition| condition.side().is_some();
    let turned = driven.iter().any(|condition| turns(condition));
    for person in people {
        watch.check()?;
        let own_hat = steering.hat(&person.embedding)?;
        let by_support = person.beyond_why.clone();
        let (_, why) = BeyondWhy::of_reading(model.score_range(), own_hat, by_support);
        let may_turn = strangers.may_turn(&person.participant, why.as_ref(), turned);
        for condition in &driven {
            if !may_turn && turns(condition) {
                continue;
            }
            let id = DriveId::in_condition(&person.participant, condition.id)?;
            if design.exclude().drives.contains_key(&id) {
                warnings.push(format!("drive {id}: left out by exclude.drives"));
                continue;
            }
            rows.extend(steering.row(study, condition, person, why.as_ref())?);
        }
    }
    warnings.extend(strangers.warnings());
    warnings.extend(steering.of_donors(&rows));
    let nobody = told_once("participant", steering.nobodys(&driven, people));
    warnings.extend(nobody);
    let shifted = |row: &&ConditionRow| design.condition(row.condition).is_some_and(turns);
    let shifts = rows.iter().filter(shifted).count();
    let clamped = rows.iter().filter(|row| row.clamped).count();
    if clamped > 0 {
        warnings
            .push(format!("{clamped} of {shifts} shifts were cut short by the ends of the scale"));
    }
    let nowhere = |c: &&&Condition| c.car == Some(Car::Across) && !steering.across;
    let summary = vec![format!(
        "{} participants × {} conditions: {}",
        people.len(),
        driven.len() - driven.iter().filter(nowhere).count(),
        options.out.to_slash_lossy()
    )];
    let value = Steered {
        participants: people.len(),
        clamped,
        beyond: strangers.people,
        beyond_left_out: strangers.left_out,
        attributes: Vec::new(),
        conditions: rows,
    };
    Ok(Outcome::new(value, summary, warnings))
}

impl Steering<'_> {
    /// Looks whether there is something across the dial, where a condition asks for it; what to know of one that has nothing there.
    fn look_across(&mut self, driven: &[&Condition]) -> Result<Vec<String>, StudyError> {
        let mut across = driven.iter().filter(|c| c.car == Some(Car::Across)).peekable();
        if across.peek().is_none() {
            return Ok(Vec::new());
        }
        match PerpendicularEllipse::of(self.model) {
            Err(error @ ModelError::NoPerpendicular { .. }) => {
                let left_out = |c: &&Condition| format!("condition {} left out: {error}", c.id);
                Ok(across.map(left_out).collect())
            }
            ellipse => {
                self.across = ellipse.map(|_| true)?;
                Ok(Vec::new())
            }
        }
    }

    /// Asks for each condition of somebody else's style who may lend theirs: whoever is not beyond what the model has met, and lets it be lent.
    fn ask_donors(
        &mut self,
        study: &DesignFile,
        driven: &[&Condition],
        people: &[&EmbeddingRow],
    ) -> Result<(), StudyError> {
        let refused = withheld::people(&study.consents()?);
        let learned = self.model.training().iter().map(|t| &t.drive);
        let kept_back = withheld::drives(&refused, &study.design, learned);
        for condition in driven {
            let (Some(Car::Matched(matched)), false) = (&condition.car, condition.recorded) else {
                continue;
            };
            let mut tested = Vec::new();
            let lend = |person: &&&EmbeddingRow| !refused.contains(&person.participant);
            for person in people.iter().filter(lend) {
                let hat = self.hat(&person.embedding)?;
                let (range, by_support) = (self.model.score_range(), person.beyond_why.clone());
                let (_, beyond) = BeyondWhy::of_reading(range, hat, by_support);
                if beyond.is_none() {
                    tested.push((person.drive.clone(), person.embedding.clone()));
                }
            }
            let lending = Lending::of(self.model, *matched, tested, &kept_back)?;
            self.lending.insert(condition.id, lending);
        }
        Ok(())
    }

    /// The row of a person in a condition, `why` their own drive is beyond what the model has met; none where there is no such style.
    fn row(
        &mut self,
        study: &DesignFile,
        condition: &Condition,
        person: &EmbeddingRow,
        why: Option<&BeyondWhy>,
    ) -> Result<Option<ConditionRow>, StudyError> {
        let Some((placed, lent)) = self.place(study, condition, person)? else {
            return Ok(None);
        };
        let embedding = placed.embedding;
        let ends = [&person.embedding, &embedding];
        let range = self.model.score_range();
        let of_the_own_style =
            matches!(condition.car, Some(Car::Dial(_) | Car::Across | Car::Replay));
        Ok(Some(ConditionRow {
            participant: person.participant.clone(),
            condition: condition.id,
            adb_hat: BeyondWhy::of_reading(range, self.hat(&embedding)?, None).0,
            moved_points: placed.moved_points,
            moved_points_sd: self.axis.and_then(|axis| moved_sd(axis, ends)),
            clamped: placed.clamped,
            angle_rad: placed.angle_rad,
            lent,
            beyond_training: is_beyond(self.model, &embedding)?,
            beyond_why: why.filter(|_| of_the_own_style).cloned(),
            sweep: None,
            embedding,
        }))
    }

    /// Where a condition lies for a person, and who lends the style; none across the dial where there is nothing.
    fn place(
        &mut self,
        study: &DesignFile,
        condition: &Condition,
        person: &EmbeddingRow,
    ) -> Result<Option<(PlacedStyle, Option<Lent>)>, StudyError> {
        let who = &person.participant;
        let drawn = stream_seed(self.seed, &[who.as_str(), condition.id.as_str()]);
        let mut lent = None;
        let style = match &condition.car {
            Some(Car::Dial(_)) => RideStyle::Own,
            Some(Car::Replay) => RideStyle::Replay,
            Some(Car::Across) if self.across => RideStyle::Across(Seed(drawn)),
            // Where it was ridden, what was lent is known.
            Some(Car::Matched(_)) if condition.recorded => {
                let ridden = self.ridden.iter();
                let mut theirs = ridden.filter(|row| row.condition == condition.id);
                let Some(row) = theirs.find(|row| row.participant == *who) else {
                    return Ok(None);
                };
                lent = Some(row.lent.clone());
                RideStyle::Given(row.embedding.clone())
            }
            Some(Car::Matched(_)) => {
                let lending = self.lending.get_mut(&condition.id);
                let rider = (Some(&person.drive), &person.embedding);
                let loan = lending.map(|lending| lending.lend(rider, drawn));
                let Some((style, from)) = loan.transpose()?.flatten() else {
                    return Ok(None);
                };
                lent = Some(from);
                RideStyle::Given(style)
            }
            Some(Car::Mean) => RideStyle::Mean,
            Some(Car::Embedding(file)) => {
                let file = study.resolve(file);
                let rows = read_styles(&file, self.model.embedding_size())?;
                RideStyle::Given(style_of(&rows, &file, who)?.clone())
            }
            _ => return Ok(None),
        };
        let points = condition.dial().unwrap_or(0.0) * self.steps;
        let placed = style.place(self.model, &person.embedding, points)?;
        Ok(Some((placed, lent)))
    }

    /// What a reader has to know of how donors were drawn.
    fn of_donors(&self, rows: &[ConditionRow]) -> Vec<String> {
        let mut warnings = Vec::new();
        for (id, lending) in &self.lending {
            let lenders = lending.lenders();
            if lenders == 0 && self.model.training().is_empty() {
                warnings.push(format!(
                    "condition {id} left out: the model keeps no drives whose style could be lent"
                ));
            } else if lenders == 0 {
                warnings.push(format!(
                    "condition {id} left out: there is nobody whose style may be lent (`style_lent` of {})",
                    consents_of_study().to_slash_lossy()
                ));
            } else if lenders < FEWEST_DONORS {
                warnings.push(format!(
                    "condition {id}: {lenders} drives whose style may be lent, fewer than {FEWEST_DONORS}: it is the same one again and again"
                ));
            }
            let theirs = rows.iter().filter(|row| row.condition == *id);
            let lent: Vec<&Lent> = theirs.filter_map(|row| row.lent.as_ref()).collect();
            let beyond = lent.iter().filter(|lent| !lent.donor_within_reach).count();
            if beyond > 0 {
                warnings.push(format!(
                    "condition {id}: nobody within reach of {beyond} of {} people, who were lent the nearest style (`donor_within_reach`)",
                    lent.len()
                ));
            }
        }
        warnings
    }

    /// Who was lent nobody's style in a condition that was ridden, and what is said of it.
    fn nobodys(&self, driven: &[&Condition], people: &[&EmbeddingRow]) -> Vec<(String, String)> {
        let ridden = driven.iter().filter(|c| c.recorded);
        let ridden = ridden.filter(|c| matches!(c.car, Some(Car::Matched(_))));
        let missing = ridden.flat_map(|condition| {
            people.iter().filter_map(|person| {
                let mut lent = self.ridden.iter().filter(|row| row.condition == condition.id);
                let known = lent.any(|row| row.participant == person.participant);
                let what = format!(
                    "nobody's style was lent in the seat for condition {} ({LENT}): left out there",
                    condition.id
                );
                (!known).then(|| (person.participant.to_string(), what))
            })
        });
        missing.collect()
    }

    /// Ŝ at an embedding; none where the model has no style head.
    fn hat(&self, style: &Embedding) -> Result<Option<f64>, ModelError> {
        self.axis.map(|axis| axis.read(style)).transpose()
    }
}
