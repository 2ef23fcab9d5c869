//! Cells of any design, each with its mean as the test has it.

use super::{
    Picture,
    cells::{HOLM, p_text},
    first,
};
use crate::stages::stats::{
    printed::{at_covariates, named_sentence},
    rows::DesignRows,
};
use maveric_report::figures::{
    comparison::{ComparedCell, ComparisonPanel, Contrast},
    forest::{Forest, ForestRow},
    interaction::{InteractionLine, InteractionPanel},
};
use maveric_stats::{
    AlignedRanks, Bounds, ByDesign, ChosenTest, Equivalence, Factorial, FactorialFinding, FollowUp,
    GroupsAnalysis, Interval, MarginalContrast, Named, Ordinal, RandomIntercept,
    apa::{self, Statements},
};

const MARGINAL: &str = "95% intervals of the marginal means";
/// More pairs than this would make a picture of brackets.
const MOST_BRACKETS: usize = 12;
/// More lines than this cannot be told apart.
const MOST_LINES: usize = 12;
const TOO_MANY: &str = "pairs stand in the tables: they are too many to draw";
const NOT_ADJUSTED: &str = "*p* values, not adjusted";

/// A number by the name of its cell (its levels joined with `:`), or of its pair of cells (`A|B`).
type ByName<T> = Vec<(String, Option<T>)>;

fn by_name<T: Copy>(values: &[(String, Option<T>)], name: &str) -> Option<T> {
    values.iter().find(|(known, _)| known == name)?.1
}

/// What is said over the cells.
#[derive(Default)]
struct Over {
    test: String,
    /// Each cell's mean and the ends of its interval; none where the test has no means.
    means: ByName<[f64; 3]>,
    intervals: &'static str,
    /// p of each pair that is drawn.
    pairs: ByName<f64>,
    contrasts: &'static str,
}

/// Rainclouds of the cells that the factors cross to; the last factor counts fastest.
fn rainclouds(rows: &DesignRows, outcome: &str, over: Over) -> Picture {
    let levels = rows.levels();
    let mut cells: Vec<Vec<&str>> = vec![Vec::new()];
    for levels in &levels {
        let mut next = Vec::new();
        for cell in &cells {
            next.extend(levels.iter().map(|level| [&cell[..], &[*level]].concat()));
        }
        cells = next;
    }
    let names: Vec<String> = cells.iter().map(|cell| cell.join(":")).collect();
    let mut contrasts = Vec::new();
    for (first, a) in names.iter().enumerate() {
        for (second, b) in names.iter().enumerate() {
            if let Some(p) = by_name(&over.pairs, &format!("{a}|{b}")) {
                contrasts.push(Contrast { first, second, p });
            }
        }
    }
    let mut note = over.contrasts;
    if contrasts.len() > MOST_BRACKETS {
        contrasts.clear();
        note = TOO_MANY;
    }
    let cells = cells.iter().zip(&names).map(|(cell, name)| ComparedCell {
        name: cell.join(", "),
        mean: by_name(&over.means, name),
    });
    let panel = ComparisonPanel {
        outcome: outcome.to_owned(),
        test: over.test,
        cells: cells.collect(),
        rows: rows.people(&levels),
        contrasts,
    };
    Picture::Panel(panel, over.intervals, note)
}

/// The means of each effect by cell, each with the ends of its interval.
type MeansByEffect = Vec<(String, ByName<[f64; 3]>)>;

fn means_of<T>(emm: &Named<Named<T>>, numbers: impl Fn(&T) -> (f64, Interval)) -> MeansByEffect {
    let with_ends = |mean: &T| {
        let (mean, ci) = numbers(mean);
        Some([mean, ci.low?, ci.high?])
    };
    let effects = emm.iter();
    effects.map(|(effect, cells)| (effect.to_owned(), named(cells, with_ends))).collect()
}

/// Means of two factors with their intervals: a line a level of the first, along the levels of the second. None of fewer or more factors,
/// or of more lines than can be told apart.
fn two_factors(
    rows: &DesignRows,
    [outcome, axis]: [&str; 2],
    (emm, n): (&MeansByEffect, usize),
    test: &str,
) -> Option<Picture> {
    let (names, levels) = (rows.factors(), rows.levels());
    let ([first, second], [lines, along]) = (&names[..], &levels[..]) else {
        return None;
    };
    if lines.len() > MOST_LINES {
        return None;
    }
    let effect = format!("{first}:{second}");
    let (_, means) = emm.iter().find(|(known, _)| *known == effect)?;
    let mean = |line: &str, level: &str| by_name(means, &format!("{line}:{level}"));
    let line = |name: &&str| InteractionLine {
        name: (*name).to_owned(),
        means: along.iter().map(|level| mean(name, level)).collect(),
    };
    Some(Picture::Interaction(InteractionPanel {
        title: outcome.to_owned(),
        test: test.to_owned(),
        n,
        axis: axis.to_owned(),
        factor: (*second).to_owned(),
        levels: along.iter().map(|level| (*level).to_owned()).collect(),
        lines: lines.iter().map(line).collect(),
        range: None,
    }))
}

