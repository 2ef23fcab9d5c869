//! What became of the questions that rehearsals and validations ask: which rates, shares and intervals decide, and by which rule.

use crate::{
    dial_trial::{LearnedFrom, Method, TrialError},
    leave_out::{By, Direction, Order, Whose},
    power::POWER,
    rates::{ALPHA, Cell, FamilyRate, TestRate},
    validation::{Agreement, Dial, Fidelity, Identification, Metric, Reading, mean},
};
use maveric_analysis::{Finding, Part, Question, verdict::FEWEST};
use maveric_domain::design::Sign;
use maveric_stats::{Proportion, proportion};

/// Is anything found where there is nothing? Every family has to be kept at its level after Holm.
pub fn families(cell: &Cell) -> Finding {
    let part =
        |f: &FamilyRate| Part::share(&f.family, cell.studies, f.any_holm.as_ref(), (0.0, ALPHA));
    Finding::every(Question::Families, cell.families.iter().map(part).collect())
}

/// Is each test as strict as it says? At most one in twenty may look too lax by its own interval.
pub fn single(cell: &Cell) -> Finding {
    let rates: Vec<&Proportion> = cell.tests.iter().filter_map(|t| t.rate.as_ref()).collect();
    let above = rates.iter().filter(|rate| rate.low > ALPHA).count();
    let share = proportion(above, rates.len().max(1), 0.95).ok();
    let part = Part::share("tests above .05", rates.len(), share.as_ref(), (0.0, ALPHA));
    Finding::every(Question::Single, vec![part])
}

/// Would studies of this size show what is there? Each declared hypothesis has to be shown in more than [`POWER`] of them; without any, of
/// each part of the analysis the test that most studies found, which flatters.
pub fn power(cell: &Cell) -> Finding {
    let part = |key: &str, share: Option<&Proportion>| {
        // A question that no study could judge is as one of too few.
        let judged = share.map_or(cell.studies.min(1), |_| cell.studies);
        Part::share(key, judged, share, (POWER, f64::INFINITY))
    };
    let parts = if cell.hypotheses.is_empty() {
        let best = cell.best_tests().into_iter();
        best.map(|t: &TestRate| {
            let key = format!("{}: {}", t.part.title(), t.key);
            part(&key, t.rate.as_ref())
        })
        .collect()
    } else {
        let declared = cell.hypotheses.iter();
        declared.map(|h| part(&h.says, h.shown.as_ref())).collect()
    };
    Finding::every(Question::Power, parts)
}

/// Does the model know how far to turn the dial? It has to come near for more people than leaving everybody at their own style does.
pub fn recommends(learned: &LearnedFrom) -> Finding {
    let score = |method| learned.scores.iter().find(|s| s.method == method);
    let floor = score(Method::OwnForAll).and_then(|s| s.within_5);
    let floor = floor.map_or(0.0, |share| share.estimate);
    let (people, share) = score(Method::AfterFourConditions)
        .and_then(|s| Some((s.people, s.within_5?)))
        .unzip();
    let part = Part::share(
        "within 5 points",
        people.unwrap_or(0),
        share.as_ref(),
        (floor, f64::INFINITY),
    );
    Finding::every(Question::Recommends, vec![part])
}

/// After how many trials the two ways of choosing are held beside each other: half of them.
pub fn halfway(search: &[TrialError]) -> Option<&TrialError> {
    search.get(search.len() / 2)
}

/// Does choosing the next ride save rides? Its error has to be below the grid's, both taken as independent.
pub fn saves(search: &[TrialError]) -> Option<Finding> {
    let middle = halfway(search)?;
    let difference = middle.active.0 - middle.grid.0;
    let half = libm::hypot(middle.active.1, middle.grid.1);
    let part = Part::within(
        format!("after {} trials", middle.trials),
        FEWEST.max(search.len()),
        (
            Some(difference),
            Some((difference - half, difference + half)),
        ),
        (f64::NEG_INFINITY, 0.0),
    );
    Some(Finding::every(Question::Active, vec![part]))
}

