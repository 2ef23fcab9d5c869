//! A sweep: the same embeddings at several points along aggression, or along another attribute.

use super::{
    Steer, Steered,
    attribute_scores::{AGGRESSION, AttributeSummary, Heads},
    is_beyond, moved_sd,
    strangers::Strangers,
};
use crate::{
    design::DesignFile,
    error::StudyError,
    outcome::{Outcome, Watch},
    tables::{
        conditions::{ConditionRow, SweepPoint},
        embeddings::EmbeddingRow,
    },
};
use maveric_domain::{
    BeyondWhy, ConditionId, Design, DomainError, DriveId, Embedding, ScoreRange, design::Sign,
};
use maveric_model::{
    Model,
    style_space::{LinearHead, StyleMetric},
};
use path_slash::PathExt as _;

/// Change of S, in points, that counts as none.
const UNMOVED: f64 = 1e-6;

pub(super) fn sweep(
    options: &Steer,
    study: &DesignFile,
    (model, axis): (&Model, &LinearHead),
    people: &[&EmbeddingRow],
    watch: Watch<'_>,
) -> Result<Outcome<Steered>, StudyError> {
    let design = &study.design;
    let fit = |attribute| Heads::fit(model, axis, (options, attribute), design.baseline_id());
    let heads = options.attribute.as_ref().map(fit).transpose()?;
    let first = heads.as_ref().and_then(|heads| heads.all.first());
    let asked = (options.sweep.as_slice(), options.points);
    let points = points(asked, first.unwrap_or(axis).range())?;
    let sweeping = Sweeping {
        design,
        model,
        axis,
        heads: heads.as_ref(),
        metric: StyleMetric::of(model),
        name: options.attribute.as_deref().unwrap_or(AGGRESSION),
    };
    let mut conditions = Vec::new();
    let mut strangers = Strangers::new(options, design);
    let turns = |points: &f64| points.abs() >= UNMOVED;
    let turned = points.iter().any(turns);
    for row in people {
        watch.check()?;
        let own_hat = axis.read(&row.embedding)?;
        let by_support = row.beyond_why.clone();
        let (_, why) = BeyondWhy::of_reading(model.score_range(), Some(own_hat), by_support);
        let may_turn = strangers.may_turn(&row.participant, why.as_ref(), turned);
        for point in points.iter().filter(|p| may_turn || !turns(p)) {
            conditions.push(sweeping.row(row, own_hat, *point, why.clone())?);
        }
    }
    let name = sweeping.name;
    let clamped = conditions.iter().filter(|row| row.clamped).count();
    let attributes: Vec<AttributeSummary> =
        heads.as_ref().map_or(Vec::new(), |h| h.summaries.clone());
    let mut warnings = heads.as_ref().map_or(Vec::new(), |h| h.warnings.clone());
    warnings.extend(strangers.warnings());
    let n = conditions.len();
    if clamped > 0 {
        warnings.push(format!(
            "{clamped} of {n} moves were cut short by the ends of the range of {name}"
        ));
    }
    let beyond = conditions.iter().filter(|c| c.beyond_training).count();
    if beyond > 0 {
        warnings
            .push(format!("{beyond} of {n} embeddings lie further out than any training driver's"));
    }
    let mut summary = vec![format!(
        "{} participants × {} points along {name}: {}",
        people.len(),
        points.len(),
        options.out.to_slash_lossy()
    )];
    summary.extend(attributes.iter().map(ToString::to_string));
    let value = Steered {
        participants: people.len(),
        clamped,
        beyond: strangers.people,
        beyond_left_out: strangers.left_out,
        attributes,
        conditions,
    };
    Ok(Outcome::new(value, summary, warnings))
}

/// The points of the sweep: those that are asked for, else a step down, none, and a step up; on a range that says how far a step is
/// where nothing else does.
fn points(
    (asked, step): (&[f64], Option<f64>),
    [low, high]: [f64; 2],
) -> Result<Vec<f64>, StudyError> {
    if asked.is_empty() {
        let usual = || Ok::<f64, DomainError>(ScoreRange::new(low, high)?.step(1.0));
        let step = step.map_or_else(usual, Ok)?;
        return Ok(vec![-step, 0.0, step]);
    }
    for (index, point) in asked.iter().enumerate() {
        if !point.is_finite() || asked[..index].iter().any(|p| (p - point).abs() < 1e-9) {
            let problem =
                format!("sweep: found {point} twice or not finite, expected points that differ");
            let help = "for example --sweep=-20,-10,0,10,20";
            return Err(StudyError::not_possible(problem).with_help(help));
        }
    }
    Ok(asked.to_vec())
}

/// What moves, along what, and by what it is read.
struct Sweeping<'a> {
    design: &'a Design,
    model: &'a Model,
    axis: &'a LinearHead,
    /// Along an attribute; none along S.
    heads: Option<&'a Heads>,
    metric: StyleMetric,
    name: &'a str,
}

