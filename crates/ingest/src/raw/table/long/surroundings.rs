//! Who else was there at the times of a vehicle.

use super::vehicles::{Lead, Vehicle};
use crate::raw::{EgoSample, ObjectSample, ObjectSamples, Sighting, Sightings, leader::Leaders};
use std::collections::{BTreeMap, BTreeSet};

/// Vehicles further away than this are of no concern: the method looks 200 m ahead.
const NEAR_M: f64 = 250.0;
/// Most others at one time, the nearest ones: a leader, and neighbours ahead and behind in every lane.
const MOST_OTHERS: usize = 24;
/// Vehicles that are looked at to either side of a vehicle, in the order of x: a road of eight lanes, 8 m a car, 64 m.
const MOST_LOOKED_AT: usize = 64;

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
///
/// Who is stamped within half a step of a vehicle is there with it: some rigs stamp one vehicle after the other.
#[derive(Debug)]
pub(super) struct Surroundings {
    seen: Vec<Seen>,
    /// Half a step by group, in ns.
    half_step_ns: BTreeMap<u32, i64>,
    /// Longest time between two samples of a vehicle that is bridged, in ns.
    max_gap_ns: i64,
}

/// Who was around a vehicle.
#[derive(Debug, Default)]
pub(super) struct Around {
    pub(super) objects: ObjectSamples,
    /// Times at which the others were observed; `None` if that is always.
    pub(super) sightings: Option<Sightings>,
    /// Rows that name a leader whose position is unknown.
    pub(super) lost_leaders: usize,
    /// Vehicles whose length is unknown.
    pub(super) without_length: usize,
}

impl Seen {
    fn time(&self) -> (u32, i64) {
        (self.group, self.stamp_ns)
    }
}

impl Surroundings {
    pub(super) fn new(vehicles: &[Vehicle], max_gap_s: f64) -> Self {
        let mut seen = Vec::with_capacity(vehicles.iter().map(|v| v.samples.len()).sum());
        for (vehicle, one) in (0..).zip(vehicles) {
            let stamps = &one.samples.stamp_ns;
            // Of two rows at one time the first counts.
            let is_first = |sample: usize| sample == 0 || stamps[sample - 1] != stamps[sample];
            let samples = (0..).zip(one.samples.iter()).filter(|s| is_first(s.0 as usize));
            seen.extend(samples.map(|(sample, s): (u32, _)| Seen {
                group: one.group,
                stamp_ns: s.stamp_ns,
                x_m: s.x_m,
                vehicle,
                sample,
            }));
        }
        seen.sort_by(|a, b| {
            let by_x = || a.x_m.total_cmp(&b.x_m);
            let order = a.time().cmp(&b.time()).then_with(by_x);
            order.then_with(|| (a.vehicle, a.sample).cmp(&(b.vehicle, b.sample)))
        });
        let groups = vehicles.chunk_by(|a, b| a.group == b.group);
        Self {
            seen,
            half_step_ns: groups.map(|g| (g[0].group, usual_step_ns(g) / 2)).collect(),
            max_gap_ns: (max_gap_s * 1e9) as i64,
        }
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
    ) -> Around {
        let vehicle = &vehicles[ego];
        let mut objects = ObjectSamples::default();
        // When anybody was seen last, and the times between which nobody was although who was there before came back.
        let (mut first_ns, mut last_ns) = (None, None);
        let mut unseen: Vec<(i64, i64)> = Vec::new();
        let mut unnamed = Leaders::default();
        let (mut lost_ns, mut without_length) = (BTreeSet::new(), BTreeSet::new());
        let leads = vehicle.leads.iter().zip(&vehicle.lead_ids);
        for (sample, (lead, &lead_id)) in vehicle.samples.iter().zip(leads) {
            objects.extend(lead.map(|lead| lead_sample(&lead, &sample, numbers, &mut unnamed)));
            let observer = Observer { ego, sample, lead_id, by_row: lead.and(lead_id), view };
            let mut near: Vec<(f64, ObjectSample)> = Vec::new();
            for (other, at, o) in self.seen_from(vehicles, &observer) {
                if let Some(last_ns) = last_ns
                    && sample.stamp_ns - last_ns > self.max_gap_ns
                    && view == View::All
                    && returns(other, at, last_ns)
                {
                    unseen.push((last_ns, sample.stamp_ns));
                }
                let object = observer.object(other, &o, numbers);
                if object.is_some() && !other.length_known {
                    without_length.insert(other.id);
                }
                near.extend(object);
            }
            if let Some(id) = lead_id.filter(|_| lead.is_none())
                && !self.is_recorded(vehicles, (vehicle.group, id), sample.stamp_ns)
            {
                lost_ns.insert(sample.stamp_ns);
            }
            near.sort_by(|a, b| a.0.total_cmp(&b.0));
            if lead.is_some() || !near.is_empty() {
                last_ns = Some(sample.stamp_ns);
                first_ns = first_ns.or(last_ns);
            }
            objects.extend(near.into_iter().take(MOST_OTHERS).map(|n| n.1));
        }
        unseen.dedup();
        blind_ends(vehicle, first_ns.zip(last_ns), &mut unseen);
        let is_partial = !unseen.is_empty() || !lost_ns.is_empty();
        Around {
            objects,
            sightings: is_partial.then(|| seen_times(vehicle, &unseen, &lost_ns)),
            lost_leaders: lost_ns.len(),
            without_length: without_length.len(),
        }
    }

