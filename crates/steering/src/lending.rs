//! Whose style is lent where a condition has somebody else's.

use maveric_domain::{
    DriveId, Embedding, Lent,
    design::{Donors, Matched},
};
use maveric_model::{
    Model, ModelError,
    style_space::{Donor, Matching},
};
use std::collections::{BTreeMap, BTreeSet};

/// The donors of one condition, each drawn as evenly as can be.
#[derive(Debug)]
pub struct Lending {
    matching: Matching,
    lenders: Vec<(DriveId, Embedding)>,
    lent: BTreeMap<DriveId, usize>,
}

impl Lending {
    /// `tested` are the drives by hand of those who are tested and lend their style, the rider's too, but for those beyond what the model has
    /// met; `withheld` those that the model learned from whose style may not be lent.
    ///
    /// # Errors
    /// As [`Matching::of`].
    pub fn of(
        model: &Model,
        matched: Matched,
        tested: Vec<(DriveId, Embedding)>,
        withheld: &BTreeSet<DriveId>,
    ) -> Result<Self, ModelError> {
        let lenders = if matched.from == Donors::Tested && tested.len() > Donors::FROM {
            tested
        } else {
            let training = model.training().iter();
            training
                .filter(|drive| !withheld.contains(&drive.drive))
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
        let others: Vec<_> = lenders.filter(|(lender, _)| Some(lender) != drive).collect();
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

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// Two directions, the first of which is the dial; ten drives around the middle.
    fn model() -> Model {
        let training: Vec<_> = (0..10_i32)
            .map(|i| {
                let (along, across) = (f64::from(i % 5) / 2.0 - 1.0, f64::from(i % 3) - 1.0);
                json!({"drive": format!("L{i}-own"), "embedding": [along, across], "mean_speed_mps": 27.0})
            })
            .collect();
        let heads = maveric_model::HEADS.iter().map(|head| {
            let common = match head.name {
                "free_speed_mps" | "move_out_s" | "merge_back_s" => vec![1.0],
                _ => vec![0.5, 0.0],
            };
            json!({"name": head.name, "family": head.family, "common": common, "slopes": [0.1, 0.1], "between_sd": 1.0, "within_sd": 1.0, "events": 9, "drives": 3})
        });
        let heads: Vec<_> = heads.collect();
        let covariance: Vec<f64> = (0..36).map(|at| f64::from(u8::from(at % 7 == 0))).collect();
        serde_json::from_value(json!({
            "embedding_size": 2,
            "score_range": [11.0, 55.0],
            "training": training,
            "population": {"people": 10, "mean": [0.0, 0.0, 0.0, 0.0, 0.0, 0.0], "covariance": covariance},
            "posted": {"free_speed": "absolute", "lowest_mps": 20.0, "highest_mps": 40.0, "mean_mps": 30.0},
            "heads": {"linear": {
                "heads": heads,
                "style": {
                    "gradient": [10.0, 0.0], "offset": 30.0,
                    "covariance": [0.01, 0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.01], "reading_sd": 1.0,
                    "cross_fitted_rmse": null, "cross_fitted_r": null, "people": 10, "drives": 10,
                },
            }},
        }))
        .unwrap()
    }

    fn drive(id: &str) -> DriveId {
        DriveId::new(id).unwrap()
    }

    fn lending(from: Donors, tested: usize, withheld: &[&str]) -> Lending {
        let style = |i: usize| Embedding::new(vec![0.0, i as f64 / 5.0 - 1.0]).unwrap();
        let tested = (0..tested).map(|i| (drive(&format!("P{i}-own")), style(i)));
        let matched = Matched { from, apart_sd: [0.7, 2.5] };
        let withheld = withheld.iter().map(|id| drive(id)).collect();
        Lending::of(&model(), matched, tested.collect(), &withheld).unwrap()
    }

    #[test]
    fn a_withheld_drive_is_lent_to_nobody_and_the_others_are() {
        let own = Embedding::new(vec![0.0, 0.0]).unwrap();
        let mut all = lending(Donors::Learned, 0, &[]);
        assert_eq!(all.lenders(), 10);
        let lent = |lending: &mut Lending| -> Vec<String> {
            let draws = (0..10).map(|seed| lending.lend((None, &own), seed).unwrap().unwrap());
            draws.map(|(_, lent)| lent.donor.to_string()).collect()
        };
        let met = lent(&mut all);
        let mut fewer = lending(Donors::Learned, 0, &[met[0].as_str(), "stranger-own"]);
        assert_eq!(fewer.lenders(), 9);
        assert!(!lent(&mut fewer).contains(&met[0]));
        let everybody: Vec<String> = (0..10).map(|i| format!("L{i}-own")).collect();
        let everybody: Vec<&str> = everybody.iter().map(String::as_str).collect();
        let mut nobody = lending(Donors::Learned, 0, &everybody);
        assert!(nobody.lend((None, &own), 1).unwrap().is_none());
    }

    #[test]
    fn the_tested_lend_once_there_are_enough_of_them() {
        let few = lending(Donors::Tested, Donors::FROM, &["L3-own"]);
        assert_eq!(few.lenders(), 9);
        let enough = lending(Donors::Tested, Donors::FROM + 1, &["L3-own"]);
        assert_eq!(enough.lenders(), Donors::FROM + 1);
        let learned = lending(Donors::Learned, Donors::FROM + 1, &[]);
        assert_eq!(learned.lenders(), 10);
    }
}
