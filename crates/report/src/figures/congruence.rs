//! What people are predicted to like: a rating over the car's style, for people of three own styles.

use super::prelude::*;

/// Curves of a surface, a panel a rating.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Congruence {
    /// What style is counted in, such as `ADB score`. Plain text.
    pub style: String,
    /// Any number of panels.
    pub panels: Vec<CongruencePanel>,
    /// Places of the dial that the curvature rests on.
    pub places: usize,
    /// Which of how many parts this is, counted from 1; none where all panels fit one printed page: see [`Congruence::parts`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<(usize, usize)>,
}

/// One rating.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CongruencePanel {
    /// Such as `Trust`. Plain text.
    pub title: String,
    /// Title of the axis of the rating. Plain text.
    pub axis: String,
    /// The test of the curvature, with marks; empty where there is none.
    pub test: String,
    /// Participants in its model.
    pub n: usize,
    /// Whether the model takes the period: the curves are then averages over the periods.
    pub period: bool,
    /// Of people whose own style lies one standard deviation below the mean, at it, and one above; none where nobody is near.
    pub curves: [Option<CongruenceLine>; 3],
}

/// What people of one own style are predicted to answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CongruenceLine {
    /// Their own style.
    pub own: f64,
    /// The car's style and the rating, ascending in the car's style, over what they met.
    pub points: Vec<(f64, f64)>,
    /// The rating of a car in their own style; none where they met none so near.
    pub at_own: Option<f64>,
    /// Where the rating is best, the car's style and the rating; none where that lies beyond what they met.
    pub best: Option<(f64, f64)>,
}

const NAME: &str = "congruence";
/// Most panels of a printed page.
const MOST: usize = 9;
/// Height of a panel, in millimetres.
const PANEL_MM: f64 = 58.0;
/// Half the length of the stroke at the own style, in points.
const STROKE: f64 = 4.0;
const NAMES: [&str; 3] =
    ["Own style 1 SD below the mean", "Own style at the mean", "Own style 1 SD above the mean"];
/// Shape, colour and dashes of a curve.
type Look = (Marker, RGBColor, Option<(f64, f64)>);
const LOOKS: [Look; 3] = [
    (Marker::TriangleDown, BLUE, Some((4.0, 1.8))),
    (Marker::Circle, INK, None),
    (Marker::TriangleUp, ORANGE, Some((1.2, 1.4))),
];

impl Congruence {
    /// The same panels as figures that a printed page holds each, in order.
    #[must_use]
    pub fn parts(self) -> Vec<Self> {
        let count = self.panels.len().div_ceil(MOST);
        if count <= 1 {
            return vec![self];
        }
        let pieces = self.panels.chunks(MOST).enumerate();
        let part = |(at, panels): (usize, &[CongruencePanel])| Self {
            style: self.style.clone(),
            panels: panels.to_vec(),
            places: self.places,
            part: Some((at + 1, count)),
        };
        pieces.map(part).collect()
    }
}

impl CongruencePanel {
    fn lines(&self) -> impl Iterator<Item = &CongruenceLine> {
        self.curves.iter().flatten()
    }
}

impl CongruenceLine {
    /// Every style of a car, and one's own.
    fn styles(&self) -> impl Iterator<Item = f64> {
        let points = self.points.iter().chain(&self.best);
        points.map(|point| point.0).chain([self.own])
    }

    fn ratings(&self) -> impl Iterator<Item = f64> {
        let points = self.points.iter().chain(&self.best);
        points.map(|point| point.1).chain(self.at_own)
    }
}

fn pen(look: usize) -> Pen {
    let (_, colour, dashes) = LOOKS[look];
    let pen = Pen::new(colour, stroke::STRONG);
    dashes.map_or(pen, |(on, off)| pen.dashed(on, off))
}

