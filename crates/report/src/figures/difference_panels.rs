//! Every outcome, condition by condition: rainclouds.

use super::crowd::MOST_POINTS;
use super::prelude::*;
use super::rainclouds::{self, Panel, Slot};
use crate::apa;
use maveric_domain::ConditionId;
use maveric_stats::{mean, mean_interval, standard_deviation, within_subject_intervals};

/// The panels of the figure, in reading order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DifferencePanels {
    /// Any number of panels; three to a row.
    pub panels: Vec<DifferencePanel>,
    /// The drive that the values are differences from; none where some are not.
    pub from: Option<ConditionId>,
    /// Which of how many parts this is, counted from 1; none where all panels fit one printed page: see [`DifferencePanels::parts`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<(usize, usize)>,
}

/// Highest figure that a printed page holds above its caption, in millimetres.
const PAGE_MM: f64 = 240.0;

impl DifferencePanels {
    /// The same panels as figures that a printed page holds each, in order.
    #[must_use]
    pub fn parts(self) -> Vec<Self> {
        let (columns, height) = self.shape();
        let most = columns * (PAGE_MM / height) as usize;
        let count = self.panels.len().div_ceil(most);
        if count <= 1 {
            return vec![self];
        }
        // As many in each, in whole rows.
        let each = self.panels.len().div_ceil(count).next_multiple_of(columns);
        let pieces = self.panels.chunks(each).enumerate();
        let part = |(at, panels): (usize, &[DifferencePanel])| Self {
            panels: panels.to_vec(),
            from: self.from,
            part: Some((at + 1, count)),
        };
        pieces.map(part).collect()
    }

    /// Panels in a row, and the height of one in millimetres: a condition needs its room, so with more of them fewer panels stand in a row.
    fn shape(&self) -> (usize, f64) {
        let conditions = self.panels.iter().map(|panel| panel.conditions.len());
        match conditions.max().unwrap_or(0) {
            ..=4 => (3, 64.0),
            5..=6 => (2, 64.0),
            // Many names read upwards.
            _ => (1, 88.0),
        }
    }
}

/// One measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DifferencePanel {
    /// Such as `Mean velocity`.
    pub title: String,
    /// Title of the axis with the unit, such as `Difference from own drive (mph)`.
    pub axis: String,
    /// The conditions, in the order of the columns of `rows`.
    pub conditions: Vec<ConditionId>,
    /// One row a participant, one value a condition, in the axis's unit; `None` is missing.
    pub rows: Vec<Vec<Option<f64>>>,
    /// The omnibus test, with marks, as [`crate::apa`] writes it. Shown as the subtitle.
    pub omnibus: String,
    /// Post-hoc pairs to be shown as brackets.
    pub pairs: Vec<PairTest>,
    /// Value at which a line is drawn (0 for a difference, 4 for "as aggressive as I am").
    pub reference: Option<f64>,
    /// Lowest and highest value that there can be, where the scale has ends.
    pub range: Option<(f64, f64)>,
    /// Whether these are one group of people: its pairs are of one family with those of the other groups.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub of_group: bool,
}

/// A post-hoc comparison.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PairTest {
    /// One condition.
    pub first: ConditionId,
    /// The other.
    pub second: ConditionId,
    /// Its p value, adjusted after Holm.
    pub p_holm: f64,
    /// Its effect size, if there is one, of the condition that stands further right less the other.
    pub effect: Option<f64>,
}

impl PairTest {
    /// On its bracket: the effect size with the stars of the p; the p itself where there is none.
    fn label(&self) -> String {
        let stars = match self.p_holm {
            p if p < 0.001 => "\\*\\*\\*",
            p if p < 0.01 => "\\*\\*",
            p if p < 0.05 => "\\*",
            _ => "",
        };
        self.effect.map_or_else(
            || apa::p(self.p_holm).markup().to_owned(),
            |effect| format!("{}{stars}", apa::number(effect, 2)),
        )
    }
}

const NAME: &str = "difference-panels";

