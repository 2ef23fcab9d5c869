//! Cells of any design, each with its mean as the test has it.

use super::{
    Picture,
    cells::{HOLM, relation},
    first,
};
use crate::stages::stats::rows::DesignRows;
use maveric_report::figures::{
    comparison::{ComparedCell, ComparisonPanel, Contrast},
    forest::{Forest, ForestRow},
    interaction::{InteractionLine, InteractionPanel},
};
use maveric_stats::{
    AlignedRanks, Bounds, ByDesign, ChosenTest, Equivalence, Factorial, GroupsAnalysis,
    MarginalMean, Named, Ordinal, RandomIntercept, RankCheck,
    apa::{Statement, Statements},
};

const MARGINAL: &str = "95% intervals of the marginal means";
/// More pairs than this would make a picture of brackets.
const MOST_BRACKETS: usize = 12;
/// More lines than this cannot be told apart.
const MOST_LINES: usize = 12;
const TOO_MANY: &str = "pairs stand in the tables: they are too many to draw";
const NOT_ADJUSTED: &str = "*p* values, not adjusted";

/// A number by the name of its cell (its levels joined with `:`), or of its pair of cells (`A|B`).
type Of<T> = Vec<(String, Option<T>)>;

/// What is said over the cells.
#[derive(Default)]
struct Over {
    test: String,
    /// Each cell's mean and the ends of its interval; none where the test has no means.
    means: Of<[f64; 3]>,
    intervals: &'static str,
    /// p of each pair that is drawn.
    pairs: Of<f64>,
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
    let known = |of: &Of<f64>, name: &str| of.iter().find(|(n, _)| n == name).and_then(|(_, p)| *p);
    let mut contrasts = Vec::new();
    for (first, a) in names.iter().enumerate() {
        for (second, b) in names.iter().enumerate() {
            if let Some(p) = known(&over.pairs, &format!("{a}|{b}")) {
                contrasts.push(Contrast { first, second, p });
            }
        }
    }
    let mut said = over.contrasts;
    if contrasts.len() > MOST_BRACKETS {
        contrasts.clear();
        said = TOO_MANY;
    }
    let cells = cells.iter().zip(&names).map(|(cell, name)| ComparedCell {
        name: cell.join(", "),
        mean: over
            .means
            .iter()
            .find(|(known, _)| known == name)
            .and_then(|(_, mean)| *mean),
    });
    let panel = ComparisonPanel {
        outcome: outcome.to_owned(),
        test: over.test,
        cells: cells.collect(),
        rows: rows.people(&levels),
        contrasts,
    };
    Picture::Panel(panel, over.intervals, said)
}

fn with_ends(m: &MarginalMean) -> Option<[f64; 3]> {
    Some([m.mean, m.ci_low?, m.ci_high?])
}

/// The means of the cells of all factors: those of the effect that has the most of them.
fn of_all(emm: &Named<Named<MarginalMean>>) -> Of<[f64; 3]> {
    let cells = emm.values().last().into_iter().flat_map(Named::iter);
    cells
        .map(|(cell, mean)| (cell.to_owned(), with_ends(mean)))
        .collect()
}

/// Means of two factors with their intervals: a line a level of the first, along the levels of the second. None of fewer or more factors,
/// or of more lines than can be told apart.
fn two_factors(
    rows: &DesignRows,
    outcome: &str,
    (emm, n): (&Named<Named<MarginalMean>>, usize),
    test: &str,
) -> Option<Picture> {
    let (names, levels) = (rows.factors(), rows.levels());
    let ([first, second], [lines, along]) = (&names[..], &levels[..]) else {
        return None;
    };
    if lines.len() > MOST_LINES {
        return None;
    }
    let means = emm.get(&format!("{first}:{second}"))?;
    let mean = |line: &str, level: &str| with_ends(means.get(&format!("{line}:{level}"))?);
    let line = |name: &&str| InteractionLine {
        name: (*name).to_owned(),
        means: along.iter().map(|level| mean(name, level)).collect(),
    };
    Some(Picture::Interaction(InteractionPanel {
        title: outcome.to_owned(),
        test: test.to_owned(),
        n,
        axis: outcome.to_owned(),
        factor: (*second).to_owned(),
        levels: along.iter().map(|level| (*level).to_owned()).collect(),
        lines: lines.iter().map(line).collect(),
        range: None,
    }))
}

