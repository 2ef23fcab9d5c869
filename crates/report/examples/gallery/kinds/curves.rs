//! Power of three tests against participants, in two panels.

use maveric_report::figures::curves::{CurvePanel, CurvePoint, Curves};

pub(crate) fn input() -> Curves {
    let curve = |strength: f64| -> Vec<CurvePoint> {
        let point = |n: f64| {
            let y = 1.0 - 0.95 * (-strength * n).exp();
            CurvePoint { x: n, y, low: y - 0.03, high: (y + 0.03).min(1.0) }
        };
        [12.0, 24.0, 36.0, 48.0, 72.0].map(point).to_vec()
    };
    let panel = |title: &str, strength: f64| CurvePanel {
        title: title.into(),
        y: "Power".into(),
        curves: [1.0, 0.6, 0.3].map(|share| curve(share * strength)).to_vec(),
    };
    Curves {
        name: "power-curves".into(),
        title: "Power against participants".into(),
        caption: "Share of simulated studies in which *p* < .05, with 95% intervals; dashed: .80. *n* = 400 \
                  studies a point."
            .into(),
        alt: "Power grows with the participants in both panels, fastest for a large effect.".into(),
        x: "Participants".into(),
        curves: ["large effect", "medium", "small"].map(str::to_owned).to_vec(),
        rule: Some(0.8),
        range: Some((0.0, 1.0)),
        panels: vec![panel("Mimic − Aggressive", 0.06), panel("Mimic − Cautious", 0.04)],
    }
}
