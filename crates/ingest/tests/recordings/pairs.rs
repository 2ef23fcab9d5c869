//! Tables of pairs and what is beside them: how many drives, of whom, and their first numbers.

use crate::{of, settings};
use libtest_mimic::Trial;
use maveric_domain::{Drive, Recording, scene::bumper_distance_m};
use maveric_ingest::{LogFormat, inspect, log_files, read_log};
use std::path::Path;

/// The tests, with the folders that they need.
pub(crate) fn tests() -> Vec<Trial> {
    let openacc = of!["openacc_astazero":
        openacc_has_four_drives_whose_gap_is_the_spacing,
        every_table_of_openacc_can_be_inspected,
    ];
    let ngsim = of!["ngsim_us101_i80": every_table_of_ngsim_can_be_inspected];
    let comma = of!["comma2k19_segment": every_table_of_comma2k19_can_be_inspected];
    let feet = of!["ngsim_i80_pairs": ngsim_feet_become_metres];
    openacc.into_iter().chain(ngsim).chain(comma).chain(feet).collect()
}

/// First gap between bumpers, in m.
fn first_gap_m(recording: &Recording) -> f64 {
    let scene = recording.scene(0).unwrap();
    bumper_distance_m(&scene.ego, &scene.vehicles[0])
}

fn openacc_has_four_drives_whose_gap_is_the_spacing(folder: &Path) {
    let settings = settings("openacc.toml");
    let files = log_files(folder, settings.mapping.as_ref()).unwrap();
    assert_eq!(files.len(), 4);
    for path in &files {
        let found = read_log(path, &settings).unwrap().remove(0);
        // The files give a length of 0, which is reported as unknown.
        let others = found.warnings.iter().filter(|w| !w.what.contains("length"));
        assert_eq!(others.count(), 0, "{:?}", found.warnings);
        assert_eq!((found.recording.rows(), found.recording.others().len()), (12_433, 1));
        assert!((found.recording.rate_hz() - 10.0).abs() < 1e-12);
        let drive = Drive::from_recording(found.meta, &found.recording).unwrap();
        assert!(drive.rows().lead_present.iter().all(|&p| p));
    }
    let first = read_log(&files[0], &settings).unwrap().remove(0);
    assert_eq!(first.meta.drive.as_str(), "openacc-040719_platoon10-f2");
    assert!((first_gap_m(&first.recording) - 5.122_082_263_370_74).abs() < 1e-9);
    assert!(read_log(&folder.join("manifest.csv"), &settings).unwrap().is_empty());
}

fn ngsim_feet_become_metres(folder: &Path) {
    let settings = settings("ngsim_pairs.toml");
    let files = log_files(folder, settings.mapping.as_ref()).unwrap();
    assert_eq!(files.len(), 12);
    let path = folder.join("i80_0500pm_f1278_l1267.csv");
    let found = read_log(&path, &settings).unwrap().remove(0);
    assert_eq!(found.meta.participant.as_str(), "i80-0500pm-f1278");
    assert!((first_gap_m(&found.recording) - 27.792_645_84 * 0.3048).abs() < 1e-9);
    assert!((found.recording.ego().speed_mps[0] - 25.046_703_11 * 0.3048).abs() < 1e-9);
    assert!((found.recording.others()[0].length_m - 17.8 * 0.3048).abs() < 1e-12);
}

fn every_table_can_be_inspected(folder: &Path) {
    for path in log_files(folder, None).unwrap() {
        let found = inspect(&path).unwrap();
        assert_eq!(found.format, LogFormat::Table);
        assert!(found.rows > 0 && !found.columns.is_empty());
    }
}

fn every_table_of_openacc_can_be_inspected(folder: &Path) {
    every_table_can_be_inspected(folder);
}

fn every_table_of_ngsim_can_be_inspected(folder: &Path) {
    every_table_can_be_inspected(folder);
}

fn every_table_of_comma2k19_can_be_inspected(folder: &Path) {
    every_table_can_be_inspected(folder);
}
