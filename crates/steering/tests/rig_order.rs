//! Which loss of a rig costs the order of a calm and an aggressive drive.

#[path = "support/rig.rs"]
mod rig;

use maveric_simulator::Scenario;

/// SDs by which an aggressive drive lies above the person's own, and a calm one below it.
const APART: f64 = 0.5;
const PEOPLE: usize = 80;

#[test]
fn the_order_is_lost_where_only_the_vehicle_ahead_is_seen_and_nowhere_else() {
    let scenario = Scenario::paper();
    let model = rig::learned(36, 1.9, &scenario).unwrap();
    let people: Vec<_> =
        (0..PEOPLE).map(|i| rig::calm_and_aggressive(i, APART, &scenario).unwrap()).collect();
    let holds: Vec<f64> = (0..rig::STEPS.len())
        .map(|step| rig::order(&people, &model, step, rig::seen_by(step)).unwrap().holds)
        .collect();
    assert!(holds[0] >= 0.95, "{holds:?}");
    let lost: Vec<f64> = holds.windows(2).map(|pair| pair[0] - pair[1]).collect();
    for (i, lost) in lost.iter().enumerate() {
        if i + 1 == rig::ONLY_AHEAD {
            assert!(*lost >= 0.05, "{holds:?}");
        } else {
            assert!(lost.abs() <= 0.03, "{holds:?}");
        }
    }
    // It is not turned round: most people are still read the right way.
    assert!(holds[rig::STEPS.len() - 1] >= 0.8, "{holds:?}");
}
