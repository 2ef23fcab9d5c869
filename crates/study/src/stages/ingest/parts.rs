//! Drives that are left out for a condition that nobody knows, though they are the second half of one that is known.

use super::LeftOutDrive;
use maveric_analysis::Rule;
use maveric_domain::DriveMeta;

/// Says of drives that are left out which of the others they may be a part of, and what to write.
pub(super) fn maybe_parts<'a>(
    drives: &(impl Iterator<Item = &'a DriveMeta> + Clone),
    left_out: &[LeftOutDrive],
) -> Vec<(String, String)> {
    let unknown = left_out.iter().filter(|out| out.why.rule == Rule::UnknownCondition);
    let part = |out: &LeftOutDrive| {
        let condition = out.meta.condition.to_string();
        let known = drives.clone().filter(|d| d.participant == out.meta.participant);
        let ending = known
            .filter_map(|d| ending(&condition, &d.condition.to_string()))
            .min_by_key(String::len)?;
        let what = format!(
            "it may be a part of a recording that was split: then write `parts = \"{ending}\"` under [names] of the mapping, and it joins the drive before it"
        );
        Some((out.meta.drive.to_string(), what))
    };
    unknown.filter_map(part).collect()
}

/// How parts of a recording are called of which one is of a condition and another of one that is called like it, with a number behind;
/// none where it is not.
fn ending(condition: &str, known: &str) -> Option<String> {
    let numbered = condition.strip_prefix(known)?;
    let text = numbered.trim_end_matches(|c: char| c.is_ascii_digit());
    (!text.is_empty() && text.len() < numbered.len()).then(|| format!("{text}{{n}}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ending_is_a_text_and_a_number_behind_a_condition_that_is_known() {
        assert_eq!(ending("calm_2", "calm").as_deref(), Some("_{n}"));
        assert_eq!(ending("calm-part10", "calm").as_deref(), Some("-part{n}"));
        for condition in ["calm2", "calm", "calm_b", "sporty_2"] {
            assert_eq!(ending(condition, "calm"), None, "{condition}");
        }
    }
}