fn named<T, U>(all: &Named<T>, of: impl Fn(&T) -> Option<U>) -> Of<U> {
    all.iter()
        .map(|(name, one)| (name.to_owned(), of(one)))
        .collect()
}

/// The effects' sentences, shortened to the highest.
fn highest(found: &impl Statements) -> String {
    let last = found.statements().into_iter().last();
    last.map_or_else(|| first(found), of_effect)
}

fn of_effect((name, sentence): (String, Statement)) -> String {
    format!(
        "{}: {}",
        maveric_report::markup::literal(&name),
        sentence.markup()
    )
}

pub(in crate::stages::stats) fn factorial(
    rows: &DesignRows,
    outcome: &str,
    found: &Factorial,
) -> Picture {
    factorial_under(rows, outcome, found, highest(found))
}

/// The same under the sentence of another test.
fn factorial_under(rows: &DesignRows, outcome: &str, found: &Factorial, test: String) -> Picture {
    if let Some(picture) = two_factors(rows, outcome, (&found.emm, found.n), &test) {
        return picture;
    }
    let over = Over {
        test,
        means: of_all(&found.emm),
        intervals: MARGINAL,
        pairs: brackets(found),
        contrasts: HOLM,
    };
    rainclouds(rows, outcome, over)
}

pub(in crate::stages::stats) fn aligned(
    rows: &DesignRows,
    outcome: &str,
    found: &AlignedRanks,
) -> Picture {
    let test = highest(found);
    rainclouds(
        rows,
        outcome,
        Over {
            test,
            ..Over::default()
        },
    )
}

/// Pairs of one factor, or of the second of two at each level of the first; none where there are more.
fn brackets(found: &Factorial) -> Of<f64> {
    let factors: Vec<(&str, &Vec<String>)> = found.levels.iter().collect();
    match factors[..] {
        [_] => {
            let pairs = found.contrast.values().flat_map(Named::iter);
            pairs
                .map(|(name, pair)| (name.to_owned(), pair.p_holm))
                .collect()
        }
        [(_, slow), (fast, levels)] => {
            let mut pairs = Vec::new();
            for level in slow {
                let simple = found.simple.values().next();
                let Some(test) = simple.and_then(|all| all.get(&format!("{fast}@{level}"))) else {
                    continue;
                };
                for a in levels {
                    for b in levels {
                        let p = test
                            .pairs
                            .get(&format!("{a}|{b}"))
                            .and_then(|pair| pair.p_holm);
                        pairs.push((format!("{level}:{a}|{level}:{b}"), p));
                    }
                }
            }
            pairs
        }
        _ => Vec::new(),
    }
}