/// Draws the panels: half violin, box, points, each participant's line, mean with within-subject
/// interval, omnibus test in the subtitle, Holm brackets.
///
/// # Errors
/// [`ReportError`] if there is no panel, a value is not finite, or a row is of the wrong length.
///
/// # Source
/// The paper's figure of six panels; method, section 9.3.
pub fn difference_panels(
    input: &DifferencePanels,
    context: &Context,
) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "panels", input.panels.len())?;
    for panel in &input.panels {
        check.at_least(1, "conditions", panel.conditions.len())?;
        check.at_least(1, "participants", panel.rows.len())?;
        for row in &panel.rows {
            check.length("a participant's row", row.len(), panel.conditions.len())?;
        }
        check.finite(&panel.title, panel.rows.iter().flatten().flatten().copied())?;
        check.finite("a pair's p", panel.pairs.iter().map(|pair| pair.p_holm))?;
        check.at_least(1, "values", panel.rows.iter().flatten().flatten().count())?;
    }
    let (columns, height) = input.shape();
    let grid = Grid::limited(input.panels.len(), columns, (10.0, 11.0));
    let width = match columns {
        3 => grid.width_mm(),
        2 => TWO_COLUMNS_MM / 2.0 * grid.columns as f64,
        _ => TWO_COLUMNS_MM,
    };
    let heads = input.panels.iter();
    let heads = heads.map(|panel| [panel.title.as_str(), panel.omnibus.as_str()]);
    let height = height + rainclouds::further_mm(heads, grid, width);
    let what = match input.from {
        Some(from) => {
            format!("Difference between each condition and {}", context.look(from).words())
        }
        None => "The outcomes in each condition".to_owned(),
    };
    let (name, part) = of_part(NAME, input.part);
    let plan = Plan {
        name,
        size_mm: (width, height * grid.rows() + 3.0),
        title: format!("{what}{part}"),
        caption: caption(input, context, (grid, width)),
        alt: alternative(input, context),
        shows: Shows::Participants,
    };
    draw_panels(plan, context, grid, &[], |canvas, index, place| {
        rainclouds::paint(canvas, place, &drawn(&input.panels[index], context));
    })
}

/// Most brackets of a panel.
const MOST_BRACKETS: usize = 6;

/// The pairs that are drawn: all where they are few, else those with the smallest p.
fn bracketed(panel: &DifferencePanel) -> Vec<PairTest> {
    let mut pairs = panel.pairs.clone();
    pairs.sort_by(|a, b| a.p_holm.total_cmp(&b.p_holm));
    let last = pairs.get(MOST_BRACKETS).map(|pair| pair.p_holm);
    let kept = panel.pairs.iter().filter(|pair| last.is_none_or(|last| pair.p_holm < last));
    // Of equal p none is preferred.
    kept.copied().collect()
}

fn complete(panel: &DifferencePanel) -> Vec<Vec<f64>> {
    panel.rows.iter().filter_map(|row| row.iter().copied().collect()).collect()
}

/// Conditions in which nobody has a value.
fn empty(panel: &DifferencePanel) -> impl Iterator<Item = ConditionId> {
    let nobody = |index: usize| panel.rows.iter().all(|row| row[index].is_none());
    let conditions = panel.conditions.iter().enumerate();
    conditions.filter_map(move |(index, &condition)| nobody(index).then_some(condition))
}

/// Mean and within-subject interval of each condition, over who has a value in all, of one condition alone the mean with its own interval; none
/// below two people.
fn means(panel: &DifferencePanel) -> Vec<Option<[f64; 3]>> {
    let rows = complete(panel);
    if panel.conditions.len() == 1 {
        return vec![mean_interval(&rows.concat(), 0.95)];
    }
    let intervals = within_subject_intervals(&rows);
    let interval = |index: usize| intervals.as_ref().map(|intervals| intervals[index]);
    (0..panel.conditions.len()).map(interval).collect()
}

fn drawn<'a>(panel: &'a DifferencePanel, context: &Context) -> Panel<'a> {
    let means = means(panel).into_iter();
    let slots = panel.conditions.iter().zip(means).map(|(&condition, mean)| {
        let look = context.look(condition);
        Slot { name: look.words(), look: (look.marker, look.rgb()), mean }
    });
    let place = |wanted: ConditionId| panel.conditions.iter().position(|&c| c == wanted);
    let contrasts = bracketed(panel)
        .into_iter()
        .filter_map(|pair| Some((place(pair.first)?, place(pair.second)?, pair.label())));
    Panel {
        title: &panel.title,
        subtitle: &panel.omnibus,
        axis: &panel.axis,
        slots: slots.collect(),
        rows: &panel.rows,
        contrasts: contrasts.collect(),
        reference: panel.reference,
        range: panel.range,
    }
}

