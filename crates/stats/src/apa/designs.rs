//! The sentences of factors, groups, bounds and models.

use super::{
    F, Statement, Statements, bounded, chi2, degrees, f, number, of_n, p_symbol,
    parts::ranks,
    probability,
    results::{corrected_f, of_each, says_itself, those},
    t,
};
use crate::{
    Adjustment, AlignedRanks, BayesCorrelationAnalysis, BayesTAnalysis, ByDesign, ChosenTest,
    CochranQ, EffectMethod, Equivalence, Factorial, FactorialEffect, FactorialFinding,
    GroupsAnalysis, McNemar, McNemarTest, MixedFinding, Ordinal, OrdinalFinding, PERIOD, Prior,
    RandomIntercept, SmallSample, SphericityCorrection, TermTest,
};

says_itself!(
    Factorial,
    AlignedRanks,
    GroupsAnalysis,
    Equivalence,
    BayesTAnalysis,
    BayesCorrelationAnalysis,
    RandomIntercept,
    Ordinal,
    ByDesign,
);

impl Factorial {
    /// An effect, corrected for a lack of sphericity where its within part has more than one degree of freedom.
    fn effect(&self, name: &str, effect: &FactorialEffect) -> Option<Statement> {
        let uncorrected = F {
            f: effect.f?,
            df_effect: effect.df1 as f64,
            df_error: effect.df2 as f64,
            p: effect.p?,
            eta2_partial: effect.eta2_partial,
            eta2_partial_ci90: effect.eta2_partial_ci90,
            epsilon: None,
        };
        match self.sphericity.get(name) {
            Some(sphericity) => corrected_f(uncorrected, sphericity),
            None => Some(f(&uncorrected)),
        }
    }
}

impl Statements for Factorial {
    fn statements(&self) -> Vec<(String, Statement)> {
        of_each(&self.anova, |name, effect| self.effect(name, effect))
    }
}

impl Statements for AlignedRanks {
    fn statements(&self) -> Vec<(String, Statement)> {
        of_each(&self.art, |_, effect| {
            let df = [effect.df1 as f64, effect.df2 as f64];
            Some(Statement::f_test(df, effect.f?, effect.p?))
        })
    }
}

/// Of two groups Welch's t and Mann-Whitney's U; of more, Welch's F and Kruskal-Wallis, then the pairs after Games and Howell.
impl Statements for GroupsAnalysis {
    fn statements(&self) -> Vec<(String, Statement)> {
        let Some(several) = &self.several else {
            let welch = || {
                let test = self.welch_t.values().next()?;
                let statement = t(test.t?, test.df?, test.p?, Adjustment::None, None);
                let size = self.hedges.values().next()?;
                Some(match size.g {
                    Some(g) => statement.and("*g*", &number(g, 2)).ci(0.95, size.g_ci, number),
                    None => statement,
                })
            };
            let ranks = || {
                let test = self.mann_whitney.values().next()?;
                let statement =
                    Statement(format!("*U* = {}", degrees(test.u))).p(test.p?, Adjustment::None);
                Some(statement.and("*r*_{rb}", &bounded(test.rank_biserial, 2)))
            };
            return those([("welch_t", welch()), ("mann_whitney", ranks())]);
        };
        let welch = || {
            let test = &several.welch_anova;
            let df = [test.df1 as f64, test.df2?];
            Some(Statement::f_test(df, test.f?, test.p?))
        };
        let ranks = || {
            let test = &several.kruskal;
            let statement = chi2(test.chi2?, test.df, self.n, test.p?, None);
            Some(statement.and("*ε*^{2}", &bounded(test.epsilon2?, 2)))
        };
        let mut statements = those([("welch_anova", welch()), ("kruskal", ranks())]);
        // Of the studentised range, not of this t.
        statements.extend(of_each(&several.games_howell, |_, pair| {
            let statement = Statement::with_df("*t*", &[pair.df?], pair.t?);
            Some(statement.p_named("*p*_{Games-Howell}", pair.p?))
        }));
        statements
    }
}

/// `t(23) = 2.41, p = .012, 90% CI [−0.20, 0.11]`: the larger of both one-sided tests; of several pairs `p_Holm`.
impl Statements for Equivalence {
    fn statements(&self) -> Vec<(String, Statement)> {
        let adjusted = self.adjusted();
        of_each(&self.tost, |_, test| {
            let (lower, upper) = (test.t_lower?, test.t_upper?);
            let weaker = if lower.abs() < upper.abs() { lower } else { upper };
            let statement = t(weaker, test.df as f64, test.p_holm?, adjusted, None);
            Some(statement.ci_of_values(0.9, test.ci90))
        })
    }
}