/// Groups with the pairs of the test that was chosen; without one those after Games and Howell, or Welch.
pub(in crate::stages::stats) fn groups(
    rows: &DesignRows,
    outcome: &str,
    found: &GroupsAnalysis,
    chosen: Option<(ChosenTest, String)>,
) -> Picture {
    let ranked = matches!(
        chosen,
        Some((ChosenTest::MannWhitney | ChosenTest::KruskalWallis, _))
    );
    let (pairs, contrasts) = match (&found.several, ranked) {
        (None, false) => (named(&found.welch_t, |t| t.p), "*p* values after Welch"),
        (None, true) => (
            named(&found.mann_whitney, |u| u.p),
            "*p* values after Mann and Whitney",
        ),
        (Some(all), false) => (
            named(&all.games_howell, |t| t.p),
            "*p* values after Games and Howell",
        ),
        (Some(all), true) => (
            named(&all.dunn, |z| z.p_holm),
            "*p* values after Dunn and Holm",
        ),
    };
    let over = Over {
        test: chosen.map_or_else(|| first(found), |(_, said)| said),
        means: named(&found.desc, |g| Some([g.mean, g.ci_low?, g.ci_high?])),
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
    rainclouds(
        rows,
        outcome,
        Over {
            test,
            ..Over::default()
        },
    )
}

pub(in crate::stages::stats) fn mixed(
    rows: Option<&DesignRows>,
    outcome: &str,
    found: &RandomIntercept,
) -> Picture {
    let term = found.contrast.iter().last();
    let (Some(rows), Some((name, pairs))) = (rows, term) else {
        let coefficients = found.coef.iter().skip(1);
        let coefficients = coefficients.map(|(name, c)| ForestRow {
            name: name.to_owned(),
            estimate: (|| Some([c.estimate, c.ci_low?, c.ci_high?]))(),
            said: c
                .p
                .map_or_else(|| "–".to_owned(), |p| format!("*p* {}", relation(p))),
        });
        return Picture::Forest(Forest {
            title: format!("Coefficients of {outcome}"),
            axis: "Estimate (95% CI)".to_owned(),
            rows: coefficients.collect(),
            bounds: None,
            n: found.n_subjects,
        });
    };
    let said = found
        .statements()
        .into_iter()
        .find(|(known, _)| known == name);
    let test = said.map_or_else(String::new, |(_, said)| said.markup().to_owned());
    if let Some(picture) = two_factors(rows, outcome, (&found.emm, found.n_subjects), &test) {
        return picture;
    }
    let over = Over {
        test,
        means: of_all(&found.emm),
        intervals: MARGINAL,
        pairs: named(pairs, |pair| pair.p_holm),
        contrasts: HOLM,
    };
    rainclouds(rows, outcome, over)
}

/// Conditions with the coefficients against the first as brackets, or Wilcoxon's pairs where they were tested.
pub(in crate::stages::stats) fn ordinal(
    rows: &DesignRows,
    outcome: &str,
    found: &Ordinal,
    beside: Option<&RankCheck>,
) -> Picture {
    let reference = found.conditions.first().map_or("", String::as_str);
    let (pairs, contrasts) = if let Some(ranks) = beside {
        (
            named(&ranks.wilcoxon, |w| w.p_holm),
            "*p* values of Wilcoxon’s test after Holm",
        )
    } else {
        let coefficients = found.quadrature.coef.iter();
        let against_first = coefficients.map(|(name, c)| (format!("{reference}|{name}"), c.p));
        (against_first.collect(), NOT_ADJUSTED)
    };
    let over = Over {
        test: first(found),
        means: Vec::new(),
        intervals: "",
        pairs,
        contrasts,
    };
    rainclouds(rows, outcome, over)
}

/// Differences with their 90 % intervals and the bounds; in standard deviations where the bounds are.
pub(in crate::stages::stats) fn equivalence(outcome: &str, found: &Equivalence) -> Picture {
    let (low, high, standardized) = match found.bounds {
        Bounds::Raw { low, high } => (low, high, false),
        Bounds::Standardized { low, high } => (low, high, true),
    };
    let rows = found.tost.iter().map(|(name, t)| {
        let estimate = || {
            let unit = if standardized {
                t.dz? / t.estimate
            } else {
                1.0
            };
            let all = [t.estimate, t.ci90_low?, t.ci90_high?].map(|v| v * unit);
            Some(all).filter(|all| all.iter().all(|v| v.is_finite()))
        };
        ForestRow {
            name: name.to_owned(),
            estimate: estimate(),
            said: t
                .p
                .map_or_else(|| "–".to_owned(), |p| format!("*p* {}", relation(p))),
        }
    });
    let axis = if standardized {
        "*d*_{z} (90% CI)"
    } else {
        "Difference (90% CI)"
    };
    Picture::Forest(Forest {
        title: format!("Equivalence of {outcome}"),
        axis: axis.to_owned(),
        rows: rows.collect(),
        bounds: Some((low, high)),
        n: found.n,
    })
}

/// What was chosen by the design; a comparison of one factor within is drawn by its caller.
pub(in crate::stages::stats) fn by_design(
    rows: &DesignRows,
    outcome: &str,
    found: &ByDesign,
) -> Picture {
    match found {
        ByDesign::Factorial(found) => {
            // The highest effect of factors; covariates come behind it.
            let highest = found.found.anova.anova.iter().last();
            let mut sentences = found.found.statements().into_iter();
            let test = highest.and_then(|(name, _)| sentences.find(|(n, _)| n == name));
            let test = test.map_or_else(|| first(&found.found), of_effect);
            factorial_under(rows, outcome, &found.found.anova, test)
        }
        ByDesign::Groups(inner) => {
            let chosen = Some((inner.chosen, first(found)));
            groups(rows, outcome, &inner.found, chosen)
        }
        ByDesign::Mixed(found) => mixed(Some(rows), outcome, &found.found.model),
        ByDesign::Ordinal(found) => ordinal(
            rows,
            outcome,
            &found.found.model,
            found.found.beside.as_ref(),
        ),
        _ => plain_cells(rows, outcome, first(found)),
    }
}
