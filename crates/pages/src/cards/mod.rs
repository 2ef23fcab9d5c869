//! The cards of each page.

pub mod ablation;
pub mod following;
pub mod in_turn;
pub mod rehearsal;
pub mod study;
pub mod validation;