/// `BF10 = 3.20`, or `BF01 = 5.41` where the data speak for no difference.
fn bayes_factor(log_bf10: f64) -> Statement {
    let (symbol, value) = if log_bf10 >= 0.0 {
        ("*BF*_{10}", libm::exp(log_bf10))
    } else {
        ("*BF*_{01}", libm::exp(-log_bf10))
    };
    if value >= 1e5 {
        return Statement(format!("{symbol} = {value:.2e}"));
    }
    Statement::with_df(symbol, &[], value)
}

impl Statement {
    /// `… (Cauchy prior of the standardised effect, scale .71)`.
    fn under(mut self, prior: &Prior, scale: &str) -> Self {
        let (family, parameter) = (&prior.family, &prior.parameter);
        let scale = format!("{scale} {}", bounded(prior.scale, 2));
        let prior = format!(" ({family} prior of the {parameter}, {scale})");
        self.0.push_str(&prior);
        self
    }
}

/// `BF10 = 17.26 (Cauchy prior of the standardised effect, scale .71)`, by the names of the pairs.
impl Statements for BayesTAnalysis {
    fn statements(&self) -> Vec<(String, Statement)> {
        of_each(&self.bayes_t, |_, test| {
            let factor = bayes_factor(test.bf10.and(test.bf01).and(test.log_bf10)?);
            Some(factor.under(&self.prior, "scale"))
        })
    }
}

/// `BF10 = 3.20 (stretched beta prior of the correlation, κ = .33); BF10 = 2.71 (…, κ = 1.00), r = .46`.
impl Statements for BayesCorrelationAnalysis {
    fn statements(&self) -> Vec<(String, Statement)> {
        let bayes_r = &self.bayes_r;
        let statement = || {
            let (third, flat) = (bayes_r.log_bf10?, bayes_r.log_bf10_kappa1?);
            bayes_r.bf10.and(bayes_r.bf01).and(bayes_r.bf10_kappa1)?;
            let factor = bayes_factor(third).under(&self.prior, "*κ* =").0;
            let flat = bayes_factor(flat).under(&self.prior_kappa1, "*κ* =").0;
            let both = Statement(format!("{factor}; {flat}"));
            Some(both.and("*r*", &bounded(bayes_r.r?, 2)))
        };
        those([("bayes_r", statement())])
    }
}

impl McNemarTest {
    /// So many who differ are enough for the mid-p alone.
    const MANY: usize = 25;

    /// `8 against 1, mid-p = .021, exact p = .039, difference = .35, 95% CI [.05, .58]`.
    fn statement(&self, p_mid: f64, adjusted: Adjustment) -> Statement {
        let mid = probability(p_symbol(adjusted), p_mid);
        let exact_symbol = match adjusted {
            Adjustment::None => "exact *p*",
            _ => "exact *p* unadjusted",
        };
        let few = self.only_a + self.only_b < Self::MANY;
        let exact = self
            .p_exact
            .filter(|_| few)
            .map_or_else(String::new, |p| format!(", {}", probability(exact_symbol, p)));
        Statement(format!("{} against {}, mid-{mid}{exact}", self.only_a, self.only_b))
            .and("difference", &bounded(self.difference, 2))
            .ci(0.95, self.difference_ci, bounded)
    }
}

impl Statements for McNemar {
    fn statements(&self) -> Vec<(String, Statement)> {
        let test = &self.mcnemar;
        let statement = test.p_mid.map(|p| test.statement(p, Adjustment::None));
        those([("mcnemar", statement)])
    }
}

impl Statements for CochranQ {
    fn statements(&self) -> Vec<(String, Statement)> {
        let test = &self.cochran_q;
        let omnibus = || {
            let p = (p_symbol(Adjustment::None), test.p?);
            Some(of_n("*Q*", test.q?, [test.df?, self.n], p, test.w))
        };
        let mut statements = those([("cochran_q", omnibus())]);
        statements.extend(of_each(&self.pairs, |_, pair| {
            Some(pair.test.statement(pair.p_holm?, Adjustment::Holm))
        }));
        statements
    }
}

impl TermTest {
    /// `F(2, 23.40) = 4.10, p = .030`; none without degrees of freedom.
    pub fn statement(&self) -> Option<Statement> {
        let df = [self.df1 as f64, self.df2?];
        Some(Statement::f_test(df, self.f, self.p?))
    }
}

