//! The embedding space and the aggression line.

use super::{Run, printed};
use crate::{
    atomic_write::if_there,
    error::StudyError,
    run_folder::{MODEL_FILE, embeddings_path},
    stages::report::keys::short,
    tables::{
        conditions::ConditionRow,
        embeddings::{EmbeddingRow, read_embeddings},
    },
};
use maveric_analysis::{AggressionLine as Line, LineRow};
use maveric_domain::{ConditionId, DriveId, MetresPerSecond, design::Condition};
use maveric_model::Model;
use maveric_model::style_space::{LinearHead, PerpendicularEllipse};
use maveric_pages::words::{correlation, with_unit};
use maveric_report::{
    claims::LedgerRow,
    figures::{
        aggression_line::{AggressionLine, LinePanel, aggression_line},
        embedding_space::{EmbeddingPoint, EmbeddingSpace, ExampleConditions, embedding_space},
    },
    html::{Live, LiveContent, Section, SpaceDrive, SpacePerson, StyleSpace},
    markup,
    tables::{Cell, Table},
};
use std::path::Path;

/// Number of points in which an ellipse is drawn.
const ELLIPSE_POINTS: usize = 72;

/// `None` for a study without a style or without a model.
pub(super) fn section_embedding(
    folder: &Path,
    run: &Run,
    ledger: &[LedgerRow],
) -> Result<Option<Section>, StudyError> {
    let (Some(model), Some(line)) = (&run.model, &run.analysis.line) else {
        return Ok(None);
    };
    let axis = LinearHead::aggression(model)?;
    let mut points = Vec::new();
    for row in trained(folder)? {
        if let (Some(score_points), Some(mean_velocity_mps)) = (row.adb, speed_of(run, &row.drive))
        {
            points.push(EmbeddingPoint {
                embedding: row.embedding.coordinates().to_vec(),
                score_points,
                mean_velocity_mps,
            });
        }
    }
    let score = run.style_label();
    let space = EmbeddingSpace {
        points,
        gradient: axis.gradient().to_vec(),
        score_range: run.score_range().unwrap_or((0.0, 1.0)),
        score: score.to_owned(),
        example: example(run, model)?,
    };
    let lines = line_panels(line);
    let mut intro = vec![format!(
        "The embeddings of the test participants were fitted with their {score}; the line’s correlation with \
         it is then partly built in, so the table shows the fit without the score beside it."
    )];
    intro.extend(step_of_the_dial(&run.conditions, score));
    let mut figures = Vec::new();
    if space.points.is_empty() && run.training.is_none() {
        intro.push(
            "The model was learned elsewhere, and the drives that it learned from are not here."
                .to_owned(),
        );
    } else if space.points.is_empty() {
        intro.push(format!(
            "No training drive has both a score ({score}) and a mean velocity: there is no space to draw."
        ));
    } else {
        figures.push(embedding_space(&space, &run.context)?);
    }
    if lines.panels.is_empty() {
        intro.push("No participant is left along the line: there is nothing to draw.".to_owned());
    } else {
        figures.push(aggression_line(&lines, &run.context)?);
    }
    Ok(Some(Section {
        title: "Does the embedding hold a driver’s style?".to_owned(),
        intro,
        figures,
        tables: std::iter::once(line_table(run, line, ledger))
            .chain(steps_table(run))
            .collect(),
    }))
}

/// The position on the line against each measure.
fn line_table(run: &Run, line: &Line, ledger: &[LedgerRow]) -> Table {
    let paper = |row: &LineRow| printed(ledger, &format!("line.{}.r", short(&row.measure)));
    let without = |row: &LineRow| {
        let mut others = run.analysis.line_without_adb.as_ref()?.rows.iter();
        let other = others.find(|r| r.measure == row.measure)?;
        other.correlation.statement()
    };
    let reported = line.rows.iter().any(|row| paper(row).is_some());
    Table::of(
        "embedding-line",
        "Position on the line against each measure",
        &line.rows,
    )
    .text("Measure", |row| &row.title)
    .left("Here", |row| {
        Cell::said(row.correlation.statement().as_ref())
    })
    .left("Here, fitted without *L*_{4}", |row| {
        Cell::said(without(row).as_ref())
    })
    .and_if(reported, |table| {
        table.left("Paper", |row| Cell::said(paper(row).as_ref()))
    })
    .noted(format!(
        "*n* = {} test participants. With *L*_{{4}} the score itself ({}) takes part in \
             fitting the embedding, so its own correlation is partly built in: the third column \
             leaves it out.",
        run.analysis.participants,
        markup::literal(run.style_label())
    ))
}

