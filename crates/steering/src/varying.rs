//! A planner whose speed, gap and place in the lane wander as a person's do.

use maveric_domain::{Setpoints, Variability, Wander, stream_seed};
use maveric_simulator::{ControllerSettings, OrnsteinUhlenbeck, PLANNING_STEP_S, Planner, View};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// Largest SD of speed (m/s), of the logarithm of the gap and of the place in the lane (m) that is driven.
const LARGEST_SD: [f64; 3] = [2.0, 0.4, 0.3];
/// Shortest and longest lag, in s.
const LAG_S: (f64, f64) = (1.0, 60.0);
/// A wander further than this many SDs is held back.
const MOST_SDS: f64 = 2.5;

/// One value that wanders: two equal lags, as [`Wander`] says.
#[derive(Debug, Clone)]
struct Wandering {
    pushed: OrnsteinUhlenbeck,
    keep: f64,
    time_s: f64,
    most: f64,
    value: f64,
    rate_per_s: f64,
}

impl Wandering {
    /// None for a value that stands still.
    fn new(wander: Option<Wander>, largest_sd: f64, seed: u64, name: &str) -> Option<Self> {
        let wander = wander.filter(|w| w.sd > 0.0 && w.sd.is_finite() && w.time_s.is_finite())?;
        let sd = wander.sd.min(largest_sd);
        let time_s = wander.time_s.clamp(LAG_S.0, LAG_S.1);
        let rng = Pcg64Mcg::seed_from_u64(stream_seed(seed, &["varying", name]));
        // A second lag as long as the first one halves the variance.
        let push_sd = sd * std::f64::consts::SQRT_2;
        let mut pushed = OrnsteinUhlenbeck::new(push_sd, time_s, PLANNING_STEP_S, rng);
        let value = 0.5 * pushed.next();
        Some(Self {
            pushed,
            keep: libm::exp(-PLANNING_STEP_S / time_s),
            time_s,
            most: MOST_SDS * sd,
            value,
            rate_per_s: 0.0,
        })
    }

    fn step(&mut self) {
        let push = self.pushed.next();
        self.rate_per_s = (push - self.value) / self.time_s;
        self.value = self.keep * self.value + (1.0 - self.keep) * push;
    }

    /// The value `ahead_s` from now if it went on as it does.
    fn ahead(&self, ahead_s: f64) -> f64 {
        (self.value + ahead_s * self.rate_per_s).clamp(-self.most, self.most)
    }
}

/// A planner with a person's variability on top: how fast it would drive, how near, and where in the lane.
///
/// What the car may do is decided after it, as without: no safe distance, bound of acceleration or of jerk changes.
#[derive(Debug)]
pub struct Varying<P> {
    inner: P,
    speed: Option<Wandering>,
    gap: Option<Wandering>,
    place: Option<Wandering>,
    place_m: f64,
    lag_s: f64,
}

impl<P: Planner> Varying<P> {
    /// Lets what `inner` asks for wander; `seed` is the drive's.
    pub fn new(
        inner: P,
        variability: &Variability,
        settings: &ControllerSettings,
        seed: u64,
    ) -> Self {
        let [speed, gap, place] = LARGEST_SD;
        let v = variability;
        Self {
            inner,
            speed: Wandering::new(v.free_speed, speed, seed, "speed"),
            gap: Wandering::new(v.gap, gap, seed, "gap"),
            place: Wandering::new(v.place, place, seed, "place"),
            place_m: v.place_m.filter(|m| m.is_finite()).unwrap_or(0.0),
            lag_s: 1.0 / settings.velocity_gain_per_s,
        }
    }

    /// The planner below.
    pub fn into_inner(self) -> P {
        self.inner
    }
}

impl<P: Planner> Planner for Varying<P> {
    fn plan(&mut self, view: &View<'_>) -> Setpoints {
        let offsets = [&mut self.speed, &mut self.gap, &mut self.place];
        offsets.into_iter().flatten().for_each(Wandering::step);
        let planned = self.inner.plan(view);
        // The car comes to a speed one lag of its controller late.
        let added_mps = self.speed.as_ref().map_or(0.0, |s| s.ahead(self.lag_s));
        let factor = self.gap.as_ref().map_or(1.0, |g| libm::exp(g.ahead(0.0)));
        Setpoints {
            speed_mps: planned.speed_mps + added_mps,
            following_distance_m: planned.following_distance_m * factor,
            ..planned
        }
    }

