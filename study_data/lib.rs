//! The files of `study_data` and `pipelines` that travel inside the program and the crates: questionnaires, scenarios, mappings, designs,
//! the claims of the paper and what a run consists of. They stand at the top of the project, where a researcher sees and changes them;
//! this package has no code but the list of them and a look into it.
//!
//! ```
//! assert!(maveric_data::SCALES_ADB.contains("id = \"adb\""));
//! let paths: Vec<&str> = maveric_data::FILES.iter().map(|(path, _)| *path).collect();
//! assert!(paths.contains(&"pipelines/paper.toml"));
//! ```

/// The text of a questionnaire that is shipped, the paper's or one of `further_scales`.
pub fn scale(id: &str) -> Option<&'static str> {
    let is_it = |path: &str| {
        ["scales", "further_scales"]
            .map(|folder| format!("study_data/{folder}/{id}.toml"))
            .contains(&path.to_owned())
    };
    FILES.iter().find(|(path, _)| is_it(path)).map(|(_, text)| *text)
}

macro_rules! files {
    ($($name:ident = $path:literal;)+) => {
        $(
            #[doc = concat!("`", $path, "`")]
            pub const $name: &str = include_str!(concat!("../", $path));
        )+
        /// Path in the project and text of every file.
        pub const FILES: &[(&str, &str)] = &[$(($path, $name)),+];
    };
}

