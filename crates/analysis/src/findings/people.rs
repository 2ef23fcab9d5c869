//! What people want: their own style or another, and whether their traits tell.

use crate::{
    finding::{Finding, Part, Question},
    result::{HomophilyRow, Preference},
    which::WhichRide,
};

/// By every rating fewer than half have to put another style above their own.
pub(super) fn preferred(rated: &[Preference]) -> Option<Finding> {
    let rated = rated.iter().filter(|p| p.n > 0);
    let parts = rated.flat_map(|p| {
        p.others.iter().map(move |other| {
            let key = format!("{}.{}", p.rating, other.condition);
            Part::share(key, p.n, other.share.as_ref(), (0.0, 0.5))
        })
    });
    let parts: Vec<Part> = parts.collect();
    (!parts.is_empty()).then(|| Finding::every(Question::Preferred, parts))
}

/// More than half have to name the ride in their own style; a choice of two is right by chance in one of two.
pub(super) fn which(ride: Option<&WhichRide>) -> Option<Finding> {
    let ride = ride?;
    let everybody = ride.all.as_ref()?;
    let key = format!("which.{}-{}", ride.own, ride.other);
    let part = Part::share(key, everybody.n, Some(&everybody.share), (0.5, 1.0));
    Some(Finding::every(Question::Which, vec![part]))
}

/// One correlation of the declared family is enough.
pub(super) fn personality(rows: &[HomophilyRow]) -> Option<Finding> {
    let tested = rows.iter().filter(|row| row.p_holm.is_some());
    let part = |row: &HomophilyRow| {
        let c = &row.correlation;
        Part::differs(row.key(), c.n, (c.r, row.p_holm)).with_interval(row.simultaneous)
    };
    let parts: Vec<Part> = tested.map(part).collect();
    (!parts.is_empty()).then(|| Finding::one(Question::Personality, parts))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Above, Correlation, Verdict, finding,
        testing::{analysed, score, tables},
    };
    use Verdict::{Fails, NotShown, Shown, TooFew};
    use maveric_domain::Moment;
    use maveric_stats::proportion;

    fn preference(above: &[usize], n: usize) -> Preference {
        let condition = |text: &str| text.parse().unwrap();
        let other = |above: &usize| Above {
            condition: condition("fast"),
            above: *above,
            share: proportion(*above, n, 0.95).ok(),
            not_below: n,
            not_below_share: proportion(n, n, 0.95).ok(),
        };
        Preference {
            rating: "jian_trust.overall".parse().unwrap(),
            title: String::new(),
            less_is_better: false,
            own: condition("same"),
            n,
            others: above.iter().map(other).collect(),
        }
    }

    #[test]
    fn the_own_style_is_preferred_when_few_put_another_above_it() {
        let judged = |above: &[usize], n| preferred(&[preference(above, n)]).unwrap().verdict;
        assert_eq!(judged(&[3, 2], 24), Shown);
        assert_eq!(judged(&[3, 12], 24), NotShown);
        assert_eq!(judged(&[3, 21], 24), Fails);
        assert_eq!(judged(&[0], 5), TooFew);
        assert_eq!(preferred(&[preference(&[], 24)]), None);
        assert_eq!(preferred(&[preference(&[0], 0)]), None);
    }

    #[test]
    fn whoever_rates_another_car_higher_counts_against_the_own_style() {
        // Everybody rates the car at 0 and another: one of the two clearly higher.
        let rated = |same: f64, fast: f64| {
            let mut tables = tables();
            tables.post.clear();
            for i in 0..6 {
                for (condition, value) in
                    [("same", same), ("fast", fast), ("slow", 2.0), ("across", 2.0)]
                {
                    let after = Moment::After(condition.parse().unwrap());
                    let wobble = 0.01 * i as f64;
                    tables.post.push(score(i, after, "jian_trust", "overall", value + wobble));
                }
            }
            let analysis = analysed(tables);
            finding::by_question(&analysis.findings, Question::Preferred).unwrap().clone()
        };
        let parts = |found: Finding| {
            found.parts.iter().map(|p| (p.of.clone(), p.estimate.unwrap())).collect::<Vec<_>>()
        };
        assert_eq!(rated(5.0, 3.0).verdict, Shown);
        assert_eq!(parts(rated(3.0, 5.0))[0], ("jian_trust.overall.fast".to_owned(), 1.0));
        assert_eq!(rated(3.0, 5.0).verdict, Fails);
    }

    #[test]
    fn a_trait_tells_when_its_correlation_holds_among_all_that_were_declared() {
        let rows = analysed(tables()).homophily;
        let judged = |p: f64, p_holm: Option<f64>, n: usize| {
            let mut row = rows[0].clone();
            row.correlation = Correlation { n, r: Some(-0.6), p: Some(p), ..row.correlation };
            row.p_holm = p_holm;
            personality(&[row]).map(|f| f.verdict)
        };
        assert_eq!(judged(0.001, Some(0.04), 24), Some(Shown));
        assert_eq!(judged(0.001, Some(0.05), 24), Some(NotShown));
        assert_eq!(judged(0.001, Some(0.04), 5), Some(TooFew));
        assert_eq!(judged(0.001, None, 24), None);
    }

    #[test]
    fn what_could_hold_is_told_of_the_pair_that_most_people_have_and_of_a_family_of_that_size() {
        let rows = analysed(tables()).homophily;
        let of = |n: usize, p_holm: Option<f64>| {
            let mut row = rows[0].clone();
            (row.correlation.n, row.p_holm) = (n, p_holm);
            row
        };
        // t / √(df + t²): t(22) of .025 is 2.405, t(18) of .05 is 2.101.
        let two = [of(20, Some(0.5)), of(24, Some(0.5)), of(30, None)];
        let (n, least) = crate::least_that_holds(&two).unwrap();
        assert_eq!(n, 24);
        assert!((least - 0.456_3).abs() < 1e-3, "{least}");
        let (n, least) = crate::least_that_holds(&two[..1]).unwrap();
        assert_eq!(n, 20);
        assert!((least - 0.443_8).abs() < 1e-3, "{least}");
        assert_eq!(crate::least_that_holds(&[of(24, None)]), None);
    }
}
