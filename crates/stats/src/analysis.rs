//! The whole analysis of a within-subject design.

use serde::{Deserialize, Serialize};

use crate::{
    Conover, Friedman, Interval, Mauchly, Named, Nemenyi, PairedT, PooledT, Reasons, RmAnova,
    ShapiroWilk, Sphericity, Wilcoxon, WithinSubjects,
    friedman::{self, Exact, RankTable},
    normality::{RoystonWeights, shapiro_wilk_with},
    numerics::decimal::Written,
    paired,
    rm_anova::{self, Decomposition},
    sphericity,
};

/// Mean and spread of one condition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ConditionSummary {
    /// Mean over subjects.
    pub mean: f64,
    /// Standard deviation, over n-1.
    pub sd: f64,
    /// The 95 % within-subject interval of the mean (Morey, 2008): subjects'
    /// means taken out, variance times k/(k-1).
    #[serde(flatten, with = "crate::interval::within_ci")]
    pub within_ci: Interval,
}

/// Everything this crate computes for n subjects under k conditions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WithinAnalysis {
    /// Complete subjects.
    pub n: usize,
    /// Conditions.
    pub k: usize,
    /// Subjects left out because a cell is missing.
    pub dropped: Vec<String>,
    /// Mean and spread by condition.
    pub desc: Named<ConditionSummary>,
    /// Repeated-measures analysis of variance.
    pub rm_anova: RmAnova,
    /// Mauchly's test of sphericity.
    pub mauchly: Mauchly,
    /// Corrections for a lack of sphericity.
    pub sphericity: Sphericity,
    /// Friedman's test.
    pub friedman: Friedman,
    /// Paired t tests by pair.
    pub paired: Named<PairedT>,
    /// t tests over the pooled error term by pair.
    pub pooled: Named<PooledT>,
    /// Wilcoxon's signed-rank tests by pair.
    pub wilcoxon: Named<Wilcoxon>,
    /// Conover's comparisons by pair.
    pub conover: Named<Conover>,
    /// Nemenyi's comparisons by pair.
    pub nemenyi: Named<Nemenyi>,
    /// Shapiro and Wilk's test by condition, and of the `residuals` of the additive model.
    pub shapiro: Named<ShapiroWilk>,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// The analysis of variance alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RmAnovaAnalysis {
    /// Complete subjects.
    pub n: usize,
    /// Conditions.
    pub k: usize,
    /// Subjects left out because a cell is missing.
    pub dropped: Vec<String>,
    /// Mean and spread by condition.
    pub desc: Named<ConditionSummary>,
    /// Repeated-measures analysis of variance.
    pub rm_anova: RmAnova,
    /// Mauchly's test of sphericity.
    pub mauchly: Mauchly,
    /// Corrections for a lack of sphericity.
    pub sphericity: Sphericity,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Friedman's test alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FriedmanAnalysis {
    /// Complete subjects.
    pub n: usize,
    /// Conditions.
    pub k: usize,
    /// Subjects left out because a cell is missing.
    pub dropped: Vec<String>,
    /// Mean and spread by condition.
    pub desc: Named<ConditionSummary>,
    /// Friedman's test.
    pub friedman: Friedman,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Runs every test of the within-subject design on the same complete subjects.
///
/// # Source
/// The formula of each number is at its field. Where R, JASP, SciPy and pingouin disagree
/// the field says whom it follows.
///
/// # Example
/// Effort to rise from four stools (Wretenberg, Arborelius and Lindberg, 1993; R's
/// `nlme::ergoStool`):
/// ```
/// use maveric_stats::{WithinSubjects, within};
/// let rows = [
///     [12.0, 15.0, 12.0, 10.0], [10.0, 14.0, 13.0, 12.0], [7.0, 14.0, 13.0, 9.0],
///     [7.0, 11.0, 10.0, 9.0], [8.0, 11.0, 8.0, 7.0], [9.0, 11.0, 11.0, 10.0],
///     [8.0, 12.0, 12.0, 11.0], [7.0, 11.0, 8.0, 7.0], [9.0, 13.0, 10.0, 8.0],
/// ].map(Vec::from);
/// let subjects = ["1", "2", "3", "4", "5", "6", "7", "8", "9"];
/// let data = WithinSubjects::from_rows(&["T1", "T2", "T3", "T4"], &subjects, &rows)?;
/// let analysis = within(&data);
/// let f = analysis.rm_anova.f.unwrap();
/// assert!((f - 22.3556).abs() < 1e-4); // R: F(3, 24) = 22.36
/// assert!(analysis.friedman.p_exact.unwrap() < 1e-6);
/// assert!(analysis.undefined.get("mauchly.W").is_none());
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn within(data: &WithinSubjects) -> WithinAnalysis {
    analyse(data, Exact::Feasible)
}

