//! The factors behind a scale: what traits explain of them, and how the rest hangs together.

use crate::{
    effects::{FactorModel, Loadings, weighted},
    error::ParticipantError,
    item_model::ItemModel,
    linear::cholesky,
    person::Participant,
    trait_mixing::TraitMixing,
};
use maveric_domain::{Scale, Subscale};
use std::collections::BTreeMap;

/// One subscale: its items, its loadings on traits.
#[derive(Debug, Clone)]
pub(crate) struct Factor<'a> {
    pub(crate) subscale: &'a Subscale,
    pub(crate) item: ItemModel,
    loadings: &'a Loadings,
}

/// A scale whose scores have its norms.
#[derive(Debug, Clone)]
pub(crate) struct ScaleModel<'a> {
    pub(crate) scale: &'a Scale,
    pub(crate) factors: Vec<Factor<'a>>,
    /// What no trait explains = own_parts · draws; shape `(factors, factors)`.
    own_parts: Vec<Vec<f64>>,
}

impl<'a> ScaleModel<'a> {
    /// Factor = Σ loading · trait + own part, each of variance 1. The own parts are made to correlate so that the scores of
    /// the pairs in [`Scale::correlations`] do as told there; other pairs share traits only, and a factor that is all
    /// trait correlates as the traits do.
    ///
    /// # Errors
    /// [`ParticipantError::BadNorms`] where norms, correlations and loadings contradict each other.
    pub(crate) fn new(
        scale: &'a Scale,
        models: &'a BTreeMap<String, FactorModel>,
        traits: &TraitMixing,
    ) -> Result<Self, ParticipantError> {
        let mut factors = Vec::new();
        // In the order of the scale, so that no file's order changes anybody's answers.
        for subscale in &scale.subscales {
            if let Some(model) = models.get(&subscale.id) {
                factors.push(Factor {
                    subscale,
                    item: ItemModel::from_norms(scale, subscale)?,
                    loadings: &model.loadings,
                });
            }
        }
        let shared = |a: &Loadings, b: &Loadings| -> f64 {
            let terms = a.iter().flat_map(|x| b.iter().map(move |y| (x, y)));
            terms.map(|((t, l), (u, m))| l * m * traits.correlation(*t, *u)).sum()
        };
        let bad = |subscale: &str, problem| ParticipantError::BadNorms {
            scale: scale.id.clone(),
            subscale: subscale.to_owned(),
            problem,
        };
        let n = factors.len();
        let mut rest = vec![vec![0.0; n]; n];
        for (i, factor) in factors.iter().enumerate() {
            let left = 1.0 - shared(factor.loadings, factor.loadings);
            if left < -1e-9 {
                return Err(bad(
                    &factor.subscale.id,
                    "loadings that explain more than the whole factor",
                ));
            }
            rest[i][i] = left.max(0.0);
        }
        let nothing = 1e-9;
        for pair in &scale.correlations {
            let place = |id: &String| factors.iter().position(|f| f.subscale.id == *id);
            let (Some(i), Some(j)) = (place(&pair.of[0]), place(&pair.of[1])) else {
                continue;
            };
            if rest[i][i] < nothing || rest[j][j] < nothing {
                continue;
            }
            let wanted = factors[i].item.factor_correlation(&factors[j].item, pair.r);
            let wanted = wanted.ok_or_else(|| {
                bad(&pair.of[0], "a correlation larger than its reliability allows")
            })?;
            let covariance = wanted - shared(factors[i].loadings, factors[j].loadings);
            (rest[i][j], rest[j][i]) = (covariance, covariance);
        }
        let own_parts = cholesky(&rest).map_err(|_| {
            bad("correlations", "values that contradict each other or the loadings on traits")
        })?;
        Ok(Self { scale, factors, own_parts })
    }

    /// The factors of one person, from a draw a factor.
    pub(crate) fn scores(&self, participant: &Participant, draws: &[f64]) -> Vec<f64> {
        let factor = |(factor, own): (&Factor<'_>, &Vec<f64>)| {
            let traits = weighted(participant, factor.loadings);
            traits + own.iter().zip(draws).map(|(w, z)| w * z).sum::<f64>()
        };
        self.factors.iter().zip(&self.own_parts).map(factor).collect()
    }
}
