#![doc = include_str!("../README.md")]

mod donors;
mod error;
pub mod findings;
mod groups;
pub mod leave_out;
mod outcomes;
mod population;
mod power;
mod rates;
#[cfg(test)]
mod testing;
mod unknown_car;
pub mod validation;
mod world;

pub use error::RehearsalError;
pub use outcomes::{Found, Part, Studied, found_in};
pub use population::{
    CarSetting, DerivedMeasure, DrawnMeasure, Drives, LineModel, MeasureModel, PopulationModel,
    Round, Step,
};
pub use power::POWER;
pub use rates::{ALPHA, Cell, FamilyRate, HypothesisRate, TestRate, n_for};
pub use unknown_car::UnknownCar;
pub use world::{Rehearsed, World};
