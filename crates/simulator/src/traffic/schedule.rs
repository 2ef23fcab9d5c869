//! The six leads: at what speed, when, and how each behaves.

use super::{Arrival, Car, EgoView, Role, distance_m, find};
use crate::scenario::{LeadSettings, ScenarioSettings};
use maveric_domain::VehicleId;
use rand::{SeedableRng, seq::SliceRandom};
use rand_pcg::Pcg64Mcg;

/// What a lead is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LeadPhase {
    /// Slow enough for ego to come near.
    Approach,
    /// At its own speed.
    Own,
    /// Leaving ego behind.
    DriveOff,
}

/// One lead's plan.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LeadPlan {
    own_mps: f64,
    approach_mps: f64,
    since_s: f64,
    phase: LeadPhase,
}

impl LeadPlan {
    /// Its speed now, in m/s, after taking note of where ego is.
    pub(crate) fn wanted_mps(
        &mut self,
        s: &LeadSettings,
        ego: &EgoView,
        ahead_in_lane_m: Option<f64>,
        time_s: f64,
    ) -> f64 {
        let age_s = time_s - self.since_s;
        if self.phase == LeadPhase::Approach {
            let near =
                ahead_in_lane_m.is_some_and(|gap| gap < s.approach_time_gap_s * ego.speed_mps);
            if near || age_s > s.approach_limit_s {
                self.phase = LeadPhase::Own;
            }
        }
        if age_s > s.drives_off_after_s && ahead_in_lane_m.is_some() {
            self.phase = LeadPhase::DriveOff;
        }
        match self.phase {
            LeadPhase::Approach => self.approach_mps,
            LeadPhase::Own => self.own_mps,
            LeadPhase::DriveOff => ego.speed_mps + s.drives_off_faster_mps,
        }
    }
}

#[derive(Debug, Clone, Copy)]
struct Slot {
    opens_s: f64,
    factor: Factor,
    blocked: bool,
}

#[derive(Debug, Clone, Copy)]
enum Factor {
    OfTarget(f64),
    OfPosted(f64),
}

/// Slots that open one after the other, each for one lead.
///
/// # Source
/// Calibration section 1. A drive too short for six slots keeps the order and opens as many as fit: the first
/// after a tenth of the drive, then one every two fifths of it (ours), so that two minutes meet two leads.
#[derive(Debug, Clone)]
pub(crate) struct LeadSchedule {
    settings: LeadSettings,
    posted_mps: f64,
    slots: Vec<Slot>,
    next: usize,
    current: Option<VehicleId>,
}

/// A slot that would open later than this before the end does not open, in s: nobody would meet its lead.
const USEFUL_S: f64 = 30.0;
/// The first slot opens after this share of a short drive.
const FIRST_SHARE: f64 = 0.1;
/// Share of a short drive between slots.
const SPACING_SHARE: f64 = 0.4;

impl LeadSchedule {
    pub(crate) fn new(scenario: &ScenarioSettings, posted_mps: f64, seed: u64) -> Self {
        let s = &scenario.leads;
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let of_target = s.factors_of_target.iter().map(|&f| Factor::OfTarget(f));
        let of_posted = s.factors_of_posted.iter().map(|&f| Factor::OfPosted(f));
        let mut factors: Vec<Factor> = of_target.chain(of_posted).collect();
        factors.shuffle(&mut rng);
        let mut blocked: Vec<bool> =
            (0..factors.len()).map(|i| i < scenario.blocked.encounters).collect();
        blocked.shuffle(&mut rng);
        let first = s.first_slot_s.min(FIRST_SHARE * scenario.duration_s);
        let spacing = s.slot_spacing_s.min(SPACING_SHARE * scenario.duration_s);
        let slots = factors.into_iter().zip(blocked).enumerate();
        let slots = slots
            .map(|(i, (factor, blocked))| Slot {
                opens_s: first + spacing * i as f64,
                factor,
                blocked,
            })
            .take_while(|slot| slot.opens_s < scenario.duration_s - USEFUL_S)
            .collect();
        Self { settings: s.clone(), posted_mps, slots, next: 0, current: None }
    }