    /// The vehicles around a vehicle at one of its times, each once: which, by which of its samples, and where it is then.
    fn seen_from<'a>(
        &'a self,
        vehicles: &'a [Vehicle],
        observer: &Observer,
    ) -> impl Iterator<Item = (&'a Vehicle, usize, EgoSample)> {
        let (vehicle, observer) = (&vehicles[observer.ego], *observer);
        let mut seen = BTreeSet::new();
        let (stamp_ns, x_m) = (observer.sample.stamp_ns, observer.sample.x_m);
        self.near(vehicle.group, stamp_ns, x_m).filter_map(move |s| {
            let (index, at) = (s.vehicle as usize, s.sample as usize);
            let other = &vehicles[index];
            let passed_over = match observer.view {
                View::All => other.sign * vehicle.sign < 0.0,
                View::Leader | View::LeaderInBends => observer.lead_id != Some(other.id),
            };
            let there = observer.by_row == Some(other.id) || index == observer.ego;
            if passed_over || there || !seen.insert(s.vehicle) {
                return None;
            }
            Some((other, at, self.at(other, at, stamp_ns)?))
        })
    }

    /// Whether the vehicle of a group and name has a sample at a time, or one on either side of it that may be bridged.
    fn is_recorded(&self, vehicles: &[Vehicle], name: (u32, u32), stamp_ns: i64) -> bool {
        let half_step_ns = self.half_step_ns.get(&name.0).copied().unwrap_or(0);
        let key = |v: &Vehicle| (v.group, v.id);
        let from = vehicles.partition_point(|v| key(v) < name);
        vehicles[from..].iter().take_while(|v| key(v) == name).any(|vehicle| {
            let stamps = &vehicle.samples.stamp_ns;
            let after = stamps.partition_point(|ns| *ns < stamp_ns);
            let before = after.checked_sub(1).map(|i| stamps[i]);
            let after = stamps.get(after).copied();
            let is_near =
                |ns: Option<i64>| ns.is_some_and(|ns| ns.abs_diff(stamp_ns) <= half_step_ns as u64);
            let is_bridged = before.zip(after).is_some_and(|(a, b)| b - a <= self.max_gap_ns);
            is_near(before) || is_near(after) || is_bridged
        })
    }

    /// Where a vehicle is at a time beside one of its samples: as that says, or between it and the next to it.
    fn at(&self, vehicle: &Vehicle, sample: usize, stamp_ns: i64) -> Option<EgoSample> {
        let samples = &vehicle.samples;
        let there = samples.at(sample);
        if there.stamp_ns == stamp_ns {
            return Some(there);
        }
        let earlier = |stamps: &[i64]| stamps.partition_point(|ns| *ns < stamp_ns);
        let after = if there.stamp_ns < stamp_ns {
            sample + earlier(&samples.stamp_ns[sample..])
        } else {
            earlier(&samples.stamp_ns[..sample])
        };
        let before = after.checked_sub(1)?;
        let (a, b) = (samples.at(before), samples.get(before + 1)?);
        let step_ns = b.stamp_ns - a.stamp_ns;
        if step_ns > self.max_gap_ns {
            return None;
        }
        let w = (stamp_ns - a.stamp_ns) as f64 / step_ns as f64;
        let mix = |a: f64, b: f64| a + w * (b - a);
        Some(EgoSample {
            x_m: mix(a.x_m, b.x_m),
            y_m: mix(a.y_m, b.y_m),
            speed_mps: a.speed_mps.zip(b.speed_mps).map(|(a, b)| mix(a, b)),
            stamp_ns,
            ..there
        })
    }

    /// The samples around a time that lie next to x, at most 250 m and a limited number to either side; those of that very time
    /// first.
    fn near(&self, group: u32, stamp_ns: i64, x_m: f64) -> impl Iterator<Item = &Seen> {
        let within_ns = self.half_step_ns.get(&group).copied().unwrap_or(0);
        let begin = self.seen.partition_point(|s| s.time() < (group, stamp_ns - within_ns));
        let around = self.seen[begin..]
            .chunk_by(|a, b| a.time() == b.time())
            .take_while(move |s| s[0].time() <= (group, stamp_ns + within_ns));
        let now = around.clone().filter(move |s| s[0].stamp_ns == stamp_ns);
        let others = around.filter(move |s| s[0].stamp_ns != stamp_ns);
        now.chain(others).flat_map(move |s| beside(s, x_m))
    }
}

