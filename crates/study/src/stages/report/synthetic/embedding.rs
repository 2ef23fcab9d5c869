//! The second section: the embedding space and the aggression line.

use super::{Run, printed, said, statement};
use crate::{
    error::StudyError,
    stages::{
        report::keys::short,
        train::{MODEL_FILE, embeddings_path},
    },
    tables::{
        conditions::ConditionRow,
        embeddings::{EmbeddingRow, read_embeddings},
    },
};
use maveric_analysis::{AggressionLine as Line, LineRow};
use maveric_domain::{ConditionId, DriveId, MetresPerSecond};
use maveric_model::style_space::{AggressionAxis, PerpendicularEllipse};
use maveric_report::{
    claims::LedgerRow,
    figures::{
        aggression_line::{AggressionLine, LinePanel, aggression_line},
        embedding_space::{EmbeddingPoint, EmbeddingSpace, ExampleConditions, embedding_space},
    },
    html::{Live, LiveContent, Section, SpaceDrive, SpacePerson, StyleSpace},
    tables::{self, LineCorrelation},
};
use std::path::Path;

/// Number of points in which an ellipse is drawn.
const ELLIPSE_POINTS: usize = 72;

pub(super) fn section_embedding(
    folder: &Path,
    run: &Run,
    ledger: &[LedgerRow],
) -> Result<Section, StudyError> {
    let axis = AggressionAxis::of(&run.model)?;
    let mut points = Vec::new();
    for row in read_embeddings(&embeddings_path(&folder.join(MODEL_FILE)))? {
        if let (Some(adb_points), Some(mean_velocity_mps)) = (row.adb, speed_of(run, &row.drive)) {
            points.push(EmbeddingPoint {
                embedding: row.embedding.coordinates().to_vec(),
                adb_points,
                mean_velocity_mps,
            });
        }
    }
    let space = EmbeddingSpace {
        points,
        gradient: axis.gradient().to_vec(),
        example: example(run)?,
    };
    let lines = line_panels(&run.analysis.line);
    let rows: Vec<LineCorrelation> = run
        .analysis
        .line
        .rows
        .iter()
        .zip(&run.analysis.line_without_adb.rows)
        .map(|(with, without)| LineCorrelation {
            measure: with.title.clone(),
            ours: statement(&with.correlation),
            without_style_loss: statement(&without.correlation),
            paper: printed(ledger, &format!("line.{}.r", short(&with.measure))),
        })
        .collect();
    let mut intro = vec![
        "The embeddings of the test participants were fitted with their ADB score, as the paper does; the line’s correlation with \
         ADB is then partly built in, so the table shows the fit without the score beside it."
            .to_owned(),
    ];
    let mut figures = Vec::new();
    if space.points.is_empty() {
        intro.push("No training drive has both an ADB score and a mean velocity: there is no space to draw.".to_owned());
    } else {
        figures.push(embedding_space(&space, &run.context)?);
    }
    if lines.panels.is_empty() {
        intro.push(
            "No participant is left along the aggression line: there is nothing to draw."
                .to_owned(),
        );
    } else {
        figures.push(aggression_line(&lines, &run.context)?);
    }
    Ok(Section {
        title: "Does the embedding hold a driver’s style?".to_owned(),
        intro,
        figures,
        tables: vec![tables::embedding_line(&rows, run.analysis.participants)],
    })
}

fn speed_of(run: &Run, drive: &DriveId) -> Option<f64> {
    let measured = run.measured.iter().find(|d| d.meta.drive == *drive)?;
    measured.values.get("mean_velocity_mps").copied().flatten()
}

