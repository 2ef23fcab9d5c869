//! The one vehicle ahead in ego's lane, as a camera or a radar with one target tells it.

use super::{
    super::{Gaps, open::Kind, pair::bumper_gap_m},
    path::DrivenPath,
    place::Place,
    rows::Files,
};
use crate::{
    error::IngestError,
    mapping::{LeadSignal, TableMapping},
    quality::{Warning, WarningKind, report},
    raw::{LEADER, ObjectSample, ObjectSamples, Sighting, Sightings},
};

/// A vehicle unseen for longer than this is another one, in s.
const UNSEEN_S: f64 = 1.0;
/// One whose gap jumps further than this between two rows is another one, in m.
const JUMP_M: f64 = 5.0;
/// And further than this share of the gap: a camera is the less sure the further away it looks.
const JUMP_SHARE: f64 = 0.1;
/// Half the time over which the change of the gap tells the vehicle's speed, in s: a camera's gap wanders by some decimetres.
const HALF_WINDOW_S: f64 = 1.0;

/// The vehicles ahead, one after another.
#[derive(Debug, Default)]
pub(super) struct Leads {
    pub(super) objects: ObjectSamples,
    /// When somebody looked, whoever was there.
    pub(super) sightings: Sightings,
    pub(super) gaps: Gaps,
}

/// One row with a vehicle ahead.
struct Seen {
    stamp_ns: i64,
    gap_m: f64,
    speed_mps: Option<f64>,
    vehicle: u32,
}

/// Reads the vehicles ahead. Each is in the lane that ego is in: after a lane change it is another one.
pub(super) fn read(
    files: &mut Files<'_>,
    signal: &LeadSignal,
    mapping: &TableMapping,
    driven: &DrivenPath,
    place: Option<&Place>,
    warnings: &mut Vec<Warning>,
) -> Result<Leads, IngestError> {
    let mut columns = vec![(signal.gap.as_str(), Kind::Number)];
    columns.extend(signal.speed.iter().map(|c| (c.as_str(), Kind::Number)));
    let rows = files.rows(&signal.file, &signal.time, &columns, signal.only.as_ref())?;
    let length = mapping.units.length.metres();
    let speed = mapping.units.speed.metres_per_second();
    let gap_m = rows.numbers(&signal.gap, &signal.missing, length)?;
    let speed_mps = match &signal.speed {
        Some(name) => rows.numbers(name, &signal.missing, speed)?,
        None => vec![None; gap_m.len()],
    };
    let missing = WarningKind::MissingValue;
    rows.report(warnings);
    let mut leads = Leads::default();
    let mut seen: Vec<Seen> = Vec::new();
    let (mut before_ego, mut without_speed) = (0, 0);
    for (nth, &stamp_ns) in rows.stamp_ns.iter().enumerate() {
        leads.sightings.push(Sighting {
            stamp_ns,
            log_ns: stamp_ns,
            nth: 0,
        });
        let Some(gap_m) = gap_m[nth] else { continue };
        if driven.at(stamp_ns).is_none() {
            before_ego += 1;
            continue;
        }
        if signal.speed.is_some() && speed_mps[nth].is_none() {
            without_speed += 1;
            continue;
        }
        let (ego_m, lead_m) = (mapping.ego_length_m, mapping.lead_length_m);
        let gap_m = bumper_gap_m(gap_m, mapping.gap_kind, ego_m, lead_m);
        leads.gaps.note(stamp_ns, gap_m);
        let another = |last: &Seen| {
            let unseen_s = (stamp_ns - last.stamp_ns) as f64 / 1e9;
            let jump_m = JUMP_M.max(JUMP_SHARE * gap_m);
            let moved = place.is_some_and(|p| p.changes_between(last.stamp_ns, stamp_ns));
            unseen_s > UNSEEN_S || (gap_m - last.gap_m).abs() > jump_m || moved
        };
        let vehicle = seen
            .last()
            .map_or(LEADER, |last| last.vehicle + u32::from(another(last)));
        seen.push(Seen {
            stamp_ns,
            gap_m,
            speed_mps: speed_mps[nth],
            vehicle,
        });
    }
    let what = "rows of the vehicle ahead without its speed are left out";
    report(warnings, &rows.path, missing, without_speed, what);
    let what = "rows of the vehicle ahead before ego's first speed or after its last are left out";
    let outside = WarningKind::NoOverlap;
    report(warnings, &rows.path, outside, before_ego, what);
    if seen.is_empty() {
        let what = "nobody was seen ahead in the whole drive";
        warnings.push(Warning::new(&rows.path, outside, 1, what));
    }
    let alone = leads.place(&seen, mapping, driven, place);
    let what = "vehicles ahead that were seen in one row alone have no speed and are left out";
    report(warnings, &rows.path, missing, alone, what);
    if signal.speed.is_none() {
        let what = "speeds of the vehicle ahead were not recorded: the change of the gap over two seconds tells them";
        let count = leads.objects.len();
        report(warnings, &rows.path, WarningKind::Default, count, what);
    }
    Ok(leads)
}

impl Leads {
    /// Puts each row where its vehicle was; how many rows are left out because their vehicle has no speed.
    fn place(
        &mut self,
        seen: &[Seen],
        mapping: &TableMapping,
        driven: &DrivenPath,
        place: Option<&Place>,
    ) -> usize {
        let mut alone = 0;
        for vehicle in seen.chunk_by(|a, b| a.vehicle == b.vehicle) {
            for (at, now) in vehicle.iter().enumerate() {
                let Some(ego) = driven.at(now.stamp_ns) else {
                    continue;
                };
                let changing = || slope(vehicle, at).map(|s| ego.speed_mps + s);
                let Some(speed_mps) = now.speed_mps.or_else(changing) else {
                    alone += 1;
                    continue;
                };
                let centres_m = 0.5 * (mapping.ego_length_m + mapping.lead_length_m);
                self.objects.push(ObjectSample {
                    stamp_ns: now.stamp_ns,
                    log_ns: now.stamp_ns,
                    nth: 0,
                    id: now.vehicle,
                    x_m: ego.way_m + now.gap_m + centres_m,
                    y_m: place.map_or(0.0, |p| p.centre_m(now.stamp_ns)),
                    speed_mps,
                    length_m: mapping.lead_length_m,
                });
            }
        }
        alone
    }
}

/// How fast the gap to a vehicle grows around one of its rows, in m/s: the straight line that fits best; none for a single row.
fn slope(vehicle: &[Seen], at: usize) -> Option<f64> {
    let since_s = |s: &Seen| (s.stamp_ns - vehicle[at].stamp_ns) as f64 / 1e9;
    let first = vehicle.partition_point(|s| since_s(s) < -HALF_WINDOW_S);
    let end = vehicle.partition_point(|s| since_s(s) <= HALF_WINDOW_S);
    // At least one to either side, however slowly rows come.
    let first = first.min(at.saturating_sub(1));
    let end = end.max((at + 2).min(vehicle.len()));
    let around = &vehicle[first..end];
    let n = around.len() as f64;
    let mean_t = around.iter().map(since_s).sum::<f64>() / n;
    let mean_m = around.iter().map(|s| s.gap_m).sum::<f64>() / n;
    let (mut tt, mut tg) = (0.0, 0.0);
    for seen in around {
        let t = since_s(seen) - mean_t;
        tt += t * t;
        tg += t * (seen.gap_m - mean_m);
    }
    (tt > 0.0).then(|| tg / tt)
}