/// A vehicle at one of its times.
#[derive(Debug, Clone, Copy)]
struct Observer {
    /// Its place among the vehicles.
    ego: usize,
    sample: EgoSample,
    /// Whom its row names as its leader.
    lead_id: Option<u32>,
    /// The same, where the row says where that is.
    by_row: Option<u32>,
    view: View,
}

impl Observer {
    /// Another vehicle as this one sees it, and how far away; none beyond 250 m or without a speed.
    fn object(
        &self,
        other: &Vehicle,
        o: &EgoSample,
        numbers: &[u32],
    ) -> Option<(f64, ObjectSample)> {
        let sample = &self.sample;
        let bends = self.view == View::LeaderInBends && sample.yaw_rad.is_some();
        let (sin, cos) = libm::sincos(o.yaw_rad.unwrap_or(0.0));
        let ahead_m = other.as_other.ahead_m;
        let there = (o.x_m + ahead_m * cos, o.y_m + ahead_m * sin);
        let distance = libm::hypot(there.0 - sample.x_m, there.1 - sample.y_m);
        let speed_mps = o.speed_mps.filter(|_| distance <= NEAR_M)?;
        let (x_m, y_m) = if bends {
            let (sin, cos) = libm::sincos(sample.yaw_rad.unwrap_or(0.0));
            (sample.x_m + distance * cos, sample.y_m + distance * sin)
        } else {
            there
        };
        let object = ObjectSample {
            stamp_ns: sample.stamp_ns,
            log_ns: sample.log_ns,
            nth: 0,
            id: numbers[other.id as usize],
            x_m,
            y_m,
            speed_mps,
            length_m: other.as_other.length_m,
        };
        Some((distance, object))
    }
}

