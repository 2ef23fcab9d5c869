//! The flow of participants: how many there were at each step, and why the others were left out.

use super::names::wrapped;
use super::prelude::*;

/// Counts of people.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Flow {
    /// People who asked to take part and were not admitted: the rule that they did not fulfil, and count. Plain text.
    pub not_admitted: Vec<(String, usize)>,
    /// People who did not agree to the consent.
    pub not_agreed: usize,
    /// People who were to be tested.
    pub recruited: usize,
    /// Those of them who neither drove nor rated anything: reason and count. Plain text.
    pub absent: Vec<(String, usize)>,
    /// Those who drove or rated something.
    pub drove: usize,
    /// Those of them who are left out: reason and count. Plain text.
    pub left_out: Vec<(String, usize)>,
    /// People analysed.
    pub analysed: usize,
    /// Single drives left out: reason and count. Plain text.
    pub drives_left_out: Vec<(String, usize)>,
    /// People in the tests, by outcome. Plain text.
    pub outcomes: Vec<(String, usize)>,
}

const NAME: &str = "flow";
/// Height of a line of text, in points.
const LINE: f64 = 10.0;
/// Space inside and between boxes, in points.
const PAD: f64 = 5.0;
const GAP: f64 = 14.0;
/// Longest line, in letters.
const LETTERS: usize = 58;

/// Draws who was recruited, drove, was left out and why, and was analysed, from top to bottom.
///
/// # Errors
/// [`ReportError`] if those who leave the flow at a step are not as many as are missing at the next.
///
/// # Source
/// CONSORT 2010 (Schulz, Altman and Moher): the flow diagram.
pub fn flow(input: &Flow, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    let held_back = count(&input.not_admitted);
    let (absent, out) = (count(&input.absent), count(&input.left_out));
    for (field, left, gone, before) in [
        ("drove", input.drove, absent, input.recruited),
        ("analysed", input.analysed, out, input.drove),
    ] {
        check.that(
            left + gone == before,
            field,
            left as f64,
            &format!("{before} less the {gone} who left before"),
        )?;
    }
    let steps = steps(input);
    let height: f64 = steps.iter().map(Step::height).sum::<f64>() + GAP * steps.len() as f64;
    let width = if has_beside(&steps) { TWO_COLUMNS_MM } else { ONE_COLUMN_MM };
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: (width, (height + 12.0) * 25.4 / 72.0 + 4.0),
        title: "Flow of participants".to_owned(),
        caption: format!(
            "Who was recruited, took part, was left out and is analysed, as CONSORT draws it. By outcome: participants who enter its tests. \
             *n* = {}.",
            input.analysed
        ),
        alt: format!(
            "{}{}{} recruited, {}{} took part, {out} left out{}, {} analysed.",
            if_any(held_back, "not admitted", &input.not_admitted),
            if_any(input.not_agreed, "did not agree", &[]),
            input.recruited,
            if_any(absent, "neither drove nor rated anything", &input.absent),
            input.drove,
            reasons(&input.left_out),
            input.analysed
        ),
        shows: Shows::Participants,
    };
    draw(plan, context, |canvas, place| paint(canvas, place, &steps))
}

/// One box, with what leaves the flow beside it.
struct Step {
    lines: Vec<String>,
    beside: Vec<String>,
}

impl Step {
    fn height(&self) -> f64 {
        let lines = self.lines.len().max(self.beside.len());
        lines as f64 * LINE + 2.0 * PAD
    }
}

/// Whether anything leaves the flow.
fn has_beside(steps: &[Step]) -> bool {
    steps.iter().any(|step| !step.beside.is_empty())
}

fn count(left: &[(String, usize)]) -> usize {
    left.iter().map(|(_, n)| n).sum()
}

/// How many did or were what, with why; nothing of nobody.
fn if_any(n: usize, what: &str, left: &[(String, usize)]) -> String {
    match n {
        0 => String::new(),
        n => format!("{n} {what}{}, ", reasons(left)),
    }
}

fn reasons(left: &[(String, usize)]) -> String {
    let one = |(why, n): &(String, usize)| format!("{n}: {why}");
    let counts: Vec<String> = left.iter().map(one).collect();
    if counts.is_empty() { String::new() } else { format!(" ({})", counts.join("; ")) }
}

fn listed(title: &str, left: &[(String, usize)]) -> Vec<String> {
    if left.is_empty() {
        return Vec::new();
    }
    let mut lines = vec![format!("{title}: {}", count(left))];
    let fits = |line: &str| line.chars().count() <= LETTERS;
    for (why, n) in left {
        lines.extend(wrapped(&format!("{n}: {why}"), fits));
    }
    lines
}

