//! Made-up people who drive calmly and aggressively, a rig that sees less and less of the same drives, and whether the order of the two
//! on the line of aggression holds.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "shared by a test and an example that each use a part"
)]

use maveric_domain::{
    Drive, DriveMeta, DrivenBy, EgoTrack, LatentTraits, ObjectTrack, Recording, Road, ScoreRange,
    Sees, VehicleId, stream_seed,
};
use maveric_model::{
    HeadsKind, Model, Personalizer, TrainSettings, TrainingDrive, style_space::LinearHead, train,
};
use maveric_simulator::{Driver, DriverParams, Scenario, rollout};
use std::{error::Error, ops::ControlFlow};

/// What the rig loses, in this order: each step has lost what those before it have.
pub const STEPS: [&str; 7] = [
    "everything is seen",
    "speed once a second",
    "who is ahead seen for a third to three quarters of the time, in pieces",
    "nobody seen but who is ahead in ego's lane",
    "no place in the lane",
    "120 km/h posted",
    "three lanes",
];
/// The step from which on nobody but the vehicle ahead is seen.
pub const ONLY_AHEAD: usize = 3;

/// Mean length of a piece in which the vehicle ahead is seen, in s.
const PIECE_S: f64 = 8.0;
/// Time that a lane change takes of which only the moment is known, in s.
const CHANGE_S: f64 = 4.0;

/// A number between 0 and 1, its own for each of the names.
fn uniform(names: &[&str]) -> f64 {
    (stream_seed(17, names) >> 11) as f64 / (1_u64 << 53) as f64
}

fn normal(names: &[&str]) -> f64 {
    let [a, b] = ["radius", "angle"].map(|part| uniform(&[names, &[part]].concat()));
    (-2.0 * libm::log(1.0 - a)).sqrt() * libm::cos(std::f64::consts::TAU * b)
}

/// One drive of a made-up person, and its recording.
pub struct Driven {
    meta: DriveMeta,
    pub recording: Recording,
    aggressiveness: f64,
}

/// The person's drive with this aggressiveness, on a day and a road of its own.
///
/// # Errors
/// As [`rollout`].
pub fn driven(
    person: &str,
    label: &str,
    aggressiveness: f64,
    scenario: &Scenario,
) -> Result<Driven, Box<dyn Error>> {
    let traits = LatentTraits {
        aggressiveness,
        spacing: normal(&[person, "spacing"]),
        pace: normal(&[person, "pace"]),
    };
    let who = DriverParams::draw(
        &traits,
        stream_seed(1, &[person]),
        stream_seed(1, &[person, label, "day"]),
    );
    let world = stream_seed(1, &[person, label, "world"]);
    let meta = DriveMeta::named(format!("{person}-{label}"), person, "own", DrivenBy::Synthetic)?;
    Ok(Driven {
        meta,
        recording: rollout(scenario, Driver::Human(&who), world)?.recording,
        aggressiveness,
    })
}

/// A model of linear heads, learned from people who drive as they do, of whom every third shows both roles as well.
///
/// # Errors
/// As [`train`].
pub fn learned(people: usize, role: f64, scenario: &Scenario) -> Result<Model, Box<dyn Error>> {
    let mut drives = Vec::new();
    for i in 0..people {
        let person = format!("L{i}");
        let own = normal(&[&person, "aggressiveness"]);
        let mut labels = vec![("own", own)];
        if i % 3 == 0 {
            labels.extend([("calm", -role), ("aggressive", role)]);
        }
        for (label, aggressiveness) in labels {
            let drive = driven(&person, label, aggressiveness, scenario)?;
            let answered = 27.0 + 7.0 * aggressiveness + 3.0 * normal(&[&person, label, "answer"]);
            let score = ScoreRange::ADB.score(answered.clamp(11.0, 55.0))?;
            drives.push((Drive::from_recording(drive.meta, &drive.recording)?, score));
        }
    }
    let given = drives.iter().map(TrainingDrive::from);
    let given: Vec<TrainingDrive<'_>> = given.collect();
    let settings = TrainSettings { heads: HeadsKind::Linear, ..TrainSettings::default() };
    Ok(train(&given, &settings, 1, &mut |_| ControlFlow::Continue(()))?.model)
}

