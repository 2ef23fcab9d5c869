//! Numbers of several segments abreast.
#![allow(
    clippy::inline_always,
    reason = "code for one processor must be inlined into the function compiled for it"
)]

use maveric_laws::Real;

/// Segments simulated abreast.
pub(super) const LANES: usize = 16;
/// One number of each segment.
pub(super) type Lanes<T, const N: usize = LANES> = [T; N];

/// Zero in every lane.
#[inline(always)]
pub(super) fn nothing<T: Real, const N: usize>() -> Lanes<T, N> {
    [T::of(0.0); N]
}

/// What `combine` makes of two numbers, lane by lane. All is read before anything is written, so that lanes run abreast wherever they lie.
#[inline(always)]
pub(super) fn lanes<T: Real, const N: usize>(
    x: &Lanes<T, N>,
    y: &Lanes<T, N>,
    combine: impl Fn(T, T) -> T,
) -> Lanes<T, N> {
    let (x, y) = (*x, *y);
    std::array::from_fn(|l| combine(x[l], y[l]))
}

#[inline(always)]
pub(super) fn add<T: Real, const N: usize>(sum: &mut Lanes<T, N>, x: &Lanes<T, N>) {
    *sum = lanes(sum, x, |sum, x| sum + x);
}

#[inline(always)]
pub(super) fn add_scaled<T: Real, const N: usize>(
    sum: &mut Lanes<T, N>,
    weight: T,
    x: &Lanes<T, N>,
) {
    *sum = lanes(sum, x, |sum, x| sum + weight * x);
}

#[inline(always)]
pub(super) fn product<T: Real, const N: usize>(x: &Lanes<T, N>, y: &Lanes<T, N>) -> Lanes<T, N> {
    lanes(x, y, |x, y| x * y)
}

#[inline(always)]
pub(super) fn add_product<T: Real, const N: usize>(
    sum: &mut Lanes<T, N>,
    x: &Lanes<T, N>,
    y: &Lanes<T, N>,
) {
    add(sum, &product(x, y));
}

/// x/(1 + |x|) of every number: unlike tanh the same few instructions on every machine, and so the same bytes.
#[inline(always)]
pub(super) fn softsign<T: Real, const N: usize>(all: &mut [Lanes<T, N>]) {
    let one = T::of(1.0);
    let (fours, rest) = all.as_chunks_mut::<4>();
    for [a, b, c, d] in fours {
        for ((a, b), (c, d)) in a.iter_mut().zip(b).zip(c.iter_mut().zip(d)) {
            // One division for four numbers of a lane, which takes as long as a dozen products; they may be as large as 10⁹ each.
            let [under_a, under_b, under_c, under_d] = [*a, *b, *c, *d].map(|x| one + x.abs());
            let (ab, cd) = (under_a * under_b, under_c * under_d);
            let over = one / (ab * cd);
            let (over_ab, over_cd) = (over * cd, over * ab);
            (*a, *b) = (*a * (over_ab * under_b), *b * (over_ab * under_a));
            (*c, *d) = (*c * (over_cd * under_d), *d * (over_cd * under_c));
        }
    }
    for x in rest {
        *x = lanes(x, x, |x, _| x / (one + x.abs()));
    }
}

/// The derivative by what went into [`softsign`], from that by `y`, what came out.
#[inline(always)]
pub(super) fn through_softsign<T: Real, const N: usize>(d: &mut Lanes<T, N>, y: &Lanes<T, N>) {
    *d = lanes(d, y, |d, y| {
        let rest = T::of(1.0) - y.abs();
        d * (rest * rest)
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close_to_the_fraction<const N: usize>() {
        let number = |i: usize| (i as f64 - 7.3) * [0.1, 1.0, 9.0, 80.0][i % 4];
        for units in 1..10 {
            let mut all: Vec<Lanes<f64, N>> = (0..units)
                .map(|unit| std::array::from_fn(|l| number(unit * N + l)))
                .collect();
            let before = all.clone();
            softsign(&mut all);
            for (x, y) in before.as_flattened().iter().zip(all.as_flattened()) {
                let expected = x / (1.0 + x.abs());
                assert!((y - expected).abs() < 1e-14, "{units} units: {x} {y}");
            }
        }
    }

    #[test]
    fn softsign_is_the_fraction_for_any_number_of_units() {
        close_to_the_fraction::<1>();
        close_to_the_fraction::<LANES>();
    }

    #[test]
    fn a_lane_without_a_number_leaves_the_others_theirs() {
        for units in 1..10 {
            let mut all = vec![[1.0_f32; LANES]; units];
            all[units / 2][3] = f32::NAN;
            softsign(&mut all);
            let others = all.iter().flat_map(|unit| unit.iter().enumerate());
            assert!(
                others
                    .filter(|(l, _)| *l != 3)
                    .all(|(_, y)| (y - 0.5).abs() < 1e-6)
            );
        }
    }
}
