//! How often a drive of a fresh person is called beyond, and how evenly p is spread.
//!
//! `cargo run --release -p maveric-model --example support_calibration -- 40 linear LEARNED FRESH`: people a training, heads (or `paper`), the
//! file of the population learned from, and that of the fresh people; `drivers` for the people of the paper's scenario.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use maveric_domain::{Drive, DriveMeta, DrivenBy, LatentTraits, stream_seed};
use maveric_model::{HeadsKind, Personalizer, TrainSettings, TrainingDrive, train};
use maveric_simulator::{Driver, People, Scenario, rollout};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::ops::ControlFlow;

const FRESH: usize = 500;

type Failure = Box<dyn std::error::Error + Send + Sync>;

fn drive(scenario: &Scenario, people: &People, seed: u64, person: usize) -> Result<Drive, Failure> {
    let name = person.to_string();
    let mut rng = Pcg64Mcg::seed_from_u64(stream_seed(seed, &["traits", &name]));
    let traits = LatentTraits::draw(|| StandardNormal.sample(&mut rng));
    let seed_of = |what: &str| stream_seed(seed, &[what, &name]);
    let who = people.draw(&traits, seed_of("person"), seed_of("day"));
    let driven = rollout(scenario, Driver::from(&who), seed_of("world"))?;
    let meta = DriveMeta::named(
        format!("p{person}-own"),
        format!("p{person}"),
        "own",
        DrivenBy::Synthetic,
    )?;
    Ok(Drive::from_recording(meta, &driven.recording)?)
}

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [learned, heads, from, fresh_source] = &arguments[..] else {
        return Err("give: PEOPLE linear|paper LEARNED FRESH".into());
    };
    let learned: usize = learned.parse()?;
    let scenario = Scenario::paper();
    let people = |path: &str| -> Result<People, Failure> {
        Ok(match path {
            "drivers" => People::Drivers(Box::new(scenario.settings().drivers.clone())),
            path => toml::from_str(&std::fs::read_to_string(path)?)?,
        })
    };
    let (learned_from, fresh_of) = (people(from)?, people(fresh_source)?);
    let settings = TrainSettings { heads: heads.parse::<HeadsKind>()?, ..TrainSettings::default() };
    let trainings = FRESH.div_ceil(learned);
    let results: Vec<Vec<(f64, Option<String>, usize)>> = (0..trainings as u64)
        .into_par_iter()
        .map(|training| {
            let drives: Vec<Drive> = (0..2 * learned)
                .map(|person| {
                    let people = if person < learned { &learned_from } else { &fresh_of };
                    drive(&scenario, people, 1000 + training, person)
                })
                .collect::<Result<_, Failure>>()?;
            let (from, fresh) = drives.split_at(learned);
            let given: Vec<TrainingDrive<'_>> =
                from.iter().map(|drive| TrainingDrive { drive, adb: None }).collect();
            let trained = train(&given, &settings, 1, &mut |_| ControlFlow::Continue(()))?;
            let personalizer = Personalizer::new(&trained.model);
            let mut rows = Vec::new();
            for drive in fresh {
                let Some(support) = personalizer.fit(drive, None)?.support else {
                    continue;
                };
                if let Some(p) = support.p {
                    rows.push((p, support.beyond().map(|b| b.to_string()), support.habits));
                }
            }
            Ok(rows)
        })
        .collect::<Result<_, Failure>>()?;
    let rows: Vec<_> = results.into_iter().flatten().take(FRESH).collect();
    let mut p: Vec<f64> = rows.iter().map(|r| r.0).collect();
    p.sort_by(f64::total_cmp);
    let n = p.len() as f64;
    let distance = p
        .iter()
        .enumerate()
        .map(|(i, p)| (p - i as f64 / n).abs().max((p - (i + 1) as f64 / n).abs()));
    let beyond: Vec<&String> = rows.iter().filter_map(|r| r.1.as_ref()).collect();
    println!(
        "{heads} heads learned from {learned} of {from}, {n} fresh people of {fresh_source}: D = {:.3}, beyond {} {beyond:?}",
        distance.fold(0.0, f64::max),
        beyond.len()
    );
    for (i, w) in p.chunks(p.len().div_ceil(10)).enumerate() {
        println!("decile {i}: up to {:.3}", w[w.len() - 1]);
    }
    Ok(())
}
