//! The figure of a result: rainclouds with contrasts, a scatter, or a forest.

use crate::{atomic_write::atomic_write_bytes, error::StudyError};
use maveric_report::{
    Context, Figure,
    figures::{
        comparison::{ComparedCell, Comparison, ComparisonPanel, Contrast, comparison},
        forest::{Forest, ForestRow, forest},
        scatter::{Scatter, scatter},
    },
    markup,
};
use maveric_stats::{
    ConditionSummary, Factorial, Named, Posthoc, WithinSubjects, apa, mean_interval,
};
use std::path::Path;

/// What is drawn of one result.
#[derive(Debug)]
pub(super) enum Picture {
    /// Groups, conditions or cells; the sentences say what intervals and brackets are.
    Panel(ComparisonPanel, &'static str, &'static str),
    /// Two columns.
    Scatter(Scatter),
    /// Contrasts or coefficients.
    Forest(Forest),
}

/// Above this many contrasts a forest is clearer than brackets.
const MOST_BRACKETS: usize = 6;
pub(super) const WITHIN_INTERVALS: &str = "within-subject 95% intervals (Cousineau–Morey)";
pub(super) const HOLM: &str = "*p* values after Holm";

/// Conditions of the same people; `p` are those of the pairs in their order, if any.
pub(super) fn conditions(
    data: &WithinSubjects,
    outcome: &str,
    test: String,
    desc: &Named<ConditionSummary>,
    p: impl Iterator<Item = Option<f64>>,
) -> Picture {
    let cells = desc.iter().map(|(name, c)| ComparedCell {
        name: name.to_owned(),
        mean: (|| Some([c.mean, c.within_ci_low?, c.within_ci_high?]))(),
    });
    let k = data.k();
    let pairs = (0..k).flat_map(|a| (a + 1..k).map(move |b| (a, b)));
    let contrasts = pairs.zip(p).filter_map(|((first, second), p)| {
        Some(Contrast {
            first,
            second,
            p: p?,
        })
    });
    let panel = ComparisonPanel {
        outcome: outcome.to_owned(),
        test,
        cells: cells.collect(),
        rows: data
            .rows()
            .map(|row| row.iter().copied().map(Some).collect())
            .collect(),
        contrasts: contrasts.collect(),
    };
    Picture::Panel(panel, WITHIN_INTERVALS, HOLM)
}

/// Pairs: brackets over rainclouds while they are few, a forest of effect sizes beyond.
pub(super) fn pairs(
    data: &WithinSubjects,
    outcome: &str,
    desc: &Named<ConditionSummary>,
    found: &Posthoc,
) -> Picture {
    if found.pairs.len() <= MOST_BRACKETS {
        let p = found.pairs.values().map(|pair| pair.p_adjusted);
        return conditions(data, outcome, String::new(), desc, p);
    }
    let symbol = apa::p_symbol(found.adjust);
    let rows = found.pairs.iter().map(|(name, pair)| {
        let effect = &pair.effect;
        let said = |p: f64| format!("{symbol} {}", relation(p));
        ForestRow {
            name: name.to_owned(),
            estimate: (|| Some([effect.value?, effect.ci_low?, effect.ci_high?]))(),
            said: pair.p_adjusted.map_or_else(|| "–".to_owned(), said),
        }
    });
    let axis = match found.pairs.values().next().map(|pair| pair.effect.name) {
        Some(maveric_stats::EffectName::RankBiserial) => "*r*_{rb} (A minus B, 95% CI)",
        _ => "*d*_{z} (A minus B, 95% CI)",
    };
    Picture::Forest(Forest {
        title: format!("Differences of {outcome}"),
        axis: axis.to_owned(),
        rows: rows.collect(),
        bounds: None,
    })
}

/// `= .012`, `< .001`.
pub(super) fn relation(p: f64) -> String {
    let cell = apa::p_cell(p);
    if cell.starts_with('<') {
        cell
    } else {
        format!("= {cell}")
    }
}

/// Draws one result, or the panels of several outcomes, into an SVG or PNG file.
pub(super) fn write(path: &Path, pictures: Vec<Picture>) -> Result<(), StudyError> {
    let figure = draw(pictures)?;
    let bytes = if svg(path)? {
        figure.standalone_svg().into_bytes()
    } else {
        figure.png()?
    };
    atomic_write_bytes(path, &bytes)
}

