//! The number of the lane and the place in it, in every layout; and a place in the lane that is taken for one across the road.

use super::mapped::{UNITS, drive_of, mapped, of_toml};
use maveric_ingest::{
    IngestSettings, Ingested, Warning, WarningKind, inspect_with, suggest_mapping,
};
use std::fmt::Write as _;

const WIDTH_M: f64 = 3.5;

/// Where ego is across three lanes at a time, in m: a lane to the left around 20 s, another one around 40 s.
fn across_m(t: f64) -> f64 {
    let change = |at: f64| WIDTH_M / (1.0 + (2.0 * (at - t)).exp());
    change(20.0) + change(40.0)
}

/// The lane from the right, and the place in it to the left.
fn in_lane(t: f64) -> (u32, f64) {
    let y = across_m(t);
    let lane = (y / WIDTH_M).round();
    (lane as u32, y - lane * WIDTH_M)
}

fn mapping(layout: &str, columns: &str) -> String {
    format!(
        "[road]\nlanes = 3\nlane_width_m = {WIDTH_M}\nposted_speed_mps = 33.0\nframe = \"map\"\n[table]\nlayout = \"{layout}\"\n\
         {UNITS}[table.columns]\ntime = \"t\"\n{columns}"
    )
}

/// Sixty seconds at 20 Hz of whatever a row is.
fn table(header: &str, row: impl Fn(f64) -> String) -> String {
    let mut text = format!("{header}\n");
    for i in 0..1200 {
        let t = f64::from(i) / 20.0;
        writeln!(text, "{t},{}", row(t)).unwrap();
    }
    text
}

/// Two lane changes to the left, seen in each row.
fn changes_lanes(found: &Ingested) {
    assert!(found.recording.sees().lanes);
    let drive = drive_of(found);
    let rows = drive.rows();
    assert_eq!(drive.len(), 1200);
    for (time_s, y_m) in rows.time_s.iter().zip(&rows.ego_y_m) {
        // A place beyond .49 of a lane is kept in it.
        assert!((y_m - across_m(*time_s)).abs() < 0.02 * WIDTH_M, "{y_m} at {time_s} s");
    }
    assert_eq!(drive.lane_changes().len(), 2);
    assert!(drive.lane_changes().iter().all(|c| c.completed));
}

const PAIR: &str = "ego_speed = \"v\"\ngap = \"gap\"\nlead_speed = \"w\"\n";

/// A pair whose lanes are numbered from the left, from 1, and whose place grows to the right, in cm.
fn pair(columns: &str, keys: &str) -> String {
    let text = mapping("pair", &format!("{PAIR}{columns}"));
    text.replace(
        "layout = \"pair\"\n",
        &format!("layout = \"pair\"\ngap_kind = \"bumper_to_bumper\"\n{keys}"),
    )
}

fn pair_table() -> String {
    table("t,v,gap,w,lane,offset", |t| {
        let (lane, offset) = in_lane(t);
        format!("25,40,25,{},{}", 3 - lane, -offset)
    })
}

const NUMBERED: &str = "lanes_from = \"left\"\noffset_grows = \"right\"\n";
const LANE: &str = "lane = \"lane\"\noffset = \"offset\"\n";

