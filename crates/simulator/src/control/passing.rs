//! Driving up to a vehicle that is about to be passed.

use super::safety::safe_distance_m;
use crate::{neighbours::Neighbour, planner::PLANNING_STEP_S, scenario::ControllerSettings};
use maveric_domain::VehicleId;
use maveric_laws::needed_braking_mps2;

/// Lets a car that means to pass, and may, come nearer to the lead than it would follow: within bounds.
///
/// The car then brakes only for what a late swerve or braking of `intervenes_above_mps2` would no longer avoid; both must
/// still be open. Inside the safe distance it may spend `passing_inside_s` a lead, and never under
/// `passing_least_share` of it: beyond either it follows like anybody.
///
/// # Source
/// Ours: people pull out at 1.3 to 1.6 s behind a lead that they close in on; a car that brakes for the gap it would follow at
/// never comes so near.
#[derive(Debug, Clone, Default)]
pub(super) struct DrivingUp {
    lead: Option<VehicleId>,
    inside_s: f64,
}

impl DrivingUp {
    /// Whether `lead` may be driven up to now; one call a row and lead.
    pub(super) fn may(
        &mut self,
        settings: &ControllerSettings,
        ego_mps: f64,
        lead: &Neighbour,
    ) -> bool {
        if self.lead != Some(lead.vehicle.id) {
            self.lead = Some(lead.vehicle.id);
            self.inside_s = 0.0;
        }
        let lead_mps = lead.vehicle.speed_mps;
        let safe_m = safe_distance_m(settings, ego_mps, lead_mps);
        if lead.gap_m < safe_m {
            self.inside_s += PLANNING_STEP_S;
        }
        let response_m = (ego_mps - lead_mps).max(0.0) * settings.closing_response_s;
        let gap_m = lead.gap_m - response_m;
        self.inside_s <= settings.passing_inside_s
            && lead.gap_m >= settings.passing_least_share * safe_m
            && needed_braking_mps2(gap_m, settings.margin_m, ego_mps, lead_mps, 0.0)
                < settings.intervenes_above_mps2
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::VehicleState;
    use std::sync::LazyLock;

    static SETTINGS: LazyLock<ControllerSettings> = LazyLock::new(ControllerSettings::default);

    fn lead(id: u32, gap_m: f64, speed_mps: f64) -> Neighbour {
        let vehicle =
            VehicleState { id: VehicleId(id), x_m: gap_m, y_m: 0.0, speed_mps, length_m: 4.7 };
        Neighbour { vehicle, gap_m }
    }

    #[test]
    fn a_lead_is_driven_up_to_for_a_while_and_another_one_again() {
        let safe_m = safe_distance_m(&SETTINGS, 30.0, 28.0);
        let gap_m = (0.5 + 0.5 * SETTINGS.passing_least_share) * safe_m;
        let mut up = DrivingUp::default();
        let rows = |up: &mut DrivingUp, id| {
            (0..1000).take_while(|_| up.may(&SETTINGS, 30.0, &lead(id, gap_m, 28.0))).count()
        };
        let most = (SETTINGS.passing_inside_s / PLANNING_STEP_S) as usize;
        assert!(rows(&mut up, 1).abs_diff(most) <= 1);
        assert_eq!(rows(&mut up, 1), 0);
        assert!(rows(&mut up, 2).abs_diff(most) <= 1);
    }

    #[test]
    fn nobody_is_driven_up_to_beyond_the_bounds() {
        let may = |gap_m, speed_mps| {
            DrivingUp::default().may(&SETTINGS, 30.0, &lead(1, gap_m, speed_mps))
        };
        assert!(may(40.0, 27.0));
        assert!(!may(
            0.99 * SETTINGS.passing_least_share * safe_distance_m(&SETTINGS, 30.0, 27.0),
            27.0
        ));
        // 15 m/s faster at 35 m: 3.5 m/s² would no longer do.
        assert!(!may(35.0, 15.0));
    }
}
