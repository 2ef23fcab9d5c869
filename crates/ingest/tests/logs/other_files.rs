//! Files that are no logs, and recordings that lack a part: each says what it is and what to do.

use super::{bytes_of, recording, rewritten};
use maveric_bag::BagError;
use maveric_ingest::{IngestError, IngestSettings, WarningKind, inspect, log_files, read_log};
use mcap::WriteOptions;
use std::path::Path;

#[test]
fn files_that_are_no_logs_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let settings = IngestSettings::default();
    let of = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        read_log(&path, &settings).unwrap_err()
    };
    assert!(matches!(of("a.mcap", b""), IngestError::Empty { .. }));
    assert!(matches!(of("b.mcap", b"PAR1\0\x01\xff"), IngestError::NotALog { .. }));
    assert!(matches!(of("c.csv", b"t,x\n1,2\n"), IngestError::NoMapping { .. }));
    assert!(matches!(of("d.mcap", b"\x89MC"), IngestError::Bag(BagError::Damaged { .. })));
    let missing = read_log(&folder.path().join("none.mcap"), &settings).unwrap_err();
    assert!(matches!(missing, IngestError::NotFound { .. }));
    let is_folder = read_log(folder.path(), &settings).unwrap_err();
    assert!(matches!(is_folder, IngestError::IsDirectory { .. }));
}

#[test]
fn what_is_often_taken_for_a_log_is_named_with_what_makes_one_of_it() {
    let folder = tempfile::tempdir().unwrap();
    for (name, start, what, advice) in [
        ("a.bag", &b"#ROSBAG V2.0\n\x45\0\0\0"[..], "ROS 1 bag", "mcap convert"),
        ("b.mcap", b"#ROSBAG V2.0\n\x45\0\0\0", "ROS 1 bag", "mcap convert"),
        ("c.db3", b"SQLite format 3\0\x10\0", "SQLite", "mcap convert"),
        ("d.mcap.gz", &[0x1f, 0x8b, 8, 0, 0, 0, 0, 0], "gzip", "gunzip"),
        ("e.mcap.zstd", &[0x28, 0xb5, 0x2f, 0xfd, 4, 0], "zstd", "zstd -d"),
        ("k.csv", b"\xff\xfet\0,\0v\0\n\0", "UTF-16", "UTF-8"),
        ("l.csv", b"t,F\xfchrer\n0,1\n", "line 1 holds the byte fc", "UTF-8"),
        ("m.csv", b"t,speed\n0,1\n\0,2\n", "line 3 holds a zero byte", "UTF-8"),
        ("n.csv", b"\xc3", "starts with c3", "MCAP"),
        ("f.xlsx", b"PK\x03\x04\x14\0", "spreadsheet", "CSV"),
        ("g.h5", b"\x89HDF\r\n\x1a\n\0", "HDF5", "CSV"),
        ("h.png", b"\x89PNG\r\n\x1a\n\0\0", "picture", "MCAP"),
        ("i.mcap", b"time,speed\n0,1\n", "text", ".csv"),
        ("j.bin", &[0, 1, 2, 3, 0xff], "starts with 00 01 02 03 ff", "MCAP"),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, start).unwrap();
        for error in
            [read_log(&path, &IngestSettings::default()).unwrap_err(), inspect(&path).unwrap_err()]
        {
            assert!(error.to_string().contains(what), "{error}");
            let said = error.suggestion().unwrap();
            assert!(said.contains(advice), "{said}");
        }
    }
    // A folder of nothing else says so too.
    let bags = folder.path().join("bags");
    std::fs::create_dir(&bags).unwrap();
    std::fs::copy(folder.path().join("a.bag"), bags.join("a.bag")).unwrap();
    let error = log_files(&bags, None).unwrap_err();
    assert!(error.to_string().contains("ROS 1 bag"), "{error}");
}

/// Twenty seconds of our log a file.
fn split_into(folder: &Path) {
    let log = bytes_of(&recording(false));
    let name = folder.file_name().unwrap().to_string_lossy();
    for part in 0..3_u64 {
        let there = |t: u64| t / 20_000_000_000 == part;
        let bytes = rewritten(&log, WriteOptions::new(), |message| {
            there(message.log_time).then_some(message)
        });
        std::fs::write(folder.join(format!("{name}_{part}.mcap")), bytes).unwrap();
    }
}