    /// Notes which vehicle the last arrival became.
    pub(crate) fn arrived(&mut self, id: VehicleId) {
        self.current = Some(id);
    }

    /// How many leads have come.
    pub(crate) fn count(&self) -> u32 {
        self.next as u32
    }

    /// The next lead, if its slot is open and the road is free; and whether its encounter is blocked.
    pub(crate) fn next(
        &mut self,
        cars: &[Car],
        ego: &EgoView,
        car_length_m: f64,
        time_s: f64,
    ) -> Option<(Arrival, bool)> {
        let slot = *self.slots.get(self.next)?;
        let s = &self.settings;
        let clear = || {
            !cars.iter().any(|car| {
                let distance = distance_m(ego, &car.state);
                car.lane == ego.lane && distance >= 0.0 && distance < s.clear_ahead_m
            })
        };
        if time_s < slot.opens_s || !ego.keeping || !self.last_is_over(cars, ego) || !clear() {
            return None;
        }
        self.next += 1;
        let own_mps = match slot.factor {
            Factor::OfTarget(factor) => factor * ego.target_mps,
            Factor::OfPosted(factor) => factor * self.posted_mps,
        };
        let approach_mps = own_mps.min(s.approach_factor * ego.target_mps);
        let plan = LeadPlan { own_mps, approach_mps, since_s: time_s, phase: LeadPhase::Approach };
        let arrival = Arrival {
            x_m: ego.x_m + s.appears_ahead_m + 0.5 * (ego.length_m + car_length_m),
            lane: ego.lane,
            speed_mps: approach_mps,
            role: Role::Lead(plan),
        };
        Some((arrival, slot.blocked))
    }

