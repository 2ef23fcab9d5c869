//! Which numbers of a result go into which sentence.

use std::fmt;

use super::{
    F, Statement, bounded, f, number, of_n, of_values, p_symbol, r, r_rm, rho, t, wilcoxon,
};
use crate::{
    Adjustment, AlphaAnalysis, Bootstrap, Comparison, Correlation, Friedman, FriedmanAnalysis,
    Interval, Levene, Named, Normality, Omnibus, OmnibusP, OmnibusTest, Posthoc, PosthocPair,
    PosthocTest, RmAnova, RmAnovaAnalysis, RmCorrelationAnalysis, Sphericity, SphericityCorrection,
    VarianceTests, WithinAnalysis,
};

/// A result that can be said as APA has it.
pub trait Statements {
    /// Each finding under its name in the JSON, such as `rm_anova` or `a|b`. A number that does not exist has no sentence.
    fn statements(&self) -> Vec<(String, Statement)>;
}

/// One sentence alone, several with their names, a line each.
pub(super) fn write(statements: &[(String, Statement)], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    for (i, (name, statement)) in statements.iter().enumerate() {
        if i > 0 {
            f.write_str("\n")?;
        }
        if statements.len() > 1 {
            write!(f, "{name}: ")?;
        }
        write!(f, "{statement}")?;
    }
    Ok(())
}

/// `Display` as the sentences of a result.
macro_rules! says_itself {
    ($($result:ty),* $(,)?) => {$(
        impl std::fmt::Display for $result {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                $crate::apa::results::write(&self.statements(), f)
            }
        }
    )*};
}
pub(super) use says_itself;

says_itself!(
    RmAnovaAnalysis,
    FriedmanAnalysis,
    WithinAnalysis,
    Comparison,
    Posthoc,
    Correlation,
    RmCorrelationAnalysis,
    Normality,
    VarianceTests,
    AlphaAnalysis,
    Bootstrap,
);

/// Those of the named statements that exist.
pub(super) fn those<const N: usize>(
    statements: [(&str, Option<Statement>); N],
) -> Vec<(String, Statement)> {
    let named = |(name, statement): (&str, Option<Statement>)| Some((name.to_owned(), statement?));
    statements.into_iter().filter_map(named).collect()
}

/// Those of the results that have a sentence, under their names.
pub(super) fn of_each<T>(
    results: &Named<T>,
    sentence: impl Fn(&str, &T) -> Option<Statement>,
) -> Vec<(String, Statement)> {
    let named = |(name, result): (&str, &T)| Some((name.to_owned(), sentence(name, result)?));
    results.iter().filter_map(named).collect()
}

/// F with degrees of freedom and p as a lack of sphericity asks for, whatever Mauchly's test says.
pub(super) fn corrected_f(uncorrected: F, sphericity: &Sphericity) -> Option<Statement> {
    let correction = sphericity.correction();
    let (epsilon, p) = sphericity.corrected(correction, Some(uncorrected.p));
    let epsilon = epsilon?;
    Some(f(&F {
        df_effect: uncorrected.df_effect * epsilon,
        df_error: uncorrected.df_error * epsilon,
        p: p?,
        epsilon: (correction != SphericityCorrection::None).then_some(epsilon),
        ..uncorrected
    }))
}

fn of_anova(anova: &RmAnova, sphericity: &Sphericity) -> Option<Statement> {
    let uncorrected = F {
        f: anova.f?,
        df_effect: anova.df1 as f64,
        df_error: anova.df2 as f64,
        p: anova.p?,
        eta2_partial: anova.eta2_partial,
        eta2_partial_ci90: anova.eta2_partial_ci90,
        epsilon: None,
    };
    corrected_f(uncorrected, sphericity)
}

fn of_friedman(friedman: &Friedman, n: usize) -> Option<Statement> {
    let (p, method) = friedman.reported_p();
    let df = [friedman.df?, n];
    Some(friedman_of(friedman.chi2?, df, (p?, method), friedman.kendall_w))
}

/// `χ²(3, N = 24) = 41.19, p_exact < .001, W = .57`: p has the name of what it is, unless it is that of χ².
fn friedman_of(
    statistic: f64,
    df_and_n: [usize; 2],
    (p, method): (f64, OmnibusP),
    w: Option<f64>,
) -> Statement {
    let symbol = match method {
        OmnibusP::Exact => "*p*_{exact}",
        OmnibusP::ImanDavenport => "*p*_{Iman-Davenport}",
        _ => p_symbol(Adjustment::None),
    };
    of_n("*χ*^{2}", statistic, df_and_n, (symbol, p), w)
}

