//! How often something happens in each condition: events of people counted over time.

use rand::Rng as _;
use serde::{Deserialize, Serialize};

use crate::{
    Named, StatsError, WithinSubjects, bootstrap::stream, friedman::Friedman,
    numerics::matrix::Matrix, reasons::Reasons,
};

/// What one person did in one condition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exposed {
    /// How many there were.
    pub events: usize,
    /// Time in which one could have come, in the unit of the rate; above 0.
    pub time: f64,
}

/// Rates of events by condition, and whether they differ.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EventRates {
    /// People with at least one event: they alone tell.
    pub n: usize,
    /// People without any.
    pub never: usize,
    /// Conditions.
    pub k: usize,
    /// Events by condition, over everybody.
    pub events: Named<usize>,
    /// Time by condition, over everybody.
    pub time: Named<f64>,
    /// Events for a unit of time, over everybody.
    pub rate: Named<f64>,
    /// Rao's score statistic of the Poisson model given each person's number of events: U′ V⁻¹ U at equal rates.
    pub chi2: Option<f64>,
    /// Conditions − 1.
    pub df: usize,
    /// Share of the arrangements of the conditions within people, the seen one among them, whose statistic is at least as large.
    pub p: Option<f64>,
    /// Arrangements that were drawn.
    pub permutations: usize,
    /// Friedman's test of the rates of the same people.
    pub friedman: Option<Friedman>,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Rates of events of people (rows) in conditions, tested given each person's number of events: a Poisson model in which everybody has
/// a rate of their own. The p is by permuting the conditions within people, so that neither a person's way of pressing often nor events
/// that come in bursts make it too small.
///
/// # Errors
/// [`StatsError::TooFewConditions`] for one condition; [`StatsError::BadParameter`] for a row of another length, or time that is not above 0.
///
/// # Source
/// Cox and Lewis (1966), *The Statistical Analysis of Series of Events*, for comparing rates given the number of events.
///
/// # Example
/// ```
/// # use maveric_stats::{Exposed, event_rates};
/// let row = |a, b| vec![Exposed { events: a, time: 10.0 }, Exposed { events: b, time: 10.0 }];
/// let rows: Vec<_> = (0..8).map(|_| row(0, 3)).chain([row(0, 0)]).collect();
/// let found = event_rates(&["calm", "sporty"].map(str::to_owned), &rows, 10_000, 1)?;
/// assert_eq!((found.n, found.never), (8, 1));
/// assert!((found.chi2.unwrap() - 24.0).abs() < 1e-9); // (24 − 12)² / 6
/// assert!(found.p.unwrap() < 0.02);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn event_rates(
    conditions: &[String],
    rows: &[Vec<Exposed>],
    permutations: usize,
    seed: u64,
) -> Result<EventRates, StatsError> {
    let k = conditions.len();
    StatsError::two_conditions(k)?;
    for row in rows {
        if row.len() != k {
            let expected = format!("{k} conditions of each person");
            return Err(StatsError::parameter("row", &expected, row.len() as f64));
        }
        let usable = |time: f64| time > 0.0 && time < 1e12;
        if let Some(cell) = row.iter().find(|cell| !usable(cell.time)) {
            return Err(StatsError::parameter("time", "above 0", cell.time));
        }
    }
    let time = |j: usize| rows.iter().map(|row| row[j].time).sum::<f64>();
    let events = |j: usize| rows.iter().map(|row| row[j].events).sum::<usize>();
    let mut pressed: Vec<Vec<Exposed>> =
        rows.iter().filter(|row| row.iter().any(|cell| cell.events > 0)).cloned().collect();
    let mut undefined = Reasons::default();
    let chi2 = statistic(&pressed);
    if chi2.is_none() {
        undefined.note_all(&["chi2", "p"], "nobody has an event");
    }
    let friedman = friedman_of(conditions, &pressed);
    if friedman.is_none() {
        undefined.note("friedman", "fewer than two people have an event");
    }
    let p = chi2.map(|seen| {
        let mut generator = stream(seed, 0);
        // Two arrangements of the same numbers may differ in their last digit.
        let border = seen - 1e-9 * seen.max(1.0);
        let mut as_large = 1_usize;
        for _ in 0..permutations {
            for row in &mut pressed {
                for last in (1..k).rev() {
                    let chosen = generator.next_u64() % (last as u64 + 1);
                    row.swap(last, chosen as usize);
                }
            }
            as_large += usize::from(statistic(&pressed).is_some_and(|drawn| drawn >= border));
        }
        as_large as f64 / (permutations + 1) as f64
    });
    Ok(EventRates {
        n: pressed.len(),
        never: rows.len() - pressed.len(),
        k,
        events: Named::by_name(conditions, events),
        time: Named::by_name(conditions, time),
        rate: Named::by_name(conditions, |j| events(j) as f64 / time(j)),
        chi2,
        df: k - 1,
        p,
        permutations,
        friedman,
        undefined,
    })
}

