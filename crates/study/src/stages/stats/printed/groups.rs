//! The report of independent groups, and of bounds.

use super::{
    Printed,
    cells::{degrees, effect, ends, estimate, interval, number, optional, p, share, table},
    named_sentences,
};
use maveric_report::tables::Cell;
use maveric_stats::{Equivalence, GroupsAnalysis, Interval};

pub(in crate::stages::stats) fn groups(result: &GroupsAnalysis) -> Printed {
    let who = format!("Independent groups: {} values, {} groups", result.n, result.k);
    let mut desc = table("Groups", result.desc.iter())
        .text("", |(name, _)| *name)
        .right("*n*", |(_, g)| Cell::count(g.n))
        .right("*M*", |(_, g)| estimate(g.mean, g.ci))
        .right("95% CI", |(_, g)| ends(g.ci))
        .right("*SD*", |(_, g)| optional(g.sd))
        .done();
    desc.notes = named_sentences(result);
    let others = result.hedges.values().zip(result.mann_whitney.values());
    let title = "Pairs by Welch's t and Mann-Whitney (A minus B; not adjusted)";
    let pairs = table(title, result.welch_t.iter().zip(others))
        .text("", |((name, _), _)| *name)
        .right("Difference", |((_, t), _)| number(t.mean_diff))
        .right("95% CI", |((_, t), _)| interval(t.ci, optional))
        .right("*t*", |((_, t), _)| optional(t.t))
        .right("*df*", |((_, t), _)| degrees(t.df))
        .right("*p*", |((_, t), _)| p(t.p))
        .right("*g*", |(_, (size, _))| effect(size.g))
        .right("95% CI", |(_, (size, _))| interval(size.g_ci, effect))
        .right("*U*", |(_, (_, u))| number(u.u))
        .right("*p*", |(_, (_, u))| p(u.p))
        .right("*r*_{rb}", |(_, (_, u))| share(Some(u.rank_biserial)))
        .done();
    let mut printed =
        Printed::headed(who, 0, &[]).left_out(result.missing, "rows").table(desc).table(pairs);
    if let Some(several) = &result.several {
        let pairs = several.games_howell.iter().zip(several.dunn.values());
        let by_pair = table("Pairs of all groups (A minus B)", pairs)
            .text("", |((name, _), _)| *name)
            .right("*t* (Games-Howell)", |((_, t), _)| optional(t.t))
            .right("*df*", |((_, t), _)| degrees(t.df))
            .right("*p*", |((_, t), _)| p(t.p))
            .right("95% CI", |((_, t), _)| interval(t.ci, optional))
            .right("*z* (Dunn)", |(_, z)| optional(z.z))
            .right("*p*_{Holm}", |(_, z)| p(z.p_holm))
            .done();
        printed = printed.table(by_pair);
    }
    printed.undefined(&result.undefined)
}

pub(in crate::stages::stats) fn equivalence(result: &Equivalence) -> Printed {
    let mut table = table("Equivalence", result.tost.iter())
        .text("", |(name, _)| *name)
        .right("Difference", |(_, t)| number(t.estimate))
        .right("90% CI", |(_, t)| interval(t.ci90, optional))
        .right("Bounds", |(_, t)| {
            let (low, high) = (t.low, t.high);
            interval(Interval { low, high }, optional)
        })
        .right("*p* (two one-sided)", |(_, t)| p(t.p))
        .right("*p*_{Holm}", |(_, t)| p(t.p_holm))
        .right("Equivalent", |(_, t)| Cell::word(t.equivalent_holm, "yes", "not shown"))
        .right("*p* (difference)", |(_, t)| p(t.p_difference))
        .done();
    table.notes = named_sentences(result);
    let counted = if result.is_of_one_sample() { "values" } else { "subjects" };
    let who = format!("Equivalence by two one-sided tests: {} {counted}", result.n);
    Printed::headed(who, result.n, &result.dropped)
        .left_out(result.missing, "values")
        .table(table)
        .undefined(&result.undefined)
}
