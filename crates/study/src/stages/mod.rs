//! One module per command.

pub mod ablate;
pub mod analyse;
pub mod codebook;
pub mod declare;
pub mod evaluate;
pub mod export;
pub mod generate;
pub mod import;
pub mod ingest;
pub mod init;
pub mod inspect;
pub mod measure;
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
        ("generate", 3),
        ("import", 1),
        ("codebook", 1),
        ("export", 2),
        ("ingest", 5),
        ("score", 4),
        ("train", 5),
        ("personalize", 5),
        ("steer", 2),
        ("simulate", 7),
        ("measure", 2),
        ("rate", 1),
        ("evaluate", 3),
        ("stats", 7),
        ("ablate", 4),
        ("validate", 6),
        ("recommend", 2),
        ("rehearse", 3),
        ("rehearse-dial", 2),
        ("report", 6),
    ]
    .map(|(command, version)| (command.to_owned(), version.to_string()))
    .into()
}
