//! Where each condition of the design lies for each person.

use super::{Steer, Steered, is_beyond, strangers::Strangers};
use crate::{
    design::DesignFile,
    error::StudyError,
    outcome::{Outcome, Watch},
    style_scale::StyleScale,
    tables::{
        conditions::ConditionRow,
        embeddings::{EmbeddingRow, read_embeddings},
    },
};
use maveric_domain::{
    BeyondWhy, Embedding, ParticipantId,
    design::{Car, Condition},
    stream_seed,
};
use maveric_model::{
    Model, ModelError,
    style_space::{LinearHead, PerpendicularEllipse},
};
use path_slash::PathExt as _;
use rand_pcg::{Pcg64Mcg, rand_core::SeedableRng};
use std::path::Path;

/// Where a condition lies, how far that is along the dial (points), where there is one, and the angle of a move across it.
type Place = (Embedding, Option<f64>, Option<f64>);

struct Steering<'a> {
    model: &'a Model,
    /// None where the model has no style head.
    axis: Option<&'a LinearHead>,
    ellipse: Option<PerpendicularEllipse>,
    /// Points of the model for one of the design's: a `--points` that is not the design's own step.
    stretch: f64,
    seed: u64,
    clamped: usize,
    shifts: usize,
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
        ellipse: None,
        stretch: options
            .points
            .zip(step)
            .map_or(scale.stretch(), |(asked, step)| {
                scale.stretch() * (asked / step)
            }),
        seed: options.seed,
        clamped: 0,
        shifts: 0,
    };
    if driven.iter().any(|c| c.car == Some(Car::Across)) {
        match PerpendicularEllipse::of(model) {
            Err(error @ ModelError::NoPerpendicular { .. }) => {
                let across = driven.iter().filter(|c| c.car == Some(Car::Across));
                warnings.extend(across.map(|c| format!("condition {} left out: {error}", c.id)));
            }
            ellipse => steering.ellipse = Some(ellipse?),
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
            let id = format!("{}-{}", person.participant, condition.id);
            let excluded = design
                .exclude()
                .drives
                .iter()
                .any(|(d, _)| d.as_str() == id);
            if excluded {
                warnings.push(format!("drive {id}: left out by exclude.drives"));
                continue;
            }
            let clamped_before = steering.clamped;
            let Some((embedding, moved_points, angle_rad)) =
                steering.place(study, condition, person)?
            else {
                continue;
            };
            let ends = embedding.coordinates().iter();
            let step: Vec<f64> = ends
                .zip(person.embedding.coordinates())
                .map(|(a, b)| a - b)
                .collect();
            rows.push(ConditionRow {
                participant: person.participant.clone(),
                condition: condition.id,
                adb_hat: scale.score_of(steering.hat(&embedding)?, None).0,
                moved_points: moved_points.map(|points| points / scale.stretch()),
                moved_points_sd: axis
                    .and_then(|axis| axis.step_sd(&step))
                    .map(|sd| sd / scale.stretch()),
                clamped: steering.clamped > clamped_before,
                angle_rad,
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
    if steering.clamped > 0 {
        let (clamped, shifts) = (steering.clamped, steering.shifts);
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
                .filter(|c| c.car == Some(Car::Across) && steering.ellipse.is_none())
                .count(),
        options.out.to_slash_lossy()
    )];
    Ok(Outcome {
        value: Steered {
            participants: own.len(),
            clamped: steering.clamped,
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
    fn place(
        &mut self,
        study: &DesignFile,
        condition: &Condition,
        person: &EmbeddingRow,
    ) -> Result<Option<Place>, StudyError> {
        let own = &person.embedding;
        Ok(match &condition.car {
            Some(Car::Dial(points)) => {
                let points = points * self.stretch;
                if points.abs() < f64::EPSILON {
                    return Ok(Some((own.clone(), Some(0.0), None)));
                }
                let axis = self.axis.ok_or(ModelError::NoAggressionAxis)?;
                let moved = axis.shift(own, points)?;
                self.shifts += 1;
                self.clamped += usize::from(moved.clamped);
                Some((moved.embedding, Some(moved.effective_points), None))
            }
            Some(Car::Across) => match &self.ellipse {
                None => None,
                Some(ellipse) => {
                    let labels = [person.participant.as_str(), condition.id.as_str()];
                    let mut rng = Pcg64Mcg::seed_from_u64(stream_seed(self.seed, &labels));
                    let across = ellipse.sample(own, &mut rng)?;
                    Some((across.embedding, Some(0.0), Some(across.angle_rad)))
                }
            },
            Some(Car::Mean) => Some(self.elsewhere(self.model.mean_embedding(), own)?),
            Some(Car::Embedding(file)) => {
                let file = study.resolve(file);
                let given = embedding_of(&file, &person.participant)?;
                Some(self.elsewhere(&given, own)?)
            }
            _ => None,
        })
    }

    /// A style that is not the person's own, and how far along the dial it is from there.
    fn elsewhere(&self, style: &Embedding, own: &Embedding) -> Result<Place, StudyError> {
        let moved = self.hat(style)?.zip(self.hat(own)?);
        Ok((style.clone(), moved.map(|(there, here)| there - here), None))
    }

    /// Ŝ at an embedding; none where the model has no style head.
    fn hat(&self, style: &Embedding) -> Result<Option<f64>, ModelError> {
        self.axis.map(|axis| axis.read(style)).transpose()
    }
}

/// The person's own row of a file of embeddings, or its only row.
fn embedding_of(file: &Path, who: &ParticipantId) -> Result<Embedding, StudyError> {
    let rows = read_embeddings(file)?;
    let own = rows.iter().find(|row| row.participant == *who);
    match own.or(rows.first().filter(|_| rows.len() == 1)) {
        Some(row) => Ok(row.embedding.clone()),
        None => Err(StudyError::file(
            file,
            format!(
                "has {} rows and none of {who}, expected one row for everybody, or one a person",
                rows.len()
            ),
        )),
    }
}