#[test]
fn a_split_recording_that_lacks_a_part_is_refused_and_recovered_with_its_hole() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("run");
    std::fs::create_dir(&folder).unwrap();
    split_into(&folder);
    let settings = IngestSettings::default();
    let recover = IngestSettings { recover: true, ..IngestSettings::default() };
    let whole = read_log(&folder, &settings).unwrap().remove(0);
    let summary = inspect(&folder).unwrap();
    assert_eq!(summary.channels.len(), 2);
    let odometry = summary.channels.iter().map(|c| c.messages).max().unwrap();
    assert_eq!(odometry, whole.recording.rows());
    assert!(summary.damage.is_empty(), "{:?}", summary.damage);

    std::fs::remove_file(folder.join("run_1.mcap")).unwrap();
    let list = "rosbag2_bagfile_information:\n  relative_file_paths:\n    - run_0.mcap\n    - run_1.mcap\n    - run_2.mcap\n";
    for metadata in [None, Some(list)] {
        if let Some(text) = metadata {
            std::fs::write(folder.join("metadata.yaml"), text).unwrap();
        }
        assert_eq!(log_files(&folder, None).unwrap(), std::slice::from_ref(&folder));
        let error = read_log(&folder, &settings).unwrap_err();
        assert!(
            matches!(&error, IngestError::MissingPart { part, .. } if part == "run_1.mcap"),
            "{error}"
        );
        assert!(error.suggestion().unwrap().contains("--recover"));
        let found = read_log(&folder, &recover).unwrap().remove(0);
        let said = |kind| found.warnings.iter().any(|w| w.kind == kind);
        assert!(said(WarningKind::Damage) && said(WarningKind::Hole));
        assert_eq!(found.recording.rows(), whole.recording.rows() - 400);
        assert_eq!(found.recording.segment().last(), Some(&1));
        assert_eq!(inspect(&folder).unwrap().damage.len(), 1);
    }
}

#[test]
fn an_intact_log_with_one_very_large_message_is_read_and_the_message_counted() {
    let mut out = WriteOptions::new().create(std::io::Cursor::new(Vec::new())).unwrap();
    let log = super::bytes_of(&super::recording(false));
    let map = mcap::Channel {
        id: 77,
        topic: "/map".to_owned(),
        schema: None,
        message_encoding: "json".to_owned(),
        metadata: std::collections::BTreeMap::new(),
    };
    let large = mcap::Message {
        channel: std::sync::Arc::new(map),
        sequence: 0,
        log_time: 1,
        publish_time: 1,
        data: vec![b' '; 40 << 20].into(),
    };
    out.write(&large).unwrap();
    for record in mcap::read::LinearReader::new(&log).unwrap() {
        if let mcap::records::Record::Metadata(metadata) = record.unwrap() {
            out.write_metadata(&metadata).unwrap();
        }
    }
    for message in mcap::MessageStream::new(&log).unwrap() {
        out.write(&message.unwrap()).unwrap();
    }
    out.finish().unwrap();
    let bytes = out.into_inner().into_inner();
    let found = super::damage::read(&bytes, false).unwrap();
    assert_eq!(found.recording.rows(), super::ROWS);
    let said = |w: &maveric_ingest::Warning| w.what.contains("more than 32 MiB");
    assert_eq!(found.warnings.iter().filter(|w| said(w)).count(), 1);
}

#[test]
fn what_was_read_is_known_by_its_name_and_hash_however_it_ends() {
    let folder = tempfile::tempdir().unwrap();
    let settings = IngestSettings { recover: true, ..IngestSettings::default() };
    let whole = bytes_of(&recording(false));
    for (i, bytes) in [&whole[..], &whole[..whole.len() / 2]].into_iter().enumerate() {
        let path = folder.path().join(format!("{i}.mcap"));
        std::fs::write(&path, bytes).unwrap();
        let found = read_log(&path, &settings).unwrap();
        let [source] = &found[0].sources[..] else {
            panic!("{:?}", found[0].sources);
        };
        assert_eq!(source.name, format!("{i}.mcap"));
        assert_eq!(source.blake3, blake3::hash(bytes).to_hex().to_string(), "case {i}");
    }
}

