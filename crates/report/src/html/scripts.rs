//! The page's own scripts, and the policy that lets these run and no other.

use base64::{Engine as _, engine::general_purpose::STANDARD};
use sha2::{Digest, Sha256};

/// Turns the embedding space.
pub(crate) const SPACE: &str = include_str!("scripts/space.js");
/// Sorts tables.
pub(crate) const TABLES: &str = include_str!("scripts/tables.js");
/// Puts the panels of a figure one below the other on a narrow screen.
pub(crate) const PANELS: &str = include_str!("scripts/panels.js");
/// Filters the ledger.
pub(crate) const LEDGER: &str = include_str!("scripts/ledger.js");

/// A script as it stands on the page: without empty lines, so that nothing between here and there changes it.
pub(crate) fn packed(script: &str) -> String {
    let lines = script.lines().filter(|line| !line.trim().is_empty());
    lines.collect::<Vec<_>>().join("\n")
}

/// The content security policy of a page with these scripts: nothing comes from outside, and of scripts only these run,
/// known by their SHA-256. A script that came in with somebody's data would not be one of them.
pub(crate) fn policy(scripts: &[String]) -> String {
    let hash = |script: &String| {
        format!(" 'sha256-{}'", STANDARD.encode(Sha256::digest(script.as_bytes())))
    };
    let allowed =
        if scripts.is_empty() { " 'none'".to_owned() } else { scripts.iter().map(hash).collect() };
    format!(
        "default-src 'none'; img-src data:; font-src data:; style-src 'unsafe-inline'; script-src{allowed}; \
         base-uri 'none'; form-action 'none'"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_policy_names_each_script_by_its_hash() {
        // From the content security policy's specification, level 2, section 7.17.2 (its example): 'alert(...)'.
        assert!(
            policy(&["alert('Hello, world.');".to_owned()])
                .contains("script-src 'sha256-qznLcsROx4GACP2dm0UCKCzCG+HiZ1guq6ZZDob/Tng='")
        );
        assert!(policy(&[]).contains("script-src 'none'"));
    }

    #[test]
    fn no_script_holds_the_end_of_a_script_or_puts_text_in_as_html() {
        for script in [SPACE, TABLES, PANELS, LEDGER] {
            let low = script.to_lowercase();
            for word in [
                "</script",
                "<!--",
                "innerhtml",
                "outerhtml",
                "insertadjacenthtml",
                "eval(",
                "fetch(",
                "http",
            ] {
                assert!(!low.contains(word), "{word}");
            }
        }
    }
}
