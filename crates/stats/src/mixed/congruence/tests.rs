use super::*;
use crate::mixed::ratio::{LEVEL, Region};

struct Made {
    subjects: Vec<String>,
    liking: Vec<Option<f64>>,
    moved: Vec<Option<f64>>,
    own: Vec<Option<f64>>,
}

impl Made {
    fn test(&self) -> Result<Congruence, StatsError> {
        self.beside(&[])
    }

    fn beside(&self, beside: &[(&str, Predictor)]) -> Result<Congruence, StatsError> {
        let data = CongruenceData {
            subjects: &self.subjects,
            liking: &self.liking,
            moved: &self.moved,
            own: &self.own,
            beside,
        };
        congruence(&data, 5.0)
    }
}

/// A number without a pattern between -1 and 1.
fn drawn(seed: usize) -> f64 {
    (libm::sin(seed as f64 * 12.9898) * 43_758.547).fract()
}

/// 24 people whose own lies from -6 to 6 (SD 3.7), in cars at five distances, who like best what lies `top` points from it, and `drift`
/// more for each point of their own; what lies a point from there is liked less by `bend`.
fn made(top: f64, drift: f64, bend: f64) -> Made {
    let row = |row: usize| (row / 5, (row % 5) as f64 * 7.5 - 15.0);
    let own = |person: usize| (person % 12) as f64 * 12.0 / 11.0 - 6.0;
    let liking = |at: usize| {
        let (person, moved) = row(at);
        let best = top + drift * own(person) + drawn(person + 1);
        4.0 + drawn(100 + person) - bend * (moved - best).powi(2) + 0.5 * drawn(200 + at)
    };
    Made {
        subjects: (0..120).map(|at| row(at).0.to_string()).collect(),
        liking: (0..120).map(|at| Some(liking(at))).collect(),
        moved: (0..120).map(|at| Some(row(at).1)).collect(),
        own: (0..120).map(|at| Some(own(row(at).0))).collect(),
    }
}

/// Ten people in three cars.
fn ten() -> Made {
    let own = [-9.0, -6.5, -1.9, -1.7, -3.4, 0.9, 1.7, 4.7, 3.8, 8.4];
    let liking = [
        [4.0, 5.4, 3.1],
        [1.5, 3.2, 2.6],
        [3.4, 4.4, 3.8],
        [3.7, 5.3, 1.9],
        [2.8, 5.4, 3.6],
        [3.0, 5.2, 5.0],
        [3.2, 5.3, 4.5],
        [3.3, 6.0, 3.6],
        [3.2, 5.2, 4.4],
        [2.7, 4.2, 4.1],
    ];
    Made {
        subjects: (0..30).map(|at| (at / 3).to_string()).collect(),
        liking: liking.as_flattened().iter().copied().map(Some).collect(),
        moved: (0..30).map(|at| Some(f64::from(at % 3) * 15.0 - 15.0)).collect(),
        own: (0..30).map(|at| Some(own[at / 3])).collect(),
    }
}

fn near(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance * expected.abs(), "{value}, expected {expected}");
}

fn is_within(test: &RatioTest) -> bool {
    test.p_lower.unwrap().max(test.p_upper.unwrap()) < LEVEL
}

/// Slopes and curvatures of each person: their means and variances in NumPy 2.4, Satterthwaite's formula and roots by SciPy's `brentq`.
#[test]
fn a_complete_table_gives_the_numbers_of_its_strata() {
    let result = ten().test().unwrap();
    let is = |test: &RatioTest, expected: [f64; 5]| {
        let Some(Region::Between { low, high }) = test.region else { panic!("{:?}", test.region) };
        let numbers =
            [test.estimate.unwrap(), test.p_lower.unwrap(), test.p_upper.unwrap(), low, high];
        for (number, expected) in numbers.into_iter().zip(expected) {
            near(number, expected, 2e-5);
        }
    };
    is(
        &result.turn,
        [
            1.367_924_528_301_9,
            8.181_500_393_6e-6,
            1.572_357_279_3e-3,
            -0.150_047_544_49,
            2.984_255_899_51,
        ],
    );
    is(
        &result.movement,
        [
            2.381_909_337_196,
            1.170_817_762_7e-3,
            9.214_564_143_9e-2,
            -0.820_788_873_9,
            5.752_110_180_4,
        ],
    );
    assert_eq!(result.bend, Bend::Top);
    near(result.own_mean, -0.3, 1e-12);
    near(result.own_sd, 5.283_096_734_975_7, 1e-12);
    for (name, df) in [("moved", 8.0), ("moved^2", 9.0), ("moved:own", 8.0)] {
        near(result.coef.get(name).unwrap().df.unwrap(), df, 1e-4);
    }
}

