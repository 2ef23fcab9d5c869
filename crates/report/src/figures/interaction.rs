//! Means of two crossed factors: the levels of one along the axis, a line a level of the other.

use super::names::shortened;
use super::prelude::*;
use super::theme::nth_look;
use crate::apa::decimals;

/// Panels of one or more outcomes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Interaction {
    /// The panels, in reading order.
    pub panels: Vec<InteractionPanel>,
    /// What the intervals are and whose the numbers, as sentences.
    pub intervals: String,
}

/// One outcome, or a level of a third factor of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InteractionPanel {
    /// Such as `Trust`. Plain text.
    pub title: String,
    /// The test of the interaction, with marks.
    pub test: String,
    /// People in it.
    pub n: usize,
    /// The outcome with its unit.
    pub axis: String,
    /// The factor along the axis.
    pub factor: String,
    /// Its levels, in order. Plain text.
    pub levels: Vec<String>,
    /// A line a level of the other factor; at most 12.
    pub lines: Vec<InteractionLine>,
    /// Lowest and highest value that there can be, where the scale has ends.
    pub range: Option<(f64, f64)>,
}

/// One level of the factor that has a line a level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InteractionLine {
    /// The level. Plain text.
    pub name: String,
    /// Mean and ends of its interval at each level along the axis; none where there is no mean.
    pub means: Vec<Option<[f64; 3]>>,
}

impl InteractionPanel {
    /// Means and ends of intervals as they are drawn: an interval may reach beyond the scale, its line ends there.
    fn drawn(&self) -> impl Iterator<Item = [f64; 3]> {
        let means = self.lines.iter().flat_map(|line| &line.means).flatten();
        means.map(|ends| ends.map(|end| self.within(end)))
    }

    fn within(&self, end: f64) -> f64 {
        self.range.map_or(end, |(low, high)| end.clamp(low, high))
    }
}

const NAME: &str = "interaction";
const MOST_LINES: usize = 12;

/// Draws the means with their intervals, lines beside each other rather than on each other, each with its name at its end.
///
/// # Errors
/// [`ReportError`] if there is no panel, line or mean, a number is not finite, or a line has another length than the levels.
pub fn interaction(input: &Interaction, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "panels", input.panels.len())?;
    for panel in &input.panels {
        check.at_least(1, "lines", panel.lines.len())?;
        check.at_most(MOST_LINES, "lines", panel.lines.len())?;
        for line in &panel.lines {
            check.length("a line", line.means.len(), panel.levels.len())?;
        }
        let means = || panel.lines.iter().flat_map(|line| &line.means).flatten();
        check.at_least(1, "means", means().count())?;
        check.finite(&panel.title, means().flatten().copied())?;
    }
    let most = input.panels.iter().map(|panel| panel.levels.len()).max();
    let columns = if most.unwrap_or(0) > 6 { 1 } else { 2 };
    let grid = Grid::limited(input.panels.len(), columns, (12.0, 11.0));
    let width = match grid.columns {
        1 if columns == 2 => ONE_COLUMN_MM,
        _ => TWO_COLUMNS_MM,
    };
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (width, 62.0 * grid.rows() + 3.0),
        title: "Means by factor".to_owned(),
        caption: caption(input),
        alt: sentences(input.panels.iter().map(told_of)),
        shows: Shows::Participants,
    };
    draw_panels(plan, context, grid, &[], |canvas, index, place| {
        let panel = &input.panels[index];
        let alike = input.panels.iter().filter(|other| other.axis == panel.axis);
        let ends = alike.flat_map(InteractionPanel::drawn).flatten();
        paint(canvas, place, panel, Scale::over(ends, 5));
    })
}

fn caption(input: &Interaction) -> String {
    let n = counted(input.panels.iter().map(|panel| panel.n), " (by panel)");
    let are_cut = input.panels.iter().any(|panel| {
        let means = panel.lines.iter().flat_map(|line| &line.means).flatten();
        let is_beyond =
            |end: &f64| panel.range.is_some_and(|(low, high)| !(low..=high).contains(end));
        means.flatten().any(is_beyond)
    });
    let cut = if are_cut { ", cut at the ends of the scale" } else { "" };
    format!(
        "Markers are means with 95% intervals{cut}, a line a level of one factor. {} *n* = {n}.",
        input.intervals
    )
}

