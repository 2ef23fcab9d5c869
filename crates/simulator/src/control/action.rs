//! What a driver does until the next row.

/// What the car's driver may ask of its steering.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Manoeuvre {
    /// Change to `lane` over `duration_s` at the present speed.
    Change {
        /// Lane to go to.
        lane: u8,
        /// Time the change takes, in s.
        duration_s: f64,
    },
    /// Go back to the lane the change under way came from.
    GoBack {
        /// Time that takes, in s.
        duration_s: f64,
    },
}

/// What a driver does until the next row.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Action {
    pub(crate) acceleration_mps2: f64,
    pub(crate) manoeuvre: Option<Manoeuvre>,
    /// Where in the lane to drive, in m to the left of its centre.
    pub(crate) lane_offset_m: f64,
}

impl Action {
    pub(crate) const NOTHING: Self =
        Self { acceleration_mps2: 0.0, manoeuvre: None, lane_offset_m: 0.0 };
}
