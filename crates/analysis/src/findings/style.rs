//! What the learned style holds: the score, and habits beside it.

use crate::{
    finding::{Finding, Part, Question},
    result::{AggressionLine, Analysis, Kept},
};
use maveric_domain::design::Sign;

/// The position on the line has to go with the score, fitted without it where there is such a fit.
pub(super) fn line(analysis: &Analysis) -> Option<Finding> {
    let score = |line: &AggressionLine| line.rows.last().map(|row| row.correlation.clone());
    let without = analysis.line_without_adb.as_ref().and_then(score);
    let (key, decides) = match without {
        Some(correlation) => ("without_score", correlation),
        None => ("with_score", analysis.line.as_ref().and_then(score)?),
    };
    let part = Part::directed(key, decides.n, (decides.r, decides.p), Sign::Plus);
    let part = part.with_interval(decides.ci.ends());
    Some(Finding::every(Question::Style, vec![part]))
}

/// One habit that goes with the angle of the move is enough.
pub(super) fn across(kept: &[Kept]) -> Option<Finding> {
    let part = |habit: &Kept| {
        let estimate = (habit.circular_r, habit.circular_p_holm);
        Part::directed(&habit.measure, habit.points.len(), estimate, Sign::Plus)
    };
    let parts = kept.iter().map(part).collect();
    (!kept.is_empty()).then(|| Finding::one(Question::Across, parts))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Correlation, Verdict, finding,
        testing::{analysed, position, tables},
    };
    use Verdict::{Fails, NotShown, Shown, TooFew};
    use maveric_stats::Interval;

    fn correlation(r: f64, p: f64, n: usize) -> Correlation {
        Correlation {
            method: "pearson".to_owned(),
            n,
            df: n.saturating_sub(2),
            r: Some(r),
            p: Some(p),
            ci: Interval::default(),
        }
    }

    #[test]
    fn the_fit_without_the_score_decides_where_there_is_one() {
        let mut analysis = analysed(tables());
        let judged =
            |analysis: &Analysis| line(analysis).map(|f| (f.verdict, f.parts[0].of.clone()));
        let mut set = |with: Correlation, without: Option<Correlation>| {
            let line = analysis.line.as_mut().unwrap();
            line.rows.last_mut().unwrap().correlation = with;
            let mut other = line.clone();
            analysis.line_without_adb = without.map(|correlation| {
                other.rows.last_mut().unwrap().correlation = correlation;
                other
            });
            judged(&analysis).unwrap()
        };
        let (high, low) = (correlation(0.9, 0.001, 24), correlation(-0.6, 0.001, 24));
        assert_eq!(set(high.clone(), Some(low.clone())), (Fails, "without_score".to_owned()));
        assert_eq!(set(low.clone(), Some(high.clone())).0, Shown);
        assert_eq!(set(low, Some(correlation(0.3, 0.05, 24))).0, NotShown);
        assert_eq!(set(high, None), (Shown, "with_score".to_owned()));
        assert_eq!(set(correlation(0.9, 0.001, 5), None).0, TooFew);
        analysis.line = None;
        assert_eq!(judged(&analysis), None);
    }

    #[test]
    fn a_line_that_runs_against_the_score_fails() {
        // The positions of six people, turned round: who scores high lies low.
        let turned = |positions: [f64; 6]| {
            let mut tables = tables();
            tables.embeddings = (0..6).map(|i| position(i, positions[i])).collect();
            let analysis = analysed(tables);
            finding::by_question(&analysis.findings, Question::Style).unwrap().verdict
        };
        let along = [20.0, 25.0, 22.0, 30.0, 28.0, 35.0];
        assert_eq!(turned(along), Shown);
        assert_eq!(turned(along.map(|x| -x)), Fails);
    }

    #[test]
    fn one_habit_that_goes_with_the_angle_after_holm_is_enough() {
        let condition = |text: &str| text.parse().unwrap();
        let habit = |p: f64, p_holm: f64, n: usize| Kept {
            across: condition("across"),
            from: condition("same"),
            measure: "min_headway_distance_m".to_owned(),
            title: String::new(),
            unit: String::new(),
            line: correlation(0.1, 0.9, n),
            angle: correlation(0.9, 0.001, n),
            circular_r: Some(0.6),
            circular_p: Some(p),
            circular_p_holm: Some(p_holm),
            points: vec![(0.0, 0.0); n],
        };
        let judged = |habits: &[Kept]| across(habits).unwrap().verdict;
        assert_eq!(judged(&[habit(0.5, 0.5, 24), habit(0.01, 0.02, 24)]), Shown);
        // Neither the p before Holm nor the correlation with the bare angle decides.
        assert_eq!(judged(&[habit(0.03, 0.06, 24)]), NotShown);
        assert_eq!(judged(&[habit(0.01, 0.02, 5)]), TooFew);
        assert_eq!(across(&[]), None);
    }
}
