//! Where each condition of the design lies for each person.

use super::{Steer, Steered, is_beyond, strangers::Strangers};
use crate::{
    design::DesignFile,
    error::StudyError,
    once::told_once,
    outcome::{Outcome, Watch},
    style_scale::StyleScale,
    tables::{
        collected::{LENT, LentRow},
        conditions::ConditionRow,
        embeddings::{EmbeddingRow, read_styles, style_of},
    },
};
use maveric_domain::{
    BeyondWhy, ConditionId, DriveId, Embedding, Lent,
    design::{Car, Condition},
    stream_seed,
};
use maveric_model::{
    Model, ModelError,
    style_space::{FEWEST_DONORS, LinearHead, PerpendicularEllipse},
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
    /// Points of the model for one of the study's.
    points: f64,
    /// Points of the model for one of the design's: a `--points` that is not the design's own step.
    stretch: f64,
    seed: u64,
}

/// One row a participant and condition that has a learned car; the person's own turning of the dial has none.
pub(super) fn conditions(
    options: &Steer,
    study: &DesignFile,
    model: &Model,
    axis: Option<&LinearHead>,
    own: &[&EmbeddingRow],
    watch: Watch<'_>,
) -> Result<Outcome<Steered>, StudyError> {
    let design = &study.design;
    let mut warnings = Vec::new();
    let driven: Vec<&Condition> = design
        .conditions()
        .iter()
        .filter(|c| !matches!(c.car, None | Some(Car::Free)))
        .collect();
    if driven.is_empty() {
        return Err(study.wrong(
            "`condition.car`: found no learned car, expected one to steer",
            Some(
                "give a condition a car: { dial = 0 }, { across = true }, { mean = true }"
                    .to_owned(),
            ),
        ));
    }
    let scale = StyleScale::of(study)?;
    let step = design.style().and_then(|style| style.points);
    let mut steering = Steering {
        model,
        axis,
        across: false,
        lending: BTreeMap::new(),
        ridden: study.lent()?,
        points: scale.stretch(),
        stretch: options
            .points
            .zip(step)
            .map_or(scale.stretch(), |(asked, step)| {
                scale.stretch() * (asked / step)
            }),
        seed: options.seed,
    };
    let (mut clamped, mut shifts) = (0, 0);
    if driven.iter().any(|c| c.car == Some(Car::Across)) {
        match PerpendicularEllipse::of(model) {
            Err(error @ ModelError::NoPerpendicular { .. }) => {
                let across = driven.iter().filter(|c| c.car == Some(Car::Across));
                warnings.extend(across.map(|c| format!("condition {} left out: {error}", c.id)));
            }
            ellipse => steering.across = ellipse.map(|_| true)?,
        }
    }
    for condition in &driven {
        if let (Some(Car::Matched(matched)), false) = (&condition.car, condition.recorded) {
            let mut tested = Vec::new();
            for person in own {
                let hat = steering.hat(&person.embedding)?;
                if BeyondWhy::of_reading(hat, person.beyond_why.clone())
                    .1
                    .is_none()
                {
                    tested.push((person.drive.clone(), person.embedding.clone()));
                }
            }
            let lending = Lending::of(model, *matched, tested)?;
            steering.lending.insert(condition.id, lending);
        }
    }
    let mut rows = Vec::new();
    let mut strangers = Strangers::of(options, design);
    let turned = driven.iter().any(|condition| condition.side().is_some());
    for person in own {
        watch.check()?;
        let own_hat = steering.hat(&person.embedding)?;
        let (_, why) = BeyondWhy::of_reading(own_hat, person.beyond_why.clone());
        let may_turn = strangers.may_turn(&person.participant, why.as_ref(), turned);
        for condition in &driven {
            if !may_turn && condition.side().is_some() {
                continue;
            }
            let id = DriveId::in_condition(&person.participant, condition.id)?;
            if design.exclude().drives.contains_key(&id) {
                warnings.push(format!("drive {id}: left out by exclude.drives"));
                continue;
            }
            let Some((placed, lent)) = steering.place(study, condition, person)? else {
                continue;
            };
            shifts += usize::from(condition.side().is_some());
            clamped += usize::from(placed.clamped);
            let embedding = placed.embedding;
            let ends = embedding.coordinates().iter();
            let step: Vec<f64> = ends
                .zip(person.embedding.coordinates())
                .map(|(a, b)| a - b)
                .collect();
            rows.push(ConditionRow {
                participant: person.participant.clone(),
                condition: condition.id,
                adb_hat: scale.score_of(steering.hat(&embedding)?, None).0,
                moved_points: placed.moved_points.map(|points| points / scale.stretch()),
                moved_points_sd: axis
                    .and_then(|axis| axis.step_sd(&step))
                    .map(|sd| sd / scale.stretch()),
                clamped: placed.clamped,
                angle_rad: placed.angle_rad,
                lent,
                beyond_training: is_beyond(model, &embedding)?,
                beyond_why: match condition.car {
                    Some(Car::Dial(_) | Car::Across) => why.clone(),
                    _ => None,
                },
                sweep: None,
                embedding,
            });
        }
    }
    warnings.extend(strangers.warnings());
    warnings.extend(steering.of_donors(&rows));
    let nobody = told_once("participant", steering.nobodys(&driven, own));
    warnings.extend(nobody);
    if clamped > 0 {
        warnings.push(format!(
            "{clamped} of {shifts} shifts were cut short by the ends of the scale"
        ));
    }
    let summary = vec![format!(
        "{} participants × {} conditions: {}",
        own.len(),
        driven.len()
            - driven
                .iter()
                .filter(|c| c.car == Some(Car::Across) && !steering.across)
                .count(),
        options.out.to_slash_lossy()
    )];
    Ok(Outcome {
        value: Steered {
            participants: own.len(),
            clamped,
            beyond: strangers.people,
            beyond_left_out: strangers.left_out,
            attributes: Vec::new(),
            conditions: rows,
        },
        summary,
        warnings,
    })
}

