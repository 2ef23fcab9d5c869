//! A habit of synthetic people is declared once: what a person has, and the law by which a population has it, follow.

use crate::{
    error::SimulatorError,
    scenario::setting::{Range, check},
};

/// Declares a kind of people, `$person` drawn from `$population` by a `Draw`, a line a habit:
/// `key = default law, range, how("stream");`, where `how` is the method of `Draw` and the stream its source of chance.
///
/// Everybody has a speed that they would like to drive. What is alike in all follows; it has no law.
macro_rules! people {
    (
        $(#[$person_meta:meta])* pub struct $person:ident;
        $(#[$population_meta:meta])* pub struct $population:ident of $law:ident;
        desired_speed $(= $speed:expr)?;
        habits {
            $( $(#[doc = $doc:expr])* $habit:ident $(= $default:expr)?, $range:expr, $how:ident($stream:literal); )*
        }
        everybody {
            $( $(#[doc = $alike_doc:expr])* $alike:ident: $alike_type:ty $(= $alike_default:expr)? $(, $alike_range:expr)?; )*
        }
    ) => {
        $crate::scenario::setting::settings! {
            $(#[$person_meta])*
            pub struct $person {
                /// Speed wanted on free road.
                desired_speed_mps: f64, 7.0..=65.0;
                $( $(#[doc = $doc])* $habit: f64, $range; )*
                $( $(#[doc = $alike_doc])* $alike: $alike_type $(, $alike_range)?; )*
            }
        }

        $crate::scenario::setting::settings! {
            $(#[$population_meta])*
            pub struct $population {
                /// Speed wanted on free road.
                desired_speed_mph: $law $(= $speed)?, 20.0..=120.0;
                $( $(#[doc = $doc])* #[doc = concat!(" The law is ", stringify!($how), ".")] $habit: $law $(= $default)?, $range; )*
                $( $(#[doc = $alike_doc])* $alike: $alike_type $(= $alike_default)? $(, $alike_range)?; )*
            }
        }

        impl $person {
            /// Speed wanted on free road on this day.
            pub fn desired_speed(&self) -> maveric_domain::MetresPerSecond {
                maveric_domain::MetresPerSecond(self.desired_speed_mps)
            }
        }

        impl $population {
            fn person(&self, draw: &Draw) -> $person {
                $person {
                    desired_speed_mps: draw.desired_speed_mps(&self.desired_speed_mph),
                    $( $habit: draw.$how($stream, &self.$habit), )*
                    $( $alike: self.$alike, )*
                }
            }
        }
    };
}

pub(super) use people;

/// Latents beyond this are taken as this, so that no parameter leaves the finite numbers.
const LATENT_LIMIT: f64 = 10.0;

/// A latent as a law reads it: within the limit, and 0 if it is not a number.
pub(super) fn latent(value: f64) -> f64 {
    if value.is_nan() { 0.0 } else { value.clamp(-LATENT_LIMIT, LATENT_LIMIT) }
}

/// Refuses bounds of the law `name` outside `range`, or the wrong way round.
pub(super) fn check_bounds(
    name: &str,
    [lowest, highest]: [f64; 2],
    range: Range,
) -> Result<(), SimulatorError> {
    check(&format!("{name}.lowest"), lowest, range)?;
    check(&format!("{name}.highest"), highest, range)?;
    let above = Range::Because(lowest, f64::MAX, "`lowest` or above");
    check(&format!("{name}.highest"), highest, above)
}
