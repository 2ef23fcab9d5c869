//! Styles go in and come out in order: synthetic drivers of known style are learned, and the car drives like them,
//! faster when told to be more aggressive than they are and slower when told to be more cautious.

use crate::support::{TempStudy, argv, tells};
use path_slash::PathExt as _;
use std::collections::BTreeMap;

/// Mean velocity by participant and condition, from the measurements as CSV.
fn velocities(csv: &str) -> BTreeMap<(String, String), f64> {
    let mut lines = csv.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|h| *h == name).unwrap();
    let (who, condition, speed) =
        (column("participant"), column("condition"), column("mean_velocity_mps"));
    lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            ((cells[who].to_owned(), cells[condition].to_owned()), cells[speed].parse().unwrap())
        })
        .collect()
}

fn correlation(pairs: &[(f64, f64)]) -> f64 {
    let n = pairs.len() as f64;
    let (mx, my) =
        (pairs.iter().map(|p| p.0).sum::<f64>() / n, pairs.iter().map(|p| p.1).sum::<f64>() / n);
    let sum = |f: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(f).sum::<f64>();
    let xy = sum(&|p| (p.0 - mx) * (p.1 - my));
    xy / (sum(&|p| (p.0 - mx).powi(2)) * sum(&|p| (p.1 - my).powi(2))).sqrt()
}

/// The page shows the own drive and the four conditions, and the logs hold the same drives.
fn one_participant_is_watched(study: &TempStudy) {
    let read = |path: &str| std::fs::read(study.path(path)).unwrap();
    let page = String::from_utf8(read("d/watch.html")).unwrap();
    let labels: Vec<&str> = page
        .split("<i class=\"pl-swatch\"></i><b>")
        .skip(1)
        .map(|rest| rest.split_once('<').unwrap().0)
        .collect();
    assert_eq!(labels, ["Own", "Mimic", "Aggressive", "Cautious", "Perpendicular"]);
    assert!(page.contains("Synthetic participants."));
    let has = |path: &str, topic: &[u8]| {
        let log = read(path);
        log.windows(topic.len()).any(|part| part == topic)
    };
    assert!(has("d/av/logs/S2P01-mimic.mcap", b"/maveric/decisions"));
    let logs = "inspect d/logs/study2/S2P02-own.mcap d/av/logs/S2P02-mimic.mcap d/av/logs/S2P02-aggressive.mcap d/av/logs/S2P02-cautious.mcap d/av/logs/S2P02-perpendicular.mcap --watch d/again.html";
    study.maveric(&argv(logs)).ok();
    let again = String::from_utf8(read("d/again.html")).unwrap();
    let data = |page: &str| {
        let rest = page.split_once("class=\"pl-data\">").unwrap().1;
        rest.split_once("</script>").unwrap().0.to_owned()
    };
    assert_eq!(data(&page), data(&again));
}

#[test]
fn the_car_drives_like_its_owner_and_the_dial_turns_the_right_way() {
    let study = TempStudy::new();
    let run = |line: &str| study.maveric(&argv(line)).ok();
    run("generate --out d --study1 16 --study2 8 --duration 300 --seed 3");
    run("ingest d/logs/study1 --out d/drives/study1");
    run("ingest d/logs/study2 --out d/drives/study2");
    run("score --surveys d/surveys.csv --out d/scores.csv");
    run("train --drives d/drives/study1 --scores d/scores.csv --out d/model.maveric --epochs 30");
    run(
        "personalize --model d/model.maveric --drives d/drives/study2 --scores d/scores.csv --out d/embeddings.csv",
    );
    run("steer --model d/model.maveric --embeddings d/embeddings.csv --out d/conditions.csv");
    sweeps_and_attributes(&study);
    nobody_whom_the_scale_does_not_have_is_turned(&study);
    a_lent_style_has_the_riders_score(&study);
    run(
        "simulate --model d/model.maveric --conditions d/conditions.csv --out d/av --duration 300 --logs --watch d/watch.html --watch-participant S2P02 --watch-own d/logs/study2/S2P02-own.mcap",
    );
    one_participant_is_watched(&study);
    run("measure --drives d/drives/study2 --drives d/av/drives --out d/measurements.csv");

    let found = velocities(&study.read("d/measurements.csv"));
    let people: Vec<&String> = found.keys().filter(|k| k.1 == "own").map(|k| &k.0).collect();
    assert_eq!(people.len(), 8);
    let speed = |who: &String, condition: &str| found[&(who.clone(), condition.to_owned())];
    let pairs: Vec<(f64, f64)> =
        people.iter().map(|p| (speed(p, "own"), speed(p, "mimic"))).collect();
    assert!(correlation(&pairs) > 0.7, "mimic follows its owner: {pairs:?}");
    let ordered = people.iter().filter(|p| {
        speed(p, "aggressive") > speed(p, "mimic") - 0.05
            && speed(p, "mimic") > speed(p, "cautious") - 0.05
    });
    assert!(ordered.count() >= 6, "aggressive, mimic, cautious in that order: {found:?}");

    let rollouts = study.read("d/av/rollouts.csv");
    let at = rollouts.lines().next().unwrap().split(',').position(|h| h == "collisions").unwrap();
    assert!(rollouts.lines().skip(1).all(|l| l.split(',').nth(at) == Some("0")), "{rollouts}");
}