impl Steering<'_> {
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
                let found = lending.map(|lending| lending.lend(rider, drawn));
                let Some((style, from)) = found.transpose()?.flatten() else {
                    return Ok(None);
                };
                lent = Some(Lent {
                    donor_shift_points: from.donor_shift_points / self.points,
                    ..from
                });
                RideStyle::Given(style)
            }
            Some(Car::Mean) => RideStyle::Mean,
            Some(Car::Embedding(file)) => {
                let file = study.resolve(file);
                let rows = read_styles(&file, self.model.embedding_size())?;
                RideStyle::Given(style_of(&rows, &file, Some(who))?.clone())
            }
            _ => return Ok(None),
        };
        let points = condition.dial().unwrap_or(0.0) * self.stretch;
        let placed = style.place(self.model, &person.embedding, points)?;
        Ok(Some((placed, lent)))
    }

    /// What a reader has to know of how donors were drawn.
    fn of_donors(&self, rows: &[ConditionRow]) -> Vec<String> {
        let mut told = Vec::new();
        for (id, lending) in &self.lending {
            let lenders = lending.lenders();
            if lenders < FEWEST_DONORS {
                told.push(format!(
                    "condition {id}: {lenders} drives whose style may be lent, fewer than {FEWEST_DONORS}: it is the same one again and again"
                ));
            }
            let theirs = rows.iter().filter(|row| row.condition == *id);
            let lent: Vec<&Lent> = theirs.filter_map(|row| row.lent.as_ref()).collect();
            let beyond = lent.iter().filter(|lent| !lent.donor_within_reach).count();
            if beyond > 0 {
                told.push(format!(
                    "condition {id}: nobody within reach of {beyond} of {} people, who were lent the nearest style (`donor_within_reach`)",
                    lent.len()
                ));
            }
        }
        told
    }

    /// Who was lent nobody's style in a condition that was ridden, and what is said of it.
    fn nobodys(&self, driven: &[&Condition], own: &[&EmbeddingRow]) -> Vec<(String, String)> {
        let ridden = driven.iter().filter(|c| c.recorded);
        let ridden = ridden.filter(|c| matches!(c.car, Some(Car::Matched(_))));
        let missing =
            ridden.flat_map(|condition| {
                own.iter().filter_map(|person| {
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
