//! What moves on the page. Each stands below a figure that says the same on paper and without scripts.

use super::player::WatchPlayer;
use super::space::StyleSpace;
use crate::error::ReportError;

/// A part of the page that a script brings to life.
#[derive(Debug, Clone, PartialEq)]
pub struct Live {
    /// Name of the figure below which it stands.
    pub below: String,
    /// What it is.
    pub content: LiveContent,
}

/// What can move.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum LiveContent {
    /// The embedding space in three dimensions.
    StyleSpace(StyleSpace),
    /// Drives from above, side by side.
    Player(WatchPlayer),
}

impl Live {
    /// Refuses a number that is not finite, or nothing to show.
    pub(crate) fn check(&self) -> Result<(), ReportError> {
        let checked = match &self.content {
            LiveContent::StyleSpace(space) => space.check(),
            // The player checks its drives itself, when it is made.
            LiveContent::Player(_) => Ok(()),
        };
        checked.map_err(|reason| ReportError::Live { below: self.below.clone(), reason })
    }
}

/// JSON for a `script` element of type `application/json`: no text in it can end the element.
pub(crate) fn embedded(json: &serde_json::Value) -> String {
    json.to_string().replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_in_a_name_ends_the_script() {
        let nasty = serde_json::json!({ "name": "</script><script>alert(1)</script>&<!--" });
        let out = embedded(&nasty);
        assert!(!out.contains('<') && !out.contains('>') && !out.contains('&'));
        assert_eq!(serde_json::from_str::<serde_json::Value>(&out).unwrap(), nasty);
    }
}