impl Statements for RmAnovaAnalysis {
    fn statements(&self) -> Vec<(String, Statement)> {
        let statement = of_anova(&self.rm_anova, &self.sphericity);
        those([("rm_anova", statement)])
    }
}

impl Statements for FriedmanAnalysis {
    fn statements(&self) -> Vec<(String, Statement)> {
        those([("friedman", of_friedman(&self.friedman, self.n))])
    }
}

impl Statements for WithinAnalysis {
    fn statements(&self) -> Vec<(String, Statement)> {
        let anova = of_anova(&self.rm_anova, &self.sphericity);
        let friedman = of_friedman(&self.friedman, self.n);
        let mut statements = those([("rm_anova", anova), ("friedman", friedman)]);
        statements.extend(of_each(&self.paired, |_, pair| {
            let dz = pair.dz.map(|dz| (dz, pair.dz_ci));
            let (df, p) = (pair.df as f64, pair.p_holm?);
            Some(t(pair.t?, df, p, Adjustment::Holm, dz))
        }));
        statements
    }
}

impl Omnibus {
    /// The test as it is reported, of `n` subjects; `None` if it has no value.
    pub fn statement(&self, n: usize) -> Option<Statement> {
        self.full_or_short(n, false)
    }

    /// The same without interval and ε, for a figure.
    pub fn short_statement(&self, n: usize) -> Option<Statement> {
        self.full_or_short(n, true)
    }

    fn full_or_short(&self, n: usize, short: bool) -> Option<Statement> {
        let (statistic, p, effect) = (self.statistic?, self.p?, &self.effect);
        if self.test == OmnibusTest::Wilcoxon {
            return Some(wilcoxon(statistic, p, Adjustment::None, effect.value));
        }
        let df1 = self.df1?;
        let ci = if short { Interval::default() } else { effect.ci };
        if self.test == OmnibusTest::PairedT {
            let dz = effect.value.map(|dz| (dz, ci));
            return Some(t(statistic, df1, p, Adjustment::None, dz));
        }
        if self.test == OmnibusTest::Friedman {
            let df = [df1.round() as usize, n];
            return Some(friedman_of(statistic, df, (p, self.p_method), effect.value));
        }
        let corrected = self.correction != SphericityCorrection::None;
        Some(f(&F {
            f: statistic,
            df_effect: df1,
            df_error: self.df2?,
            p,
            eta2_partial: effect.value,
            eta2_partial_ci90: ci,
            epsilon: self.epsilon.filter(|_| !short && corrected),
        }))
    }
}

impl Statements for Comparison {
    fn statements(&self) -> Vec<(String, Statement)> {
        let mut statements = those([("omnibus", self.omnibus.statement(self.n))]);
        // The only pair of two conditions is the test itself.
        if self.k > 2 {
            statements.extend(self.posthoc.statements());
        }
        statements
    }
}

impl Statements for Posthoc {
    fn statements(&self) -> Vec<(String, Statement)> {
        of_each(&self.pairs, |_, pair| self.pair(pair))
    }
}

impl Posthoc {
    fn pair(&self, pair: &PosthocPair) -> Option<Statement> {
        let (statistic, p_value) = (pair.statistic?, pair.p_adjusted?);
        let (effect, adjust) = (&pair.effect, self.adjust);
        Some(match self.test {
            PosthocTest::T | PosthocTest::PooledT => {
                let dz = effect.value.map(|dz| (dz, effect.ci));
                t(statistic, pair.df? as f64, p_value, adjust, dz)
            }
            PosthocTest::Conover => t(statistic, pair.df? as f64, p_value, adjust, None),
            PosthocTest::Wilcoxon => wilcoxon(statistic, p_value, adjust, effect.value),
            PosthocTest::Nemenyi => {
                let q = number(statistic, 2);
                let statement = Statement(format!("*q*({}, ∞) = {q}", self.k));
                statement.p(p_value, Adjustment::None)
            }
        })
    }
}

