//! Every setting, read off its declaration: the tables of `docs/simulator.md`, and each number at the ends of its range.

use super::{
    ScenarioSettings,
    setting::{Field, Range, Value, check_section},
};
use crate::drivers::People;
use std::fmt::Write as _;

/// A scenario of the keys alone that have no default.
const REQUIRED: &str = "
[[vehicles]]
ahead_m = 100.0
lane = 1
speed_mps = 20.0
script = [{}]
[background]
vehicles_per_km_and_lane = 20.0
ring_m = 2000.0
seen_within_m = 250.0
wave = { ahead_m = 100.0, length_m = 100.0, speed_mps = 5.0 }
";

const BEGIN: &str = "<!-- settings; `UPDATE_DOCS=1 cargo test -p maveric-simulator settings` writes what follows -->\n";
const END: &str = "<!-- end of the settings -->\n";

/// A section with its path, what it is, and its keys.
struct Section<'a> {
    path: String,
    doc: &'static str,
    keys: Vec<Field<'a>>,
}

/// `section` at `path` and the sections below it.
fn walk<'a>(
    path: &str,
    doc: &'static str,
    section: &'a dyn Value,
    sections: &mut Vec<Section<'a>>,
) {
    let (inner, keys) = section
        .fields()
        .into_iter()
        .partition::<Vec<_>, _>(|field| !field.value.fields().is_empty());
    let path_of = |key: &str| format!("{path}.{key}").trim_start_matches('.').to_owned();
    let below: Vec<_> = inner.iter().map(|f| (path_of(f.key), f.doc, f.value)).collect();
    sections.push(Section { path: path.to_owned(), doc, keys });
    for (path, doc, section) in below {
        walk(&path, doc, section, sections);
    }
}

fn sections<'a>(settings: &'a ScenarioSettings, evidence: &'a People) -> Vec<Section<'a>> {
    let mut sections = Vec::new();
    walk("", " The drive.", settings, &mut sections);
    sections[0].keys.retain(|field| !["vehicles", "background"].contains(&field.key));
    let vehicle = &settings.vehicles[0];
    walk("vehicles[0]", " Further vehicles.", vehicle, &mut sections);
    sections.last_mut().unwrap().keys.retain(|field| field.key != "script");
    let does = " What one does, step by step.";
    walk("vehicles[0].script[0]", does, &vehicle.script[0], &mut sections);
    let background = settings.background.as_ref().unwrap();
    let place = " Background traffic in the place of leads and off-lane vehicles.";
    walk("background", place, background, &mut sections);
    for section in &mut sections {
        section.keys.retain(|field| field.key != "wave");
    }
    let wave = " A section of slow traffic at the start.";
    walk("background.wave", wave, background.wave.as_ref().unwrap(), &mut sections);
    let People::Evidence(evidence) = evidence else {
        panic!("people of another kind");
    };
    let second = " In the place of `[drivers]` in a file of people: people of a second kind.";
    walk("evidence", second, evidence.as_ref(), &mut sections);
    sections
}

/// What stands at `path`.
fn at<'a>(value: &'a mut toml::Value, path: &str) -> Option<&'a mut toml::Value> {
    let mut keys = path.split('.').filter(|key| !key.is_empty());
    keys.try_fold(value, |value, key| match key.strip_suffix("[0]") {
        Some(key) => value.get_mut(key)?.get_mut(0),
        None => value.get_mut(key),
    })
}

fn example() -> (toml::Value, ScenarioSettings, People) {
    (
        toml::from_str(REQUIRED).unwrap(),
        toml::from_str(REQUIRED).unwrap(),
        toml::from_str(maveric_data::POPULATION_MISSPECIFIED).unwrap(),
    )
}

fn tables() -> String {
    let (mut required, settings, people) = example();
    let mut filled = toml::Value::try_from(&settings).unwrap();
    let mut text = String::new();
    for section in sections(&settings, &people) {
        let path = section.path.as_str();
        let name = match path {
            "" => String::new(),
            "vehicles[0]" => "`[[vehicles]]`: ".to_owned(),
            "vehicles[0].script[0]" => "`script` of a vehicle: ".to_owned(),
            _ => format!("`[{path}]`: "),
        };
        writeln!(text, "{name}{}\n", section.doc.trim()).unwrap();
        text += "| key | default | allowed | meaning |\n|---|---|---|---|\n";
        for Field { key, value, range, doc } in section.keys {
            let name = format!("{path}.{key}");
            let required = path == "evidence" || at(&mut required, &name).is_some();
            let default = match at(&mut filled, &name) {
                _ if required => "must be there".to_owned(),
                Some(value) => value.to_string().replace('\n', " "),
                None => "none".to_owned(),
            };
            let words: Vec<_> = value.choices().iter().map(|word| format!("`{word}`")).collect();
            let allowed = if words.is_empty() { range.words(&name) } else { words.join(", ") };
            writeln!(text, "| `{key}` | {default} | {allowed} | {} |", doc.trim()).unwrap();
        }
        text += "\n";
    }
    text
}

