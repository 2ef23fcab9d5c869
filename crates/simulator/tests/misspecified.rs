//! The second kind of people, held against what they have to be: sane drivers, about as fast and as close as the paper's population.

use maveric_domain::{Drive, DriveMeta, DrivenBy, LatentTraits, drive::Direction, stream_seed};
use maveric_simulator::{Driver, People, Rollout, Scenario, rollout};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

fn people() -> People {
    toml::from_str(include_str!("../../../study_data/population_misspecified.toml"))
        .expect("the shipped file is a population")
}

fn drives(n: u64) -> Vec<Rollout> {
    let (people, scenario) = (people(), Scenario::paper());
    let one = |i: u64| {
        let mut rng = Pcg64Mcg::seed_from_u64(stream_seed(5, &["person", &i.to_string()]));
        let traits = LatentTraits::draw(|| StandardNormal.sample(&mut rng));
        rollout(&scenario, Driver::from(&people.draw(&traits, i, i)), i)
            .expect("the paper's scenario can be driven")
    };
    (0..n).map(one).collect()
}

fn drive(rollout: &Rollout) -> Drive {
    let meta = DriveMeta::named("test", "test", "own", DrivenBy::Synthetic).expect("a plain word");
    Drive::from_recording(meta, &rollout.recording).expect("a whole recording")
}

fn mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, n) = values.into_iter().fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
    sum / n
}

#[test]
fn forty_drives_hit_nobody_and_are_in_the_range_of_the_papers_population() {
    let all = drives(40);
    assert_eq!(all.iter().map(|d| d.report.collisions).sum::<u32>(), 0);
    let drives: Vec<Drive> = all.iter().map(drive).collect();
    let velocity = mean(drives.iter().map(|d| mean(d.rows().ego_speed_mps.clone())));
    assert!((27.0..31.5).contains(&velocity), "{velocity}");
    let changes = mean(drives.iter().map(|d| {
        let completed = d.lane_changes().into_iter().filter(|c| c.completed);
        completed.count() as f64
    }));
    assert!((7.0..11.0).contains(&changes), "{changes}");
    let gaps = |direction: Direction| -> Vec<f64> {
        let mut gaps = Vec::new();
        for d in &drives {
            for c in d.lane_changes() {
                let rows = d.rows();
                if c.completed && c.direction == direction {
                    gaps.extend(match direction {
                        Direction::Left => {
                            rows.lead_present[c.start].then(|| rows.lead_dx_m[c.start])
                        }
                        Direction::Right => c.gap_behind_m,
                    });
                }
            }
        }
        gaps
    };
    let (out, back) = (mean(gaps(Direction::Left)), mean(gaps(Direction::Right)));
    assert!((40.0..65.0).contains(&out), "{out}");
    assert!((36.0..56.0).contains(&back), "{back}");
}

#[test]
fn the_same_seed_gives_the_same_drive() {
    let (people, scenario) = (people(), Scenario::paper());
    let drive = || {
        let person = people.draw(&LatentTraits::default(), 1, 1);
        rollout(&scenario, Driver::from(&person), 1).unwrap().recording
    };
    assert_eq!(drive(), drive());
}

#[test]
fn a_population_with_a_misspelt_key_or_of_no_known_kind_is_refused_by_name() {
    let text = maveric_data::POPULATION_MISSPECIFIED;
    let wrong = text.replace("lateness", "lateiness");
    let error = toml::from_str::<People>(&wrong).unwrap_err().to_string();
    assert!(error.contains("lateiness"), "{error}");
    let wrong = text.replace("evidence", "witches");
    let error = toml::from_str::<People>(&wrong).unwrap_err().to_string();
    assert!(error.contains("witches") && error.contains("evidence"), "{error}");
    let wrong = text.replace("gap_error_sd = 0.06", "gap_error_sd = 0.6");
    let error = toml::from_str::<People>(&wrong).unwrap_err().to_string();
    assert!(error.contains("evidence.gap_error_sd"), "{error}");
}
