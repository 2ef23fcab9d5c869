//! The plane of the style gradient and of the direction across it in which drivers differ most.

use super::crowd::{self, MOST_POINTS};
use super::embedding_drives::{
    EmbeddingPoint, EmbeddingSpace, ExampleConditions, Palette, dot, norm, paint_condition,
    paint_point,
};
use super::prelude::*;

/// The unit direction across `unit` in which the points vary most, sign fixed by its largest part.
fn first_perpendicular(points: &[EmbeddingPoint], unit: &[f64]) -> Vec<f64> {
    let d = unit.len();
    let n = points.len() as f64;
    let mean: Vec<f64> = (0..d)
        .map(|axis| {
            points
                .iter()
                .map(|point| point.embedding[axis])
                .sum::<f64>()
                / n
        })
        .collect();
    let across: Vec<Vec<f64>> = points
        .iter()
        .map(|point| {
            let centred: Vec<f64> = point
                .embedding
                .iter()
                .zip(&mean)
                .map(|(w, m)| w - m)
                .collect();
            let along = dot(&centred, unit);
            centred
                .iter()
                .zip(unit)
                .map(|(c, u)| c - along * u)
                .collect()
        })
        .collect();
    let mut best = vec![0.0; d];
    // Power iteration from every axis: a start across the answer would never find it.
    for start in 0..d {
        let mut direction = vec![0.0; d];
        direction[start] = 1.0;
        let mut variance = 0.0;
        for _ in 0..200 {
            let mut next = vec![0.0; d];
            for row in &across {
                let weight = dot(row, &direction);
                for (cell, value) in next.iter_mut().zip(row) {
                    *cell += weight * value;
                }
            }
            variance = norm(&next);
            if variance < 1e-12 {
                break;
            }
            direction = next.iter().map(|x| x / variance).collect();
        }
        let spread = |v: &[f64]| across.iter().map(|row| dot(row, v).powi(2)).sum::<f64>();
        if variance >= 1e-12 && spread(&direction) > spread(&best) * (1.0 + 1e-9) {
            best = direction;
        }
    }
    let largest = best
        .iter()
        .copied()
        .fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
    if largest < 0.0 {
        best.iter().map(|x| -x).collect()
    } else {
        best
    }
}

/// Draws the plane of the gradient and of the axis across it, level with the solid drawing beside it if there is one.
pub(crate) fn paint(
    canvas: &mut Canvas<'_>,
    place: Place,
    input: &EmbeddingSpace,
    palette: Palette,
    context: &Context,
) {
    let solid = input.gradient.len() == 3;
    let length = norm(&input.gradient);
    let unit: Vec<f64> = input.gradient.iter().map(|g| g / length).collect();
    let across = first_perpendicular(&input.points, &unit);
    let at = |w: &[f64]| (dot(w, &unit), dot(w, &across));
    let mut places: Vec<(f64, f64)> = input
        .points
        .iter()
        .map(|point| at(&point.embedding))
        .collect();
    places.extend(
        input
            .example
            .iter()
            .flat_map(ExampleConditions::all)
            .map(at),
    );
    let x = Scale::over(places.iter().map(|place| place.0), 5);
    let y = Scale::over(places.iter().map(|place| place.1), 5);
    let labels = Labels {
        x: "Position on the style line",
        y: "First axis across it",
        ..Labels::default()
    };
    // Level with the box beside it.
    let place = if solid {
        Place {
            top: place.top + 6.0,
            bottom: place.bottom - 4.0,
            ..place
        }
    } else {
        place
    };
    let frame = Frame::draw(canvas, place, &labels, x, y);
    let middle = places[..input.points.len()]
        .iter()
        .map(|place| place.1)
        .sum::<f64>()
        / input.points.len() as f64;
    let y = frame.y.at(middle);
    canvas.arrow(
        (frame.place.left, y),
        (frame.place.right, y),
        Pen::new(INK, 1.2),
        6.0,
    );
    if let Some(example) = &input.example {
        let mut ring: Vec<(f64, f64)> = example
            .ellipse
            .iter()
            .map(|w| at(w))
            .map(|(x, y)| frame.at(x, y))
            .collect();
        ring.extend(ring.first().copied());
        canvas.path(&ring, Pen::new(GREEN, stroke::STRONG));
    }
    if input.points.len() <= MOST_POINTS {
        for point in &input.points {
            let (x, y) = at(&point.embedding);
            paint_point(canvas, frame.at(x, y), point, palette, input.score_range);
        }
    } else {
        let drives = input.points.iter().map(|point| {
            let (x, y) = at(&point.embedding);
            (x, y, point.mean_velocity_mps)
        });
        let cells = crowd::cells(&frame, drives);
        let most = cells.iter().map(|cell| cell.count).max().unwrap_or(1);
        for cell in &cells {
            let (a, b) = cell.corners(&frame);
            canvas.fill_rect(
                a,
                b,
                palette.of(cell.mean()),
                crowd::shade(cell.count, most),
            );
        }
    }
    for (condition, w) in input.example.iter().flat_map(|e| &e.conditions) {
        let (x, y) = at(w);
        paint_condition(canvas, frame.at(x, y), &context.look(*condition));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_axis_is_across_the_gradient() {
        let point = |seed: usize| EmbeddingPoint {
            embedding: (0..5)
                .map(|axis| ((seed * 13 + axis * 7) % 17) as f64)
                .collect(),
            score_points: 20.0,
            mean_velocity_mps: 28.0,
        };
        let points: Vec<EmbeddingPoint> = (0..20).map(point).collect();
        let unit: Vec<f64> = vec![1.0 / 5f64.sqrt(); 5];
        let across = first_perpendicular(&points, &unit);
        assert!(dot(&across, &unit).abs() < 1e-9);
        assert!((norm(&across) - 1.0).abs() < 1e-9);
    }
}
