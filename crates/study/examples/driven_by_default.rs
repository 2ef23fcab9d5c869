//! What is driven by default in a recorded person's place: every candidate on people it did not learn from, by fit rows alone.
//!
//! `cargo run --release -p maveric-study --example driven_by_default -- OUT.csv SET=FOLDER:FOLDS:MOVING_ABOVE_MPS …`; the folders are
//! those that `maveric ingest` writes, and folders of one name make one set.

#![expect(clippy::print_stdout, reason = "an example shows its result")]

use maveric_following::{FollowingRun, FollowingSettings, Trial, ranked, trials, try_over_people};
use maveric_study::tables::drives::read_drives;
use std::{collections::BTreeMap, error::Error, fmt::Write as _, path::Path};

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let out = args.next().ok_or("give the table to write first")?;
    let mut sets: BTreeMap<String, Vec<Trial>> = BTreeMap::new();
    let mut table = "set,person,method,gap_rmse_m,reached_zero\n".to_owned();
    for arg in args {
        let usage = || format!("`{arg}`: expected SET=FOLDER:FOLDS:MOVING_ABOVE_MPS");
        let (set, rest) = arg.split_once('=').ok_or_else(usage)?;
        let [folder, folds, above] = rest.split(':').collect::<Vec<_>>()[..] else {
            return Err(usage().into());
        };
        let settings = FollowingSettings {
            moving_above_mps: above.parse()?,
            ..FollowingSettings::default()
        };
        let drives = read_drives(Path::new(folder))?;
        let runs = drives.iter().map(FollowingRun::from_drive);
        let runs: Vec<FollowingRun> = runs.collect::<Result<_, _>>()?;
        let tried = trials(&try_over_people(&runs, folds.parse()?, &settings)?);
        for t in &tried {
            let reached = u8::from(t.reached_zero);
            writeln!(
                table,
                "{set},{},{},{:.3},{reached}",
                t.person, t.method, t.gap_rmse_m
            )?;
        }
        sets.entry(set.to_owned()).or_default().extend(tried);
    }
    std::fs::write(out, table)?;
    let sets: Vec<Vec<Trial>> = sets.into_values().collect();
    for candidate in ranked(&sets) {
        println!(
            "{:<45} {:+.3}  reached the leader: {}",
            candidate.method.label(),
            candidate.score,
            candidate.reached_zero
        );
    }
    Ok(())
}
