//! The style space: who lies where, and which way is "more aggressive".

use super::ConditionLook;
use super::crowd::MOST_POINTS;
use super::embedding_drives::{MPH_PER_MPS, Palette, norm, paint_condition, paint_point, radius};
use super::embedding_plane;
use super::prelude::*;
use super::projection::{View, paint_box};
use super::theme::viridis;

pub use super::embedding_drives::{EmbeddingPoint, EmbeddingSpace, ExampleConditions};

const NAME: &str = "embedding-space";
/// Draws the space in three dimensions, if it has three, and the plane of the style gradient against the
/// first axis perpendicular to it.
///
/// # Errors
/// [`ReportError`] if there is nobody, sizes differ, the gradient is zero, or a value is not
/// finite.
///
/// # Source
/// The paper's figure of the embedding space; method, sections 4 and 9.1. The plane is ours.
pub fn embedding_space(input: &EmbeddingSpace, context: &Context) -> Result<Figure, ReportError> {
    check(input)?;
    let dimensions = input.gradient.len();
    let solid = dimensions == 3;
    let example = match &input.example {
        Some(example) => format!(
            " Large markers: participant {} in each condition{}.",
            crate::markup::literal(&example.participant),
            if example.ellipse.is_empty() {
                ""
            } else {
                "; line: the ellipse across the gradient, one standard deviation wide (in the plane seen edge on, the prediction \
                 being the same all round)"
            }
        ),
        None => String::new(),
    };
    let views = if solid {
        "Left, the three dimensions; right, the plane of the style gradient and of the \
         direction across it in which drivers differ most."
    } else {
        "The plane of the style gradient and of the direction across it in which drivers \
         differ most."
    };
    let drawn = sample(&input.points).count();
    let many = match (input.points.len() > MOST_POINTS, solid) {
        (false, _) => String::new(),
        (true, true) => format!(
            " There being too many for single points, the left shows {drawn} of them, evenly over the list, and the \
             right how many lie where (shade) and their mean velocity (colour)."
        ),
        (true, false) => {
            " There being too many for single points, shades show how many lie where, colours their mean velocity.".to_owned()
        }
    };
    let low = input
        .points
        .iter()
        .map(|p| p.mean_velocity_mps)
        .fold(f64::INFINITY, f64::min);
    let high = input
        .points
        .iter()
        .map(|p| p.mean_velocity_mps)
        .fold(f64::NEG_INFINITY, f64::max);
    let plan = Plan {
        name: NAME.to_owned(),
        size_mm: if solid {
            (TWO_COLUMNS_MM, 98.0)
        } else {
            (110.0, 98.0)
        },
        title: "The learned style space".to_owned(),
        caption: format!(
            "Embeddings of size {dimensions}; each point is a drive, its size the driver’s {score}, its colour the mean velocity. {views} Black line: gradient of the style \
             predictor.{example}{many} *n* = {} drives; no test.",
            input.points.len(),
            score = crate::markup::literal(&input.score),
        ),
        alt: format!(
            "{} drives in a style space of {dimensions} dimensions, mean velocity from {} to {} mph.",
            input.points.len(),
            number(low * MPH_PER_MPS, 1),
            number(high * MPH_PER_MPS, 1)
        ),
        shows: Shows::Participants,
    };
    let palette = Palette {
        low: low * MPH_PER_MPS,
        high: high * MPH_PER_MPS,
    };
    draw(plan, context, |canvas, whole| {
        let foot = 34.0;
        let upper = Place {
            bottom: whole.bottom - foot,
            ..whole
        };
        paint_keys(
            canvas,
            Place {
                top: upper.bottom,
                ..whole
            },
            input,
            palette,
            context,
        );
        let mut plane = upper;
        if solid {
            let split = whole.left + 0.5 * (whole.right - whole.left);
            paint_solid(
                canvas,
                Place {
                    right: split - 8.0,
                    ..upper
                },
                input,
                palette,
                context,
            );
            plane.left = split + 8.0;
        }
        embedding_plane::paint(canvas, plane, input, palette, context);
    })
}

