//! How near a drive comes to the participant's own one.

/// AV minus own, in the measure's unit; `None` where either has no value.
///
/// # Source
/// Method section 9, analysis 3.
pub fn difference_from_own(av: Option<f64>, own: Option<f64>) -> Option<f64> {
    Some(av? - own?).filter(|d| d.is_finite())
}

/// Accuracy of the car as one driver: 1 − |AV − driver| / |driver|.
///
/// 1 is a perfect copy; a drive off by more than the driver's own value is below 0, and stays so.
/// `None` where either has no value, or the driver's own is zero (no lane change at all): a share of nothing.
///
/// # Source
/// Method section 9, analysis 2. The paper gives percentages without a formula.
///
/// # Example
/// ```
/// # use maveric_measures::drive_accuracy;
/// assert_eq!(drive_accuracy(Some(33.0), Some(30.0)), Some(0.9));
/// assert_eq!(drive_accuracy(Some(1.0), Some(0.0)), None);
/// ```
pub fn drive_accuracy(av: Option<f64>, own: Option<f64>) -> Option<f64> {
    let (av, own) = (av?, own?);
    Some(1.0 - (av - own).abs() / own.abs()).filter(|a| own != 0.0 && a.is_finite())
}

/// Accuracy of one measure over drivers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// Mean over drivers; `None` if no driver has a value.
    pub mean: Option<f64>,
    /// Standard deviation over drivers (n − 1); `None` below two.
    pub sd: Option<f64>,
    /// Drivers in the mean.
    pub n: usize,
    /// Drivers left out because their own drive has no value.
    pub own_missing: usize,
    /// Drivers left out because the AV's drive has no value.
    pub av_missing: usize,
    /// Drivers left out because their own value is zero.
    pub own_zero: usize,
}

impl Accuracy {
    /// Drivers left out, for whatever reason.
    pub fn dropped(&self) -> usize {
        self.own_missing + self.av_missing + self.own_zero
    }
}

/// Mean of [`drive_accuracy`] over drivers; `pairs` holds (AV, own) for each, shape `(n,)`.
pub fn mean_accuracy(pairs: &[(Option<f64>, Option<f64>)]) -> Accuracy {
    let values: Vec<f64> = pairs.iter().filter_map(|&(av, own)| drive_accuracy(av, own)).collect();
    let n = values.len();
    let own_missing = pairs.iter().filter(|(_, own)| own.is_none()).count();
    let av_missing = pairs.iter().filter(|(av, own)| av.is_none() && own.is_some()).count();
    let mean = (n > 0).then(|| values.iter().sum::<f64>() / n as f64);
    let sd = mean.filter(|_| n > 1).map(|m| {
        let squares: f64 = values.iter().map(|v| (v - m).powi(2)).sum();
        (squares / (n - 1) as f64).sqrt()
    });
    Accuracy {
        mean,
        sd,
        n,
        own_missing,
        av_missing,
        own_zero: pairs.len() - n - own_missing - av_missing,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn drivers_without_a_value_are_dropped_and_counted() {
        let found = mean_accuracy(&[
            (Some(9.0), Some(10.0)),
            (Some(12.0), Some(10.0)),
            (None, Some(10.0)),
            (Some(5.0), None),
            (None, None),
            (Some(2.0), Some(0.0)),
        ]);
        assert!((found.mean.unwrap() - 0.85).abs() < 1e-12);
        assert_eq!((found.n, found.dropped()), (2, 4));
        assert_eq!((found.own_missing, found.av_missing, found.own_zero), (2, 1, 1));
    }

    #[test]
    fn the_spread_of_two_drivers_is_known_and_that_of_one_is_not() {
        let (near, far) = ((Some(9.0), Some(10.0)), (Some(-6.0), Some(-10.0)));
        let (two, one) = (mean_accuracy(&[near, far]), mean_accuracy(&[far]));
        // 0.9 and 0.6.
        assert!((two.mean.unwrap() - 0.75).abs() < 1e-12);
        assert!((two.sd.unwrap() - 0.15 * 2_f64.sqrt()).abs() < 1e-12);
        assert!((one.mean.unwrap() - 0.6).abs() < 1e-12 && one.sd.is_none());
    }

    #[test]
    fn a_difference_is_the_cars_less_ones_own_and_needs_both() {
        assert_eq!(difference_from_own(Some(9.0), Some(6.0)), Some(3.0));
        assert_eq!(difference_from_own(Some(9.0), None), None);
        assert_eq!(difference_from_own(None, Some(6.0)), None);
        assert_eq!(difference_from_own(Some(f64::MAX), Some(f64::MIN)), None);
    }

    #[test]
    fn nobody_has_no_mean() {
        assert_eq!(mean_accuracy(&[]).mean, None);
        assert_eq!(mean_accuracy(&[(None, None)]).sd, None);
    }

    proptest! {
        #[test]
        fn accuracy_is_at_most_one_and_one_for_a_copy(av in -1e6..1e6_f64, own in 0.1..1e6_f64) {
            prop_assert!(drive_accuracy(Some(av), Some(own)).unwrap() <= 1.0);
            prop_assert!((drive_accuracy(Some(own), Some(own)).unwrap() - 1.0).abs() < 1e-12);
        }
    }
}
