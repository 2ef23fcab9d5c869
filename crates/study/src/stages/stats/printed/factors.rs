//! The report of factorial designs.

use super::{
    Printed,
    cells::{degrees, interval, number, optional, p, share, table},
    named_sentences,
};
use maveric_report::tables::{Cell, Table};
use maveric_stats::{AlignedRanks, CellContrast, Factorial, MarginalMean, Named};

pub(in crate::stages::stats) fn factorial(found: &Factorial) -> Printed {
    let factors = found
        .levels
        .iter()
        .map(|(name, levels)| format!("{name} ({})", levels.join(", ")));
    let who = format!(
        "Factorial analysis: {} subjects; {}",
        found.n,
        factors.collect::<Vec<_>>().join("; ")
    );
    let mut effects = effects(found);
    effects.notes = named_sentences(found);
    let mut printed = Printed::headed(who, found.n, &found.dropped).table(effects);
    for (name, means) in found.emm.iter() {
        printed = printed.table(marginal(name, means));
    }
    for (name, pairs) in found.contrast.iter() {
        printed = printed.table(contrasts(
            &format!("Pairs of {name} (A minus B, Holm)"),
            pairs,
        ));
    }
    let mut simple = table(
        "Simple effects",
        &["Effect", "*F*", "*df*_{1}", "*df*_{2}", "*p*"],
    );
    let mut pairs = Vec::new();
    for (interaction, all) in found.simple.iter() {
        for (name, test) in all.iter() {
            let whole = format!("{interaction}: {name}");
            let df = [test.df1, test.df2].map(|df| degrees(Some(df as f64)));
            let [df1, df2] = df;
            simple.rows.push(vec![
                Cell::text(&whole),
                optional(test.f),
                df1,
                df2,
                p(test.p),
            ]);
            if test.pairs.len() > 1 {
                pairs.push(contrasts(
                    &format!("Pairs of {whole} (A minus B, Holm)"),
                    &test.pairs,
                ));
            }
        }
    }
    printed = printed.table(simple);
    for table in pairs {
        printed = printed.table(table);
    }
    printed.undefined(&found.undefined)
}

fn effects(found: &Factorial) -> Table {
    let header = [
        "Effect",
        "*F*",
        "*df*_{1}",
        "*df*_{2}",
        "*p*",
        "*ε*_{GG}",
        "*p*_{GG}",
        "*η*_{p}^{2}",
        "90% CI",
        "*η*_{G}^{2}",
    ];
    let mut table = table("Effects", &header);
    for (name, e) in found.anova.iter() {
        let sphericity = found.sphericity.get(name);
        table.rows.push(vec![
            Cell::text(name),
            optional(e.f),
            degrees(Some(e.df1 as f64)),
            degrees(Some(e.df2 as f64)),
            p(e.p),
            sphericity.map_or_else(|| Cell::text(""), |s| share(s.gg)),
            sphericity.map_or_else(|| Cell::text(""), |s| p(s.p_gg)),
            share(e.eta2_partial),
            interval(e.eta2_partial_ci90_low, e.eta2_partial_ci90_high, share),
            share(e.eta2_generalized),
        ]);
    }
    table
}

pub(super) fn marginal(name: &str, means: &Named<MarginalMean>) -> Table {
    let mut table = table(&format!("Means of {name}"), &["", "*M*", "*SE*", "95% CI"]);
    for (cell, m) in means.iter() {
        let ci = interval(m.ci_low, m.ci_high, optional);
        table
            .rows
            .push(vec![Cell::text(cell), number(m.mean), number(m.se), ci]);
    }
    table
}

fn contrasts(title: &str, pairs: &Named<CellContrast>) -> Table {
    let header = ["", "Difference", "95% CI", "*t*", "*p*", "*p*_{Holm}"];
    let mut table = table(title, &header);
    for (name, c) in pairs.iter() {
        let ci = interval(c.ci_low, c.ci_high, optional);
        table.rows.push(vec![
            Cell::text(name),
            number(c.estimate),
            ci,
            optional(c.t),
            p(c.p),
            p(c.p_holm),
        ]);
    }
    table
}

pub(in crate::stages::stats) fn aligned(found: &AlignedRanks) -> Printed {
    let mut table = table(
        "Effects on aligned ranks",
        &["Effect", "*F*", "*df*_{1}", "*df*_{2}", "*p*"],
    );
    for (name, e) in found.art.iter() {
        let [df1, df2] = [e.df1, e.df2].map(|df| degrees(Some(df as f64)));
        table
            .rows
            .push(vec![Cell::text(name), optional(e.f), df1, df2, p(e.p)]);
    }
    table.notes = named_sentences(found);
    let who = format!("Aligned ranks: {} subjects", found.n);
    Printed::headed(who, found.n, &found.dropped)
        .table(table)
        .undefined(&found.undefined)
}
