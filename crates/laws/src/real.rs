//! In how many digits a law is reckoned.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number of single or of double precision, for laws that are driven in either: only operations that every machine does alike.
pub trait Real:
    Copy
    + PartialOrd
    + Default
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// The nearest to a number of double precision.
    fn of(number: f64) -> Self;
    /// The number in double precision.
    fn wide(self) -> f64;
    /// Without its sign.
    #[must_use]
    fn abs(self) -> Self;
    /// The square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// The greater of both; a number, where one of them is none.
    #[must_use]
    fn max(self, other: Self) -> Self;
}

macro_rules! real {
    ($($type:ty),*) => {$(
        impl Real for $type {
            #[inline]
            fn of(number: f64) -> Self {
                number as Self
            }
            #[inline]
            fn wide(self) -> f64 {
                self.into()
            }
            #[inline]
            fn abs(self) -> Self {
                self.abs()
            }
            #[inline]
            fn sqrt(self) -> Self {
                self.sqrt()
            }
            #[inline]
            fn max(self, other: Self) -> Self {
                self.max(other)
            }
        }
    )*};
}

real!(f32, f64);
