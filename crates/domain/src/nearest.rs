//! The word that was probably meant.

/// How alike two words are of which one was probably meant, from 0 to 1.
const ALIKE: f64 = 0.8;

/// The one of some words that is most like `found`, whatever their capitals, if one is alike at all.
///
/// # Example
/// ```
/// use maveric_domain::nearest;
/// assert_eq!(nearest("Layuot", ["units", "layout"]), Some("layout"));
/// assert_eq!(nearest("speed", ["lane"]), None);
/// ```
pub fn nearest<'a>(given: &str, possible: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let given = given.to_lowercase();
    possible
        .into_iter()
        .map(|word| (strsim::jaro_winkler(&given, &word.to_lowercase()), word))
        .filter(|(alike, _)| *alike >= ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, word)| word)
}
