//! A lead that drives off while it is being passed is let go.

use maveric_domain::{LatentTraits, stream_seed};
use maveric_simulator::{Driver, DriverParams, People, Scenario, rollout};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

#[test]
fn nobody_made_up_drives_much_faster_than_they_would_on_a_free_road() {
    let scenario = Scenario::paper();
    let people = People::Drivers(Box::new(scenario.settings().drivers.clone()));
    // The third of these people met such a lead, and went along with it up to 52 m/s.
    for person in 0..30 {
        let name = person.to_string();
        let of = |what: &str| stream_seed(1000, &[what, &name]);
        let mut rng = Pcg64Mcg::seed_from_u64(of("traits"));
        let traits = LatentTraits::draw(|| StandardNormal.sample(&mut rng));
        let usual = DriverParams::draw(&traits, of("person"), of("day"));
        let who = people.draw(&traits, of("person"), of("day"));
        let driven = rollout(&scenario, Driver::from(&who), of("world"))
            .expect("the paper's scenario can be driven");
        let speeds = driven.recording.ego().speed_mps.iter().copied();
        let fastest = speeds.fold(0.0, f64::max);
        let desired = usual.desired_speed().0;
        assert!(
            fastest < desired + 12.0,
            "person {person} would drive {desired:.1} m/s and drove {fastest:.1}"
        );
    }
}
