//! Accuracies of drivers who drove twice, and of Mimic.

use super::{PARTICIPANTS, wobble};
use maveric_report::{
    Context, Figure, ReportError,
    figures::test_retest::{RetestMeasure, TestRetest, test_retest},
};

pub(crate) fn draw(context: &Context) -> Result<Figure, ReportError> {
    test_retest(&input(), context)
}

pub(crate) fn input() -> TestRetest {
    let measure = |(k, title): (usize, &str)| RetestMeasure {
        title: title.into(),
        drivers: (0..PARTICIPANTS)
            .map(|i| {
                let own = 0.97 - 0.04 * k as f64 + 0.05 * wobble(i, k);
                let mimic = own - 0.02 + 0.04 * wobble(i, 30 + k);
                // Two never merged back.
                (Some(own), (k != 2 || i > 1).then_some(mimic))
            })
            .collect(),
    };
    let titles = [
        "Mean velocity",
        "Mean headway time",
        "Distance headway merge back",
        "Number of lane changes",
        "Time headway merge back",
    ];
    TestRetest {
        measures: titles.into_iter().enumerate().map(measure).collect(),
    }
}