/// statsmodels 0.15.0, `MixedLM(y, X, groups, exog_re).fit(reml=True)`; standard errors are those of (XᵀV⁻¹X)⁻¹ at its variances by NumPy,
/// since statsmodels takes them from the Hessian of all parameters.
#[test]
fn a_table_with_gaps_gives_the_coefficients_and_surface_of_statsmodels() {
    let mut ten = ten();
    for row in [2, 10, 22] {
        ten.liking[row] = None;
    }
    let result = ten.test().unwrap();
    assert_eq!((result.n_obs, result.n_subjects, result.missing), (27, 10, 3));
    for (name, estimate, se) in [
        ("(Intercept)", 4.772_989_420_5, 0.321_384_539_8),
        ("moved", 0.022_828_439_016, 0.011_633_683_735),
        ("own", 0.022_424_600_345, 0.045_220_523_565),
        ("moved^2", -0.005_814_616_086, 0.000_760_483_637),
        ("moved:own", 0.002_204_616_344, 0.002_449_421_952),
        ("own^2", -0.001_803_554_517, 0.007_831_730_243),
        ("b1", -0.000_403_838_671, 0.046_996_369_268),
        ("b3", -0.009_822_786_946, 0.008_421_373_704),
        ("b4", 0.013_833_848_516, 0.003_022_485_606),
        ("a3", -0.023_232_277_687, 0.051_411_155_325),
        ("a4", -0.029_471_251_548, 0.010_218_978_586),
    ] {
        let effect = result.coef.get(name).or_else(|| result.surface.get(name));
        let effect = effect.unwrap();
        assert!((effect.estimate - estimate).abs() < 2e-4 * se, "{name}");
        near(effect.se.unwrap(), se, 1e-4);
    }
    near(result.slope_sd, 0.031_158_097_8, 1e-3);
    near(result.residual_sd, 0.379_742_021_4, 1e-3);
    assert!(!result.singular);
}

#[test]
fn a_top_near_ones_own_is_within_the_bounds_and_one_far_from_it_is_not() {
    for (top, within) in [(0.0, true), (-2.0, true), (12.0, false), (-12.0, false)] {
        let turn = made(top, 0.0, 0.01).test().unwrap().turn;
        assert_eq!(is_within(&turn), within, "{top}: {turn:?}");
        assert!((turn.estimate.unwrap() - top).abs() < 1.5, "{top}: {turn:?}");
    }
    // Beyond the upper bound the slope at the bound is positive, and its opposite is excluded.
    let beyond = made(12.0, 0.0, 0.01).test().unwrap().turn;
    assert!(beyond.p_upper.unwrap() > 1.0 - LEVEL && beyond.p_lower.unwrap() < LEVEL);
}

#[test]
fn a_top_that_goes_with_ones_own_moves_and_one_that_does_not_stays() {
    for (drift, stays) in [(0.0, true), (2.0, false), (-2.0, false)] {
        let result = made(0.0, drift, 0.01).test().unwrap();
        let movement = &result.movement;
        assert_eq!(is_within(movement), stays, "{drift}: {movement:?}");
        let planted = 2.0 * drift * result.own_sd;
        assert!((movement.estimate.unwrap() - planted).abs() < 2.0, "{drift}: {movement:?}");
        assert!(is_within(&result.turn), "{drift}");
    }
}

#[test]
fn what_is_liked_least_at_ones_own_is_no_top() {
    let result = made(0.0, 0.0, -0.01).test().unwrap();
    assert_eq!(result.bend, Bend::Bottom);
    assert!(result.turn.p_lower.unwrap() > 1.0 - LEVEL);
    assert!(matches!(result.turn.region, Some(Region::Between { .. })));
}

#[test]
fn the_region_lies_within_the_bounds_where_both_tests_are_below_their_level() {
    let mut both = [false; 2];
    for step in 0..40 {
        let turn = made(f64::from(step) * 0.2, 0.0, 0.003).test().unwrap().turn;
        let Some(Region::Between { low, high }) = turn.region else { panic!("{turn:?}") };
        let within = is_within(&turn);
        assert_eq!(low > -5.0 && high < 5.0, within, "{turn:?}");
        both[usize::from(within)] = true;
    }
    assert_eq!(both, [true; 2]);
}

