//! Background traffic: vehicle-steps a second. Run with `cargo bench -p maveric-simulator --bench flow`.
//!
//! One lane is the Intelligent Driver Model alone; three lanes have MOBIL, asked once a second for each side, and changes
//! of 4 s. Rings of 20 vehicles per km and lane with trucks, steps of 0.1 s, as in `tests/external/sumo_compare.py`.

use divan::{Bencher, counter::ItemsCount};
use maveric_simulator::flow::{Flow, FlowSettings, Mobil, TrafficMix, evenly};

#[global_allocator]
static ALLOCATIONS: divan::AllocProfiler = divan::AllocProfiler::system();

fn main() {
    divan::main();
}

/// Vehicle-steps of one sample, so that the clock's grain does not matter.
const STEPS: usize = 200_000;

fn warm(lanes: u8, vehicles: usize, mobil: Option<Mobil>) -> Flow {
    let per_lane = vehicles.div_ceil(usize::from(lanes));
    let settings =
        FlowSettings { lanes, length_m: per_lane as f64 * 50.0, mobil, ..FlowSettings::default() };
    let placed = evenly(&settings, vehicles, &TrafficMix::default(), 1).expect("room enough");
    let mut flow = Flow::new(settings, &placed, Vec::new()).expect("settings in range");
    for _ in 0..600 {
        flow.step();
    }
    flow
}

fn run(bencher: Bencher<'_, '_>, lanes: u8, vehicles: usize, mobil: Option<Mobil>) {
    let steps = STEPS / vehicles;
    bencher
        .counter(ItemsCount::new(steps * vehicles))
        .with_inputs(|| warm(lanes, vehicles, mobil))
        .bench_local_refs(|flow| (0..steps).for_each(|_| flow.step()));
}

#[divan::bench(name = "flow/one_lane", args = [10, 100, 1000, 10_000], sample_count = 20)]
fn one_lane(bencher: Bencher<'_, '_>, vehicles: usize) {
    run(bencher, 1, vehicles, None);
}

#[divan::bench(name = "flow/three_lanes", args = [10, 100, 1000, 10_000], sample_count = 20)]
fn three_lanes(bencher: Bencher<'_, '_>, vehicles: usize) {
    run(bencher, 3, vehicles, Some(Mobil::default()));
}
