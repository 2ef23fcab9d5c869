//! Who else was there at the times of a vehicle.

use super::vehicles::Vehicle;
use crate::raw::ObjectSample;
use std::collections::BTreeSet;

/// Vehicles further away than this are of no concern: the method looks 200 m ahead.
const NEAR_M: f64 = 250.0;
/// Most others at one time, the nearest ones: a leader, and neighbours ahead and behind in every lane.
const MOST_OTHERS: usize = 24;
/// Vehicles that are looked at to either side of a vehicle, in the order of x: a road of eight lanes, 8 m a car, 64 m.
const MOST_LOOKED_AT: usize = 64;
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

/// A sample of a vehicle: group, time, x, and where it is.
#[derive(Debug, Clone, Copy)]
struct Seen {
    group: u32,
    stamp_ns: i64,
    x_m: f64,
    vehicle: u32,
    sample: u32,
}

/// Samples of all vehicles, by time and then along x.
#[derive(Debug)]
pub(super) struct Surroundings {
    seen: Vec<Seen>,
}

impl Surroundings {
    pub(super) fn new(vehicles: &[Vehicle]) -> Self {
        let mut seen = Vec::with_capacity(vehicles.iter().map(|v| v.samples.len()).sum());
        for (vehicle, one) in (0..).zip(vehicles) {
            seen.extend((0..).zip(&one.samples).map(|(sample, s)| Seen {
                group: one.group,
                stamp_ns: s.stamp_ns,
                x_m: s.x_m,
                vehicle,
                sample,
            }));
        }
        seen.sort_by(|a, b| {
            let place = |s: &Seen| (s.group, s.stamp_ns);
            let by_x = || a.x_m.total_cmp(&b.x_m);
            let order = place(a).cmp(&place(b)).then_with(by_x);
            order.then_with(|| (a.vehicle, a.sample).cmp(&(b.vehicle, b.sample)))
        });
        Self { seen }
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
        numbers: &[u32],
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
                    nth: 0,
                    id: match lead.id {
                        Some(id) => numbers[id as usize],
                        None => unnamed.number(sample.stamp_ns, lead.x_m, lead.speed_mps),
                    },
                    x_m: lead.x_m,
                    y_m: sample.y_m,
                    speed_mps: lead.speed_mps,
                    length_m: lead.length_m,
                });
            }
            let mut near: Vec<(f64, ObjectSample)> = Vec::new();
            let mut seen = BTreeSet::new();
            for &Seen {
                vehicle: v,
                sample: s,
                ..
            } in self.near(vehicle.group, sample.stamp_ns, sample.x_m)
            {
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
                let (sin, cos) = libm::sincos(sample.yaw_rad.unwrap_or(0.0));
                let bends = view == View::LeaderInBends && sample.yaw_rad.is_some();
                let distance = libm::hypot(o.x_m - sample.x_m, o.y_m - sample.y_m);
                if let (Some(speed_mps), true) = (o.speed_mps, distance <= NEAR_M) {
                    let object = ObjectSample {
                        stamp_ns: sample.stamp_ns,
                        log_ns: sample.log_ns,
                        nth: 0,
                        id: numbers[other.id as usize],
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
                        length_m: other.length_m,
                    };
                    near.push((distance, object));
                }
            }
            near.sort_by(|a, b| a.0.total_cmp(&b.0));
            out.extend(near.into_iter().take(MOST_OTHERS).map(|n| n.1));
        }
        out
    }

    /// The samples at a time that lie next to x, at most 250 m and a limited number to either side.
    fn near(&self, group: u32, stamp_ns: i64, x_m: f64) -> &[Seen] {
        let time = |s: &Seen| (s.group, s.stamp_ns);
        let now = (group, stamp_ns);
        let here = self
            .seen
            .partition_point(|s| time(s) < now || time(s) == now && s.x_m < x_m);
        let fits = |s: &&Seen| time(s) == now && (s.x_m - x_m).abs() <= NEAR_M;
        let (behind, ahead) = self.seen.split_at(here);
        let behind = behind.iter().rev().take(MOST_LOOKED_AT);
        let ahead = ahead.iter().take(MOST_LOOKED_AT);
        let (behind, ahead) = (behind.take_while(fits), ahead.take_while(fits));
        &self.seen[here - behind.count()..here + ahead.count()]
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
