//! Logs and answers of a laboratory's own, written by hand: tables in km/h, with a lane offset.

use super::TempStudy;
use std::fmt::Write as _;

/// How the tables are read, but for the names.
pub const TABLE: &str = "\n[road]\nlanes = 2\nlane_width_m = 3.66\nposted_speed_mps = 24.5872\nframe = \"map\"\n\
    [table]\nlayout = \"pair\"\ngap_kind = \"bumper_to_bumper\"\n[table.units]\ntime = \"s\"\nlength = \"m\"\nspeed = \"km/h\"\n\
    [table.columns]\ntime = \"t\"\nego_x = \"x\"\nego_y = \"offset\"\nego_speed = \"speed\"\ngap = \"gap\"\nlead_speed = \"lead_speed\"\n";

/// One drive as a table: a minute behind a slower car, then round it by the left lane and back. `kmh` is ego's speed, `car` stands
/// in a column of its own.
pub fn table(kmh: f64, gap_m: f64, car: &str) -> String {
    let mut text = "t,x,offset,speed,gap,lead_speed,car\n".to_owned();
    let mps = kmh / 3.6;
    for i in 0..1200 {
        let t = f64::from(i) / 20.0;
        let left = (20.0..40.0).contains(&t);
        let offset = if left { 3.66 } else { 0.0 };
        let gap = gap_m + 2.0 * (t / 7.0).sin();
        let _ = writeln!(
            text,
            "{t},{},{offset},{kmh},{gap},{},{car}",
            mps * t,
            kmh - 4.0
        );
    }
    text
}

/// Answers to the items of some scales, a row an item: everybody before the drives and after each condition.
pub fn answers(people: &[&str], scales: &[(&str, usize, usize)], conditions: &[&str]) -> String {
    let mut text = "participant,moment,scale,item,answer\n".to_owned();
    for (i, who) in people.iter().enumerate() {
        for (j, moment) in std::iter::once(&"pre").chain(conditions).enumerate() {
            for (scale, items, most) in scales {
                for item in 1..=*items {
                    let answer = 1 + (i + 2 * j + item) % most;
                    let _ = writeln!(text, "{who},{moment},{scale},{item},{answer}");
                }
            }
        }
    }
    text
}

/// A questionnaire of one subscale.
pub fn scale(id: &str, items: u32, min: i32, max: i32, scoring: &str) -> String {
    let all: Vec<String> = (1..=items).map(|i| i.to_string()).collect();
    format!(
        "id = \"{id}\"\ntitle = \"{id}\"\nreference = \"ours\"\nitems = {items}\nmin = {min}\nmax = {max}\nscoring = \"{scoring}\"\n\
         [[subscales]]\nid = \"total\"\ntitle = \"{id}\"\nitems = [{}]\n",
        all.join(", ")
    )
}

/// Keeps only these questionnaires of a study's folder.
pub fn only_scales(study: &TempStudy, folder: &str, scales: &[(&str, String)]) {
    let place = study.path(&format!("{folder}/scales"));
    std::fs::remove_dir_all(&place).unwrap();
    for (id, text) in scales {
        study.write(&format!("{folder}/scales/{id}.toml"), text);
    }
}