/// Whether the file is to be SVG; else PNG.
pub(super) fn svg(path: &Path) -> Result<bool, StudyError> {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("svg") => Ok(true),
        Some("png") => Ok(false),
        _ => Err(StudyError::NotPossible {
            problem: format!("{}: a figure is written as .svg or .png", path.display()),
            help: None,
        }),
    }
}

fn draw(pictures: Vec<Picture>) -> Result<Figure, StudyError> {
    let context = Context::real();
    let (mut panels, mut forests, mut scatters) = (Vec::new(), Vec::new(), Vec::new());
    let mut said = ("", "");
    for picture in pictures {
        match picture {
            Picture::Panel(panel, intervals, contrasts) => {
                said = (intervals, contrasts);
                panels.push(panel);
            }
            Picture::Forest(found) => forests.push(found),
            Picture::Scatter(found) => scatters.push(found),
        }
    }
    if let Some(mut first) = forests.pop() {
        // Several outcomes under each other, each row with its own.
        while let Some(other) = forests.pop() {
            first.title = format!("{}; {}", other.title, first.title);
            first.rows.splice(0..0, other.rows);
        }
        return Ok(forest(&first, &context)?);
    }
    if let Some(found) = scatters.pop() {
        return Ok(scatter(&found, &context)?);
    }
    let input = Comparison {
        panels,
        intervals: said.0.to_owned(),
        contrasts: said.1.to_owned(),
    };
    Ok(comparison(&input, &context)?)
}

/// Pairs with both values.
fn complete(x: &[Option<f64>], y: &[Option<f64>]) -> Vec<(f64, f64)> {
    x.iter()
        .zip(y)
        .filter_map(|(x, y)| Some(((*x)?, (*y)?)))
        .collect()
}

/// A correlation: points, line, band.
pub(super) fn correlation(
    (x_name, x): (&str, &[Option<f64>]),
    (y_name, y): (&str, &[Option<f64>]),
    test: String,
) -> Picture {
    Picture::Scatter(Scatter {
        x: x_name.to_owned(),
        y: y_name.to_owned(),
        points: complete(x, y),
        test,
        people: Vec::new(),
    })
}

/// A correlation within people: parallel lines of the common slope.
pub(super) fn within_people(
    subjects: &[String],
    (x_name, x): (&str, &[Option<f64>]),
    (y_name, y): (&str, &[Option<f64>]),
    slope: Option<f64>,
    test: String,
) -> Picture {
    let mut people: Vec<(&str, Vec<(f64, f64)>)> = Vec::new();
    for (who, point) in subjects.iter().zip(x.iter().zip(y)) {
        let (Some(x), Some(y)) = point else { continue };
        match people.iter_mut().find(|(known, _)| known == who) {
            Some((_, points)) => points.push((*x, *y)),
            None => people.push((who, vec![(*x, *y)])),
        }
    }
    let line = |points: &Vec<(f64, f64)>| {
        let n = points.len() as f64;
        let (mx, my) = points
            .iter()
            .fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
        let ends = |f: fn(f64, f64) -> f64, start: f64| points.iter().map(|p| p.0).fold(start, f);
        let at = |x: f64| Some((x, my + slope? * (x - mx)));
        Some([
            at(ends(f64::min, f64::INFINITY))?,
            at(ends(f64::max, f64::NEG_INFINITY))?,
        ])
    };
    Picture::Scatter(Scatter {
        x: x_name.to_owned(),
        y: y_name.to_owned(),
        points: complete(x, y),
        test,
        people: people
            .iter()
            .filter_map(|(_, points)| line(points))
            .collect(),
    })
}

/// The first sentence of a result, for above a panel.
pub(super) fn first(found: &impl apa::Statements) -> String {
    let first = found.statements().into_iter().next();
    first.map_or_else(
        || markup::literal("no test has a value"),
        |(_, said)| said.markup().to_owned(),
    )
}

const CELL_INTERVALS: &str = "95% intervals of each cell's mean";

/// A factor, and its level in each row.
pub(super) type FactorColumn<'a> = (&'a str, Vec<Option<String>>);

