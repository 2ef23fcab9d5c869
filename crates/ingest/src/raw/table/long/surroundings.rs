//! Who else was there at the times of a vehicle.

use super::{number_of, vehicles::Vehicle};
use crate::raw::ObjectSample;
use std::collections::BTreeSet;

/// Vehicles further away than this are of no concern: the method looks 200 m ahead.
const NEAR_M: f64 = 250.0;
/// Most others at one time, the nearest ones: a leader, and neighbours ahead and behind in every lane.
const MOST_OTHERS: usize = 24;
/// A leader without a name that jumps further than this is another one, in m.
const JUMP_M: f64 = 5.0;

/// Whom rows tell enough of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum View {
    /// Everybody.
    All,
    /// The leader that a row names.
    Leader,
    /// The same, on a road that bends.
    LeaderInBends,
}

/// Samples of all vehicles, by time.
#[derive(Debug)]
pub(super) struct Surroundings {
    /// Group, time, vehicle and sample, sorted.
    at: Vec<(u32, i64, u32, u32)>,
}

impl Surroundings {
    pub(super) fn new(vehicles: &[Vehicle]) -> Self {
        let mut at = Vec::with_capacity(vehicles.iter().map(|v| v.samples.len()).sum());
        for (v, vehicle) in (0..).zip(vehicles) {
            let samples = (0..).zip(&vehicle.samples);
            at.extend(samples.map(|(s, sample)| (vehicle.group, sample.stamp_ns, v, s)));
        }
        at.sort_unstable();
        Self { at }
    }

    /// The others around vehicle `ego` at each of its times, in the order of time; only its leader if the
    /// rows name one and say too little of where the others are.
    ///
    /// In the frame of the world such a leader is put straight ahead of ego, as far away as it is: beside ego's nose is
    /// where it stands in a bend.
    pub(super) fn others(
        &self,
        vehicles: &[Vehicle],
        ego: usize,
        ids: &[String],
        view: View,
    ) -> Vec<ObjectSample> {
        let vehicle = &vehicles[ego];
        let mut out = Vec::new();
        let mut unnamed = Unnamed::default();
        let told = vehicle.leads.iter().zip(&vehicle.lead_ids);
        for (sample, (lead, &lead_id)) in vehicle.samples.iter().zip(told) {
            let told = lead.and(lead_id);
            if let Some(lead) = lead {
                out.push(ObjectSample {
                    stamp_ns: sample.stamp_ns,
                    log_ns: sample.log_ns,
                    id: match lead.id {
                        Some(id) => number_of(id, ids),
                        None => unnamed.number(sample.stamp_ns, lead.x_m, lead.speed_mps),
                    },
                    x_m: lead.x_m,
                    y_m: sample.y_m,
                    speed_mps: lead.speed_mps,
                    length_m: Some(lead.length_m),
                });
            }
            let mut near: Vec<(f64, ObjectSample)> = Vec::new();
            let mut seen = BTreeSet::new();
            for &(_, _, v, s) in self.then(vehicle.group, sample.stamp_ns) {
                let other = &vehicles[v as usize];
                let leads = lead_id == Some(other.id);
                let passed_over = match view {
                    View::All => other.sign * vehicle.sign < 0.0,
                    View::Leader | View::LeaderInBends => !leads,
                };
                let there = told == Some(other.id) || v as usize == ego;
                if passed_over || there || !seen.insert(v) {
                    continue;
                }
                let o = &other.samples[s as usize];
                let (sin, cos) = sample.yaw_rad.unwrap_or(0.0).sin_cos();
                let bends = view == View::LeaderInBends && sample.yaw_rad.is_some();
                let distance = (o.x_m - sample.x_m).hypot(o.y_m - sample.y_m);
                if let (Some(speed_mps), true) = (o.speed_mps, distance <= NEAR_M) {
                    let object = ObjectSample {
                        stamp_ns: sample.stamp_ns,
                        log_ns: sample.log_ns,
                        id: number_of(other.id, ids),
                        x_m: if bends {
                            sample.x_m + distance * cos
                        } else {
                            o.x_m
                        },
                        y_m: if bends {
                            sample.y_m + distance * sin
                        } else {
                            o.y_m
                        },
                        speed_mps,
                        length_m: Some(other.length_m),
                    };
                    near.push((distance, object));
                }
            }
            near.sort_by(|a, b| a.0.total_cmp(&b.0));
            out.extend(near.into_iter().take(MOST_OTHERS).map(|n| n.1));
        }
        out
    }

    fn then(&self, group: u32, stamp_ns: i64) -> &[(u32, i64, u32, u32)] {
        let start = self.at.partition_point(|a| (a.0, a.1) < (group, stamp_ns));
        let rest = &self.at[start..];
        let same = rest.iter().take_while(|a| (a.0, a.1) == (group, stamp_ns));
        &rest[..same.count()]
    }
}

/// Numbers for leaders that have no name: a new one after each jump, counted down from the greatest number.
#[derive(Debug, Default)]
struct Unnamed {
    last: Option<(i64, f64, f64)>,
    jumps: u32,
}

impl Unnamed {
    fn number(&mut self, stamp_ns: i64, x_m: f64, speed_mps: f64) -> u32 {
        if let Some((before_ns, before_m, before_mps)) = self.last {
            let dt = stamp_ns.saturating_sub(before_ns) as f64 / 1e9;
            let expected_m = before_m + 0.5 * (before_mps + speed_mps) * dt;
            self.jumps += u32::from((x_m - expected_m).abs() > JUMP_M);
        }
        self.last = Some((stamp_ns, x_m, speed_mps));
        u32::MAX - self.jumps
    }
}
