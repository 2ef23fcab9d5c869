//! Six traits against four ratings, two series each.

use super::{PARTICIPANTS, conditions, wobble};
use maveric_report::figures::family::{Family, FamilyPanel};

pub(crate) fn input() -> Family {
    let cell = |p: usize, i: usize, s: usize| {
        let r = 0.5 * wobble(i + 9 * p, s + 3);
        Some([r, (r - 0.55).max(-1.0), (r + 0.55).min(1.0)])
    };
    let panel = |(p, title): (usize, &str)| FamilyPanel {
        title: title.into(),
        cells: (0..6).map(|i| vec![cell(p, i, 0), cell(p, i, 1)]).collect(),
    };
    let panels = ["Competence", "Intelligence", "Discomfort", "Trust"];
    Family {
        rows: [
            "Extraversion",
            "Agreeableness",
            "Conscientiousness",
            "Neuroticism",
            "Openness",
            "Patience",
        ]
        .map(String::from)
        .to_vec(),
        series: vec![conditions()[1], conditions()[2]],
        panels: panels.into_iter().enumerate().map(panel).collect(),
        what: "Made up: intervals that would hold for all 48 at once (95%).".into(),
        n: vec![PARTICIPANTS],
    }
}
