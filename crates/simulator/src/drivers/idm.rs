//! Car-following of people: the improved Intelligent Driver Model.

use maveric_laws::Idm;

/// Hardest braking of a person who follows, in m/s².
const HARDEST_MPS2: f64 = 8.0;

/// What a driver wants of the road at one instant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Following {
    /// The model's parameters.
    pub(crate) idm: Idm,
    /// Factor on the whole desired gap: below 1 for a driver who is about to pass.
    pub(crate) gap_factor: f64,
}

/// The lead as a driver sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SeenLead {
    /// Bumper to bumper, in m.
    pub(crate) gap_m: f64,
    /// Ego's speed minus the lead's, in m/s.
    pub(crate) closing_mps: f64,
}

impl Following {
    /// Acceleration wanted at `speed_mps`, in m/s², never below -8.
    pub(crate) fn acceleration_mps2(&self, speed_mps: f64, lead: Option<SeenLead>) -> f64 {
        let (gap_m, lead_mps) = lead
            .map_or((f64::INFINITY, speed_mps), |lead| (lead.gap_m, speed_mps - lead.closing_mps));
        self.idm.improved_accel_mps2(gap_m, speed_mps, lead_mps, self.gap_factor).max(-HARDEST_MPS2)
    }
}
