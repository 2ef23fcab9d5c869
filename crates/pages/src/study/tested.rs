//! The tests of a panel, each with its numbers and its sentence.

use super::titled;
use crate::{
    texts::value,
    words::{effect_title, in_unit_of, omnibus, over, paired},
};
use maveric_analysis::{Analysis, Contrast, Panel};
use maveric_domain::Design;
use maveric_stats::{
    Adjustment, ByDesign, Chosen, ChosenTest, EffectMethod, FactorialFinding, GroupsAnalysis,
    Interval, PERIOD, SmallSample, apa::Statements,
};
use minijinja::{Value, context};
use serde::Serialize;

/// A test of one effect, or why there is none.
#[derive(Debug, Default, Serialize)]
pub(super) struct Tested {
    outcome: String,
    /// Of a group of people what sets its rows apart, and its level.
    group: String,
    level: String,
    /// `omnibus` where there is one alone.
    effect: String,
    title: String,
    sentence: String,
    reasons: Vec<String>,
    n: usize,
    #[serde(flatten)]
    numbers: Numbers,
}

/// The numbers of a test.
#[derive(Debug, Default, Serialize)]
struct Numbers {
    test: Option<&'static str>,
    statistic: Option<f64>,
    df1: Option<f64>,
    df2: Option<f64>,
    epsilon: Option<f64>,
    p: Option<f64>,
    /// What the effect size is.
    size: Option<&'static str>,
    effect_size: Option<f64>,
    #[serde(flatten)]
    ci: Interval,
}

/// The test of each effect that the design crosses; of one factor, of groups and of ordered answers a single one.
pub(super) fn tested(design: &Design, panel: &Panel) -> Vec<Tested> {
    let group = panel.group.as_ref();
    let row = |effect: &str, sentence: String, numbers: Numbers| Tested {
        outcome: panel.outcome.clone(),
        group: group.map_or_else(String::new, |g| format!(".{}.{}", g.factor, g.level)),
        level: group.map_or_else(String::new, |g| g.level.clone()),
        effect: effect.to_owned(),
        title: titled(panel),
        sentence,
        reasons: panel.reasons.clone(),
        n: panel.n,
        numbers,
    };
    let alone = |numbers| vec![row("omnibus", omnibus(design, panel, false), numbers)];
    let effects = match &panel.comparison {
        None => return alone(Numbers::default()),
        Some(ByDesign::Factorial(found)) => of_factors(&found.found),
        Some(ByDesign::Mixed(found)) => {
            let mixed = &found.found;
            let terms = mixed.model.anova.iter().map(|(name, term)| {
                let corrected = mixed.corrected.get(name);
                let numbers = Numbers {
                    test: Some("F"),
                    statistic: Some(term.f),
                    df1: Some(corrected.map_or(term.df1 as f64, |c| c.df1)),
                    df2: corrected.map_or(term.df2, |c| Some(c.df2)),
                    epsilon: corrected.map(|c| c.epsilon),
                    p: mixed.p(name),
                    ..Numbers::default()
                };
                (name.to_owned(), numbers)
            });
            terms.collect()
        }
        Some(ByDesign::Groups(found)) => {
            let factors = over(design, panel);
            let mut rows = alone(of_groups(found));
            for row in &mut rows {
                row.title = format!("{}: {factors}", row.title);
            }
            return rows;
        }
        Some(ByDesign::Ordinal(found)) => {
            let ratio = |test: Option<&SmallSample>| Numbers {
                test: Some("F"),
                statistic: test.map(|t| t.f),
                df1: test.map(|t| t.df1 as f64),
                df2: test.map(|t| t.df2 as f64),
                p: test.map(|t| t.p),
                ..Numbers::default()
            };
            let conditions = ratio(found.found.small_sample.as_ref());
            match &found.found.period {
                None => return alone(conditions),
                Some(period) => vec![
                    ("conditions".to_owned(), conditions),
                    (PERIOD.to_owned(), ratio(Some(period))),
                ],
            }
        }
        Some(found) => return alone(found.one_factor().map_or_else(Numbers::default, of_one)),
    };
    let sentences = panel.comparison.as_ref().map_or_else(Vec::new, Statements::statements);
    let several = effects.len() > 1;
    let rows = effects.into_iter().filter_map(|(name, numbers)| {
        let (_, said) = sentences.iter().find(|(said, _)| *said == name)?;
        let mut tested = row(&name, said.markup().to_owned(), numbers);
        if several {
            tested.title = format!("{}: {}", tested.title, effect_title(design, &name));
        }
        Some(tested)
    });
    let mut rows: Vec<Tested> = rows.collect();
    // The reasons are those of all effects: the first row has them.
    for row in rows.iter_mut().skip(1) {
        row.reasons.clear();
    }
    if rows.is_empty() {
        return alone(Numbers::default());
    }
    rows
}

