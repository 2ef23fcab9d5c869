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

/// x/(1 + |x|): unlike tanh the same few instructions on every machine, and so the same bytes.
#[inline(always)]
pub(super) fn softsign<T: Real, const N: usize>(x: &Lanes<T, N>) -> Lanes<T, N> {
    lanes(x, x, |x, _| x / (T::of(1.0) + x.abs()))
}

/// The derivative by what went into [`softsign`], from that by `y`, what came out.
#[inline(always)]
pub(super) fn through_softsign<T: Real, const N: usize>(d: &mut Lanes<T, N>, y: &Lanes<T, N>) {
    *d = lanes(d, y, |d, y| {
        let rest = T::of(1.0) - y.abs();
        d * (rest * rest)
    });
}
