//! How much of what differs between drives of made-up people is the person's, and populations in which it is a given share.
//!
//! `cargo run -p maveric-rehearsal --example retest -- measure FILE 1000 1` prints the ICC(2,1) of two drives of 1,000 people (seed 1),
//! whose habits FILE gives, measure by measure.
//! `… -- fit 0.7 1000 1` prints the file of people like those of the paper's scenario for whom it is .7.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

#[path = "../made_up/mod.rs"]
mod made_up;

use made_up::{Wrong, again, cohort, driven, people_of};
use maveric_rehearsal::validation::{Retest, Values, retest, values};
use maveric_simulator::{Law, People, Population, Scenario};

/// Measures of the first and the second drive of `n` people.
fn twice(people: &People, n: usize, seed: u64) -> Result<[Vec<Values>; 2], Wrong> {
    let first = cohort(0, n, seed)?.drives;
    let scenario = Scenario::paper();
    let values = |planned: &[_]| driven(planned, people, &scenario, seed, |d| values(&d));
    Ok([values(&first)?, values(&again(&first)?)?])
}

fn print(rows: &[Retest], first: &[Values]) {
    println!(
        "measure: ICC(2,1) [95 %], standard error of measurement, mean and SD of first drives, people, without a value"
    );
    for (k, row) in rows.iter().enumerate() {
        let known: Vec<f64> = first.iter().filter_map(|v| v[k]).collect();
        let n = known.len() as f64;
        let mean = known.iter().sum::<f64>() / n;
        let square = known.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
        let (low, high) = row.interval.unwrap_or_default();
        println!(
            "{}: {:.3} [{low:.3}, {high:.3}], {:.3}, {mean:.3} ± {:.3}, {}, {}",
            row.measure,
            row.icc.unwrap_or_default(),
            row.sem.unwrap_or_default(),
            (square / (n - 1.0)).sqrt(),
            row.n,
            row.missing
        );
    }
}

/// How far habits vary from day to day.
#[derive(Debug, Clone, Copy)]
struct OfTheDay {
    /// Share of the variance of the speed wanted that is the day's.
    speed: f64,
    /// The same of every other habit. Below 0 none of them has a day, encounters differ by this share less, and people by this share more
    /// in the gap at which they pass: what each encounter happens to be like scatters a mean headway time too much otherwise.
    rest: f64,
}

/// The usual people with other shares: how much a habit differs over the drives of all people stays as it is.
fn people(usual: &Population, of_day: OfTheDay) -> Population {
    let squares = |law: &Law| law.a * law.a + law.b * law.b + law.c * law.c + law.own * law.own;
    let split = |law: &mut Law, share: f64, unit: f64| {
        let person = law.scale * law.scale * squares(law);
        let variance = person + (law.day * unit).powi(2);
        law.scale *= ((1.0 - share) * variance / person).sqrt();
        law.day = (share * variance).sqrt() / unit;
    };
    let mut new = usual.clone();
    // The day of the speed wanted is relative.
    let centre = usual.desired_speed_mph.centre;
    split(&mut new.desired_speed_mph, of_day.speed, centre);
    for law in [
        &mut new.passing_time_gap_s,
        &mut new.passing_gain_mps,
        &mut new.merge_back_time_gap_s,
        &mut new.following_time_gap_s,
        &mut new.acceleration_mps2,
        &mut new.passing_speed_added_mps,
        &mut new.passing_speed_over_lead_mps,
        &mut new.lane_change_s,
    ] {
        split(law, of_day.rest.max(0.0), 1.0);
    }
    let steadier = -of_day.rest.min(0.0);
    new.passing_time_gap_s.scale *= 1.0 + steadier;
    for sd in [
        &mut new.noise.passing_time_gap_log_sd,
        &mut new.noise.passing_gain_sd_mps,
        &mut new.noise.merge_back_log_sd,
    ] {
        *sd *= 1.0 - steadier;
    }
    new
}

/// Places in [`MEASURES`](maveric_rehearsal::validation::MEASURES) of the two that a population is fitted by.
const SPEED: usize = 0;
const HEADWAY: usize = 1;
/// Distance from the share asked at which the fit ends, and evaluations at most.
const NEAR: f64 = 0.015;
const ROUNDS: usize = 20;
/// What people whose habits have no day have in headway time, about.
const USUAL_HEADWAY: f64 = 0.81;

