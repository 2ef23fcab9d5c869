//! Which numbers of a result go into which sentence.

use std::fmt;

use super::{F, Statement, bounded, chi2, f, number, r, r_rm, rho, t, wilcoxon};
use crate::{
    Adjustment, AlphaAnalysis, Bootstrap, Comparison, Correlation, Friedman, FriedmanAnalysis,
    Interval, Levene, Mauchly, Named, Normality, Omnibus, OmnibusTest, Posthoc, PosthocPair,
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

/// Level at which Mauchly's test asks for a correction.
const ALPHA: f64 = 0.05;

/// F, corrected after Greenhouse and Geisser where Mauchly's test rejects sphericity.
fn of_anova(anova: &RmAnova, mauchly: &Mauchly, sphericity: &Sphericity) -> Option<Statement> {
    let corrected = mauchly.p.is_none_or(|p| p < ALPHA) && anova.df1 > 1;
    let epsilon = if corrected { sphericity.gg } else { None };
    Some(f(&F {
        f: anova.f?,
        df_effect: anova.df1 as f64 * epsilon.unwrap_or(1.0),
        df_error: anova.df2 as f64 * epsilon.unwrap_or(1.0),
        p: if epsilon.is_some() {
            sphericity.p_gg?
        } else {
            anova.p?
        },
        eta2_partial: anova.eta2_partial,
        eta2_partial_ci90: anova.eta2_partial_ci90,
        epsilon,
    }))
}

fn of_friedman(friedman: &Friedman, n: usize) -> Option<Statement> {
    Some(chi2(
        friedman.chi2?,
        friedman.df?,
        n,
        friedman.p?,
        friedman.kendall_w,
    ))
}

impl Statements for RmAnovaAnalysis {
    fn statements(&self) -> Vec<(String, Statement)> {
        let statement = of_anova(&self.rm_anova, &self.mauchly, &self.sphericity);
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
        let anova = of_anova(&self.rm_anova, &self.mauchly, &self.sphericity);
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
        let ci = if short {
            Interval::default()
        } else {
            effect.ci
        };
        if self.test == OmnibusTest::PairedT {
            let dz = effect.value.map(|dz| (dz, ci));
            return Some(t(statistic, df1, p, Adjustment::None, dz));
        }
        if self.test == OmnibusTest::Friedman {
            return Some(chi2(statistic, df1.round() as usize, n, p, effect.value));
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
        those([
            ("pearson", of_r()),
            ("spearman", of_rho()),
            ("kendall", of_tau()),
        ])
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
        let omega = alpha
            .omega
            .map(|o| Statement(format!("*ω* = {}", bounded(o, 2))));
        those([("alpha", statement()), ("omega", omega)])
    }
}

impl Statements for Bootstrap {
    fn statements(&self) -> Vec<(String, Statement)> {
        let (level, estimate) = (self.settings.confidence, self.estimate);
        let statement = |ci: Interval| {
            ci.ends()?;
            Some(Statement(format!("estimate {}", number(estimate?, 2))).ci(level, ci, number))
        };
        those([
            ("bca", statement(self.bca)),
            ("percentile", statement(self.percentile)),
        ])
    }
}

#[cfg(test)]
mod tests {
    use crate::{Adjustment, PosthocTest, WithinSubjects, compare, posthoc, rm_anova};

    fn data() -> WithinSubjects {
        let rows = [
            [1.0, 4.0, 2.0],
            [2.0, 6.0, 3.0],
            [3.0, 6.5, 3.5],
            [1.5, 5.0, 4.0],
        ];
        let rows: Vec<Vec<f64>> = rows.map(Vec::from).to_vec();
        WithinSubjects::from_rows(&["a", "b", "c"], &["1", "2", "3", "4"], &rows).unwrap()
    }

    #[test]
    fn a_single_finding_is_its_sentence_and_several_are_named() {
        let one = rm_anova(&data()).to_string();
        assert!(one.starts_with("F(2, 6) = "), "{one}");
        let all = compare(&data(), 0.05).unwrap().to_string();
        let lines: Vec<&str> = all.lines().collect();
        assert_eq!(lines.len(), 4);
        assert!(
            lines[0].starts_with("omnibus: F(") && lines[1].starts_with("a|b: t(3) = −"),
            "{all}"
        );
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