/// [`within`] without the exact p of Friedman's test, which takes hundreds of times longer
/// than all the rest together: for simulations.
///
/// # Example
/// ```
/// use maveric_stats::{WithinSubjects, within_without_exact};
/// let rows = [[1.0, 4.0, 2.0], [2.0, 6.0, 3.0], [3.0, 6.5, 3.5]].map(Vec::from);
/// let analysis = within_without_exact(&WithinSubjects::from_rows(&["a", "b", "c"], &["1", "2", "3"], &rows)?);
/// assert_eq!(analysis.friedman.p_exact, None);
/// assert_eq!(analysis.undefined.get("friedman.p_exact"), Some("not computed: not asked for"));
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn within_without_exact(data: &WithinSubjects) -> WithinAnalysis {
    analyse(data, Exact::No)
}

pub(crate) fn analyse(data: &WithinSubjects, exact: Exact) -> WithinAnalysis {
    let mut undefined = Reasons::default();
    let parts = rm_anova::decompose(data);
    let (anova, mauchly, sphericity) = variance_part(data, &parts, &mut undefined);
    let table = RankTable::new(data);
    let friedman = undefined.result("friedman", friedman::test(&table, exact));
    let columns: Vec<Vec<f64>> = (0..data.k()).map(|j| data.column(j)).collect();
    WithinAnalysis {
        n: data.n(),
        k: data.k(),
        dropped: data.dropped().to_vec(),
        desc: summaries(data, &parts),
        paired: paired_t(data, &columns, &mut undefined),
        pooled: pooled_t(data, &parts, &anova, &mut undefined),
        wilcoxon: wilcoxon(data, &columns, &mut undefined),
        conover: conover(data, &table, &mut undefined),
        nemenyi: nemenyi(data, &table),
        shapiro: shapiro(data, &columns, &parts, &mut undefined),
        rm_anova: anova,
        mauchly,
        sphericity,
        friedman,
        undefined,
    }
}

/// Repeated-measures analysis of variance with its test and corrections of sphericity.
///
/// # Source
/// Maxwell and Delaney (2004), chapter 11; Mauchly (1940); Greenhouse and Geisser (1959);
/// Huynh and Feldt (1976). Agrees with R's afex and car but where those print p = 0 for a
/// singular error matrix, or lose digits to an offset of the values.
///
/// # Example
/// Extra hours of sleep by two drugs (Student, 1908; R's `sleep`): with two conditions F is
/// the square of t = -4.0621.
/// ```
/// use maveric_stats::{WithinSubjects, rm_anova};
/// let rows = [
///     [0.7, 1.9], [-1.6, 0.8], [-0.2, 1.1], [-1.2, 0.1], [-0.1, -0.1],
///     [3.4, 4.4], [3.7, 5.5], [0.8, 1.6], [0.0, 4.6], [2.0, 3.4],
/// ].map(Vec::from);
/// let people = ["1", "2", "3", "4", "5", "6", "7", "8", "9", "10"];
/// let result = rm_anova(&WithinSubjects::from_rows(&["1", "2"], &people, &rows)?);
/// assert!((result.rm_anova.f.unwrap() - 4.0621_f64.powi(2)).abs() < 1e-3);
/// assert!((result.rm_anova.p.unwrap() - 0.002833).abs() < 1e-6);
/// assert!(result.undefined.get("mauchly.W").unwrap().contains("two conditions"));
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn rm_anova(data: &WithinSubjects) -> RmAnovaAnalysis {
    let mut undefined = Reasons::default();
    let parts = rm_anova::decompose(data);
    let (rm_anova, mauchly, sphericity) = variance_part(data, &parts, &mut undefined);
    RmAnovaAnalysis {
        n: data.n(),
        k: data.k(),
        dropped: data.dropped().to_vec(),
        desc: summaries(data, &parts),
        rm_anova,
        mauchly,
        sphericity,
        undefined,
    }
}