    fn lane_offset_m(&self) -> f64 {
        let weave_m = self.place.as_ref().map_or(0.0, |p| p.ahead(0.0));
        self.inner.lane_offset_m() + self.place_m + weave_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::{Drive, DriveMeta, DrivenBy, LaneWish, Seconds};
    use maveric_model::variability;
    use maveric_simulator::{Driver, Rollout, Scenario, rollout};

    const WANDERS: Variability = Variability {
        free_speed: Some(Wander {
            sd: 0.5,
            time_s: 8.0,
        }),
        gap: None,
        place: Some(Wander {
            sd: 0.12,
            time_s: 4.0,
        }),
        place_m: Some(-0.1),
    };

    fn steady(_: &View<'_>) -> Setpoints {
        Setpoints {
            speed_mps: 28.0,
            following_distance_m: 40.0,
            wish: LaneWish::Stay,
        }
    }

    /// Half an hour on a road with nobody on it.
    fn driven(variability: &Variability, seed: u64) -> Rollout {
        let paper = Scenario::paper().with_duration(Seconds(1800.0)).unwrap();
        let mut settings = paper.settings().clone();
        settings.leads.factors_of_target.clear();
        settings.leads.factors_of_posted.clear();
        settings.off_lane.interval_s = [1e5, 1e5];
        let scenario = Scenario::try_from(settings).unwrap();
        let controllers = &scenario.settings().controllers;
        let mut planner = Varying::new(steady, variability, controllers, seed);
        rollout(&scenario, Driver::Automated(&mut planner, controllers), 1).unwrap()
    }

    #[test]
    fn the_car_wanders_as_much_and_at_the_pace_that_it_is_asked_to() {
        let driven = driven(&WANDERS, 3);
        let meta = DriveMeta::named("car", "P01", "mimic", DrivenBy::Automated).unwrap();
        let found = variability(&Drive::from_recording(meta, &driven.recording).unwrap());
        let near = |found: Option<Wander>, asked: Option<Wander>| {
            let (found, asked) = (found.unwrap(), asked.unwrap());
            assert!((found.sd / asked.sd - 1.0).abs() < 0.2, "{found:?}");
            assert!((found.time_s / asked.time_s - 1.0).abs() < 0.3, "{found:?}");
        };
        near(found.free_speed, WANDERS.free_speed);
        near(found.place, WANDERS.place);
        assert!((found.place_m.unwrap() + 0.1).abs() < 0.03, "{found:?}");
    }

    #[test]
    fn one_seed_is_one_drive_and_nothing_that_wanders_is_the_planner_itself() {
        let [once, again, other] = [3, 3, 4].map(|seed| driven(&WANDERS, seed).recording);
        assert_eq!(once, again);
        assert_ne!(once, other);
        let still = driven(&Variability::default(), 3);
        assert!(still.trace.len() > 30_000);
        let mut asked = still.trace.iter().map(|row| row.asked);
        assert!(asked.all(|asked| (asked.speed_mps - 28.0).abs() <= 0.0));
        assert!(still.recording.ego().y_m.iter().all(|y| y.abs() < 1e-6));
    }

    #[test]
    fn no_wander_goes_beyond_its_bound_however_much_is_asked() {
        let wild = Wander {
            sd: 1e6,
            time_s: 1e-9,
        };
        let mut wandering = Wandering::new(Some(wild), 2.0, 1, "speed").unwrap();
        for _ in 0..10_000 {
            wandering.step();
            assert!(wandering.ahead(2.0).abs() <= 5.0);
        }
        for sd in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let none = Wander { sd, time_s: 5.0 };
            assert!(Wandering::new(Some(none), 2.0, 1, "speed").is_none());
        }
    }
}