fn told_of(panel: &InteractionPanel) -> String {
    let line = |line: &InteractionLine| {
        let means = panel.levels.iter().zip(&line.means);
        let means = means.filter_map(|(level, mean)| {
            let [mean, low, high] = (*mean)?;
            Some(format!("{level} {}", number(mean, decimals(high - low))))
        });
        format!("{}: {}", line.name, means.collect::<Vec<_>>().join(", "))
    };
    let lines: Vec<String> = panel.lines.iter().map(line).collect();
    let test = markup::plain(&panel.test);
    format!("{}, means. {}. {test}.", panel.title, lines.join("; "))
}

/// The names at the lines' ends get at most this share of the width.
const NAMES: f64 = 0.3;
/// How far the lines of a level stand apart, as a share of the room of a level.
const APART: f64 = 0.5;
/// Points between two names.
const STEP: f64 = 1.25 * size::TICK;

/// Panels of one axis share its scale `y`.
fn paint(canvas: &mut Canvas<'_>, place: Place, input: &InteractionPanel, y: Scale) {
    let look = Look::new(size::TICK);
    let room = NAMES * (place.right - place.left);
    let names: Vec<String> =
        input.lines.iter().map(|line| markup::literal(&shortened(&line.name, room))).collect();
    let widest = look.widest(&names);
    let k = input.levels.len();
    let levels = input.levels.iter().map(|level| markup::literal(level));
    let x = Scale::of_names(-0.5, k as f64 - 0.5, levels);
    let labels = Labels {
        title: &input.title,
        subtitle: &input.test,
        x: &input.factor,
        y: &input.axis,
        ..Labels::default()
    };
    let inner = Place { right: place.right - widest - 6.0, ..place };
    let mut panel = Panel::open(canvas, inner, &labels, (x, y));
    let lines = input.lines.len();
    let beside = |line: usize| {
        let step = if lines > 1 { APART / (lines - 1) as f64 } else { 0.0 };
        step.min(0.12) * (line as f64 - (lines - 1) as f64 / 2.0)
    };
    for (index, line) in input.lines.iter().enumerate() {
        let (marker, colour) = line_look(index);
        let points: Vec<[f64; 4]> = line
            .means
            .iter()
            .enumerate()
            .filter_map(|(at, mean)| {
                let [mean, low, high] = (*mean)?.map(|end| input.within(end));
                Some([at as f64 + beside(index), mean, low, high])
            })
            .collect();
        panel.curve(&points, (2.0, marker, colour));
    }
    // Names keep their order and their distance, as near to their line's end as that allows.
    let mut ends: Vec<(f64, usize)> = input
        .lines
        .iter()
        .enumerate()
        .filter_map(|(index, line)| {
            let last = line.means.iter().rev().flatten().next()?;
            Some((panel.frame.y.at(input.within(last[0])), index))
        })
        .collect();
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Place { right, bottom, .. } = panel.frame.place;
    for (y, index) in apart(&ends, bottom) {
        let (marker, colour) = line_look(index);
        panel.canvas.marker((right + 3.0, y), 2.0, marker, colour);
        panel.canvas.text(&names[index], (right + 6.5, y), look.centred());
    }
}

/// Heights at least a step apart, none below the foot.
fn apart(ends: &[(f64, usize)], foot: f64) -> Vec<(f64, usize)> {
    let mut placed: Vec<(f64, usize)> = Vec::new();
    for &(y, index) in ends {
        let above = placed.last().map_or(f64::NEG_INFINITY, |(y, _)| y + STEP);
        placed.push((y.max(above), index));
    }
    let mut below = foot;
    for (y, _) in placed.iter_mut().rev() {
        *y = y.min(below);
        below = *y - STEP;
    }
    placed
}

