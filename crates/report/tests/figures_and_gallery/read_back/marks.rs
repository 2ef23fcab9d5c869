//! Points, upright intervals, bars, boxes and clouds.

use super::*;

fn interval(x: f64, [value, low, high]: [f64; 3]) -> [Drawn; 3] {
    [Drawn::Mark((x, value)), Drawn::Line((x, low)), Drawn::Line((x, high))]
}

#[test]
fn points_lie_where_both_their_numbers_say() {
    let marks = |points: &[Point]| points.iter().copied().map(Drawn::Mark).collect::<Vec<_>>();
    let scatter = kinds::scatter::input();
    let figure = figures::scatter(&scatter, &context()).unwrap();
    read_back(&figure, &[marks(&scatter.points)]);

    let line = kinds::aggression_line::input();
    let figure = figures::aggression_line(&line, &context()).unwrap();
    let expected: Vec<_> = line.panels.iter().map(|panel| marks(&panel.points)).collect();
    read_back(&figure, &expected);

    let round = kinds::perpendicular::input();
    let figure = figures::perpendicular(&round, &context()).unwrap();
    let place = |p: &figures::perpendicular::AngleChange| {
        Drawn::Mark((p.angle_rad.to_degrees().rem_euclid(360.0), p.change))
    };
    let expected: Vec<Vec<_>> =
        round.panels.iter().map(|panel| panel.points.iter().map(place).collect()).collect();
    read_back(&figure, &expected);
}

#[test]
fn upright_intervals_have_their_mark_and_both_their_ends() {
    let curves = kinds::curves::input();
    let figure = figures::curves(&curves, &context()).unwrap();
    let expected = curves.panels.iter().map(|panel| {
        let points = panel.curves.iter().flatten();
        points.flat_map(|p| interval(p.x, [p.y, p.low, p.high])).collect()
    });
    read_back(&figure, &expected.collect::<Vec<_>>());

    let learning = kinds::learning_curve::input();
    let figure = figures::learning_curve(&learning, &context()).unwrap();
    let expected = learning.panels.iter().map(|panel| {
        let points = panel.points.iter();
        points.flat_map(|p| interval(p.minutes, [p.mean, p.low, p.high])).collect()
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
        let whole: Vec<Vec<f64>> =
            panel.drivers.iter().filter_map(|d| d.iter().copied().collect()).collect();
        let mean = |step: usize| whole.iter().map(|d| d[step]).sum::<f64>() / whole.len() as f64;
        let means =
            sweep.points.iter().enumerate().map(|(step, at)| Drawn::Mark((*at, mean(step))));
        means.collect()
    });
    read_back(&figure, &expected.collect::<Vec<_>>());
}

#[test]
fn bars_boxes_and_clouds_reach_as_far_as_their_numbers() {
    let bars = kinds::preference::input();
    let figure = figures::preference(&bars, &context()).unwrap();
    let shares = bars
        .scales
        .iter()
        .flat_map(|scale| scale.above.iter().map(|k| 100.0 * *k as f64 / scale.n as f64));
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
        let means = panel.cells.iter().filter_map(|cell| cell.mean).map(|mean| mean[0]);
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