impl Sweeping<'_> {
    /// A style moved by so many points: where it lies, how far it came, and whether an end of the range cut it short.
    fn moved(&self, from: &Embedding, by: f64) -> Result<(Embedding, f64, bool), StudyError> {
        if let Some(heads) = self.heads {
            let axes: Vec<&LinearHead> = heads.all.iter().collect();
            let moved = self.metric.move_along(&axes, from, by)?;
            return Ok((moved.embedding, moved.effective_points, moved.clamped));
        }
        let shifted = self.axis.shift(from, by)?;
        Ok((shifted.embedding, shifted.effective_points, shifted.clamped))
    }

    fn row(
        &self,
        person: &EmbeddingRow,
        own_hat: f64,
        requested_points: f64,
        beyond_why: Option<BeyondWhy>,
    ) -> Result<ConditionRow, StudyError> {
        let (axis, range) = (self.axis, self.model.score_range());
        let (embedding, attribute_points, clamped) =
            self.moved(&person.embedding, requested_points)?;
        let adb_hat = axis.read(&embedding)?;
        let moved_points = adb_hat - own_hat;
        let ends = [&person.embedding, &embedding];
        let who = person.participant.as_str();
        Ok(ConditionRow {
            participant: person.participant.clone(),
            condition: condition(self.design, requested_points, moved_points)?,
            adb_hat: BeyondWhy::of_reading(range, Some(adb_hat), None).0,
            moved_points: Some(moved_points),
            moved_points_sd: moved_sd(axis, ends),
            clamped,
            angle_rad: None,
            lent: None,
            beyond_training: is_beyond(self.model, &embedding)?,
            beyond_why,
            sweep: Some(SweepPoint {
                drive: drive_name(who, self.name, requested_points)?,
                attribute: self.name.to_owned(),
                requested_points,
                attribute_points,
            }),
            embedding,
        })
    }
}

/// The condition that a point is, by what it does to S: that of the design which lies there, else one named as the point.
fn condition(
    design: &Design,
    requested_points: f64,
    moved_points: f64,
) -> Result<ConditionId, DomainError> {
    let on = |way| {
        let mut conditions = design.conditions().iter();
        conditions.find(|c| c.side() == Some(way)).map(|c| c.id)
    };
    let there = if requested_points.abs() < UNMOVED {
        design.own_style()
    } else if moved_points > UNMOVED {
        on(Sign::Plus)
    } else if moved_points < -UNMOVED {
        on(Sign::Minus)
    } else {
        design.across()
    };
    there.map_or_else(|| ConditionId::new(&point_name(requested_points)), Ok)
}

/// `up15`, `down0_5`, `0`.
fn point_name(points: f64) -> String {
    let way = match points {
        p if p > 0.0 => "up",
        p if p < 0.0 => "down",
        _ => "",
    };
    let size = points.abs().to_string().replace('.', "_");
    format!("{way}{size}")
}

/// `P01-aggression-up15`, `P01-big5_openness-down0_5`, `P01-aggression-0`: letters that are safe in a file name.
fn drive_name(participant: &str, attribute: &str, points: f64) -> Result<DriveId, StudyError> {
    let safe = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let attribute: String = attribute.chars().map(safe).collect();
    let point = point_name(points);
    Ok(DriveId::new(format!("{participant}-{attribute}-{point}"))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_have_names_of_their_own() {
        let name = |points| drive_name("P01", "mini_ipip.openness", points).unwrap();
        assert_eq!(name(15.0).as_str(), "P01-mini_ipip_openness-up15");
        assert_eq!(name(-0.5).as_str(), "P01-mini_ipip_openness-down0_5");
        assert_eq!(name(0.0).as_str(), "P01-mini_ipip_openness-0");
    }

    #[test]
    fn without_points_a_sweep_is_a_step_of_the_range_to_either_side() {
        let asked = |step, range| points((&[], step), range).unwrap();
        assert_eq!(asked(None, [11.0, 55.0]), [-15.0, 0.0, 15.0]);
        assert_eq!(asked(None, [1.0, 6.0]), [-1.7, 0.0, 1.7]);
        assert_eq!(asked(Some(4.0), [1.0, 6.0]), [-4.0, 0.0, 4.0]);
        assert_eq!(points((&[2.0], None), [1.0, 6.0]).unwrap(), [2.0]);
    }

    #[test]
    fn a_point_is_the_condition_of_the_design_that_lies_there_or_one_of_its_own() {
        let style = "[study]\ntitle = \"x\"\n[people]\nlearn = { part = \"learn\" }\n[style]\nscore = \"adb.total\"\n";
        let car =
            |id: &str, car: &str| format!("[[condition]]\nid = \"{id}\"\ncar = {{ {car} }}\n");
        let design =
            |cars: &[String]| Design::from_toml(&format!("{style}{}", cars.concat())).unwrap();
        let whole = design(&[
            car("gentle", "dial = -5"),
            car("mine", "dial = 0"),
            car("keen", "dial = 10"),
            car("other", "across = true"),
        ]);
        let point =
            |design: &Design, asked, moved| condition(design, asked, moved).unwrap().to_string();
        assert_eq!(point(&whole, 0.0, 0.0), "mine");
        assert_eq!(point(&whole, 5.0, 5.0), "keen");
        assert_eq!(point(&whole, 5.0, -1.0), "gentle");
        assert_eq!(point(&whole, 5.0, 1e-9), "other");
        let one = design(&[car("keen", "dial = 10")]);
        assert_eq!(point(&one, 0.0, 0.0), "0");
        assert_eq!(point(&one, -2.5, -2.5), "down2_5");
    }
}
