//! What a figure shows, read back from its SVG: the numbers at the axes say which value a place on the page has, and
//! each number of the input must be drawn at its place.

mod lines;
mod marks;
mod rows;

use crate::kinds;
use maveric_report::{Context, Figure, figures};
use resvg::usvg::roxmltree::{Document, Node};

/// Coordinates are written with two decimals, at the ticks and at what is drawn.
const TOLERANCE_PT: f64 = 0.1;

type Point = (f64, f64);

/// One panel: its ticks, and what is drawn in it.
#[derive(Default)]
struct Panel {
    x: Vec<(String, f64)>,
    y: Vec<(String, f64)>,
    /// Middles of circles and polygons.
    marks: Vec<Point>,
    lines: Vec<Point>,
    corners: Vec<Point>,
}

fn attribute(node: Node<'_, '_>, name: &str) -> f64 {
    let text = node.attribute(name).unwrap_or_default();
    text.parse().unwrap_or_default()
}

fn points(node: Node<'_, '_>) -> Vec<Point> {
    let pairs = node.attribute("points").unwrap_or_default().split(' ');
    let point = |pair: &str| {
        let (x, y) = pair.split_once(',').unwrap();
        (x.parse().unwrap(), y.parse().unwrap())
    };
    pairs.map(point).collect()
}

fn words(node: Node<'_, '_>) -> String {
    node.descendants().filter(Node::is_text).filter_map(|inner| inner.text()).collect()
}

/// The panels of a figure in the order in which they are drawn.
fn panels(svg: &str) -> Vec<Panel> {
    let document = Document::parse(svg).unwrap();
    let nodes: Vec<Node<'_, '_>> =
        document.root_element().children().filter(Node::is_element).collect();
    let mut panels: Vec<Panel> = Vec::new();
    let (mut in_axes, mut index) = (false, 0);
    while index < nodes.len() {
        let node = nodes[index];
        let label = nodes.get(index + 1).filter(|next| next.has_tag_name("text"));
        let anchor = label.and_then(|label| label.attribute("text-anchor"));
        let ends = if node.has_tag_name("polyline") { points(node) } else { Vec::new() };
        let tick = match (&ends[..], anchor) {
            ([a, b], Some("end")) if node.attribute("stroke") == Some("#e6e6e6") => {
                (a.1 - b.1).abs() < 1e-9
            }
            ([a, b], Some("middle")) => {
                (a.0 - b.0).abs() < 1e-9 && ((b.1 - a.1) - 2.0).abs() < 1e-9
            }
            _ => false,
        };
        if tick {
            if !in_axes {
                panels.push(Panel::default());
            }
            let (panel, text) = (panels.last_mut().unwrap(), words(*label.unwrap()));
            if anchor == Some("end") {
                panel.y.push((text, ends[0].1));
            } else {
                panel.x.push((text, ends[0].0));
            }
            index += 2;
        } else {
            if let Some(panel) = panels.last_mut() {
                panel.take(node);
            }
            index += 1;
        }
        in_axes = tick;
    }
    panels
}

impl Panel {
    fn take(&mut self, node: Node<'_, '_>) {
        match node.tag_name().name() {
            "polyline" => self.lines.extend(points(node)),
            "circle" => self.marks.push((attribute(node, "cx"), attribute(node, "cy"))),
            "polygon" => {
                let corners = points(node);
                let n = corners.len() as f64;
                let sum = |of: fn(&Point) -> f64| corners.iter().map(of).sum::<f64>();
                self.marks.push((sum(|p| p.0) / n, sum(|p| p.1) / n));
            }
            "rect" => {
                let [x, y, w, h] = ["x", "y", "width", "height"].map(|name| attribute(node, name));
                self.corners.extend([(x, y), (x + w, y + h)]);
            }
            _ => {}
        }
    }
}

/// Where a value lies on the page, by the first and the last number at an axis.
fn place(ticks: &[(String, f64)], value: f64) -> f64 {
    let number = |text: &str| -> f64 {
        let text = text.replace('\u{2212}', "-").replace('°', "");
        text.parse().unwrap_or_else(|_| panic!("`{text}` is no number"))
    };
    let (first, last) = (&ticks[0], &ticks[ticks.len() - 1]);
    assert!(ticks.len() > 1, "one tick is no scale");
    let share = (value - number(&first.0)) / (number(&last.0) - number(&first.0));
    first.1 + share * (last.1 - first.1)
}

/// What must be found in a panel.
enum Drawn {
    Mark(Point),
    /// A point of a line.
    Line(Point),
    /// A mark at a value of x in a row, counted from the top.
    InRow(f64, usize),
    /// The end of a line in a row.
    EndInRow(f64, usize),
    /// A mark at this value of y, wherever it stands along x.
    MarkAtY(f64),
    /// A point of a line at this value of x, wherever it stands along y.
    LineAtX(f64),
    /// A corner of a rectangle at this value of x or of y, wherever it stands along the other.
    CornerAtX(f64),
    CornerAtY(f64),
}

impl Drawn {
    fn check(&self, panel: &Panel, name: &str) {
        let near = |a: f64, b: f64| (a - b).abs() < TOLERANCE_PT;
        let both =
            |list: &[Point], (x, y): Point| list.iter().any(|p| near(p.0, x) && near(p.1, y));
        let at = |&(x, y): &Point| (place(&panel.x, x), place(&panel.y, y));
        // Series in one row have their own heights: a third of the row's.
        let in_row = |list: &[Point], x: f64, row: usize| {
            let apart = (panel.y[1].1 - panel.y[0].1).abs() / 2.0;
            let (x, y) = (place(&panel.x, x), panel.y[row].1);
            list.iter().any(|p| near(p.0, x) && (p.1 - y).abs() < apart)
        };
        let (holds, what) = match self {
            Self::Mark(point) => (both(&panel.marks, at(point)), format!("a mark at {point:?}")),
            Self::Line(point) => (both(&panel.lines, at(point)), format!("a line at {point:?}")),
            Self::InRow(x, row) => (in_row(&panel.marks, *x, *row), format!("{x} in row {row}")),
            Self::EndInRow(x, row) => {
                (in_row(&panel.lines, *x, *row), format!("a line to {x} in row {row}"))
            }
            Self::MarkAtY(y) => {
                let height = place(&panel.y, *y);
                (panel.marks.iter().any(|p| near(p.1, height)), format!("a mark at y = {y}"))
            }
            Self::LineAtX(x) => {
                let side = place(&panel.x, *x);
                (panel.lines.iter().any(|p| near(p.0, side)), format!("a line at x = {x}"))
            }
            Self::CornerAtX(x) => {
                let side = place(&panel.x, *x);
                (panel.corners.iter().any(|p| near(p.0, side)), format!("a side at x = {x}"))
            }
            Self::CornerAtY(y) => {
                let height = place(&panel.y, *y);
                (panel.corners.iter().any(|p| near(p.1, height)), format!("an edge at y = {y}"))
            }
        };
        assert!(holds, "{name}: {what} is not drawn");
    }
}

/// Every expectation of a panel holds, and there are some.
fn read_back(figure: &Figure, expected: &[Vec<Drawn>]) {
    let panels = panels(&figure.svg);
    assert_eq!(panels.len(), expected.len(), "panels of {}", figure.name);
    for (panel, expected) in panels.iter().zip(expected) {
        assert!(!expected.is_empty(), "{}", figure.name);
        for drawn in expected {
            drawn.check(panel, &figure.name);
        }
    }
}

fn context() -> Context {
    kinds::context(1)
}
