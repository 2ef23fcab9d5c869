//! Two columns against each other: a scatter with its line, or a line a person.

use super::Picture;
use maveric_report::figures::scatter::Scatter;

fn complete(x: &[Option<f64>], y: &[Option<f64>]) -> Vec<(f64, f64)> {
    x.iter().zip(y).filter_map(|(x, y)| Some(((*x)?, (*y)?))).collect()
}

/// A correlation: points, line, band.
pub(in crate::stages::stats) fn correlation(
    (x_name, x): (&str, &[Option<f64>]),
    (y_name, y): (&str, &[Option<f64>]),
    test: String,
) -> Picture {
    Picture::Scatter(Scatter {
        x: x_name.to_owned(),
        y: y_name.to_owned(),
        points: complete(x, y),
        test,
        people: Vec::new(),
    })
}

/// A correlation within people: parallel lines of the common slope.
pub(in crate::stages::stats) fn within_people(
    subjects: &[String],
    (x_name, x): (&str, &[Option<f64>]),
    (y_name, y): (&str, &[Option<f64>]),
    slope: Option<f64>,
    test: String,
) -> Picture {
    let mut people: Vec<(&str, Vec<(f64, f64)>)> = Vec::new();
    for (who, point) in subjects.iter().zip(x.iter().zip(y)) {
        let (Some(x), Some(y)) = point else { continue };
        match people.iter_mut().find(|(known, _)| known == who) {
            Some((_, points)) => points.push((*x, *y)),
            None => people.push((who, vec![(*x, *y)])),
        }
    }
    let line = |points: &Vec<(f64, f64)>| {
        let n = points.len() as f64;
        let (mx, my) = points.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
        let ends = |f: fn(f64, f64) -> f64, start: f64| points.iter().map(|p| p.0).fold(start, f);
        let point_at = |x: f64| Some((x, my + slope? * (x - mx)));
        Some([
            point_at(ends(f64::min, f64::INFINITY))?,
            point_at(ends(f64::max, f64::NEG_INFINITY))?,
        ])
    };
    Picture::Scatter(Scatter {
        x: x_name.to_owned(),
        y: y_name.to_owned(),
        points: complete(x, y),
        test,
        people: people.iter().filter_map(|(_, points)| line(points)).collect(),
    })
}
