//! Does the car at 0 on the dial drive as its driver does, and nearer than the other cars?

use crate::{
    finding::{Finding, Part, Question, Rule},
    result::{Nearer, Reproduction},
    verdict::Verdict,
};
use maveric_domain::design::Sign;

/// In every measure the mean difference has to lie within what counts as none.
pub(super) fn own_style(rows: &[Reproduction]) -> Option<Finding> {
    let part = |row: &Reproduction| {
        let bias = row.bias.as_ref();
        let within = bias.map_or(0.0, |bias| bias.same_within);
        Part {
            of: row.measure.clone(),
            n: bias.map_or(0, |bias| bias.n),
            estimate: bias.map(|bias| bias.mean),
            interval: bias.and_then(|bias| bias.interval),
            p: bias.and_then(|bias| bias.p_equivalent),
            rule: Rule::Same { low: -within, high: within },
            verdict: bias.map_or(Verdict::NotAsked, |bias| bias.verdict),
        }
    };
    let parts = rows.iter().map(part).collect();
    (!rows.is_empty()).then(|| Finding::every(Question::OwnStyle, parts))
}

/// It has to be the nearer one in every measure, against every other car.
pub(super) fn nearer(rows: &[Nearer]) -> Option<Finding> {
    let part = |row: &Nearer| {
        let key = format!("{}.{}", row.measure, row.than);
        Part::directed(key, row.n, (row.effect, row.p_holm), Sign::Plus).with_interval(row.interval)
    };
    let parts = rows.iter().map(part).collect();
    (!rows.is_empty()).then(|| Finding::every(Question::Nearer, parts))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        finding,
        testing::{CONDITIONS, SPEED, analysed, drive, tables},
    };
    use Verdict::{Fails, NotShown, Shown, TooFew};

    /// Twelve people's own speeds, and of each condition what its car drives faster (m/s).
    fn driven(same: impl Fn(usize) -> f64, others: f64) -> crate::Analysis {
        let mut tables = tables();
        tables.measurements.clear();
        for i in 0..12 {
            let own = 24.0 + 0.5 * i as f64;
            tables.measurements.push(drive(i, "own", Some(own)));
            let wobble = if i.is_multiple_of(2) { 0.1 } else { -0.1 };
            for condition in CONDITIONS {
                let faster = match condition {
                    "same" => same(i),
                    "slow" => -others + wobble,
                    _ => others + wobble * (1.0 + i as f64 / 20.0),
                };
                tables.measurements.push(drive(i, condition, Some(own + faster)));
            }
        }
        analysed(tables)
    }

    fn of(analysis: &crate::Analysis, question: Question) -> Finding {
        finding::by_question(&analysis.findings, question).unwrap().clone()
    }

    #[test]
    fn a_car_that_drives_as_its_driver_is_the_same_a_fast_one_fails_and_between_nothing_is_shown() {
        let spread = |i: usize| if i.is_multiple_of(2) { 0.2 } else { -0.2 };
        let own = |shift: f64| of(&driven(|i| shift + spread(i), 3.0), Question::OwnStyle);
        assert_eq!([own(0.0).verdict, own(2.0).verdict], [Shown, Fails]);
        // What counts as none is half a standard deviation of 12 people half a metre a second apart.
        let border = own(0.0).parts[0].rule;
        let Rule::Same { high, low } = border else { panic!("{border:?}") };
        let at_the_border = own(high / 3.6);
        assert_eq!((low, at_the_border.verdict), (-high, NotShown));
        assert_eq!(at_the_border.parts[0].of, SPEED);
    }

    #[test]
    fn the_nearer_car_is_shown_the_farther_one_fails_and_as_near_is_neither() {
        let near = |same: f64, others: f64| {
            of(&driven(|i| same + 0.01 * i as f64, others), Question::Nearer)
        };
        assert_eq!(near(0.3, 3.0).verdict, Shown);
        assert_eq!(near(3.0, 0.3).verdict, Fails);
        let nearer = near(0.3, 3.0);
        let parts: Vec<&str> = nearer.parts.iter().map(|p| p.of.as_str()).collect();
        assert_eq!(parts, [format!("{SPEED}.fast"), format!("{SPEED}.slow")]);
        assert!(nearer.parts.iter().all(|p| p.n == 12 && p.estimate == Some(1.0)));
        assert_eq!(
            driven(|i| if i.is_multiple_of(2) { 2.0 } else { 4.0 }, 3.0).findings[1].verdict,
            NotShown
        );
    }

    #[test]
    fn the_p_after_holm_decides_and_a_measure_without_a_test_is_not_asked() {
        let row = |effect, p, p_holm| Nearer {
            condition: "same".parse().unwrap(),
            measure: SPEED.to_owned(),
            title: String::new(),
            than: "fast".parse().unwrap(),
            n: 24,
            nearer: 20,
            tied: 0,
            farther: 4,
            effect: Some(effect),
            interval: None,
            p: Some(p),
            p_holm: Some(p_holm),
        };
        let judged = |rows: &[Nearer]| nearer(rows).unwrap().verdict;
        assert_eq!(judged(&[row(0.5, 0.03, 0.06)]), NotShown);
        assert_eq!(judged(&[row(0.5, 0.01, 0.02), row(-0.5, 0.01, 0.02)]), Fails);
        assert_eq!(judged(&[Nearer { n: 5, ..row(0.5, 0.01, 0.02) }]), TooFew);
        assert_eq!(nearer(&[]), None);
        let mut unknown = analysed(tables()).reproduction;
        unknown[0].bias = None;
        assert_eq!(own_style(&unknown).unwrap().verdict, Verdict::NotAsked);
    }
}
