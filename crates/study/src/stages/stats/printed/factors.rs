//! The report of factorial designs.

use super::{
    Printed,
    cells::{degrees, interval, number, optional, p, share, table},
    named_sentences,
};
use maveric_report::tables::{Cell, Table};
use maveric_stats::{
    AlignedRanks, CellContrast, Factorial, FactorialFinding, MarginalMean, Named, SimpleEffect,
    Sphericity,
};

pub(in crate::stages::stats) fn factorial(result: &Factorial) -> Printed {
    let factors = result
        .levels
        .iter()
        .map(|(name, levels)| format!("{name} ({})", levels.join(", ")));
    let who = format!(
        "Factorial analysis: {} subjects; {}",
        result.n,
        factors.collect::<Vec<_>>().join("; ")
    );
    let mut effects = effects(result);
    effects.notes = named_sentences(result);
    let mut printed = Printed::headed(who, result.n, &result.dropped).table(effects);
    for (name, means) in result.emm.iter() {
        printed = printed.table(marginal(name, means));
    }
    for (name, pairs) in result.contrast.iter() {
        printed = printed.table(contrasts(name, pairs));
    }
    let inner = result.simple.iter().flat_map(|(interaction, tests)| {
        tests
            .iter()
            .map(move |(name, test)| (format!("{interaction}: {name}"), test))
    });
    let inner: Vec<_> = inner.collect();
    let mut simple = table("Simple effects", &inner)
        .text("Effect", |(whole, _)| whole)
        .right("*F*", |(_, test)| optional(deciding_f(test).0))
        .right("*df*_{1}", |(_, test)| degrees(Some(test.df1 as f64)))
        .right("*df*_{2}", |(_, test)| {
            degrees(Some(deciding_f(test).1 as f64))
        })
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
        result
            .sphericity
            .get(name)
            .map_or_else(|| Cell::text(""), column)
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
        .right("90% CI", |(_, e)| interval(e.eta2_partial_ci90, share))
        .right("*η*_{G}^{2}", |(_, e)| share(e.eta2_generalized))
        .done()
}

/// Each effect by the test that decides about it.
pub(super) fn deciding(result: &FactorialFinding) -> Table {
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
    table(&format!("Means of {name}"), means.iter())
        .text("", |(cell, _)| *cell)
        .right("*M*", |(_, m)| number(m.mean))
        .right("*SE*", |(_, m)| number(m.se))
        .right("95% CI", |(_, m)| interval(m.ci, optional))
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
    Printed::headed(who, result.n, &result.dropped)
        .table(table)
        .undefined(&result.undefined)
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
        let exact = ExactTest {
            f: Some(3.5),
            df2: 7,
            p: Some(0.09),
        };
        let hotelling = SimpleEffect {
            exact: Some(exact),
            ..wald
        };
        assert_eq!(deciding_f(&hotelling), (Some(3.5), 7, Some(0.09)));
    }
}