impl Statements for Correlation {
    fn statements(&self) -> Vec<(String, Statement)> {
        let of_r = || {
            let pearson = self.pearson.as_ref()?;
            Some(r(pearson.r?, pearson.df?, pearson.p?))
        };
        let of_rho = || {
            let spearman = self.spearman.as_ref()?;
            Some(rho(spearman.rho?, spearman.df?, spearman.p?))
        };
        let of_tau = || {
            let kendall = self.kendall.as_ref()?;
            let tau = Statement(format!("*τ*_{{b}} = {}", bounded(kendall.tau_b?, 2)));
            Some(tau.p(kendall.p?, Adjustment::None))
        };
        those([("pearson", of_r()), ("spearman", of_rho()), ("kendall", of_tau())])
    }
}

impl Statements for RmCorrelationAnalysis {
    fn statements(&self) -> Vec<(String, Statement)> {
        let rm_corr = &self.rm_corr;
        let statement = || Some(r_rm(rm_corr.r?, rm_corr.df?, rm_corr.p?));
        those([("rm_corr", statement())])
    }
}

impl Statements for Normality {
    fn statements(&self) -> Vec<(String, Statement)> {
        let statement = || {
            let w = Statement(format!("*W* = {}", bounded(self.shapiro.w?, 3)));
            Some(w.p(self.shapiro.p?, Adjustment::None))
        };
        those([("shapiro", statement())])
    }
}

impl Statements for VarianceTests {
    fn statements(&self) -> Vec<(String, Statement)> {
        let of_f = |test: &Levene| {
            let df = [test.df1 as f64, test.df2 as f64];
            Some(Statement::f_test(df, test.f?, test.p?))
        };
        let of_k2 = || {
            let bartlett = &self.bartlett;
            let k2 = Statement::with_df("*χ*^{2}", &[bartlett.df as f64], bartlett.k2?);
            Some(k2.p(bartlett.p?, Adjustment::None))
        };
        those([
            ("levene_mean", of_f(&self.levene_mean)),
            ("levene_median", of_f(&self.levene_median)),
            ("bartlett", of_k2()),
        ])
    }
}

impl Statements for AlphaAnalysis {
    fn statements(&self) -> Vec<(String, Statement)> {
        let alpha = &self.alpha;
        let statement = || {
            let raw = Statement(format!("*α* = {}", bounded(alpha.raw?, 2)));
            Some(raw.ci(0.95, alpha.ci, bounded))
        };
        let omega = alpha.omega.map(|o| Statement(format!("*ω* = {}", bounded(o, 2))));
        those([("alpha", statement()), ("omega", omega)])
    }
}

impl Statements for Bootstrap {
    fn statements(&self) -> Vec<(String, Statement)> {
        let (level, estimate) = (self.settings.confidence, self.estimate);
        let statement = |ci: Interval| {
            ci.ends()?;
            let estimate = of_values(estimate?, ci);
            Some(Statement(format!("estimate {estimate}")).ci_of_values(level, ci))
        };
        those([("bca", statement(self.bca)), ("percentile", statement(self.percentile))])
    }
}

#[cfg(test)]
mod tests {
    use crate::{
        Adjustment, PosthocTest, WithinSubjects, compare, compare_without_exact, friedman, groups,
        posthoc, rm_anova,
    };

    fn rows_of<const K: usize>(rows: &[[f64; K]]) -> WithinSubjects {
        let rows: Vec<Vec<f64>> = rows.iter().map(|row| row.to_vec()).collect();
        let names: Vec<String> = (0..rows.len().max(K)).map(|i| i.to_string()).collect();
        WithinSubjects::from_rows(&names[..K], &names[..rows.len()], &rows).unwrap()
    }

    fn data() -> WithinSubjects {
        let rows = [[1.0, 4.0, 2.0], [2.0, 6.0, 3.0], [3.0, 6.5, 3.5], [1.5, 5.0, 4.0]];
        let rows: Vec<Vec<f64>> = rows.map(Vec::from).to_vec();
        WithinSubjects::from_rows(&["a", "b", "c"], &["1", "2", "3", "4"], &rows).unwrap()
    }

