//! Draws synthetic drivers, lets them drive, and prints what calibration section 2 gives for its thousand.
//!
//! `cargo run --release -p maveric-simulator --example population -- 200` for people,
//! the same with ` rule` for a simple rule in the automated car, ` table` for the distributions of their parameters as CSV, or a
//! file of another population, such as ` study_data/population_misspecified.toml`.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

#[path = "../tests/support/passing.rs"]
mod passing;

use maveric_domain::{Drive, DriveMeta, DrivenBy, LatentTraits, drive::Direction, stream_seed};
use maveric_simulator::{
    Driver, DriverParams, People, Rollout, Scenario, SimulatorError, population_table, rollout,
};
use passing::passing;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// Name, mean and SD in calibration, and its correlations with a and b where given.
const ROWS: [(&str, &str); 9] = [
    ("velocity, mph", "65.5 ± 5.9   r(a)  .57"),
    ("lane changes", "8.9 ± 2.9    r(a)  .51"),
    ("headway time, s", "1.8 ± .6     r(a) -.50"),
    ("merge back, m", "46 ± 16      r(a) -.47"),
    ("merge back, s", "1.5 ± .5     r(a) -.62"),
    ("left-lane share", ".22 ± .12    r(a) -.01"),
    ("min. headway, m", "31 ± 10      r(a) -.01 r(b) .74"),
    ("following, s", "median 63, 5% under 17"),
    ("leads met", "six in 98%"),
];

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn sd(values: &[f64]) -> f64 {
    let m = mean(values);
    (values.iter().map(|v| (v - m).powi(2)).sum::<f64>() / (values.len() - 1) as f64).sqrt()
}

fn correlation(x: &[f64], y: &[f64]) -> f64 {
    let (mx, my) = (mean(x), mean(y));
    let covariance: f64 = x.iter().zip(y).map(|(a, b)| (a - mx) * (b - my)).sum();
    covariance / ((x.len() - 1) as f64 * sd(x) * sd(y))
}

/// The figures of one drive, in the order of [`ROWS`].
fn figures(drive: &Drive, leads: u32) -> [Option<f64>; 9] {
    let rows = drive.rows();
    let changes: Vec<_> = drive.lane_changes().into_iter().filter(|c| c.completed).collect();
    let some_mean = |v: Vec<f64>| (!v.is_empty()).then(|| mean(&v));
    let headway = changes
        .iter()
        .filter(|c| c.direction == Direction::Left && rows.lead_present[c.start])
        .map(|c| rows.lead_dx_m[c.start] / rows.ego_speed_mps[c.start]);
    let back = || {
        let right = changes.iter().filter(|c| c.direction == Direction::Right);
        right.filter_map(|c| Some((c.gap_behind_m?, rows.ego_speed_mps[c.start])))
    };
    let nearest = (0..drive.len())
        .filter(|&i| rows.lead_present[i] && rows.changing[i] == 0 && rows.lead_dx_m[i] > 0.0)
        .filter(|&i| rows.lead_dy_m[i].abs() < 1.83)
        .map(|i| rows.lead_dx_m[i])
        .min_by(f64::total_cmp);
    let share = |flags: &mut dyn Iterator<Item = bool>| flags.filter(|&f| f).count() as f64;
    [
        Some(mean(&rows.ego_speed_mps) / 0.44704),
        Some(changes.len() as f64),
        some_mean(headway.collect()),
        some_mean(back().map(|(gap, _)| gap).collect()),
        some_mean(back().map(|(gap, speed)| gap / speed).collect()),
        Some(share(&mut rows.lane.iter().map(|&l| l == 1)) / drive.len() as f64),
        nearest,
        Some(share(&mut rows.following.iter().copied()) / drive.rate_hz()),
        Some(f64::from(leads)),
    ]
}

fn drive_of(rollout: &Rollout) -> Result<Drive, SimulatorError> {
    let meta = DriveMeta::named("example", "example", "own", DrivenBy::Synthetic)?;
    Ok(Drive::from_recording(meta, &rollout.recording)?)
}