/// A number over several models: mean, lowest and highest; nothing where no model has it.
pub fn over_models(values: impl IntoIterator<Item = Option<f64>>) -> Option<(f64, (f64, f64))> {
    let values: Vec<f64> = values.into_iter().flatten().collect();
    let low = values.iter().copied().reduce(f64::min)?;
    let high = values.iter().copied().reduce(f64::max)?;
    Some((mean(&values)?, (low, high)))
}

/// Is the car like its driver? In every measure the least accurate model has to be above guessing the average driver.
pub fn own_style(models: &[&[Fidelity]]) -> Finding {
    let first = models.first().copied().unwrap_or_default();
    let part = |(k, row): (usize, &Fidelity)| {
        let over = |number: fn(&Fidelity) -> Option<f64>| {
            over_models(models.iter().map(|m| m.get(k).and_then(number)))
        };
        let floor = over(|f| f.population_mean).map_or(f64::NEG_INFINITY, |(mean, _)| mean);
        let (mean, range) = over(|f| f.mimic).unzip();
        Part::within(row.title, row.n, (mean, range), (floor, f64::INFINITY))
    };
    Finding::every(
        Question::OwnStyle,
        first.iter().enumerate().map(part).collect(),
    )
}

/// The way of telling drivers apart that decides: by a distance that knows how people vary from day to day.
pub fn deciding(identity: &[Identification]) -> Option<&Identification> {
    let by_days = |i: &&Identification| i.metric == Metric::WithinPerson;
    identity.iter().find(by_days).or(identity.first())
}

/// Is a driver recognised on another day? For every model more often than by chance.
pub fn recognised(models: &[&[Identification]]) -> Option<Finding> {
    let part = |i: &Identification| {
        let chance = 1.0 / i.n.max(1) as f64;
        let interval = Some((i.low, i.high));
        Part::within(
            i.what,
            i.n,
            (Some(i.rate), interval),
            (chance, f64::INFINITY),
        )
    };
    let parts: Vec<Part> = models
        .iter()
        .filter_map(|m| deciding(m))
        .map(part)
        .collect();
    (!parts.is_empty()).then(|| Finding::every(Question::Recognised, parts))
}

/// Does the dial do as it says? For every model, measure and side more than half of the drivers have to change the right way.
pub fn dial(models: &[&[Dial]]) -> Finding {
    let rows = models.iter().copied().flatten();
    let sides = rows.flat_map(|d| [(d, "+", &d.aggressive), (d, "-", &d.cautious)]);
    let part = |(d, side, right): (&Dial, &str, &crate::validation::Right)| {
        let share = proportion(right.right, right.n, 0.95).ok();
        let key = format!("{} {side}", d.title);
        Part::share(key, right.n, share.as_ref(), (0.5, f64::INFINITY))
    };
    Finding::every(Question::Dial, sides.map(part).collect())
}

/// Does driving alone tell the score? For every model the correlation of the fit without it has to be above 0.
pub fn style(models: &[&[Agreement]]) -> Option<Finding> {
    let alone = |m: &&[Agreement]| {
        m.iter()
            .find(|a| a.reading == Reading::WithoutScore)
            .cloned()
    };
    let part = |a: Agreement| {
        let estimate = (a.adb, a.adb_interval);
        Part::within(a.reading.title(), a.n, estimate, (0.0, f64::INFINITY))
    };
    let parts: Vec<Part> = models.iter().filter_map(alone).map(part).collect();
    (!parts.is_empty()).then(|| Finding::every(Question::Style, parts))
}

/// Does the car stay clear of others? One collision in one of its drives is enough to fail.
pub fn safe(collisions: usize, drives: usize) -> Finding {
    let part = Part::never("collision", collisions, drives);
    Finding::every(Question::Safe, vec![part])
}

/// Are drives of people whom the model has not met placed as they were told to drive? Every order by the p of exchanged roles.
pub fn ordered(orders: &[&Order]) -> Finding {
    let part = |order: &&Order| {
        let line = order.by(By::Line)?;
        let chance = order.chance;
        let above = line.share.map(|share| share.estimate - chance);
        // The p of the side on which it came out.
        let p = match above {
            Some(above) if above < 0.0 => line.p_below,
            _ => line.p,
        };
        let interval = line.share.map(|s| (s.low - chance, s.high - chance));
        let part = Part::directed(order.asked.title(), line.n, (above, p), Sign::Plus);
        Some(part.with_interval(interval))
    };
    Finding::every(Question::Order, orders.iter().filter_map(part).collect())
}

