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
    let (one, all) = (T::of(1.0), all.as_flattened_mut());
    let quarter = all.len() / 4;
    let (fours, rest) = all.split_at_mut(4 * quarter);
    let (front, back) = fours.split_at_mut(2 * quarter);
    let (front, back) = (front.split_at_mut(quarter), back.split_at_mut(quarter));
    for ((a, b), (c, d)) in front
        .0
        .iter_mut()
        .zip(front.1)
        .zip(back.0.iter_mut().zip(back.1))
    {
        // One division for four numbers: it takes as long as a dozen products.
        let [under_a, under_b, under_c, under_d] = [*a, *b, *c, *d].map(|x| one + x.abs());
        let (ab, cd) = (under_a * under_b, under_c * under_d);
        let over = one / (ab * cd);
        let (over_ab, over_cd) = (over * cd, over * ab);
        (*a, *b) = (*a * (over_ab * under_b), *b * (over_ab * under_a));
        (*c, *d) = (*c * (over_cd * under_d), *d * (over_cd * under_c));
    }
    for x in rest {
        *x = *x / (one + x.abs());
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