/// The distributions of `people` people's parameters, as CSV.
fn print_table(people: usize) {
    println!(
        "quantity,unit,n,mean,sd,lowest,d1,d2,d3,d4,d5,d6,d7,d8,d9,highest,retest_r,day_sd,encounter_sd"
    );
    for d in population_table(&Scenario::paper().settings().drivers, people, 1) {
        let deciles = d.deciles.map(|value| format!("{value:.3}")).join(",");
        let [lowest, highest] = d.range;
        let retest = d.retest_r.map_or(String::new(), |r| format!("{r:.3}"));
        println!(
            "{},{},{},{:.3},{:.3},{lowest:.3},{deciles},{highest:.3},{retest},{:.3},{:.3}",
            d.quantity, d.unit, d.n, d.mean, d.sd, d.day_sd, d.encounter_sd
        );
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let people: u64 = arguments.next().map_or(Ok(60), |text| text.parse())?;
    let how = arguments.next();
    if how.as_deref() == Some("table") {
        print_table(people as usize);
        return Ok(());
    }
    let automated = how.as_deref() == Some("rule");
    let scenario = Scenario::paper();
    let population = match &how {
        Some(path) if !automated => toml::from_str(&std::fs::read_to_string(path)?)?,
        _ => People::Drivers(Box::new(scenario.settings().drivers.clone())),
    };
    let mut latents: [Vec<f64>; 3] = Default::default();
    let mut table: Vec<[Option<f64>; 9]> = Vec::new();
    let mut counts = [0_u32; 5];
    for person in 0..people {
        let mut rng = Pcg64Mcg::seed_from_u64(stream_seed(1, &["person", &person.to_string()]));
        let traits = LatentTraits::draw(|| StandardNormal.sample(&mut rng));
        let usual = DriverParams::draw(&traits, person, person);
        let drawn = population.draw(&traits, person, person);
        let mut planner = passing(usual.desired_speed().0);
        let driver = if automated {
            Driver::Automated(&mut planner, &scenario.settings().controllers)
        } else {
            Driver::from(&drawn)
        };
        let driven = rollout(&scenario, driver, stream_seed(2, &[&person.to_string()]))?;
        let report = driven.report;
        let events = [
            report.collisions,
            report.rule_violations,
            report.interventions,
            report.held_changes,
            report.given_up_changes,
        ];
        for (total, one) in counts.iter_mut().zip(events) {
            *total += one;
        }
        table.push(figures(&drive_of(&driven)?, report.leads));
        let [a, b, c] = &mut latents;
        a.push(traits.aggressiveness);
        b.push(traits.spacing);
        c.push(traits.pace);
    }
    println!("{people} drives: mean ± SD [5% 50% 95%], n, r with a, b, c; calibration");
    for (i, (name, expected)) in ROWS.iter().enumerate() {
        let has: Vec<usize> = (0..table.len()).filter(|&p| table[p][i].is_some()).collect();
        let mut values: Vec<f64> = has.iter().filter_map(|&p| table[p][i]).collect();
        let r = |latent: &[f64]| {
            let those: Vec<f64> = has.iter().map(|&p| latent[p]).collect();
            correlation(&those, &values)
        };
        let [ra, rb, rc] = [r(&latents[0]), r(&latents[1]), r(&latents[2])];
        let (m, s, n) = (mean(&values), sd(&values), values.len());
        values.sort_by(f64::total_cmp);
        let quantile = |q: f64| values[(q * (n - 1) as f64) as usize];
        println!(
            "{name:16} {m:7.2} ± {s:5.2} [{:6.2} {:6.2} {:6.2}] n {n:4}  a {ra:5.2} b {rb:5.2} c {rc:5.2}  | {expected}",
            quantile(0.05),
            quantile(0.5),
            quantile(0.95),
        );
    }
    let [collisions, violations, interventions, held, given_up] = counts;
    println!(
        "collisions {collisions}, rule violations {violations}, interventions {interventions}, \
         changes held {held}, given up {given_up}"
    );
    Ok(())
}