fn steps(input: &Flow) -> Vec<Step> {
    let mut beside = listed("Left out", &input.left_out);
    beside.extend(listed("Single drives left out", &input.drives_left_out));
    let mut analysed = vec![format!("Analysed: {}", input.analysed)];
    let outcomes = input.outcomes.iter();
    analysed.extend(outcomes.map(|(title, n)| format!("{title}: {n}")));
    let not_recruited = count(&input.not_admitted) + input.not_agreed;
    let mut before = listed("Not admitted", &input.not_admitted);
    if input.not_agreed > 0 {
        before.push(format!("Did not agree: {}", input.not_agreed));
    }
    let invited = (not_recruited > 0).then(|| Step {
        lines: vec![format!("Asked to take part: {}", input.recruited + not_recruited)],
        beside: before,
    });
    let others = [
        Step {
            lines: vec![format!("Recruited to be tested: {}", input.recruited)],
            beside: listed("Did not take part", &input.absent),
        },
        Step { lines: vec![format!("Drove or rated something: {}", input.drove)], beside },
        Step { lines: analysed, beside: Vec::new() },
    ];
    invited.into_iter().chain(others).collect()
}

fn paint(canvas: &mut Canvas<'_>, place: Place, steps: &[Step]) {
    let width = place.right - place.left;
    let side = 0.50 * width;
    let main = if has_beside(steps) { 0.44 * width } else { width };
    let mut top = place.top + 4.0;
    let middle = place.left + 0.5 * main;
    for (at, step) in steps.iter().enumerate() {
        let bottom = top + step.lines.len() as f64 * LINE + 2.0 * PAD;
        boxed(canvas, (place.left, top), (place.left + main, bottom), &step.lines);
        let mut lowest = bottom;
        if !step.beside.is_empty() {
            let left = place.right - side;
            lowest = lowest.max(top + step.beside.len() as f64 * LINE + 2.0 * PAD);
            boxed(canvas, (left, top), (place.right, lowest), &step.beside);
            let y = f64::midpoint(top, bottom);
            let from = (place.left + main, y);
            canvas.arrow(from, (left, y), Pen::new(MUTED, stroke::BOX), 4.0);
        }
        if at + 1 < steps.len() {
            let to = (middle, lowest + GAP);
            canvas.arrow((middle, bottom), to, Pen::new(MUTED, stroke::BOX), 4.0);
        }
        top = lowest + GAP;
    }
}

fn boxed(canvas: &mut Canvas<'_>, a: (f64, f64), b: (f64, f64), lines: &[String]) {
    canvas.fill_rect(a, b, PALE, 1.0);
    canvas.rect(a, b, Pen::new(MUTED, stroke::OUTLINE));
    for (at, line) in lines.iter().enumerate() {
        let look = Look::new(size::TICK).centred().colour(INK);
        let look = if at == 0 { look.semibold() } else { look };
        let y = a.1 + PAD + (at as f64 + 0.5) * LINE;
        canvas.text(&markup::literal(line), (a.0 + PAD, y), look);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input() -> Flow {
        Flow {
            not_admitted: vec![("about_you.age >= 18".into(), 3)],
            not_agreed: 2,
            recruited: 24,
            absent: vec![("no drive *at all*".into(), 1)],
            drove: 23,
            left_out: vec![("withdrew consent".into(), 1)],
            analysed: 22,
            drives_left_out: vec![("drive shorter than 300 s".into(), 2)],
            outcomes: vec![("Trust".into(), 21)],
        }
    }

    #[test]
    fn every_step_and_reason_stands_in_the_picture() {
        let figure = flow(&input(), &Context::real()).unwrap();
        for said in [
            "24",
            "Asked to take part: 29",
            "3: about_you.age",
            "Did not agree: 2",
            "Did not take part: 1",
            "Left out: 1",
            "withdrew consent",
            "Analysed: 22",
            "Trust: 21",
        ] {
            assert!(figure.svg.contains(said), "{said}");
        }
        assert!(figure.alt.contains("1: withdrew consent"), "{}", figure.alt);
        assert!(figure.alt.starts_with("3 not admitted"), "{}", figure.alt);
        assert!(figure.alt.contains("2 did not agree, 24"), "{}", figure.alt);
        let everybody = Flow { not_admitted: Vec::new(), not_agreed: 0, ..input() };
        let figure = flow(&everybody, &Context::real()).unwrap();
        assert!(!figure.svg.contains("Asked"), "nobody was screened");
        assert!(figure.alt.starts_with("24 recruited"), "{}", figure.alt);
    }

    #[test]
    fn where_nobody_is_left_out_the_figure_is_one_column_wide() {
        let width = |input: &Flow| {
            let svg = flow(input, &Context::real()).unwrap().svg;
            let millimetres = svg.split_once(" width=\"").unwrap().1;
            millimetres.split_once("mm").unwrap().0.to_owned()
        };
        assert_eq!(width(&input()), "180");
        let everybody = Flow {
            not_admitted: Vec::new(),
            not_agreed: 0,
            absent: Vec::new(),
            drove: 24,
            left_out: Vec::new(),
            analysed: 24,
            drives_left_out: Vec::new(),
            ..input()
        };
        assert_eq!(width(&everybody), "85");
    }

    #[test]
    fn what_does_not_add_up_at_a_step_is_refused() {
        let numbers = |recruited, drove, analysed| {
            let input = Flow { recruited, drove, analysed, ..input() };
            flow(&input, &Context::real())
        };
        assert!(numbers(24, 23, 22).is_ok());
        for counts in [[24, 23, 25], [24, 23, 21], [24, 24, 23], [22, 23, 22]] {
            let refused = numbers(counts[0], counts[1], counts[2]);
            assert!(matches!(refused, Err(ReportError::OutOfRange { .. })));
        }
    }
}
