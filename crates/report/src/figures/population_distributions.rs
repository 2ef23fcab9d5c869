//! Whether the people we made up spread as real ones do: generated, published and recorded, side by side.

use super::axes::{Frame, Labels, Scale};
use super::canvas::{Canvas, Key, Pen};
use super::check::Check;
use super::theme::{INK, MUTED, Marker, OCHRE, PURPLE, TWO_COLUMNS_MM, stroke};
use super::{Context, Figure, Plan, Shows, draw};
use crate::apa::number;
use crate::error::ReportError;
use crate::markup;
use plotters::style::RGBColor;
use serde::{Deserialize, Serialize};

/// Several quantities, each of several groups of drivers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PopulationDistributions {
    /// One panel a quantity; two to a row.
    pub panels: Vec<DistributionPanel>,
}

/// One quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DistributionPanel {
    /// Such as `Time gap when following`.
    pub title: String,
    /// Title of the axis with the unit: `Time gap (s)`.
    pub axis: String,
    /// The groups, from top to bottom.
    pub groups: Vec<DistributionGroup>,
}

/// One group's distribution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DistributionGroup {
    /// Such as `OpenACC` or `Treiber and Kesting (2013)`. Plain text.
    pub name: String,
    /// Where the numbers come from.
    pub origin: Origin,
    /// Share below and value, both ascending: pairs symmetric about one half are drawn as intervals, 0.5 as a point.
    pub quantiles: Vec<(f64, f64)>,
    /// Drivers, where known.
    pub n: Option<usize>,
}

/// Where a distribution comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Origin {
    /// Made up here.
    Generated,
    /// Printed in a publication.
    Published,
    /// Computed from recordings of real people.
    Recorded,
}

impl Origin {
    fn look(self) -> (Marker, RGBColor, &'static str) {
        match self {
            Self::Generated => (Marker::Square, PURPLE, "generated"),
            Self::Published => (Marker::Diamond, OCHRE, "published"),
            Self::Recorded => (Marker::Circle, INK, "recorded"),
        }
    }
}

const NAME: &str = "population-distributions";
const ROW: f64 = 13.0;
const FRAME: f64 = 44.0;
const MOST_GROUPS: usize = 24;

/// Draws, quantity by quantity, each group's intervals between symmetric quantiles and its median.
///
/// # Errors
/// [`ReportError`] if there is no panel, a panel has no group or more than 24, a group has no quantile, shares are not
/// within 0..=1 or do not ascend, or a value is not finite.
///
/// # Source
/// Ours: the ranges that a made-up population is held against.
pub fn population_distributions(
    input: &PopulationDistributions,
    context: &Context,
) -> Result<Figure, ReportError> {
    check(input)?;
    let groups = || input.panels.iter().flat_map(|panel| &panel.groups);
    let shares = shares(groups());
    let found = input.panels.iter().map(|panel| {
        let groups: Vec<String> = panel.groups.iter().map(in_words).collect();
        format!("{}: {}.", panel.title, groups.join("; "))
    });
    let columns = input.panels.len().min(2);
    let rows = input.panels.len().div_ceil(columns);
    let most = |row: usize| {
        let panels = input.panels.iter().skip(row * columns).take(columns);
        panels.map(|panel| panel.groups.len()).max().unwrap_or(1)
    };
    let heights: Vec<f64> = (0..rows)
        .map(|row| FRAME + ROW * most(row) as f64)
        .collect();
    let height = (heights.iter().sum::<f64>() + 34.0) / 72.0 * 25.4;
    let origins: Vec<Origin> = [Origin::Generated, Origin::Published, Origin::Recorded]
        .into_iter()
        .filter(|origin| groups().any(|group| group.origin == *origin))
        .collect();
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (
            if columns == 1 { 110.0 } else { TWO_COLUMNS_MM },
            (height * 10.0).round() / 10.0,
        ),
        title: "Made-up drivers beside real ones".to_owned(),
        caption: format!(
            "Distributions over drivers. Lines reach between the quantiles {shares}, the thicker the nearer to the \
             middle; points are medians. A group without an inner interval or a median has none published. \
             *n* = the number in brackets after each group’s name (–: not published); no test."
        ),
        alt: found.collect::<Vec<_>>().join(" "),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, whole| {
        let keys: Vec<(Key, &str)> = origins
            .iter()
            .map(|origin| {
                let (marker, colour, name) = origin.look();
                (Key::Point(marker, colour), name)
            })
            .collect();
        let whole = canvas.legend(whole, &keys);
        let mut top = whole.top + 2.0;
        for (row, height) in heights.iter().enumerate() {
            let panels = input.panels.iter().skip(row * columns).take(columns);
            for (column, panel) in panels.enumerate() {
                let mut place = whole.cell((column, 0), (columns, 1), (14.0, 0.0));
                place.top = top;
                // A panel with fewer groups than its neighbour keeps the rows as high.
                place.bottom = top + FRAME + ROW * panel.groups.len() as f64 - 6.0;
                paint(canvas, place, panel);
            }
            top += height;
        }
    })
}