fn check(input: &EmbeddingSpace) -> Result<(), ReportError> {
    let check = Check(NAME);
    let dimensions = input.gradient.len();
    check.at_least(1, "dimensions", dimensions)?;
    check.at_least(1, "drives", input.points.len())?;
    check.finite("gradient", input.gradient.iter().copied())?;
    let length = norm(&input.gradient);
    check.that(length > 0.0, "gradient", length, "a length above 0")?;
    for point in &input.points {
        check.length("an embedding", point.embedding.len(), dimensions)?;
        check.finite("embedding", point.embedding.iter().copied())?;
        check.finite("score_points", [point.score_points])?;
        let (low, high) = input.score_range;
        check.that(
            (low..=high).contains(&point.score_points),
            "score_points",
            point.score_points,
            &format!("{low} to {high} points"),
        )?;
        check.finite("mean_velocity_mps", [point.mean_velocity_mps])?;
    }
    for place in input.example.iter().flat_map(ExampleConditions::all) {
        check.length("an example's embedding", place.len(), dimensions)?;
        check.finite("an example's embedding", place.iter().copied())?;
    }
    Ok(())
}

/// All points, or at most [`MOST_POINTS`] of them, evenly over the list.
fn sample(points: &[EmbeddingPoint]) -> impl Iterator<Item = &EmbeddingPoint> {
    points
        .iter()
        .step_by(points.len().div_ceil(MOST_POINTS).max(1))
}

enum Item<'a> {
    Point(&'a EmbeddingPoint),
    Piece((f64, f64), Pen),
    Condition(ConditionLook),
}

fn paint_solid(
    canvas: &mut Canvas<'_>,
    place: Place,
    input: &EmbeddingSpace,
    palette: Palette,
    context: &Context,
) {
    let cube = |w: &[f64]| [w[0], w[1], w[2]];
    let gradient = cube(&input.gradient);
    let length = norm(&gradient);
    let unit = gradient.map(|g| g / length);
    let everything = || {
        let example = input.example.iter().flat_map(ExampleConditions::all);
        input
            .points
            .iter()
            .map(|point| point.embedding.as_slice())
            .chain(example)
    };
    let view = View::fit(&everything().map(cube).collect::<Vec<_>>(), unit, place);
    paint_box(canvas, &view, ["*w*_{1}", "*w*_{2}", "*w*_{3}"]);
    let mut items: Vec<(f64, (f64, f64), Item<'_>)> = Vec::new();
    let placed = |w: [f64; 3], nearer: f64| {
        let (at, depth) = view.project(w);
        (depth + nearer, at)
    };
    for point in sample(&input.points) {
        let (depth, at) = placed(cube(&point.embedding), 0.0);
        items.push((depth, at, Item::Point(point)));
    }
    let n = input.points.len() as f64;
    let centre: [f64; 3] = [0, 1, 2].map(|axis| {
        input
            .points
            .iter()
            .map(|point| point.embedding[axis])
            .sum::<f64>()
            / n
    });
    let (start, end) = view.chord(centre, unit);
    let pieces: u32 = 24;
    let along = |k: u32| {
        let share = start + (end - start) * f64::from(k) / f64::from(pieces);
        [0, 1, 2].map(|axis| centre[axis] + share * unit[axis])
    };
    for k in 0..pieces {
        let (depth, at) = placed(along(k), 0.0);
        items.push((
            depth,
            at,
            Item::Piece(view.project(along(k + 1)).0, Pen::new(INK, 1.2)),
        ));
    }
    if let Some(example) = &input.example {
        let pen = Pen::new(GREEN, stroke::STRONG);
        for (k, w) in example.ellipse.iter().enumerate() {
            let next = &example.ellipse[(k + 1) % example.ellipse.len()];
            let (depth, at) = placed(cube(w), 0.0);
            items.push((depth, at, Item::Piece(view.project(cube(next)).0, pen)));
        }
        for (condition, w) in &example.conditions {
            let (depth, at) = placed(cube(w), view.size());
            items.push((depth, at, Item::Condition(context.look(*condition))));
        }
    }
    items.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, at, item) in items {
        match item {
            Item::Point(point) => paint_point(canvas, at, point, palette, input.score_range),
            Item::Piece(to, pen) => canvas.line(at, to, pen),
            Item::Condition(look) => paint_condition(canvas, at, &look),
        }
    }
    // The end of the line that means more.
    let (tail, tip) = (
        view.project(along(pieces - 1)).0,
        view.project(along(pieces)).0,
    );
    canvas.arrow(tail, tip, Pen::new(INK, 1.2), 6.0);
}

