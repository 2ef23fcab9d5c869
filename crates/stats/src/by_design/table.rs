//! The columns of a design with their cells, and parts of them.

use super::DesignColumns;

/// The same columns with their cells.
#[derive(Debug, Clone, Default)]
pub struct DesignTable {
    /// Whose each row is.
    pub subjects: Vec<String>,
    /// As [`DesignColumns::within`].
    pub within: Vec<(String, Vec<String>)>,
    /// As [`DesignColumns::between`].
    pub between: Vec<(String, Vec<Option<String>>)>,
    /// As [`DesignColumns::covariates`].
    pub covariates: Vec<(String, Vec<Option<f64>>)>,
    /// As [`DesignColumns::with`].
    pub with: Vec<(String, Vec<String>)>,
    /// As [`DesignColumns::periods`].
    pub periods: Vec<usize>,
    /// The outcome.
    pub values: Vec<Option<f64>>,
    /// As [`DesignColumns::labels`].
    pub labels: Vec<(String, String)>,
}

impl DesignTable {
    /// The rows at one level of a factor, without that factor.
    pub(super) fn at_level(data: &DesignColumns<'_>, factor: &str, level: &str) -> Self {
        let within = data.within.iter().find(|(name, _)| *name == factor);
        let between = data.between.iter().find(|(name, _)| *name == factor);
        let is_at = |row: &usize| match (within, between) {
            (Some((_, cells)), _) => cells[*row] == level,
            (_, Some((_, cells))) => cells[*row].as_deref() == Some(level),
            _ => false,
        };
        let rows: Vec<usize> = (0..data.values.len()).filter(is_at).collect();
        Self::rows(data, &rows, Some(factor))
    }

    /// These rows, without a factor.
    pub(super) fn rows(data: &DesignColumns<'_>, rows: &[usize], less: Option<&str>) -> Self {
        fn columns<T: Clone>(
            all: &[(&str, &[T])],
            rows: &[usize],
            less: Option<&str>,
        ) -> Vec<(String, Vec<T>)> {
            let stay = all.iter().filter(|(name, _)| Some(*name) != less);
            stay.map(|(name, cells)| ((*name).to_owned(), these(cells, rows))).collect()
        }
        fn these<T: Clone>(cells: &[T], rows: &[usize]) -> Vec<T> {
            rows.iter().map(|row| cells[*row].clone()).collect()
        }
        let product = |effect: &&str| effect.split(':').all(|name| Some(name) != less);
        let products = |with: &[&str]| {
            let stay = with.iter().copied().filter(product);
            stay.map(str::to_owned).collect()
        };
        let with = data.with.iter();
        Self {
            subjects: these(data.subjects, rows),
            within: columns(&data.within, rows, less),
            between: columns(&data.between, rows, less),
            covariates: columns(&data.covariates, rows, None),
            with: with.map(|(n, with)| ((*n).to_owned(), products(with))).collect(),
            periods: rows.iter().filter_map(|row| data.periods.get(*row).copied()).collect(),
            values: these(data.values, rows),
            labels: Vec::new(),
        }
    }

    /// The table borrowed, as the tests take it.
    pub fn columns(&self) -> DesignColumns<'_> {
        fn columns<T>(all: &[(String, Vec<T>)]) -> Vec<(&str, &[T])> {
            all.iter().map(|(n, cells)| (n.as_str(), &cells[..])).collect()
        }
        let with = self.with.iter();
        DesignColumns {
            subjects: &self.subjects,
            within: columns(&self.within),
            between: columns(&self.between),
            covariates: columns(&self.covariates),
            with: with
                .map(|(n, with)| (n.as_str(), with.iter().map(String::as_str).collect()))
                .collect(),
            periods: &self.periods,
            values: &self.values,
            labels: (self.labels.iter()).map(|(n, label)| (n.as_str(), label.as_str())).collect(),
        }
    }
}