/// Friedman's test, with the exact p where it is feasible.
///
/// # Source
/// Friedman (1937), corrected for ties; Iman and Davenport (1980). The exact p counts all
/// orders within subjects, which neither R's `friedman.test` nor SciPy offers.
///
/// # Example
/// Three ways of rounding first base (Hollander and Wolfe, 1973, table 7.1; R's help of
/// `friedman.test`):
/// ```
/// use maveric_stats::{WithinSubjects, friedman};
/// let times = [
///     [5.40, 5.50, 5.55], [5.85, 5.70, 5.75], [5.20, 5.60, 5.50], [5.55, 5.50, 5.40],
///     [5.90, 5.85, 5.70], [5.45, 5.55, 5.60], [5.40, 5.40, 5.35], [5.45, 5.50, 5.35],
///     [5.25, 5.15, 5.00], [5.85, 5.80, 5.70], [5.25, 5.20, 5.10], [5.65, 5.55, 5.45],
///     [5.60, 5.35, 5.45], [5.05, 5.00, 4.95], [5.50, 5.50, 5.40], [5.45, 5.55, 5.50],
///     [5.55, 5.55, 5.35], [5.45, 5.50, 5.55], [5.50, 5.45, 5.25], [5.65, 5.60, 5.40],
///     [5.70, 5.65, 5.55], [6.30, 6.30, 6.25],
/// ].map(Vec::from);
/// let players: Vec<String> = (1..=22).map(|i| i.to_string()).collect();
/// let ways = ["round out", "narrow angle", "wide angle"].map(str::to_owned);
/// let result = friedman(&WithinSubjects::from_rows(&ways, &players, &times)?).friedman;
/// assert!((result.chi2.unwrap() - 11.143).abs() < 5e-4);
/// assert!((result.p.unwrap() - 0.003805).abs() < 5e-7);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn friedman(data: &WithinSubjects) -> FriedmanAnalysis {
    let mut undefined = Reasons::default();
    let test = friedman::test(&RankTable::new(data), Exact::Feasible);
    let friedman = undefined.result("friedman", test);
    FriedmanAnalysis {
        n: data.n(),
        k: data.k(),
        dropped: data.dropped().to_vec(),
        desc: summaries(data, &rm_anova::decompose(data)),
        friedman,
        undefined,
    }
}

pub(crate) fn variance_part(
    data: &WithinSubjects,
    parts: &Decomposition,
    undefined: &mut Reasons,
) -> (RmAnova, Mauchly, Sphericity) {
    let anova = undefined.result("rm_anova", rm_anova::test(data, parts));
    let (mauchly, sphericity, inner) = sphericity::tests(data, &parts.residuals, &anova);
    undefined.absorb("", inner);
    (anova, mauchly, sphericity)
}

pub(crate) fn summaries(data: &WithinSubjects, parts: &Decomposition) -> Named<ConditionSummary> {
    let (n, k) = (data.n() as f64, data.k() as f64);
    let t95 = paired::t::t95(data.n());
    let squares = column_squares(data);
    let mut residual_squares = vec![0.0; data.k()];
    for row in parts.residuals.chunks_exact(data.k()) {
        for (sum, r) in residual_squares.iter_mut().zip(row) {
            *sum += r * r;
        }
    }
    let summary = |((mean, squares), residual): ((f64, f64), f64)| {
        // Residuals are the normalised values less their condition mean.
        let variance = residual / (n - 1.0) * k / (k - 1.0);
        let half = t95.map(|t| t * (variance / n).sqrt());
        ConditionSummary {
            mean,
            sd: (squares / (n - 1.0)).sqrt(),
            within_ci: Interval::around(mean, half),
        }
    };
    data.conditions()
        .iter()
        .cloned()
        .zip(squares.into_iter().zip(residual_squares).map(summary))
        .collect()
}

