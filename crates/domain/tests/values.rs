//! Units, ids, embeddings, seeds: what the small nouns do.
#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use maveric_domain::{
    ConditionId, ConditionRow, DriveId, Embedding, LaneWish, Metres, MetresPerSecond,
    ParticipantId, Road, Seconds, SweepPoint, VehicleId, When, stream_seed,
};

#[test]
fn units_add_scale_and_divide_as_their_numbers_do() {
    assert_eq!(Metres(3.0) + Metres(4.0), Metres(7.0));
    assert_eq!(Metres(3.0) - Metres(4.0), Metres(-1.0));
    assert_eq!(-Seconds(3.0), Seconds(-3.0));
    assert_eq!(MetresPerSecond(3.0) * 2.0, MetresPerSecond(6.0));
    assert_eq!(MetresPerSecond(30.0) * Seconds(2.0), Metres(60.0));
    assert!((Metres(6.0) / Metres(3.0) - 2.0).abs() < 1e-15);
    assert!((MetresPerSecond::from_mph(55.0).mph() - 55.0).abs() < 1e-12);
    assert!((MetresPerSecond(0.44704).mph() - 1.0).abs() < 1e-12);
    assert_eq!(format!("{:.2}", MetresPerSecond(-1.5)), "-1.50 m/s");
    assert_eq!(Seconds(2.0).to_string(), "2 s");
}

#[test]
fn an_id_reads_back_as_it_was_written_and_a_bad_one_does_not() {
    let id = ParticipantId::new("S2_P-07").unwrap();
    assert_eq!(id.to_string(), "S2_P-07");
    let json = serde_json::to_string(&id).unwrap();
    assert_eq!(json, "\"S2_P-07\"");
    assert_eq!(serde_json::from_str::<ParticipantId>(&json).unwrap(), id);
    let longest = "x".repeat(64);
    assert!(DriveId::new(&*longest).is_ok());
    for bad in ["", "a b", "a/b", "ä", &"x".repeat(65)] {
        let refused = DriveId::new(bad).unwrap_err().to_string();
        assert!(refused.contains("drive id"), "{refused}");
        assert!(serde_json::from_value::<DriveId>(bad.into()).is_err());
    }
    let condition: ConditionId = serde_json::from_str("\"calm\"").unwrap();
    assert_eq!(serde_json::to_string(&condition).unwrap(), "\"calm\"");
    assert_eq!(format!("{condition} {condition:?}"), "calm calm");
    assert!(serde_json::from_str::<ConditionId>("\"a b\"").is_err());
    assert!(VehicleId(2) > VehicleId(1));
}

#[test]
fn an_embedding_has_coordinates_and_all_are_finite() {
    let w = Embedding::new(vec![0.5, -1.0]).unwrap();
    assert_eq!((w.size(), w.coordinates()), (2, &[0.5, -1.0][..]));
    assert_eq!(Vec::from(w), [0.5, -1.0]);
    assert!(Embedding::new(vec![]).unwrap_err().to_string().contains("embedding has 0"));
    let refused = Embedding::try_from(vec![1.0, f64::NAN]).unwrap_err().to_string();
    assert!(refused.contains("`embedding` row 1 is NaN"), "{refused}");
}

#[test]
fn a_conditions_drive_is_called_after_person_and_condition_and_a_sweeps_by_itself() {
    let mut row = ConditionRow::new(
        ParticipantId::new("P1").unwrap(),
        "calm".parse().unwrap(),
        Embedding::new(vec![0.0]).unwrap(),
    );
    assert_eq!(row.drive().unwrap().as_str(), "P1-calm");
    row.sweep = Some(SweepPoint {
        drive: DriveId::new("P1-plus-5").unwrap(),
        attribute: "aggression".to_owned(),
        requested_points: 5.0,
        attribute_points: 5.0,
    });
    assert_eq!(row.drive().unwrap().as_str(), "P1-plus-5");
    row.sweep = None;
    row.participant = ParticipantId::new("p".repeat(64)).unwrap();
    assert!(row.drive().is_err(), "longer than a file name may be");
}

#[test]
fn lanes_have_centres_and_the_nearest_one_counts() {
    let road = Road { lanes: 3, ..Road::PAPER };
    assert!((road.lane_centre_m(2) - 7.32).abs() < 1e-12);
    for (y, lane) in [(-50.0, 0), (1.82, 0), (1.84, 1), (5.4, 1), (5.6, 2), (1e9, 2)] {
        assert_eq!(road.nearest_lane(y), lane, "at {y} m");
    }
}

#[test]
fn every_wish_has_its_words() {
    let words = [
        (LaneWish::Stay, "stay"),
        (LaneWish::MoveOut(When::NotYet), "move out, not yet"),
        (LaneWish::MoveOut(When::Now), "move out"),
        (LaneWish::MoveBack(When::NotYet), "move back, not yet"),
        (LaneWish::MoveBack(When::Now), "move back"),
    ];
    for (wish, word) in words {
        assert_eq!(wish.as_str(), word);
    }
    assert_eq!(LaneWish::default(), LaneWish::Stay);
}

#[test]
fn streams_differ_by_root_by_label_and_by_where_labels_part() {
    let of = |root, labels: &[&str]| stream_seed(root, labels);
    // FNV-1a and SplitMix64, worked out by an independent program.
    assert_eq!(of(1, &["S2P01", "mimic"]), 0x2f0c_928e_68cb_16d9);
    assert_ne!(of(2, &["S2P01", "mimic"]), 0x2f0c_928e_68cb_16d9);
    assert_ne!(of(1, &["mimic", "S2P01"]), 0x2f0c_928e_68cb_16d9);
    assert_ne!(of(1, &["S2P01mimic"]), 0x2f0c_928e_68cb_16d9);
}
