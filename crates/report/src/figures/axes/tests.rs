use super::*;

#[test]
fn numbers_have_a_true_minus_and_no_negative_zero() {
    assert_eq!(number(-1.25, 1), "−1.2");
    assert_eq!(number(-0.001, 1), "0.0");
    assert_eq!(number(12.0, 0), "12");
}

#[test]
fn equal_values_get_a_range_around_them() {
    let scale = Scale::over([5.0, 5.0], 4).placed(0.0, 100.0);
    assert!((scale.at(5.0) - 50.0).abs() < 1e-9);
    let zero = Scale::over([0.0], 4).placed(0.0, 100.0);
    assert!((zero.at(0.0) - 50.0).abs() < 1e-9);
}

#[test]
fn ticks_are_round_and_inside() {
    let scale = Scale::between(-0.37, 1.18, 4);
    assert_eq!(scale.labels, ["0.0", "0.5", "1.0"]);
    assert_eq!(Scale::between(0.0, 100.0, 5).labels, ["0", "20", "40", "60", "80", "100"]);
}

#[test]
fn a_short_logarithmic_scale_has_ticks_between_the_powers() {
    let scale = Scale::log_over([0.3, 2.1]);
    assert_eq!(scale.labels, ["0.5", "1", "2"]);
}

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9, "{found} instead of {expected}");
}

#[test]
fn a_scale_reaches_a_little_beyond_its_values_and_lies_where_it_is_placed() {
    let scale = Scale::over([30.0, 10.0, 20.0], 4).placed(100.0, 300.0);
    close(scale.low, 9.2);
    close(scale.high, 30.8);
    close(scale.at(9.2), 100.0);
    close(scale.at(30.8), 300.0);
    close(scale.at(20.0), 200.0);
    // Upwards on the page: the greater value the nearer to the top.
    let up = Scale::between(0.0, 10.0, 5).placed(80.0, 30.0);
    close(up.at(2.0), 70.0);
    let log = Scale::log_over([1.0, 100.0]).placed(0.0, 1.1);
    close(log.at(1.0), 0.05);
    close(log.at(10.0), 0.55);
    close(log.at(100.0), 1.05);
    assert_eq!(log.labels, ["1", "10", "100"]);
}

#[test]
fn a_range_that_is_none_is_given_one() {
    for ((low, high), (from, to)) in [
        ((0.0, 0.0), (-1.0, 1.0)),
        ((1e-10, 1e-10), (-1.0, 1.0)),
        ((100.0, 100.0), (95.0, 105.0)),
        ((-100.0, -100.0), (-105.0, -95.0)),
        ((100.0, 100.0 + 1e-8), (95.0, 105.0)),
        ((100.0, 101.0), (100.0, 101.0)),
        ((0.0, 1e-6), (0.0, 1e-6)),
        ((-1.0, 2.0), (-1.0, 2.0)),
        ((f64::INFINITY, f64::NEG_INFINITY), (0.0, 1.0)),
        ((0.0, f64::INFINITY), (0.0, 1.0)),
    ] {
        let found = widened(low, high);
        assert!(
            (found.0 - from).abs() < 1e-7 && (found.1 - to).abs() < 1e-7,
            "{low} {high}: {found:?}"
        );
    }
}

#[test]
fn steps_are_the_nearest_of_one_two_five_and_ten() {
    for (rough, step) in [
        (1.0, 1.0),
        (1.49, 1.0),
        (1.5, 2.0),
        (3.19, 2.0),
        (3.2, 5.0),
        (7.09, 5.0),
        (7.1, 10.0),
        (9.9, 10.0),
        (0.034, 0.05),
        (140.0, 100.0),
    ] {
        let found = nice_step(rough);
        assert!((found / step - 1.0).abs() < 1e-12, "{rough}: {found}");
    }
    let scale = Scale::between(0.0, 1.0, 5);
    assert_eq!(scale.labels, ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
    let scale = Scale::between(-30.0, 45.0, 4);
    assert_eq!(scale.labels, ["−20", "0", "20", "40"]);
    assert_eq!(Scale::between(0.0, 10.0, 0).ticks, [0.0, 10.0]);
}
