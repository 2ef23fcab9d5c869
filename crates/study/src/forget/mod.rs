//! Forgetting somebody: everything of theirs goes from a study's folder, but the id in the list of those that are not given again.

mod made;
mod models;
mod person;
mod rows;

pub use crate::named::is_about;
pub use models::{learned_from, refuse_learned_from_gone};
pub use person::{Forgotten, forget_person};
