//! The report of factorial designs.

use super::{
    Printed,
    cells::{degrees, ends, estimate, interval, number, optional, p, share, table},
    named_sentences,
};
use maveric_report::tables::{Cell, Table};
use maveric_stats::{
    AlignedRanks, CellContrast, EffectMethod, EffectTest, Factorial, FactorialFinding, FollowUp,
    Interval, LevelPair, MarginalMean, Named, SimpleEffect, SimplePairs, Sphericity,
};

/// What was analysed, with its factors and their levels.
fn headed(result: &Factorial) -> Printed {
    let factors =
        result.levels.iter().map(|(name, levels)| format!("{name} ({})", levels.join(", ")));
    let who = format!(
        "Factorial analysis: {} subjects; {}",
        result.n,
        factors.collect::<Vec<_>>().join("; ")
    );
    Printed::headed(who, result.n, &result.dropped)
}

/// Each effect by the test that decides about it, with what follows it.
pub(super) fn decided(result: &FactorialFinding, after: &FollowUp) -> Printed {
    let mut printed = headed(&result.anova).table(deciding(result));
    let suffix = at_covariates(&after.covariates);
    for (name, means) in after.emm.iter() {
        let means = means.iter();
        let means = means.map(|(cell, m)| (cell, m.mean, m.se, m.ci));
        printed = printed.table(means_of(&format!("{name}{suffix}"), means));
    }
    for (name, pairs) in after.contrast.iter() {
        printed = printed.table(level_pairs(name, pairs));
    }
    let number_of = |number: fn(&EffectTest) -> Option<f64>| {
        move |simple: &&SimplePairs| number(simple.effect.test.as_ref()?)
    };
    let [statistic, df1, df2, p_alone] = [
        number_of(|test| test.statistic),
        number_of(|test| test.df1),
        number_of(|test| test.df2),
        number_of(|test| test.p),
    ];
    let title = "Simple effects (Holm over those of two factors)";
    let simple = table(title, &after.simple)
        .text("Effect", |simple| simple_name(simple))
        .text("Test", |simple| {
            let test = simple.effect.test.as_ref();
            test.map_or("", |test| test.method.title())
        })
        .right("Statistic", |simple| optional(statistic(simple)))
        .right("*df*_{1}", |simple| degrees(df1(simple)))
        .right("*df*_{2}", |simple| degrees(df2(simple)))
        .right("*p*", |simple| p(p_alone(simple)))
        .right("*p*_{Holm}", |simple| p(simple.effect.p_holm))
        .done();
    printed = printed.table(simple);
    for simple in after.simple.iter().filter(|s| !s.pairs.is_empty()) {
        printed = printed.table(level_pairs(&simple_name(simple), &simple.pairs));
    }
    printed.undefined(&after.undefined)
}

/// At which value of the covariates the means are: nothing without covariates.
pub(in crate::stages::stats) fn at_covariates(covariates: &[String]) -> String {
    match covariates {
        [] => String::new(),
        covariates => format!(", at the mean of {}", covariates.join(" and ")),
    }
}

fn simple_name(SimplePairs { effect, .. }: &SimplePairs) -> String {
    format!("{} at {} = {}", effect.factor, effect.at, effect.level)
}

/// Pairs of levels: by *t*, or where ranks decide by theirs, which have neither an interval nor degrees of freedom.
fn level_pairs(term: &str, pairs: &Named<LevelPair>) -> Table {
    let ranks = pairs.values().any(|pair| pair.test.method.is_of_ranks());
    let statistic = match pairs.values().next().map(|pair| pair.test.method) {
        Some(EffectMethod::GroupRanks) => "*U*",
        Some(_) if ranks => "*V*",
        _ => "*t*",
    };
    let table = table(&format!("Pairs of {term} (A minus B, Holm)"), pairs.iter())
        .text("", |(name, _)| *name)
        .right("Difference", |(_, pair)| number(pair.test.estimate))
        .and_if(!ranks, |table| table.right("95% CI", |(_, pair)| interval(pair.test.ci, optional)))
        .right(statistic, |(_, pair)| optional(pair.test.statistic))
        .and_if(!ranks, |table| table.right("*df*", |(_, pair)| degrees(pair.test.df)));
    table
        .right("*p*", |(_, pair)| p(pair.test.p))
        .right("*p*_{Holm}", |(_, pair)| p(pair.p_holm))
        .done()
}

pub(in crate::stages::stats) fn factorial(result: &Factorial) -> Printed {
    let mut effects = effects(result);
    effects.notes = named_sentences(result);
    let mut printed = headed(result).table(effects);
    for (name, means) in result.emm.iter() {
        printed = printed.table(marginal(name, means));
    }
    for (name, pairs) in result.contrast.iter() {
        printed = printed.table(contrasts(name, pairs));
    }
    let inner = result.simple.iter().flat_map(|(interaction, tests)| {
        tests.iter().map(move |(name, test)| (format!("{interaction}: {name}"), test))
    });
    let inner: Vec<_> = inner.collect();
    let mut simple = table("Simple effects", &inner)
        .text("Effect", |(whole, _)| whole)
        .right("*F*", |(_, test)| optional(deciding_f(test).0))
        .right("*df*_{1}", |(_, test)| degrees(Some(test.df1 as f64)))
        .right("*df*_{2}", |(_, test)| degrees(Some(deciding_f(test).1 as f64)))
        .right("*p*", |(_, test)| p(deciding_f(test).2))
        .done();
    if inner.iter().any(|(_, test)| test.exact.is_some()) {
        let note = "Of a factor within subjects with more than two levels: Hotelling's exact *F*.";
        simple.notes.push(note.to_owned());
    }
    printed = printed.table(simple);
    for (whole, test) in inner.iter().filter(|(_, test)| test.pairs.len() > 1) {
        printed = printed.table(contrasts(whole, &test.pairs));
    }
    printed.undefined(&result.undefined)
}

