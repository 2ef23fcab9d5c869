//! All findings of a study, in the order in which a reader asks.

use super::{car, conditions, congruence, declared, people, presses, retest, sensitivity, style};
use crate::{
    finding::{Finding, Part, Question},
    result::Analysis,
};
use maveric_domain::Design;
use maveric_stats::proportion;

/// What was declared first, then does it work, for whom, and what goes with it. Whether the conditions differ at all is asked where nothing
/// else is asked of them.
pub fn of_study(design: &Design, analysis: &Analysis) -> Vec<Finding> {
    let steered = design.style().is_some();
    let mut findings = declared::primary(&analysis.primary);
    findings.extend(declared::hypotheses(&analysis.hypotheses));
    findings.extend(car::own_style(&analysis.reproduction));
    findings.extend(car::nearer(&analysis.nearer));
    let changed = if steered { Question::Dial } else { Question::Expected };
    findings.extend(conditions::expected(&analysis.panels, changed));
    findings.extend(conditions::expected(&analysis.panels, Question::Noticed));
    if findings.is_empty() {
        findings.extend(conditions::differ(&analysis.panels));
    }
    findings.extend(sensitivity::stays(&analysis.sensitivity));
    findings.extend(style::line(analysis));
    findings.extend(style::across(&analysis.kept));
    findings.extend(congruence::congruence(&analysis.congruence));
    findings.extend(people::which(analysis.which.as_ref()));
    findings.extend(people::preferred(&analysis.preferences));
    findings.extend(people::personality(&analysis.homophily));
    findings.extend(presses::findings(analysis.presses.as_ref()));
    findings.extend(retest::retest(design, analysis.repeats.as_ref()));
    findings
}

/// Whether more than half of the paper's numbers that `could` differ `agree`.
pub fn against_the_paper(agree: usize, could: usize) -> Finding {
    let share = proportion(agree, could, 0.95).ok();
    let part = Part::share("claims", could, share.as_ref(), (0.5, 1.0));
    Finding::every(Question::Paper, vec![part])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Verdict,
        testing::{DESIGN, analysed, analysed_by, plain, tables},
    };

    fn asked(analysis: &Analysis) -> Vec<Question> {
        analysis.findings.iter().map(|f| f.question).collect()
    }

    #[test]
    fn a_study_asks_what_its_design_makes_it_ask_and_no_more() {
        use Question::{Dial, Differ, Nearer, Noticed, OwnStyle, Personality, Preferred, Style};
        let whole = analysed(tables());
        assert_eq!(asked(&whole)[..3], [OwnStyle, Nearer, Dial]);
        for question in [Style, Preferred, Personality] {
            assert!(asked(&whole).contains(&question), "{question:?}");
        }
        assert!(!asked(&whole).contains(&Differ) && !asked(&whole).contains(&Noticed));
        // Nothing is expected of conditions without a dial, so that any difference counts.
        let recorded = analysed_by(&plain(&["fast", "slow"], ""), tables());
        assert_eq!(asked(&recorded), [Differ]);
        let declared = "[[hypothesis]]\nsays = \"Fast is faster\"\noutcome = \"mean_velocity_mps\"\ncontrast = [\"fast\", \"slow\"]\ndirection = \"+\"\n";
        let declared = analysed_by(&format!("{DESIGN}{declared}"), tables());
        assert_eq!(asked(&declared)[0], Question::Hypothesis(1));
    }

    #[test]
    fn more_than_half_of_the_papers_numbers_have_to_agree() {
        let judged = |agree, could| against_the_paper(agree, could).verdict;
        assert_eq!(
            [judged(20, 24), judged(12, 24), judged(4, 24), judged(5, 5), judged(0, 0)],
            [Verdict::Shown, Verdict::NotShown, Verdict::Fails, Verdict::TooFew, Verdict::NotAsked]
        );
    }
}