fn caption(input: &DifferencePanels, context: &Context, (grid, width): (Grid, f64)) -> String {
    let everybody = input.panels.iter().map(|panel| panel.rows.len()).max();
    let everybody = everybody.unwrap_or(0);
    let complete: Vec<usize> = input.panels.iter().map(|panel| complete(panel).len()).collect();
    let complete = counted(complete.into_iter(), " (by panel)");
    let alone = input.panels.iter().all(|panel| panel.conditions.len() == 1);
    let points = match (everybody > MOST_POINTS, alone) {
        (true, true) => "Points of single participants are left out, there being too many.",
        (true, false) => {
            "Points and lines of single participants are left out, there being too many."
        }
        (false, true) => "Each point is a participant.",
        (false, false) => {
            "Each point is a participant, each thin line one participant across the conditions."
        }
    };
    let what = match input.from {
        Some(from) => {
            format!("Difference from {}, where the axis says so", context.look(from).words())
        }
        None => "What was measured and answered".to_owned(),
    };
    let is_drawn = input.panels.iter().any(|panel| panel.reference.is_some());
    let line = if is_drawn { ", not with the dashed line" } else { "" };
    // In the figure of all panels, or in that of one.
    let widths = [width / grid.columns as f64, ONE_COLUMN_MM];
    let mut cut: Vec<String> = Vec::new();
    for panel in &input.panels {
        let looks = panel.conditions.iter().map(|c| context.look(*c).words());
        let names: Vec<String> = looks.collect();
        let places = widths.map(|mm| rainclouds::names(&names, mm / 25.4 * 72.0).cut());
        for name in places.into_iter().flatten().map(|at| &names[at]) {
            if !cut.contains(name) {
                cut.push(name.clone());
            }
        }
    }
    let shortened = match &cut[..] {
        [] => String::new(),
        cut => format!(" In full: {}.", cut.join(", ")),
    };
    let brackets = brackets(input);
    let nobody: Vec<String> = input
        .panels
        .iter()
        .flat_map(|panel| empty(panel).map(|c| (c, &panel.title)))
        .map(|(c, title)| format!(" Nobody has a value of {title} in {}.", context.look(c).words()))
        .collect();
    let nobody = nobody.concat();
    let drawn = "Half violins are kernel densities (to two bandwidths beyond the data, never beyond the scale), boxes quartiles with whiskers to \
                 1.5 times their distance";
    if alone {
        return format!(
            "{what}. {points} {drawn}, black dots means with 95% intervals, cut where the panel ends. *n* = {everybody} participants, of whom \
             {complete} have a value.{shortened}{nobody}"
        );
    }
    format!(
        "{what}. {points} {drawn}, black dots \
         means with within-subject 95% intervals (Cousineau–Morey), cut where the panel ends: these compare conditions with one another{line}. *n* = {everybody} participants, of \
         whom {complete} enter means, intervals and tests: those with a value in every condition and, where the period is tested, a known order. \
         The omnibus test stands below each title, of several factors that of their interaction. {brackets}{shortened}{nobody}"
    )
}

/// What stands on the brackets, and over what its p is adjusted.
fn brackets(input: &DifferencePanels) -> String {
    let panels = || input.panels.iter().filter(|p| !p.pairs.is_empty());
    if panels().next().is_none() {
        return "Contrasts stand in their table.".to_owned();
    }
    let which = if panels().all(|p| p.pairs.len() <= MOST_BRACKETS) {
        String::new()
    } else {
        format!(
            " (at most {MOST_BRACKETS} a panel, those with the smallest *p*; the table has all)"
        )
    };
    let groups = panels().filter(|p| p.of_group).count();
    let family = match groups {
        0 => "over the contrasts of that panel",
        all if all == panels().count() => {
            "over the contrasts of all groups of people for the outcome"
        }
        _ => {
            "over the contrasts of that panel, in a panel of one group of people over those of all groups for the outcome"
        }
    };
    let mut sized = panels().flat_map(bracketed).map(|pair| pair.effect.is_some());
    let has_size = sized.clone().any(|sized| sized);
    if !has_size {
        return format!("Brackets{which} carry *p* after Holm {family}.");
    }
    let bare =
        if sized.all(|sized| sized) { "" } else { "; *p* itself where there is no effect size" };
    format!(
        "Brackets{which} carry effect sizes, the condition on the right less that on the left (*d*_{{z}}, or the rank-biserial *r* where ranks were \
         compared) with the stars of *p* after Holm {family} (\\* .05, \\*\\* .01, \\*\\*\\* .001){bare}."
    )
}

fn alternative(input: &DifferencePanels, context: &Context) -> String {
    sentences(input.panels.iter().map(|panel| {
        let rows = complete(panel);
        let values = |index: usize| rows.iter().map(|row| row[index]).collect::<Vec<f64>>();
        let spreads = (0..panel.conditions.len()).filter_map(|c| standard_deviation(&values(c)));
        let decimals = apa::decimals_among(spreads);
        let means = panel.conditions.iter().enumerate().filter_map(|(index, condition)| {
            let mean = number(mean(&values(index))?, decimals);
            Some(format!("{} {mean}", context.look(*condition).label))
        });
        let means: Vec<String> = means.collect();
        format!("{}: means {}.", panel.title, means.join(", "))
    }))
}

#[cfg(test)]
mod tests;