/// The leader that a row tells of; one without a number is counted down from the greatest.
fn lead_sample(
    lead: &Lead,
    sample: &EgoSample,
    numbers: &[u32],
    unnamed: &mut Leaders,
) -> ObjectSample {
    let object = ObjectSample {
        stamp_ns: sample.stamp_ns,
        log_ns: sample.log_ns,
        nth: 0,
        id: 0,
        x_m: lead.x_m,
        y_m: sample.y_m,
        speed_mps: lead.speed_mps,
        length_m: lead.length_m,
    };
    let known_m = lead.length_known.then_some(lead.length_m);
    let length_m = known_m.unwrap_or(f64::NAN);
    let unnumbered = || u32::MAX - unnamed.before(ObjectSample { length_m, ..object });
    let number = lead.id.map(|id| numbers[id as usize]);
    let id = number.unwrap_or_else(unnumbered);
    ObjectSample { id, ..object }
}

/// Those of samples along x that lie next to one place.
fn beside(seen: &[Seen], x_m: f64) -> &[Seen] {
    let index = seen.partition_point(|s| s.x_m < x_m);
    let fits = |s: &&Seen| (s.x_m - x_m).abs() <= NEAR_M;
    let (behind, ahead) = seen.split_at(index);
    let behind = behind.iter().rev().take(MOST_LOOKED_AT);
    let ahead = ahead.iter().take(MOST_LOOKED_AT);
    let (behind, ahead) = (behind.take_while(fits), ahead.take_while(fits));
    &seen[index - behind.count()..index + ahead.count()]
}

/// The shortest of vehicles' mean steps, in ns.
fn usual_step_ns(vehicles: &[Vehicle]) -> i64 {
    let step = |v: &Vehicle| {
        let (first, last) = (v.samples.first()?, v.samples.last()?);
        let steps = i64::try_from(v.samples.len()).ok()? - 1;
        (steps > 0).then(|| (last.stamp_ns - first.stamp_ns) / steps)
    };
    vehicles.iter().filter_map(step).min().unwrap_or(0)
}

/// Whether a vehicle was there at a time, was silent since, and is seen again by this sample.
fn returns(vehicle: &Vehicle, sample: usize, last_ns: i64) -> bool {
    let before = sample.checked_sub(1).map(|i| vehicle.samples.stamp_ns[i]);
    before.is_some_and(|ns| ns <= last_ns)
}

/// Adds the ends of a drive where others are not seen for as long as they were not between, or less.
fn blind_ends(ego: &Vehicle, seen: Option<(i64, i64)>, unseen: &mut Vec<(i64, i64)>) {
    let longest_ns = unseen.iter().map(|(from, to)| to - from).max();
    let (Some(longest_ns), Some((first_ns, last_ns))) = (longest_ns, seen) else {
        return;
    };
    let (Some(begin), Some(end)) = (ego.samples.first(), ego.samples.last()) else {
        return;
    };
    if first_ns - begin.stamp_ns <= longest_ns {
        unseen.insert(0, (i64::MIN, first_ns));
    }
    if end.stamp_ns - last_ns <= longest_ns {
        unseen.push((last_ns, i64::MAX));
    }
}

/// Ego's times without those between which nobody looked and those whose leader is `lost`.
fn seen_times(ego: &Vehicle, unseen: &[(i64, i64)], lost: &BTreeSet<i64>) -> Sightings {
    let mut hole = 0;
    let known = ego.samples.stamp_ns.iter().copied().filter(|ns| !lost.contains(ns));
    let times = known.filter(|&ns| {
        while unseen.get(hole).is_some_and(|(_, to)| *to <= ns) {
            hole += 1;
        }
        unseen.get(hole).is_none_or(|(from, _)| ns <= *from)
    });
    let sighting = |stamp_ns| Sighting { stamp_ns, log_ns: stamp_ns, nth: 0 };
    times.map(sighting).collect()
}
