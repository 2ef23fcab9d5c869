//! What a population comes to: each parameter's distribution, and how much people differ from themselves.

use super::population::{DriverParams, Population};
use crate::normal::standard_normal;
use maveric_domain::{LatentTraits, stream_seed};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

/// How one driving parameter is distributed over a population, and from day to day.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Distribution {
    /// Which parameter, as in `study_data/population_sources.toml`.
    pub quantity: &'static str,
    /// `m/s`, `s` or `m/s²`: of mean, SDs, range and deciles.
    pub unit: &'static str,
    /// Number of people.
    pub n: usize,
    /// Mean over people, on their first day.
    pub mean: f64,
    /// SD over people, on their first day.
    pub sd: f64,
    /// Lowest and highest.
    pub range: [f64; 2],
    /// The nine deciles, 10 % to 90 %.
    pub deciles: [f64; 9],
    /// Test-retest correlation: of two days of the same people; `None` where nobody differs from anybody.
    pub retest_r: Option<f64>,
    /// SD of one person from day to day: that of the differences between two days, over √2.
    pub day_sd: f64,
    /// SD from one encounter to the next on top, in the parameter's unit; 0 for what stays the same all day.
    pub encounter_sd: f64,
}

type Read = fn(&DriverParams) -> f64;

/// Name, unit and where to find each parameter.
const QUANTITIES: [(&str, &str, Read); 7] = [
    ("desired_speed", "m/s", |p| p.desired_speed_mps),
    ("following_time_gap", "s", |p| p.following_time_gap_s),
    ("passing_time_gap", "s", |p| p.passing_time_gap_s),
    ("passing_gain", "m/s", |p| p.passing_gain_mps),
    ("merge_back_time_gap", "s", |p| p.merge_back_time_gap_s),
    ("lane_change_duration", "s", |p| p.lane_change_s),
    ("acceleration", "m/s²", |p| p.acceleration_mps2),
];

/// The distributions of `n` people of `population`, each on two days.
///
/// Latent traits are standard normal. The same `seed` gives the same people, and the first of them are the same
/// whatever `n`. Empty for fewer than two people.
///
/// # Example
/// ```
/// # use maveric_simulator::{Scenario, population_table};
/// let scenario = Scenario::paper();
/// let table = population_table(&scenario.settings().drivers, 200, 1);
/// let gap = table.iter().find(|d| d.quantity == "following_time_gap").expect("one of them");
/// assert!((gap.mean - 1.15).abs() < 0.1 && gap.retest_r.is_some_and(|r| r > 0.9));
/// ```
pub fn population_table(population: &Population, n: usize, seed: u64) -> Vec<Distribution> {
    if n < 2 {
        return Vec::new();
    }
    let person = |i: usize| {
        let person_seed = stream_seed(seed, &["population", &i.to_string()]);
        let mut rng = Pcg64Mcg::seed_from_u64(person_seed);
        let traits = LatentTraits::draw(|| standard_normal(&mut rng));
        let day =
            |name| population.draw(&traits, person_seed, stream_seed(person_seed, &["day", name]));
        [day("first"), day("second")]
    };
    let people: Vec<[DriverParams; 2]> = (0..n).map(person).collect();
    let distribution = |&(quantity, unit, read): &(&'static str, &'static str, Read)| {
        let day = |k: usize| -> Vec<f64> { people.iter().map(|days| read(&days[k])).collect() };
        let encounter = |mean: f64| match quantity {
            "passing_time_gap" => mean * log_normal_sd(population.noise.passing_time_gap_log_sd),
            "merge_back_time_gap" => mean * log_normal_sd(population.noise.merge_back_log_sd),
            "passing_gain" => population.noise.passing_gain_sd_mps,
            "desired_speed" => population.noise.speed_wander_sd_mps,
            _ => 0.0,
        };
        summary(quantity, unit, &day(0), &day(1), encounter)
    };
    QUANTITIES.iter().map(distribution).collect()
}

/// SD over mean of exp(s·N).
fn log_normal_sd(s: f64) -> f64 {
    libm::expm1(s * s).sqrt()
}

