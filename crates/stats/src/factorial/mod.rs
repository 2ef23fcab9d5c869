//! Factorial designs: up to two factors within subjects and two between them.

mod analysis;
mod anova;
mod art;
mod cells;
mod design;
mod effect;
mod means;
mod regression;
mod residuals;
mod sets;
mod unpooled;
mod weights;

pub use analysis::{Factorial, factorial};
pub use anova::FactorialEffect;
pub use art::{AlignedRanks, ArtEffect, ArtStrata, aligned_ranks};
pub(crate) use cells::contrasts;
pub(crate) use design::check_between;
pub use design::{BetweenColumn, Factor, FactorialDesign, WithinColumn};
pub use means::{CellContrast, ExactTest, MarginalMean, SimpleEffect};
pub(crate) use regression::{Regressed, SubjectCovariate, regressed};
pub(crate) use sets::sets_of_factors;
pub(crate) use unpooled::{Unpooled, unpooled};
pub(crate) use weights::{cell_weights, level_weights, stratum_weights};

use effect::Effect;