    /// Gone, far ahead, behind ego in its lane, or well behind in the other.
    fn last_is_over(&self, cars: &[Car], ego: &EgoView) -> bool {
        let Some(car) = find(cars, self.current) else {
            return true;
        };
        let distance = distance_m(ego, &car.state);
        let behind = car.state.x_m < ego.x_m;
        distance > self.settings.clear_ahead_m
            || (behind && car.lane == ego.lane)
            || (behind && -distance > self.settings.over_behind_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        scenario::Scenario,
        testing::{car, seen_ego},
    };

    #[test]
    fn six_speeds_come_without_replacement_in_an_order_of_the_seed() {
        let scenario = Scenario::paper();
        let order = |seed| {
            LeadSchedule::new(scenario.settings(), 24.5872, seed)
                .slots
                .iter()
                .map(|s| match s.factor {
                    Factor::OfTarget(f) => format!("{f} v_e"),
                    Factor::OfPosted(f) => format!("{f} s"),
                })
                .collect::<Vec<_>>()
        };
        let mut sorted = order(1);
        assert_eq!(sorted, order(1));
        assert!((0..5).any(|seed| order(seed) != sorted));
        sorted.sort();
        assert_eq!(sorted, ["0.85 v_e", "0.9 s", "0.9 v_e", "0.97 v_e", "1 s", "1.1 s"]);
    }

    #[test]
    fn two_encounters_of_six_are_blocked() {
        let schedule = LeadSchedule::new(Scenario::paper().settings(), 24.5872, 3);
        assert_eq!(schedule.slots.iter().filter(|s| s.blocked).count(), 2);
        assert!((schedule.slots[5].opens_s - 470.0).abs() < 1e-9);
    }

    #[test]
    fn two_minutes_have_two_slots() {
        let short = Scenario::paper().with_duration(maveric_domain::Seconds(120.0)).unwrap();
        let schedule = LeadSchedule::new(short.settings(), 24.5872, 3);
        assert_eq!(schedule.slots.len(), 2);
        assert!((schedule.slots[1].opens_s - 60.0).abs() < 1e-9);
    }

    #[test]
    fn a_lead_lets_ego_come_near_keeps_its_speed_and_drives_off_in_the_end() {
        let s = LeadSettings {
            approach_time_gap_s: 2.0,
            approach_limit_s: 50.0,
            drives_off_after_s: 90.0,
            drives_off_faster_mps: 4.0,
            ..Scenario::paper().settings().leads.clone()
        };
        let ego = seen_ego();
        let begun = LeadPlan {
            own_mps: 28.0,
            approach_mps: 22.0,
            since_s: 100.0,
            phase: LeadPhase::Approach,
        };
        let after = |steps: &[(f64, Option<f64>)]| {
            let mut plan = begun;
            let last = steps.iter().map(|(age, gap)| plan.wanted_mps(&s, &ego, *gap, 100.0 + age));
            last.last().unwrap()
        };
        // Two seconds at 20 m/s are near; 50 s are long enough.
        for (steps, expected) in [
            (&[(1.0, Some(40.0))][..], 22.0),
            (&[(1.0, Some(39.9))], 28.0),
            (&[(1.0, Some(39.9)), (2.0, Some(90.0))], 28.0),
            (&[(50.0, None)], 22.0),
            (&[(50.1, None)], 28.0),
            (&[(90.0, Some(90.0))], 28.0),
            (&[(90.1, Some(90.0))], 24.0),
            (&[(90.1, None)], 28.0),
        ] {
            assert!((after(steps) - expected).abs() < 1e-12, "{steps:?}");
        }
    }

    #[test]
    fn a_lead_comes_when_its_slot_is_open_and_the_last_encounter_is_over() {
        let scenario = Scenario::paper();
        let s = &scenario.settings().leads;
        let role = Role::Steady { speed_mps: 20.0, passing_by: false };
        let comes = |cars: &[Car], ego: &EgoView, time_s: f64| {
            let mut schedule = LeadSchedule::new(scenario.settings(), 24.5872, 3);
            schedule.arrived(VehicleId(1));
            schedule.next(cars, ego, 5.0, time_s).is_some()
        };
        let opens = LeadSchedule::new(scenario.settings(), 24.5872, 3).slots[0].opens_s;
        let ego = seen_ego();
        assert!(comes(&[], &ego, opens) && !comes(&[], &ego, opens - 0.1));
        assert!(!comes(&[], &EgoView { keeping: false, ..ego }, opens));
        let (clear, over) = (s.clear_ahead_m, s.over_behind_m);
        for (gap_m, lane, id, expected) in [
            // The last lead: ahead, far ahead, behind in ego's lane, just behind and well behind in the other.
            (clear - 1.0, 1, 1, false),
            (clear + 1.0, 1, 1, true),
            (-1.0, 0, 1, true),
            (1.0 - over, 1, 1, false),
            (-1.0 - over, 1, 1, true),
            // Anybody ahead in ego's lane.
            (clear - 1.0, 0, 2, false),
            (clear + 1.0, 0, 2, true),
            (clear - 1.0, 1, 2, true),
        ] {
            let cars = [car(id, gap_m, lane, 20.0, role)];
            assert_eq!(comes(&cars, &ego, opens), expected, "{gap_m} {lane} {id}");
        }
        let mut schedule = LeadSchedule::new(scenario.settings(), 24.5872, 3);
        let (arrival, _) = schedule.next(&[], &ego, 7.0, opens).unwrap();
        assert_eq!((schedule.count(), arrival.lane), (1, 0));
        assert!((arrival.x_m - s.appears_ahead_m - 6.0).abs() < 1e-12);
        let Role::Lead(plan) = arrival.role else { panic!("a lead") };
        assert!(arrival.speed_mps <= plan.own_mps + 1e-12);
        assert!(arrival.speed_mps <= s.approach_factor * 30.0 + 1e-12);
    }
}