/// Does the line say more than speed alone? In every order the paired difference of the two, in spreads between people, has to lie
/// above 0.
pub fn beyond_speed(orders: &[&Order]) -> Finding {
    let part = |order: &&Order| {
        let beyond = order.by(By::Line)?.beyond_speed;
        let interval = beyond.and_then(|b| b.low.zip(b.high));
        let estimate = (beyond.map(|b| b.mean), interval);
        let n = beyond.map_or(0, |b| b.n);
        let ends = (0.0, f64::INFINITY);
        Some(Part::within(order.asked.title(), n, estimate, ends))
    };
    Finding::every(
        Question::BeyondSpeed,
        orders.iter().filter_map(part).collect(),
    )
}

/// Is a driver whom the model has not met recognised in another drive? By the style more often than by chance.
pub fn recognised_unmet<'a>(rows: impl IntoIterator<Item = &'a Whose>) -> Finding {
    let by_style = rows.into_iter().filter(|w| w.by == By::Line);
    let part = |w: &Whose| {
        let key = format!("{} among {}", w.sought, w.among);
        Part::share(key, w.n, w.share.as_ref(), (w.chance, f64::INFINITY))
    };
    Finding::every(Question::Recognised, by_style.map(part).collect())
}

/// Does the dial point where people themselves go? Better than directions drawn in style space.
pub fn pointed(directions: &[&Direction]) -> Finding {
    let part = |d: &&Direction| {
        let better = d.dial.zip(d.drawn).map(|(dial, drawn)| dial - drawn);
        // The p of the side on which it came out.
        let p = match better {
            Some(better) if better < 0.0 => d.p_below,
            _ => d.p,
        };
        Part::directed("dial - directions", d.n, (better, p), Sign::Plus)
    };
    Finding::every(Question::Direction, directions.iter().map(part).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Score, outcomes::Part as Of, validation::Right};
    use maveric_analysis::Verdict::{self, Fails, NotAsked, NotShown, Shown, TooFew};

    fn share(hits: usize, n: usize) -> Option<Proportion> {
        proportion(hits, n, 0.95).ok()
    }

    fn cell(studies: usize) -> Cell {
        Cell {
            participants: 24,
            effect_scale: 0.0,
            studies,
            tests: Vec::new(),
            families: Vec::new(),
            hypotheses: Vec::new(),
            findings: Vec::new(),
        }
    }

    #[test]
    fn a_family_is_kept_at_its_level_after_holm_or_fails() {
        let judged = |holm: &[usize]| {
            let family = |hits: &usize| FamilyRate {
                family: "panel".to_owned(),
                tests: 3,
                any_uncorrected: share(900, 1000),
                any_holm: share(*hits, 1000),
            };
            let families = holm.iter().map(family).collect();
            super::families(&Cell {
                families,
                ..cell(1000)
            })
            .verdict
        };
        assert_eq!(
            [judged(&[20, 30]), judged(&[50]), judged(&[20, 90])],
            [Shown, NotShown, Fails]
        );
        assert_eq!(judged(&[]), NotAsked);
    }

    #[test]
    fn one_test_in_twenty_may_look_lax_and_no_more() {
        let judged = |lax: usize| {
            let test = |i: usize| TestRate {
                part: Of::Nearer,
                key: format!("t{i}"),
                studies: 1000,
                rejected: 0,
                rate: share(if i < lax { 100 } else { 50 }, 1000),
                holm: None,
                mean_estimate: None,
                mean_when_significant: None,
                above_zero: None,
            };
            single(&Cell {
                tests: (0..200).map(test).collect(),
                ..cell(1000)
            })
            .verdict
        };
        assert_eq!(
            [judged(2), judged(10), judged(30)],
            [Shown, NotShown, Fails]
        );
    }

    #[test]
    fn a_recommendation_has_to_beat_leaving_everybody_at_their_own_style() {
        let judged = |ours: usize, floor: usize| {
            let score = |method, hits| Score {
                method,
                people: 100,
                within_5: share(hits, 100),
                mean_error: 5.0,
                mean_error_half: 1.0,
                covered: None,
            };
            recommends(&LearnedFrom {
                participants: 48,
                scores: vec![
                    score(Method::OwnForAll, floor),
                    score(Method::AfterFourConditions, ours),
                    score(Method::Ceiling, 99),
                ],
                shown: Vec::new(),
            })
            .verdict
        };
        assert_eq!(
            [judged(80, 40), judged(45, 40), judged(20, 40)],
            [Shown, NotShown, Fails]
        );
    }

    #[test]
    fn choosing_saves_rides_when_its_error_is_below_the_grids_after_half_of_them() {
        let judged = |middle: f64| {
            let trial = |trials, active| TrialError {
                trials,
                active: (active, 0.3),
                grid: (5.0, 0.4),
                within_5: (0.5, 0.4),
            };
            // The first and the last say the opposite.
            let search = [
                trial(0, 10.0 - middle),
                trial(1, middle),
                trial(2, 10.0 - middle),
            ];
            saves(&search).unwrap().verdict
        };
        // The half of the difference is .5.
        assert_eq!(
            [judged(4.4), judged(4.6), judged(5.6)],
            [Shown, NotShown, Fails]
        );
        assert_eq!(saves(&[]), None);
    }

    fn fidelity(mimic: f64, floor: f64, n: usize) -> Fidelity {
        Fidelity {
            title: "Mean velocity",
            n,
            mimic: Some(mimic),
            population_mean: Some(floor),
            test_retest: Some(0.99),
            ..Fidelity::default()
        }
    }

    #[test]
    fn the_least_accurate_model_decides_whether_the_car_is_like_its_driver() {
        let judged = |models: [f64; 2]| {
            let rows = models.map(|mimic| vec![fidelity(mimic, 0.8, 24)]);
            own_style(&[&rows[0], &rows[1]]).verdict
        };
        assert_eq!(
            [judged([0.9, 0.81]), judged([0.9, 0.79]), judged([0.7, 0.6])],
            [Shown, NotShown, Fails]
        );
        assert_eq!(own_style(&[&[fidelity(0.9, 0.8, 5)]]).verdict, TooFew);
    }

    #[test]
    fn a_driver_is_recognised_by_the_distance_that_knows_how_people_vary() {
        let row = |metric, hits: usize, n: usize| {
            let share = share(hits, n).unwrap();
            Identification {
                what: "embedding",
                metric,
                n,
                hits,
                rate: share.estimate,
                low: share.low,
                high: share.high,
                mean_rank: 1.0,
            }
        };
        let judged = |hits, n| {
            let rows = [
                row(Metric::Euclidean, n - hits, n),
                row(Metric::WithinPerson, hits, n),
            ];
            recognised(&[&rows]).unwrap().verdict
        };
        assert_eq!(
            [judged(20, 24), judged(1, 24), judged(3, 5)],
            [Shown, NotShown, TooFew]
        );
        assert_eq!(recognised(&[]), None);
    }

    #[test]
    fn the_dial_needs_more_than_half_of_the_drivers_on_both_sides_for_every_model() {
        let judged = |up: usize, down: usize| {
            let right = |right| Right {
                right,
                n: 24,
                ..Right::default()
            };
            let row = |up, down| Dial {
                title: "Mean velocity",
                aggressive: right(up),
                cautious: right(down),
                ..Dial::default()
            };
            let (first, second) = ([row(24, 24)], [row(up, down)]);
            dial(&[&first, &second]).verdict
        };
        assert_eq!(
            [judged(24, 24), judged(24, 12), judged(2, 24)],
            [Shown, NotShown, Fails]
        );
    }

    #[test]
    fn the_score_is_told_by_driving_alone_when_the_fit_without_it_goes_with_it() {
        let judged = |low: f64, high: f64| {
            let row = |reading, interval| Agreement {
                reading,
                n: 24,
                adb: Some(0.5 * (low + high)),
                adb_interval: Some(interval),
                latent: None,
            };
            // The fit with the score says the opposite.
            let rows = [
                row(Reading::WithScore, (-high, -low)),
                row(Reading::WithoutScore, (low, high)),
            ];
            style(&[&rows]).unwrap().verdict
        };
        assert_eq!(
            [judged(0.1, 0.6), judged(-0.1, 0.6), judged(-0.6, -0.1)],
            [Shown, NotShown, Fails]
        );
        assert_eq!(style(&[&[]]), None);
    }

    #[test]
    fn one_collision_is_enough() {
        let judged = |hits, n| safe(hits, n).verdict;
        let all: [Verdict; 3] = [judged(0, 24), judged(1, 24), judged(0, 3)];
        assert_eq!(all, [Shown, Fails, TooFew]);
    }

    use crate::leave_out::{Asked, Mean, ReadOrder};

    fn order(right: usize, n: usize, p: f64, beyond: (f64, f64)) -> Order {
        let read = |by, right| ReadOrder {
            by,
            n,
            right,
            share: maveric_stats::proportion_exact(right, n, 0.95).ok(),
            p: Some(p),
            p_below: Some(1.0 - p),
            difference: None,
            beyond_speed: Some(Mean {
                n,
                mean: f64::midpoint(beyond.0, beyond.1),
                low: Some(beyond.0),
                high: Some(beyond.1),
                dz: None,
            }),
        };
        Order {
            asked: Asked {
                higher: "sporty".parse().unwrap(),
                lower: vec!["calm".parse().unwrap()],
            },
            chance: 0.5,
            // Speed says the opposite.
            readings: vec![read(By::Line, right), read(By::Speed, n - right)],
            people: Vec::new(),
            permutations: 1000,
            uncounted: Vec::new(),
        }
    }

    #[test]
    fn an_order_is_shown_by_the_p_of_exchanged_roles_and_fails_on_the_other_side() {
        let judged = |right, n, p| ordered(&[&order(right, n, p, (0.0, 0.0))]).verdict;
        assert_eq!(
            [
                judged(6, 6, 0.016),
                judged(5, 6, 0.11),
                judged(0, 6, 0.99),
                judged(5, 5, 0.031)
            ],
            [Shown, NotShown, Fails, TooFew]
        );
    }

    #[test]
    fn a_line_says_more_than_speed_where_the_paired_difference_lies_above_0() {
        let judged = |n, beyond| beyond_speed(&[&order(n, n, 0.016, beyond)]).verdict;
        assert_eq!(
            [
                judged(6, (0.1, 0.9)),
                judged(6, (-0.1, 0.9)),
                judged(6, (-0.9, -0.1)),
                judged(5, (0.1, 0.9))
            ],
            [Shown, NotShown, Fails, TooFew]
        );
    }

    #[test]
    fn a_driver_is_recognised_by_the_style_and_not_by_speed() {
        let row = |by, hits, n| Whose {
            among: "calm".parse().unwrap(),
            sought: "sporty".parse().unwrap(),
            by,
            n,
            candidates: n as f64,
            chance: 1.0 / n as f64,
            hits,
            share: maveric_stats::proportion_exact(hits, n, 0.95).ok(),
            uncounted: Vec::new(),
        };
        let judged = |hits, n| {
            recognised_unmet(&[row(By::Line, hits, n), row(By::Speed, n - hits, n)]).verdict
        };
        assert_eq!(
            [judged(20, 24), judged(2, 24), judged(5, 5)],
            [Shown, NotShown, TooFew]
        );
    }

    #[test]
    fn a_dial_has_to_point_better_than_directions_that_are_drawn() {
        let judged = |dial: f64, p: f64, n| {
            let direction = Direction {
                n,
                driven: None,
                dial: Some(dial),
                speed: None,
                speed_and_gap: None,
                directions: 1000,
                drawn: Some(0.0),
                p: Some(p),
                p_below: Some(1.0 - p),
                people: Vec::new(),
            };
            pointed(&[&direction]).verdict
        };
        assert_eq!(
            [
                judged(0.8, 0.01, 6),
                judged(0.5, 0.2, 6),
                judged(-0.8, 0.99, 6),
                judged(0.8, 0.01, 3)
            ],
            [Shown, NotShown, Fails, TooFew]
        );
    }
}
