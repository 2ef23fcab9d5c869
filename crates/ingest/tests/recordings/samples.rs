//! Real recordings: healthy ones open, odd ones are refused by themselves, damaged ones say so.

use crate::of;
use libtest_mimic::Trial;
use maveric_bag::BagError;
use maveric_ingest::{IngestError, IngestSettings, inspect, log_files, read_log};
use std::path::Path;

/// The tests, with the folder that they need.
pub(crate) fn tests() -> Vec<Trial> {
    of!["mcap":
        every_recording_opens_and_says_what_it_would_become,
        every_common_message_type_fits_its_definition,
        healthy_rosbag2_files_decode_whole,
        an_unknown_encoding_is_refused_channel_by_channel,
        ros_1_and_json_channels_fit_and_tell_of_no_ego,
        a_recording_that_was_killed_is_damaged_and_holds_no_drive,
        a_flight_of_poses_has_a_differentiated_speed_and_no_lead_vehicle,
    ]
    .into()
}

fn every_recording_opens_and_says_what_it_would_become(folder: &Path) {
    for path in log_files(folder, None).unwrap() {
        let found = inspect(&path).unwrap();
        assert!(!found.would_ingest.is_empty(), "{}", path.display());
        for channel in &found.channels {
            assert_eq!(channel.decodable, channel.reason.is_none());
        }
        // Reading never panics, whatever there is to read.
        let recover = IngestSettings { recover: true, ..IngestSettings::default() };
        let _ = read_log(&path, &recover);
    }
}

fn every_common_message_type_fits_its_definition(folder: &Path) {
    let found = inspect(&folder.join("all_common_types_ros2.mcap")).unwrap();
    assert_eq!(found.channels.len(), 94);
    let refused: Vec<String> = found
        .channels
        .iter()
        .filter_map(|c| c.reason.as_ref().map(|r| format!("{}: {r}", c.type_name)))
        .collect();
    assert!(refused.is_empty(), "{refused:?}");
}

fn healthy_rosbag2_files_decode_whole(folder: &Path) {
    for name in [
        "rosbag2_cdr_test.mcap",
        "rosbag2_talker.mcap",
        "rosbag2_wbag_0.mcap",
        "rosbag2_seek_schema_name_without_msg.mcap",
    ] {
        let found = inspect(&folder.join(name)).unwrap();
        for channel in &found.channels {
            assert!(channel.decodable, "{name} {}: {:?}", channel.topic, channel.reason);
        }
        assert!(found.damage.is_empty(), "{name}: {:?}", found.damage);
    }
}

fn an_unknown_encoding_is_refused_channel_by_channel(folder: &Path) {
    let found = inspect(&folder.join("rosbag2_wrong_serialization.mcap")).unwrap();
    assert_eq!(found.channels.len(), 2);
    for channel in &found.channels {
        assert!(channel.reason.as_ref().unwrap().contains("`wrong_format`"));
    }
    let path = folder.join("rosbag2_wrong_serialization.mcap");
    let error = read_log(&path, &IngestSettings::default()).unwrap_err();
    assert!(matches!(&error, IngestError::NoEgo { found, .. } if found.contains("wrong_format")));
}

fn ros_1_and_json_channels_fit_and_tell_of_no_ego(folder: &Path) {
    for (name, messages) in [("ros1_tf_diagnostics_zstd.mcap", 826), ("json_schema_log.mcap", 0)] {
        let found = inspect(&folder.join(name)).unwrap();
        assert_eq!(found.channels.len(), 2, "{name}");
        for channel in &found.channels {
            assert!(channel.decodable, "{name}: {:?}", channel.reason);
        }
        let read: usize = found.channels.iter().map(|c| c.messages).sum();
        assert!(read == messages || messages == 0 && read > 0, "{name}: {read}");
        assert!(found.damage.is_empty(), "{name}: {:?}", found.damage);
        let path = folder.join(name);
        let error = read_log(&path, &IngestSettings::default()).unwrap_err();
        assert!(matches!(&error, IngestError::NoEgo { .. }), "{error}");
    }
}

fn a_recording_that_was_killed_is_damaged_and_holds_no_drive(folder: &Path) {
    let path = folder.join("chunk_not_closed.mcap");
    let error = read_log(&path, &IngestSettings::default()).unwrap_err();
    assert!(matches!(error, IngestError::Bag(BagError::Damaged { .. })), "{error}");
    let recover = IngestSettings { recover: true, ..IngestSettings::default() };
    let error = read_log(&path, &recover).unwrap_err();
    assert!(matches!(error, IngestError::NoEgo { .. }), "{error}");
    assert_eq!(inspect(&path).unwrap().damage.len(), 1);
}

fn a_flight_of_poses_has_a_differentiated_speed_and_no_lead_vehicle(folder: &Path) {
    let found = read_log(&folder.join("cub_pose_flight.mcap"), &IngestSettings::default())
        .unwrap()
        .remove(0);
    let recording = &found.recording;
    assert_eq!(found.meta.drive.as_str(), "cub_pose_flight");
    assert!(recording.others().is_empty());
    let last = recording.time_s()[recording.rows() - 1];
    assert!((last - 198.0).abs() < 2.0, "{last}");
    let fastest = recording.ego().speed_mps.iter().copied().fold(0.0, f64::max);
    assert!(fastest > 2.0 && fastest < 30.0, "{fastest}");
}