/// Whoever reads as no score of the scale keeps the own style and has no dial, unless asked for.
fn nobody_whom_the_scale_does_not_have_is_turned(study: &TempStudy) {
    let table = study.read("d/embeddings.csv");
    let mut lines = table.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let moved = lines.map(|line| {
        let cells = line.split(',').zip(&head).map(|(cell, name)| {
            if line.contains("S2P02") && name.starts_with('w') {
                (cell.parse::<f64>().unwrap() * 1000.0).to_string()
            } else {
                cell.to_owned()
            }
        });
        cells.collect::<Vec<_>>().join(",")
    });
    let far = std::iter::once(head.join(",")).chain(moved);
    study.write("d/far.csv", far.collect::<Vec<_>>().join("\n") + "\n");
    let steered = |flags: &[&str]| {
        let call = "steer --model d/model.maveric --embeddings d/far.csv \
                    --out d/far_conditions.csv";
        let call = argv(call);
        let ran = study.maveric(&[&call[..], flags].concat()).ok();
        let table = study.read("d/far_conditions.csv");
        let theirs = table.lines().filter(|line| line.starts_with("S2P02,"));
        let theirs: Vec<String> =
            theirs.map(|line| line.split(',').nth(1).unwrap().to_owned()).collect();
        (ran.stderr, theirs, table.lines().count())
    };
    let (told, theirs, rows) = steered(&[]);
    assert!(
        told.contains("participant S2P02: drives beyond what the model has learned from"),
        "{told}"
    );
    assert_eq!(theirs, ["mimic", "perpendicular"]);
    assert_eq!(rows, 1 + 7 * 4 + 2, "everybody else is turned");
    let (told, theirs, rows) = steered(&["--beyond"]);
    assert!(
        told.contains(
            "S2P02: drives beyond what the model has learned from: the dial is turned all the same"
        ),
        "{told}"
    );
    assert_eq!((theirs.len(), rows), (4, 1 + 8 * 4));

    // A sweep is held to the same.
    let sweep = "--sweep=-10,0,10";
    let (told, theirs, rows) = steered(&[sweep]);
    assert!(
        told.contains("participant S2P02: drives beyond") && told.contains("--beyond"),
        "{told}"
    );
    assert_eq!((theirs, rows), (vec!["mimic".to_owned()], 1 + 7 * 3 + 1));
    let score = |line: &str| line.split(',').nth(2).unwrap().to_owned();
    let swept = || study.read("d/far_conditions.csv");
    for line in swept().lines().skip(1) {
        // A number that cannot be is none.
        let theirs = line.starts_with("S2P02,");
        assert_eq!(score(line).is_empty(), theirs, "{line}");
    }
    let (told, theirs, rows) = steered(&[sweep, "--beyond"]);
    assert!(told.contains("turned all the same"), "{told}");
    assert_eq!((theirs.len(), rows), (3, 1 + 8 * 3));
    let driven = "simulate --model d/model.maveric --conditions d/far_conditions.csv --out d/far --duration 5";
    let driven = study.maveric(&argv(driven));
    let told = driven.ok().stderr;
    tells(
        &told,
        &[
            "participant S2P02: reads as a score that the scale does not have",
            "the car drives all the same",
        ],
    );
    let openness = argv("--attribute mini_ipip.openness --scores d/scores.csv --points 0.2");
    let (_, theirs, rows) = steered(&openness);
    assert_eq!((theirs.len(), rows), (1, 1 + 7 * 3 + 1));
}

