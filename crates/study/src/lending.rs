//! Whose style is lent where a condition has somebody else's.

use crate::error::StudyError;
use maveric_domain::{
    ConditionId, DriveId, Embedding, Lent,
    design::{Donors, Matched},
};
use maveric_model::{
    Model,
    style_space::{Donor, FEWEST_DONORS, Matching},
};
use std::collections::BTreeMap;

/// The donors of one condition, each drawn as evenly as can be.
pub struct Lending {
    matching: Matching,
    lenders: Vec<(DriveId, Embedding)>,
    lent: BTreeMap<DriveId, usize>,
    /// Rides, and those of them whose donor is not within reach.
    rides: usize,
    beyond_reach: usize,
}

impl Lending {
    /// `tested` are the drives by hand of those who are tested, the rider's too, but for those beyond what the model has met.
    ///
    /// # Errors
    /// As [`Matching::of`].
    pub fn of(
        model: &Model,
        matched: Matched,
        tested: impl IntoIterator<Item = (DriveId, Embedding)>,
    ) -> Result<Self, StudyError> {
        let mut lenders: Vec<(DriveId, Embedding)> = tested.into_iter().collect();
        if matched.from == Donors::Learned || lenders.len() <= Donors::FROM {
            let training = model.training().iter();
            lenders = training
                .map(|drive| (drive.drive.clone(), drive.embedding.clone()))
                .collect();
        }
        Ok(Self {
            matching: Matching::of(model, matched.apart_sd)?,
            lenders,
            lent: BTreeMap::new(),
            rides: 0,
            beyond_reach: 0,
        })
    }

    /// Counts a style that was lent before.
    pub fn count(&mut self, donor: &DriveId) {
        *self.lent.entry(donor.clone()).or_default() += 1;
    }

    /// Draws a donor for whose style is `own`, learned of `drive`, which is never lent to them; none where nobody else is there.
    ///
    /// # Errors
    /// [`StudyError::Model`] for a style of another model.
    pub fn lend(
        &mut self,
        (drive, own): (&DriveId, &Embedding),
        seed: u64,
    ) -> Result<Option<(Embedding, Lent)>, StudyError> {
        let others: Vec<&(DriveId, Embedding)> = self
            .lenders
            .iter()
            .filter(|lender| lender.0 != *drive)
            .collect();
        let donor = |(drive, style)| Donor {
            style,
            lent: self.lent.get(drive).copied().unwrap_or(0),
        };
        let donors: Vec<Donor<'_>> = others.iter().map(|(d, s)| donor((d, s))).collect();
        let Some((at, style)) = self.matching.draw(own, &donors, seed)? else {
            return Ok(None);
        };
        let donor = others[at].0.clone();
        self.count(&donor);
        self.rides += 1;
        self.beyond_reach += usize::from(!style.within_reach);
        let lent = style.lent_by(donor);
        Ok(Some((style.embedding, lent)))
    }

    /// What a reader has to know of how they were drawn.
    pub fn warnings(&self, condition: ConditionId) -> Vec<String> {
        let few = (self.lenders.len() < FEWEST_DONORS).then(|| {
            format!(
                "condition {condition}: {} drives whose style may be lent, fewer than {FEWEST_DONORS}: it is the same one again and again",
                self.lenders.len()
            )
        });
        let nearest = (self.beyond_reach > 0).then(|| {
            format!(
                "condition {condition}: nobody within reach of {} of {} people, who were lent the nearest style (`donor_within_reach`)",
                self.beyond_reach, self.rides
            )
        });
        few.into_iter().chain(nearest).collect()
    }
}
