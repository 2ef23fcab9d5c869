//! Tables and mappings that were damaged at random: refused or read, never a panic, never a value that is not finite.
//!
//! `PROPTEST_CASES` sets how many; `cargo test` runs a few.

use maveric_domain::Drive;
use maveric_ingest::{IngestSettings, Mapping, inspect_with, read_log, suggest_mapping};
use proptest::prelude::*;
use std::{fmt::Write as _, path::Path};

const MAPPINGS: [(&str, &str); 9] = [
    ("openacc.toml", "oa_pair_r_f2_c.csv"),
    ("ngsim_pairs.toml", "i80_p_f1_l2.csv"),
    ("openacc_platoon.toml", "ASta.csv"),
    ("ngsim.toml", "n.csv"),
    ("ngsim_feet.toml", "n.csv"),
    ("highd.toml", "01_tracks.csv"),
    ("exid.toml", "00_tracks.csv"),
    ("ours.toml", "P01-own.csv"),
    ("comma2k19.toml", "speed.csv"),
];

/// What tables and mappings trip over.
const WORDS: [&str; 28] = [
    "",
    ",",
    ",,,,",
    "\n",
    "\n\n",
    "\"",
    "\t",
    ";",
    "NaN",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e-320",
    "0",
    "-1",
    "9223372036854775807",
    "1e19",
    "null",
    "\u{feff}",
    "\0",
    "é",
    "2019-07-04T10:21:33Z",
    "?",
    "{n}",
    "[table]",
    "\"\"\"",
    "= \"frames\"",
];

/// A table that the mapping of this number reads.
fn table(which: usize) -> String {
    let mut text = String::new();
    match which {
        0 | 1 => text.push_str("t,x_follower,v_follower,x_leader,v_leader,leader_length,spacing\n"),
        2 => text.push_str("Freq,10\nTime,Speed1,Speed2,IVS1\n"),
        3 | 4 => text.push_str(
            "Vehicle_ID,Global_Time,Local_X,Local_Y,v_length,v_Vel,Lane_ID,Preceding,Location\n",
        ),
        5 => text.push_str("frame,id,x,y,width,height,xVelocity,yVelocity\n"),
        6 => text
            .push_str("trackId,frame,xCenter,yCenter,heading,length,xVelocity,yVelocity,leadId\n"),
        7 => text.push_str(
            "time_s,ego_x_m,ego_y_m,ego_speed_mps,lead_id,lead_dx_m,lead_dy_m,lead_speed_mps\n",
        ),
        _ => text.push_str("t,speed_mps\n"),
    }
    for i in 0..40 {
        let t = f64::from(i) / 10.0;
        let row = match which {
            0 | 1 => format!("{t},{},20,{},21,4,26", 2 * i, 2 * i + 30),
            2 => format!("{t},20,21,30"),
            3 | 4 => format!(
                "{},{},10,{},4,20,{},0,us",
                i % 2 + 1,
                1_118_848_685_000_i64 + i64::from(i / 2) * 100,
                4 * i,
                i % 3
            ),
            5 => format!("{},{},{},25,4,2,30,0", i / 2, i % 2, 3 * i + i % 2 * 30),
            6 => format!("{},{},{},{},10,4,20,1,{}", i % 2, i / 2, i, i, 1 - i % 2),
            7 => format!("{t},{},0,30,5,20,0,29", 3 * i),
            _ => format!("{t},20"),
        };
        writeln!(text, "{row}").unwrap();
    }
    text
}

/// One damage: what, where (of the whole), how far, and a word.
type Damage = (u8, f64, usize, usize);

fn damaged(text: &str, damages: &[Damage]) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for &(what, at, length, word) in damages {
        let at = ((bytes.len() as f64 * at) as usize).min(bytes.len());
        let end = (at + length).min(bytes.len());
        match what {
            0 => bytes.truncate(at),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let copy = bytes[at..end].to_vec();
                bytes.splice(end..end, copy);
            }
            3 => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << (word % 8);
                }
            }
            4 => bytes
                .splice(at..end, WORDS[word % WORDS.len()].bytes())
                .for_each(drop),
            // A whole cell becomes the word.
            _ => {
                let stop = |b: &u8| *b == b',' || *b == b'\n';
                let start = bytes[..at].iter().rposition(stop).map_or(0, |i| i + 1);
                let end = bytes[at..]
                    .iter()
                    .position(stop)
                    .map_or(bytes.len(), |i| at + i);
                bytes.splice(start..end, WORDS[word % WORDS.len()].bytes());
            }
        }
    }
    bytes
}

fn damages(most: usize) -> impl Strategy<Value = Vec<Damage>> {
    prop::collection::vec((0..6_u8, 0.0..1.0, 0..60_usize, 0..WORDS.len()), 0..most)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(
        std::env::var("PROPTEST_CASES").ok().and_then(|c| c.parse().ok()).unwrap_or(60)
    ) })]

    #[test]
    fn damaged_tables_and_mappings_are_refused_or_read(
        which in 0..MAPPINGS.len(),
        to_table in damages(6),
        to_mapping in damages(3),
    ) {
        let (mapping, name) = MAPPINGS[which];
        let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study_data/mappings").join(mapping);
        let toml = std::fs::read_to_string(shipped).unwrap();
        let toml = String::from_utf8_lossy(&damaged(&toml, &to_mapping)).into_owned();
        let mapping = Mapping::from_toml(&toml, Path::new("m.toml")).ok();
        // A rate is a wish, not damage: it may cost what it costs.
        let settings = IngestSettings { mapping, rate_hz: Some(20.0), ..IngestSettings::default() };

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, damaged(&table(which), &to_table)).unwrap();
        for beside in ["01_recordingMeta.csv", "00_recordingMeta.csv"] {
            let meta = "frameRate,speedLimit,upperLaneMarkings,lowerLaneMarkings\n25,30,8;12,20;24;28\n";
            std::fs::write(folder.path().join(beside), damaged(meta, &to_mapping)).unwrap();
        }
        let log = if settings.mapping.as_ref().is_some_and(Mapping::takes_folders) { folder.path() } else { &path };
        for found in read_log(log, &settings).unwrap_or_default() {
            // A drive takes finite numbers only.
            let drive = Drive::from_recording(found.meta, &found.recording).unwrap();
            prop_assert!(drive.rows().lead_dx_m.iter().all(|d| d.is_finite()));
        }
        let _ = inspect_with(log, &settings);
        if let Ok(toml) = suggest_mapping(&path) {
            let complete = !toml.contains("It is not complete");
            let read = Mapping::from_toml(&toml, Path::new("proposed"));
            prop_assert!(read.is_ok() || !complete, "{:?}\n{toml}", read.err());
        }
    }
}