fn paint(canvas: &mut Canvas<'_>, place: super::axes::Place, panel: &DistributionPanel) {
    let last = panel.groups.len() as f64 - 1.0;
    let names = panel.groups.iter().enumerate().map(|(row, group)| {
        let n = group.n.map_or_else(|| "–".to_owned(), |n| n.to_string());
        (
            last - row as f64,
            format!("{} ({n})", markup::literal(&group.name)),
        )
    });
    let labels = Labels {
        title: &panel.title,
        x: &panel.axis,
        ..Labels::default()
    };
    let values = panel
        .groups
        .iter()
        .flat_map(|group| group.quantiles.iter().map(|q| q.1));
    let y = Scale::labelled(-0.7, last + 0.6, names.collect());
    let frame = Frame::draw(canvas, place, &labels, Scale::over(values, 5), y);
    for (row, group) in panel.groups.iter().enumerate() {
        let y = last - row as f64;
        let (marker, colour, _) = group.origin.look();
        for (depth, (low, high)) in intervals(group).into_iter().enumerate() {
            let width = stroke::BOX + 1.5 * depth as f64;
            canvas.line(frame.at(low, y), frame.at(high, y), Pen::new(colour, width));
        }
        for &(share, value) in &group.quantiles {
            if (share - 0.5).abs() < 1e-9 {
                canvas.marker(frame.at(value, y), 2.4, marker, colour);
            } else if partner(group, share).is_none() {
                let (x, y) = frame.at(value, y);
                canvas.line((x, y - 3.0), (x, y + 3.0), Pen::new(MUTED, stroke::BOX));
            }
        }
    }
}

/// The value at one minus a share.
fn partner(group: &DistributionGroup, share: f64) -> Option<f64> {
    let there = |q: &&(f64, f64)| (q.0 - (1.0 - share)).abs() < 1e-9;
    group.quantiles.iter().find(there).map(|q| q.1)
}

/// Symmetric pairs, the widest first.
fn intervals(group: &DistributionGroup) -> Vec<(f64, f64)> {
    let lower = group.quantiles.iter().filter(|q| q.0 < 0.5 - 1e-9);
    lower
        .filter_map(|&(share, low)| Some((low, partner(group, share)?)))
        .collect()
}

fn shares<'a>(groups: impl Iterator<Item = &'a DistributionGroup>) -> String {
    let mut found: Vec<f64> = groups
        .flat_map(|group| group.quantiles.iter().map(|q| q.0))
        .collect();
    found.retain(|share| *share < 0.5 - 1e-9);
    found.sort_by(f64::total_cmp);
    found.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    let percent = |share: f64| number(100.0 * share, 0);
    let written = found
        .iter()
        .map(|share| format!("{}–{}%", percent(*share), percent(1.0 - share)));
    written.collect::<Vec<_>>().join(", ")
}

fn in_words(group: &DistributionGroup) -> String {
    let at = |share: f64| group.quantiles.iter().find(|q| (q.0 - share).abs() < 1e-9);
    let middle = at(0.5).map_or_else(String::new, |q| format!(" median {}", number(q.1, 2)));
    let widest = intervals(group)
        .first()
        .map_or_else(String::new, |(low, high)| {
            format!(" from {} to {}", number(*low, 2), number(*high, 2))
        });
    format!("{} ({}){middle}{widest}", group.name, group.origin.look().2)
}

fn check(input: &PopulationDistributions) -> Result<(), ReportError> {
    let check = Check(NAME);
    check.at_least(1, "panels", input.panels.len())?;
    for panel in &input.panels {
        let count = panel.groups.len();
        check.at_least(1, "groups", count)?;
        check.that(
            count <= MOST_GROUPS,
            "groups",
            count as f64,
            "1 to 24 groups: choose some",
        )?;
        for group in &panel.groups {
            check.at_least(1, "quantiles", group.quantiles.len())?;
            check.finite(&group.name, group.quantiles.iter().map(|q| q.1))?;
            for (share, _) in &group.quantiles {
                check.that((0.0..=1.0).contains(share), "share", *share, "0 to 1")?;
            }
            for pair in group.quantiles.windows(2) {
                let ascend = pair[0].0 < pair[1].0 && pair[0].1 <= pair[1].1;
                check.that(
                    ascend,
                    &group.name,
                    pair[1].1,
                    "ascending shares and values",
                )?;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_symmetric_quantiles_make_an_interval() {
        let group = DistributionGroup {
            name: "x".into(),
            origin: Origin::Published,
            quantiles: vec![(0.1, 1.0), (0.25, 2.0), (0.5, 3.0), (0.75, 4.0)],
            n: None,
        };
        let found = intervals(&group);
        assert_eq!(found.len(), 1);
        assert!((found[0].0 - 2.0).abs() < 1e-12 && (found[0].1 - 4.0).abs() < 1e-12);
    }

    #[test]
    fn quantiles_out_of_order_are_refused() {
        let group = DistributionGroup {
            name: "x".into(),
            origin: Origin::Recorded,
            quantiles: vec![(0.1, 1.0), (0.9, 0.5)],
            n: Some(3),
        };
        let panel = DistributionPanel {
            title: "Speed".into(),
            axis: "m/s".into(),
            groups: vec![group],
        };
        let input = PopulationDistributions {
            panels: vec![panel],
        };
        assert!(population_distributions(&input, &Context::real()).is_err());
    }
}
