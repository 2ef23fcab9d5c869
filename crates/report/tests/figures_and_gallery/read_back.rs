//! What a figure shows, read back from its SVG: the numbers at the axes say which value a place on the page has, and
//! each number of the input must be drawn at its place.

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
    /// Points of lines.
    lines: Vec<Point>,
    /// Opposite corners of rectangles.
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
    node.descendants()
        .filter(Node::is_text)
        .filter_map(|inner| inner.text())
        .collect()
}

/// The panels of a figure in the order in which they are drawn.
fn panels(svg: &str) -> Vec<Panel> {
    let document = Document::parse(svg).unwrap();
    let nodes: Vec<Node<'_, '_>> = document
        .root_element()
        .children()
        .filter(Node::is_element)
        .collect();
    let mut panels: Vec<Panel> = Vec::new();
    let (mut in_axes, mut index) = (false, 0);
    while index < nodes.len() {
        let node = nodes[index];
        let label = nodes
            .get(index + 1)
            .filter(|next| next.has_tag_name("text"));
        let anchor = label.and_then(|label| label.attribute("text-anchor"));
        let ends = if node.has_tag_name("polyline") {
            points(node)
        } else {
            Vec::new()
        };
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
            "circle" => self
                .marks
                .push((attribute(node, "cx"), attribute(node, "cy"))),
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
        text.parse()
            .unwrap_or_else(|_| panic!("`{text}` is no number"))
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
            Self::Mark(point) => (
                both(&panel.marks, at(point)),
                format!("a mark at {point:?}"),
            ),
            Self::Line(point) => (
                both(&panel.lines, at(point)),
                format!("a line at {point:?}"),
            ),
            Self::InRow(x, row) => (in_row(&panel.marks, *x, *row), format!("{x} in row {row}")),
            Self::EndInRow(x, row) => (
                in_row(&panel.lines, *x, *row),
                format!("a line to {x} in row {row}"),
            ),
            Self::MarkAtY(y) => {
                let height = place(&panel.y, *y);
                (
                    panel.marks.iter().any(|p| near(p.1, height)),
                    format!("a mark at y = {y}"),
                )
            }
            Self::LineAtX(x) => {
                let side = place(&panel.x, *x);
                (
                    panel.lines.iter().any(|p| near(p.0, side)),
                    format!("a line at x = {x}"),
                )
            }
            Self::CornerAtX(x) => {
                let side = place(&panel.x, *x);
                (
                    panel.corners.iter().any(|p| near(p.0, side)),
                    format!("a side at x = {x}"),
                )
            }
            Self::CornerAtY(y) => {
                let height = place(&panel.y, *y);
                (
                    panel.corners.iter().any(|p| near(p.1, height)),
                    format!("an edge at y = {y}"),
                )
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

fn interval(x: f64, [value, low, high]: [f64; 3]) -> [Drawn; 3] {
    [
        Drawn::Mark((x, value)),
        Drawn::Line((x, low)),
        Drawn::Line((x, high)),
    ]
}

fn row_interval([value, low, high]: [f64; 3], row: usize) -> [Drawn; 3] {
    [
        Drawn::InRow(value, row),
        Drawn::EndInRow(low, row),
        Drawn::EndInRow(high, row),
    ]
}

#[test]
fn points_lie_where_both_their_numbers_say() {
    let marks = |points: &[Point]| points.iter().copied().map(Drawn::Mark).collect::<Vec<_>>();
    let scatter = kinds::scatter::input();
    let figure = figures::scatter(&scatter, &context()).unwrap();
    read_back(&figure, &[marks(&scatter.points)]);

    let line = kinds::aggression_line::input();
    let figure = figures::aggression_line(&line, &context()).unwrap();
    let expected: Vec<_> = line
        .panels
        .iter()
        .map(|panel| marks(&panel.points))
        .collect();
    read_back(&figure, &expected);

    let changes = kinds::lane_change_quality::input();
    let figure = figures::lane_change_quality(&changes, &context()).unwrap();
    let points = |values: &[f64]| {
        let points = changes
            .speed_mps
            .iter()
            .copied()
            .zip(values.iter().copied());
        marks(&points.collect::<Vec<_>>())
    };
    let expected: Vec<_> = changes
        .panels
        .iter()
        .map(|panel| points(&panel.values))
        .collect();
    read_back(&figure, &expected);

    let round = kinds::perpendicular::input();
    let figure = figures::perpendicular(&round, &context()).unwrap();
    let place = |p: &figures::perpendicular::AngleChange| {
        Drawn::Mark((p.angle_rad.to_degrees().rem_euclid(360.0), p.change))
    };
    let expected: Vec<Vec<_>> = round
        .panels
        .iter()
        .map(|panel| panel.points.iter().map(place).collect())
        .collect();
    read_back(&figure, &expected);
}

#[test]
fn upright_intervals_have_their_mark_and_both_their_ends() {
    let people = kinds::recommendation::input();
    let figure = figures::recommendation(&people, &context()).unwrap();
    let one = |&[truth, value, low, high]: &[f64; 4]| {
        // An end beyond the panel lies on its border.
        let furthest = people
            .people
            .iter()
            .flatten()
            .fold(15.0, |far: f64, v| far.max(v.abs()))
            + 1.0;
        interval(truth, [value, low.max(-furthest), high.min(furthest)])
    };
    read_back(&figure, &[people.people.iter().flat_map(one).collect()]);

    let curves = kinds::curves::input();
    let figure = figures::curves(&curves, &context()).unwrap();
    let expected = curves.panels.iter().map(|panel| {
        let points = panel.curves.iter().flatten();
        points
            .flat_map(|p| interval(p.x, [p.y, p.low, p.high]))
            .collect()
    });
    read_back(&figure, &expected.collect::<Vec<_>>());

    let learning = kinds::learning_curve::input();
    let figure = figures::learning_curve(&learning, &context()).unwrap();
    let expected = learning.panels.iter().map(|panel| {
        let points = panel.points.iter();
        points
            .flat_map(|p| interval(p.minutes, [p.mean, p.low, p.high]))
            .collect()
    });
    read_back(&figure, &expected.collect::<Vec<_>>());

    let calibration = kinds::calibration::input();
    let figure = figures::calibration(&calibration, &context()).unwrap();
    let marks = calibration
        .bins
        .iter()
        .map(|bin| Drawn::Mark((100.0 * bin.predicted, 100.0 * bin.observed)));
    read_back(&figure, &[marks.collect()]);

    let sweep = kinds::dial_sweep::input();
    let figure = figures::dial_sweep(&sweep, &context()).unwrap();
    let expected = sweep.panels.iter().map(|panel| {
        let whole: Vec<Vec<f64>> = panel
            .drivers
            .iter()
            .filter_map(|d| d.iter().copied().collect())
            .collect();
        let mean = |step: usize| whole.iter().map(|d| d[step]).sum::<f64>() / whole.len() as f64;
        let means = sweep
            .points
            .iter()
            .enumerate()
            .map(|(step, at)| Drawn::Mark((*at, mean(step))));
        means.collect()
    });
    read_back(&figure, &expected.collect::<Vec<_>>());
}

#[test]
fn rows_hold_their_estimates_and_both_ends_of_their_intervals() {
    let forest = kinds::forest::input();
    let figure = figures::forest(&forest, &context()).unwrap();
    let rows = forest.rows.iter().enumerate();
    let expected = rows
        .flat_map(|(i, row)| row_interval(row.estimate.unwrap(), i))
        .collect();
    read_back(&figure, &[expected]);

    let few = kinds::intervals::input();
    let figure = figures::intervals::intervals("x", "X", &few, &context()).unwrap();
    let rows = few.rows.iter().enumerate();
    let expected = rows.flat_map(|(i, row)| {
        let (low, high) = row.interval.unwrap();
        let others = [
            Drawn::EndInRow(row.floor.unwrap(), i),
            Drawn::InRow(row.ceiling.unwrap(), i),
        ];
        row_interval([row.estimate.unwrap(), low, high], i)
            .into_iter()
            .chain(others)
    });
    read_back(&figure, &[expected.collect()]);

    let family = kinds::family::input();
    let figure = figures::family(&family, &context()).unwrap();
    let expected = family.panels.iter().map(|panel| {
        let rows = panel.cells.iter().enumerate();
        let cells = rows.flat_map(|(i, row)| row.iter().flatten().map(move |cell| (i, *cell)));
        cells.flat_map(|(i, cell)| row_interval(cell, i)).collect()
    });
    read_back(&figure, &expected.collect::<Vec<_>>());

    let fidelity = kinds::fidelity::input();
    let figure = figures::fidelity(&fidelity, &context()).unwrap();
    let rows = fidelity.measures.iter().enumerate();
    let expected = rows.flat_map(|(i, row)| {
        let series = [Some(row.car), row.test_retest, row.population]
            .into_iter()
            .flatten();
        let paper = row.paper.map(|share| Drawn::InRow(100.0 * share, i));
        series
            .flat_map(move |a| row_interval([a.mean, a.low, a.high].map(|v| 100.0 * v), i))
            .chain(paper)
    });
    read_back(&figure, &[expected.collect()]);

    let rates = kinds::false_positives::input();
    let figure = figures::false_positives(&rates, &context()).unwrap();
    let parts = rates.parts.iter().enumerate();
    let tests =
        parts.flat_map(|(i, part)| part.rates.iter().map(move |rate| Drawn::InRow(*rate, i)));
    let families = rates.families.iter().enumerate();
    let families = families.flat_map(|(i, (_, rate, (low, high)))| {
        row_interval([*rate, *low, *high], rates.parts.len() + i)
    });
    read_back(&figure, &[tests.chain(families).collect()]);

    let errors = kinds::following_errors::input();
    let figure = figures::following_errors(&errors, &context()).unwrap();
    let expected = errors.models.iter().flat_map(|model| {
        let short = model.model == figures::car_following::Follower::Idm;
        let errors = model.gap_rmse_m.iter().enumerate();
        errors.map(move |(i, error)| {
            if short {
                Drawn::EndInRow(*error, i)
            } else {
                Drawn::InRow(*error, i)
            }
        })
    });
    read_back(&figure, &[expected.collect()]);

    let ablation = kinds::ablation::input();
    let figure = figures::ablation(&ablation, &context()).unwrap();
    let expected = (0..ablation.losses.len()).map(|loss| {
        let reference = &ablation.variants[0].losses[loss];
        let variants = ablation.variants.iter().enumerate();
        let mean = variants.map(|(i, variant)| {
            let pairs = variant.losses[loss].iter().zip(reference);
            let differences: Vec<f64> = pairs.filter_map(|(a, b)| Some((*a)? - (*b)?)).collect();
            Drawn::InRow(
                differences.iter().sum::<f64>() / differences.len() as f64,
                i,
            )
        });
        mean.collect()
    });
    read_back(&figure, &expected.collect::<Vec<_>>());
}

#[test]
fn bars_boxes_and_clouds_reach_as_far_as_their_numbers() {
    let bars = kinds::preference::input();
    let figure = figures::preference(&bars, &context()).unwrap();
    let shares = bars.scales.iter().flat_map(|scale| {
        scale
            .above
            .iter()
            .map(|k| 100.0 * *k as f64 / scale.n as f64)
    });
    read_back(&figure, &[shares.map(Drawn::CornerAtY).collect()]);

    let residuals = kinds::residuals::input();
    let figure = figures::residuals(&residuals, &context()).unwrap();
    let expected = residuals.panels.iter().map(|panel| {
        let outer = panel.quantiles.iter().filter(|q| (q.0 - 0.5).abs() > 1e-9);
        outer.map(|q| Drawn::CornerAtX(q.1)).collect()
    });
    read_back(&figure, &expected.collect::<Vec<_>>());

    let cells = kinds::comparison::input();
    let figure = figures::comparison(&cells, &context()).unwrap();
    let expected = cells.panels.iter().map(|panel| {
        let people = panel.rows.iter().flatten().flatten().copied();
        let means = panel
            .cells
            .iter()
            .filter_map(|cell| cell.mean)
            .map(|mean| mean[0]);
        people.chain(means).map(Drawn::MarkAtY).collect()
    });
    read_back(&figure, &expected.collect::<Vec<_>>());

    let differences = kinds::difference_panels::input();
    let figure = figures::difference_panels(&differences, &context()).unwrap();
    let expected = differences.panels.iter().map(|panel| {
        let people = panel.rows.iter().flatten().flatten().copied();
        people.map(Drawn::MarkAtY).collect()
    });
    read_back(&figure, &expected.collect::<Vec<_>>());
}

#[test]
fn lines_begin_and_end_where_their_numbers_do() {
    let training = kinds::training_curves::input();
    let figure = figures::training_curves(&training, &context()).unwrap();
    let logarithmic = |values: &[f64]| values.iter().any(|v| v * 10.0 < values[0]);
    let terms = panels(&figure.svg).into_iter().zip(&training.terms);
    let mut read = 0;
    for (panel, term) in terms.filter(|(_, term)| !logarithmic(&term.train)) {
        let epochs = term.train.len();
        for point in [
            (1.0, term.train[0]),
            (epochs as f64, term.train[epochs - 1]),
        ] {
            Drawn::Line(point).check(&panel, &term.title);
            read += 1;
        }
    }
    assert!(read > 3);

    let steps = kinds::step_responses::input();
    let figure = figures::step_responses(&steps, &context()).unwrap();
    let ends = |x: &[f64], y: &[f64]| {
        let last = x.len() - 1;
        [Drawn::Line((x[0], y[0])), Drawn::Line((x[last], y[last]))]
    };
    let expected = steps
        .panels
        .iter()
        .map(|panel| ends(&panel.time_s, &panel.value).into());
    read_back(&figure, &expected.collect::<Vec<_>>());

    let drive = kinds::car_following::input();
    let figure = figures::car_following(&drive, &context()).unwrap();
    let time: Vec<f64> = drive.time_s.iter().map(|t| t - drive.time_s[0]).collect();
    let recorded = &drive.series[0];
    let first = |values: &[f64]| vec![Drawn::Line((0.0, values[0]))];
    assert!(time.len() > 800, "long enough to be thinned");
    read_back(
        &figure,
        &[first(&recorded.gap_m), first(&recorded.speed_mps)],
    );

    let overview = kinds::drive_overview::input();
    let figure = figures::drive_overview(&overview, &context()).unwrap();
    let time: Vec<f64> = overview
        .time_s
        .iter()
        .map(|t| t - overview.time_s[0])
        .collect();
    let hole = overview.segment.partition_point(|segment| *segment == 0);
    // Both sides of the hole.
    let beside = |values: &[f64]| [hole - 1, hole].map(|row| Drawn::Line((time[row], values[row])));
    let lane: Vec<f64> = overview.lane.iter().map(|lane| f64::from(*lane)).collect();
    let gap = overview.gap_m.iter().position(Option::is_some).unwrap();
    let expected = [
        beside(&overview.speed_mps).into(),
        vec![Drawn::Line((time[gap], overview.gap_m[gap].unwrap()))],
        beside(&lane).into(),
    ];
    read_back(&figure, &expected);

    let diagram = kinds::time_space::input();
    let figure = figures::time_space(&diagram, &context()).unwrap();
    let (first, last) = (0, diagram.ego.x_m.len() - 1);
    let length = diagram.ego.time_s[last] - diagram.ego.time_s[first];
    read_back(
        &figure,
        &[vec![Drawn::Line((0.0, 0.0)), Drawn::Line((length, 0.0))]],
    );
}

#[test]
fn curves_of_congruence_begin_where_they_do_and_mark_ones_own_and_what_is_best() {
    let input = kinds::congruence::input();
    let figure = figures::congruence(&input, &context()).unwrap();
    let expected = input.panels.iter().map(|panel| {
        let lines = panel.curves.iter().flatten();
        let first = |line: &figures::congruence::CongruenceLine| {
            let begins = Drawn::Line(line.points[0]);
            let own = line.at_own.map(|_| Drawn::LineAtX(line.own));
            let best = line.best.map(Drawn::Mark);
            [Some(begins), own, best].into_iter().flatten()
        };
        // The one in the middle is not dashed.
        let whole = panel.curves[1].iter().flat_map(|line| &line.points);
        let whole = whole.copied().map(Drawn::Line);
        lines.flat_map(first).chain(whole).collect()
    });
    read_back(&figure, &expected.collect::<Vec<_>>());
    let best = |panel: usize| {
        let lines = input.panels[panel].curves.iter().flatten();
        lines.filter(|line| line.best.is_some()).count()
    };
    assert_eq!([best(0), best(3)], [3, 0]);
}
