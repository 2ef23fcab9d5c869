//! Lines and curves.

use super::*;

#[test]
fn lines_begin_and_end_where_their_numbers_do() {
    let training = kinds::training_curves::input();
    let figure = figures::training_curves(&training, &context()).unwrap();
    let logarithmic = |values: &[f64]| values.iter().any(|v| v * 10.0 < values[0]);
    let terms = panels(&figure.svg).into_iter().zip(&training.terms);
    let mut read = 0;
    for (panel, term) in terms.filter(|(_, term)| !logarithmic(&term.train)) {
        let epochs = term.train.len();
        for point in [(1.0, term.train[0]), (epochs as f64, term.train[epochs - 1])] {
            Drawn::Line(point).check(&panel, &term.title);
            read += 1;
        }
    }
    assert!(read > 3);

    let drive = kinds::car_following::input();
    let figure = figures::car_following(&drive, &context()).unwrap();
    let time: Vec<f64> = drive.time_s.iter().map(|t| t - drive.time_s[0]).collect();
    let recorded = &drive.series[0];
    let first = |values: &[f64]| vec![Drawn::Line((0.0, values[0]))];
    assert!(time.len() > 800, "long enough to be thinned");
    read_back(&figure, &[first(&recorded.gap_m), first(&recorded.speed_mps)]);

    let overview = kinds::drive_overview::input();
    let figure = figures::drive_overview(&overview, &context()).unwrap();
    let time: Vec<f64> = overview.time_s.iter().map(|t| t - overview.time_s[0]).collect();
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
    read_back(&figure, &[vec![Drawn::Line((0.0, 0.0)), Drawn::Line((length, 0.0))]]);
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