    #[test]
    fn a_single_finding_is_its_sentence_and_several_are_named() {
        let one = rm_anova(&data()).to_string();
        assert!(one.starts_with("F(1.29, 3.86) = "), "{one}");
        let all = compare(&data(), 0.05).unwrap().to_string();
        let lines: Vec<&str> = all.lines().collect();
        assert_eq!(lines.len(), 4);
        assert!(
            lines[0].starts_with("omnibus: F(") && lines[1].starts_with("a|b: t(3) = −"),
            "{all}"
        );
    }

    #[test]
    fn an_f_is_corrected_by_its_epsilon_whatever_mauchly_says() {
        let data = rows_of(&[
            [-1.79, -0.26, 1.11, 3.03],
            [-1.66, 0.54, -0.75, 1.89],
            [1.78, -0.06, -0.89, -1.27],
            [0.45, 1.19, 0.27, -0.73],
            [-1.44, 1.03, 0.29, 3.06],
            [0.37, -0.21, 2.18, 2.81],
            [-0.62, 1.16, -0.62, 0.12],
            [-1.49, 2.84, 3.12, 2.52],
            [-1.22, 0.58, -3.27, -0.12],
            [-0.68, -0.19, 0.27, 0.73],
        ]);
        let anova = rm_anova(&data);
        assert!(anova.mauchly.p.unwrap() > 0.05);
        let sentence = anova.to_string();
        assert!(
            sentence.starts_with("F(2.14, 19.29) = 3.18, p = .061, ")
                && sentence.ends_with(", ε = .71"),
            "{sentence}"
        );
        let compared = compare(&data, 0.05).unwrap().to_string();
        let first = format!("omnibus: {sentence}");
        assert_eq!(compared.lines().next(), Some(first.as_str()));
        // Huynh and Feldt's epsilon is 1.67 before it is cut.
        let spherical = rows_of(&[
            [3.0, 7.0, 7.0],
            [1.0, 6.0, 9.0],
            [3.0, 3.0, 8.0],
            [5.0, 7.0, 10.0],
            [2.0, 3.0, 10.0],
            [6.0, 5.0, 8.0],
        ]);
        let sentence = rm_anova(&spherical).to_string();
        assert!(sentence.starts_with("F(2, 10) = ") && !sentence.contains('ε'), "{sentence}");
    }

    #[test]
    fn a_p_that_is_not_that_of_the_statistic_before_it_has_a_name_everywhere() {
        let data = rows_of(&[
            [0.03, 0.14, 149.59],
            [0.0, 2.91, 0.02],
            [27.18, 8.24, 1174.05],
            [0.22, 14.8, 8.52],
            [0.11, 6.93, 0.46],
            [0.35, 36.21, 23.86],
        ]);
        let exact = "χ²(2, N = 6) = 6.33, p_exact = .052, W = .53";
        assert_eq!(friedman(&data).to_string(), exact);
        let compared = compare(&data, 0.05).unwrap().to_string();
        assert!(compared.starts_with(&format!("omnibus: {exact}\n")), "{compared}");
        let without = compare_without_exact(&data, 0.05).unwrap().to_string();
        assert!(without.contains(", p_Iman-Davenport = "), "{without}");
        let of_groups = |labels: &[&str]| {
            let values: Vec<_> = [1.0, 3.0, 2.0, 4.0, 6.0, 5.5, 2.5, 7.0, 3.5].map(Some).to_vec();
            let labels: Vec<String> = labels.iter().map(|l| (*l).to_owned()).collect();
            groups(&labels, &values).unwrap().to_string()
        };
        let three = of_groups(&["a", "a", "a", "b", "b", "b", "c", "c", "c"]);
        assert_eq!(three.matches(", p_Games-Howell ").count(), 3, "{three}");
        let two = of_groups(&["a", "a", "a", "a", "b", "b", "b", "b", "b"]);
        assert!(two.contains("welch_t: t(") && !two.contains("Howell"), "{two}");
    }

    #[test]
    fn the_correction_of_pairs_is_named_as_it_is() {
        let said = |test, adjust| posthoc(&data(), test, adjust, 0.05).unwrap().to_string();
        assert!(said(PosthocTest::T, Adjustment::Bonferroni).contains("p_Bonferroni "));
        assert!(said(PosthocTest::Wilcoxon, Adjustment::Bh).contains("p_BH "));
        assert!(said(PosthocTest::T, Adjustment::None).contains(", p "));
        assert!(said(PosthocTest::Nemenyi, Adjustment::Holm).contains("q(3, ∞) = "));
    }
}
