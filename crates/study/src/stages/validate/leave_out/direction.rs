//! Where the dial points, beside where a person's own drives of two roles differ.

use super::{
    Bench,
    folds::{Fold, Learning, first_in},
    role_of,
};
use crate::{
    error::StudyError,
    mean::column_means,
    outcome::{Watch, for_each_on},
    recordings::Recorded,
    run_folder::read_scenario,
    stages::simulate::drive_style,
};
use maveric_domain::{
    ConditionId, Drive, DriveId, DriveMeta, DrivenBy, Embedding, ParticipantId, stream_seed,
};
use maveric_measures::objective::{self, median_time_gap_s};
use maveric_model::style_space::LinearHead;
use maveric_rehearsal::leave_out::{
    AXES, Change, Direction, Missing, Pointed, Uncounted, between_people, direction,
};

/// What a drive is like: mean speed, time gap, gap when moving out, lane changes a minute.
fn axes(drive: &Drive) -> Change {
    let measure = |name: &str| objective::find(name).and_then(|m| m.of(drive));
    let minutes = drive.len() as f64 / drive.rate_hz() / 60.0;
    let changes = drive.has_lateral().then(|| drive.lane_changes().len() as f64 / minutes);
    [
        measure("mean_velocity_mps"),
        median_time_gap_s(drive),
        measure("mean_headway_time_s"),
        changes,
    ]
}

/// Each part over its spread between people; empty where one side has none.
fn change(higher: &Change, lower: &Change, spread: &Change) -> Change {
    let mut change = [None; AXES];
    for (axis, part) in change.iter_mut().enumerate() {
        let both = higher[axis].zip(lower[axis]).zip(spread[axis]);
        *part = both.map(|((higher, lower), sd)| (higher - lower) / sd);
    }
    change
}

/// A style to be driven for somebody.
struct Ride<'f> {
    fold: &'f Fold,
    embedding: Embedding,
    world: usize,
}

/// One person of whom it is asked.
struct Judged<'f> {
    fold: &'f Fold,
    own: Change,
    spread: Change,
    step: Vec<f64>,
    /// How far the car is moved along each coordinate to see what it does.
    reach: f64,
}

/// Drives the car of everybody who is judged at the own style, with the dial turned, and to both sides along each coordinate of the
/// style; gives whoever lacks a drive as well.
pub(super) fn pointing(
    bench: &Bench<'_>,
    learning: &Learning<'_>,
    folds: &[Fold],
    rows: &[&Recorded],
    watch: Watch<'_>,
) -> Result<(Direction, Vec<Uncounted>), StudyError> {
    let (table, options) = (bench.table, bench.options);
    let (higher, lower) = (role_of(table.higher)?, role_of(table.lower.first().copied())?);
    let measured: Vec<Change> = rows.iter().map(|r| axes(&r.drive)).collect();
    let points = table.points.unwrap_or(options.points);
    let (mut judged, mut rides, mut uncounted) = (Vec::new(), Vec::new(), Vec::new());
    for fold in folds {
        if !table.judged.is_empty() && !table.judged.contains(&fold.person) {
            continue;
        }
        let (above, below, own_style) = match placed(learning, fold, higher, lower) {
            Ok(place) => place,
            Err(why) => {
                uncounted.push(Uncounted { participant: fold.person.clone(), why });
                continue;
            }
        };
        let mut spread = [None; AXES];
        for (axis, part) in spread.iter_mut().enumerate() {
            let values: Vec<Option<f64>> = measured.iter().map(|m| m[axis]).collect();
            *part = between_people(&learning.drove, &values, &fold.person).map(|(_, sd)| sd);
        }
        let gradient = LinearHead::aggression(&fold.model)?.gradient().to_vec();
        let square: f64 = gradient.iter().map(|g| g * g).sum();
        // The ends of the scale stop a dial and not a direction.
        let step: Vec<f64> = gradient.iter().map(|g| points * g / square).collect();
        let reach = points.abs() / square.sqrt();
        for embedding in turned(own_style, &step, reach)? {
            rides.extend((0..options.worlds).map(|world| Ride {
                fold,
                embedding: embedding.clone(),
                world,
            }));
        }
        judged.push(Judged {
            fold,
            own: change(&measured[above], &measured[below], &spread),
            spread,
            step,
            reach,
        });
    }
    let scenario = read_scenario(options.scenario.as_deref(), options.duration_s)?;
    let driven = for_each_on(options.jobs, &rides, watch, "drives", |ride| {
        let who = ride.fold.person.as_str();
        let world = stream_seed(options.seed, &[who, "direction", &ride.world.to_string()]);
        let done = drive_style(&ride.fold.model, &ride.embedding, &scenario, world)?.completed()?;
        let meta = DriveMeta::new(
            DriveId::new(format!("{who}-direction"))?,
            ride.fold.person.clone(),
            lower,
            DrivenBy::Automated,
        );
        Ok(axes(&Drive::from_recording(meta, &done.recording)?))
    })?;
    let mut driven = driven.chunks_exact(options.worlds).map(column_means);
    let mut pointed = Vec::new();
    for judged in judged {
        let mut next = || driven.next().unwrap_or([None; AXES]);
        let (still, turned) = (next(), next());
        let mut response = Vec::new();
        for _ in 0..judged.step.len() {
            let (up, down) = (next(), next());
            let both = change(&up, &down, &judged.spread);
            response.push(both.map(|part| part.map(|c| c / (2.0 * judged.reach))));
        }
        pointed.push(Pointed {
            participant: judged.fold.person.clone(),
            own: judged.own,
            dial: change(&turned, &still, &judged.spread),
            step: judged.step,
            response,
        });
    }
    let directions = table.directions.unwrap_or_default();
    let result = direction(&pointed, directions, options.seed)?;
    let apart = result.people.iter().filter(|p| p.cosine.is_none());
    uncounted.extend(
        apart.map(|p| Uncounted { participant: p.participant.clone(), why: Missing::Change }),
    );
    Ok((result, uncounted))
}