/// Both drives of a person whose aggressiveness is moved by `apart` to either side of their own.
///
/// # Errors
/// As [`driven`].
pub fn calm_and_aggressive(
    i: usize,
    apart: f64,
    scenario: &Scenario,
) -> Result<[Driven; 2], Box<dyn Error>> {
    let person = format!("T{i}");
    let own = normal(&[&person, "aggressiveness"]);
    Ok([
        driven(&person, "calm", own - apart, scenario)?,
        driven(&person, "aggressive", own + apart, scenario)?,
    ])
}

/// How the two drives of people lie.
pub struct Order {
    /// Share of people whose aggressive drive lies above the calm one on the line.
    pub holds: f64,
    /// Median of by how much, in points of the score.
    pub median_points: f64,
    /// Share of people whose aggressive drive is the faster one.
    pub by_speed: f64,
}

/// The order of people's two drives as a rig sees them that has lost so much; `sees` is what it is said to see.
///
/// # Errors
/// As [`Personalizer::fit`].
pub fn order(
    people: &[[Driven; 2]],
    model: &Model,
    step: usize,
    sees: Sees,
) -> Result<Order, Box<dyn Error>> {
    let line = LinearHead::aggression(model)?;
    let personalizer = Personalizer::new(model);
    let (mut apart, mut faster) = (Vec::new(), 0_usize);
    for pair in people {
        let mut read = Vec::new();
        for driven in pair {
            let seen = degraded(&driven.recording, step, driven.meta.drive.as_str())?;
            let drive = Drive::from_recording(driven.meta.clone(), &seen.seen_by(sees))?;
            let speed = drive.rows().ego_speed_mps.iter().sum::<f64>() / drive.len() as f64;
            let fit = personalizer.fit(&drive, None)?;
            read.push((line.read(&fit.embedding)?, speed));
        }
        debug_assert!(pair[0].aggressiveness < pair[1].aggressiveness);
        apart.push(read[1].0 - read[0].0);
        faster += usize::from(read[1].1 > read[0].1);
    }
    let n = people.len() as f64;
    let holds = apart.iter().filter(|d| **d > 0.0).count() as f64 / n;
    apart.sort_by(f64::total_cmp);
    Ok(Order { holds, median_points: apart[apart.len() / 2], by_speed: faster as f64 / n })
}

/// What a rig sees that has lost so much.
pub fn seen_by(step: usize) -> Sees {
    if step < ONLY_AHEAD { Sees::ALL } else { Sees { lanes: true, ..Sees::LEAD } }
}

/// A recording as a rig writes it that has lost all up to a step of [`STEPS`].
///
/// # Errors
/// As [`Recording::new`].
pub fn degraded(whole: &Recording, step: usize, name: &str) -> Result<Recording, Box<dyn Error>> {
    let mut road = *whole.road();
    let mut ego = whole.ego().clone();
    let mut others = whole.others().to_vec();
    let rate = whole.rate_hz();
    if step >= 1 {
        once_a_second(&mut ego, &mut others, rate);
    }
    if step >= 2 {
        others = seen_ahead(&ego, &others, &road, rate, step >= ONLY_AHEAD, name);
    }
    if step >= 4 {
        let lanes: Vec<u8> = ego.y_m.iter().map(|y| road.nearest_lane(*y)).collect();
        ego.y_m = centres(&lanes, &road, rate);
        for track in &mut others {
            for (i, y) in track.y_m.iter_mut().enumerate() {
                *y = road.lane_centre_m(lanes[track.first_row + i]);
            }
        }
    }
    if step >= 5 {
        road.posted_speed_mps = 120.0 / 3.6;
    }
    if step >= 6 {
        road.lanes = 3;
    }
    let (time_s, segment) = (whole.time_s().to_vec(), whole.segment().to_vec());
    Ok(Recording::new(road, rate, time_s, segment, ego, others)?)
}

/// Ego's speed between whole seconds as a straight line, its way as the integral of that; gaps stay as they are.
fn once_a_second(ego: &mut EgoTrack, others: &mut [ObjectTrack], rate: f64) {
    let step = rate.round() as usize;
    let last = ego.speed_mps.len() - 1;
    let known = ego.speed_mps.clone();
    let former = ego.x_m.clone();
    for row in 0..=last {
        let (from, to) = (row / step * step, (row / step * step + step).min(last));
        let share = (row - from) as f64 / (to - from).max(1) as f64;
        ego.speed_mps[row] = known[from] + share * (known[to] - known[from]);
        if row > 0 {
            let mean = 0.5 * (ego.speed_mps[row - 1] + ego.speed_mps[row]);
            ego.x_m[row] = ego.x_m[row - 1] + mean / rate;
        }
    }
    for track in others {
        for (i, x) in track.x_m.iter_mut().enumerate() {
            *x += ego.x_m[track.first_row + i] - former[track.first_row + i];
        }
    }
}