#[test]
fn the_page_has_the_settings_as_they_are_declared() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/simulator.md");
    let page = std::fs::read_to_string(path).unwrap();
    let (before, rest) = page.split_once(BEGIN).unwrap();
    let (written, after) = rest.split_once(END).unwrap();
    let declared = format!("\n{}", tables());
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(path, format!("{before}{BEGIN}{declared}{END}{after}")).unwrap();
    } else {
        assert_eq!(written, declared, "UPDATE_DOCS=1 cargo test -p maveric-simulator settings");
    }
}

/// Puts `number` where a number, a list, a law or nothing stands.
fn put(file: &mut toml::Value, section: &str, key: &str, number: f64) {
    let there = at(file, section).and_then(|section| section.as_table_mut());
    let there = there.unwrap().entry(key).or_insert(toml::Value::Float(0.0));
    match there {
        toml::Value::Integer(old) => *old = number as i64,
        toml::Value::Array(list) => list.fill(toml::Value::Float(number)),
        toml::Value::Table(law) => {
            law["lowest"] = toml::Value::Float(number);
            law["highest"] = toml::Value::Float(number);
        }
        _ => *there = toml::Value::Float(number),
    }
}

/// What is wrong with this file, if anything.
fn problem(section: &str, file: toml::Value) -> String {
    let checked = if section == "evidence" {
        file.try_into().map(|_: People| ()).map_err(|e| e.to_string())
    } else {
        let settings: ScenarioSettings = file.try_into().unwrap();
        check_section("", &settings).map_err(|e| e.to_string())
    };
    checked.err().unwrap_or_default()
}

#[test]
fn every_setting_is_allowed_at_the_ends_of_its_range_and_refused_beyond_them() {
    let (_, settings, people) = example();
    let scenario = toml::Value::try_from(&settings).unwrap();
    let evidence: toml::Value = toml::from_str(maveric_data::POPULATION_MISSPECIFIED).unwrap();
    let mut tried = 0;
    for Section { path, keys, .. } in sections(&settings, &people) {
        for Field { key, value, range, .. } in keys {
            let (inside, outside) = match range {
                Range::Positive => (vec![1e-9], vec![0.0]),
                Range::NotNegative => (vec![0.0], vec![-1e-9]),
                Range::Within(low, high) => (vec![low, high], vec![low - 0.1, high + 1.0]),
                Range::Finite | Range::Because(..) => continue,
            };
            // A number without a sign cannot be below 0 in a file.
            let signed = !["lanes", "lane", "cars", "encounters"].contains(&key);
            let outside = outside.into_iter().filter(|number| signed || *number > 0.0);
            let name = format!("{path}.{key}").trim_start_matches('.').to_owned();
            let with = |number| {
                let mut file = if path == "evidence" { &evidence } else { &scenario }.clone();
                put(&mut file, &path, key, number);
                problem(&path, file)
            };
            for number in inside {
                let problem = with(number);
                assert!(!problem.contains(&format!("`{name}")), "{number}: {problem}");
            }
            for number in outside {
                let problem = with(number);
                let refused =
                    problem.contains(&format!("`{name}")) && problem.contains(&range.words(&name));
                assert!(refused, "`{name}` = {number}: {problem}");
                tried += 1;
            }
            assert!(value.choices().is_empty(), "a choice has no range");
        }
    }
    assert!(tried > 200, "{tried}");
}

#[test]
fn the_unit_of_a_number_is_the_end_of_its_name() {
    let words = |name| Range::Within(0.5, 3.0).words(name);
    assert_eq!(words("controllers.approach_braking_mps2"), "0.5 to 3 m/s²");
    assert_eq!(words("drivers.lane_change_s.lowest"), "0.5 to 3 s");
    assert_eq!(words("controllers.passing_least_share"), "0.5 to 3");
}

#[test]
fn a_key_that_is_left_out_has_its_default_and_one_without_default_is_missed_by_name() {
    let empty: ScenarioSettings = toml::from_str("").unwrap();
    assert_eq!(empty, ScenarioSettings::default());
    let one: ScenarioSettings = toml::from_str("[controllers]\nmargin_m = 3.0").unwrap();
    let mut expected = ScenarioSettings::default();
    expected.controllers.margin_m = 3.0;
    assert_eq!(one, expected);
    let error = toml::from_str::<ScenarioSettings>("[background]\nring_m = 2000.0").unwrap_err();
    assert!(error.to_string().contains("vehicles_per_km_and_lane"), "{error}");
}