fn paint_keys(
    canvas: &mut Canvas<'_>,
    place: Place,
    input: &EmbeddingSpace,
    palette: Palette,
    context: &Context,
) {
    let solid = input.gradient.len() == 3;
    let first = place.top + 11.0;
    let second = place.top + 26.0;
    let small = Look::new(size::TICK);
    let mut x = place.left;
    let looks: Vec<ConditionLook> = input
        .example
        .iter()
        .flat_map(|e| &e.conditions)
        .map(|(c, _)| context.look(*c))
        .collect();
    if !looks.is_empty() {
        let key =
            |look: &ConditionLook| (Key::Point(look.marker(), look.rgb()), look.label.clone());
        canvas.legend_row((x, first), &looks.iter().map(key).collect::<Vec<_>>());
    }
    let row = if solid && looks.is_empty() {
        first
    } else {
        second
    };
    let title = input.score.as_str();
    canvas.text(title, (x, row), small.centred().colour(MUTED));
    x += small.width(title) + 8.0;
    let (low, high) = input.score_range;
    let ticks = Scale::between(low, high, 4);
    for (score, label) in ticks.ticks.into_iter().zip(ticks.labels) {
        let r = radius(score, input.score_range);
        canvas.disc((x + r, row), r, GREY, 1.0);
        x += 2.0 * r + 2.5;
        canvas.text(&label, (x, row), small.centred());
        x += small.width(&label) + 8.0;
    }
    let title = "Mean velocity (mph)";
    x += 6.0;
    canvas.text(title, (x, row), small.centred().colour(MUTED));
    x += small.width(title) + 6.0;
    let ends = [number(palette.low, 1), number(palette.high, 1)];
    canvas.text(&ends[0], (x, row), small.centred());
    x += small.width(&ends[0]) + 3.0;
    let width = 68.0_f64.min(place.right - x - small.width(&ends[1]) - 4.0);
    let half = cap_height(size::TICK) / 2.0 + 1.0;
    for step in 0..40 {
        let left = x + width * f64::from(step) / 40.0;
        // A hair wider than its step, or the ground shows between the steps.
        let right = left + width / 40.0 + if step < 39 { 0.15 } else { 0.0 };
        canvas.fill_rect(
            (left, row - half),
            (right, row + half),
            viridis(f64::from(step) / 39.0),
            1.0,
        );
    }
    canvas.text(&ends[1], (x + width + 3.0, row), small.centred());
}

#[cfg(test)]
mod tests {
    use super::*;

    fn space(dimensions: usize) -> EmbeddingSpace {
        let embedding = |seed: usize| -> Vec<f64> {
            (0..dimensions)
                .map(|axis| ((seed * 13 + axis * 7) % 17) as f64 / 5.0 - 1.6)
                .collect()
        };
        let points = (0..20)
            .map(|seed| EmbeddingPoint {
                embedding: embedding(seed),
                score_points: 11.0 + (seed * 2) as f64,
                mean_velocity_mps: 24.0 + seed as f64 * 0.3,
            })
            .collect();
        EmbeddingSpace {
            points,
            gradient: vec![1.0; dimensions],
            score_range: (11.0, 55.0),
            score: "score".into(),
            example: None,
        }
    }

    #[test]
    fn every_size_of_embedding_makes_a_picture() {
        for dimensions in [1, 2, 3, 5, 8] {
            let figure = embedding_space(&space(dimensions), &Context::real()).unwrap();
            assert!(figure.svg.matches("<circle").count() >= 20);
        }
    }

    #[test]
    fn a_gradient_of_zero_is_refused() {
        let mut input = space(3);
        input.gradient = vec![0.0; 3];
        let refused = embedding_space(&input, &Context::real());
        assert!(matches!(refused, Err(ReportError::OutOfRange { .. })));
    }

    #[test]
    fn a_score_outside_the_scale_is_refused() {
        let mut input = space(3);
        input.points[4].score_points = 60.0;
        assert!(embedding_space(&input, &Context::real()).is_err());
    }
}