/// How far the dial moved people, condition by condition: what was meant, and what was reached before an end of the scale.
pub(super) fn steps(run: &Run) -> Vec<(ConditionId, Vec<f64>, usize)> {
    let mut found: Vec<(ConditionId, Vec<f64>, usize)> = Vec::new();
    let turned = run
        .design
        .conditions()
        .iter()
        .filter(|c| c.dial().is_some_and(|d| d != 0.0));
    for condition in turned {
        let rows = || {
            run.conditions
                .iter()
                .filter(|r| r.condition == condition.id)
        };
        let moved: Vec<f64> = rows().filter_map(|r| r.moved_points).collect();
        if !moved.is_empty() {
            found.push((condition.id, moved, rows().filter(|r| r.clamped).count()));
        }
    }
    found
}

fn steps_table(run: &Run) -> Option<Table> {
    let steps = steps(run).into_iter().map(|(condition, moved, clamped)| {
        let values: Vec<Option<f64>> = moved.iter().copied().map(Some).collect();
        let shape = maveric_stats::normality(&values).ok();
        (
            condition,
            moved.len(),
            clamped,
            shape.map(|found| found.desc),
        )
    });
    let steps: Vec<_> = steps.collect();
    if steps.is_empty() {
        return None;
    }
    let meant = |id| run.design.condition(id).and_then(Condition::dial);
    let table = Table::of("dial-steps", "How far the dial was turned", &steps)
        .text("Condition", |step| run.design.label(step.0))
        .right("Meant", |step| Cell::number(meant(step.0), 0))
        .right("*n*", |step| Cell::count(step.1))
        .right("Cut short", |step| Cell::count(step.2))
        .right("*M*", |step| Cell::number(step.3.as_ref().map(|s| s.mean), 1))
        .right("*SD*", |step| Cell::number(step.3.as_ref().and_then(|s| s.sd), 1))
        .right("Lowest", |step| Cell::number(step.3.as_ref().map(|s| s.min), 1))
        .right("Highest", |step| Cell::number(step.3.as_ref().map(|s| s.max), 1))
        .noted(format!(
            "In points of {}, as the model reads them. Cut short: an end of the scale lay nearer than what was meant.",
            run.style_label()
        ));
    Some(table)
}

/// How sure a step of the dial is, and how often the scale's end cut it short; `None` where nothing is known of that.
fn step_of_the_dial(conditions: &[ConditionRow], score: &str) -> Option<String> {
    let steps = conditions
        .iter()
        .filter_map(|c| Some((c.moved_points?.abs(), c.moved_points_sd?)));
    let (points, sd) = steps.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let clamped = conditions.iter().filter(|c| c.clamped).count();
    (points > 0.0).then(|| {
        format!(
            "A step of {points:.0} points of {score} is known to within {:.0} points (95%: bootstrap over the people learned from); {clamped} of \
             {} settings ended at an end of the scale.",
            1.96 * sd,
            conditions.len()
        )
    })
}

/// The embeddings of the training drives; none where the model was learned elsewhere.
fn trained(folder: &Path) -> Result<Vec<EmbeddingRow>, StudyError> {
    if_there(&embeddings_path(&folder.join(MODEL_FILE)), read_embeddings)
}

fn speed_of(run: &Run, drive: &DriveId) -> Option<f64> {
    let measured = run.measured.iter().find(|d| d.meta.drive == *drive)?;
    measured.values.get("mean_velocity_mps").copied().flatten()
}