/// The others, of whom the one ahead in ego's lane is seen in pieces; of the rest everything, or nothing if `alone`.
fn seen_ahead(
    ego: &EgoTrack,
    others: &[ObjectTrack],
    road: &Road,
    rate: f64,
    alone: bool,
    name: &str,
) -> Vec<ObjectTrack> {
    let rows = ego.x_m.len();
    let mut ahead: Vec<Option<usize>> = vec![None; rows];
    let mut nearest = vec![f64::INFINITY; rows];
    for (which, track) in others.iter().enumerate() {
        for (i, (&x, &y)) in track.x_m.iter().zip(&track.y_m).enumerate() {
            let row = track.first_row + i;
            let gap = x - ego.x_m[row];
            let in_lane = road.lane_at(y) == Some(road.nearest_lane(ego.y_m[row]));
            if in_lane && gap > 0.0 && gap < nearest[row] {
                (nearest[row], ahead[row]) = (gap, Some(which));
            }
        }
    }
    let seen = pieces(rows, rate, name);
    let mut tracks: Vec<ObjectTrack> = Vec::new();
    let mut id = 0;
    for (which, track) in others.iter().enumerate() {
        let mut goes_on = false;
        for i in 0..track.x_m.len() {
            let row = track.first_row + i;
            let leads = ahead[row] == Some(which);
            let kept = if leads { seen[row] } else { !alone };
            if kept {
                // Seen again it is another one; and so it is to a camera in another lane.
                let crossed = row > 0
                    && road.nearest_lane(ego.y_m[row]) != road.nearest_lane(ego.y_m[row - 1]);
                if !goes_on || alone && crossed {
                    id += 1;
                    tracks.push(ObjectTrack {
                        id: VehicleId(id),
                        first_row: row,
                        x_m: Vec::new(),
                        y_m: Vec::new(),
                        speed_mps: Vec::new(),
                        ..*track
                    });
                }
                if let Some(open) = tracks.last_mut() {
                    open.x_m.push(track.x_m[i]);
                    open.y_m.push(track.y_m[i]);
                    open.speed_mps.push(track.speed_mps[i]);
                }
            }
            goes_on = kept;
        }
    }
    tracks
}

/// In which rows a camera sees whoever is ahead: pieces of chance length, 33 to 77 % of the time.
fn pieces(rows: usize, rate: f64, name: &str) -> Vec<bool> {
    let share = 0.33 + 0.44 * uniform(&[name, "share"]);
    let mut seen = Vec::with_capacity(rows);
    let mut sees = uniform(&[name, "begins"]) < share;
    let mut piece = 0;
    while seen.len() < rows {
        let mean_s = if sees { PIECE_S } else { PIECE_S * (1.0 - share) / share };
        let length_s = -mean_s * libm::log(1.0 - uniform(&[name, "piece", &piece.to_string()]));
        let length = ((length_s * rate).ceil() as usize).max(1);
        seen.extend(std::iter::repeat_n(sees, length));
        (sees, piece) = (!sees, piece + 1);
    }
    seen.truncate(rows);
    seen
}

/// Lateral positions of which only the lane is known, and when it changes.
fn centres(lanes: &[u8], road: &Road, rate: f64) -> Vec<f64> {
    let half = (0.5 * CHANGE_S * rate).round() as usize;
    let mut lateral_m: Vec<f64> = lanes.iter().map(|l| road.lane_centre_m(*l)).collect();
    for row in 1..lanes.len() {
        if lanes[row] == lanes[row - 1] {
            continue;
        }
        let (from, to) = (row.saturating_sub(half), (row + half).min(lanes.len() - 1));
        let (a, b) = (road.lane_centre_m(lanes[row - 1]), road.lane_centre_m(lanes[row]));
        for (i, y) in lateral_m[from..=to].iter_mut().enumerate() {
            *y = a + (b - a) * i as f64 / (to - from) as f64;
        }
    }
    lateral_m
}
