//! Two styles in three kinds of traffic, for two groups.

use super::wobble;
use maveric_report::figures::interaction::{Interaction, InteractionLine, InteractionPanel};

pub(crate) fn input() -> Interaction {
    let line = |group: usize, (style, name): (usize, &str)| InteractionLine {
        name: name.to_owned(),
        means: (0..3)
            .map(|traffic| {
                let mean = 2.6 + 0.3 * (style * traffic) as f64 + 0.2 * (group * style) as f64;
                let mean = mean + 0.1 * wobble(traffic, 7 * group + style);
                Some([mean, mean - 0.25, mean + 0.25])
            })
            .collect(),
    };
    let panel = |(group, name): (usize, &str)| InteractionPanel {
        title: format!("Take-over time, {name}"),
        test: "*F*(2, 17.80) = 4.31, *p* = .030".to_owned(),
        n: 24,
        axis: "Take-over time (s)".to_owned(),
        factor: "Traffic".to_owned(),
        levels: ["Free flow", "Dense", "Jam"].map(str::to_owned).to_vec(),
        lines: ["Calm", "Sporty"].into_iter().enumerate().map(|s| line(group, s)).collect(),
        range: None,
    };
    Interaction {
        panels: ["experts", "novices"].into_iter().enumerate().map(panel).collect(),
        intervals: "Intervals compare the levels within people (Cousineau–Morey).".to_owned(),
    }
}