fn named<T, U>(entries: &Named<T>, number: impl Fn(&T) -> Option<U>) -> ByName<U> {
    entries.iter().map(|(name, entry)| (name.to_owned(), number(entry))).collect()
}

/// The effects' sentences, shortened to the highest.
fn highest(result: &impl Statements) -> String {
    let last = result.statements().into_iter().last();
    last.map_or_else(|| first(result), named_sentence)
}

pub(in crate::stages::stats) fn factorial(
    rows: &DesignRows,
    outcome: &str,
    result: &Factorial,
) -> Picture {
    let means = means_of(&result.emm, |m| (m.mean, m.ci));
    let pairs = only_factor(&result.contrast, |pair| pair.p_holm);
    let means = (&means, result.n);
    marginal_means(rows, outcome, means, highest(result), pairs)
}

/// The same by the tests that decide.
fn decided(
    rows: &DesignRows,
    outcome: &str,
    result: &FactorialFinding,
    after: &FollowUp,
) -> Picture {
    // The highest effect of factors; covariates come behind it.
    let highest = result.anova.anova.iter().last();
    let mut sentences = result.statements().into_iter();
    let test = highest.and_then(|(name, _)| sentences.find(|(n, _)| n == name));
    let test = test.map_or_else(|| first(result), named_sentence);
    let means = means_of(&after.emm, |m| (m.mean, m.ci));
    let pairs = only_factor(&after.contrast, |pair| pair.p_holm);
    let means = (&means, result.anova.n);
    marginal_means(rows, outcome, means, test, pairs)
}

/// Marginal means under a sentence: of two factors as lines along an axis of the means, of others over rainclouds with the pairs.
fn marginal_means(
    rows: &DesignRows,
    outcome: &str,
    (emm, n): (&MeansByEffect, usize),
    test: String,
    pairs: ByName<f64>,
) -> Picture {
    let suffix = at_covariates(&rows.covariates());
    let axis = format!("{outcome}{suffix}");
    if let Some(picture) = two_factors(rows, [outcome, &axis], (emm, n), &test) {
        return picture;
    }
    let over = Over {
        test,
        // Those of the cells of all factors: the effect that has the most of them.
        means: emm.last().map_or_else(Vec::new, |(_, cells)| cells.clone()),
        intervals: MARGINAL,
        pairs,
        contrasts: HOLM,
    };
    if suffix.is_empty() {
        return rainclouds(rows, outcome, over);
    }
    // The values below them are not.
    rainclouds(rows, &format!("{outcome}; dots are means{suffix}"), over)
}

pub(in crate::stages::stats) fn aligned(
    rows: &DesignRows,
    outcome: &str,
    result: &AlignedRanks,
) -> Picture {
    plain_cells(rows, outcome, highest(result))
}

/// The pairs of the levels of a single factor; those of several factors are no pairs of cells.
fn only_factor<T>(contrast: &Named<Named<T>>, p: impl Fn(&T) -> Option<f64>) -> ByName<f64> {
    let mut factors = contrast.values();
    match (factors.next(), factors.next()) {
        (Some(pairs), None) => named(pairs, p),
        _ => Vec::new(),
    }
}

/// Groups with the pairs of the test that was chosen; without one those after Games and Howell, or Welch.
pub(in crate::stages::stats) fn groups(
    rows: &DesignRows,
    outcome: &str,
    result: &GroupsAnalysis,
    chosen: Option<(ChosenTest, String)>,
) -> Picture {
    let ranked = matches!(chosen, Some((ChosenTest::MannWhitney | ChosenTest::KruskalWallis, _)));
    let (pairs, contrasts) = match (&result.several, ranked) {
        (None, false) => (named(&result.welch_t, |t| t.p), "*p* values after Welch"),
        (None, true) => (named(&result.mann_whitney, |u| u.p), "*p* values after Mann and Whitney"),
        (Some(several), false) => {
            (named(&several.games_howell, |t| t.p), "*p* values after Games and Howell")
        }
        (Some(several), true) => {
            (named(&several.dunn, |z| z.p_holm), "*p* values after Dunn and Holm")
        }
    };
    let over = Over {
        test: chosen.map_or_else(|| first(result), |(_, sentence)| sentence),
        means: named(&result.desc, |g| Some([g.mean, g.ci.low?, g.ci.high?])),
        intervals: "95% intervals of each group’s mean",
        pairs,
        contrasts,
    };
    rainclouds(rows, outcome, over)
}

