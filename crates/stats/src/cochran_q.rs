//! Cochran's Q: do yes/no answers of the same people differ among conditions?

use serde::{Deserialize, Serialize};

use crate::{
    Named, Reasons, StatsError, WithinSubjects,
    analysis::by_pair,
    mcnemar::{self, McNemarTest},
    numerics::distributions::chi2_upper,
};

/// Conditions, each answered with yes or no by the same people.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CochranQ {
    /// Complete subjects.
    pub n: usize,
    /// Conditions.
    pub k: usize,
    /// Subjects left out because a cell is missing.
    pub dropped: Vec<String>,
    /// Share of yes by condition.
    pub yes: Named<f64>,
    /// The test of all conditions at once.
    pub cochran_q: CochranQTest,
    /// McNemar's test of each pair.
    pub pairs: Named<McNemarPair>,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Cochran's test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CochranQTest {
    /// Q = (k − 1) (k Σ C² − T²) / (k T − Σ R²): C yes of a condition, R of a subject, T of all. Friedman's χ² of the answers.
    #[serde(rename = "Q")]
    pub q: Option<f64>,
    /// k − 1.
    pub df: Option<usize>,
    /// P(χ²(k − 1) ≥ Q), for large samples.
    pub p: Option<f64>,
    /// Q / (n (k − 1)): Kendall's W of the answers, 0 to 1.
    pub w: Option<f64>,
    /// Subjects who did not answer all conditions alike: only they tell.
    pub differing: usize,
}

/// McNemar's test of a pair, with its p among all pairs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct McNemarPair {
    /// Of this pair alone: counts, difference, odds ratio and p before Holm.
    #[serde(flatten)]
    pub test: McNemarTest,
    /// The mid-p, after Holm for all pairs.
    pub p_holm: Option<f64>,
}

/// Cochran's test of conditions whose values are 1 for yes and 0 for no, and McNemar's test of each pair.
///
/// # Errors
/// [`StatsError::BadParameter`] for a value that is neither.
///
/// # Source
/// Cochran (1950).
///
/// # Example
/// ```
/// # use maveric_stats::{WithinSubjects, cochran_q};
/// let answers = [[1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 1.0]].map(Vec::from);
/// let people: Vec<String> = (1..=5).map(|i| i.to_string()).collect();
/// let three = ["a", "b", "c"].map(str::to_owned);
/// let found = cochran_q(&WithinSubjects::from_rows(&three, &people, &answers)?)?.cochran_q;
/// assert!((found.q.unwrap() - 4.5).abs() < 1e-12); // 2 (3 · 33 − 81) / (27 − 19)
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn cochran_q(data: &WithinSubjects) -> Result<CochranQ, StatsError> {
    mcnemar::check_yes_no(data)?;
    let mut undefined = Reasons::default();
    let pairs = by_pair(data, "pairs", &mut undefined, |i, j| {
        let (test, inner) = mcnemar::test(&data.column(i), &data.column(j));
        (McNemarPair { test, p_holm: None }, inner)
    })
    .with_holm(|pair| pair.test.p_mid, |pair, p| pair.p_holm = p);
    let cochran_q = omnibus(data);
    if cochran_q.q.is_none() {
        let names = ["cochran_q.Q", "cochran_q.p", "cochran_q.w"];
        undefined.note_all(&names, "everybody answered all conditions alike");
    }
    Ok(CochranQ {
        n: data.n(),
        k: data.k(),
        dropped: data.dropped().to_vec(),
        yes: mcnemar::shares(data),
        cochran_q,
        pairs,
        undefined,
    })
}

fn omnibus(data: &WithinSubjects) -> CochranQTest {
    let (n, k) = (data.n() as f64, data.k() as f64);
    let columns: Vec<f64> = (0..data.k()).map(|j| data.column(j).iter().sum()).collect();
    let rows: Vec<f64> = data.rows().map(|row| row.iter().sum()).collect();
    let square = |sums: &[f64]| sums.iter().map(|v| v * v).sum::<f64>();
    let total: f64 = rows.iter().sum();
    let within = k * total - square(&rows);
    let q = (within > 0.0).then(|| (k - 1.0) * (k * square(&columns) - total * total) / within);
    CochranQTest {
        q,
        df: q.map(|_| data.k() - 1),
        p: q.map(|q| chi2_upper(q, k - 1.0)),
        w: q.map(|q| q / (n * (k - 1.0))),
        differing: rows.iter().filter(|yes| **yes > 0.0 && **yes < k).count(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{apa::Statements, friedman};

    fn data(rows: &[[f64; 3]]) -> WithinSubjects {
        let people: Vec<String> = (0..rows.len()).map(|i| i.to_string()).collect();
        let rows: Vec<Vec<f64>> = rows.iter().map(|row| row.to_vec()).collect();
        WithinSubjects::from_rows(&["a", "b", "c"].map(str::to_owned), &people, &rows).unwrap()
    }

    #[test]
    fn q_is_friedmans_chi_squared_of_the_answers() {
        let rows = [
            [1.0, 1.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [1.0, 1.0, 1.0],
            [1.0, 0.0, 1.0],
            [0.0, 0.0, 0.0],
        ];
        let found = cochran_q(&data(&rows)).unwrap();
        let ranks = friedman(&data(&rows)).friedman;
        let test = &found.cochran_q;
        assert!((test.q.unwrap() - ranks.chi2.unwrap()).abs() < 1e-12);
        assert!((test.p.unwrap() - ranks.p.unwrap()).abs() < 1e-12);
        assert!((test.w.unwrap() - ranks.kendall_w.unwrap()).abs() < 1e-12);
        assert_eq!(test.differing, 5);
    }

    #[test]
    fn of_two_conditions_it_is_mcnemars_chi_squared_and_pairs_are_adjusted() {
        let rows = [
            [1.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 0.0, 1.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [1.0, 0.0, 0.0],
        ];
        let found = cochran_q(&data(&rows)).unwrap();
        let two = rows.map(|[a, b, _]| vec![a, b]);
        let people: Vec<String> = (0..6).map(|i| i.to_string()).collect();
        let two = WithinSubjects::from_rows(&["a", "b"].map(str::to_owned), &people, &two).unwrap();
        let alone = crate::mcnemar(&two).unwrap().mcnemar;
        let q = cochran_q(&two).unwrap().cochran_q.q.unwrap();
        assert!((q - alone.chi2.unwrap()).abs() < 1e-12);
        let pair = found.pairs.get("a|b").unwrap();
        assert_eq!(pair.test, alone);
        // Four against one; five against none is the smallest of the three.
        let smallest = found.pairs.get("a|c").unwrap();
        assert!((smallest.test.p_mid.unwrap() - 1.0 / 16.0).abs() < 1e-9);
        assert!((smallest.p_holm.unwrap() - 3.0 / 16.0).abs() < 1e-9);
        let said = found.statements();
        assert_eq!(said.len(), 4, "{said:?}");
    }

    #[test]
    fn everybody_alike_is_no_test_and_scores_are_refused() {
        let alike = cochran_q(&data(&[[1.0; 3], [0.0; 3]])).unwrap();
        assert_eq!((alike.cochran_q.q, alike.cochran_q.p), (None, None));
        assert!(alike.undefined.get("cochran_q.Q").is_some());
        assert!(cochran_q(&data(&[[1.0, 0.5, 0.0], [0.0; 3]])).is_err());
    }
}
