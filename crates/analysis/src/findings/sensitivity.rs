//! Does what was found stay by another choice?

use crate::{
    finding::{Finding, Part, Question},
    other_choice::{OtherChoice, Sensitivity, SensitivityRow},
    verdict::Verdict,
};
use maveric_domain::design::Sign;

/// Every difference that was found has to be there by the other choice too; none where no difference was found.
pub(super) fn stays(sensitivity: &[Sensitivity]) -> Option<Finding> {
    let parts: Vec<Part> = sensitivity.iter().flat_map(parts).collect();
    (!parts.is_empty()).then(|| Finding::every(Question::Stays, parts))
}

fn parts(by_choice: &Sensitivity) -> impl Iterator<Item = Part> + '_ {
    let choice = match by_choice.choice {
        OtherChoice::WithoutItems { .. } => "without-items",
        OtherChoice::WithStopped { .. } => "with-stopped",
    };
    let [_, n] = by_choice.n;
    let key = move |row: &SensitivityRow| {
        format!("{}.{}-{}.{choice}", by_choice.outcome, row.first, row.second)
    };
    let differing = by_choice.rows.iter().filter(|row| row.differs == Verdict::Shown);
    differing.filter_map(move |row| {
        let way = Sign::of(row.mean_difference?)?;
        let other = (row.other_mean_difference, row.other_p);
        Some(Part::directed(key(row), n, other, way))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Analysis, Tables,
        finding::by_question,
        testing::{analysed_by, id, near, plain, score, tables},
        verdict::significant,
    };
    use Verdict::{Fails, NotShown, Shown, TooFew};
    use maveric_domain::Moment;

    const WITH: [f64; 6] = [2.0, 2.5, 1.5, 2.2, 1.8, 2.0];
    const OUTCOME: &str = "[[outcome]]\nscale = \"jian_trust.overall\"\ndrop_items = [3]\n";

    /// Everybody rates slow 4, and fast by so much more, with all items and without the third.
    fn rated(with: [f64; 6], without: [f64; 6]) -> Tables {
        let mut tables = tables();
        tables.post.clear();
        for (i, more) in [("overall", with), ("overall_without_3", without)]
            .into_iter()
            .flat_map(|(subscale, more)| more.map(|more| (subscale, more)).into_iter().enumerate())
        {
            let (subscale, more) = more;
            for (condition, value) in [("slow", 4.0), ("fast", 4.0 + more)] {
                let after = Moment::After(id(condition).into());
                tables.post.push(score(i, after, "jian_trust", subscale, value));
            }
        }
        tables
    }

    fn judged(with: [f64; 6], without: [f64; 6]) -> Analysis {
        analysed_by(&plain(&["fast", "slow"], OUTCOME), rated(with, without))
    }

    #[test]
    fn a_difference_stays_goes_or_turns_without_the_items_and_one_may_be_there_by_that_alone() {
        let verdict = |without| {
            let analysis = judged(WITH, without);
            by_question(&analysis.findings, Question::Stays).map(|finding| finding.verdict)
        };
        assert_eq!(verdict(WITH), Some(Shown));
        assert_eq!(verdict([0.5, -0.6, 0.1, -0.2, 0.3, 0.0]), Some(NotShown));
        assert_eq!(verdict(WITH.map(|more| -more)), Some(Fails));
        let none = [0.5, -0.6, 0.1, -0.2, 0.3, 0.0];
        let analysis = judged(none, WITH);
        assert!(by_question(&analysis.findings, Question::Stays).is_none());
        let [by_choice] = analysis.sensitivity.as_slice() else {
            panic!("{:?}", analysis.sensitivity);
        };
        assert_eq!(by_choice.only_there(), 1);
        assert_eq!(judged(WITH, WITH).sensitivity[0].only_there(), 0);
    }

    #[test]
    fn both_differences_stand_side_by_side_with_the_sign_of_the_contrast() {
        let analysis = judged(WITH, WITH.map(|more| more / 2.0));
        let [by_choice] = analysis.sensitivity.as_slice() else {
            panic!("{:?}", analysis.sensitivity);
        };
        assert_eq!((by_choice.outcome.as_str(), by_choice.n), ("jian_trust.overall", [6, 6]));
        let row = &by_choice.rows[0];
        assert_eq!((row.first.as_str(), row.second.as_str()), ("fast", "slow"));
        near(row.mean_difference, 2.0);
        near(row.other_mean_difference, 1.0);
        let part = &by_question(&analysis.findings, Question::Stays).unwrap().parts[0];
        assert_eq!(part.of, "jian_trust.overall.fast-slow.without-items");
        near(part.estimate, 1.0);
    }

    #[test]
    fn both_p_are_corrected_but_of_the_contrast_that_decides_about_a_primary_outcome() {
        let holm = |more: &str| {
            let design = plain(&["fast", "slow"], &format!("{OUTCOME}{more}"));
            analysed_by(&design, rated(WITH, WITH)).sensitivity[0].rows[0].holm
        };
        assert!(holm(""));
        let primary = "primary = true\ntest = \"rm-anova\"\ncontrast = [\"fast\", \"slow\"]\n";
        assert!(!holm(primary));
    }

    #[test]
    fn what_was_said_of_stopped_rides_counts_by_the_other_choice_alone() {
        let design = plain(&["fast", "slow"], "[[outcome]]\nscale = \"jian_trust.overall\"\n");
        let judged = |of_stopped: f64| {
            let mut tables = rated(WITH, WITH);
            let who = crate::testing::person(0);
            let fast = Moment::After(id("fast").into());
            for score in &mut tables.post {
                if score.participant == who && score.moment == fast {
                    score.value = Some(of_stopped);
                }
            }
            tables.stopped.push(crate::Stopped {
                participant: who,
                condition: id("fast"),
                session: maveric_domain::occasion::first(),
                trial: maveric_domain::occasion::first(),
                time_s: 30.0,
                reason: "misc >= 6".to_owned(),
            });
            analysed_by(&design, tables)
        };
        let analysis = judged(6.0);
        let [by_choice] = analysis.sensitivity.as_slice() else {
            panic!("{:?}", analysis.sensitivity);
        };
        assert_eq!(by_choice.choice, OtherChoice::WithStopped { rides: 1 });
        assert_eq!(by_choice.n, [5, 6]);
        near(by_choice.rows[0].mean_difference, 2.0);
        near(by_choice.rows[0].other_mean_difference, 2.0);
        // Of the five who did not stop nothing is said; with the sixth there is a difference.
        assert_eq!(by_choice.only_there(), 1);
        assert!(by_question(&analysis.findings, Question::Stays).is_none());
        assert!(analysed_by(&design, rated(WITH, WITH)).sensitivity.is_empty());
        near(judged(-60.0).sensitivity[0].rows[0].other_mean_difference, (10.0 - 64.0) / 6.0);
    }

    #[test]
    fn without_the_items_too_few_may_have_a_score() {
        let mut few = rated(WITH, WITH);
        few.post.retain(|s| s.subscale == "overall" || s.participant != crate::testing::person(0));
        let analysis = analysed_by(&plain(&["fast", "slow"], OUTCOME), few);
        let finding = by_question(&analysis.findings, Question::Stays).unwrap();
        assert_eq!((finding.verdict, analysis.sensitivity[0].n), (TooFew, [6, 5]));
        assert_eq!(significant(5, Some(0.01)), TooFew);
    }
}
