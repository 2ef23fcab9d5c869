//! A study's file: what is read from it, and what is refused and how.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod faults;
mod outcomes;
mod what_is_read;

use maveric_domain::{
    ConditionId, Design, DriveId, ParticipantId,
    design::{
        Car, Claim, Color, Compare, Condition, DeclaredTest, Donors, Factor, Mappings, Matched,
        ProtocolStep, ScoreName, Sign, Software,
    },
};
use std::{fs, path::PathBuf};

fn id(text: &str) -> ConditionId {
    text.parse().unwrap()
}

const SMALL: &str = r#"
[study]
title = "Calm, normal, sporty"
[people]
learn = { study = 1 }
[style]
score = "adb.total"
points = 15
[[condition]]
id = "calm"
car = { dial = "-1" }
[[condition]]
id = "sporty"
label = "Sporty"
car = { dial = 7.5, recorded = true }
"#;

fn read(text: &str) -> Result<Design, String> {
    Design::from_toml(text).map_err(|e| match e.suggestion() {
        Some(hint) => format!("{e}; {hint}"),
        None => e.to_string(),
    })
}

/// The small design with more lines.
fn with(more: &str) -> Result<Design, String> {
    read(&format!("{SMALL}{more}"))
}