#[test]
fn without_a_sure_curvature_the_region_has_no_end_and_says_so() {
    let mut flat = made(0.0, 0.0, 0.0);
    // What half of the people like is what the others do not.
    for (at, liking) in flat.liking.iter_mut().enumerate() {
        let side = if at / 5 % 2 == 0 { 1.0 } else { -1.0 };
        let pattern = [1.0, -1.0, 0.5, -0.5, 0.3][at % 5];
        *liking = Some(side * pattern + 0.1 * drawn(300 + at));
    }
    let turn = flat.test().unwrap().turn;
    assert_eq!(turn.region, Some(Region::Everywhere));
    assert!(!is_within(&turn));
    // A line upwards: the top, if there is one, is far away on either side.
    for (liking, moved) in flat.liking.iter_mut().zip(&flat.moved) {
        *liking = Some(liking.unwrap() + 0.2 * moved.unwrap());
    }
    let turn = flat.test().unwrap().turn;
    let Some(Region::Outside { low, high }) = turn.region else { panic!("{turn:?}") };
    assert!(low < -15.0 && high > 15.0, "{turn:?}");
    assert!(turn.p_lower.unwrap() < LEVEL && turn.p_upper.unwrap() > 1.0 - LEVEL);
}

#[test]
fn another_middle_of_the_scale_or_of_the_liking_changes_no_test() {
    let plain = made(3.0, 0.4, 0.004);
    let mut moved = made(3.0, 0.4, 0.004);
    for (own, liking) in moved.own.iter_mut().zip(&mut moved.liking) {
        (*own, *liking) = (own.map(|o| o + 30.0), liking.map(|l| l + 1000.0));
    }
    let (plain, moved) = (plain.test().unwrap(), moved.test().unwrap());
    for (a, b) in [(&plain.turn, &moved.turn), (&plain.movement, &moved.movement)] {
        near(a.estimate.unwrap(), b.estimate.unwrap(), 1e-5);
        near(a.p_lower.unwrap(), b.p_lower.unwrap(), 1e-4);
        near(a.p_upper.unwrap(), b.p_upper.unwrap(), 1e-4);
    }
    let slope = |fit: &Congruence| fit.coef.get("moved").unwrap().estimate;
    assert!((slope(&plain) - slope(&moved)).abs() > 0.01);
}

#[test]
fn a_period_beside_takes_its_effect_out() {
    let periods: Vec<Option<String>> =
        (0..120).map(|at| Some(((at % 5 + at / 5) % 5).to_string())).collect();
    let mut tired = made(2.0, 0.0, 0.01);
    for (liking, period) in tired.liking.iter_mut().zip(&periods) {
        let later: f64 = period.as_ref().unwrap().parse().unwrap();
        *liking = Some(liking.unwrap() - 2.0 * later);
    }
    let with = tired.beside(&[("period", Predictor::Factor(&periods))]).unwrap();
    let without = tired.test().unwrap();
    assert!((with.coef.get("period[4]").unwrap().estimate + 8.0).abs() < 0.5);
    assert!(with.residual_sd < 0.2 * without.residual_sd);
}

#[test]
fn what_cannot_be_fitted_is_refused_by_name() {
    let refused = |made: &Made| made.test().unwrap_err().to_string();
    let mut few = made(0.0, 0.0, 0.01);
    few.liking.iter_mut().skip(15).for_each(|liking| *liking = None);
    assert!(refused(&few).contains("3 complete subjects"), "{}", refused(&few));
    let mut two = made(0.0, 0.0, 0.01);
    two.moved = two.moved.iter().map(|m| m.map(|m| f64::from(m > 0.0) * 15.0 + m * 1e-6)).collect();
    assert!(refused(&two).contains("3 different distances"), "{}", refused(&two));
    let mut alike = made(0.0, 0.0, 0.01);
    alike.own.fill(Some(3.0));
    assert!(refused(&alike).contains("`own` is determined"), "{}", refused(&alike));
    let mut once = made(0.0, 0.0, 0.01);
    once.subjects = (0..120).map(|at| at.to_string()).collect();
    assert!(refused(&once).contains("at least 121"), "{}", refused(&once));
    let mut infinite = made(0.0, 0.0, 0.01);
    infinite.moved[3] = Some(f64::INFINITY);
    assert!(refused(&infinite).contains("`moved`, row 4"), "{}", refused(&infinite));
    let fine = made(0.0, 0.0, 0.01);
    let twice = fine.beside(&[("own", Predictor::Covariate(&fine.own))]);
    assert!(matches!(twice, Err(StatsError::DoubleName { .. })));
}
