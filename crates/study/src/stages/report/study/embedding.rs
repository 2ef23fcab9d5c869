//! The embedding space and the aggression line.

use super::Run;
use crate::{
    atomic_write::if_there,
    beyond::own_drives,
    error::StudyError,
    run_folder::{MODEL_FILE, embeddings_path},
    tables::{
        conditions::ConditionRow,
        embeddings::{EmbeddingRow, read_embeddings},
    },
};
use maveric_domain::{ConditionId, DriveId, ParticipantId};
use maveric_model::Model;
use maveric_model::style_space::{LinearHead, PerpendicularEllipse};
use maveric_pages::study::{StudyPage, line_panels};
use maveric_report::{
    figures::{
        aggression_line::aggression_line,
        embedding_space::{EmbeddingPoint, EmbeddingSpace, ExampleConditions, embedding_space},
    },
    html::{Live, LiveContent, Section, SpaceDrive, SpacePerson, StyleSpace},
};
use maveric_stats::HALF_95;
use serde::Serialize;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// Number of points in which an ellipse is drawn.
const ELLIPSE_POINTS: usize = 72;

/// `None` for a study without a style or without a model.
pub(super) fn section_embedding(
    folder: &Path,
    run: &Run,
    page: &StudyPage<'_>,
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
    let space = EmbeddingSpace {
        points,
        gradient: axis.gradient().to_vec(),
        score_range: run.score_range().unwrap_or((0.0, 1.0)),
        score: run.style_label().to_owned(),
        example: example(folder, run, model)?,
    };
    let lines = line_panels(line);
    let values = SpaceValues {
        space: !space.points.is_empty(),
        along: !lines.panels.is_empty(),
        step: step_of_the_dial(&run.conditions),
    };
    let mut figures = Vec::new();
    if values.space {
        figures.push(embedding_space(&space, &run.context)?);
    }
    if values.along {
        figures.push(aggression_line(&lines, &run.context)?);
    }
    let tables = page.line_tables(line, &run.conditions)?;
    let texts = page.texts.with(&values);
    Ok(Some(texts.section("embedding", figures, tables)?))
}

/// What the section says before its figures.
#[derive(Serialize)]
struct SpaceValues {
    /// Whether there is a space to draw.
    space: bool,
    /// Whether somebody is left along the line.
    along: bool,
    step: Option<Step>,
}

/// How sure a step of the dial is, and how often the scale's end cut it short.
#[derive(Serialize)]
struct Step {
    points: f64,
    /// Half of its 95 % interval, in points.
    within: f64,
    clamped: usize,
    settings: usize,
}

/// The longest step; `None` where nothing is known of it.
fn step_of_the_dial(conditions: &[ConditionRow]) -> Option<Step> {
    let steps = conditions.iter().filter_map(|c| Some((c.moved_points?.abs(), c.moved_points_sd?)));
    let (points, sd) = steps.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (points > 0.0).then(|| Step {
        points,
        within: HALF_95 * sd,
        clamped: conditions.iter().filter(|c| c.clamped).count(),
        settings: conditions.len(),
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
            velocity_mps: speed_of(run, &row.drive)?,
        })
    };
    let (trained, tested) = (trained(folder)?, read_embeddings(&tested)?);
    let person = |row: &EmbeddingRow| {
        let mine = run.conditions.iter().filter(|c| c.participant == row.participant);
        let placed = mine.filter_map(|c| Some((c.condition, solid(c.embedding.coordinates())?)));
        Some(SpacePerson {
            own: drive(row, row.participant.to_string())?,
            conditions: placed.collect(),
        })
    };
    let round = run.design.across().map(|_| PerpendicularEllipse::of(model));
    let ellipse = round.transpose()?.map(|round| {
        [0, 1].map(|i| {
            let (axis, half) = (&round.axes()[i], round.half_axes()[i]);
            std::array::from_fn(|k| axis[k] * half)
        })
    });
    let space = StyleSpace {
        drives: trained.iter().filter_map(|row| drive(row, row.drive.to_string())).collect(),
        people: first_by_hand(&tested, run.design.baseline_id()).filter_map(person).collect(),
        gradient,
        ellipse,
        score: (low, high, run.style_label().to_owned()),
        dial: along_the_dial(run),
    };
    Ok(Some(Live { below: "embedding-space".to_owned(), content: LiveContent::StyleSpace(space) }))
}

/// Each person’s first drive of the baseline in the first session: that of a later one sets no condition.
fn first_by_hand(
    tested: &[EmbeddingRow],
    baseline: Option<ConditionId>,
) -> impl Iterator<Item = &EmbeddingRow> {
    let mut met = BTreeSet::new();
    let own = baseline.map(|baseline| own_drives(tested, baseline));
    let own = own.into_iter().flatten().filter(|row| row.adb_used);
    own.filter(move |row| met.insert(&row.participant))
}

/// The conditions on the dial, from the low end to the high one.
fn along_the_dial(run: &Run) -> Vec<ConditionId> {
    let mut dials: Vec<(f64, ConditionId)> =
        run.design.conditions().iter().filter_map(|c| Some((c.dial()?, c.id))).collect();
    dials.sort_by(|a, b| a.0.total_cmp(&b.0));
    dials.into_iter().map(|(_, id)| id).collect()
}

