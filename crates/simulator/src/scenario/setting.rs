//! A setting is declared once: its shape in the file, its default, its check with the error, and its row in `docs/simulator.md` follow.

use crate::error::SimulatorError;
use std::ops::RangeInclusive;

/// What a number may be.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Range {
    /// Any finite number.
    Finite,
    /// Finite and above 0.
    Positive,
    /// Finite and 0 or above.
    NotNegative,
    /// Between two numbers, both included.
    Within(f64, f64),
    /// The same where a number follows from something else, in words.
    Because(f64, f64, &'static str),
}

impl From<RangeInclusive<f64>> for Range {
    fn from(range: RangeInclusive<f64>) -> Self {
        Self::Within(*range.start(), *range.end())
    }
}

impl Range {
    /// The number of a lane, on a road of so many.
    pub(crate) fn lane_of(lanes: u8) -> Self {
        Self::Because(0.0, f64::from(lanes) - 1.0, "a lane of the road")
    }

    /// What is expected of the number that has the path `name`.
    pub(crate) fn words(self, name: &str) -> String {
        match self {
            Self::Finite => "a finite number".to_owned(),
            Self::Positive => "a finite number above 0".to_owned(),
            Self::NotNegative => "a finite number, 0 or above".to_owned(),
            Self::Within(low, high) => {
                format!("{low} to {high} {}", unit(name)).trim_end().to_owned()
            }
            Self::Because(_, _, words) => words.to_owned(),
        }
    }
}

/// The number of a lane; which there are, the road says.
pub(crate) const LANE: Range = Range::Because(0.0, 255.0, "a lane of the road");

/// Refuses `found`, which has the path `name` in the file, outside `range`.
pub(crate) fn check(name: &str, found: f64, range: impl Into<Range>) -> Result<(), SimulatorError> {
    let range = range.into();
    let fits = match range {
        Range::Finite => true,
        Range::Positive => found > 0.0,
        Range::NotNegative => found >= 0.0,
        Range::Within(low, high) | Range::Because(low, high, _) => (low..=high).contains(&found),
    };
    if fits && found.is_finite() {
        return Ok(());
    }
    Err(SimulatorError::Setting { name: name.to_owned(), found, expected: range.words(name) })
}

/// How the ends of names say a unit; the longer first.
const UNITS: [(&str, &str); 14] = [
    ("_per_km_and_lane", "vehicles per km and lane"),
    ("_rad_per_s", "rad/s"),
    ("_n_per_rad", "N/rad"),
    ("_kg_m2", "kg m²"),
    ("_per_s2", "per s²"),
    ("_per_s", "per s"),
    ("_mps3", "m/s³"),
    ("_mps2", "m/s²"),
    ("_mps", "m/s"),
    ("_mph", "mph"),
    ("_rad", "rad"),
    ("_kg", "kg"),
    ("_s", "s"),
    ("_m", "m"),
];

/// The unit of what has the path `name`: of the key itself, or of the key whose part it is.
pub(crate) fn unit(name: &str) -> &'static str {
    let unit_of = |key: &str| UNITS.iter().find(|(end, _)| key.ends_with(end));
    name.rsplit('.').find_map(unit_of).map_or("", |(_, unit)| unit)
}

/// One key of a section.
pub(crate) struct Field<'a> {
    pub(crate) key: &'static str,
    pub(crate) value: &'a dyn Value,
    pub(crate) range: Range,
    /// Its documentation.
    #[cfg(test)]
    pub(crate) doc: &'static str,
}

/// What a key of a scenario file holds.
pub(crate) trait Value {
    /// The keys below, of a section.
    fn fields(&self) -> Vec<Field<'_>> {
        Vec::new()
    }

    /// Refuses what has the path `name` outside `range`, and what is wrong below it.
    fn check(&self, name: &str, _range: Range) -> Result<(), SimulatorError> {
        let mut fields = self.fields();
        // A bound that follows from another number is worth something once that number is.
        fields.sort_by_key(|field| matches!(field.range, Range::Because(..)));
        fields.iter().try_for_each(|field| {
            let path = format!("{name}.{}", field.key);
            let path = path.trim_start_matches('.');
            field.value.check(path, field.range)
        })
    }

    /// The words that may stand here, of a choice.
    #[cfg(test)]
    fn choices(&self) -> &'static [&'static str] {
        &[]
    }
}

/// Refuses the first number of a section that is out of range; `name` is the section's path.
pub(crate) fn check_section(name: &str, section: &dyn Value) -> Result<(), SimulatorError> {
    section.check(name, Range::Finite)
}