/// The space to be turned by hand; `None` unless it has three dimensions.
pub(super) fn live(folder: &Path, run: &Run) -> Result<Option<Live>, StudyError> {
    let solid = |values: &[f64]| <[f64; 3]>::try_from(values).ok();
    let axis = AggressionAxis::of(&run.model)?;
    let Some(gradient) = solid(axis.gradient()) else {
        return Ok(None);
    };
    let drive = |row: &EmbeddingRow, name: String| {
        Some(SpaceDrive {
            name,
            at: solid(row.embedding.coordinates())?,
            adb_points: row.adb,
            velocity_mph: MetresPerSecond(speed_of(run, &row.drive)?).mph(),
        })
    };
    let trained = read_embeddings(&embeddings_path(&folder.join(MODEL_FILE)))?;
    let tested = read_embeddings(&folder.join("embeddings.csv"))?;
    let person = |row: &EmbeddingRow| {
        let mine = run
            .conditions
            .iter()
            .filter(|c| c.participant == row.participant);
        let placed = mine.filter_map(|c| Some((c.condition, solid(c.embedding.coordinates())?)));
        Some(SpacePerson {
            own: drive(row, row.participant.to_string())?,
            conditions: placed.collect(),
        })
    };
    let own = |row: &&EmbeddingRow| row.adb_used && row.condition == ConditionId::OWN;
    let round = PerpendicularEllipse::of(&run.model)?;
    let half_axis = |i: usize| {
        let (axis, half) = (&round.axes()[i], round.half_axes()[i]);
        std::array::from_fn(|k| axis[k] * half)
    };
    let space = StyleSpace {
        drives: trained
            .iter()
            .filter_map(|row| drive(row, row.drive.to_string()))
            .collect(),
        people: tested.iter().filter(own).filter_map(person).collect(),
        gradient,
        ellipse: [half_axis(0), half_axis(1)],
    };
    Ok(Some(Live {
        below: "embedding-space".to_owned(),
        content: LiveContent::StyleSpace(space),
    }))
}

/// Mimic of the participant whose conditions are shown: the one nearest to the middle of the line shows both directions best.
pub(super) fn shown_participant(run: &Run) -> Option<&ConditionRow> {
    let middle = f64::midpoint(maveric_domain::AdbScore::MIN, maveric_domain::AdbScore::MAX);
    let from_middle = |row: &ConditionRow| (row.adb_hat - middle).abs();
    let mimic = run
        .conditions
        .iter()
        .filter(|c| c.condition == ConditionId::MIMIC);
    mimic.min_by(|a, b| from_middle(a).total_cmp(&from_middle(b)))
}

fn example(run: &Run) -> Result<Option<ExampleConditions>, StudyError> {
    let Some(own) = shown_participant(run) else {
        return Ok(None);
    };
    let of = |condition| {
        let mine = |c: &&ConditionRow| c.participant == own.participant && c.condition == condition;
        run.conditions
            .iter()
            .find(mine)
            .map(|c| c.embedding.coordinates().to_vec())
    };
    let (Some(aggressive), Some(cautious)) =
        (of(ConditionId::AGGRESSIVE), of(ConditionId::CAUTIOUS))
    else {
        return Ok(None);
    };
    let round = PerpendicularEllipse::of(&run.model)?;
    let at = |i: usize| -> Result<Vec<f64>, StudyError> {
        let angle = std::f64::consts::TAU * i as f64 / ELLIPSE_POINTS as f64;
        Ok(round
            .at_angle(&own.embedding, angle)?
            .embedding
            .coordinates()
            .to_vec())
    };
    Ok(Some(ExampleConditions {
        participant: own.participant.to_string(),
        mimic: own.embedding.coordinates().to_vec(),
        aggressive,
        cautious,
        perpendicular: of(ConditionId::PERPENDICULAR),
        ellipse: (0..ELLIPSE_POINTS).map(at).collect::<Result<_, _>>()?,
    }))
}

fn line_panels(line: &Line) -> AggressionLine {
    let panel = |row: &LineRow| {
        let (axis, scale) = match row.measure.as_str() {
            "mean_velocity_mps" => ("Mean velocity (mph)".to_owned(), MetresPerSecond(1.0).mph()),
            "adb" => ("ADB score (points)".to_owned(), 1.0),
            "lane_changes" => ("Lane changes".to_owned(), 1.0),
            measure if measure.ends_with("_m") => (format!("{} (m)", row.title), 1.0),
            _ => (format!("{} (s)", row.title), 1.0),
        };
        LinePanel {
            title: row.title.clone(),
            axis,
            points: row.points.iter().map(|(x, y)| (*x, y * scale)).collect(),
            statistic: said(&row.correlation),
        }
    };
    AggressionLine {
        panels: line
            .rows
            .iter()
            .filter(|r| !r.points.is_empty())
            .map(panel)
            .collect(),
    }
}
