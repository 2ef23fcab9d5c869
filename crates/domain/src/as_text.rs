//! Values that files keep as their text.

/// Reads and writes a value by its `FromStr` and its `Display`, for `#[serde(try_from = "String", into = "String")]`.
macro_rules! as_text {
    ($kept:ty) => {
        impl TryFrom<String> for $kept {
            type Error = <$kept as std::str::FromStr>::Err;
            fn try_from(text: String) -> Result<Self, Self::Error> {
                text.parse()
            }
        }

        impl From<$kept> for String {
            fn from(kept: $kept) -> Self {
                kept.to_string()
            }
        }
    };
}
pub(crate) use as_text;
