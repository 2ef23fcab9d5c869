//! Effects of a factorial design as sets of its factors.

use super::{FactorialDesign, sets::sets_of_factors};

/// A set of factors: bit f stands for the f-th, those between subjects first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Effect(pub(super) usize);

impl Effect {
    /// All effects, main effects first.
    pub(super) fn all(design: &FactorialDesign) -> Vec<Self> {
        let sets = sets_of_factors(design.factors().len()).into_iter();
        sets.map(Self).collect()
    }

    pub(super) fn has(self, factor: usize) -> bool {
        self.0 >> factor & 1 == 1
    }

    /// Positions of its factors.
    pub(super) fn factors(self) -> impl Iterator<Item = usize> {
        (0..usize::BITS as usize).filter(move |f| self.has(*f))
    }

    pub(super) fn name(self, design: &FactorialDesign) -> String {
        let factors = design.factors();
        let names: Vec<&str> = self.factors().map(|f| factors[f].name.as_str()).collect();
        names.join(":")
    }
}
