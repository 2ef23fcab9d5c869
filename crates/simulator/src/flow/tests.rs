use super::*;
use proptest::prelude::*;

fn ring(lanes: u8, length_m: f64, count: usize, mobil: Option<Mobil>, seed: u64) -> Flow {
    let settings = FlowSettings { lanes, length_m, mobil, ..FlowSettings::default() };
    let vehicles = evenly(&settings, count, &TrafficMix::default(), seed).unwrap();
    Flow::new(settings, &vehicles, Vec::new()).unwrap()
}

/// Smallest bumper-to-bumper gap in any lane, in which a changing vehicle counts in both.
fn smallest_gap_m(flow: &Flow) -> f64 {
    let lanes = flow.lanes.iter();
    lanes
        .flat_map(|lane| (0..lane.len()).map(|i| lane.lead(i, flow.ends).0))
        .fold(f64::INFINITY, f64::min)
}

fn state(flow: &Flow) -> Vec<FlowVehicle> {
    flow.vehicles().collect()
}

#[test]
fn a_homogeneous_ring_keeps_the_equilibrium_of_the_formula() {
    let settings = FlowSettings { lanes: 1, mobil: None, ..FlowSettings::default() };
    let mix = TrafficMix::alike(IdmDriver::CAR);
    // Sparse enough to be stable.
    let vehicles = evenly(&settings, 12, &mix, 1).unwrap();
    let mut flow = Flow::new(settings, &vehicles, Vec::new()).unwrap();
    (0..6000).for_each(|_| flow.step());
    let expected = IdmDriver::CAR.equilibrium_speed_mps(1000.0 / 12.0 - 5.0);
    assert!((flow.mean_speed_mps() - expected).abs() < 1e-6);
}

#[test]
fn nobody_collides_and_nobody_is_lost_over_an_hour_on_rings() {
    for (lanes, per_km) in [(1, 20), (2, 25), (3, 12), (3, 40), (4, 60)] {
        let count = usize::from(lanes) * 2 * per_km;
        let mut flow = ring(lanes, 2000.0, count, Some(Mobil::default()), 3);
        for step in 0..36_000 {
            flow.step();
            let gap = smallest_gap_m(&flow);
            assert!(gap > 0.0, "{lanes} lanes, {per_km}/km: {gap} m at step {step}");
        }
        assert_eq!(flow.len(), count);
        let changed = flow.started_changes();
        assert_eq!(changed > 50, lanes > 1, "{lanes} lanes, {per_km}/km: {changed}");
    }
}

#[test]
fn lanes_stay_in_order_and_every_vehicle_is_there_once() {
    let mut flow = ring(3, 1500.0, 90, Some(Mobil::default()), 5);
    for _ in 0..3000 {
        flow.step();
        for lane in &flow.lanes {
            for rank in 1..lane.len() {
                assert!(lane.x[lane.at(rank - 1)] < lane.x[lane.at(rank)]);
            }
        }
    }
    let mut ids: Vec<u32> = flow.vehicles().map(|v| v.id).collect();
    ids.sort_unstable();
    assert_eq!(ids, (0..90).collect::<Vec<u32>>());
}

#[test]
fn the_same_start_gives_the_same_bytes_and_another_seed_another() {
    let run = |seed| {
        let mut flow = ring(3, 1000.0, 60, Some(Mobil::default()), seed);
        (0..2000).for_each(|_| flow.step());
        state(&flow)
    };
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}

#[test]
fn a_step_allocates_nothing() {
    let mut flow = ring(3, 1000.0, 40, Some(Mobil::default()), 1);
    let places = |flow: &Flow| {
        let lanes = flow.lanes.iter().chain(&flow.staged).chain([&flow.spare]);
        let mut at: Vec<_> = lanes.map(|l| (l.x.as_ptr(), l.x.capacity())).collect();
        at.sort_unstable();
        (at, flow.decided.as_ptr(), flow.pairs.as_ptr())
    };
    let before = places(&flow);
    (0..5000).for_each(|_| flow.step());
    assert!(flow.started_changes() > 20, "{}", flow.started_changes());
    assert_eq!(places(&flow), before);
}