/// The row at 0 on the dial of the participant whose conditions are shown, as [`most_placed`] finds it; without such a condition the first
/// row there is. Of those with a log of it, where anybody has one: drives of others cannot be played.
pub(super) fn shown_participant<'a>(folder: &Path, run: &'a Run) -> Option<&'a ConditionRow> {
    let (low, high) = run.score_range().unwrap_or_default();
    let own_style = run.design.own_style();
    let rows = run.conditions.iter();
    let rows: Vec<&ConditionRow> =
        rows.filter(|c| own_style.is_none_or(|id| c.condition == id)).collect();
    let logged = |c: &&&ConditionRow| av_log(folder, &c.participant, c.condition).is_file();
    let any = rows.iter().any(|c| logged(&c));
    let rows = rows.into_iter().filter(|c| !any || logged(&c));
    most_placed(rows, &run.conditions, f64::midpoint(low, high))
}

/// Of these rows that of a person for whom most conditions were placed: of several the one nearest to the middle of the line, who shows both
/// directions best.
fn most_placed<'a>(
    rows: impl Iterator<Item = &'a ConditionRow>,
    all: &[ConditionRow],
    middle: f64,
) -> Option<&'a ConditionRow> {
    let placed = |row: &ConditionRow| {
        let theirs = all.iter().filter(|r| r.participant == row.participant);
        theirs.count()
    };
    let from_middle =
        |row: &ConditionRow| row.adb_hat.map_or(f64::INFINITY, |hat| (hat - middle).abs());
    rows.min_by(|a, b| {
        let most = placed(b).cmp(&placed(a));
        most.then(from_middle(a).total_cmp(&from_middle(b)))
    })
}

/// Where `simulate` writes the log of a participant's drive.
pub(super) fn av_log(folder: &Path, who: &ParticipantId, condition: ConditionId) -> PathBuf {
    folder.join(format!("av/logs/{who}-{condition}.mcap"))
}

fn example(
    folder: &Path,
    run: &Run,
    model: &Model,
) -> Result<Option<ExampleConditions>, StudyError> {
    let Some(shown) = shown_participant(folder, run) else {
        return Ok(None);
    };
    let mine = run.conditions.iter().filter(|c| c.participant == shown.participant);
    let mut ellipse = Vec::new();
    if run.design.across().is_some() {
        let round = PerpendicularEllipse::of(model)?;
        for i in 0..ELLIPSE_POINTS {
            let angle = std::f64::consts::TAU * i as f64 / ELLIPSE_POINTS as f64;
            let point = round.at_angle(&shown.embedding, angle)?;
            ellipse.push(point.embedding.coordinates().to_vec());
        }
    }
    Ok(Some(ExampleConditions {
        participant: shown.participant.to_string(),
        conditions: mine.map(|c| (c.condition, c.embedding.coordinates().to_vec())).collect(),
        ellipse,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::Embedding;

    #[test]
    fn a_person_of_two_sessions_is_there_once_by_the_first_drive() {
        let row = |who: &str, drive: &str, at: f64, adb_used| EmbeddingRow {
            adb_used,
            ..EmbeddingRow::new(
                DriveId::new(drive).unwrap(),
                ParticipantId::new(who).unwrap(),
                "own".parse().unwrap(),
                Embedding::new(vec![at]).unwrap(),
            )
        };
        let later = |who: &str, drive: &str, at: f64| EmbeddingRow {
            session: std::num::NonZeroU32::new(2).unwrap(),
            ..row(who, drive, at, true)
        };
        let rows = [
            later("P00", "P00-own_s2_t1", 0.5),
            row("P01", "P01-own", 1.0, true),
            row("P01", "P01-own", 1.5, false),
            later("P01", "P01-own_s2_t1", 2.0),
            row("P02", "P02-own", 3.0, true),
        ];
        let drives = |baseline| {
            let rows = first_by_hand(&rows, baseline);
            rows.map(|row| row.drive.as_str()).collect::<Vec<_>>()
        };
        assert_eq!(drives("own".parse().ok()), ["P01-own", "P02-own"]);
        assert!(drives("calm".parse().ok()).is_empty());
        assert!(drives(None).is_empty());
    }

    fn row(who: &str, condition: &str, hat: f64) -> ConditionRow {
        ConditionRow {
            adb_hat: Some(hat),
            ..ConditionRow::new(
                ParticipantId::new(who).unwrap(),
                condition.parse().unwrap(),
                Embedding::new(vec![0.5]).unwrap(),
            )
        }
    }

    #[test]
    fn whoever_has_every_condition_is_shown_before_whoever_is_nearest_to_the_middle() {
        let both = |who: &str, hat: f64| [row(who, "mine", hat), row(who, "sporty", hat + 5.0)];
        let shown = |rows: &[ConditionRow]| {
            let mine = rows.iter().filter(|r| r.condition.as_str() == "mine");
            let found = most_placed(mine, rows, 30.0).unwrap();
            found.participant.to_string()
        };
        let near = row("P1", "mine", 30.0);
        let [far, farther] = [both("P2", 25.0), both("P3", 40.0)];
        let all = [&[near][..], &farther, &far].concat();
        assert_eq!(shown(&all), "P2");
        assert_eq!(shown(&all[..1]), "P1");
    }
}