/// F of a simple effect with the degrees of freedom of its error and p: the exact one, as T² over its degrees of freedom finds too much.
fn deciding_f(test: &SimpleEffect) -> (Option<f64>, usize, Option<f64>) {
    let exact = test.exact.as_ref();
    exact.map_or((test.f, test.df2, test.p), |e| (e.f, e.df2, e.p))
}

fn effects(result: &Factorial) -> Table {
    let epsilon = |name: &str, column: fn(&Sphericity) -> Cell| {
        result.sphericity.get(name).map_or_else(|| Cell::text(""), column)
    };
    table("Effects", result.anova.iter())
        .text("Effect", |(name, _)| *name)
        .right("*F*", |(_, e)| optional(e.f))
        .right("*df*_{1}", |(_, e)| degrees(Some(e.df1 as f64)))
        .right("*df*_{2}", |(_, e)| degrees(Some(e.df2 as f64)))
        .right("*p*", |(_, e)| p(e.p))
        .right("*ε*_{GG}", |(name, _)| epsilon(name, |s| share(s.gg)))
        .right("*p*_{GG}", |(name, _)| epsilon(name, |s| p(s.p_gg)))
        .right("*η*_{p}^{2}", |(_, e)| share(e.eta2_partial))
        .right("90% CI", |(_, e)| interval(e.eta2_partial_ci90.holding(e.eta2_partial), share))
        .right("*η*_{G}^{2}", |(_, e)| share(e.eta2_generalized))
        .done()
}

/// Each effect by the test that decides about it.
fn deciding(result: &FactorialFinding) -> Table {
    let mut table = table("Effects", result.tests.iter())
        .text("Effect", |(name, _)| *name)
        .text("Test", |(_, test)| test.method.title())
        .right("Statistic", |(_, test)| optional(test.statistic))
        .right("*df*_{1}", |(_, test)| degrees(test.df1))
        .right("*df*_{2}", |(_, test)| degrees(test.df2))
        .right("*ε*", |(_, test)| share(test.epsilon))
        .right("*p*", |(_, test)| p(test.p))
        .done();
    table.notes = named_sentences(result);
    table
}

pub(super) fn marginal(name: &str, means: &Named<MarginalMean>) -> Table {
    let means = means.iter();
    means_of(name, means.map(|(cell, m)| (cell, m.mean, Some(m.se), m.ci)))
}

/// Means with their standard errors and intervals, by cell.
fn means_of<'a>(
    name: &str,
    means: impl Iterator<Item = (&'a str, f64, Option<f64>, Interval)>,
) -> Table {
    table(&format!("Means of {name}"), means)
        .text("", |(cell, ..)| *cell)
        .right("*M*", |(_, mean, _, ci)| estimate(*mean, *ci))
        .right("*SE*", |(_, _, se, _)| optional(*se))
        .right("95% CI", |(.., ci)| ends(*ci))
        .done()
}

fn contrasts(term: &str, pairs: &Named<CellContrast>) -> Table {
    table(&format!("Pairs of {term} (A minus B, Holm)"), pairs.iter())
        .text("", |(name, _)| *name)
        .right("Difference", |(_, c)| number(c.estimate))
        .right("95% CI", |(_, c)| interval(c.ci, optional))
        .right("*t*", |(_, c)| optional(c.t))
        .right("*p*", |(_, c)| p(c.p))
        .right("*p*_{Holm}", |(_, c)| p(c.p_holm))
        .done()
}

pub(in crate::stages::stats) fn aligned(result: &AlignedRanks) -> Printed {
    let mut table = table("Effects on aligned ranks", result.art.iter())
        .text("Effect", |(name, _)| *name)
        .right("*F*", |(_, e)| optional(e.f))
        .right("*df*_{1}", |(_, e)| degrees(Some(e.df1 as f64)))
        .right("*df*_{2}", |(_, e)| degrees(Some(e.df2 as f64)))
        .right("*p*", |(_, e)| p(e.p))
        .done();
    table.notes = named_sentences(result);
    let who = format!("Aligned ranks: {} subjects", result.n);
    Printed::headed(who, result.n, &result.dropped).table(table).undefined(&result.undefined)
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_stats::ExactTest;

    #[test]
    fn a_simple_effect_is_printed_by_the_exact_f_where_there_is_one() {
        let wald = SimpleEffect {
            f: Some(4.0),
            df1: 2,
            df2: 8,
            p: Some(0.06),
            exact: None,
            pairs: Named::default(),
        };
        assert_eq!(deciding_f(&wald), (Some(4.0), 8, Some(0.06)));
        let exact = ExactTest { f: Some(3.5), df2: 7, p: Some(0.09) };
        let hotelling = SimpleEffect { exact: Some(exact), ..wald };
        assert_eq!(deciding_f(&hotelling), (Some(3.5), 7, Some(0.09)));
    }
}