/// Cells of any design: groups, conditions, or both; the last factor counts fastest.
pub(super) fn cells(
    subjects: &[String],
    factors: &[FactorColumn<'_>],
    values: &[Option<f64>],
    outcome: &str,
    test: String,
    contrasts: Vec<Contrast>,
) -> Picture {
    let levels: Vec<Vec<&str>> = factors
        .iter()
        .map(|(_, column)| {
            let mut seen: Vec<&str> = Vec::new();
            for level in column.iter().flatten() {
                if !seen.contains(&level.as_str()) {
                    seen.push(level);
                }
            }
            seen
        })
        .collect();
    let count: usize = levels.iter().map(Vec::len).product();
    let cell = |row: usize| {
        factors
            .iter()
            .zip(&levels)
            .try_fold(0, |at, ((_, column), levels)| {
                let level = column[row].as_deref()?;
                Some(at * levels.len() + levels.iter().position(|known| *known == level)?)
            })
    };
    let mut people: Vec<(&str, Vec<Option<f64>>)> = Vec::new();
    for (row, (who, value)) in subjects.iter().zip(values).enumerate() {
        let (Some(at), Some(value)) = (cell(row), value) else {
            continue;
        };
        match people
            .iter_mut()
            .find(|(known, own)| known == who && own[at].is_none())
        {
            Some((_, own)) => own[at] = Some(*value),
            None => {
                let mut own = vec![None; count];
                own[at] = Some(*value);
                people.push((who, own));
            }
        }
    }
    let rows: Vec<Vec<Option<f64>>> = people.into_iter().map(|(_, row)| row).collect();
    let name = |at: usize| {
        let mut rest = at;
        let mut words: Vec<&str> = Vec::new();
        for levels in levels.iter().rev() {
            words.push(levels[rest % levels.len()]);
            rest /= levels.len();
        }
        words.reverse();
        words.join(" ")
    };
    let cells = (0..count).map(|at| {
        let own: Vec<f64> = rows.iter().filter_map(|row| row[at]).collect();
        ComparedCell {
            name: name(at),
            mean: mean_interval(&own).map(|m| [m.mean, m.low, m.high]),
        }
    });
    let panel = ComparisonPanel {
        outcome: outcome.to_owned(),
        test,
        cells: cells.collect(),
        rows,
        contrasts,
    };
    Picture::Panel(panel, CELL_INTERVALS, HOLM)
}

/// Pairs of `k` cells in their order.
pub(super) fn in_order(k: usize, p: impl Iterator<Item = Option<f64>>) -> Vec<Contrast> {
    let pairs = (0..k).flat_map(|a| (a + 1..k).map(move |b| (a, b)));
    pairs
        .zip(p)
        .filter_map(|((first, second), p)| {
            Some(Contrast {
                first,
                second,
                p: p?,
            })
        })
        .collect()
}

/// Simple effects of the second of two factors, at each level of the first.
pub(super) fn simple(found: &Factorial) -> Vec<Contrast> {
    let factors: Vec<(&str, &Vec<String>)> = found.levels.iter().collect();
    let [(_, slow), (fast, levels)] = factors[..] else {
        return Vec::new();
    };
    let k = levels.len();
    let mut contrasts = Vec::new();
    for (_, all) in found.simple.iter() {
        for (at, level) in slow.iter().enumerate() {
            let Some(test) = all.get(&format!("{fast}@{level}")) else {
                continue;
            };
            let pairs = in_order(k, test.pairs.values().map(|pair| pair.p_holm));
            contrasts.extend(pairs.into_iter().map(|c| Contrast {
                first: at * k + c.first,
                second: at * k + c.second,
                p: c.p,
            }));
        }
    }
    contrasts
}

/// Coefficients or differences as a forest: name, estimate with its ends, p.
pub(super) fn estimates(
    title: String,
    axis: &str,
    rows: impl Iterator<Item = (String, Option<[f64; 3]>, Option<f64>)>,
    bounds: Option<(f64, f64)>,
) -> Picture {
    let rows = rows.map(|(name, estimate, p)| ForestRow {
        name,
        estimate,
        said: p.map_or_else(|| "–".to_owned(), |p| format!("*p* {}", relation(p))),
    });
    Picture::Forest(Forest {
        title,
        axis: axis.to_owned(),
        rows: rows.collect(),
        bounds,
    })
}
