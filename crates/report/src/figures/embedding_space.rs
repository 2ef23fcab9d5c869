//! The style space: who lies where, and which way is "more aggressive".

use super::ConditionLook;
use super::crowd::MOST_POINTS;
use super::embedding_drives::{Palette, norm, paint_condition, paint_point, radius};
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
    let palette = Palette::for_points(&input.points);
    let solid = input.gradient.len() == 3;
    draw(plan(input, palette, context), context, |canvas, whole| {
        let upper = Place { bottom: whole.bottom - 34.0, ..whole };
        let keys = Place { top: upper.bottom, ..whole };
        paint_keys(canvas, keys, input, palette, context);
        let mut plane = upper;
        if solid {
            let split = whole.left + 0.5 * (whole.right - whole.left);
            let left = Place { right: split - 8.0, ..upper };
            paint_solid(canvas, left, input, palette, context);
            plane.left = split + 8.0;
        }
        embedding_plane::paint(canvas, plane, input, palette, context);
    })
}

fn plan(input: &EmbeddingSpace, palette: Palette, context: &Context) -> Plan {
    let unit = context.speed.name();
    let (dimensions, drives) = (input.gradient.len(), input.points.len());
    let solid = dimensions == 3;
    let example = input.example.as_ref().map_or_else(String::new, |example| {
        let ellipse = if example.ellipse.is_empty() {
            ""
        } else {
            "; line: the ellipse across the gradient, one standard deviation wide (in the plane seen edge on, the prediction \
             being the same all round)"
        };
        let participant = markup::literal(&example.participant);
        format!(" Large markers: participant {participant} in each condition{ellipse}.")
    });
    let views = if solid {
        "Left, the three dimensions; right, the plane of the style gradient and of the \
         direction across it in which drivers differ most."
    } else {
        "The plane of the style gradient and of the direction across it in which drivers \
         differ most."
    };
    let many = match (drives > MOST_POINTS, solid) {
        (false, _) => String::new(),
        (true, true) => format!(
            " There being too many for single points, the left shows {} of them, evenly over the list, and the \
             right how many lie where (shade) and their mean velocity (colour).",
            sample(&input.points).count()
        ),
        (true, false) => {
            " There being too many for single points, shades show how many lie where, colours their mean velocity.".to_owned()
        }
    };
    let score = markup::literal(&input.score);
    let [low, high] = palette.ends(context);
    Plan {
        name: NAME.to_owned(),
        size_mm: (if solid { TWO_COLUMNS_MM } else { 110.0 }, 98.0),
        title: "The learned style space".to_owned(),
        caption: format!(
            "Embeddings of size {dimensions}; each point is a drive, its size the driver’s {score}, its colour the mean velocity. {views} Black line: gradient of the style \
             predictor.{example}{many} *n* = {drives} drives; no test."
        ),
        alt: format!(
            "{drives} drives in a style space of {dimensions} dimensions, mean velocity from {low} to {high} {unit}."
        ),
        shows: Shows::Participants,
    }
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
        let expected = format!("{low} to {high} points");
        check.within((low, high), "score_points", [point.score_points], &expected)?;
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
    points.iter().step_by(points.len().div_ceil(MOST_POINTS).max(1))
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
    const PIECES: u32 = 24;
    let cube = |w: &[f64]| [w[0], w[1], w[2]];
    let (unit, centre) = (cube(&input.unit()), cube(&input.centre()));
    let view = View::fit(&input.everything().map(cube).collect::<Vec<_>>(), unit, place);
    paint_box(canvas, &view, ["*w*_{1}", "*w*_{2}", "*w*_{3}"]);
    let mut items: Vec<(f64, (f64, f64), Item<'_>)> = Vec::new();
    let mut add = |w: [f64; 3], nearer: f64, item| {
        let (at, depth) = view.project(w);
        items.push((depth + nearer, at, item));
    };
    for point in sample(&input.points) {
        add(cube(&point.embedding), 0.0, Item::Point(point));
    }
    let (start, end) = view.chord(centre, unit);
    let along = |k: u32| {
        let share = start + (end - start) * f64::from(k) / f64::from(PIECES);
        [0, 1, 2].map(|axis| centre[axis] + share * unit[axis])
    };
    let to = |w: [f64; 3]| view.project(w).0;
    let black = Pen::new(INK, 1.2);
    for k in 0..PIECES {
        add(along(k), 0.0, Item::Piece(to(along(k + 1)), black));
    }
    if let Some(ExampleConditions { ellipse, conditions, .. }) = &input.example {
        let pen = Pen::new(GREEN, stroke::STRONG);
        for (from, next) in ellipse.iter().zip(ellipse.iter().cycle().skip(1)) {
            add(cube(from), 0.0, Item::Piece(to(cube(next)), pen));
        }
        for (condition, w) in conditions {
            add(cube(w), view.size(), Item::Condition(context.look(*condition)));
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
    canvas.arrow(to(along(PIECES - 1)), to(along(PIECES)), black, 6.0);
}

/// Below the panels: conditions, then what the sizes and the colours of the points stand for.
fn paint_keys(
    canvas: &mut Canvas<'_>,
    place: Place,
    input: &EmbeddingSpace,
    palette: Palette,
    context: &Context,
) {
    let first = place.top + 11.0;
    let conditions = input.example.iter().flat_map(|example| &example.conditions);
    let looks = conditions.map(|(condition, _)| context.look(*condition));
    let keys: Vec<(Key, String)> = looks.map(|look| (look.key(), look.label)).collect();
    if !keys.is_empty() {
        canvas.legend_row((place.left, first), &keys);
    }
    let alone = input.gradient.len() == 3 && keys.is_empty();
    let row = if alone { first } else { first + 15.0 };
    let small = Look::new(size::TICK).centred();
    let mut x = place.left;
    let write = |canvas: &mut Canvas<'_>, x: &mut f64, text: &str, look: Look, gap: f64| {
        canvas.text(text, (*x, row), look);
        *x += look.width(text) + gap;
    };
    write(canvas, &mut x, &input.score, small.colour(MUTED), 8.0);
    let ticks = Scale::between(input.score_range.0, input.score_range.1, 4);
    for (score, label) in ticks.ticks.into_iter().zip(ticks.labels) {
        let r = radius(score, input.score_range);
        canvas.disc((x + r, row), r, GREY, 1.0);
        x += 2.0 * r + 2.5;
        write(canvas, &mut x, &label, small, 8.0);
    }
    x += 6.0;
    write(
        canvas,
        &mut x,
        &format!("Mean velocity ({})", context.speed.name()),
        small.colour(MUTED),
        6.0,
    );
    let [low, high] = palette.ends(context);
    write(canvas, &mut x, &low, small, 3.0);
    let width = 68.0_f64.min(place.right - x - small.width(&high) - 4.0);
    let half = cap_height(size::TICK) / 2.0 + 1.0;
    for step in 0..40 {
        let left = x + width * f64::from(step) / 40.0;
        // A hair wider than its step, or the ground shows between the steps.
        let right = left + width / 40.0 + if step < 39 { 0.15 } else { 0.0 };
        let colour = viridis(f64::from(step) / 39.0);
        canvas.fill_rect((left, row - half), (right, row + half), colour, 1.0);
    }
    canvas.text(&high, (x + width + 3.0, row), small);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn space(dimensions: usize) -> EmbeddingSpace {
        let embedding = |seed: usize| -> Vec<f64> {
            (0..dimensions).map(|axis| ((seed * 13 + axis * 7) % 17) as f64 / 5.0 - 1.6).collect()
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
