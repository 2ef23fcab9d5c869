//! The report of independent groups, and of bounds.

use super::{
    Printed,
    cells::{degrees, effect, interval, number, optional, p, share, table},
    named_sentences,
};
use maveric_report::tables::Cell;
use maveric_stats::{Equivalence, GroupsAnalysis};

pub(in crate::stages::stats) fn groups(found: &GroupsAnalysis) -> Printed {
    let who = format!("Independent groups: {} values, {} groups", found.n, found.k);
    let mut desc = table("Groups", &["", "*n*", "*M*", "95% CI", "*SD*"]);
    for (name, g) in found.desc.iter() {
        desc.rows.push(vec![
            Cell::text(name),
            Cell::count(g.n),
            number(g.mean),
            interval(g.ci_low, g.ci_high, optional),
            optional(g.sd),
        ]);
    }
    desc.notes = named_sentences(found);
    let header = [
        "",
        "Difference",
        "95% CI",
        "*t*",
        "*df*",
        "*p*",
        "*g*",
        "95% CI",
        "*U*",
        "*p*",
        "*r*_{rb}",
    ];
    let mut pairs = table(
        "Pairs by Welch's t and Mann-Whitney (A minus B; not adjusted)",
        &header,
    );
    let tests = found
        .welch_t
        .iter()
        .zip(found.hedges.values())
        .zip(found.mann_whitney.values());
    for (((name, t), size), u) in tests {
        pairs.rows.push(vec![
            Cell::text(name),
            number(t.mean_diff),
            interval(t.ci_low, t.ci_high, optional),
            optional(t.t),
            degrees(t.df),
            p(t.p),
            effect(size.g),
            interval(size.g_ci_low, size.g_ci_high, effect),
            number(u.u),
            p(u.p),
            share(Some(u.rank_biserial)),
        ]);
    }
    let mut printed = Printed::headed(who, 0, &[])
        .left_out(found.missing, "rows")
        .table(desc)
        .table(pairs);
    if let Some(several) = &found.several {
        let header = [
            "",
            "*t* (Games-Howell)",
            "*df*",
            "*p*",
            "95% CI",
            "*z* (Dunn)",
            "*p*_{Holm}",
        ];
        let mut all = table("Pairs of all groups (A minus B)", &header);
        for ((name, t), z) in several.games_howell.iter().zip(several.dunn.values()) {
            let ci = interval(t.ci_low, t.ci_high, optional);
            let row = vec![
                Cell::text(name),
                optional(t.t),
                degrees(t.df),
                p(t.p),
                ci,
                optional(z.z),
                p(z.p_holm),
            ];
            all.rows.push(row);
        }
        printed = printed.table(all);
    }
    printed.undefined(&found.undefined)
}

pub(in crate::stages::stats) fn equivalence(found: &Equivalence) -> Printed {
    let header = [
        "",
        "Difference",
        "90% CI",
        "Bounds",
        "*p* (two one-sided)",
        "*p*_{Holm}",
        "Equivalent",
        "*p* (difference)",
    ];
    let mut table = table("Equivalence", &header);
    for (name, t) in found.tost.iter() {
        let word = |yes: Option<bool>| {
            yes.map_or(Cell::Missing, |yes| {
                Cell::text(if yes { "yes" } else { "not shown" })
            })
        };
        table.rows.push(vec![
            Cell::text(name),
            number(t.estimate),
            interval(t.ci90_low, t.ci90_high, optional),
            interval(t.low, t.high, optional),
            p(t.p),
            p(t.p_holm),
            word(t.equivalent),
            p(t.p_difference),
        ]);
    }
    table.notes = named_sentences(found);
    let who = format!("Equivalence by two one-sided tests: {} subjects", found.n);
    Printed::headed(who, found.n, &found.dropped)
        .left_out(found.missing, "values")
        .table(table)
        .undefined(&found.undefined)
}
