//! Two groups under two conditions each, with their contrasts.

use super::wobble;
use maveric_report::figures::comparison::{ComparedCell, Comparison, ComparisonPanel, Contrast};

pub(crate) fn input() -> Comparison {
    let names = ["novice calm", "novice brisk", "expert calm", "expert brisk"];
    let shift = [4.2, 3.1, 4.4, 4.9];
    let cell = |(name, mean): (&str, f64)| ComparedCell {
        name: name.to_owned(),
        mean: Some([mean, mean - 0.4, mean + 0.4]),
    };
    let person = |i: usize| {
        let first = if i.is_multiple_of(2) { 0 } else { 2 };
        let value = |c: usize| shift[c] + 0.6 * (wobble(i, 90) + wobble(i, c));
        (0..4).map(|c| (c == first || c == first + 1).then(|| value(c))).collect()
    };
    let contrast = |(first, second, p)| Contrast { first, second, p };
    Comparison {
        panels: vec![ComparisonPanel {
            outcome: "Trust (1 to 7)".into(),
            test: "experience × style: *F*(1, 22) = 9.41, *p* = .006, *η*_{p}^{2} = .30".into(),
            cells: names.into_iter().zip(shift).map(cell).collect(),
            rows: (0..24).map(person).collect(),
            contrasts: [(0, 1, 0.004), (2, 3, 0.081)].map(contrast).to_vec(),
        }],
        intervals: "95% intervals of the model".into(),
        contrasts: "*p* values after Holm".into(),
    }
}