#[test]
fn faster_drivers_pass_a_truck_where_there_is_a_second_lane() {
    let one_truck = |mobil| {
        let settings =
            FlowSettings { lanes: 2, length_m: 3000.0, mobil, ..FlowSettings::default() };
        let place =
            |front_m: f64, driver: IdmDriver| Placed { lane: 0, front_m, speed_mps: 22.0, driver };
        let mut vehicles = vec![place(1000.0, IdmDriver::TRUCK)];
        vehicles.extend((1..6).map(|i| place(980.0 - 50.0 * f64::from(i), IdmDriver::CAR)));
        let mut flow = Flow::new(settings, &vehicles, Vec::new()).unwrap();
        (0..3000).for_each(|_| flow.step());
        flow.mean_speed_mps()
    };
    assert!(one_truck(None) < 23.0);
    assert!(one_truck(Some(Mobil::default())) > 29.0);
}

#[test]
fn a_change_goes_smoothly_from_lane_to_lane_in_its_time() {
    let mut flow = ring(2, 1500.0, 24, Some(Mobil::default()), 4);
    let mut paths = vec![Vec::new(); 24];
    for _ in 0..2000 {
        flow.step();
        for v in flow.vehicles() {
            paths[v.id as usize].push((v.lane, v.lateral_lanes));
        }
    }
    // Four seconds at ten steps a second.
    let mut changes = 0;
    for path in &paths {
        for start in 1..path.len() - 40 {
            let (from, into) = (path[start - 1].0, path[start].0);
            if from == into {
                continue;
            }
            changes += 1;
            let way: Vec<f64> =
                (0..=40).map(|step| (path[start + step].1 - f64::from(from)).abs()).collect();
            assert!(way[0] < 0.01 && (way[40] - 1.0).abs() < 1e-9, "{way:?}");
            assert!((way[20] - 0.5).abs() < 0.06, "{way:?}");
            // The steepest of the way is 15/8 of its mean.
            let rises = way.windows(2).map(|w| w[1] - w[0]);
            assert!(rises.into_iter().all(|r| (0.0..0.05).contains(&r)), "{way:?}");
        }
    }
    assert!(changes > 20, "{changes}");
}

#[test]
fn a_bias_to_the_right_fills_the_right_lane() {
    let share_right = |keep_right_mps2| {
        let mobil = Mobil { keep_right_mps2, ..Mobil::default() };
        let mut flow = ring(2, 3000.0, 24, Some(mobil), 2);
        let mut right = 0;
        for _ in 0..6000 {
            flow.step();
            right += flow.vehicles().filter(|v| v.lane == 0).count();
        }
        right as f64 / (6000.0 * 24.0)
    };
    let (without, with) = (share_right(0.0), share_right(0.3));
    assert!((without - 0.5).abs() < 0.15, "{without}");
    assert!(with > without + 0.1, "{without} {with}");
}

#[test]
fn what_enters_an_open_road_leaves_it() {
    let settings =
        FlowSettings { lanes: 2, length_m: 2000.0, shape: Shape::Open, ..FlowSettings::default() };
    let coming = departures(&settings, 900.0, 600.0, &TrafficMix::default(), 1).unwrap();
    let total = coming.len();
    assert!((250..350).contains(&total), "{total}");
    let mut flow = Flow::new(settings, &[], coming).unwrap();
    let mut most = 0;
    for _ in 0..10_000 {
        flow.step();
        assert!(smallest_gap_m(&flow) > 0.0);
        most = most.max(flow.len());
    }
    assert!(most > 25, "{most}");
    assert!(flow.is_empty());
    assert!(flow.started_changes() > 20);
}