/// Draws the predicted rating over the car's style, three curves a panel, with a stroke where the car drives as the person does and a mark
/// where the rating is best.
///
/// # Errors
/// [`ReportError`] if there is no panel, a panel has no curve or a curve no point, the car's styles do not ascend, or a number is not finite.
///
/// # Source
/// Edwards and Parry (1993): cuts through the surface, at three values of one's own.
pub fn congruence(input: &Congruence, context: &Context) -> Result<Figure, ReportError> {
    let check = Check(NAME);
    check.at_least(1, "panels", input.panels.len())?;
    for panel in &input.panels {
        check.at_least(1, "curves", panel.lines().count())?;
        for line in panel.lines() {
            check.at_least(1, "points", line.points.len())?;
            check.finite("the style", line.styles())?;
            check.finite(&panel.title, line.ratings())?;
            let styles = line.points.iter().map(|point| point.0);
            check.rising("the car's style", styles, "ascending styles")?;
        }
    }
    let count = input.panels.len();
    let most = if count == 4 { 2 } else { 3 };
    let grid = Grid::limited(count, most, (12.0, 11.0));
    let width = if count == 1 { ONE_COLUMN_MM } else { TWO_COLUMNS_MM };
    let (name, part) = of_part(NAME, input.part);
    let plan = Plan {
        name,
        size_mm: (width, PANEL_MM * grid.rows() + 12.0),
        title: format!("Predicted rating over the car’s style{part}"),
        caption: caption(input),
        alt: sentences(input.panels.iter().map(told_of)),
        shows: Shows::Participants,
    };
    let drawn = |look: &usize| {
        let has = |panel: &CongruencePanel| panel.curves[*look].is_some();
        input.panels.iter().any(has)
    };
    let looks = (0..LOOKS.len()).filter(drawn);
    let keys: Vec<(Key, &str)> = looks.map(|look| (Key::Line(pen(look)), NAMES[look])).collect();
    let lines = input.panels.iter().flat_map(CongruencePanel::lines);
    let x = Scale::over(lines.flat_map(CongruenceLine::styles), 5);
    let along = markup::capital(&markup::literal(&input.style)) + " of the car";
    draw_panels(plan, context, grid, &keys, |canvas, index, place| {
        paint(canvas, place, &input.panels[index], (along.as_str(), x.clone()));
    })
}

/// Panels share their scale `x`.
fn paint(
    canvas: &mut Canvas<'_>,
    place: Place,
    input: &CongruencePanel,
    (along, x): (&str, Scale),
) {
    let (title, axis) = (markup::literal(&input.title), markup::literal(&input.axis));
    let labels =
        Labels { title: &title, subtitle: &input.test, x: along, y: &axis, ..Labels::default() };
    let y = Scale::over(input.lines().flat_map(CongruenceLine::ratings), 5);
    let mut panel = Panel::open(canvas, place, &labels, (x, y));
    let drawn = || {
        let curves = input.curves.iter().enumerate();
        curves.filter_map(|(look, line)| Some((look, line.as_ref()?)))
    };
    for (look, line) in drawn() {
        panel.line(line.points.iter().copied(), pen(look));
    }
    for (look, line) in drawn() {
        let (shape, colour, _) = LOOKS[look];
        if let Some(at_own) = line.at_own {
            let (x, y) = panel.frame.at(line.own, at_own);
            let ends = ((x, y - STROKE), (x, y + STROKE));
            let stroke = Pen::new(colour, stroke::STRONG);
            panel.canvas.line(ends.0, ends.1, stroke);
        }
        if let Some(best) = line.best {
            panel.mark(best, (2.2, shape, colour));
        }
    }
}

fn caption(input: &Congruence) -> String {
    let n = counted(input.panels.iter().map(|panel| panel.n), " (by panel)");
    let with_period = input.panels.iter().filter(|panel| panel.period).count();
    let period = match with_period {
        0 => "",
        all if all == input.panels.len() => " and the period, averaged over the periods",
        _ => " and, where it can be told apart, the period, averaged over the periods",
    };
    let always = if input.places == 3 { ": a parabola through three always fits" } else { "" };
    format!(
        "Each rating as the mixed model predicts it (on the distance of the car from one’s own style, own style, their squares and product{period}; \
         level and slope of the distance at random over people), over the {} of the car: for people whose own is the mean, or one *SD* below or \
         above, each over what the people nearest to them met. Upright strokes: the car drives as the person does. Marks: where the rating is \
         best, if they met that. The curvature rests on {} places of the dial{always}. *n* = {n} participants.",
        markup::literal(&input.style),
        input.places,
    )
}

