//! Logs in two parts, with lane and offset and German heads.

use super::*;

/// Half a minute of a German rig's recording a file: decimal commas, the lane by its number, the place in it.
fn halves(who: usize, place: usize, hole: bool) -> [String; 2] {
    let head =
        "Zeit [s];Geschwindigkeit [km/h];Abstand [m];v_Vordermann [km/h];Spur;Querablage [m]\n";
    let mut halves = [head.to_owned(), head.to_owned()];
    let v = kmh(who, place);
    for i in (0..1200).filter(|i| !(hole && (600..610).contains(i))) {
        let t = f64::from(i) / 20.0;
        // Across the line at 20 s and at 40 s, within 4 s each.
        let over = |at: f64| ((t - at + 2.0) / 4.0).clamp(0.0, 1.0);
        let y = 3.5 * (over(20.0) - over(40.0));
        let lane = if y >= 1.75 { 2 } else { 1 };
        let row = format!(
            "{t:.2};{v:.1};{:.3};{:.1};{lane};{:.3}\n",
            gap(place, t),
            v - 4.0,
            y - 3.5 * f64::from(lane - 1) + 0.1 * t.sin()
        );
        halves[usize::from(i >= 600)] += &row.replace('.', ",");
    }
    halves
}

fn gap(place: usize, t: f64) -> f64 {
    30.0 + 2.0 * place as f64 + 2.0 * (t / 7.0).sin()
}

#[test]
fn split_logs_of_lane_and_offset_with_german_heads() {
    let study = made(&["komfort", "sport"], &[]);
    let cars = ["own", "komfort", "sport"];
    for who in 0..6 {
        for (place, car) in cars.iter().enumerate() {
            let name = format!("mine/logs/VP{:02}/VP{:02}-{car}", who + 1, who + 1);
            let [first, second] = halves(who, place, who == 2);
            study.write(&format!("{name}.csv"), first);
            study.write(&format!("{name}_2.csv"), second);
        }
    }
    let people: Vec<String> = (1..=6).map(|who| format!("VP{who:02}\n")).collect();
    study.write("mine/participants.csv", format!("participant\n{}", people.concat()));
    let names =
        ("{participant}_{condition}\"\n", "{participant}-{condition}\"\nparts = \"_{n}\"\n");
    proposed(
        &study,
        "logs/VP01/VP01-komfort.csv",
        &[names, ("lane_width_m = 3.66", "lane_width_m = 3.5")],
    );
    let mapping = study.read("mine/mapping.toml");
    tells(
        &mapping,
        &[
            "ego_speed = \"Geschwindigkeit [km/h]\"",
            "gap = \"Abstand [m]\"",
            "lead_speed = \"v_Vordermann [km/h]\"",
            "lane = \"Spur\"",
            "offset = \"Querablage [m]\"",
            "speed = \"km/h\"",
            "decimal_comma = true",
        ],
    );
    let ran = study.mine("run").ok().stderr;
    tells(&ran, &["15 logs (", "goes on in its part 2, 0.050 s later"]);
    tells(&ran, &["3 logs (", "goes on in its part 2, 0.550 s later"]);
    let speeds = measured(&study, "mean_velocity_mps");
    assert_eq!(speeds.len(), 18);
    for (drive, mps) in &speeds {
        let who: usize = drive[2..4].parse().unwrap();
        let place = cars.iter().position(|c| drive.ends_with(c)).unwrap();
        assert!((mps - kmh(who - 1, place) / 3.6).abs() < 1e-6, "{drive}: {mps}");
    }
    let whole = |drive: &str| !drive.starts_with("VP03");
    for (drive, changes) in measured(&study, "lane_changes") {
        assert!((changes - 2.0).abs() < 1e-9, "{drive}: {changes}");
    }
    for (drive, share) in measured(&study, "left_lane_fraction").iter().filter(|(d, _)| whole(d)) {
        assert!((share - 1.0 / 3.0).abs() < 2e-3, "{drive}: {share}");
    }
    for (drive, least) in
        measured(&study, "min_headway_distance_m").iter().filter(|(d, _)| whole(d))
    {
        let place = cars.iter().position(|c| drive.ends_with(c)).unwrap();
        let gaps = (0..1200).map(|i| gap(place, f64::from(i) / 20.0));
        let smallest = gaps.fold(f64::INFINITY, f64::min);
        assert!((least - smallest).abs() < 2e-3, "{drive}: {least}, not {smallest}");
    }
    let analysis = analysis(&study);
    let differences: Vec<f64> = (0..6).map(|who| kmh(who, 1) - kmh(who, 2)).collect();
    differs(
        panel(&analysis, "mean_velocity_mps").unwrap(),
        ["komfort", "sport"],
        &differences,
        1e-3,
    );
    Page::read(&study.path("mine/report/index.html"))
        .says(&["Tested 6 18", "goes on in its part 2, 0.550 s later"])
        .is_silent_of(&["What is not there"]);
}