#[test]
fn a_pair_a_platoon_and_a_long_table_have_lanes_by_number_and_place() {
    let found = mapped(&pair(LANE, NUMBERED), &pair_table()).unwrap();
    changes_lanes(&found[0]);
    let lead = &found[0].recording.others()[0];
    assert!(lead.x_m.len() == 1200, "one leader, in ego's lane throughout");

    let platoon = mapping("platoon", "speed = \"v{n}\"\ngap = \"gap{n}\"\nlane = \"lane{n}\"\noffset = \"off{n}\"\n").replace(
        "layout = \"platoon\"\n",
        "layout = \"platoon\"\ngap_kind = \"bumper_to_bumper\"\nlanes_from = \"right\"\nfirst_lane = 0\noffset_grows = \"left\"\n",
    );
    let text = table("t,v1,v2,gap1,lane1,off1,lane2,off2", |t| {
        let (lane, offset) = in_lane(t);
        // The car ahead stays in the right lane.
        format!("25,25,40,0,0.1,{lane},{offset}")
    });
    let found = mapped(&platoon, &text).unwrap();
    changes_lanes(&found[0]);
    let lead = &found[0].recording.others()[0];
    assert!(lead.y_m.iter().all(|y| (y - 0.1).abs() < 1e-9), "{:?}", &lead.y_m[..3]);

    let long = mapping(
        "long",
        "id = \"id\"\nx = \"x\"\nspeed = \"v\"\nlane = \"lane\"\noffset = \"offset\"\n",
    )
    .replace(
        "layout = \"long\"\n",
        "layout = \"long\"\npoint = \"centre\"\nlanes_from = \"right\"\noffset_grows = \"left\"\n",
    );
    let text = table("t,id,x,v,lane,offset", |t| {
        let (lane, offset) = in_lane(t);
        format!("a,{},25,{},{offset}\n{t},b,{},25,1,-0.2", 25.0 * t, lane + 1, 60.0 + 25.0 * t)
    });
    let found = mapped(&long, &text).unwrap();
    changes_lanes(&found[0]);
    let other = &found[0].recording.others()[0];
    assert!(other.y_m.iter().all(|y| (y + 0.2).abs() < 1e-9));
}

#[test]
fn a_number_alone_steps_from_lane_to_lane_and_a_place_alone_makes_no_lane_change() {
    let steps = mapped(&pair("lane = \"lane\"\n", "lanes_from = \"left\"\n"), &pair_table())
        .unwrap()
        .remove(0);
    let centre = |y: &f64| [0.0, WIDTH_M, 2.0 * WIDTH_M].iter().any(|c| (y - c).abs() < 1e-9);
    assert!(steps.recording.sees().lanes && steps.recording.ego().y_m.iter().all(centre));
    let alone = mapped(&pair("offset = \"offset\"\n", "offset_grows = \"right\"\n"), &pair_table())
        .unwrap()
        .remove(0);
    assert!(!alone.recording.sees().lanes);
    assert!(alone.recording.ego().y_m.iter().all(|y| y.abs() < 0.5 * WIDTH_M));
}

#[test]
fn what_says_where_ego_is_twice_or_lacks_a_side_is_asked_about() {
    let refused =
        |columns: &str, keys: &str| of_toml(&pair(columns, keys)).unwrap_err().to_string();
    for (columns, keys, said) in [
        (
            LANE,
            "offset_grows = \"left\"\n",
            "`table.lanes_from` is not given: are lanes numbered from the `left`",
        ),
        (
            LANE,
            "lanes_from = \"left\"\n",
            "`table.offset_grows` is not given: does the place in the lane grow to the `left`",
        ),
        ("", NUMBERED, "does nothing without"),
        (
            "lane = \"lane\"\n",
            NUMBERED,
            "`table.offset_grows` does nothing without `table.columns.offset`",
        ),
        (
            "ego_y = \"y\"\nlane = \"lane\"\n",
            "lanes_from = \"left\"\n",
            "both say where ego is across the road",
        ),
    ] {
        let error = refused(columns, keys);
        assert!(error.contains(said), "{error}");
    }
    let long = |columns: &str, keys: &str| {
        let text = mapping("long", &format!("id = \"id\"\nx = \"x\"\n{columns}"));
        let text = text.replace(
            "layout = \"long\"\n",
            &format!("layout = \"long\"\npoint = \"centre\"\noffset_grows = \"left\"\n{keys}"),
        );
        of_toml(&text).unwrap_err().to_string()
    };
    let error = long("offset = \"offset\"\n", "");
    assert!(error.contains("`table.columns.lane` is not given: in which lane"), "{error}");
    let error = long(
        "y = \"y\"\nlane = \"l\"\noffset = \"o\"\n",
        "y_grows = \"left\"\nlanes_from = \"left\"\n",
    );
    assert!(error.contains("`y` is for a position across the road"), "{error}");
}