/// Mean and sum of squared deviations of each condition, all in two passes over the rows.
fn column_squares(data: &WithinSubjects) -> Vec<(f64, f64)> {
    let n = data.n() as f64;
    let pivots = &data.values()[..data.k()];
    let mut shifts = vec![0.0; data.k()];
    for row in data.rows() {
        for ((shift, v), pivot) in shifts.iter_mut().zip(row).zip(pivots) {
            *shift += v - pivot;
        }
    }
    for shift in &mut shifts {
        *shift /= n;
    }
    let mut sums = vec![(0.0, 0.0); data.k()];
    for row in data.rows() {
        for (((sum, v), pivot), shift) in sums.iter_mut().zip(row).zip(pivots).zip(&shifts) {
            let deviation = (v - pivot) - shift;
            sum.0 += deviation * deviation;
            sum.1 += deviation;
        }
    }
    let centres = pivots.iter().zip(&shifts).map(|(pivot, shift)| pivot + shift);
    // What rounding of the mean leaves over is taken out.
    let squares = sums.iter().map(|(squares, rest)| (squares - rest * rest / n).max(0.0));
    centres.zip(squares).collect()
}

pub(crate) fn paired_t(
    data: &WithinSubjects,
    columns: &[Vec<f64>],
    undefined: &mut Reasons,
) -> Named<PairedT> {
    let t95 = paired::t::t95(data.n());
    let test = |a: usize, b: usize| paired::t::test(&columns[a], &columns[b], t95);
    by_pair(data, "paired", undefined, test).with_holm(|r| r.p, |r, p| r.p_holm = p)
}

pub(crate) fn pooled_t(
    data: &WithinSubjects,
    parts: &Decomposition,
    anova: &RmAnova,
    undefined: &mut Reasons,
) -> Named<PooledT> {
    let means = &parts.condition_effects;
    let test = |a: usize, b: usize| paired::pooled::test(means[a] - means[b], data.n(), anova);
    by_pair(data, "pooled", undefined, test).with_holm(|r| r.p, |r, p| r.p_holm = p)
}

pub(crate) fn wilcoxon(
    data: &WithinSubjects,
    columns: &[Vec<f64>],
    undefined: &mut Reasons,
) -> Named<Wilcoxon> {
    let (written, n, k) = (Written::from_values(data.values()), data.n(), data.k());
    let test = |a: usize, b: usize| {
        let keys = written.differences((0..n).map(|i| (i * k + a, i * k + b)));
        paired::wilcoxon::test(&columns[a], &columns[b], &keys, written.is_rounded())
    };
    by_pair(data, "wilcoxon", undefined, test)
        .with_holm(|r| r.p, |r, p| r.p_holm = p)
        .with_holm(|r| r.p_exact, |r, p| r.p_exact_holm = p)
        .with_holm(|r| r.p_normal_cc, |r, p| r.p_normal_cc_holm = p)
        .with_holm(|r| r.compat.p_r_default, |r, p| r.compat.p_r_default_holm = p)
}

pub(crate) fn conover(
    data: &WithinSubjects,
    table: &RankTable,
    undefined: &mut Reasons,
) -> Named<Conover> {
    let test = |a: usize, b: usize| paired::conover::test(table, a, b);
    by_pair(data, "conover", undefined, test).with_holm(|r| r.p, |r, p| r.p_holm = p)
}

pub(crate) fn nemenyi(data: &WithinSubjects, table: &RankTable) -> Named<Nemenyi> {
    data.pairs()
        .into_iter()
        .map(|(a, b, name)| (name, paired::nemenyi::test(table, a, b)))
        .collect()
}

fn shapiro(
    data: &WithinSubjects,
    columns: &[Vec<f64>],
    parts: &Decomposition,
    undefined: &mut Reasons,
) -> Named<ShapiroWilk> {
    let residuals = ("residuals".to_owned(), &parts.residuals[..]);
    let samples = data.conditions().iter().cloned().zip(columns.iter().map(Vec::as_slice));
    let mut weights = RoystonWeights::default();
    samples
        .chain([residuals])
        .map(|(name, sample)| {
            let test = shapiro_wilk_with(sample, &mut weights);
            let result = undefined.result(&format!("shapiro.{name}"), test);
            (name, result)
        })
        .collect()
}

pub(crate) fn by_pair<T>(
    data: &WithinSubjects,
    test_name: &str,
    undefined: &mut Reasons,
    test: impl Fn(usize, usize) -> (T, Reasons),
) -> Named<T> {
    data.pairs()
        .into_iter()
        .map(|(a, b, name)| {
            let result = undefined.result(&format!("{test_name}.{name}"), test(a, b));
            (name, result)
        })
        .collect()
}
