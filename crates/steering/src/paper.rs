//! From a probability to a wish: the paper's δ, or what has added up.

use maveric_domain::{LaneActivity, LaneWish, Reference, Road, VehicleId, When};
use maveric_simulator::{ChangeRule, ControllerSettings, PLANNING_RATE_HZ, View};

/// P is taken as at most this, so that Λ stays finite.
const SUREST: f64 = 1.0 - 1e-9;

/// Makes a wish of P(change).
///
/// # Source
/// Paper: a change starts where P exceeds δ. Calibration section 4: people's timing is uncertain and P seldom gets high, so by default
/// Λ = Σ −ln(1 − P) per second adds up since this reference vehicle became the reference or the last change ended. Without a reference
/// vehicle there is nothing to pass and nothing adds up (ours).
#[derive(Debug, Clone)]
pub struct PaperRule {
    rule: ChangeRule,
    move_out_above: f64,
    move_back_above: f64,
    probability_above: f64,
    reference: Option<VehicleId>,
    hazard: f64,
    last: LaneActivity,
}

impl PaperRule {
    /// The rule with the thresholds of `settings`.
    pub fn new(settings: &ControllerSettings) -> Self {
        Self {
            rule: settings.change_rule,
            move_out_above: settings.hazard_threshold,
            move_back_above: settings.merge_back_hazard_threshold,
            probability_above: settings.probability_threshold,
            reference: None,
            hazard: 0.0,
            last: LaneActivity::Keeping,
        }
    }

    /// What is wanted of the lane at `probability`, the chance that a change starts within a second; one call a row.
    pub fn wish(&mut self, view: &View<'_>, probability: f64) -> LaneWish {
        let before = std::mem::replace(&mut self.last, view.activity);
        match view.activity {
            LaneActivity::Changing | LaneActivity::GoingBack => return LaneWish::Stay,
            LaneActivity::Keeping | LaneActivity::Waiting => {}
        }
        // A change carried out starts the count again; one given up is still wanted.
        if before == LaneActivity::Changing {
            self.hazard = 0.0;
        }
        let reference = &view.reference;
        if reference.vehicle != self.reference {
            self.reference = reference.vehicle;
            self.hazard = 0.0;
        }
        if reference.vehicle.is_some() {
            self.hazard -= libm::log1p(-probability.min(SUREST)) / PLANNING_RATE_HZ;
        }
        let out = goes_out(view.road, view.lane, reference);
        let due = match self.rule {
            ChangeRule::Accumulated if out => self.hazard > self.move_out_above,
            ChangeRule::Accumulated => self.hazard > self.move_back_above,
            ChangeRule::Paper => probability > self.probability_above,
        };
        match (due, out) {
            (false, _) => LaneWish::Stay,
            (true, true) => LaneWish::MoveOut(When::Now),
            (true, false) => LaneWish::MoveBack(When::Now),
        }
    }
}

/// Whether a change from `lane` goes to the left.
///
/// Out of the right lane to the left, out of the leftmost to the right, as on the paper's two lanes; in between to the
/// left while the reference vehicle is ahead in ego's lane, and back once it is not (ours).
fn goes_out(road: &Road, lane: u8, reference: &Reference) -> bool {
    let own_lane = reference.dy_m.abs() < 0.5 * road.lane_width_m;
    let to_pass = reference.vehicle.is_some() && own_lane && reference.dx_m > 0.0;
    let leftmost = lane + 1 >= road.lanes;
    lane == 0 || (to_pass && !leftmost)
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::{EgoState, Scene};
    use maveric_simulator::Scenario;

    fn settings() -> ControllerSettings {
        Scenario::paper().settings().controllers.clone()
    }

    fn reference(id: u32) -> Reference {
        Reference { vehicle: Some(VehicleId(id)), ..Reference::free_road(&Road::PAPER) }
    }

    /// What `rule` wishes in `lane`, behind the vehicle `id`.
    fn ask(
        rule: &mut PaperRule,
        (lane, id): (u8, u32),
        activity: LaneActivity,
        p: f64,
    ) -> LaneWish {
        let scene = Scene {
            time_s: 0.0,
            ego: EgoState { x_m: 0.0, y_m: 0.0, speed_mps: 30.0, length_m: 4.7 },
            vehicles: Vec::new(),
        };
        let view =
            View { scene: &scene, road: &Road::PAPER, reference: reference(id), lane, activity };
        rule.wish(&view, p)
    }

    fn rows_until_due(rule: &mut PaperRule, lane: u8, p: f64) -> usize {
        let keeping = LaneActivity::Keeping;
        (0..2000).take_while(|_| ask(rule, (lane, 1), keeping, p) == LaneWish::Stay).count()
    }

    #[test]
    fn small_probabilities_add_up_to_a_wish() {
        // 0.4 / -ln(0.9) = 3.8 s.
        let rows = rows_until_due(&mut PaperRule::new(&settings()), 0, 0.1);
        assert!((rows as f64 * 0.05 - 3.8).abs() < 0.1, "{rows}");
    }

    #[test]
    fn moving_out_and_back_have_their_own_thresholds() {
        let later = ControllerSettings { merge_back_hazard_threshold: 0.8, ..settings() };
        let rows = |lane| rows_until_due(&mut PaperRule::new(&later), lane, 0.1);
        assert!(rows(1).abs_diff(2 * rows(0)) <= 2);
    }

    #[test]
    fn another_reference_vehicle_or_a_change_carried_out_starts_the_count_again() {
        let keeping = LaneActivity::Keeping;
        for (between, carried_out) in
            [(LaneActivity::Changing, true), (LaneActivity::GoingBack, false)]
        {
            let mut rule = PaperRule::new(&settings());
            for _ in 0..70 {
                assert_eq!(ask(&mut rule, (0, 1), keeping, 0.1), LaneWish::Stay);
            }
            ask(&mut rule, (0, 1), between, 0.1);
            assert_eq!(rows_until_due(&mut rule, 0, 0.1) > 70, carried_out);
        }
        let mut rule = PaperRule::new(&settings());
        for id in [1, 2, 3] {
            for _ in 0..70 {
                assert_eq!(ask(&mut rule, (0, id), keeping, 0.1), LaneWish::Stay);
            }
        }
    }

    #[test]
    fn the_rule_of_the_paper_looks_at_this_moment_only() {
        let paper = ControllerSettings { change_rule: ChangeRule::Paper, ..settings() };
        let mut rule = PaperRule::new(&paper);
        assert_eq!(rows_until_due(&mut rule, 0, 0.19), 2000);
        assert_eq!(
            ask(&mut rule, (0, 1), LaneActivity::Keeping, 0.21),
            LaneWish::MoveOut(When::Now)
        );
    }

    #[test]
    fn between_two_lanes_a_change_passes_what_is_ahead_and_else_goes_back() {
        let road = Road { lanes: 4, ..Road::PAPER };
        let seen = |dx_m, dy_m| Reference { dx_m, dy_m, ..reference(1) };
        assert!(goes_out(&road, 0, &Reference::free_road(&road)));
        assert!(goes_out(&road, 1, &seen(30.0, 0.1)));
        assert!(!goes_out(&road, 2, &seen(-30.0, -3.6)));
        assert!(goes_out(&road, 2, &seen(30.0, 0.0)));
        assert!(!goes_out(&road, 3, &seen(30.0, 0.0)));
        assert!(!goes_out(&Road::PAPER, 1, &seen(30.0, 0.0)));
    }
}
