//! A driver's habits as set-points: a free speed, a gap and a wish.

use maveric_domain::{LaneWish, MetresPerSecond, Reference, Setpoints, When};
use maveric_model::Habits;
use maveric_simulator::{ControllerSettings, View, safe_distance};

/// Time from a wish to where a change of lane shows (0.15 m/s sideways), in s: habits are read where a change shows, so the wish comes
/// that much sooner. It is what this car takes, out and back alike.
const SHOWS_AFTER_S: f64 = 0.3;
/// Probability of passing from which a pass is meant.
const MEANT: f64 = 0.5;
/// Least speed over the vehicle beside, in m/s: else a pass never ends.
const LEAST_OVER_MPS: f64 = 1.0;

/// Asks for what a driver's habits say of the situation.
///
/// A pass is meant where it is likelier than not, and wished for at the driver's own time gap, or where the car comes no nearer;
/// merging back is wished for once the vehicle that was passed is the driver's own time gap behind. Where nothing of a kind was
/// learned, nothing of it is asked: the posted speed, the safe distance, the own lane.
#[derive(Debug, Clone)]
pub struct HabitRule {
    habits: Habits,
    settings: ControllerSettings,
}

impl HabitRule {
    /// Takes a driver's habits, and the settings of the car that carries them out.
    pub fn new(habits: Habits, settings: ControllerSettings) -> Self {
        Self { habits, settings }
    }

    /// What this driver asks for now.
    pub fn setpoints(&self, view: &View<'_>) -> Setpoints {
        let own_mps = self.habits.free_speed_mps(Some(view.road.posted_speed_mps));
        let free_mps = own_mps.unwrap_or(view.road.posted_speed_mps);
        let place = Place::from_view(view);
        let lead_mps = match place {
            Place::Behind(lead) => lead.speed_mps,
            _ => view.scene.ego.speed_mps,
        };
        let gap_s = self.habits.following_gap_s(free_mps, lead_mps);
        Setpoints {
            speed_mps: match place {
                Place::Passing(beside) => self.passing_speed_mps(free_mps, beside.speed_mps),
                _ => free_mps,
            },
            following_distance_m: gap_s.unwrap_or(0.0) * lead_mps,
            wish: self.wish(view, free_mps, place),
        }
    }

    fn passing_speed_mps(&self, free_mps: f64, beside_mps: f64) -> f64 {
        let over = self.habits.passing_speed_over_mps(free_mps, beside_mps);
        over.map_or(free_mps, |over| beside_mps + over.max(LEAST_OVER_MPS))
    }

    fn wish(&self, view: &View<'_>, free_mps: f64, place: Place) -> LaneWish {
        let ego_mps = view.scene.ego.speed_mps;
        match place {
            Place::Behind(lead) if view.lane + 1 < view.road.lanes => {
                let likely = self.habits.passes(free_mps, lead.speed_mps);
                let own_s = self.habits.move_out_s();
                let (true, Some(at_s)) = (likely.is_some_and(|p| p > MEANT), own_s) else {
                    return LaneWish::Stay;
                };
                let closing_mps = ego_mps - lead.speed_mps;
                let shown_m = lead.dx_m - closing_mps * SHOWS_AFTER_S;
                let at_m = (at_s * ego_mps).max(self.nearest_m(ego_mps, lead.speed_mps));
                LaneWish::MoveOut(when(shown_m <= at_m))
            }
            Place::Passing(passed) => match self.habits.merge_back_s() {
                None => LaneWish::Stay,
                Some(at_s) => {
                    let opening_mps = ego_mps - passed.speed_mps;
                    let shown_m = -passed.dx_m + opening_mps * SHOWS_AFTER_S;
                    LaneWish::MoveBack(when(passed.dx_m < 0.0 && shown_m >= at_s * ego_mps))
                }
            },
            _ => LaneWish::Stay,
        }
    }

    /// The gap to which the car drives up at most before a pass, in m: to wait for a shorter one is to wait for ever.
    fn nearest_m(&self, ego_mps: f64, lead_mps: f64) -> f64 {
        let [ego, lead] = [ego_mps, lead_mps].map(MetresPerSecond);
        self.settings.passing_least_share * safe_distance(&self.settings, ego, lead).0
    }
}

fn when(now: bool) -> When {
    if now { When::Now } else { When::NotYet }
}

/// Where ego is to its reference vehicle.
#[derive(Debug, Clone, Copy)]
enum Place {
    /// Behind it, in its lane.
    Behind(Reference),
    /// In a lane to its left.
    Passing(Reference),
    /// Neither.
    Free,
}