#[test]
fn lanes_that_the_road_has_not_are_refused_and_a_row_without_a_lane_is_counted() {
    let beside = pair_table().replace(",3,", ",9,").replace(",2,", ",8,").replace(",1,", ",7,");
    let error = mapped(&pair(LANE, NUMBERED), &beside).unwrap_err().to_string();
    assert!(
        error.contains("beside the road of 3 lanes") && error.contains("`first_lane`"),
        "{error}"
    );
    let text = table("t,v,gap,w,lane,offset", |t| {
        let (lane, offset) = in_lane(t);
        let lane = if (10.0..10.2).contains(&t) { String::new() } else { (3 - lane).to_string() };
        format!("25,40,25,{lane},{}", -offset)
    });
    let found = mapped(&pair(LANE, NUMBERED), &text).unwrap().remove(0);
    let left_out = found.warnings.iter().find(|w| w.kind == WarningKind::MissingValue);
    assert_eq!(left_out.map(|w| w.count), Some(4), "{:?}", found.warnings);
}

#[test]
fn a_place_in_the_lane_that_is_mapped_across_the_road_is_told_with_what_to_write() {
    let wrong = pair("ego_y = \"offset\"\n", "");
    let found = mapped(&wrong, &pair_table()).unwrap().remove(0);
    let told = |found: &Ingested| {
        found.warnings.iter().find(|w| w.what.contains("place in the lane")).cloned()
    };
    let warning = told(&found).unwrap();
    assert_eq!((warning.kind, warning.count), (WarningKind::Unit, 2));
    for word in [
        "`offset` jumps by a lane's width",
        "`offset = \"offset\"` in the place of `ego_y`",
        "`offset_grows`",
        "`lane`",
    ] {
        assert!(warning.what.contains(word), "{}", warning.what);
    }
    assert!((warning.spans_s[0].0 - 20.0).abs() < 0.2 && (warning.spans_s[1].0 - 40.0).abs() < 0.2);
    // One across the road, and one that is mapped as what it is, are not.
    let right = table("t,v,gap,w,y", |t| format!("25,40,25,{}", across_m(t)));
    assert_eq!(told(&mapped(&pair("ego_y = \"y\"\n", ""), &right).unwrap()[0]), None);
    assert_eq!(told(&mapped(&pair(LANE, NUMBERED), &pair_table()).unwrap()[0]), None);
    // Every vehicle of a long table is looked at.
    let long = mapping("long", "id = \"id\"\nx = \"x\"\nspeed = \"v\"\ny = \"offset\"\n").replace(
        "layout = \"long\"\n",
        "layout = \"long\"\npoint = \"centre\"\ny_grows = \"left\"\n",
    );
    let text = table("t,id,x,v,offset", |t| {
        format!("a,{},25,{}\n{t},b,{},25,0.1", 25.0 * t, in_lane(t).1, 60.0 + 25.0 * t)
    });
    let found = mapped(&long, &text).unwrap();
    assert!(told(&found[0]).is_some() && told(&found[1]).is_none());
}

#[test]
fn a_lane_that_the_road_does_not_have_is_beside_it_wherever_in_it_ego_is() {
    let mapping = |lanes: u32| {
        let keys = "lanes_from = \"right\"\nfirst_lane = 0\noffset_grows = \"left\"\n";
        pair(LANE, keys).replace("lanes = 3\n", &format!("lanes = {lanes}\n"))
    };
    // In lane 2 for some time, counted from 0, and then in lane 1.
    let read = |lanes: u32, until_s: f64, offset: f64| {
        let text = table("t,v,gap,w,lane,offset", |t| {
            format!("25,40,25,{},{offset}", if t < until_s { 2 } else { 1 })
        });
        mapped(&mapping(lanes), &text).map(|found| {
            let mut warnings = found[0].warnings.iter();
            let told = warnings.find(|w| w.what.contains("beside the road of 2 lanes"));
            told.map_or(0, |w| w.count)
        })
    };
    for offset in [-0.4, 0.0, 0.4] {
        assert_eq!(read(2, 6.0, offset).unwrap(), 120, "{offset}");
        let error = read(2, 30.0, offset).unwrap_err().to_string();
        assert!(error.contains("in 600 of 1200 samples ego is beside the road"), "{error}");
        assert_eq!(read(3, 30.0, offset).unwrap(), 0, "{offset}");
    }
}