/// U′ V⁻¹ U without the last condition: given a person's number of events each falls into a condition in proportion to its time.
fn statistic(rows: &[Vec<Exposed>]) -> Option<f64> {
    let k = rows.first()?.len();
    let mut slope = Matrix::zeros(k - 1, 1);
    let mut information = Matrix::zeros(k - 1, k - 1);
    for row in rows {
        let total: f64 = row.iter().map(|cell| cell.time).sum();
        let n: f64 = row.iter().map(|cell| cell.events as f64).sum();
        for i in 0..k - 1 {
            let share = row[i].time / total;
            slope[(i, 0)] += row[i].events as f64 - n * share;
            for j in 0..k - 1 {
                let same = if i == j { share } else { 0.0 };
                information[(i, j)] += n * (same - share * row[j].time / total);
            }
        }
    }
    let half = information.cholesky()?.half_solve(&slope);
    Some((0..k - 1).map(|i| half[(i, 0)] * half[(i, 0)]).sum())
}

fn friedman_of(conditions: &[String], rows: &[Vec<Exposed>]) -> Option<Friedman> {
    let people: Vec<String> = (1..=rows.len()).map(|i| i.to_string()).collect();
    let rate = |cell: &Exposed| cell.events as f64 / cell.time;
    let of_person = |row: &Vec<Exposed>| row.iter().map(rate).collect();
    let rates: Vec<Vec<f64>> = rows.iter().map(of_person).collect();
    let data = WithinSubjects::from_rows(conditions, &people, &rates).ok()?;
    Some(crate::friedman(&data).friedman)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(cells: &[(usize, f64)]) -> Vec<Exposed> {
        let cell = |&(events, time)| Exposed { events, time };
        cells.iter().map(cell).collect()
    }

    fn of(rows: &[Vec<Exposed>], seed: u64) -> EventRates {
        let names = ["a", "b", "c"].map(str::to_owned);
        event_rates(&names[..rows[0].len()], rows, 10_000, seed).unwrap()
    }

    #[test]
    fn with_two_conditions_it_is_the_binomial_score_and_the_p_is_that_of_turning_signs() {
        let rows = [
            row(&[(1, 10.0), (4, 20.0)]),
            row(&[(0, 10.0), (5, 20.0)]),
            row(&[(2, 10.0), (3, 20.0)]),
            row(&[(0, 10.0), (0, 20.0)]),
        ];
        let found = of(&rows, 1);
        // Of 15 events a third belongs into the first by time: (3 − 5)² / (15 · 1/3 · 2/3).
        assert!((found.chi2.unwrap() - 4.0 / (30.0 / 9.0)).abs() < 1e-12);
        assert_eq!((found.n, found.never), (3, 1));
        assert_eq!(found.events.get("b"), Some(&12));
        assert!((found.rate.get("a").unwrap() - 3.0 / 40.0).abs() < 1e-12);
        // All eight arrangements, by hand: the pairs of three people turned or not.
        let mut as_large = 0;
        for turned in 0..8_u32 {
            let mut all = rows[..3].to_vec();
            for (i, row) in all.iter_mut().enumerate() {
                if turned & (1 << i) != 0 {
                    row.swap(0, 1);
                }
            }
            as_large += u32::from(statistic(&all).unwrap() >= found.chi2.unwrap() - 1e-9);
        }
        let exact = f64::from(as_large) / 8.0;
        assert!((found.p.unwrap() - exact).abs() < 0.02, "{:?} {exact}", found.p);
    }

    #[test]
    fn the_same_seed_gives_the_same_p_and_friedman_is_that_of_the_rates() {
        let rows: Vec<Vec<Exposed>> =
            (0..9).map(|i| row(&[(i % 3, 10.0), (1 + i % 2, 10.0), ((i * 2) % 5, 10.0)])).collect();
        assert_eq!(of(&rows, 3), of(&rows, 3));
        let found = of(&rows, 3);
        let people: Vec<String> = (0..9).map(|i| i.to_string()).collect();
        let rates: Vec<Vec<f64>> =
            rows.iter().map(|r| r.iter().map(|c| c.events as f64).collect()).collect();
        let names = ["a", "b", "c"].map(str::to_owned);
        let data = WithinSubjects::from_rows(&names, &people, &rates).unwrap();
        assert_eq!(found.friedman.unwrap().p, crate::friedman(&data).friedman.p);
    }

    #[test]
    fn a_person_who_presses_in_bursts_does_not_make_it_small_and_a_difference_of_everybody_does() {
        // One of ten has forty presses in one condition: χ² alone would call it certain.
        let mut rows: Vec<Vec<Exposed>> =
            (0..10).map(|i| row(&[(i % 2, 10.0), ((i + 1) % 2, 10.0)])).collect();
        rows[0] = row(&[(40, 10.0), (0, 10.0)]);
        let burst = of(&rows, 1);
        assert!(burst.chi2.unwrap() > 30.0 && burst.p.unwrap() > 0.4, "{burst:?}");
        let all: Vec<Vec<Exposed>> = (0..10).map(|_| row(&[(0, 10.0), (2, 10.0)])).collect();
        assert!(of(&all, 1).p.unwrap() < 0.01);
    }

    #[test]
    fn nobody_with_an_event_is_no_test_and_no_time_is_refused() {
        let none = of(&[row(&[(0, 1.0), (0, 1.0)])], 1);
        assert_eq!((none.chi2, none.p, none.never), (None, None, 1));
        assert!(none.undefined.get("p").is_some());
        let names = ["a", "b"].map(str::to_owned);
        assert!(event_rates(&names, &[row(&[(0, 0.0), (0, 1.0)])], 10, 1).is_err());
        assert!(event_rates(&names[..1], &[], 10, 1).is_err());
    }
}