files! {
    README = "study_data/README.md";
    CLAIMS = "study_data/claims.toml";
    EFFECTS = "study_data/effects.toml";
    POPULATION = "study_data/population.toml";
    POPULATION_MISSPECIFIED = "study_data/population_misspecified.toml";
    POPULATION_RETEST_05 = "study_data/population_retest_05.toml";
    POPULATION_RETEST_05_MEASURES = "study_data/population_retest_05_measures.toml";
    POPULATION_RETEST_07 = "study_data/population_retest_07.toml";
    POPULATION_RETEST_07_MEASURES = "study_data/population_retest_07_measures.toml";
    POPULATION_RETEST_09 = "study_data/population_retest_09.toml";
    POPULATION_RETEST_09_MEASURES = "study_data/population_retest_09_measures.toml";
    POPULATION_SOURCES = "study_data/population_sources.toml";
    DESIGNS_PAPER = "study_data/designs/paper.toml";
    DESIGNS_UAH_DEVELOPMENT = "study_data/designs/uah_development.toml";
    DESIGNS_UAH_TEST = "study_data/designs/uah_test.toml";
    MAPPINGS_COMMA2K19 = "study_data/mappings/comma2k19.toml";
    MAPPINGS_ESMINI_CSV = "study_data/mappings/esmini_csv.toml";
    MAPPINGS_EXID = "study_data/mappings/exid.toml";
    MAPPINGS_HIGHD = "study_data/mappings/highd.toml";
    MAPPINGS_NGSIM = "study_data/mappings/ngsim.toml";
    MAPPINGS_NGSIM_FEET = "study_data/mappings/ngsim_feet.toml";
    MAPPINGS_NGSIM_PAIRS = "study_data/mappings/ngsim_pairs.toml";
    MAPPINGS_OPENACC = "study_data/mappings/openacc.toml";
    MAPPINGS_OPENACC_PLATOON = "study_data/mappings/openacc_platoon.toml";
    MAPPINGS_OPENPASS_CYCLICS = "study_data/mappings/openpass_cyclics.toml";
    MAPPINGS_OURS = "study_data/mappings/ours.toml";
    MAPPINGS_RIG_AUTOWARE = "study_data/mappings/rig_autoware.toml";
    MAPPINGS_RIG_CARLA_ROS_BRIDGE = "study_data/mappings/rig_carla_ros_bridge.toml";
    MAPPINGS_RIG_GENERIC_ROS2 = "study_data/mappings/rig_generic_ros2.toml";
    MAPPINGS_RIG_MAVERIC = "study_data/mappings/rig_maveric.toml";
    MAPPINGS_SUMO_FCD = "study_data/mappings/sumo_fcd.toml";
    MAPPINGS_UAH = "study_data/mappings/uah.toml";
    FURTHER_SCALES_ACCEPTANCE = "study_data/further_scales/acceptance.toml";
    FURTHER_SCALES_ATTENTION = "study_data/further_scales/attention.toml";
    FURTHER_SCALES_DEMOGRAPHICS = "study_data/further_scales/demographics.toml";
    FURTHER_SCALES_MISC = "study_data/further_scales/misc.toml";
    FURTHER_SCALES_NASA_TLX = "study_data/further_scales/nasa_tlx.toml";
    FURTHER_SCALES_PURPOSE = "study_data/further_scales/purpose.toml";
    FURTHER_SCALES_SSQ = "study_data/further_scales/ssq.toml";
    FURTHER_SCALES_STS_AD = "study_data/further_scales/sts_ad.toml";
    FURTHER_SCALES_WHICH = "study_data/further_scales/which.toml";
    SCALES_ADB = "study_data/scales/adb.toml";
    SCALES_AGGRESSIVENESS = "study_data/scales/aggressiveness.toml";
    SCALES_GODSPEED_INTELLIGENCE = "study_data/scales/godspeed_intelligence.toml";
    SCALES_JIAN_TRUST = "study_data/scales/jian_trust.toml";
    SCALES_MDSI = "study_data/scales/mdsi.toml";
    SCALES_MINI_IPIP = "study_data/scales/mini_ipip.toml";
    SCALES_ROSAS = "study_data/scales/rosas.toml";
    SCALES_SIMILARITY = "study_data/scales/similarity.toml";
    SCENARIOS_CURVED = "study_data/scenarios/curved.toml";
    SCENARIOS_CUT_IN = "study_data/scenarios/cut_in.toml";
    SCENARIOS_DENSE = "study_data/scenarios/dense.toml";
    SCENARIOS_FOUR_LANE = "study_data/scenarios/four_lane.toml";
    SCENARIOS_HARD_BRAKING_LEAD = "study_data/scenarios/hard_braking_lead.toml";
    SCENARIOS_MOTORWAY_120 = "study_data/scenarios/motorway_120.toml";
    SCENARIOS_PAPER = "study_data/scenarios/paper.toml";
    SCENARIOS_SEAT = "study_data/scenarios/seat.toml";
    SCENARIOS_STOP_AND_GO = "study_data/scenarios/stop_and_go.toml";
    PIPELINES_ABLATION = "pipelines/ablation.toml";
    PIPELINES_NGSIM = "pipelines/ngsim.toml";
    PIPELINES_NULL = "pipelines/null.toml";
    PIPELINES_OPENACC = "pipelines/openacc.toml";
    PIPELINES_PAPER = "pipelines/paper.toml";
    PIPELINES_POWER = "pipelines/power.toml";
    PIPELINES_SMOKE = "pipelines/smoke.toml";
    PIPELINES_UAH = "pipelines/uah.toml";
    PIPELINES_VALIDATE = "pipelines/validate.toml";
    PIPELINES_VALIDATE_NETWORKS = "pipelines/validate_networks.toml";
}

#[cfg(test)]
mod tests {
    use super::FILES;
    use std::{collections::BTreeSet, fs, path::Path};

    fn list(folder: &Path, found: &mut BTreeSet<String>) {
        for entry in fs::read_dir(folder).expect("a folder of the project") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().expect("a name").to_string_lossy();
            if path.is_dir() {
                if !name.starts_with('.') && name != "sample" && name != "generated" {
                    list(&path, found);
                }
            } else if path.extension().is_some_and(|e| e == "toml" || e == "md") {
                let below =
                    path.strip_prefix(env!("CARGO_MANIFEST_DIR")).expect("below the project");
                found.insert(below.to_string_lossy().replace('\\', "/"));
            }
        }
    }

    #[test]
    fn every_file_of_the_two_folders_but_the_sample_is_shipped() {
        let mut there = BTreeSet::new();
        for folder in ["study_data", "pipelines"] {
            list(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &mut there);
        }
        let shipped: BTreeSet<String> = FILES.iter().map(|(path, _)| (*path).to_owned()).collect();
        assert_eq!(shipped, there);
    }
}