fn told_of(panel: &CongruencePanel) -> String {
    let line = |line: &CongruenceLine| {
        let best = line.best.map_or_else(
            || "best beyond what was met, or nowhere".to_owned(),
            |(car, rating)| format!("best at {}, {}", number(car, 1), number(rating, 2)),
        );
        format!("own style {}, {best}", number(line.own, 1))
    };
    let lines: Vec<String> = panel.lines().map(line).collect();
    format!("{}, predicted over the car’s style: {}.", panel.title, lines.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(own: f64, best: Option<(f64, f64)>) -> CongruenceLine {
        let rating = |car: f64| 5.0 - 0.01 * (car - own - 1.0).powi(2);
        CongruenceLine {
            own,
            points: [-15.0, 0.0, 15.0].map(|moved| (own + moved, rating(own + moved))).to_vec(),
            at_own: Some(rating(own)),
            best,
        }
    }

    fn input() -> Congruence {
        Congruence {
            style: "ADB score".into(),
            panels: vec![CongruencePanel {
                title: "Trust".into(),
                axis: "Predicted rating".into(),
                test: "*p* < .001".into(),
                n: 24,
                period: true,
                curves: [Some(line(20.0, Some((21.0, 5.0)))), Some(line(30.0, None)), None],
            }],
            places: 3,
            part: None,
        }
    }

    #[test]
    fn the_caption_says_the_model_the_people_and_what_the_curvature_rests_on() {
        let figure = congruence(&input(), &Context::synthetic(1)).unwrap();
        for text in ["3 places of the dial", "the period", "*n* = 24", "ADB score"] {
            assert!(figure.caption.contains(text), "{text}: {}", figure.caption);
        }
        assert!(figure.svg.contains(">ADB score of the car<"));
        assert_eq!(
            figure.alt,
            "Trust, predicted over the car’s style: own style 20.0, best at 21.0, 5.00; own style 30.0, best beyond what was met, or nowhere."
        );
        let mut without = input();
        without.panels[0].period = false;
        let figure = congruence(&without, &Context::real()).unwrap();
        assert!(!figure.caption.contains("period"));
    }

    #[test]
    fn what_nobody_is_near_has_no_name_and_what_is_not_known_no_mark() {
        let drawn = |input: &Congruence| congruence(input, &Context::real()).unwrap().svg;
        let svg = drawn(&input());
        assert!(svg.contains(NAMES[0]) && svg.contains(NAMES[1]) && !svg.contains(NAMES[2]));
        let marks = |svg: &str| svg.matches("<polygon").count() + svg.matches("<circle").count();
        let mut more = input();
        more.panels[0].curves[1] = Some(line(30.0, Some((31.0, 5.0))));
        assert!(marks(&drawn(&more)) > marks(&svg));
        let lines = |svg: &str| svg.matches("<polyline").count();
        let mut fewer = input();
        fewer.panels[0].curves[1].as_mut().unwrap().at_own = None;
        assert_eq!(lines(&drawn(&fewer)) + 1, lines(&svg));
    }

    #[test]
    fn more_panels_than_a_page_holds_are_parts_with_names_of_their_own() {
        let mut many = input();
        many.panels = vec![many.panels[0].clone(); 9];
        assert_eq!(many.clone().parts(), [many.clone()]);
        many.panels.push(many.panels[0].clone());
        let drawn = many.parts();
        let drawn = drawn.iter().map(|p| congruence(p, &Context::real()));
        let drawn: Vec<Figure> = drawn.map(Result::unwrap).collect();
        assert_eq!(drawn[0].name, "congruence");
        assert_eq!(drawn[1].name, "congruence-2");
        assert!(drawn[1].title.ends_with(", part 2 of 2"));
    }

    #[test]
    fn no_curve_no_point_styles_that_fall_and_no_number_are_refused() {
        let drawn = |change: &dyn Fn(&mut Congruence)| {
            let mut input = input();
            change(&mut input);
            congruence(&input, &Context::real())
        };
        let first = |input: &mut Congruence, change: &dyn Fn(&mut CongruenceLine)| {
            change(input.panels[0].curves[0].as_mut().unwrap());
        };
        assert!(drawn(&|_| ()).is_ok());
        assert!(drawn(&|input| input.panels.clear()).is_err());
        assert!(drawn(&|input| input.panels[0].curves = [None, None, None]).is_err());
        assert!(drawn(&|input| first(input, &|line| line.points.clear())).is_err());
        assert!(drawn(&|input| first(input, &|line| line.points.reverse())).is_err());
        assert!(drawn(&|input| first(input, &|line| line.best = Some((f64::NAN, 1.0)))).is_err());
        assert!(drawn(&|input| first(input, &|line| line.at_own = Some(f64::NAN))).is_err());
    }
}
