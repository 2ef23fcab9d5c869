//! Ten thousand participants: a density instead of points, in a file of bounded size, and a caption that says so.

use crate::kinds;
use crate::kinds::wobble;
use maveric_report::{Context, Figure, figures};

const MANY: usize = 10_000;

/// The list over and over again, each turn moved a little.
fn grown<T: Clone>(list: &[T], vary: impl Fn(&mut T, f64)) -> Vec<T> {
    let turn = |k: usize| {
        let mut item = list[k % list.len()].clone();
        vary(&mut item, 1.0 + 0.2 * wobble(k, 77));
        item
    };
    (0..MANY).map(turn).collect()
}

fn numbers(list: &[f64]) -> Vec<f64> {
    grown(list, |value, by| *value *= by)
}

fn options(list: &[Option<f64>]) -> Vec<Option<f64>> {
    grown(list, |value, by| {
        if let Some(value) = value {
            *value *= by;
        }
    })
}

fn context() -> Context {
    Context::synthetic(7)
}

fn crowds() -> Vec<Figure> {
    let mut line = kinds::aggression_line::input();
    for panel in &mut line.panels {
        panel.points = grown(&panel.points, |p, by| *p = (p.0 * by, p.1 * by));
    }
    let mut differences = kinds::difference_panels::input();
    for panel in &mut differences.panels {
        panel.rows = grown(&panel.rows, |row, by| {
            row.iter_mut().flatten().for_each(|value| *value *= by);
        });
    }
    let mut space = kinds::embedding_space::input();
    space.points = grown(&space.points, |p, by| {
        p.embedding.iter_mut().for_each(|w| *w *= by);
    });
    let mut flat = space.clone();
    flat.points.iter_mut().for_each(|p| p.embedding.truncate(2));
    flat.gradient.truncate(2);
    flat.example = None;
    let mut round = kinds::perpendicular::input();
    for panel in &mut round.panels {
        panel.points = grown(&panel.points, |p, by| {
            p.angle_rad *= by;
            p.change *= by;
        });
    }
    let mut sweep = kinds::dial_sweep::input();
    for panel in &mut sweep.panels {
        panel.drivers = grown(&panel.drivers, |values, by| {
            values.iter_mut().flatten().for_each(|value| *value *= by);
        });
    }
    let mut errors = kinds::following_errors::input();
    errors.drivers = (0..MANY).map(|i| format!("driver {i}")).collect();
    for model in &mut errors.models {
        model.gap_rmse_m = numbers(&model.gap_rmse_m);
    }
    vec![
        figures::aggression_line(&line, &context()).unwrap(),
        figures::difference_panels(&differences, &context()).unwrap(),
        figures::embedding_space(&space, &context()).unwrap(),
        figures::embedding_space(&flat, &context()).unwrap(),
        figures::perpendicular(&round, &context()).unwrap(),
        figures::dial_sweep(&sweep, &context()).unwrap(),
        figures::following_errors(&errors, &context()).unwrap(),
    ]
}

#[test]
fn a_crowd_is_a_density_and_the_caption_says_so() {
    for figure in crowds() {
        let size = figure.svg.len();
        assert!(size < 450_000, "{}: {size} bytes", figure.name);
        let points = figure.svg.matches("<circle").count();
        assert!(points < 1_000, "{}: {points} circles", figure.name);
        let words = ["too many", "Shade", "first 120 drivers", "nine in ten", "middle half"];
        assert!(
            words.iter().any(|word| figure.caption.contains(word)),
            "{}: {}",
            figure.name,
            figure.caption
        );
    }
}

#[test]
fn means_of_a_crowd_grow_no_picture() {
    let mut variants = kinds::ablation::input();
    for values in variants.variants.iter_mut().flat_map(|v| &mut v.losses) {
        *values = options(values);
    }
    let mut bars = kinds::preference::input();
    bars.scales.iter_mut().for_each(|scale| scale.n = MANY);
    for figure in [
        figures::ablation(&variants, &context()).unwrap(),
        figures::preference(&bars, &context()).unwrap(),
    ] {
        assert!(figure.svg.len() < 40_000, "{}: {} bytes", figure.name, figure.svg.len());
    }
}

#[test]
fn a_long_drive_in_dense_traffic_is_thinned_and_what_is_left_out_is_counted() {
    let mut drive = kinds::time_space::input();
    let other = drive.others[0].clone();
    drive.others = vec![other; MANY];
    let figure = figures::time_space(&drive, &context()).unwrap();
    assert!(figure.svg.len() < 1_200_000, "{} bytes", figure.svg.len());
    assert!(figure.caption.contains("9880 more vehicles are left out"), "{}", figure.caption);
}
