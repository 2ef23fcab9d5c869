//! Whose style is lent where a condition has somebody else's.

use maveric_domain::{
    DriveId, Embedding, Lent,
    design::{Donors, Matched},
};
use maveric_model::{
    Model, ModelError,
    style_space::{Donor, Matching},
};
use std::collections::BTreeMap;

/// The donors of one condition, each drawn as evenly as can be.
#[derive(Debug)]
pub struct Lending {
    matching: Matching,
    lenders: Vec<(DriveId, Embedding)>,
    lent: BTreeMap<DriveId, usize>,
}

impl Lending {
    /// `tested` are the drives by hand of those who are tested, the rider's too, but for those beyond what the model has met.
    ///
    /// # Errors
    /// As [`Matching::of`].
    pub fn of(
        model: &Model,
        matched: Matched,
        tested: Vec<(DriveId, Embedding)>,
    ) -> Result<Self, ModelError> {
        let lenders = if matched.from == Donors::Tested && tested.len() > Donors::FROM {
            tested
        } else {
            let training = model.training().iter();
            training
                .map(|drive| (drive.drive.clone(), drive.embedding.clone()))
                .collect()
        };
        Ok(Self {
            matching: Matching::of(model, matched.apart_sd)?,
            lenders,
            lent: BTreeMap::new(),
        })
    }

    /// How many drives there are whose style may be lent.
    pub fn lenders(&self) -> usize {
        self.lenders.len()
    }

    /// Counts a style that was lent before.
    pub fn count(&mut self, donor: &DriveId) {
        *self.lent.entry(donor.clone()).or_default() += 1;
    }

    /// Draws a donor for whose style is `own`; the drive that it was learned of, where there is one, is never lent to them. None where nobody
    /// else is there.
    ///
    /// # Errors
    /// [`ModelError::EmbeddingSize`] for a style of another model.
    pub fn lend(
        &mut self,
        (drive, own): (Option<&DriveId>, &Embedding),
        seed: u64,
    ) -> Result<Option<(Embedding, Lent)>, ModelError> {
        let lenders = self.lenders.iter();
        let others: Vec<_> = lenders
            .filter(|(lender, _)| Some(lender) != drive)
            .collect();
        let donors = others.iter().map(|(drive, style)| Donor {
            style,
            lent: self.lent.get(drive).copied().unwrap_or(0),
        });
        let donors: Vec<Donor<'_>> = donors.collect();
        let Some((at, style)) = self.matching.draw(own, &donors, seed)? else {
            return Ok(None);
        };
        let donor = others[at].0.clone();
        self.count(&donor);
        let lent = Lent {
            donor,
            donor_shift_points: style.shift_points,
            donor_distance_sd: style.distance_sd,
            donor_within_reach: style.within_reach,
        };
        Ok(Some((style.embedding, lent)))
    }
}