impl Statements for RandomIntercept {
    fn statements(&self) -> Vec<(String, Statement)> {
        of_each(&self.anova, |_, test| test.statement())
    }
}

impl Statements for MixedFinding {
    fn statements(&self) -> Vec<(String, Statement)> {
        let mut statements = self.model.statements();
        for (name, statement) in &mut statements {
            let test = self.model.anova.get(name);
            if let (Some(test), Some(term)) = (test, self.corrected.get(name)) {
                let corrected = Statement::f_test([term.df1, term.df2], test.f, term.p);
                *statement = corrected.and("*ε*", &bounded(term.epsilon, 2));
            }
        }
        statements
    }
}

/// The likelihood ratio test of the conditions, then each condition against the first.
impl Statements for Ordinal {
    fn statements(&self) -> Vec<(String, Statement)> {
        let test = &self.quadrature.lr;
        let lr = || {
            let statement = Statement::with_df("*χ*^{2}", &[test.df as f64], test.chi2?);
            Some(statement.p(test.p?, Adjustment::None))
        };
        let mut statements = those([("lr", lr())]);
        statements.extend(of_each(&self.quadrature.coef, |_, parameter| {
            let value = number(parameter.estimate?, 2);
            let statement = Statement(format!("*b* = {value}")).ci(0.95, parameter.ci, number);
            let statement = statement.and("*z*", &number(parameter.z?, 2));
            Some(statement.p(parameter.p?, Adjustment::None))
        }));
        statements
    }
}

/// As of the model, with the conditions held against F.
impl Statements for OrdinalFinding {
    fn statements(&self) -> Vec<(String, Statement)> {
        let mut statements = self.model.statements();
        statements.retain(|(name, _)| name != "lr");
        let statement = |test: &SmallSample| {
            let df = [test.df1 as f64, test.df2 as f64];
            Statement::f_test(df, test.f, test.p)
        };
        if let Some(test) = &self.small_sample {
            statements.insert(0, ("conditions".to_owned(), statement(test)));
        }
        if let Some(test) = &self.period {
            statements.push((PERIOD.to_owned(), statement(test)));
        }
        statements
    }
}

/// Each effect by the test that decides about it; F over a stratum with partial eta squared.
impl Statements for FactorialFinding {
    fn statements(&self) -> Vec<(String, Statement)> {
        of_each(&self.tests, |name, test| {
            let (value, p) = (test.statistic?, test.p?);
            Some(match (test.method, test.df1, test.df2) {
                (
                    EffectMethod::Strata | EffectMethod::StrataGreenhouseGeisser,
                    Some(a),
                    Some(b),
                ) => {
                    let effect = self.anova.anova.get(name)?;
                    f(&F {
                        f: value,
                        df_effect: a,
                        df_error: b,
                        p,
                        eta2_partial: effect.eta2_partial,
                        eta2_partial_ci90: effect.eta2_partial_ci90,
                        epsilon: test
                            .epsilon
                            .filter(|_| test.correction != SphericityCorrection::None),
                    })
                }
                (_, Some(a), Some(b)) => Statement::f_test([a, b], value, p),
                (_, Some(df), None) => chi2(value, df.round() as usize, self.anova.n, p, None),
                (method, ..) => ranks(method, value).p(p, Adjustment::None),
            })
        })
    }
}

/// The test that was chosen, and no other.
impl Statements for ByDesign {
    fn statements(&self) -> Vec<(String, Statement)> {
        match self {
            Self::OneFactor(comparison) => comparison.statements(),
            Self::Factorial(chosen) => chosen.found.statements(),
            Self::Groups(groups) => {
                let (skipped, ranks) = match groups.chosen {
                    ChosenTest::WelchT => ("mann_whitney", false),
                    ChosenTest::MannWhitney => ("welch_t", true),
                    ChosenTest::WelchAnova => ("kruskal", false),
                    _ => ("welch_anova", true),
                };
                let mut statements = groups.found.statements();
                statements.retain(|(name, _)| name != skipped && !(ranks && name.contains('|')));
                if let Some(several) = groups.found.several.as_ref().filter(|_| ranks) {
                    statements.extend(of_each(&several.dunn, |_, pair| {
                        let z = Statement(format!("*z* = {}", number(pair.z?, 2)));
                        Some(z.p(pair.p_holm?, Adjustment::Holm))
                    }));
                }
                statements
            }
            Self::Mixed(chosen) => chosen.found.statements(),
            Self::Ordinal(chosen) => chosen.found.statements(),
        }
    }
}
