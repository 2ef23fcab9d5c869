//! Real recordings, where they stand beside the checkout.

use crate::support::{Ran, TempStudy, argv, tells};
use crate::where_there::{shared, trial};
use libtest_mimic::Trial;

/// The tests, each with the recording that it needs.
pub(crate) fn tests() -> Vec<Trial> {
    let of = |name, path, test: fn()| trial(name, shared(path).err(), test);
    vec![
        of(
            "openacc_goes_from_csv_to_the_table_of_errors",
            "openacc_astazero",
            openacc_goes_from_csv_to_the_table_of_errors,
        ),
        of(
            "ngsim_pairs_in_feet_go_to_the_same_table",
            "ngsim_i80_pairs",
            ngsim_pairs_in_feet_go_to_the_same_table,
        ),
        of(
            "people_are_judged_by_what_was_learned_from_others",
            "ngsim_i80_pairs",
            people_are_judged_by_what_was_learned_from_others,
        ),
        of(
            "six_real_drivers_are_left_out_in_turn",
            "uah_tables",
            six_real_drivers_are_left_out_in_turn,
        ),
        of(
            "every_shipped_recording_can_be_inspected",
            "mcap",
            every_shipped_recording_can_be_inspected,
        ),
        trial(
            "without_the_recordings_the_message_says_how_to_get_them",
            None,
            without_the_recordings_the_message_says_how_to_get_them,
        ),
        of(
            "a_pose_recording_ingests_without_a_lead_vehicle",
            "mcap/cub_pose_flight.mcap",
            a_pose_recording_ingests_without_a_lead_vehicle,
        ),
    ]
}

/// A study in which a shipped pipeline ran on these recordings, with further settings; and what the run said.
fn run_on(recordings: &str, pipeline: &str, settings: &str) -> (TempStudy, Ran) {
    let data = std::fs::canonicalize(shared(recordings).unwrap()).unwrap();
    let data = format!("data={}", data.display());
    let settings = argv(settings);
    let study = TempStudy::new();
    let call = [&["run", pipeline, "--set", data.as_str()], &settings[..]].concat();
    let ran = study.maveric(&call).ok();
    (study, ran)
}

fn openacc_goes_from_csv_to_the_table_of_errors() {
    let pipeline = "pipelines/openacc.toml";
    let (study, ran) = run_on("openacc_astazero", pipeline, "--set epochs=5");
    assert!(ran.stdout.contains("IDM"), "{}", ran.stdout);
    let following = study.read("study_data/generated/openacc/following.json");
    assert!(following.contains("platoon10-f2"), "each driver is there");
    let page = study.read("reports/openacc/index.html");
    assert!(page.contains("IDM, population and own time gap"));
    assert!(!page.contains("ynthetic participants"), "these people are real");
    let training = study.read("study_data/generated/openacc/model_training.json");
    assert!(training.contains("left_out"), "the losses without data are named");
}

fn six_real_drivers_are_left_out_in_turn() {
    let (study, _) = run_on("uah_tables", "pipelines/uah.toml", "");
    let text = study.read("reports/uah/validation.json");
    assert!(!text.contains("NaN"));
    let found: serde_json::Value = serde_json::from_str(&text).unwrap();
    let table = |id: &str| {
        let mut tables = found["tables"].as_array().unwrap().iter();
        tables.find(|t| t["asked"]["id"] == id).unwrap()
    };
    let order = &table("order-motorway")["answer"]["order"];
    let line = &order["readings"][0];
    assert_eq!((&line["by"], &line["n"]), (&"line".into(), &6.into()));
    // Seen while the method was made: speed alone and gap alone are right of all six, the line of no more.
    let right = |reading: usize| order["readings"][reading]["right"].as_u64().unwrap();
    assert_eq!((right(1), right(2)), (6, 6));
    assert!(right(0) >= 4, "{order}");
    // The dial is tried on three of them.
    let own = &table("direction-development")["answer"]["direction"]["found"]["people"];
    assert_eq!(own.as_array().unwrap().len(), 3);
}