fn of_one(found: &maveric_stats::Comparison) -> Numbers {
    use maveric_stats::OmnibusTest;
    let (test, size) = match found.omnibus.test {
        OmnibusTest::Friedman => ("chi2", "kendall_w"),
        OmnibusTest::PairedT => ("t", "dz"),
        OmnibusTest::Wilcoxon => ("V", "rank_biserial"),
        _ => ("F", "eta2_partial"),
    };
    let omnibus = &found.omnibus;
    Numbers {
        test: Some(test),
        statistic: omnibus.statistic,
        df1: omnibus.df1,
        df2: omnibus.df2,
        epsilon: omnibus.epsilon,
        p: omnibus.p,
        size: Some(size),
        effect_size: omnibus.effect.value,
        ci: omnibus.effect.ci,
    }
}

fn of_factors(found: &FactorialFinding) -> Vec<(String, Numbers)> {
    let test = |(name, test): (&str, &maveric_stats::EffectTest)| {
        // Only F over a stratum has a partial eta squared.
        let strata =
            matches!(test.method, EffectMethod::Strata | EffectMethod::StrataGreenhouseGeisser);
        let size = found.anova.anova.get(name).filter(|_| strata);
        let numbers = Numbers {
            test: Some(match (test.df1, test.df2) {
                (Some(_), Some(_)) => "F",
                (Some(_), None) => "chi2",
                _ if test.method == EffectMethod::SignedRanks => "V",
                _ => "U",
            }),
            statistic: test.statistic,
            df1: test.df1,
            df2: test.df2,
            epsilon: test.epsilon,
            p: test.p,
            size: size.map(|_| "eta2_partial"),
            effect_size: size.and_then(|e| e.eta2_partial),
            ci: size.map(|e| e.eta2_partial_ci90).unwrap_or_default(),
        };
        (name.to_owned(), numbers)
    };
    found.tests.iter().map(test).collect()
}

fn of_groups(found: &Chosen<GroupsAnalysis>) -> Numbers {
    let (chosen, found) = (found.chosen, &found.found);
    let several = found.several.as_ref();
    match chosen {
        ChosenTest::WelchT => {
            let (test, size) = (found.welch_t.values().next(), found.hedges.values().next());
            Numbers {
                test: Some("t"),
                statistic: test.and_then(|t| t.t),
                df1: test.and_then(|t| t.df),
                p: test.and_then(|t| t.p),
                size: Some("hedges_g"),
                effect_size: size.and_then(|s| s.g),
                ci: size.map(|s| s.g_ci).unwrap_or_default(),
                ..Numbers::default()
            }
        }
        ChosenTest::MannWhitney => {
            let test = found.mann_whitney.values().next();
            Numbers {
                test: Some("U"),
                statistic: test.map(|t| t.u),
                p: test.and_then(|t| t.p),
                size: Some("rank_biserial"),
                effect_size: test.map(|t| t.rank_biserial),
                ci: test.map(|t| t.rank_biserial_ci).unwrap_or_default(),
                ..Numbers::default()
            }
        }
        ChosenTest::WelchAnova => {
            let test = several.map(|s| &s.welch_anova);
            Numbers {
                test: Some("F"),
                statistic: test.and_then(|t| t.f),
                df1: test.map(|t| t.df1 as f64),
                df2: test.and_then(|t| t.df2),
                p: test.and_then(|t| t.p),
                ..Numbers::default()
            }
        }
        _ => {
            let test = several.map(|s| &s.kruskal);
            Numbers {
                test: Some("chi2"),
                statistic: test.and_then(|t| t.chi2),
                df1: test.map(|t| t.df as f64),
                p: test.and_then(|t| t.p),
                size: Some("epsilon2"),
                effect_size: test.and_then(|t| t.epsilon2),
                ..Numbers::default()
            }
        }
    }
}

/// A contrast with its test and its sentence.
pub(super) fn contrast(analysis: &Analysis, panel: &Panel, pair: &Contrast) -> Value {
    let group = panel.group.as_ref();
    context! {
        outcome => panel.outcome.as_str(),
        group => group.map_or_else(String::new, |g| format!(".{}.{}", g.factor, g.level)),
        level => group.map_or("", |g| g.level.as_str()),
        title => titled(panel),
        unit => panel.unit.as_str(),
        sentence => paired(panel, pair, Adjustment::None),
        test => value(&panel.test),
        se => pair.se,
        interval => value(&pair.interval),
        unbounded => pair.unbounded,
        odds => value(&pair.odds),
        n => panel.n,
        ..context! { ..in_unit_of(analysis, &panel.outcome), ..value(pair) }
    }
}
