//! What is written comes back.

use super::{bytes_of, meta, recording};
use maveric_domain::Recording;
use maveric_ingest::{IngestSettings, inspect, read_log};

fn read_back(recording: &Recording) -> (Recording, usize) {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), bytes_of(recording)).unwrap();
    let mut found = read_log(file.path(), &IngestSettings::default()).unwrap();
    assert_eq!(found.len(), 1);
    let found = found.remove(0);
    assert_eq!(found.meta, meta());
    (found.recording, found.warnings.len())
}

fn same(a: &[f64], b: &[f64]) {
    assert_eq!(a.len(), b.len());
    for (i, (a, b)) in a.iter().zip(b).enumerate() {
        assert!((a - b).abs() < 1e-9, "row {i}: {a} and {b}");
    }
}

#[test]
fn a_recording_comes_back_as_it_was() {
    let written = recording(false);
    let (read, warnings) = read_back(&written);
    assert_eq!(warnings, 0);
    assert_eq!(read.road(), written.road());
    assert_eq!(read.segment(), written.segment());
    same(read.time_s(), written.time_s());
    same(&read.ego().x_m, &written.ego().x_m);
    same(&read.ego().y_m, &written.ego().y_m);
    same(&read.ego().speed_mps, &written.ego().speed_mps);
    same(&[read.ego().length_m], &[written.ego().length_m]);
    assert_eq!(read.others().len(), written.others().len());
    for (r, w) in read.others().iter().zip(written.others()) {
        assert_eq!((r.id, r.first_row), (w.id, w.first_row));
        same(&r.x_m, &w.x_m);
        same(&r.y_m, &w.y_m);
        same(&r.speed_mps, &w.speed_mps);
        same(&[r.length_m], &[w.length_m]);
    }
}

#[test]
fn a_hole_comes_back_as_a_hole_between_two_segments() {
    let written = recording(true);
    let (read, warnings) = read_back(&written);
    assert_eq!(warnings, 1);
    assert_eq!(read.segment(), written.segment());
    same(read.time_s(), written.time_s());
    same(&read.ego().x_m, &written.ego().x_m);
}

#[test]
fn the_same_recording_gives_the_same_bytes() {
    assert_eq!(bytes_of(&recording(false)), bytes_of(&recording(false)));
}

#[test]
fn a_coarser_rate_keeps_the_positions_that_it_has() {
    let written = recording(false);
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), bytes_of(&written)).unwrap();
    let settings = IngestSettings { rate_hz: Some(10.0), ..IngestSettings::default() };
    let found = read_log(file.path(), &settings).unwrap().remove(0).recording;
    let expected: Vec<f64> = written.ego().x_m.iter().copied().step_by(2).collect();
    same(&found.ego().x_m, &expected);
}

#[test]
fn inspection_names_the_channels_and_the_drive() {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), bytes_of(&recording(false))).unwrap();
    let found = inspect(file.path()).unwrap();
    assert_eq!(found.drive.as_ref().unwrap()["drive"], "S2P07-mimic");
    assert_eq!(found.channels.len(), 2);
    for channel in &found.channels {
        assert!(channel.decodable, "{:?}", channel.reason);
        assert_eq!(channel.messages, 1200);
        assert!((channel.rate_hz.unwrap() - 20.0).abs() < 1e-6);
    }
    assert!(found.damage.is_empty() && found.gaps.is_empty());
    assert!(found.would_ingest.contains("/carla/ego_vehicle/odometry"));
}
