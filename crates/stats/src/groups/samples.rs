//! The values of each group, less one common value.

use crate::{
    Named, Reasons, StatsError, complete,
    numerics::{
        decimal,
        moments::{is_constant, mean_and_square_sum},
    },
    within_subjects::{Index, each_pair, tell_apart},
};

/// One group.
pub(crate) struct Sample {
    pub(crate) name: String,
    /// Less [`Samples::pivot`].
    pub(crate) values: Vec<f64>,
    /// For ranking: as given, equal where they tie.
    pub(crate) keys: Vec<f64>,
    /// Of those values.
    pub(crate) mean: f64,
    /// Sum of squared deviations; exactly 0 if the values differ by rounding alone.
    pub(crate) squares: f64,
}

impl Sample {
    pub(crate) fn n(&self) -> f64 {
        self.values.len() as f64
    }

    /// `None` for a single value.
    pub(crate) fn variance(&self) -> Option<f64> {
        (self.values.len() > 1).then(|| self.squares / (self.n() - 1.0))
    }
}

/// All groups, in order of first appearance.
pub(crate) struct Samples {
    pub(crate) all: Vec<Sample>,
    /// What was taken from each value, so that an offset costs no digits.
    pub(crate) pivot: f64,
    pub(crate) missing: usize,
}

impl Samples {
    pub(crate) fn new(groups: &[String], values: &[Option<f64>]) -> Result<Self, StatsError> {
        StatsError::same_length("group", groups.len(), values.len())?;
        let kept = complete::rows(&[("value", values)], "value", 1)?;
        let index = Index::from_labels(groups);
        complete::enough("group", index.names.len(), kept.missing, 2)?;
        tell_apart(&[index.names.as_slice()])?;
        let mut columns = vec![(Vec::new(), Vec::new()); index.names.len()];
        let given = &kept.columns[0];
        for ((&row, &value), &key) in kept.kept.iter().zip(given).zip(&*decimal::tied(given)) {
            let (values, keys) = &mut columns[index.rows[row]];
            values.push(value);
            keys.push(key);
        }
        let pivot = kept.columns[0][0];
        let sample = |(name, (values, keys)): (String, (Vec<f64>, Vec<f64>))| {
            if values.is_empty() {
                return Err(StatsError::EmptyCell { cell: name });
            }
            let constant = is_constant(&values);
            let values: Vec<f64> = values.into_iter().map(|v| v - pivot).collect();
            let (mean, squares) = mean_and_square_sum(values.iter().copied());
            Ok(Sample { name, values, keys, mean, squares: if constant { 0.0 } else { squares } })
        };
        let samples: Result<_, _> = index.names.into_iter().zip(columns).map(sample).collect();
        Ok(Self { all: samples?, pivot, missing: kept.missing })
    }

    pub(crate) fn n(&self) -> usize {
        self.all.iter().map(|s| s.values.len()).sum()
    }

    /// A test of each pair, its reasons noted below `prefix.A|B`.
    pub(crate) fn pairs<T>(
        &self,
        prefix: &str,
        undefined: &mut Reasons,
        test: impl Fn(&Sample, &Sample) -> (T, Reasons),
    ) -> Named<T> {
        let of_pair = |(a, b): (&Sample, &Sample)| {
            let name = format!("{}|{}", a.name, b.name);
            let result = undefined.result(&format!("{prefix}.{name}"), test(a, b));
            (name, result)
        };
        each_pair(&self.all).map(of_pair).collect()
    }
}
