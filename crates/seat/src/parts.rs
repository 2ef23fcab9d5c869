//! What was given, checked, on its way to be kept.

/// Lines of a drive, each checked by itself and against the step.
#[derive(Debug, Default)]
pub(crate) struct Parts {
    pub(crate) header: Option<String>,
    /// First step, steps and line of each piece.
    pub(crate) pieces: Vec<(u64, u64, String)>,
    /// The step at which it ended, and the line that says so.
    pub(crate) end: Option<(u64, String)>,
}
