//! Small drives made by hand, for tests, benches and the example.
#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "shared by programs that each use a part; inputs are fixed"
)]

use maveric_domain::{
    Drive, DriveMeta, DrivenBy, EgoTrack, ObjectTrack, Recording, Road, ScoreRange, StyleScore,
    VehicleId,
};

/// How somebody drives in [`drive`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Habits {
    /// Speed on free road, in m/s.
    pub(crate) speed_mps: f64,
    /// Time gap while following, in s.
    pub(crate) time_gap_s: f64,
    /// Whether they pass at all.
    pub(crate) passes: bool,
}

/// A driver follows this long before looking for a chance to pass, in s.
const PATIENCE_S: f64 = 15.0;
/// A pass starts at this share of the usual time gap.
const PASS_SHARE: f64 = 0.7;
/// Merging back needs this share of the usual time gap behind.
const MERGE_SHARE: f64 = 0.8;
pub(crate) const RATE_HZ: f64 = 10.0;

fn lane_step(share: f64) -> f64 {
    let s = share.clamp(0.0, 1.0);
    3.66 * s * s * (3.0 - 2.0 * s)
}

struct Lead {
    first_row: usize,
    speed: f64,
    x: f64,
    track: Vec<f64>,
}

/// Meets one slower car after the other: closes in, follows for a while, passes, merges back.
pub(crate) fn drive(name: &str, habits: &Habits, seconds: f64) -> Drive {
    drive_at(RATE_HZ, name, habits, seconds)
}

/// As [`drive`], with free road between one car and the next.
pub(crate) fn drive_apart(name: &str, habits: &Habits, seconds: f64) -> Drive {
    drive_apart_on(Road::PAPER, name, habits, seconds)
}

/// As [`drive_apart`], on this road.
pub(crate) fn drive_apart_on(road: Road, name: &str, habits: &Habits, seconds: f64) -> Drive {
    driven((road, RATE_HZ), name, habits, seconds, 30.0)
}

/// As [`drive`], with that many rows a second.
pub(crate) fn drive_at(rate_hz: f64, name: &str, habits: &Habits, seconds: f64) -> Drive {
    driven((Road::PAPER, rate_hz), name, habits, seconds, 0.0)
}

fn driven(
    (road, rate_hz): (Road, f64),
    name: &str,
    habits: &Habits,
    seconds: f64,
    apart_s: f64,
) -> Drive {
    let dt = 1.0 / rate_hz;
    let rows = (seconds * rate_hz) as usize;
    let (mut x, mut y, mut v) = (0.0_f64, 0.0_f64, habits.speed_mps);
    let mut ego = EgoTrack { length_m: 4.7, ..EgoTrack::default() };
    let mut time_s = Vec::new();
    let mut leads: Vec<Lead> = Vec::new();
    let mut others = Vec::new();
    let mut followed_s = 0.0;
    let mut moving: Option<(f64, f64)> = None;
    let mut out = false;
    let mut next_s = 10.0;
    for row in 0..rows {
        let t = row as f64 * dt;
        if leads.is_empty() && t > next_s {
            leads.push(Lead {
                first_row: row,
                speed: 22.0 + (others.len() % 3) as f64,
                x: x + 150.0,
                track: Vec::new(),
            });
        }
        let mut acceleration = 0.5 * (habits.speed_mps - v);
        if let Some(lead) = leads.first() {
            let gap = lead.x - x - 4.7;
            if gap > 0.0 && !out && moving.is_none() {
                let patient = followed_s < PATIENCE_S || !habits.passes;
                let wanted = if patient { 1.0 } else { PASS_SHARE } * habits.time_gap_s * v;
                if gap < 1.3 * habits.time_gap_s * v {
                    followed_s += dt;
                }
                if gap < 100.0 {
                    let follow = 0.03 * (gap - wanted) + 0.35 * (lead.speed - v);
                    acceleration = acceleration.min(follow);
                }
                if !patient && gap < 1.05 * wanted {
                    moving = Some((t, 1.0));
                }
            } else if out && moving.is_none() && -gap - 9.4 > MERGE_SHARE * habits.time_gap_s * v {
                moving = Some((t, -1.0));
            }
        }
        if let Some((from, sign)) = moving {
            let share = (t - from) / 4.0;
            y = if sign > 0.0 { lane_step(share) } else { 3.66 - lane_step(share) };
            if share >= 1.2 {
                moving = None;
                out = sign > 0.0;
                if !out {
                    followed_s = 0.0;
                }
            }
        }
        v = (v + acceleration.clamp(-4.0, 2.0) * dt).max(5.0);
        x += v * dt;
        time_s.push(t);
        ego.x_m.push(x);
        ego.y_m.push(y);
        ego.speed_mps.push(v);
        if let Some(lead) = leads.first_mut() {
            lead.x += lead.speed * dt;
            lead.track.push(lead.x);
        }
        let gone = leads.first().is_some_and(|l| x - l.x > 120.0);
        if gone || row + 1 == rows {
            next_s = next_s.max(t + apart_s);
            for lead in leads.drain(..) {
                let n = lead.track.len();
                others.push(ObjectTrack {
                    id: VehicleId(others.len() as u32),
                    length_m: 4.7,
                    first_row: lead.first_row,
                    x_m: lead.track,
                    y_m: vec![0.0; n],
                    speed_mps: vec![lead.speed; n],
                });
            }
        }
    }
    let segment = vec![0; rows];
    let recording = Recording::new(road, rate_hz, time_s, segment, ego, others).unwrap();
    let meta = DriveMeta::named(format!("{name}-own"), name, "own", DrivenBy::Synthetic).unwrap();
    Drive::from_recording(meta, &recording).unwrap()
}

/// A drive and its driver's score.
pub(crate) type Scored = (Drive, StyleScore);

/// `n` drivers from slow with long gaps to fast with short ones, with ADB scores that say so.
pub(crate) fn drivers(n: usize, seconds: f64) -> Vec<Scored> {
    drivers_of(n, |name, habits| drive(name, habits, seconds))
}

/// As [`drivers`], with free road between one car and the next.
pub(crate) fn drivers_apart(n: usize, seconds: f64) -> Vec<Scored> {
    drivers_of(n, |name, habits| drive_apart(name, habits, seconds))
}

fn drivers_of(n: usize, drive: impl Fn(&str, &Habits) -> Drive) -> Vec<Scored> {
    let of = |i: usize| {
        let a = if n > 1 { i as f64 / (n - 1) as f64 } else { 0.5 };
        let habits = Habits { speed_mps: 26.0 + 8.0 * a, time_gap_s: 2.2 - 1.2 * a, passes: true };
        let drive = drive(&format!("P{i:02}"), &habits);
        (drive, ScoreRange::ADB.score(16.0 + 30.0 * a).unwrap())
    };
    (0..n).map(of).collect()
}
