//! Would studies of one size show what was planted?

use crate::{
    outcomes::Part,
    rates::{Cell, TestRate},
};

/// Share of studies that should find what is there.
pub const POWER: f64 = 0.8;

impl Cell {
    /// The tests of each part of the analysis that has any.
    pub fn by_part(&self) -> Vec<(Part, Vec<&TestRate>)> {
        let tests_in = |part: Part| self.tests.iter().filter(move |t| t.part == part);
        let parts = Part::ALL.into_iter().map(|part| (part, tests_in(part).collect()));
        parts.filter(|(_, tests): &(_, Vec<_>)| !tests.is_empty()).collect()
    }

    /// Of each part of the analysis the test that most studies found.
    pub fn best_tests(&self) -> Vec<&TestRate> {
        fn most<'a>(best: &'a TestRate, t: &'a TestRate) -> &'a TestRate {
            if t.rejected > best.rejected { t } else { best }
        }
        let parts = self.by_part().into_iter();
        parts.filter_map(|(_, tests)| tests.into_iter().reduce(most)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        findings::power,
        outcomes::{Found, Studied},
    };
    use maveric_analysis::{Judged, Verdict};

    /// 100 studies, of which so many show each hypothesis; every one of them finds the one test of the report.
    fn cell(shown: &[usize]) -> Cell {
        let judged = |verdict| Judged {
            says: "Sporty is faster".to_owned(),
            outcome: "mean_velocity_mps".to_owned(),
            first: "sporty".parse().unwrap(),
            second: "calm".parse().unwrap(),
            rule: String::new(),
            verdict,
            n: 24,
            mean_difference: Some(1.0),
            interval: None,
            odds: None,
            expected: None,
            bounds: None,
            p: Some(0.01),
            holm: true,
            p_outside: None,
            unbounded: false,
            why_not: None,
        };
        let studies: Vec<Studied> = (0..100)
            .map(|i| Studied {
                tests: vec![Found {
                    part: Part::Omnibus,
                    key: "panel.mean_velocity_mps.omnibus".to_owned(),
                    about: "Mean velocity".to_owned(),
                    family: None,
                    estimate: None,
                    p: Some(0.001),
                    p_holm: None,
                }],
                findings: Vec::new(),
                judged: shown
                    .iter()
                    // A difference the wrong way has a small p as well.
                    .map(|count| judged(if i < *count { Verdict::Shown } else { Verdict::Fails }))
                    .collect(),
            })
            .collect();
        Cell::of(24, 1.0, &studies)
    }

    #[test]
    fn a_declared_hypothesis_of_little_power_fails_however_often_another_test_finds_something() {
        let cell = cell(&[21]);
        let asked = power(&cell);
        assert_eq!(asked.verdict, Verdict::Fails);
        assert_eq!(asked.parts[0].of, "Sporty is faster");
        assert!((asked.parts[0].estimate.unwrap() - 0.21).abs() < 1e-12);
    }

    #[test]
    fn power_is_shown_where_the_whole_interval_lies_above_four_fifths_and_open_on_the_border() {
        let verdict = |shown: &[usize]| power(&cell(shown)).verdict;
        assert_eq!(verdict(&[95]), Verdict::Shown);
        assert_eq!(verdict(&[80]), Verdict::NotShown);
        assert_eq!(verdict(&[60]), Verdict::Fails);
        assert_eq!(verdict(&[95, 60]), Verdict::Fails);
        assert_eq!(verdict(&[95, 85]), Verdict::NotShown);
    }

    #[test]
    fn a_hypothesis_that_no_study_could_judge_is_no_power() {
        let mut cell = cell(&[95, 95]);
        cell.hypotheses[1].shown = None;
        assert_eq!(power(&cell).verdict, Verdict::NotShown);
    }

    #[test]
    fn without_hypotheses_the_best_test_of_each_part_is_asked_and_said_to_be_that() {
        let asked = power(&cell(&[]));
        assert_eq!(asked.verdict, Verdict::Shown);
        let best = "Outcomes over the conditions: Mean velocity";
        assert_eq!(asked.parts[0].of, best);
    }
}
