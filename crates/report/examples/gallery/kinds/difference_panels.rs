//! Six measures in four conditions, with their tests.

use super::{PARTICIPANTS, conditions, wobble};
use maveric_report::apa;
use maveric_report::figures::difference_panels::{DifferencePanel, DifferencePanels, PairTest};

pub(crate) fn input() -> DifferencePanels {
    let omnibus = apa::f(&apa::F {
        f: 25.23,
        df_effect: 2.76,
        df_error: 63.49,
        p: 1e-9,
        eta2_partial: Some(0.52),
        eta2_partial_ci90: maveric_stats::Interval::default(),
        epsilon: Some(0.92),
    });
    let friedman = apa::chi2(41.19, 3, 24, 1e-8, Some(0.57));
    let pair = |second, p_holm| PairTest {
        first: conditions()[0],
        second,
        p_holm,
        effect: Some(1.0 + p_holm),
    };
    let panel = |index: usize, title: &str, axis: &str, step: f64, noise: f64, reference: f64| {
        let shift = [0.0, step, -step, 0.1 * step];
        DifferencePanel {
            title: title.into(),
            axis: axis.into(),
            conditions: conditions(),
            rows: (0..PARTICIPANTS)
                .map(|i| {
                    (0..4)
                        .map(|c| {
                            let value = reference
                                + shift[c]
                                + noise * (wobble(i, 8 * index) + wobble(i, c + 8 * index));
                            // Two participants never merged back in one condition.
                            (index != 2 || i > 1 || c != 2).then_some(value)
                        })
                        .collect()
                })
                .collect(),
            omnibus: if index == 3 { friedman.markup() } else { omnibus.markup() }.to_owned(),
            pairs: vec![
                pair(conditions()[1], 0.0002),
                pair(conditions()[2], 0.017),
                pair(conditions()[3], 0.62),
            ],
            reference: Some(reference),
            range: None,
            of_group: false,
        }
    };
    DifferencePanels {
        panels: vec![
            panel(0, "Mean velocity", "Difference (mph)", 4.5, 1.6, 0.0),
            panel(1, "Mean headway time", "Difference (s)", -0.3, 0.35, 0.0),
            panel(2, "Distance headway merge back", "Difference (m)", -10.0, 6.0, 0.0),
            panel(3, "Number of lane changes", "Difference (count)", 1.6, 1.4, 0.0),
            panel(4, "Time headway merge back", "Difference (s)", -0.4, 0.3, 0.0),
            panel(5, "Subjective aggressiveness", "Rating (1 to 7; 4 = as I drive)", 1.0, 0.6, 4.0),
        ],
        from: None,
        part: None,
    }
}
