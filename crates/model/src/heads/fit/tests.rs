use super::{
    super::{
        list::{HEADS, at},
        posterior::evaluate,
    },
    *,
};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

fn fit(drives: &[DriveEvents], d: usize) -> Fitted {
    super::fit(&HEADS.map(|h| h.shape()), drives, d)
}

/// Levels of the habits, their slopes on two true styles, own scatter of a drive, and scatter of an event.
const TRUTH: [(f64, [f64; 2], f64, f64); 6] = [
    (29.0, [1.5, -1.0], 0.7, 0.5),
    (0.1, [0.0, 0.25], 0.08, 0.1),
    (0.7, [-0.2, 0.15], 0.08, 0.16),
    (0.4, [-0.2, 0.2], 0.08, 0.16),
    (-3.0, [1.5, 1.0], 0.5, 0.0),
    (1.5, [-0.5, -0.5], 0.3, 0.5),
];

struct MadeUp {
    /// η of each head for each drive.
    eta: Vec<Vec<f64>>,
    events: Vec<DriveEvents>,
}

/// Drives of drivers that are made as the heads assume.
fn made_up(n: usize, seed: u64) -> MadeUp {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut normal = move || -> f64 { StandardNormal.sample(&mut rng) };
    let mut made = MadeUp { eta: Vec::new(), events: Vec::new() };
    for _ in 0..n {
        let w = [normal(), normal()];
        let mut of_head = Vec::new();
        let mut etas = Vec::new();
        for (head, (level, slopes, between, within)) in HEADS.iter().zip(TRUTH) {
            let eta = level + slopes[0] * w[0] + slopes[1] * w[1] + between * normal();
            etas.push(eta);
            let event = |i: usize, normal: &mut dyn FnMut() -> f64| {
                let reads = vec![4.0 + 2.0 * normal(); head.reads.len()];
                let outcome = match head.family {
                    Family::Gaussian => Outcome::Value(eta + within * normal()),
                    Family::LogNormal if i % 3 == 2 => {
                        // Kept from going at the gap wanted: what is seen is shorter.
                        Outcome::AtLeast((eta + within * normal() - normal().abs() * 0.3).exp())
                    }
                    Family::LogNormal => Outcome::Value((eta + within * normal()).exp()),
                    Family::Logistic => {
                        let p = Family::Logistic.mean(eta + reads[0], 0.0);
                        let u = 0.5 * (1.0 + (normal() / 1.3).tanh());
                        Outcome::Value(f64::from(u8::from(u < p)))
                    }
                };
                Event { time_s: i as f64, reads, outcome }
            };
            of_head.push((0..8).map(|i| event(i, &mut normal)).collect());
        }
        made.eta.push(etas);
        made.events.push(of_head);
    }
    made
}

fn correlation(pairs: &[(f64, f64)]) -> f64 {
    let n = pairs.len() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| pairs.iter().map(f).sum::<f64>() / n;
    let (a, b) = (mean(|p| p.0), mean(|p| p.1));
    let sum = |f: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(f).sum::<f64>();
    sum(&|p| (p.0 - a) * (p.1 - b))
        / (sum(&|p| (p.0 - a).powi(2)) * sum(&|p| (p.1 - b).powi(2))).sqrt()
}

#[test]
fn heads_learned_from_some_drivers_say_what_others_do() {
    let fitted = fit(&made_up(60, 1).events, 2);
    assert!(fitted.rounds < ROUNDS, "{}", fitted.rounds);
    let others = made_up(200, 2);
    for k in [at::FREE_SPEED, at::MOVE_OUT, at::MERGE_BACK] {
        let head = &fitted.heads[k];
        let (level, slopes, _, within) = TRUTH[k];
        let length = head.slopes.iter().map(|b| b * b).sum::<f64>().sqrt();
        let truth = slopes[0].hypot(slopes[1]);
        assert!((head.common[0] - level).abs() < 0.5 * truth, "{head:?}");
        assert!((length / truth - 1.0).abs() < 0.35, "{head:?}");
        let open = head.between_sd.powi(2) / (head.between_sd.powi(2) + length * length);
        assert!((open - HEADS[k].left_open).abs() < 1e-3, "{head:?}");
        assert!((head.within_sd / within - 1.0).abs() < 0.25, "{head:?}");
        let pairs = others.events.iter().zip(&others.eta).map(|(events, eta)| {
            let latent = solve(&fitted.heads, events, None, 2, None);
            (head.eta(latent.w(2), std::iter::once(1.0)), eta[k])
        });
        let r = correlation(&pairs.collect::<Vec<_>>());
        assert!(r > 0.8, "{k}: {r}");
    }
}

#[test]
fn a_posterior_is_as_wide_as_it_is_wrong() {
    let fitted = fit(&made_up(60, 1).events, 2);
    // Two halves of a drive say the same style, but for what each of them leaves open.
    let others = made_up(200, 3);
    let mut square = 0.0;
    for events in &others.events {
        let half = |odd: usize| -> DriveEvents {
            events.iter().map(|e| e.iter().skip(odd).step_by(2).cloned().collect()).collect()
        };
        let [a, b] = [0, 1].map(|odd| solve(&fitted.heads, &half(odd), None, 2, None));
        for i in 0..2 {
            let variance = a.covariance[(i, i)] + b.covariance[(i, i)];
            square += (a.mean[i] - b.mean[i]).powi(2) / variance / 400.0;
        }
    }
    // Less than 1: the drive's own deviations are the same in both halves.
    assert!((0.1..1.1).contains(&square), "{square}");
}

#[test]
fn the_posterior_s_slope_and_curvature_are_those_of_its_value() {
    let made = made_up(20, 4);
    let heads = fit(&made.events, 3).heads;
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let n = 3 + heads.len();
    let at = DVector::from_fn(n, |_, _| rng.random_range(-0.3..0.3));
    let there = |x: &DVector<f64>| evaluate(&heads, &made.events[0], None, 3, x);
    let h = 1e-5;
    for i in 0..n {
        let moved = |by: f64| {
            let mut x = at.clone();
            x[i] += by;
            there(&x)
        };
        let (up, down) = (moved(h), moved(-h));
        let slope = (up.value - down.value) / (2.0 * h);
        let found = there(&at);
        assert!((found.gradient[i] - slope).abs() < 1e-3 * (1.0 + slope.abs()));
        for j in 0..n {
            let bend = (up.gradient[j] - down.gradient[j]) / (2.0 * h);
            let entry = found.curvature[(i, j)];
            assert!((entry - bend).abs() < 1e-3 * (1.0 + bend.abs()), "{i} {j}");
        }
    }
}

#[test]
fn a_habit_that_nobody_showed_is_not_learned_and_harms_nothing() {
    let mut made = made_up(20, 6);
    for events in &mut made.events {
        events[at::PASS].clear();
    }
    let fitted = fit(&made.events, 3);
    assert!(!fitted.heads[at::PASS].learned());
    let numbers = fitted.heads.iter().flat_map(|h| h.slopes.iter().chain(&h.common));
    assert!(numbers.into_iter().all(|x| x.is_finite()));
    let one = fit(&made.events[..1], 3);
    assert!(one.latents[0].mean.iter().all(|x| x.is_finite()));
}