/// Colour and marker of a line: no two of the twelve share both.
fn line_look(index: usize) -> (Marker, RGBColor) {
    let (marker, colour) = nth_look(index);
    let further = [Marker::Star, Marker::Plus, Marker::Hexagon];
    match index / 5 {
        0 => (marker, colour),
        round => (further[(round - 1) % further.len()], colour),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input() -> Interaction {
        let line = |name: &str, means: [f64; 3]| InteractionLine {
            name: name.into(),
            means: means.map(|m| Some([m, m - 0.5, m + 0.5])).to_vec(),
        };
        Interaction {
            panels: vec![InteractionPanel {
                title: "Trust".into(),
                test: "*F*(2, 22) = 9.41".into(),
                n: 24,
                axis: "Rating, 1 to 7".into(),
                factor: "Traffic".into(),
                levels: ["free", "dense", "jam"].map(str::to_owned).to_vec(),
                lines: vec![line("calm", [3.0, 4.0, 6.8]), line("sporty", [5.0, 4.0, 6.7])],
                range: Some((1.0, 7.0)),
            }],
            intervals: "Within people.".into(),
        }
    }

    #[test]
    fn every_line_has_its_name_and_the_caption_what_the_intervals_are() {
        let figure = interaction(&input(), &Context::real()).unwrap();
        for text in [">calm<", ">sporty<", ">free<", ">Traffic<"] {
            assert!(figure.svg.contains(text), "{text}: {}", figure.svg);
        }
        assert!(figure.caption.contains("Within people."), "{}", figure.caption);
        assert!(figure.alt.contains("calm: free 3.00, dense 4.00, jam 6.80"), "{}", figure.alt);
    }

    #[test]
    fn an_interval_ends_where_its_scale_ends() {
        // 6.8 + 0.5 lies beyond 7: drawn as if it ended there, the picture is the same.
        let mut cut = input();
        for line in &mut cut.panels[0].lines {
            for mean in line.means.iter_mut().flatten() {
                mean[2] = mean[2].min(7.0);
            }
        }
        let [whole, cut] = [input(), cut].map(|i| interaction(&i, &Context::real()).unwrap());
        assert_eq!(whole.svg, cut.svg);
        let says = |figure: &Figure| figure.caption.contains("intervals, cut at the ends");
        assert!(says(&whole) && !says(&cut));
        let mut free = input();
        free.panels[0].range = None;
        let free = interaction(&free, &Context::real()).unwrap();
        assert!(free.svg != whole.svg && !says(&free));
    }

    #[test]
    fn means_in_words_have_as_many_decimals_as_their_intervals_need() {
        let mut small = input();
        let lines = small.panels[0].lines.iter_mut();
        for mean in lines.flat_map(|line| &mut line.means).flatten() {
            *mean = mean.map(|end| 0.002 * end);
        }
        let said = told_of(&small.panels[0]);
        assert!(said.contains("calm: free 0.0060, dense 0.0080"), "{said}");
    }

    #[test]
    fn panels_of_one_axis_share_their_scale() {
        let mut two = input();
        let mut higher = two.panels[0].clone();
        higher.range = None;
        for mean in higher.lines.iter_mut().flat_map(|line| &mut line.means).flatten() {
            *mean = mean.map(|end| end + 10.0);
        }
        two.panels.push(higher);
        let first = |figure: Figure| figure.panels[0].svg.clone();
        let shared = first(interaction(&two, &Context::real()).unwrap());
        assert!(shared.contains(">16<"), "{shared}");
        two.panels[1].axis = "Another".into();
        assert!(!first(interaction(&two, &Context::real()).unwrap()).contains(">16<"));
    }

    #[test]
    fn names_at_the_ends_never_touch_and_never_leave_the_panel() {
        let placed = apart(&[(10.0, 0), (10.0, 2), (11.0, 1), (99.0, 3), (99.5, 4)], 100.0);
        for pair in placed.windows(2) {
            assert!(pair[1].0 - pair[0].0 >= STEP - 1e-9, "{placed:?}");
        }
        assert!(placed.iter().all(|(y, _)| *y <= 100.0));
    }

    #[test]
    fn twelve_lines_stay_apart_and_a_thirteenth_is_refused() {
        let looks: Vec<_> = (0..12).map(line_look).collect();
        for (i, look) in looks.iter().enumerate() {
            assert!(!looks[..i].contains(look), "{i}");
        }
        let mut many = input();
        let line = many.panels[0].lines[0].clone();
        many.panels[0].lines = vec![line; 13];
        assert!(interaction(&many, &Context::real()).is_err());
    }

    #[test]
    fn a_mean_that_is_no_number_and_a_line_that_is_too_short_are_refused() {
        let mut wrong = input();
        wrong.panels[0].lines[0].means[1] = Some([f64::NAN; 3]);
        assert!(interaction(&wrong, &Context::real()).is_err());
        let mut short = input();
        short.panels[0].lines[0].means.pop();
        assert!(interaction(&short, &Context::real()).is_err());
    }
}
