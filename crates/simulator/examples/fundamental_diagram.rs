//! Flow and speed of background traffic over density; or the samples and the speed that the comparison with SUMO asks for.
//!
//! ```text
//! cargo run --release -p maveric-simulator --example fundamental_diagram
//! fundamental_diagram ring 1000 300 900 vehicles.csv    # samples of a ring, one line a vehicle and second
//! fundamental_diagram open 10000 900 1800 vehicles.csv  # the same of an open road
//! fundamental_diagram speed 3 1000                      # lanes, vehicles: vehicle-steps a second, and steps driven
//! ```
//!
//! Numbers: length in m, first and last second that is printed. `vehicles.csv` has a header and the columns lane, front_m
//! (on an open road: departure in s), speed_mps, desired_speed_mps, time_gap_s, standstill_m, acceleration_mps2,
//! braking_mps2, length_m; `id` in the samples is the row.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use maveric_simulator::flow::{
    Departure, Flow, FlowSettings, IdmDriver, Mobil, Placed, Shape, TrafficMix, evenly,
};
use std::{error::Error, time::Instant};

/// Seconds left out at the start of each density.
const WARM_S: usize = 600;
/// Seconds over which means are taken.
const MEASURED_S: usize = 600;
/// Steps a second.
const RATE: usize = 10;

fn table() -> Result<(), Box<dyn Error>> {
    println!(
        "lanes,vehicles_per_km_and_lane,mean_speed_mps,flow_per_hour_and_lane,changes_per_km_and_hour"
    );
    for lanes in [1, 3] {
        for density in [5, 10, 15, 20, 25, 30, 40, 50, 60, 80] {
            let settings = FlowSettings {
                lanes,
                mobil: (lanes > 1).then_some(Mobil::default()),
                length_m: 3000.0,
                ..FlowSettings::default()
            };
            let count = 3 * density * usize::from(lanes);
            let vehicles = evenly(&settings, count, &TrafficMix::default(), 1)?;
            let mut flow = Flow::new(settings, &vehicles, Vec::new())?;
            (0..WARM_S * RATE).for_each(|_| flow.step());
            let (mut sum, before) = (0.0, flow.started_changes());
            for _ in 0..MEASURED_S {
                (0..RATE).for_each(|_| flow.step());
                sum += flow.mean_speed_mps();
            }
            let speed = sum / MEASURED_S as f64;
            let hours = MEASURED_S as f64 / 3600.0;
            println!(
                "{lanes},{density},{speed:.2},{:.0},{:.0}",
                speed * 3.6 * density as f64,
                (flow.started_changes() - before) as f64 / hours / 3.0
            );
        }
    }
    Ok(())
}

/// Rows of a table of numbers after its header.
fn rows(path: &str) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("{path}: {e}"))?;
    let rows = text.lines().enumerate().skip(1).map(|(i, line)| {
        let cells: Result<Vec<f64>, _> = line.split(',').map(str::parse).collect();
        let cells = cells.map_err(|e| format!("{path}, line {}: {e}", i + 1))?;
        if cells.len() == 9 {
            Ok(cells)
        } else {
            Err(format!("{path}, line {}: {} columns, expected 9", i + 1, cells.len()).into())
        }
    });
    rows.collect()
}

fn driver(row: &[f64]) -> IdmDriver {
    IdmDriver {
        desired_speed_mps: row[3],
        time_gap_s: row[4],
        standstill_m: row[5],
        acceleration_mps2: row[6],
        braking_mps2: row[7],
        length_m: row[8],
    }
}

fn samples(
    shape: Shape,
    [length_m, from_s, to_s]: [f64; 3],
    path: &str,
) -> Result<(), Box<dyn Error>> {
    let rows = rows(path)?;
    let lanes = rows.iter().map(|row| row[0] as u8 + 1).max().unwrap_or(1);
    let settings = FlowSettings {
        lanes,
        length_m,
        shape,
        step_s: 1.0 / RATE as f64,
        mobil: (lanes > 1).then_some(Mobil::default()),
    };
    let (mut placed, mut departures) = (Vec::new(), Vec::new());
    for row in &rows {
        let (lane, driver) = (row[0] as u8, driver(row));
        match shape {
            Shape::Ring => placed.push(Placed { lane, front_m: row[1], speed_mps: row[2], driver }),
            Shape::Open => departures.push(Departure { time_s: row[1], lane, driver }),
        }
    }
    let mut flow = Flow::new(settings, &placed, departures)?;
    println!("time_s,id,lane,front_m,speed_mps,gap_m");
    for second in 1..=to_s as usize {
        (0..RATE).for_each(|_| flow.step());
        if second as f64 >= from_s {
            for v in flow.vehicles() {
                println!(
                    "{second},{},{},{:.3},{:.4},{:.4}",
                    v.id, v.lane, v.front_m, v.speed_mps, v.gap_m
                );
            }
        }
    }
    Ok(())
}

/// Fastest of several runs: the machine may be busy with other things.
fn speed(lanes: u8, count: usize) -> Result<(), Box<dyn Error>> {
    let settings = FlowSettings {
        lanes,
        length_m: count.div_ceil(usize::from(lanes)) as f64 * 50.0,
        mobil: (lanes > 1).then_some(Mobil::default()),
        ..FlowSettings::default()
    };
    let vehicles = evenly(&settings, count, &TrafficMix::default(), 1)?;
    let mut flow = Flow::new(settings, &vehicles, Vec::new())?;
    (0..600).for_each(|_| flow.step());
    let steps = 1_000_000 / count;
    let mut best = f64::INFINITY;
    for _ in 0..15 {
        let start = Instant::now();
        (0..steps).for_each(|_| flow.step());
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!("{:.0},{}", (steps * count) as f64 / best, (15 * steps + 600) * count);
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        [] => table(),
        [shape @ ("ring" | "open"), length, from, to, path] => {
            let shape = if *shape == "ring" { Shape::Ring } else { Shape::Open };
            samples(shape, [length.parse()?, from.parse()?, to.parse()?], path)
        }
        ["speed", lanes, count] => speed(lanes.parse()?, count.parse()?),
        _ => {
            Err("expected nothing, `ring|open LENGTH FROM TO FILE` or `speed LANES VEHICLES`"
                .into())
        }
    }
}
