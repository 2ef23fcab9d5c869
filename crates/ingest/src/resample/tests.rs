use super::*;

fn stamps(time_s: &[f64]) -> Vec<i64> {
    time_s.iter().map(|t| (t * 1e9).round() as i64).collect()
}

fn resampled(hz: f64, jitter: f64, signal: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let time: Vec<f64> = (0..(10.0 * hz) as usize)
        .map(|i| (i as f64 + jitter * (i as f64 * 1.7).sin()) / hz)
        .collect();
    let values: Vec<f64> = time.iter().map(|t| signal(*t)).collect();
    let grid = grid(&time, 20.0, 0.5);
    let found = speeds(&stamps(&time), &values, &grid, 20.0, 0.5);
    let at = grid.rows.iter().map(|r| r.tick as f64 / 20.0);
    at.zip(found).collect()
}

fn largest(found: &[(f64, f64)], wrong: impl Fn(f64, f64) -> f64) -> f64 {
    let inner = found.iter().filter(|(t, _)| (0.5..9.4).contains(t));
    inner.map(|&(t, v)| wrong(t, v).abs()).fold(0.0, f64::max)
}

#[test]
fn what_would_alias_is_gone_and_what_drivers_do_is_kept() {
    for (hz, jitter, most) in [(100.0, 0.0, 0.01), (83.0, 0.05, 0.02), (83.0, 0.3, 0.1)] {
        let at = |f: f64| move |t: f64| (2.0 * PI * f * t).sin();
        let alias = largest(&resampled(hz, jitter, at(18.0)), |_, v| v);
        assert!(alias < most, "18 Hz would look like 2 Hz: {alias} at {hz} Hz");
        let kept = resampled(hz, jitter, at(1.0));
        let lost = largest(&kept, |t, v| v - at(1.0)(t));
        assert!(lost < 0.01, "1 Hz: {lost} at {hz} Hz");
    }
}

#[test]
fn the_kernel_by_pieces_is_the_kernel() {
    for i in -40_000..=40_000 {
        let steps = f64::from(i) * 1e-4;
        let direct = kernel(steps, 4.0);
        let found = at_full_width(steps);
        assert!((found - direct).abs() < 1e-10, "{steps}: {found} {direct}");
    }
}

#[test]
fn a_row_knows_of_the_samples_around_it_alone() {
    // Steps of several lengths in turn, and rows between samples.
    let steps_ms = [10, 7, 10, 11, 9, 10, 3];
    let step = |i: usize| steps_ms[i / 70 % 7] + i64::from(i.is_multiple_of(5) && i / 490 == 1);
    let stamps: Vec<i64> = (0..1_400)
        .scan(0, |at, i| {
            *at += step(i) * 1_000_000;
            Some(*at)
        })
        .collect();
    let rows = |stamps: &[i64]| -> Vec<(i64, u64)> {
        let time: Vec<f64> = stamps.iter().map(|t| *t as f64 / 1e9).collect();
        let values: Vec<f64> = time.iter().map(|t| 30.0 + (3.0 * t).sin()).collect();
        let grid = grid(&time, 20.0, 0.5);
        let found = speeds(stamps, &values, &grid, 20.0, 0.5);
        let ticks = grid.rows.iter().map(|r| r.tick);
        ticks.zip(found.iter().map(|v| v.to_bits())).collect()
    };
    let all = rows(&stamps);
    for &(tick, value) in &all[20..all.len() - 20] {
        let near = |t: &i64| (t - tick * 50_000_000).abs() < 600_000_000;
        let around: Vec<i64> = stamps.iter().copied().filter(near).collect();
        assert!(rows(&around).contains(&(tick, value)), "row {tick}");
    }
}

#[test]
fn a_steady_speed_and_a_steady_acceleration_come_through_to_both_ends() {
    for (t, v) in resampled(100.0, 0.0, |t| 5.0 + 2.0 * t) {
        assert!((v - 5.0 - 2.0 * t).abs() < 1e-6, "{t}: {v}");
    }
    for (_, v) in resampled(83.0, 0.4, |_| 7.0) {
        assert!((v - 7.0).abs() < 1e-12);
    }
}

#[test]
fn slow_sources_are_interpolated_and_a_burst_counts_once() {
    let found = resampled(10.0, 0.0, |t| t);
    assert!(largest(&found, |t, v| v - t) < 1e-9);
    // Ten samples within a microsecond at 5 s, far off: one bad sample's worth, not ten.
    let mut time: Vec<f64> = (0..1000).map(|i| f64::from(i) / 100.0).collect();
    let mut values = vec![10.0; 1000];
    for i in 0..10 {
        time.insert(501 + i, 5.0 + 1e-7 * (i + 1) as f64);
        values.insert(501 + i, 20.0);
    }
    let grid = grid(&time, 20.0, 0.5);
    let found = speeds(&stamps(&time), &values, &grid, 20.0, 0.5);
    let most = found.iter().copied().fold(0.0, f64::max);
    assert!(most < 11.5, "{most}");
}

#[test]
fn labels_are_those_of_the_sample_before() {
    let time = [0.0, 0.07, 0.1];
    let lanes = [0.0, 1.0, 2.0];
    let grid = grid(&time, 20.0, 0.5);
    let held: Vec<f64> = grid.rows.iter().map(|r| r.across(&lanes, true)).collect();
    assert_eq!(held, [0.0, 0.0, 2.0]);
}

#[test]
fn samples_on_the_grid_come_through_unchanged() {
    let time: Vec<f64> = (0..40).map(|i| f64::from(i) * 0.05 + 2e-10).collect();
    let grid = grid(&time, 20.0, 0.5);
    assert_eq!(grid.rows.len(), 40);
    assert!(grid.rows.iter().enumerate().all(|(i, r)| r.before == i && r.weight.to_bits() == 0));
}

#[test]
fn rows_that_another_grid_lacks_are_left_out_and_segments_are_those_of_both() {
    let at = |times: &[f64]| grid(times, 10.0, 0.5);
    let times: Vec<f64> = (0..30).map(|i| f64::from(i) / 10.0).collect();
    let mut rows = at(&[&times[..10], &times[20..]].concat());
    rows.keep(&at(&[&times[3..6], &times[12..28]].concat()));
    let found: Vec<(i64, u32)> = rows.rows.iter().map(|r| (r.tick, r.segment)).collect();
    let expected = (3..6).map(|t| (t, 0)).chain((20..28).map(|t| (t, 1)));
    assert_eq!(found, expected.collect::<Vec<_>>());
}

#[test]
fn short_dropouts_are_bridged_and_long_ones_start_a_segment() {
    let time = [0.0, 0.1, 0.5, 2.0, 2.1];
    let grid = grid(&time, 10.0, 0.5);
    let ticks: Vec<(i64, u32)> = grid.rows.iter().map(|r| (r.tick, r.segment)).collect();
    let expected = [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (5, 0), (20, 1), (21, 1)];
    assert_eq!(ticks, expected);
    assert_eq!(grid.holes_s, [(0.5, 2.0)]);
    assert!((grid.rows[3].interpolated(&time) - 0.3).abs() < 1e-12);
}
