//! Results as sentences: which numbers of a test go into which APA string.

use maveric_report::apa::{self, F, Interval, Statement};
use maveric_stats::{
    Adjustment, Correlation, Friedman, Mauchly, Omnibus, OmnibusTest, Posthoc, PosthocTest,
    RmAnova, RmCorrelation, Sphericity, SphericityCorrection, WithinAnalysis,
};
use serde_json::{Map, Value};

type Said = Map<String, Value>;

fn insert(said: &mut Said, name: &str, statement: Option<Statement>) {
    if let Some(statement) = statement {
        said.insert(name.to_owned(), statement.to_string().into());
    }
}

fn interval(level: f64, low: Option<f64>, high: Option<f64>) -> Option<Interval> {
    Some(Interval {
        level,
        low: low?,
        high: high?,
    })
}

/// The omnibus test that [`maveric_stats::compare`] chose; `short` leaves out interval and ε.
pub(crate) fn omnibus(found: &Omnibus, n: usize, short: bool) -> Option<Statement> {
    let (statistic, df1, p) = (found.statistic?, found.df1?, found.p?);
    if found.test == OmnibusTest::Friedman {
        return Some(apa::chi2(
            statistic,
            df1.round() as usize,
            n,
            p,
            found.effect.value,
        ));
    }
    Some(apa::f(&F {
        f: statistic,
        df_effect: df1,
        df_error: found.df2?,
        p,
        eta2_partial: found.effect.value,
        interval: interval(
            found.effect.confidence,
            found.effect.ci_low,
            found.effect.ci_high,
        )
        .filter(|_| !short),
        epsilon: found
            .epsilon
            .filter(|_| !short && found.correction != SphericityCorrection::None),
    }))
}

/// F, corrected after Greenhouse and Geisser where Mauchly's test rejects sphericity.
pub(super) fn rm_anova(found: &RmAnova, mauchly: &Mauchly, sphericity: &Sphericity) -> Said {
    let corrected = mauchly.p.is_none_or(|p| p < super::ALPHA) && found.df1 > 1;
    let epsilon = if corrected { sphericity.gg } else { None };
    let statement = || {
        Some(apa::f(&F {
            f: found.f?,
            df_effect: found.df1 as f64 * epsilon.unwrap_or(1.0),
            df_error: found.df2 as f64 * epsilon.unwrap_or(1.0),
            p: if epsilon.is_some() {
                sphericity.p_gg?
            } else {
                found.p?
            },
            eta2_partial: found.eta2_partial,
            interval: interval(
                0.9,
                found.eta2_partial_ci90_low,
                found.eta2_partial_ci90_high,
            ),
            epsilon,
        }))
    };
    let mut said = Said::new();
    insert(&mut said, "rm_anova", statement());
    said
}

/// Friedman's chi-squared.
pub(super) fn friedman(found: &Friedman, n: usize) -> Said {
    let statement = || {
        Some(apa::chi2(
            found.chi2?,
            found.df?,
            n,
            found.p?,
            found.kendall_w,
        ))
    };
    let mut said = Said::new();
    insert(&mut said, "friedman", statement());
    said
}

/// The pairs of a post-hoc test.
pub(super) fn pairs(found: &Posthoc) -> Said {
    let label = match found.adjust {
        Adjustment::Holm => "p_Holm",
        Adjustment::Bonferroni => "p_Bonferroni",
        Adjustment::Hochberg => "p_Hochberg",
        Adjustment::Bh => "p_BH",
        _ => "p",
    };
    let mut said = Said::new();
    for (name, pair) in found.pairs.iter() {
        let statement = || {
            let (statistic, p) = (pair.statistic?, pair.p_adjusted?);
            let effect = &pair.effect;
            let ci = interval(effect.confidence, effect.ci_low, effect.ci_high);
            let text = match (found.test, pair.df) {
                (PosthocTest::T | PosthocTest::PooledT, Some(df)) => {
                    apa::t(statistic, df, p, effect.value.map(|dz| (dz, ci))).to_string()
                }
                (PosthocTest::Conover, Some(df)) => apa::t(statistic, df, p, None).to_string(),
                (PosthocTest::Wilcoxon, _) => apa::wilcoxon(statistic, p, effect.value).to_string(),
                (PosthocTest::Nemenyi, _) => {
                    let q = apa::number(statistic, 2);
                    format!("q({}, ∞) = {q}, {}", found.k, apa::p(p))
                }
                _ => return None,
            };
            // The sentences of the report are Holm's.
            Some(text.replace("p_Holm", label))
        };
        if let Some(text) = statement() {
            said.insert(name.to_owned(), text.into());
        }
    }
    said
}

/// The whole analysis.
pub(super) fn within(found: &WithinAnalysis) -> Said {
    let mut said = rm_anova(&found.rm_anova, &found.mauchly, &found.sphericity);
    said.append(&mut friedman(&found.friedman, found.n));
    for (name, pair) in found.paired.iter() {
        let statement = || {
            let ci = interval(0.95, pair.dz_ci_low, pair.dz_ci_high);
            Some(apa::t(
                pair.t?,
                pair.df,
                pair.p_holm?,
                pair.dz.map(|dz| (dz, ci)),
            ))
        };
        insert(&mut said, name, statement());
    }
    said
}

/// The coefficients that were computed.
pub(super) fn correlation(found: &Correlation) -> Said {
    let mut said = Said::new();
    if let Some(pearson) = &found.pearson {
        insert(
            &mut said,
            "pearson",
            (|| Some(apa::r(pearson.r?, pearson.df?, pearson.p?)))(),
        );
    }
    if let Some(spearman) = &found.spearman {
        insert(
            &mut said,
            "spearman",
            (|| Some(apa::rho(spearman.rho?, spearman.df?, spearman.p?)))(),
        );
    }
    if let Some(kendall) = &found.kendall
        && let (Some(tau), Some(p)) = (kendall.tau_b, kendall.p)
    {
        let text = format!("τ_b = {}, {}", apa::bounded(tau, 2), apa::p(p));
        said.insert("kendall".to_owned(), text.into());
    }
    said
}

/// The correlation within subjects.
pub(super) fn rm_correlation(found: &RmCorrelation) -> Said {
    let mut said = Said::new();
    insert(
        &mut said,
        "rm_corr",
        (|| Some(apa::r_rm(found.r?, found.df?, found.p?)))(),
    );
    said
}
