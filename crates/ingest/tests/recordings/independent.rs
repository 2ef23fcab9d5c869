//! Real tables against a reading of their own: cells split at commas, nothing shared with the program.

use crate::{of, settings};
use libtest_mimic::Trial;
use maveric_domain::Drive;
use maveric_ingest::{
    IngestSettings, Ingested, Mapping, Provenance, drive_frame, log_files, read_drive_from,
    read_log, suggest_mapping, write_drive_to,
};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

/// The tests, with the folders that they need.
pub(crate) fn tests() -> Vec<Trial> {
    let mut tests = Vec::from(of!["openacc_astazero":
        every_row_of_the_openacc_pairs_is_that_of_the_file,
        the_mapping_proposed_for_openacc_works_as_it_is,
    ]);
    tests.extend(of!["ngsim_i80_pairs":
        every_row_of_the_ngsim_pairs_is_that_of_the_file_in_metres,
        the_mapping_proposed_for_ngsim_pairs_doubts_their_units,
    ]);
    tests.extend(of!["ngsim_us101_i80":
        every_row_of_the_long_ngsim_table_is_that_of_the_file,
        the_mapping_proposed_for_the_long_ngsim_table_works_as_it_is,
        a_drive_comes_back_from_its_file_bit_by_bit_with_its_provenance,
    ]);
    tests
}

const FOOT: f64 = 0.3048;

struct Plain {
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Plain {
    fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).unwrap();
        let mut lines = text.lines().map(|l| l.split(',').map(str::to_owned).collect::<Vec<_>>());
        Self { names: lines.next().unwrap(), rows: lines.collect() }
    }

    fn column(&self, name: &str) -> Vec<f64> {
        let at = self.names.iter().position(|n| n == name).unwrap();
        self.rows.iter().map(|r| r[at].parse().unwrap()).collect()
    }

    fn words(&self, name: &str) -> Vec<String> {
        let at = self.names.iter().position(|n| n == name).unwrap();
        self.rows.iter().map(|r| r[at].clone()).collect()
    }
}

fn drive_of(found: &Ingested) -> Drive {
    Drive::from_recording(found.meta.clone(), &found.recording).unwrap()
}

fn pairs(folder: &Path, mapping: &str, unit: f64) {
    let settings = settings(mapping);
    for path in log_files(folder, settings.mapping.as_ref()).unwrap() {
        let plain = Plain::read(&path);
        let found = read_log(&path, &settings).unwrap().remove(0);
        let drive = drive_of(&found);
        let rows = drive.rows();
        let (t, v, lead) =
            (plain.column("t"), plain.column("v_follower"), plain.column("v_leader"));
        let (gap, x) = (plain.column("spacing"), plain.column("x_follower"));
        assert_eq!(drive.len(), t.len(), "{}", path.display());
        for row in 0..t.len() {
            let close = |found: f64, expected: f64| (found - expected).abs() < 1e-7;
            assert!(close(rows.time_s[row], t[row] - t[0]));
            assert!(close(rows.ego_speed_mps[row], v[row] * unit));
            assert!(close(rows.ego_x_m[row], x[row] * unit));
            assert!(close(rows.lead_speed_mps[row], lead[row] * unit));
            // Bumpers that overlap are 0 apart.
            assert!(
                close(rows.lead_dx_m[row], (gap[row] * unit).max(0.0)),
                "{} row {row}",
                path.display()
            );
        }
    }
}

fn every_row_of_the_openacc_pairs_is_that_of_the_file(folder: &Path) {
    pairs(folder, "openacc.toml", 1.0);
}

fn every_row_of_the_ngsim_pairs_is_that_of_the_file_in_metres(folder: &Path) {
    pairs(folder, "ngsim_pairs.toml", FOOT);
}

/// Rows of the long table by drive: time, speed, gap between bumpers.
fn ngsim_rows(path: &Path) -> BTreeMap<String, Vec<(f64, f64, f64)>> {
    let plain = Plain::read(path);
    let (place, id) = (plain.words("Location"), plain.words("Vehicle_ID"));
    let (t, v) = (plain.column("Global_Time"), plain.column("v_Vel"));
    let (y, lead) = (plain.column("Local_Y"), plain.column("preceding_Local_Y"));
    let length = plain.column("preceding_vehicle_length");
    let mut of: BTreeMap<String, Vec<(f64, f64, f64)>> = BTreeMap::new();
    for row in 0..t.len() {
        let rows = of.entry(format!("{}-{}", place[row], id[row])).or_default();
        rows.push((t[row] / 1000.0, v[row], lead[row] - y[row] - length[row]));
    }
    of
}

