//! `stats`: one test on a tidy table.

mod call;
mod choices;
mod columns;
mod input;
mod methods;
mod pictures;
mod printed;
mod ran;
mod roles;
mod rows;
mod statistical_test;

pub use call::Call;
pub use input::{Input, ROW};
pub use methods::AnyTest;
pub use statistical_test::Test;
