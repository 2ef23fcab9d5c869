//! What a laboratory brings beside logs: its own measures, answers alone, and the list of what is missing.

mod analysed;
mod given_away;

use crate::support::{
    TempStudy, argv, files,
    own_logs::{PEOPLE, analysis, change, panel, recorded, recorded_of},
    page::Page,
    tells,
};
use maveric_study::tables::Table;
use serde_json::Value;
use std::{
    collections::BTreeMap,
    fmt::Write as _,
    path::{Path, PathBuf},
};

const DECLARED: &str = "[[measure]]\nid = \"tor_s\"\ntitle = \"Take-over time\"\nunit = \"s\"\naggression = \"-\"\n\
                        [[measure]]\nid = \"glances\"\nunit = \"1\"\n\
                        [[hypothesis]]\nsays = \"Taking over from the sporty car takes longer\"\noutcome = \"tor_s\"\n\
                        contrast = [\"sporty\", \"calm\"]\ndirection = \"+\"\n";

fn table_of(people: &[&str]) -> String {
    let mut text = "participant,condition,trial,tor_s,glances,rater\n".to_owned();
    for (i, who) in people.iter().enumerate() {
        let calm = 2.0 + 0.1 * i as f64;
        for (condition, mean) in [("calm", calm), ("sporty", calm + 0.5 + 0.1 * i as f64)] {
            let _ = writeln!(text, "{who},{condition},1,{:.1},3,A", mean - 0.2);
            let _ = writeln!(text, "{who},{condition},2,{:.1},{},A", mean + 0.2, 4 + i);
        }
    }
    text
}