fn check_ngsim(path: &Path, settings: &IngestSettings) {
    let expected = ngsim_rows(path);
    let found = read_log(path, settings).unwrap();
    assert_eq!(found.len(), expected.len());
    for one in &found {
        let drive = drive_of(one);
        let rows = drive.rows();
        let name = drive.meta().drive.as_str();
        let key = expected.keys().find(|k| name.ends_with(k.as_str())).unwrap();
        let plain = &expected[key];
        let mut met = 0;
        for &(t, v, gap) in plain {
            let since = t - plain[0].0;
            let Some(row) = rows.time_s.iter().position(|r| (r - since).abs() < 1e-6) else {
                continue;
            };
            met += 1;
            assert!((rows.ego_speed_mps[row] - v).abs() < 1e-9, "{name} at {since}");
            assert!((rows.lead_dx_m[row] - gap.max(0.0)).abs() < 1e-6, "{name} at {since}: {gap}");
            assert!(rows.lead_present[row]);
        }
        // The last sample before a hole and the first behind it may stand alone.
        assert!(met + 2 >= plain.len(), "{name}: {met} of {}", plain.len());
    }
}

fn every_row_of_the_long_ngsim_table_is_that_of_the_file(folder: &Path) {
    check_ngsim(&folder.join("vehicles_with_leader.csv"), &settings("ngsim.toml"));
}

/// The mapping that is proposed for a table, as it is.
fn proposed(path: &Path) -> IngestSettings {
    let toml = suggest_mapping(path).unwrap();
    IngestSettings {
        mapping: Some(Mapping::from_toml(&toml, Path::new("proposed.toml")).unwrap()),
        rate_hz: Some(10.0),
        ..IngestSettings::default()
    }
}

fn proposed_for_pairs(folder: &Path, unit: f64) {
    let files: Vec<PathBuf> = log_files(folder, None).unwrap();
    let tables = files.iter().filter(|p| !p.ends_with("manifest.csv"));
    for path in tables.step_by(3) {
        let plain = Plain::read(path);
        let drive = drive_of(&read_log(path, &proposed(path)).unwrap()[0]);
        let rows = drive.rows();
        let (v, gap) = (plain.column("v_follower"), plain.column("spacing"));
        for row in 0..v.len() {
            let at = format!("{} row {row}", path.display());
            let (speed, dx) = (v[row] * unit, (gap[row] * unit).max(0.0));
            assert!((rows.ego_speed_mps[row] - speed).abs() < 1e-7, "{at}");
            assert!((rows.lead_dx_m[row] - dx).abs() < 1e-7, "{at}");
        }
    }
}

fn the_mapping_proposed_for_openacc_works_as_it_is(folder: &Path) {
    proposed_for_pairs(folder, 1.0);
}

/// Nothing but their numbers says that they are in feet.
fn the_mapping_proposed_for_ngsim_pairs_doubts_their_units(folder: &Path) {
    let path = folder.join("i80_0500pm_f1278_l1267.csv");
    let toml = suggest_mapping(&path).unwrap();
    for of in ["length", "speed"] {
        let doubt = format!("# doubt: no name says the unit of {of}.\n{of} = ");
        assert!(toml.contains(&doubt), "{toml}");
    }
}

fn the_mapping_proposed_for_the_long_ngsim_table_works_as_it_is(folder: &Path) {
    let path = folder.join("vehicles_with_leader.csv");
    check_ngsim(&path, &proposed(&path));
}

fn a_drive_comes_back_from_its_file_bit_by_bit_with_its_provenance(folder: &Path) {
    let path = folder.join("vehicles_with_leader.csv");
    let settings = settings("ngsim.toml");
    let out = tempfile::tempdir().unwrap();
    for found in read_log(&path, &settings).unwrap() {
        let provenance = Provenance::of(&found.sources, None, &settings).unwrap();
        let drive = drive_of(&found);
        let file = out.path().join("d.parquet");
        write_drive_to(std::fs::File::create(&file).unwrap(), &drive, &provenance).unwrap();
        let (back, said) = read_drive_from(&file).unwrap();
        assert_eq!((&back, &said), (&drive, &provenance));
        assert_eq!(drive_frame(&back).shape(), (drive.len(), 18));
    }
}
