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
pub mod rehearse_dial;
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
        ("import", 4),
        ("codebook", 3),
        ("export", 8),
        ("ingest", 14),
        ("score", 9),
        ("train", 11),
        ("personalize", 10),
        ("steer", 9),
        ("simulate", 11),
        ("measure", 8),
        ("rate", 5),
        ("evaluate", 10),
        ("stats", 18),
        ("ablate", 10),
        ("validate", 14),
        ("recommend", 6),
        ("rehearse", 11),
        ("rehearse-dial", 7),
        ("report", 21),
    ]
    .map(|(command, version)| (command.to_owned(), version.to_string()))
    .into()
}
