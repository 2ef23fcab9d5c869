//! Do people like best a car near their own style?

use crate::{
    AnalysisError,
    data::StudyData,
    homophily::{cells, ratings},
    result::CongruenceRow,
};
use maveric_domain::design::{Condition, ScoreName};
use maveric_stats::{CongruenceData, Predictor, StatsError, congruence};
use std::collections::BTreeSet;

/// What counts as near: this share of a step of the dial, 5 of the paper's 15 points.
const NEAR: f64 = 1.0 / 3.0;

/// Each rating, turned so that more is better, over the distance of the car from the person's own style, as it was driven; nothing where
/// the dial has fewer than three places.
///
/// Rated similarity says how near a car is, not how it is liked.
pub(crate) fn by_rating(data: &StudyData) -> Result<Vec<CongruenceRow>, AnalysisError> {
    let dials = data.design.conditions().iter().filter_map(Condition::dial);
    let places: BTreeSet<u64> = dials.clone().map(|d| (d + 0.0).to_bits()).collect();
    if places.len() < 3 {
        return Ok(Vec::new());
    }
    let furthest = dials.fold(0.0, |far: f64, d| far.max(d.abs()));
    let step = data.design.style().and_then(|style| style.points);
    let near_points = NEAR * step.unwrap_or(furthest);
    let middle = data
        .style_range()
        .map_or(0.0, |(low, high)| f64::midpoint(low, high));
    let on_the_dial = |c| data.design.condition(c).is_some_and(|c| c.dial().is_some());
    let mut cells = cells(data);
    cells.retain(|(_, c)| on_the_dial(*c));
    let subjects: Vec<String> = cells.iter().map(|(p, _)| p.to_string()).collect();
    let row = |(person, condition)| data.condition(person, condition);
    let moved: Vec<Option<f64>> = cells.iter().map(|c| row(*c)?.moved_points).collect();
    let own_style: Vec<Option<f64>> = cells
        .iter()
        .map(|c| {
            let row = row(*c)?;
            Some(row.adb_hat? - row.moved_points? - middle)
        })
        .collect();
    let periods: Vec<Option<String>> = cells
        .iter()
        .map(|(p, c)| data.period(p, *c).map(|period| period.to_string()))
        .collect();
    let period = [("period", Predictor::Factor(&periods))];
    let similar = data.design.homophily().and_then(|h| h.similarity.as_ref());
    let one = |name: &ScoreName| {
        let better = data.better(name).factor();
        let liking: Vec<Option<f64>> = cells
            .iter()
            .map(|(p, c)| data.rated(p, *c, name).map(|rated| better * rated))
            .collect();
        let complete = |index: &usize| {
            liking[*index]
                .and(moved[*index])
                .and(own_style[*index])
                .is_some()
        };
        let people = (0..cells.len())
            .filter(complete)
            .map(|index| cells[index].0);
        let n = people.collect::<BTreeSet<_>>().len();
        let fit = |beside: &[(&str, Predictor)]| {
            let rows = CongruenceData {
                subjects: &subjects,
                liking: &liking,
                moved: &moved,
                own: &own_style,
                beside,
            };
            congruence(&rows, near_points)
        };
        let with_period = data.has_orders().then(|| fit(&period));
        let separable = |fitted: &Result<_, StatsError>| {
            !matches!(
                fitted,
                Err(StatsError::Collinear { .. } | StatsError::OneLevel { .. })
            )
        };
        let with_period = with_period.filter(separable);
        let period = with_period.is_some();
        let (model, why_not) = match with_period.unwrap_or_else(|| fit(&[])) {
            Ok(model) => (Some(model), None),
            Err(
                why @ (StatsError::TooFew { .. }
                | StatsError::BadParameter { .. }
                | StatsError::Collinear { .. }
                | StatsError::NoFit { .. }),
            ) => (None, Some(why.to_string())),
            Err(why) => return Err(why.into()),
        };
        Ok(CongruenceRow {
            rating: name.clone(),
            title: data.score_title(name),
            n,
            places: places.len(),
            near_points,
            middle,
            period,
            model,
            why_not,
        })
    };
    let rated = ratings(data).iter().filter(|name| Some(*name) != similar);
    rated.map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Analysis, Question, Tables, Verdict, finding,
        testing::{DESIGN, analysed_by, liked},
    };
    use Verdict::{Fails, NotShown, Shown, TooFew};
    use maveric_domain::Scale;
    use maveric_stats::{Bend, Region};

    /// The design less its car across the dial.
    fn on_the_dial() -> String {
        let across = "    [[condition]]\n    id = \"across\"\n    car = { across = true }\n";
        assert!(DESIGN.contains(across));
        DESIGN.replace(across, "")
    }

    fn analysed(tables: Tables) -> Analysis {
        analysed_by(&on_the_dial(), tables)
    }

    fn row(analysis: &Analysis) -> &CongruenceRow {
        &analysis.congruence[0]
    }

    fn verdict(analysis: &Analysis) -> Option<Verdict> {
        finding::by_question(&analysis.findings, Question::Congruence).map(|f| f.verdict)
    }

    #[test]
    fn people_who_like_best_what_is_near_their_own_style_are_found_and_others_are_not() {
        let near = analysed(liked(24, |_| 1.0, 0.01));
        let model = row(&near).model.as_ref().unwrap();
        assert_eq!(
            (model.bend, model.n_subjects, row(&near).n),
            (Bend::Top, 24, 24)
        );
        assert!((model.turn.estimate.unwrap() - 1.0).abs() < 1.0);
        assert!((row(&near).near_points - 5.0).abs() < 1e-12);
        assert_eq!(verdict(&near), Some(Shown));
        // Everybody wants a car ten points above their own.
        assert_eq!(verdict(&analysed(liked(24, |_| 10.0, 0.01))), Some(Fails));
        // Everybody wants the same car, wherever their own style lies.
        let one_car = analysed(liked(24, |own| 30.0 - own, 0.01));
        let parts = &finding::by_question(&one_car.findings, Question::Congruence)
            .unwrap()
            .parts;
        let of: Vec<(&str, Verdict)> = parts.iter().map(|p| (p.of.as_str(), p.verdict)).collect();
        assert_eq!(
            of,
            [
                ("jian_trust.overall.top", Shown),
                ("jian_trust.overall.movement", Fails)
            ]
        );
        assert_eq!(verdict(&analysed(liked(24, |_| 0.0, 0.0))), Some(NotShown));
    }

    #[test]
    fn what_is_liked_least_near_ones_own_style_fails_and_has_no_top() {
        let worst = analysed(liked(24, |_| 0.0, -0.01));
        assert_eq!(verdict(&worst), Some(Fails));
        let finding = finding::by_question(&worst.findings, Question::Congruence).unwrap();
        assert!(finding.parts.iter().all(|part| part.estimate.is_none()));
        let flat = analysed(liked(24, |_| 0.0, 0.0));
        let region = row(&flat).model.as_ref().unwrap().turn.region;
        assert!(
            !matches!(region, Some(Region::Between { .. })),
            "{region:?}"
        );
    }

    #[test]
    fn fewer_than_six_people_or_three_places_are_not_judged() {
        assert_eq!(verdict(&analysed(liked(5, |_| 1.0, 0.01))), Some(TooFew));
        let two = on_the_dial().replace("car = { dial = \"-1\" }", "car = { mean = true }");
        let two = analysed_by(&two, liked(24, |_| 1.0, 0.01));
        assert!(two.congruence.is_empty());
        assert_eq!(verdict(&two), None);
        // Without a style nobody's distance is known.
        let mut unknown = liked(24, |_| 1.0, 0.01);
        unknown
            .conditions
            .iter_mut()
            .for_each(|row| row.adb_hat = None);
        let unknown = analysed(unknown);
        assert_eq!((row(&unknown).n, row(&unknown).model.is_some()), (0, false));
        assert!(row(&unknown).why_not.is_some());
        assert_eq!(verdict(&unknown), None);
    }

    #[test]
    fn a_rating_whose_low_values_are_better_is_turned() {
        let mut tables = liked(24, |_| 1.0, 0.01);
        for score in &mut tables.post {
            score.value = score.value.map(|trust| 8.0 - trust);
        }
        let keyed = |lower: bool| {
            let scale = format!(
                "id = \"jian_trust\"\ntitle = \"T\"\nreference = \"r\"\nitems = 1\nmin = 1\nmax = 7\nscoring = \"mean\"\n\
                 [[subscales]]\nid = \"overall\"\ntitle = \"T\"\nitems = [1]\nlower_is_better = {lower}"
            );
            vec![Scale::from_toml(&scale).unwrap()]
        };
        tables.scales = keyed(true);
        assert_eq!(verdict(&analysed(tables.clone())), Some(Shown));
        tables.scales = keyed(false);
        assert_eq!(verdict(&analysed(tables)), Some(Fails));
    }
}