/// Somebody else's style, at the rider's own score: of those learned from, or of the others who are tested once there are ten of them.
fn a_lent_style_has_the_riders_score(study: &TempStudy) {
    let shipped = crate::support::root().join("study_data");
    let paper = std::fs::read_to_string(shipped.join("designs/paper.toml")).unwrap();
    let paper = paper.replace("\"../", &format!("\"{}/", shipped.to_slash_lossy()));
    let was = "{ across = true }";
    assert!(paper.contains(was));
    let lent = |from: &str, people: usize| -> (String, Vec<BTreeMap<String, String>>) {
        let car = format!("{{ other = \"matched\", from = \"{from}\" }}");
        study.write("d/lent.toml", paper.replace(was, &car));
        // The same eight again, and again, under other names: nobody's style is more than twice the same.
        let table = study.read("d/embeddings.csv");
        let own = |line: &&str| line.starts_with("S2P") && line.contains(",own,");
        let mut lines = table.lines();
        let mut rows = vec![lines.next().unwrap().to_owned()];
        for round in 0..people.div_ceil(8) {
            let again = lines.clone().filter(own);
            rows.extend(again.map(|line| line.replace("S2P0", &format!("S2P{round}"))));
        }
        study.write("d/lent.csv", rows.join("\n") + "\n");
        let call = "steer --design d/lent.toml --model d/model.maveric --embeddings d/lent.csv --out d/lent_conditions.csv";
        let ran = study.maveric(&argv(call)).ok();
        let table = study.read("d/lent_conditions.csv");
        let mut lines = table.lines();
        let head: Vec<&str> = lines.next().unwrap().split(',').collect();
        let row = |line: &str| {
            let cells = head.iter().zip(line.split(','));
            cells.map(|(name, cell)| ((*name).to_owned(), cell.to_owned())).collect()
        };
        (ran.stderr, lines.map(row).collect())
    };
    for (from, people, donors) in
        [("learned", 8, "S1P"), ("tested", 8, "S1P"), ("tested", 16, "S2P")]
    {
        let (told, rows) = lent(from, people);
        let rides = rows.iter().filter(|row| row["condition"] == "perpendicular");
        let mut reached = 0;
        let mut drawn = BTreeMap::new();
        for row in rides {
            let (who, donor) = (&row["participant"], &row["donor"]);
            let number = |name: &str| row[name].parse::<f64>().unwrap();
            assert!(donor.starts_with(donors) && !donor.starts_with(who.as_str()), "{row:?}");
            assert!(number("moved_points").abs() < 1e-9, "{row:?}");
            let within = number("donor_shift_points").abs() <= 8.0
                && (0.7..=2.5).contains(&number("donor_distance_sd"));
            assert_eq!(row["donor_within_reach"], within.to_string(), "{row:?}");
            reached += usize::from(within);
            *drawn.entry(donor.clone()).or_insert(0) += 1;
        }
        assert_eq!(drawn.values().sum::<usize>(), people);
        assert!(reached > people / 2 && drawn.len() > people / 3, "{reached} {drawn:?}");
        let missed = format!("nobody within reach of {} of {people}", people - reached);
        assert_eq!(told.contains(&missed), reached < people, "{told}");
        assert!(
            rows.iter().all(|row| (row["condition"] == "perpendicular") != row["donor"].is_empty())
        );
    }
}

/// A sweep can be driven, another attribute can be moved with aggression held, and what cannot is said.
fn sweeps_and_attributes(study: &TempStudy) {
    let steer = |args: &str| {
        let fixed = "steer --model d/model.maveric --embeddings d/embeddings.csv --out d/sweep.csv";
        study.maveric(&[argv(fixed), argv(args)].concat())
    };
    let column = |name: &str| -> Vec<String> {
        let text = study.read("d/sweep.csv");
        let mut lines = text.lines();
        let at = lines.next().unwrap().split(',').position(|h| h == name);
        let cell = |line: &str| line.split(',').nth(at.unwrap()).unwrap().to_owned();
        lines.map(cell).collect()
    };
    let numbers = |name: &str| -> Vec<f64> {
        let cells = column(name);
        cells.iter().map(|c| c.parse().unwrap()).collect()
    };
    steer("--attribute mini_ipip.openness --scores d/scores.csv --points 0.2 --hold aggression")
        .ok();
    assert_eq!(column("drive").len(), 8 * 3);
    assert!(numbers("moved_points").iter().all(|m| m.abs() < 1e-6));
    assert!(numbers("attribute_points").iter().any(|m| m.abs() > 0.1));
    steer("--attribute mini_ipip.opennes --scores d/scores.csv")
        .failed(1, &["opennes", "did you mean `mini_ipip.openness`"]);
    steer("--attribute adb.total --scores d/scores.csv --hold adb.conflict --hold adb.speeding --hold aggression")
        .failed(1, &["4 attributes", "1 to 3", "hold fewer"]);
    steer("--attribute adb.total").failed(2, &["--scores"]);

    steer("--sweep=-10,0,10").ok();
    let names = column("drive");
    assert_eq!(names.len(), 8 * 3);
    assert!(names[0].ends_with("-aggression-down10"), "{names:?}");
    let driven =
        "simulate --model d/model.maveric --conditions d/sweep.csv --out d/sweep --duration 20";
    study.maveric(&argv(driven)).ok();
    for name in names {
        let path = format!("d/sweep/drives/{name}.parquet");
        assert!(study.path(&path).exists(), "{path}");
    }
}
