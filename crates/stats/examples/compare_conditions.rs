//! From a table to a finding: which stool is hardest to rise from (Wretenberg et al., 1993)?
#![expect(clippy::print_stdout, reason = "an example shows its finding on the terminal")]

use maveric_stats::{StatsError, WithinSubjects, compare};

fn main() -> Result<(), StatsError> {
    let effort = [
        [12.0, 15.0, 12.0, 10.0],
        [10.0, 14.0, 13.0, 12.0],
        [7.0, 14.0, 13.0, 9.0],
        [7.0, 11.0, 10.0, 9.0],
        [8.0, 11.0, 8.0, 7.0],
        [9.0, 11.0, 11.0, 10.0],
        [8.0, 12.0, 12.0, 11.0],
        [7.0, 11.0, 8.0, 7.0],
        [9.0, 13.0, 10.0, 8.0],
    ]
    .map(Vec::from);
    let people = ["1", "2", "3", "4", "5", "6", "7", "8", "9"];
    let data = WithinSubjects::from_rows(&["T1", "T2", "T3", "T4"], &people, &effort)?;
    let result = compare(&data, 0.05)?;
    for reason in &result.reasons {
        println!("{reason}");
    }
    if let (Some(f), Some(p)) = (result.omnibus.statistic, result.omnibus.p) {
        println!("{:?}: {f:.2}, p = {p:.2e}", result.chosen);
    }
    for (pair, test) in result.posthoc.pairs.iter() {
        if let (Some(p), Some(effect)) = (test.p_adjusted, test.effect.value) {
            println!(
                "{pair}: difference {:+.2}, p (Holm) = {p:.4}, effect {effect:+.2}",
                test.mean_diff
            );
        }
    }
    Ok(())
}
