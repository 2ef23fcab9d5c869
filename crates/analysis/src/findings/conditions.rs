//! Do the conditions differ, and the way that was expected?

use crate::{
    finding::{Finding, Part, Question},
    result::Panel,
};

/// The panels of everybody.
fn whole(panels: &[Panel]) -> impl Iterator<Item = &Panel> {
    panels.iter().filter(|panel| panel.group.is_none())
}

/// Every contrast of everybody that has an expected direction has to lie that way: of what people said where it is asked whether they
/// noticed, else of what was measured.
pub(super) fn expected(panels: &[Panel], question: Question) -> Option<Finding> {
    let measured = question != Question::Noticed;
    let mut parts = Vec::new();
    for panel in whole(panels).filter(|panel| panel.measured == measured) {
        for contrast in &panel.contrasts {
            if let Some(expected) = contrast.expected {
                let key = format!("{}.{}-{}", panel.outcome, contrast.first, contrast.second);
                let estimate = (contrast.mean_difference, contrast.p_holm);
                parts.push(Part::directed(key, panel.n, estimate, expected));
            }
        }
    }
    (!parts.is_empty()).then(|| Finding::every(question, parts))
}

/// One declared contrast of one outcome is enough, whichever way it lies; nothing is asked where no outcome has one.
pub(super) fn differ(panels: &[Panel]) -> Option<Finding> {
    let part = |panel: &Panel| {
        let p = panel.contrasts.iter().filter_map(|c| c.p_holm);
        Part::differs(&panel.outcome, panel.n, (None, p.reduce(f64::min)))
    };
    let compared = whole(panels).filter(|panel| !panel.contrasts.is_empty());
    let parts: Vec<Part> = compared.map(part).collect();
    (!parts.is_empty()).then(|| Finding::one(Question::Differ, parts))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Analysis, Group, Verdict, finding,
        testing::{DESIGN, analysed, analysed_by, drive, plain, tables},
    };
    use Verdict::{Fails, NotAsked, NotShown, NotTestable, Shown, TooFew};
    use maveric_domain::design::Sign;

    /// Eight people whose fast car is `faster` m/s above the own drive, and their slow one as much below it.
    fn driven(design: &str, faster: f64) -> Analysis {
        let mut tables = tables();
        tables.measurements.clear();
        for i in 0..8 {
            let own = 24.0 + i as f64;
            let wobble = 0.3 * (i as f64 - 3.5);
            for (condition, above) in
                [("own", 0.0), ("same", 0.1), ("fast", faster), ("slow", -faster), ("across", 0.2)]
            {
                let speed = own
                    + above
                    + wobble * above.signum() * if condition == "fast" { 1.0 } else { 0.7 };
                tables.measurements.push(drive(i, condition, Some(speed)));
            }
        }
        analysed_by(design, tables)
    }

    #[test]
    fn a_dial_that_does_as_it_says_is_shown_and_one_that_is_wired_the_wrong_way_fails() {
        let dial = |faster| {
            let analysis = driven(DESIGN, faster);
            finding::by_question(&analysis.findings, Question::Dial).unwrap().clone()
        };
        let (right, wrong) = (dial(4.0), dial(-4.0));
        assert_eq!([right.verdict, wrong.verdict], [Shown, Fails]);
        assert!(right.parts.iter().any(
            |p| p.of == "mean_velocity_mps.fast-slow" || p.of == "mean_velocity_mps.slow-fast"
        ));
        assert_eq!(dial(0.02).verdict, NotShown);
        // Contrasts that nothing is expected of, such as that across the dial, take no part.
        assert!(right.parts.iter().all(|p| !p.of.contains("across")));
    }

    #[test]
    fn what_was_measured_and_what_people_said_are_two_questions() {
        let mut panels = analysed(tables()).panels;
        for panel in &mut panels {
            panel.n = 24;
            for contrast in &mut panel.contrasts {
                contrast.expected = Some(if panel.measured { Sign::Plus } else { Sign::Minus });
                (contrast.mean_difference, contrast.p_holm) = (Some(1.0), Some(0.01));
            }
        }
        let judged = |panels: &[Panel], question| expected(panels, question).map(|f| f.verdict);
        assert_eq!(judged(&panels, Question::Dial), Some(Shown));
        assert_eq!(judged(&panels, Question::Noticed), Some(Fails));
        // The panels of groups are a family of their own and decide nothing.
        let group =
            Group { factor: "city".to_owned(), label: String::new(), level: "Kyiv".to_owned() };
        for panel in panels.iter_mut().filter(|p| !p.measured) {
            panel.group = Some(group.clone());
        }
        assert_eq!(judged(&panels, Question::Noticed), None);
    }

    #[test]
    fn conditions_differ_when_one_outcome_does_after_holm() {
        let panels = driven(&plain(&["fast", "slow"], ""), 4.0).panels;
        let judged = |p_holm: &[Option<f64>], n: usize| {
            let mut panels: Vec<Panel> = p_holm.iter().map(|_| panels[0].clone()).collect();
            for (panel, p_holm) in panels.iter_mut().zip(p_holm) {
                panel.n = n;
                panel.contrasts[0].p_holm = *p_holm;
                panel.contrasts[0].p = Some(0.001);
            }
            differ(&panels).unwrap().verdict
        };
        assert_eq!(judged(&[Some(0.2), Some(0.04)], 24), Shown);
        assert_eq!(judged(&[Some(0.2), Some(0.05)], 24), NotShown);
        assert_eq!(judged(&[Some(0.04)], 5), TooFew);
        // One of several contrasts of an outcome is enough.
        let mut several = panels[0].clone();
        several.n = 24;
        let mut open = several.contrasts[0].clone();
        (several.contrasts[0].p_holm, open.p_holm) = (Some(0.04), Some(0.9));
        several.contrasts.push(open);
        assert_eq!(differ(&[several]).unwrap().verdict, Shown);
        assert_eq!(judged(&[None], 0), NotAsked);
        assert_eq!(judged(&[None], 24), NotTestable);
        assert_eq!(differ(&[]), None);
        // One condition has no contrast, and is no part.
        let (mut alone, mut beside) = (panels[0].clone(), panels[0].clone());
        alone.contrasts.clear();
        assert_eq!(differ(std::slice::from_ref(&alone)), None);
        (beside.n, beside.contrasts[0].p_holm) = (24, Some(0.04));
        let found = differ(&[alone, beside]).unwrap();
        assert_eq!((found.verdict, found.parts.len()), (Shown, 1));
    }
}