/// Cells without a test of pairs, such as those of Bayes factors.
pub(in crate::stages::stats) fn plain_cells(
    rows: &DesignRows,
    outcome: &str,
    test: String,
) -> Picture {
    let over = Over { test, ..Over::default() };
    rainclouds(rows, outcome, over)
}

pub(in crate::stages::stats) fn mixed(
    rows: Option<&DesignRows>,
    outcome: &str,
    result: &RandomIntercept,
) -> Picture {
    let pairs = result.contrast.iter().last();
    fitted(rows, outcome, result, (result, pairs))
}

/// A model with the sentences of its terms, and the highest of them with its pairs, as they count.
fn fitted(
    rows: Option<&DesignRows>,
    outcome: &str,
    result: &RandomIntercept,
    (said, highest): (&impl Statements, Option<(&str, &Named<MarginalContrast>)>),
) -> Picture {
    let (Some(rows), Some((name, pairs))) = (rows, highest) else {
        let coefficients = result.coef.iter().skip(1);
        let coefficients = coefficients.map(|(name, c)| ForestRow {
            name: name.to_owned(),
            estimate: (|| Some([c.estimate, c.ci.low?, c.ci.high?]))(),
            said: p_text("*p*", c.p),
        });
        return Picture::Forest(Forest {
            title: format!("Coefficients of {outcome}"),
            axis: "Estimate (95% CI)".to_owned(),
            rows: coefficients.collect(),
            bounds: None,
            n: result.n_subjects,
        });
    };
    let statement = said.statements().into_iter().find(|(known, _)| known == name);
    let test = statement.map_or_else(String::new, |(_, statement)| statement.markup().to_owned());
    let means = means_of(&result.emm, |m| (m.mean, m.ci));
    let means = (&means, result.n_subjects);
    let pairs = named(pairs, |pair| pair.p_holm);
    marginal_means(rows, outcome, means, test, pairs)
}

/// Conditions with the coefficients against the first as brackets, under the sentence of their test.
pub(in crate::stages::stats) fn ordinal(
    rows: &DesignRows,
    outcome: &str,
    result: &Ordinal,
    test: String,
) -> Picture {
    let reference = result.conditions.first().map_or("", String::as_str);
    let coefficients = result.quadrature.coef.iter();
    let against_first = coefficients.map(|(name, c)| (format!("{reference}|{name}"), c.p));
    let over = Over {
        test,
        means: Vec::new(),
        intervals: "",
        pairs: against_first.collect(),
        contrasts: NOT_ADJUSTED,
    };
    rainclouds(rows, outcome, over)
}

/// Differences with their 90 % intervals and the bounds; in standard deviations where the bounds are.
pub(in crate::stages::stats) fn equivalence(outcome: &str, result: &Equivalence) -> Picture {
    let (low, high, standardized) = match result.bounds {
        Bounds::Raw { low, high } => (low, high, false),
        Bounds::Standardized { low, high } => (low, high, true),
    };
    let rows = result.tost.iter().map(|(name, t)| {
        let estimate = || {
            // The standard deviation of the differences is that of their mean times √n.
            let unit = if standardized { t.se? * (t.n as f64).sqrt() } else { 1.0 };
            let numbers = [t.estimate, t.ci90.low?, t.ci90.high?].map(|v| v / unit);
            Some(numbers).filter(|numbers| numbers.iter().all(|v| v.is_finite()))
        };
        ForestRow {
            name: name.to_owned(),
            estimate: estimate(),
            said: p_text(apa::p_symbol(result.adjusted()), t.p_holm),
        }
    });
    let axis = if standardized { "*d*_{z} (90% CI)" } else { "Difference (90% CI)" };
    Picture::Forest(Forest {
        title: format!("Equivalence of {outcome}"),
        axis: axis.to_owned(),
        rows: rows.collect(),
        bounds: Some((low, high)),
        n: result.n,
    })
}

/// What was chosen by the design, with what follows a factorial one; a comparison of one factor within is drawn by its caller.
pub(in crate::stages::stats) fn by_design(
    rows: &DesignRows,
    outcome: &str,
    result: &ByDesign,
    after: Option<&FollowUp>,
) -> Picture {
    match (result, after) {
        (ByDesign::Factorial(result), Some(after)) => decided(rows, outcome, &result.found, after),
        (ByDesign::Groups(inner), _) => {
            let chosen = Some((inner.chosen, first(result)));
            groups(rows, outcome, &inner.found, chosen)
        }
        (ByDesign::Mixed(result), _) => {
            let fit = &result.found;
            let term = fit.model.contrast.iter().last();
            let highest = term.and_then(|(term, _)| Some((term, fit.pairs(term)?)));
            fitted(Some(rows), outcome, &fit.model, (fit, highest))
        }
        (ByDesign::Ordinal(result), _) => {
            let test = first(&result.found);
            ordinal(rows, outcome, &result.found.model, test)
        }
        _ => plain_cells(rows, outcome, first(result)),
    }
}