/// A style as it is, moved by a step of the dial, and by `reach` to both sides along each coordinate.
fn turned(own_style: &Embedding, step: &[f64], reach: f64) -> Result<Vec<Embedding>, StudyError> {
    let moved = |by: &[f64]| -> Result<Embedding, StudyError> {
        let coordinates = own_style.coordinates().iter().zip(by);
        Ok(Embedding::new(coordinates.map(|(w, s)| w + s).collect())?)
    };
    let mut styles = vec![own_style.clone(), moved(step)?];
    for coordinate in 0..step.len() {
        for side in [1.0, -1.0] {
            let mut by = vec![0.0; step.len()];
            by[coordinate] = side * reach;
            styles.push(moved(&by)?);
        }
    }
    Ok(styles)
}

/// Where a person's two drives stand, and the style of the ordinary one.
fn placed<'f>(
    learning: &Learning<'_>,
    fold: &'f Fold,
    higher: ConditionId,
    lower: ConditionId,
) -> Result<(usize, usize, &'f Embedding), Missing> {
    let drive_in = |who: &ParticipantId, role: ConditionId| {
        first_in(&learning.drove, who, role).ok_or(Missing::Drive { role })
    };
    let (above, below) = (drive_in(&fold.person, higher)?, drive_in(&fold.person, lower)?);
    let ordinary = fold.fitted[below].as_ref().ok_or_else(|| Missing::Reading {
        drive: learning.drove[below].drive.clone(),
        by: maveric_rehearsal::leave_out::By::Line,
    })?;
    Ok((above, below, &ordinary.embedding))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_in_spreads_and_empty_where_a_side_was_not_measured() {
        let higher = [Some(30.0), Some(1.0), None, Some(2.0)];
        let lower = [Some(26.0), Some(1.5), Some(2.0), Some(1.0)];
        let spread = [Some(2.0), Some(0.25), Some(0.5), None];
        let found = change(&higher, &lower, &spread);
        assert_eq!(found, [Some(2.0), Some(-2.0), None, None]);
        let roads = [[Some(1.0), None, None, Some(3.0)], [Some(2.0), None, Some(5.0), None]];
        assert_eq!(column_means(&roads), [Some(1.5), None, Some(5.0), Some(3.0)]);
    }
}