/// A log whose second, lesser odometry nobody can decode, and which lies about it in its summary if `lies`.
fn with_a_rival(lies: bool) -> Vec<u8> {
    let log = bytes_of(&recording(false));
    let options = WriteOptions::new().compression(None).calculate_summary_section_crc(false);
    let mut out = options.create(std::io::Cursor::new(Vec::new())).unwrap();
    let none = std::collections::BTreeMap::new();
    let mut channel = |topic: &str, like: &mcap::Channel<'_>| {
        let schema = like.schema.as_ref().unwrap();
        let schema = out.add_schema(&schema.name, &schema.encoding, &schema.data).unwrap();
        out.add_channel(schema, topic, "cdr", &none).unwrap()
    };
    let first = mcap::MessageStream::new(&log).unwrap().map(Result::unwrap);
    let mut channels: Vec<_> = first.take(2).map(|m| m.channel).collect();
    channels.sort_by_key(|c| c.topic.ends_with("objects"));
    let ours = channel("/a/odometry", &channels[0]);
    let objects = channel("/a/objects", &channels[1]);
    let rival = channel("/b/odometry", &channels[0]);
    for message in mcap::MessageStream::new(&log).unwrap() {
        let message = message.unwrap();
        let head = |channel_id| mcap::records::MessageHeader {
            channel_id,
            sequence: 0,
            log_time: message.log_time,
            publish_time: message.log_time,
        };
        if message.channel.topic.ends_with("objects") {
            out.write_to_known_channel(&head(objects), &message.data).unwrap();
            continue;
        }
        out.write_to_known_channel(&head(ours), &message.data).unwrap();
        if message.log_time % 200_000_000 == 0 {
            out.write_to_known_channel(&head(rival), &[0, 1, 0, 0, 7]).unwrap();
        }
    }
    out.finish().unwrap();
    let mut bytes = out.into_inner().into_inner();
    if lies {
        let count = (1200 / 4_u64).to_le_bytes();
        let at = bytes.windows(8).rposition(|w| w == count).unwrap();
        bytes[at..at + 8].copy_from_slice(&1_000_000_u64.to_le_bytes());
    }
    bytes
}

#[test]
fn only_chosen_channels_are_decoded_and_a_summary_that_lies_is_not_believed() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        (read_log(&path, &IngestSettings::default()).unwrap().remove(0), path)
    };
    let misfits = |warnings: &[maveric_ingest::Warning]| {
        let bad = warnings.iter().filter(|w| w.kind == WarningKind::BadMessage);
        bad.map(|w| w.count).sum::<usize>()
    };
    let (honest, path) = read("rival.mcap", &with_a_rival(false));
    assert!(honest.recording.rows() > 1000);
    assert_eq!(misfits(&honest.warnings), 0, "what is not chosen is not decoded");
    assert_eq!(misfits(&inspect(&path).unwrap().warnings), 300, "inspect tells of it");
    let (lie, _) = read("lie.mcap", &with_a_rival(true));
    assert_eq!(lie.recording, honest.recording);
    assert_eq!(misfits(&lie.warnings), 300, "everything was read");
}

#[test]
fn parquet_with_unreadable_column_gives_the_others() {
    // Written by pyarrow 26: the columns of a pair, and one of a type that no measurement has.
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/logs/parquet");
    for kind in ["struct", "list", "float16", "decimal256", "map"] {
        let path = folder.join(format!("{kind}.parquet"));
        let file = maveric_ingest::read_parquet(std::fs::read(&path).unwrap(), None);
        let frame = file.map_or_else(|why| panic!("{kind}: {why}"), |file| file.frame);
        let names: Vec<String> = frame.get_column_names().iter().map(ToString::to_string).collect();
        assert_eq!(names, ["time", "ego_speed", "gap", "lead_speed"], "{kind}");
        assert_eq!(frame.height(), 30);
        let inspected = maveric_ingest::inspect_with(&path, &IngestSettings::default());
        assert!(inspected.is_ok(), "{kind}: {:?}", inspected.err().map(|e| e.to_string()));
    }
}
