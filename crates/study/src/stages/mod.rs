//! One module per command.

pub mod ablate;
pub mod analyse;
pub mod codebook;
pub mod declare;
pub mod evaluate;
pub mod export;
pub mod freeze;
pub mod generate;
pub mod import;
pub mod ingest;
pub mod init;
pub mod inspect;
pub mod measure;
pub mod orders;
pub mod personalize;
pub mod rate;
pub mod recommend;
pub mod rehearse;
pub mod report;
mod sample_size;
pub mod score;
pub mod simulate;
pub mod stats;
pub mod steer;
pub mod train;
pub mod validate;

use std::collections::BTreeMap;

/// Version of each command's numbers: part of what its outputs are made from.
///
/// Raise one when that command would compute something else from the same inputs; an unrelated release then
/// does not retrain a model.
pub fn versions() -> BTreeMap<String, String> {
    [
        ("generate", 5),
        ("import", 5),
        ("codebook", 4),
        ("export", 9),
        ("ingest", 15),
        ("score", 10),
        ("train", 11),
        ("personalize", 10),
        ("steer", 9),
        ("simulate", 11),
        ("measure", 8),
        ("rate", 5),
        ("evaluate", 12),
        ("stats", 19),
        ("ablate", 11),
        ("validate", 16),
        ("recommend", 7),
        ("rehearse", 12),
        ("report", 23),
    ]
    .map(|(command, version)| (command.to_owned(), version.to_string()))
    .into()
}

/// The commands of [`versions`] with figures among what they make.
const DRAWING: [&str; 6] = ["evaluate", "stats", "ablate", "validate", "rehearse", "report"];

/// [`versions`] where every figure looks as a style says, of which `hash` is the hash: what draws makes something else with another.
pub fn versions_in_style(hash: &str) -> BTreeMap<String, String> {
    let short = hash.get(..8).unwrap_or(hash);
    let mut versions = versions();
    for command in DRAWING {
        if let Some(version) = versions.get_mut(command) {
            *version = format!("{version}, style {short}");
        }
    }
    versions
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_style_counts_where_figures_are_drawn_and_nowhere_else() {
        let (plain, one, other) =
            (versions(), versions_in_style("0123456789"), versions_in_style("abcdef0123"));
        assert!(DRAWING.iter().all(|command| plain.contains_key(*command)));
        for (command, version) in &plain {
            let draws = DRAWING.contains(&command.as_str());
            assert_eq!(*version != one[command], draws, "{command}");
            assert_eq!(one[command] != other[command], draws, "{command}");
        }
        assert!(one["report"].ends_with(", style 01234567"));
    }
}