/// The space to be turned by hand; `None` unless it has three dimensions.
pub(super) fn live(folder: &Path, run: &Run) -> Result<Option<Live>, StudyError> {
    let tested = folder.join("embeddings.csv");
    let (Some(model), Some((low, high)), true) = (&run.model, run.score_range(), tested.is_file())
    else {
        return Ok(None);
    };
    let solid = |values: &[f64]| <[f64; 3]>::try_from(values).ok();
    let axis = LinearHead::aggression(model)?;
    let Some(gradient) = solid(axis.gradient()) else {
        return Ok(None);
    };
    let drive = |row: &EmbeddingRow, name: String| {
        Some(SpaceDrive {
            name,
            at: solid(row.embedding.coordinates())?,
            score_points: row.adb,
            velocity_mph: MetresPerSecond(speed_of(run, &row.drive)?).mph(),
        })
    };
    let (trained, tested) = (trained(folder)?, read_embeddings(&tested)?);
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
    let own = |row: &&EmbeddingRow| row.adb_used && Some(row.condition) == run.design.baseline_id();
    let round = run.across().map(|_| PerpendicularEllipse::of(model));
    let ellipse = round.transpose()?.map(|round| {
        [0, 1].map(|i| {
            let (axis, half) = (&round.axes()[i], round.half_axes()[i]);
            std::array::from_fn(|k| axis[k] * half)
        })
    });
    let space = StyleSpace {
        drives: trained
            .iter()
            .filter_map(|row| drive(row, row.drive.to_string()))
            .collect(),
        people: tested.iter().filter(own).filter_map(person).collect(),
        gradient,
        ellipse,
        score: (low, high, run.style_label().to_owned()),
        dial: along_the_dial(run),
    };
    Ok(Some(Live {
        below: "embedding-space".to_owned(),
        content: LiveContent::StyleSpace(space),
    }))
}

/// The conditions on the dial, from the low end to the high one.
fn along_the_dial(run: &Run) -> Vec<ConditionId> {
    let mut dials: Vec<(f64, ConditionId)> = run
        .design
        .conditions()
        .iter()
        .filter_map(|c| Some((c.dial()?, c.id)))
        .collect();
    dials.sort_by(|a, b| a.0.total_cmp(&b.0));
    dials.into_iter().map(|(_, id)| id).collect()
}

/// The row at 0 on the dial of the participant whose conditions are shown: the one nearest to the middle of the line shows both directions
/// best; without such a condition the first row there is.
pub(super) fn shown_participant(run: &Run) -> Option<&ConditionRow> {
    let (low, high) = run.score_range().unwrap_or_default();
    let middle = f64::midpoint(low, high);
    let from_middle = |row: &ConditionRow| {
        row.adb_hat
            .map_or(f64::INFINITY, |hat| (hat - middle).abs())
    };
    let own = run.own_style();
    let rows = run.conditions.iter();
    let rows = rows.filter(|c| own.is_none_or(|own| c.condition == own));
    rows.min_by(|a, b| from_middle(a).total_cmp(&from_middle(b)))
}

fn example(run: &Run, model: &Model) -> Result<Option<ExampleConditions>, StudyError> {
    let Some(own) = shown_participant(run) else {
        return Ok(None);
    };
    let mine = run
        .conditions
        .iter()
        .filter(|c| c.participant == own.participant);
    let mut ellipse = Vec::new();
    if run.across().is_some() {
        let round = PerpendicularEllipse::of(model)?;
        for i in 0..ELLIPSE_POINTS {
            let angle = std::f64::consts::TAU * i as f64 / ELLIPSE_POINTS as f64;
            let found = round.at_angle(&own.embedding, angle)?;
            ellipse.push(found.embedding.coordinates().to_vec());
        }
    }
    Ok(Some(ExampleConditions {
        participant: own.participant.to_string(),
        conditions: mine
            .map(|c| (c.condition, c.embedding.coordinates().to_vec()))
            .collect(),
        ellipse,
    }))
}

fn line_panels(line: &Line) -> AggressionLine {
    let panel = |row: &LineRow| LinePanel {
        title: row.title.clone(),
        axis: with_unit(&row.title, &row.unit),
        points: row.points.clone(),
        statistic: correlation(&row.correlation),
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
