//! Four ratings over the car's style, best near people's own, near one car, and nowhere.

use maveric_report::figures::congruence::{Congruence, CongruenceLine, CongruencePanel};

pub(crate) fn input() -> Congruence {
    // Where the rating is best for somebody of this own style, how fast it falls from there, and its level.
    let line = |own: f64, (best, bend, level): (f64, f64, f64)| {
        let rating = |car: f64| level - bend * (car - best) * (car - best);
        // Not below the score that the scale begins with. No point lies at the own style.
        let (least, most) = ((own - 15.0).max(11.0), own + 15.0);
        let met = |step: i32| least + (most - least) / 41.0 * f64::from(step);
        let points: Vec<(f64, f64)> = (0..=41).map(|step| (met(step), rating(met(step)))).collect();
        let is_met = (least..=most).contains(&best);
        CongruenceLine {
            own,
            points,
            at_own: Some(rating(own)),
            best: (bend > 0.0 && is_met).then_some((best, level)),
        }
    };
    let panel = |title: &str, test: &str, best: fn(f64) -> (f64, f64, f64)| CongruencePanel {
        title: title.to_owned(),
        axis: "Predicted rating".to_owned(),
        test: test.to_owned(),
        n: 24,
        period: true,
        curves: [19.6, 27.9, 36.2].map(|own| Some(line(own, best(own)))),
    };
    Congruence {
        style: "ADB score".to_owned(),
        panels: vec![
            panel("Competence", "Curvature −0.0081, *p* < .001", |own| {
                (own - 1.3, 0.0081, 5.2 - 0.01 * own)
            }),
            panel("Intelligence", "Curvature −0.0047, *p* = .012", |own| {
                (20.4 + 0.1 * own, 0.0047, 4.9)
            }),
            panel("Trust", "Curvature −0.0012, *p* = .210", |own| (own - 21.5, 0.0012, 5.6)),
            panel("Usefulness", "Curvature 0.0009, *p* = .480", |own| {
                (own + 4.2, -0.0009, 4.1 + 0.02 * own)
            }),
        ],
        places: 3,
        part: None,
    }
}