/// The shares of the day for which both measures have this ICC, in steps as large as what is missing.
fn fit(usual: &Population, wanted: f64, n: usize, seed: u64) -> Result<OfTheDay, Wrong> {
    // Near where it ends, since each round drives everybody twice.
    let rest = 1.3 * (USUAL_HEADWAY - wanted);
    let mut of_day =
        OfTheDay { speed: 0.92 * (1.0 - wanted), rest: if rest < 0.0 { 3.0 * rest } else { rest } };
    for _ in 0..ROUNDS {
        let people = People::Drivers(Box::new(people(usual, of_day)));
        let [first, second] = twice(&people, n, seed)?;
        let retests = retest(&first, &second);
        let icc = |k: usize| retests[k].icc.ok_or("nobody has the measure twice");
        let (speed, headway) = (icc(SPEED)? - wanted, icc(HEADWAY)? - wanted);
        eprintln!("{of_day:?}: speed {:.3}, headway {:.3}", speed + wanted, headway + wanted);
        if speed.abs() < NEAR && headway.abs() < NEAR {
            return Ok(of_day);
        }
        of_day.speed = (of_day.speed + speed).clamp(0.0, 1.0);
        // A day in every habit is seen less in a headway time than in the speed.
        of_day.rest = (of_day.rest + 1.5 * headway).clamp(-1.0, 1.0);
    }
    Err(format!("no shares of the day give {wanted} for both measures").into())
}

fn print_file(asked: f64, people: &str, population: &Population, of_day: OfTheDay, command: &str) {
    let steadier = if of_day.rest < 0.0 {
        STEADIER.replace("{share}", &format!("{:.2}", -of_day.rest))
    } else {
        String::new()
    };
    let head = HEAD
        .replace("{asked}", &asked.to_string())
        .replace("{n}", people)
        .replace("{speed}", &format!("{:.2}", of_day.speed))
        .replace("{rest}", &format!("{:.2}", of_day.rest.max(0.0)))
        .replace("{steadier}", &steadier)
        .replace("{command}", command);
    println!("{head}");
    println!("[drivers]");
    println!("standstill_m = {}", population.standstill_m);
    println!("braking_mps2 = {}", population.braking_mps2);
    for (name, law) in [
        ("desired_speed_mph", &population.desired_speed_mph),
        ("passing_time_gap_s", &population.passing_time_gap_s),
        ("passing_gain_mps", &population.passing_gain_mps),
        ("merge_back_time_gap_s", &population.merge_back_time_gap_s),
        ("following_time_gap_s", &population.following_time_gap_s),
        ("acceleration_mps2", &population.acceleration_mps2),
        ("passing_speed_added_mps", &population.passing_speed_added_mps),
        ("passing_speed_over_lead_mps", &population.passing_speed_over_lead_mps),
        ("lane_change_s", &population.lane_change_s),
    ] {
        println!(
            "{name} = {{ centre = {}, scale = {:.4}, a = {}, b = {}, c = {}, own = {}, day = {:.4}, lowest = {}, highest = {} }}",
            law.centre, law.scale, law.a, law.b, law.c, law.own, law.day, law.lowest, law.highest
        );
    }
    let noise = &population.noise;
    println!("\n[drivers.noise]");
    for (name, value) in [
        ("passing_time_gap_log_sd", noise.passing_time_gap_log_sd),
        ("passing_gain_sd_mps", noise.passing_gain_sd_mps),
        ("passing_gain_falls_mps2", noise.passing_gain_falls_mps2),
        ("merge_back_log_sd", noise.merge_back_log_sd),
        ("delay_s", noise.delay_s),
        ("gap_error_sd", noise.gap_error_sd),
        ("gap_error_time_s", noise.gap_error_time_s),
        ("speed_wander_sd_mps", noise.speed_wander_sd_mps),
        ("speed_wander_time_s", noise.speed_wander_time_s),
    ] {
        let text = format!("{value:.4}");
        println!("{name} = {}", text.trim_end_matches('0').trim_end_matches('.'));
    }
}

/// What it says besides where people had to be made steadier than the usual ones.
const STEADIER: &str = "
# For that encounters differ by {share} less than usual, and people by {share} more in the gap at which they pass: what each encounter happens
# to be like scatters a mean headway time too much otherwise.";

/// What the file says of itself.
const HEAD: &str = "\
# Synthetic drivers who are {asked} alike from one drive to another: `maveric generate --population FILE`, `--set population=FILE`.
#
# Written by the command
#   {command}
# The habits of the paper's people (scenarios/paper.toml, which explains each key) with another part of their variance given to the day:
# how much a habit differs over all drives of all people stays. The day has {speed} of the variance of the speed wanted and {rest} of that of
# every other habit: with these shares two drives of {n} people have an ICC(2,1) of {asked} in mean velocity and in mean headway time.{steadier}
# What is published of real drivers stands in population_sources.toml, under `retest`.
";

fn main() -> Result<(), Wrong> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let scenario = Scenario::paper();
    let usual = &scenario.settings().drivers;
    match words[..] {
        ["measure", path, n, seed] => {
            let [first, second] = twice(&people_of(path)?, n.parse()?, seed.parse()?)?;
            print(&retest(&first, &second), &first);
        }
        ["fit", wanted, n, seed] => {
            let command = format!(
                "cargo run -p maveric-rehearsal --example retest -- fit {wanted} {n} {seed}"
            );
            let wanted = wanted.parse()?;
            let of_day = fit(usual, wanted, n.parse()?, seed.parse()?)?;
            print_file(wanted, n, &people(usual, of_day), of_day, &command);
        }
        _ => return Err("give: measure FILE PEOPLE SEED, or: fit SHARE PEOPLE SEED".into()),
    }
    Ok(())
}
