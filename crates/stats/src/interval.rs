//! Both ends of an interval, and the names under which results write them.

use serde::{Deserialize, Serialize};

/// Both ends of an interval of an estimate, in its unit; an end that does not exist has its reason beside it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Lower end.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

impl Interval {
    /// From `middle` less to `middle` more half its width.
    pub(crate) fn around(middle: f64, half: Option<f64>) -> Self {
        half.map(|half| (middle - half, middle + half)).into()
    }

    /// Both ends, where both exist.
    pub fn ends(self) -> Option<(f64, f64)> {
        self.low.zip(self.high)
    }

    /// The interval where it holds this estimate; else none, as a sentence prints it.
    #[must_use]
    pub fn holding(self, estimate: Option<f64>) -> Self {
        let holds = |(low, high): (f64, f64)| estimate.is_some_and(|e| (low..=high).contains(&e));
        if self.ends().is_some_and(holds) { self } else { Self::default() }
    }

    /// That of the estimate with its sign turned.
    #[must_use]
    pub fn negated(self) -> Self {
        Self { low: self.high.map(|end| -end), high: self.low.map(|end| -end) }
    }

    /// Each end by a function that grows.
    pub(crate) fn map(self, rising: impl Fn(f64) -> f64) -> Self {
        Self { low: self.low.map(&rising), high: self.high.map(&rising) }
    }
}

impl From<Option<(f64, f64)>> for Interval {
    fn from(ends: Option<(f64, f64)>) -> Self {
        let (low, high) = ends.unzip();
        Self { low, high }
    }
}

impl From<(f64, f64)> for Interval {
    fn from(ends: (f64, f64)) -> Self {
        Some(ends).into()
    }
}

/// Ends beside the other numbers of a result, as `dz_ci_low` and `dz_ci_high`: for `#[serde(flatten, with = …)]`.
macro_rules! written_as {
    ($($name:ident: $low:literal, $high:literal;)*) => {$(
        #[doc = concat!("As `", $low, "` and `", $high, "`.")]
        pub mod $name {
            use serde::{Deserialize, Deserializer, Serialize, Serializer};

            use super::Interval;

            #[derive(Serialize, Deserialize)]
            struct Ends {
                #[serde(rename = $low)]
                low: Option<f64>,
                #[serde(rename = $high)]
                high: Option<f64>,
            }

            /// Writes both keys.
            ///
            /// # Errors
            /// As the serializer.
            pub fn serialize<S: Serializer>(ci: &Interval, to: S) -> Result<S::Ok, S::Error> {
                let Interval { low, high } = *ci;
                Ends { low, high }.serialize(to)
            }

            /// Reads both keys; one that is missing is `None`.
            ///
            /// # Errors
            /// As the deserializer.
            pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Interval, D::Error> {
                Ends::deserialize(from).map(|Ends { low, high }| Interval { low, high })
            }
        }
    )*};
}

written_as! {
    ci: "ci_low", "ci_high";
    ci90: "ci90_low", "ci90_high";
    ci_bw: "ci_bw_low", "ci_bw_high";
    d_av_ci: "d_av_ci_low", "d_av_ci_high";
    d_ci: "d_ci_low", "d_ci_high";
    difference_ci: "difference_ci_low", "difference_ci_high";
    dz_ci: "dz_ci_low", "dz_ci_high";
    eta2_ci90: "eta2_ci90_low", "eta2_ci90_high";
    eta2_generalized_ci90: "eta2_generalized_ci90_low", "eta2_generalized_ci90_high";
    eta2_partial_ci90: "eta2_partial_ci90_low", "eta2_partial_ci90_high";
    eta2_partial_ci90_mbess: "eta2_partial_ci90_mbess_low", "eta2_partial_ci90_mbess_high";
    g_ci: "g_ci_low", "g_ci_high";
    gz_ci: "gz_ci_low", "gz_ci_high";
    kendall_w_ci90: "kendall_w_ci90_low", "kendall_w_ci90_high";
    odds_ratio_ci: "odds_ratio_ci_low", "odds_ratio_ci_high";
    omega2_partial_ci90: "omega2_partial_ci90_low", "omega2_partial_ci90_high";
    rank_biserial_ci: "rank_biserial_ci_low", "rank_biserial_ci_high";
    sem: "sem_low", "sem_high";
    within_ci: "within_ci_low", "within_ci_high";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Difference {
        dz: f64,
        #[serde(flatten, with = "dz_ci")]
        dz_ci: Interval,
        #[serde(flatten, with = "ci")]
        ci: Interval,
    }

    #[test]
    fn ends_stand_beside_the_other_numbers_and_are_read_back() {
        let difference = Difference {
            dz: 0.5,
            dz_ci: Interval::around(0.5, Some(0.25)),
            ci: Interval { low: Some(-1.0), high: None },
        };
        let text = serde_json::to_string(&difference).unwrap();
        assert_eq!(
            text,
            r#"{"dz":0.5,"dz_ci_low":0.25,"dz_ci_high":0.75,"ci_low":-1.0,"ci_high":null}"#
        );
        assert_eq!(serde_json::from_str::<Difference>(&text).unwrap(), difference);
    }

    #[test]
    fn a_turned_sign_turns_the_ends_and_one_end_alone_is_no_interval() {
        let open = Interval { low: Some(-1.0), high: None };
        assert_eq!(open.ends(), None);
        assert_eq!(open.negated().high, Some(1.0));
        assert_eq!(open.negated().low, None);
        let closed = Interval::from((1.0, 2.0));
        assert_eq!(closed.negated().ends(), Some((-2.0, -1.0)));
        assert_eq!(closed.map(|end| end / 2.0).ends(), Some((0.5, 1.0)));
        assert_eq!(Interval::around(1.0, None), Interval::default());
    }
}