fn ngsim_pairs_in_feet_go_to_the_same_table() {
    let settings = "--set epochs=2";
    let (study, ran) = run_on("ngsim_i80_pairs", "pipelines/ngsim.toml", settings);
    tells(
        &ran.stdout,
        &[
            "IDM, population  ",
            "IDM, population and own time gap  ",
            "IDM, own *  ",
            "driven by default: IDM, population and own time gap",
        ],
    );
    let found = study.json("study_data/generated/ngsim/following.json");
    let gaps = &found["drivers"][0]["series"]["gap_m"];
    // Recorded in feet: metres after reading, so dense traffic stays below 40.
    assert!(gaps.as_array().unwrap().iter().all(|g| g.as_f64().unwrap() < 40.0));
    let methods = ["idm_population", "idm_population_own_time_gap", "idm_own"];
    // As they were before other methods were removed.
    let before_m = [3.84, 2.25, 2.02];
    let means = found["means"].as_array().unwrap();
    assert_eq!(means.len(), methods.len());
    for ((mean, method), before_m) in means.iter().zip(methods).zip(before_m) {
        assert_eq!(mean["method"], method);
        assert!((mean["gap_rmse_m"].as_f64().unwrap() - before_m).abs() < 0.02, "{mean}");
        assert_eq!(mean["reached_zero"], 0);
    }
    for driver in found["drivers"].as_array().unwrap() {
        let time_gap_s = |at: usize| {
            let method = &driver["methods"][at];
            assert_eq!(method["method"], methods[at]);
            method["law"]["time_gap_s"].as_f64().unwrap()
        };
        let [population, own] = [time_gap_s(0), time_gap_s(1)];
        assert!((population - own).abs() > 1e-3, "{driver}");
    }
}

fn people_are_judged_by_what_was_learned_from_others() {
    let data = shared("ngsim_i80_pairs").unwrap();
    let study = TempStudy::new();
    for group in ["learned", "judged"] {
        std::fs::create_dir(study.path(group)).unwrap();
    }
    let mut files: Vec<_> = std::fs::read_dir(data)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.file_name().unwrap().to_str().unwrap().starts_with("i80"))
        .collect();
    files.sort();
    for (at, file) in files.iter().take(6).enumerate() {
        let group = if at < 4 { "learned" } else { "judged" };
        let to = study.path(group).join(file.file_name().unwrap());
        std::fs::copy(file, to).unwrap();
    }
    for group in ["learned", "judged"] {
        let drives = format!("{group}_drives");
        let mapping = "study_data/mappings/ngsim_pairs.toml";
        study.maveric(&["ingest", group, "--mapping", mapping, "--out", &drives]).ok();
    }
    let evaluate = "evaluate --drives judged_drives --learn learned_drives \
                    --moving-above-mps 1 --out following.json";
    let ran = study.maveric(&argv(evaluate)).ok();
    tells(&ran.stdout, &["learned from 4 people"]);
    let found = study.json("following.json");
    assert_eq!(found["drivers"].as_array().unwrap().len(), 2);
    assert_eq!(found["learned_from"], 4);
    assert_eq!(found["driven"], "idm_population_own_time_gap");
    let pair = &found["compared"][0];
    let interval = ["low_m", "mean_m", "high_m"].map(|end| pair[end].as_f64().unwrap());
    assert!(interval.is_sorted(), "{pair}");
}

fn without_the_recordings_the_message_says_how_to_get_them() {
    let study = TempStudy::new();
    study
        .maveric(&["run", "pipelines/openacc.toml", "--set", "data=nowhere"])
        .failed(1, &["nowhere", "CC BY 4.0", "Joint Research Centre"]);
}

fn a_pose_recording_ingests_without_a_lead_vehicle() {
    let log = shared("mcap/cub_pose_flight.mcap").unwrap();
    let study = TempStudy::new();
    study.maveric(&["ingest", log.to_str().unwrap(), "--out", "drives"]).ok();
    let list = study.read("drives/drives.csv");
    assert_eq!(list.lines().count(), 2, "{list}");
}

fn every_shipped_recording_can_be_inspected() {
    let folder = shared("mcap").unwrap();
    let study = TempStudy::new();
    let mut files = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        study.maveric(&["inspect", path.to_str().unwrap()]).ok();
        files += 1;
    }
    assert!(files >= 11);
}