impl Place {
    fn from_view(view: &View<'_>) -> Self {
        let reference = view.reference;
        let half = 0.5 * view.road.lane_width_m;
        if reference.vehicle.is_none() {
            Self::Free
        } else if reference.dy_m < -half {
            Self::Passing(reference)
        } else if reference.dy_m <= half && reference.dx_m > 0.0 {
            Self::Behind(reference)
        } else {
            Self::Free
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::{EgoState, Embedding, LaneActivity, Road, Scene, VehicleId};
    use maveric_model::{HEADS, Model};
    use maveric_simulator::Scenario;
    use serde_json::json;

    /// Free speed 30 m/s, 2 s behind, moves out at 1.5 s unless it is `move_out_s`, back at 1 s, passes at 2 m/s of difference.
    fn rule(move_out_s: f64) -> HabitRule {
        let heads = HEADS.iter().map(|head| {
            let common = match head.name {
                "free_speed_mps" => vec![30.0],
                "following_gap_s" => vec![2.0_f64.ln(), 0.0],
                "move_out_s" => vec![move_out_s.ln()],
                "merge_back_s" => vec![0.0],
                "pass" => vec![-20.0, 10.0],
                _ => vec![4.0, 0.0],
            };
            json!({"name": head.name, "family": head.family, "common": common, "slopes": [0.0], "between_sd": 1.0, "within_sd": 0.0, "events": 1, "drives": 1})
        });
        let heads: Vec<_> = heads.collect();
        let covariance: Vec<f64> = (0..36).map(|at| f64::from(u8::from(at % 7 == 0))).collect();
        let model: Model = serde_json::from_value(json!({
            "embedding_size": 1, "score_range": [11.0, 55.0], "training": [],
            "population": {"people": 1, "mean": [0.0, 0.0, 0.0, 0.0, 0.0, 0.0], "covariance": covariance},
            "posted": {"free_speed": "absolute", "lowest_mps": 20.0, "highest_mps": 40.0, "mean_mps": 30.0},
            "heads": {"linear": {"heads": heads, "style": null}},
        }))
        .unwrap();
        let habits = Habits::new(&model, &Embedding::new(vec![0.0]).unwrap()).unwrap();
        HabitRule::new(habits, Scenario::paper().settings().controllers.clone())
    }

    /// What `rule` asks for at 30 m/s with a vehicle at `lead_mps`, `dx_m` ahead and `dy_m` to the left.
    fn asked(rule: &HabitRule, lane: u8, lead_mps: f64, dx_m: f64, dy_m: f64) -> Setpoints {
        let scene = Scene {
            time_s: 0.0,
            ego: EgoState { x_m: 0.0, y_m: 0.0, speed_mps: 30.0, length_m: 4.7 },
            vehicles: Vec::new(),
        };
        rule.setpoints(&View {
            scene: &scene,
            road: &Road::PAPER,
            reference: Reference { vehicle: Some(VehicleId(1)), speed_mps: lead_mps, dx_m, dy_m },
            lane,
            activity: LaneActivity::Keeping,
        })
    }

    #[test]
    fn a_pass_is_wished_for_so_that_it_shows_at_the_own_gap() {
        let rule = rule(1.5);
        let wish = |dx_m| asked(&rule, 0, 25.0, dx_m, 0.0).wish;
        // 45 m, and 5 m/s for 0.3 s.
        assert_eq!(wish(46.6), LaneWish::MoveOut(When::NotYet));
        assert_eq!(wish(46.4), LaneWish::MoveOut(When::Now));
    }

    #[test]
    fn who_gains_too_little_stays_behind_at_the_own_gap() {
        let asked = asked(&rule(1.5), 0, 29.0, 40.0, 0.0);
        assert_eq!(asked.wish, LaneWish::Stay);
        assert!((asked.following_distance_m - 58.0).abs() < 1e-9);
        assert!((asked.speed_mps - 30.0).abs() < 1e-9);
    }

    #[test]
    fn a_gap_that_the_car_never_comes_to_is_not_waited_for() {
        let nearest_m = rule(0.1).nearest_m(30.0, 25.0);
        let wish = |dx_m| asked(&rule(0.1), 0, 25.0, dx_m, 0.0).wish;
        assert!(nearest_m > 10.0);
        assert_eq!(wish(nearest_m + 1.4), LaneWish::MoveOut(When::Now));
    }

    #[test]
    fn beside_a_vehicle_its_speed_and_the_own_excess_then_back_at_the_own_gap() {
        let rule = rule(1.5);
        let beside = asked(&rule, 1, 25.0, 10.0, -3.66);
        assert!((beside.speed_mps - 29.0).abs() < 1e-9);
        assert_eq!(beside.wish, LaneWish::MoveBack(When::NotYet));
        let wish = |dx_m| asked(&rule, 1, 25.0, dx_m, -3.66).wish;
        assert_eq!(wish(-28.4), LaneWish::MoveBack(When::NotYet));
        assert_eq!(wish(-28.6), LaneWish::MoveBack(When::Now));
    }
}
