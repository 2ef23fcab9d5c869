//! Real recordings, where they stand beside the checkout.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at the first surprise"
)]

mod support;

use support::{TempStudy, shared};

#[test]
fn openacc_goes_from_csv_to_the_table_of_errors() {
    let Some(data) = shared("openacc_astazero") else {
        return;
    };
    let study = TempStudy::new();
    let data = format!("data={}", std::fs::canonicalize(data).unwrap().display());
    let ran = study
        .maveric(&[
            "run",
            "pipelines/openacc.toml",
            "--set",
            &data,
            "--set",
            "epochs=5",
        ])
        .ok();
    assert!(ran.stdout.contains("IDM"), "{}", ran.stdout);
    let following =
        std::fs::read_to_string(study.path("study_data/generated/openacc/following.json")).unwrap();
    assert!(following.contains("platoon10-f2"), "each driver is there");
    let page = std::fs::read_to_string(study.path("reports/openacc/index.html")).unwrap();
    assert!(
        !page.contains("ynthetic participants"),
        "these people are real"
    );
    let training =
        std::fs::read_to_string(study.path("study_data/generated/openacc/model_training.json"))
            .unwrap();
    assert!(
        training.contains("left_out"),
        "the losses without data are named"
    );
}

#[test]
fn ngsim_pairs_in_feet_go_to_the_same_table() {
    let Some(data) = shared("ngsim_i80_pairs") else {
        return;
    };
    let study = TempStudy::new();
    let data = format!("data={}", std::fs::canonicalize(data).unwrap().display());
    let ran = study
        .maveric(&[
            "run",
            "pipelines/ngsim.toml",
            "--set",
            &data,
            "--set",
            "epochs=2",
            "--set",
            "closed_loop_seeds=1",
        ])
        .ok();
    for said in ["network in closed loop", "harmed by personalising", "Gipps"] {
        assert!(ran.stdout.contains(said), "{said}: {}", ran.stdout);
    }
    let text =
        std::fs::read_to_string(study.path("study_data/generated/ngsim/following.json")).unwrap();
    let found: serde_json::Value = serde_json::from_str(&text).unwrap();
    let gaps = &found["drivers"][0]["series"]["gap_m"];
    // Recorded in feet: metres after reading, so dense traffic stays below 40.
    assert!(
        gaps.as_array()
            .unwrap()
            .iter()
            .all(|g| g.as_f64().unwrap() < 40.0)
    );
    let closed_loop = &found["closed_loop"]["seeds"][0];
    for w in ["own", "mean"] {
        for driver in closed_loop[w].as_array().unwrap() {
            assert_eq!(driver["reached_zero"], false, "the safety bound holds");
        }
    }
}

#[test]
fn without_the_recordings_the_message_says_how_to_get_them() {
    let study = TempStudy::new();
    study
        .maveric(&["run", "pipelines/openacc.toml", "--set", "data=nowhere"])
        .failed(1, &["nowhere", "CC BY 4.0", "Joint Research Centre"]);
}

#[test]
fn a_pose_recording_ingests_without_a_lead_vehicle() {
    let Some(log) = shared("mcap/cub_pose_flight.mcap") else {
        return;
    };
    let study = TempStudy::new();
    study
        .maveric(&["ingest", log.to_str().unwrap(), "--out", "drives"])
        .ok();
    let list = std::fs::read_to_string(study.path("drives/drives.csv")).unwrap();
    assert_eq!(list.lines().count(), 2, "{list}");
}