#[test]
fn a_standing_guest_stops_its_lane_and_those_beside_it_pass() {
    let mut flow = ring(2, 2000.0, 20, Some(Mobil::default()), 4);
    for _ in 0..3000 {
        flow.place_guest(0, [Some(0), None], 500.0, 0.0, 5.0);
        flow.step();
        assert!(smallest_gap_m(&flow) > 0.0);
    }
    assert_eq!(flow.len(), 20);
    let waiting = flow.vehicles().filter(|v| v.speed_mps < 0.5).count();
    assert!(waiting <= 3 && flow.mean_speed_mps() > 15.0, "{waiting}");
}

#[test]
fn a_guest_that_changes_lane_is_in_both_and_then_in_one() {
    let mut flow = ring(3, 1000.0, 30, Some(Mobil::default()), 4);
    for (step, lanes) in [[Some(0), None], [Some(0), Some(1)], [Some(1), None], [None; 2]]
        .into_iter()
        .flat_map(|l| [l; 40])
        .enumerate()
    {
        let x = 2000.0 + 2.0 * step as f64;
        flow.place_guest(3, lanes, x, 20.0, 4.7);
        flow.step();
        assert_eq!(flow.len(), 30);
        for (k, lane) in flow.lanes.iter().enumerate() {
            let here = lane.role.iter().filter(|r| **r == Role::Guest).count();
            assert_eq!(here == 1, lanes.contains(&Some(k as u8)));
        }
    }
}

#[test]
fn overlapping_vehicles_and_bad_numbers_are_refused_by_name() {
    let settings = FlowSettings::default();
    let place = |front_m| Placed { lane: 1, front_m, speed_mps: 10.0, driver: IdmDriver::CAR };
    let refused = |settings: FlowSettings, vehicles: &[Placed], departures: Vec<Departure>| {
        let error = Flow::new(settings, vehicles, departures).unwrap_err();
        error.to_string()
    };
    let message = refused(settings, &[place(10.0), place(14.0)], Vec::new());
    assert!(message.contains("`vehicles[0].gap_m` is -1"), "{message}");
    // Across the seam of the ring.
    let message = refused(settings, &[place(3.0), place(999.0)], Vec::new());
    assert!(message.contains("`vehicles[1].gap_m` is -1"), "{message}");
    let message = refused(settings, &[place(f64::NAN)], Vec::new());
    assert!(message.contains("`vehicles[0].front_m`"), "{message}");
    let still = FlowSettings { step_s: 0.0, ..settings };
    assert!(refused(still, &[], Vec::new()).contains("`flow.step_s`"));
    let departure = Departure { time_s: 0.0, lane: 0, driver: IdmDriver::CAR };
    assert!(refused(settings, &[], vec![departure]).contains("`departures[0].lane`"));
    let open = FlowSettings { shape: Shape::Open, ..settings };
    let later = Departure { time_s: 5.0, ..departure };
    assert!(refused(open, &[], vec![later, departure]).contains("`departures[1].time_s`"));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_accepted_setting_makes_the_background_collide(
        lanes in 1_u8..=4,
        per_km in 3_usize..70,
        politeness in 0.0..1.0_f64,
        keep_right in 0.0..0.5_f64,
        duration_s in 0.0..8.0_f64,
        every_s in 0.1..3.0_f64,
        trucks in 0.0..0.5_f64,
        seed in 0..u64::MAX,
    ) {
        let mobil = Mobil {
            politeness,
            keep_right_mps2: keep_right,
            duration_s,
            considers_every_s: every_s,
            ..Mobil::default()
        };
        let settings = FlowSettings { lanes, mobil: Some(mobil), ..FlowSettings::default() };
        let mix = TrafficMix { truck_share: trucks, ..TrafficMix::default() };
        let count = per_km * usize::from(lanes);
        let vehicles = evenly(&settings, count, &mix, seed).unwrap();
        let mut flow = Flow::new(settings, &vehicles, Vec::new()).unwrap();
        for _ in 0..3000 {
            flow.step();
            prop_assert!(smallest_gap_m(&flow) > 0.0);
        }
        prop_assert_eq!(flow.len(), count);
    }
}
