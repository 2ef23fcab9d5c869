//! Draws a small study, lets its people answer and rate a car that drives faster and slower than they do.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use maveric_domain::{ConditionId, Design, MeasureValues, Moment, Scale};
use maveric_participants::{Cohort, CohortSettings, Effects, answer_before, rate};
use std::collections::BTreeMap;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seed = 1;
    let mut effects: Effects = toml::from_str(maveric_data::EFFECTS)?;
    let adb = Scale::from_toml(maveric_data::SCALES_ADB)?;
    let trust = Scale::from_toml(maveric_data::SCALES_JIAN_TRUST)?;
    // Two scales are enough to see; the others would be asked as well.
    effects.answers.clear();
    effects.ratings.retain(|scale, _| *scale == trust.id);
    let scales = [adb, trust];

    let design = Design::from_toml(maveric_data::DESIGNS_PAPER)?;
    let cohort = Cohort::draw(4, 4, seed, &CohortSettings::default(), &design)?;
    let before = answer_before(&cohort, &scales, &effects, seed)?;
    let drive = |mps: f64| MeasureValues::from([("mean_velocity_mps".to_owned(), Some(mps))]);
    let spread = BTreeMap::from([("mean_velocity_mps".to_owned(), 2.6)]);
    let trials = [
        ("mimic".parse::<ConditionId>()?, drive(29.0)),
        ("aggressive".parse()?, drive(31.0)),
        ("cautious".parse()?, drive(27.0)),
    ];
    for p in &cohort.participants {
        let answers = before.iter().filter(|a| a.participant == p.id && a.moment == Moment::Pre);
        let total: i32 = answers.filter_map(|a| a.answer).sum();
        print!("{} {:2} {:6} ADB {total:2}", p.id, p.age_years, p.gender.as_str());
        if !p.order.is_empty() {
            let rated = rate(p, &drive(29.0), &trials, &spread, &scales, &effects, seed)?;
            print!("; sum of trust items 6 to 12:");
            for (condition, _) in &trials {
                let items = rated
                    .answers
                    .iter()
                    .filter(|a| a.moment == Moment::after(*condition) && a.item > 5);
                print!(" {condition} {}", items.filter_map(|a| a.answer).sum::<i32>());
            }
        }
        println!();
    }
    Ok(())
}
