//! Forgetting somebody: everything of theirs goes from a study's folder, but the id in the list of those that are not given again.

mod about;
mod made;
mod models;
mod person;
mod rows;

pub use about::is_about;
pub use models::{learned_from, refuse_learned_from_gone};
pub use person::{Forgotten, forget_person};