#[test]
fn an_only_lane_keeps_its_leader_whatever_its_number_and_what_leaves_it_is_told() {
    let read = |number: i32, from_30_s: i32| {
        let text = table("t,v,gap,w,lane", |t| {
            format!("25,40,25,{}", if t < 30.0 { number } else { from_30_s })
        });
        let mapping = pair("lane = \"lane\"\n", "lanes_from = \"right\"\n");
        let mapping = mapping.replace("lanes = 3\n", "lanes = 1\n");
        let found = mapped(&mapping, &text).unwrap().remove(0);
        let drive = drive_of(&found);
        let alone = drive.rows().lead_present.iter().filter(|there| !**there);
        // A row on the step itself may have nobody.
        assert!(alone.count() < 3, "{number}");
        let mut warnings = found.warnings.iter();
        let told = warnings.find(|w| w.what.contains("the road's only lane"));
        told.map_or(0, |w| w.count)
    };
    assert_eq!(read(1, 1), 0);
    assert_eq!(read(1, 2), 600);
    for number in [0, 2, 4] {
        assert_eq!(read(number, number), 1200, "{number}");
    }
}

#[test]
fn a_proposal_counts_lanes_from_the_least_number_where_it_is_below_1() {
    let folder = tempfile::tempdir().unwrap();
    let proposed = |first: i32| {
        let path = folder.path().join("P01.csv");
        let text = table("t,ego_speed,gap,lead_speed,lane", |t| {
            let lane = first + i32::from(t > 30.0);
            format!("{},40,25,{lane}", 25.0 + (0.3 * t).sin())
        });
        std::fs::write(&path, text).unwrap();
        suggest_mapping(&path).unwrap()
    };
    for first in [0, -2] {
        let toml = proposed(first);
        assert!(
            toml.contains("\nlanes = 2\n") && toml.contains(&format!("\nfirst_lane = {first}\n")),
            "{toml}"
        );
        assert!(!toml.contains("only lane"), "{toml}");
    }
    let toml = proposed(2);
    assert!(toml.contains("\nlanes = 3\n") && !toml.contains("\nfirst_lane"), "{toml}");
}

#[test]
fn a_place_beyond_its_lane_is_told_and_one_in_another_unit_refused() {
    let read = |rows: usize, offset: f64| {
        let text = table("t,v,gap,w,lane,offset", |t| {
            let is_far = t < rows as f64 / 20.0;
            format!("25,40,25,2,{}", if is_far { offset } else { 0.1 })
        });
        mapped(&pair(LANE, NUMBERED), &text).map(|found| {
            let mut warnings = found[0].warnings.iter();
            let told = warnings.find(|w| w.what.contains("ends at the lane's edge"));
            told.map_or(0, |w| w.count)
        })
    };
    assert_eq!(read(200, 1.7).unwrap(), 0);
    assert_eq!(read(200, 9.0).unwrap(), 200);
    let error = read(400, 40.0).unwrap_err().to_string();
    assert!(error.contains("in 400 of 1200 samples a place in the lane"), "{error}");
}

#[test]
fn proposal_takes_a_column_that_jumps_for_a_place_in_the_lane() {
    let folder = tempfile::tempdir().unwrap();
    let proposed = |text: &str| {
        let path = folder.path().join("P01.csv");
        std::fs::write(&path, text).unwrap();
        let summary = inspect_with(&path, &IngestSettings::default()).unwrap();
        (suggest_mapping(&path).unwrap(), summary)
    };
    // By its name it may be either; the reader says which it is.
    let text = table("t,ego_speed,gap,lead_speed,lane,lateral", |t| {
        let (lane, offset) = in_lane(t);
        format!("{},40,25,{},{offset}", 25.0 + (0.3 * t).sin(), lane + 1)
    });
    let (toml, summary) = proposed(&text);
    for line in [
        "offset = \"lateral\"",
        "offset_grows = \"left\"",
        "lane = \"lane\"",
        "lanes_from = \"right\"",
        "lanes = 3",
    ] {
        assert!(toml.contains(&format!("{line}\n")), "{toml}");
    }
    assert!(toml.contains("Read by it: 1 drive,"), "{toml}");
    assert!(summary.warnings.is_empty(), "{:?}", summary.warnings);
    let text = table("t,ego_speed,gap,lead_speed,lateral", |t| {
        format!("{},40,25,{}", 25.0 + (0.3 * t).sin(), across_m(t))
    });
    let (toml, summary) = proposed(&text);
    assert!(toml.contains("ego_y = \"lateral\"\n") && !toml.contains("\noffset"), "{toml}");
    assert!(summary.warnings.is_empty(), "{:?}", summary.warnings);
    let (_, summary) = proposed(&text.replace("\n2,", "\n2\n2,"));
    let early = |w: &Warning| w.what.contains("after 1 of 5 cells");
    assert!(summary.warnings.iter().any(early), "{:?}", summary.warnings);
}