fn mean_of(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn sum_of_products(x: &[f64], y: &[f64]) -> f64 {
    let (mx, my) = (mean_of(x), mean_of(y));
    x.iter().zip(y).map(|(a, b)| (a - mx) * (b - my)).sum()
}

fn summary(
    quantity: &'static str,
    unit: &'static str,
    first: &[f64],
    second: &[f64],
    encounter: impl Fn(f64) -> f64,
) -> Distribution {
    let n = first.len();
    let mean = mean_of(first);
    let free = (n - 1) as f64;
    let (var1, var2) = (sum_of_products(first, first), sum_of_products(second, second));
    let mut sorted = first.to_vec();
    sorted.sort_by(f64::total_cmp);
    let quantile = |q: f64| {
        let rank = q * free;
        let below = rank.floor() as usize;
        let above = (below + 1).min(n - 1);
        sorted[below] + (rank - below as f64) * (sorted[above] - sorted[below])
    };
    let differences: Vec<f64> = first.iter().zip(second).map(|(a, b)| a - b).collect();
    Distribution {
        quantity,
        unit,
        n,
        mean,
        sd: (var1 / free).sqrt(),
        range: [sorted[0], sorted[n - 1]],
        deciles: std::array::from_fn(|i| quantile(0.1 * (i + 1) as f64)),
        retest_r: (var1 > 0.0 && var2 > 0.0)
            .then(|| sum_of_products(first, second) / (var1 * var2).sqrt()),
        day_sd: (sum_of_products(&differences, &differences) / free / 2.0).sqrt(),
        encounter_sd: encounter(mean),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of<'a>(table: &'a [Distribution], quantity: &str) -> &'a Distribution {
        table.iter().find(|d| d.quantity == quantity).unwrap()
    }

    #[test]
    fn a_population_has_the_spread_of_its_laws() {
        let table = population_table(&Population::default(), 4000, 1);
        let speed = of(&table, "desired_speed");
        assert!((speed.mean / 0.44704 - 66.5).abs() < 0.4, "{speed:?}");
        assert!((speed.sd / 0.44704 - 6.3).abs() < 0.4, "{speed:?}");
        let duration = of(&table, "lane_change_duration");
        assert!((duration.mean - 4.8).abs() < 0.1 && (duration.sd - 0.48).abs() < 0.05);
        assert!((duration.deciles[4] - 4.8).abs() < 0.05);
        let gap = of(&table, "following_time_gap");
        assert!(gap.range[0] >= 0.7 && gap.range[1] <= 3.0);
        assert!(gap.deciles.windows(2).all(|d| d[0] <= d[1]));
    }

    #[test]
    fn people_differ_from_themselves_by_the_days_share() {
        let table = population_table(&Population::default(), 4000, 2);
        // Exponential laws: a day moves the parameter by 5 %.
        let gap = of(&table, "following_time_gap");
        assert!((gap.day_sd / gap.mean - 0.05).abs() < 0.006, "{gap:?}");
        let speed = of(&table, "desired_speed");
        assert!((speed.day_sd / speed.mean - 0.012).abs() < 0.001);
        assert!(speed.retest_r.unwrap() > 0.95);
        // What has no day of its own is the same on both.
        let steady = of(&table, "lane_change_duration");
        assert!((steady.retest_r.unwrap() - 1.0).abs() < 1e-12 && steady.day_sd < 1e-12);
        assert!(of(&table, "passing_time_gap").encounter_sd > 0.2);
    }

    #[test]
    fn the_same_seed_gives_the_same_table_and_one_person_none() {
        let table = population_table(&Population::default(), 50, 3);
        assert_eq!(table, population_table(&Population::default(), 50, 3));
        assert_ne!(table, population_table(&Population::default(), 50, 4));
        assert!(population_table(&Population::default(), 1, 3).is_empty());
    }

    #[test]
    fn every_quantity_has_an_entry_in_the_list_of_sources() {
        let text = maveric_data::POPULATION_SOURCES;
        let sources: toml::Table = text.parse().unwrap();
        let listed: Vec<&str> = sources["source"]
            .as_array()
            .unwrap()
            .iter()
            .map(|entry| {
                let citation = entry["citation"].as_str().unwrap();
                let checked = entry["checked"].as_bool().unwrap();
                // What has been read says where.
                assert_eq!(checked, entry.get("read_at").is_some(), "{citation}");
                entry["quantity"].as_str().unwrap()
            })
            .collect();
        for distribution in population_table(&Population::default(), 2, 1) {
            assert!(listed.contains(&distribution.quantity), "{distribution:?}");
        }
    }
}