impl Value for f64 {
    fn check(&self, name: &str, range: Range) -> Result<(), SimulatorError> {
        check(name, *self, range)
    }
}

impl Value for u8 {
    fn check(&self, name: &str, range: Range) -> Result<(), SimulatorError> {
        check(name, f64::from(*self), range)
    }
}

impl Value for usize {
    fn check(&self, name: &str, range: Range) -> Result<(), SimulatorError> {
        check(name, *self as f64, range)
    }
}

/// Least and most.
impl Value for [f64; 2] {
    fn check(&self, name: &str, range: Range) -> Result<(), SimulatorError> {
        let [least, most] = *self;
        check(name, least, range)?;
        check(name, most, range)?;
        check(name, most, Range::Because(least, f64::MAX, "the lower of the two first"))
    }
}

impl<T: Value> Value for Option<T> {
    fn check(&self, name: &str, range: Range) -> Result<(), SimulatorError> {
        self.iter().try_for_each(|value| value.check(name, range))
    }
}

impl<T: Value> Value for Vec<T> {
    fn check(&self, name: &str, range: Range) -> Result<(), SimulatorError> {
        let mut values = self.iter().enumerate();
        values.try_for_each(|(i, value)| value.check(&format!("{name}[{i}]"), range))
    }
}

/// Makes choices between words settings.
macro_rules! choices {
    ($($choice:ty),+) => {$(
        impl $crate::scenario::setting::Value for $choice {
            #[cfg(test)]
            fn choices(&self) -> &'static [&'static str] {
                $crate::scenario::setting::choices_of::<Self>()
            }
        }
    )+};
}

/// Declares a section of a scenario file, a line a key: `key: type = default, range;`.
///
/// The unit is the end of the key. Where every key has a default, any of them may be left out of a file; without defaults all must be
/// there. A range is two numbers or a [`Range`], and may name other keys of the section after `as`; a section or a choice has none.
macro_rules! settings {
    (
        $(#[$meta:meta])*
        pub struct $name:ident $(as $own:ident)? {
            $( $(#[doc = $doc:expr])* $(#[serde $serde:tt])* $key:ident: $type:ty = $default:expr $(, $range:expr)?; )*
        }
    ) => {
        $crate::scenario::setting::settings! {
            $(#[$meta])*
            #[serde(default)]
            pub struct $name $(as $own)? {
                $( $(#[doc = $doc])* $(#[serde $serde])* $key: $type $(, $range)?; )*
            }
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($key: $default),* }
            }
        }
    };
    (
        $(#[$meta:meta])*
        pub struct $name:ident $(as $own:ident)? {
            $( $(#[doc = $doc:expr])* $(#[serde $serde:tt])* $key:ident: $type:ty $(, $range:expr)?; )*
        }
    ) => {
        #[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        $(#[$meta])*
        pub struct $name {
            $( $(#[doc = $doc])* $(#[serde $serde])* pub $key: $type, )*
        }

        impl $crate::scenario::setting::Value for $name {
            fn fields(&self) -> Vec<$crate::scenario::setting::Field<'_>> {
                use $crate::scenario::setting::{Field, Range};
                $(let $own = self;)?
                vec![$(Field {
                    key: stringify!($key),
                    value: &self.$key,
                    // The first of one or two.
                    range: [$(Range::from($range),)? Range::Finite][0],
                    #[cfg(test)]
                    doc: concat!($($doc),*),
                }),*]
            }
        }
    };
}

pub(crate) use {choices, settings};

#[cfg(test)]
pub(crate) use choice::choices_of;

#[cfg(test)]
mod choice {
    use serde::de::{self, Deserialize, IntoDeserializer};
    use std::fmt;

    /// Refuses a word that no choice has, and keeps those it has.
    #[derive(Debug)]
    struct Choices(&'static [&'static str]);

    impl fmt::Display for Choices {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "{:?}", self.0)
        }
    }

    impl std::error::Error for Choices {}

    impl de::Error for Choices {
        fn custom<T: fmt::Display>(_: T) -> Self {
            Self(&[])
        }

        fn unknown_variant(_: &str, choices: &'static [&'static str]) -> Self {
            Self(choices)
        }
    }

    /// The words that a choice has in a file.
    pub(crate) fn choices_of<T: Deserialize<'static> + fmt::Debug>() -> &'static [&'static str] {
        let nobody: de::value::StrDeserializer<'static, Choices> = "?".into_deserializer();
        T::deserialize(nobody).unwrap_err().0
    }
}