#[test]
fn time_of_a_proposal_is_told_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let proposed = |text: &str| {
        let path = folder.path().join("P01.csv");
        std::fs::write(&path, text).unwrap();
        suggest_mapping(&path).map_err(|e| e.to_string())
    };
    let speed = |t: f64| 25.0 + 3.0 * (0.3 * t).sin();
    let way = |t: f64| 25.0 * t - 10.0 * (0.3 * t).cos();
    for name in ["Zeit", "Uhrzeit", "t[s]"] {
        // Beside a number of the row and a way, which rise as well.
        let mut text = format!("Nr,Weg,{name},speed,gap,lead_speed\n");
        for i in 0..600 {
            let t = f64::from(i) / 20.0;
            writeln!(text, "{i},{},{t},{},40,25", way(t), speed(t)).unwrap();
        }
        let toml = proposed(&text).unwrap();
        assert!(toml.contains(&format!("time = \"{name}\"\n")), "{toml}");
        assert!(toml.contains("[table.units]\n") && toml.contains("\ntime = \"s\"\n"), "{toml}");
    }
    let mut text = "Uhrzeit,speed,gap,lead_speed\n".to_owned();
    for i in 0..600 {
        writeln!(
            text,
            "14:{:02}:{:02}.{:02},{},40,25",
            i / 1200,
            i / 20 % 60,
            i % 20 * 5,
            speed(f64::from(i) / 20.0)
        )
        .unwrap();
    }
    let toml = proposed(&text).unwrap();
    assert!(
        toml.contains("time = \"Uhrzeit\"\n") && toml.contains("time_pattern = \"%H:%M:%S.%f\""),
        "{toml}"
    );
    // A name that says nothing, and a way.
    for name in ["temps", "čas", "Weg"] {
        let mut text = format!("{name},speed,gap,lead_speed\n");
        for i in 0..600 {
            let t = f64::from(i) / 20.0;
            writeln!(text, "{t},{},40,25", speed(t)).unwrap();
        }
        let refused = proposed(&text).unwrap_err();
        assert!(refused.contains("a time was not found"), "{refused}");
    }
}

#[test]
fn places_beyond_the_lane_are_marked_as_cut_off() {
    let mapping = "[road]\nlanes = 2\nlane_width_m = 3.5\nposted_speed_mps = 30.0\n[table]\nlayout = \"long\"\npoint = \"centre\"\n\
        lanes_from = \"right\"\noffset_grows = \"left\"\n[table.units]\ntime = \"s\"\nlength = \"m\"\nspeed = \"m/s\"\n\
        [table.columns]\ntime = \"t\"\nid = \"id\"\nx = \"x\"\nspeed = \"v\"\nlane = \"lane\"\noffset = \"off\"\n";
    let mut text = "t,id,x,v,lane,off\n".to_owned();
    for i in 0..600 {
        let t = f64::from(i) / 20.0;
        for id in 0..6 {
            let centre = if id == 0 { 3.0 } else { 0.0 };
            let (x, place) = (20.0 * t + 60.0 * f64::from(id), centre + 0.4 * t.sin());
            writeln!(text, "{t},{id},{x},20,1,{place}").unwrap();
        }
    }
    let found = mapped(mapping, &text).unwrap();
    // Whether the drive shows that its places end at the lane's edge: then measures of the place have no value.
    let is_cut_off = |drive: usize| {
        let road = found[drive].recording.road();
        found[drive].recording.ego().y_m.iter().all(|y| road.is_cut_off(*y))
    };
    let cut_off: Vec<bool> = (0..6).map(is_cut_off).collect();
    assert_eq!(cut_off, [true, false, false, false, false, false]);
}
