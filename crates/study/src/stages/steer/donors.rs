//! Whose style is lent where a condition has somebody else's.

use crate::{error::StudyError, tables::embeddings::EmbeddingRow};
use maveric_domain::{
    BeyondWhy, ConditionId, DriveId, Embedding, Lent, ParticipantId,
    design::{Donors, Matched},
};
use maveric_model::{
    Model,
    style_space::{Donor, FEWEST_DONORS, LinearHead, Matching},
};
use std::collections::BTreeMap;

/// Somebody who may lend their style.
struct Lender<'a> {
    drive: &'a DriveId,
    /// None for a drive that the model learned from: its name does not say whose it is.
    whose: Option<&'a ParticipantId>,
    style: &'a Embedding,
}

/// The donors of one condition, each drawn as evenly as can be.
pub(super) struct Lending<'a> {
    matching: Matching,
    lenders: Vec<Lender<'a>>,
    lent: BTreeMap<&'a DriveId, usize>,
    /// Rides, and those of them whose donor is not within reach.
    rides: usize,
    beyond_reach: usize,
}

impl<'a> Lending<'a> {
    /// Who may lend: of the tested none whose drive is beyond what the model has met.
    pub(super) fn of(
        model: &'a Model,
        matched: Matched,
        tested: &[&'a EmbeddingRow],
        dial: &LinearHead,
    ) -> Result<Self, StudyError> {
        let mut lenders = Vec::new();
        if matched.from == Donors::Tested && tested.len() > Donors::FROM {
            for row in tested {
                let hat = dial.read(&row.embedding)?;
                if BeyondWhy::of_reading(Some(hat), row.beyond_why.clone())
                    .1
                    .is_none()
                {
                    lenders.push(Lender {
                        drive: &row.drive,
                        whose: Some(&row.participant),
                        style: &row.embedding,
                    });
                }
            }
        } else {
            lenders.extend(model.training().iter().map(|drive| Lender {
                drive: &drive.drive,
                whose: None,
                style: &drive.embedding,
            }));
        }
        Ok(Self {
            matching: Matching::of(model, matched.apart_sd)?,
            lenders,
            lent: BTreeMap::new(),
            rides: 0,
            beyond_reach: 0,
        })
    }

    /// Draws a donor for a person, who never lends to themselves; none where nobody else is there.
    pub(super) fn lend(
        &mut self,
        person: &EmbeddingRow,
        seed: u64,
    ) -> Result<Option<(Embedding, Lent)>, StudyError> {
        let others = self.lenders.iter().filter(|lender| {
            lender.whose != Some(&person.participant) && *lender.drive != person.drive
        });
        let others: Vec<&Lender<'_>> = others.collect();
        let donor = |lender: &&Lender<'a>| Donor {
            style: lender.style,
            lent: self.lent.get(lender.drive).copied().unwrap_or(0),
        };
        let donors: Vec<Donor<'_>> = others.iter().map(donor).collect();
        let Some((at, style)) = self.matching.draw(&person.embedding, &donors, seed)? else {
            return Ok(None);
        };
        let drive = others[at].drive;
        *self.lent.entry(drive).or_default() += 1;
        self.rides += 1;
        self.beyond_reach += usize::from(!style.within_reach);
        let lent = Lent {
            donor: drive.clone(),
            donor_shift_points: style.shift_points,
            donor_distance_sd: style.distance_sd,
            donor_within_reach: style.within_reach,
        };
        Ok(Some((style.embedding, lent)))
    }

    /// What a reader has to know of how they were drawn.
    pub(super) fn warnings(&self, condition: ConditionId) -> Vec<String> {
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
