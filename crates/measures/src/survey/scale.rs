//! Questionnaires are data: one TOML file each.

use crate::error::MeasureError;
use maveric_domain::{DomainError, Scale};
use std::collections::BTreeSet;

/// Most items a questionnaire may have: a slip of the keyboard should not ask a million questions.
const MOST_ITEMS: u32 = 1000;

/// Reads a questionnaire definition and checks that it agrees with itself.
///
/// # Errors
/// [`MeasureError::ScaleToml`] naming line and key where the text is no definition;
/// [`MeasureError::BadScale`] naming the scale and the contradiction.
///
/// # Example
/// ```
/// let scale = maveric_measures::parse_scale(r#"
///     id = "calm"
///     title = "Calmness"
///     reference = "made up"
///     items = 2
///     min = 1
///     max = 7
///     scoring = "mean"
///     reversed = [2]
///     [[subscales]]
///     id = "calm"
///     title = "Calmness"
///     items = [1, 2]
/// "#)?;
/// assert!(scale.is_reversed(&scale.subscales[0], 2));
/// # Ok::<(), maveric_measures::MeasureError>(())
/// ```
pub fn parse_scale(text: &str) -> Result<Scale, MeasureError> {
    let scale: Scale = toml::from_str(text).map_err(|e| MeasureError::ScaleToml {
        problem: e.to_string().trim_end().to_owned(),
    })?;
    check(&scale)?;
    Ok(scale)
}

fn is_code_name(text: &str) -> bool {
    !text.is_empty()
        && text
            .bytes()
            .all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_')
}

/// What [`Scale::validate`] asks, and what a file can get wrong beyond it.
pub(super) fn check(scale: &Scale) -> Result<(), MeasureError> {
    scale.validate()?;
    let bad = |problem: String| {
        Err(MeasureError::BadScale(DomainError::BadScale {
            scale: scale.id.clone(),
            problem,
        }))
    };
    let ids = std::iter::once(&scale.id).chain(scale.subscales.iter().map(|s| &s.id));
    for id in ids {
        if !is_code_name(id) {
            return bad(format!(
                "id `{id}` must be lower-case letters, digits and `_`"
            ));
        }
    }
    if scale.items > MOST_ITEMS {
        return bad(format!(
            "{} items, expected at most {MOST_ITEMS}",
            scale.items
        ));
    }
    let mut seen = BTreeSet::new();
    for sub in &scale.subscales {
        if !seen.insert(&sub.id) {
            return bad(format!("subscale `{}` is defined twice", sub.id));
        }
        if let Some(item) = sub.reversed.iter().find(|i| !sub.items.contains(i)) {
            return bad(format!(
                "subscale `{}` reverses item {item}, which it does not have",
                sub.id
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILES: [(&str, &str); 8] = [
        ("adb", maveric_data::SCALES_ADB),
        ("mdsi", maveric_data::SCALES_MDSI),
        ("mini_ipip", maveric_data::SCALES_MINI_IPIP),
        ("jian_trust", maveric_data::SCALES_JIAN_TRUST),
        ("rosas", maveric_data::SCALES_ROSAS),
        (
            "godspeed_intelligence",
            maveric_data::SCALES_GODSPEED_INTELLIGENCE,
        ),
        ("similarity", maveric_data::SCALES_SIMILARITY),
        ("aggressiveness", maveric_data::SCALES_AGGRESSIVENESS),
    ];

    #[test]
    fn every_shipped_scale_is_valid_and_uses_all_its_items() {
        for (name, text) in FILES {
            let scale = parse_scale(text).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_eq!(scale.id, name);
            let used: BTreeSet<u32> = scale
                .subscales
                .iter()
                .flat_map(|s| s.items.clone())
                .collect();
            assert_eq!(used.len(), scale.items as usize, "{name}");
        }
    }

    #[test]
    fn the_big_five_have_four_items_each_and_their_wording() {
        let scale = parse_scale(FILES[2].1).unwrap();
        assert_eq!(scale.subscales.len(), 5);
        assert!(scale.subscales.iter().all(|s| s.items.len() == 4));
        assert_eq!(scale.wording.len(), 20);
        assert_eq!(scale.reversed.len(), 11);
    }

    #[test]
    fn adb_totals_go_from_11_to_55() {
        let scale = parse_scale(FILES[0].1).unwrap();
        let n = i32::try_from(scale.subscales[0].items.len()).unwrap();
        assert_eq!((n * scale.min, n * scale.max), (11, 55));
    }

    #[test]
    fn a_misspelt_key_is_named() {
        let error = parse_scale(&FILES[0].1.replace("scoring", "scorring")).unwrap_err();
        assert!(error.to_string().contains("scorring"), "{error}");
    }

    #[test]
    fn norms_that_cannot_be_are_refused_by_their_key() {
        let text = FILES[2].1;
        let with = |from: &str, to: &str| {
            assert!(text.contains(from), "{from}");
            parse_scale(&text.replacen(from, to, 1))
                .unwrap_err()
                .to_string()
        };
        let first = "norms = { mean = 3.3";
        for (to, said) in [
            (
                "norms = { mean = 5.3",
                "`extraversion`: norms.mean is 5.3, expected between 1 and 5",
            ),
            ("norms = { mean = nan", "norms.mean is NaN"),
        ] {
            let error = with(first, to);
            assert!(error.contains(said), "{error}");
        }
        let error = with(
            "of = [\"extraversion\", \"openness\"]",
            "of = [\"extraversion\", \"opennes\"]",
        );
        assert!(error.contains("there is no subscale `opennes`"), "{error}");
        let error = parse_scale(&format!("column = \"q\"\n{text}"))
            .unwrap_err()
            .to_string();
        assert!(error.contains("{item}"), "{error}");
    }

    #[test]
    fn contradictions_are_refused() {
        let swap = |from: &str, to: &str| {
            assert!(FILES[6].1.contains(from), "{from}");
            parse_scale(&FILES[6].1.replace(from, to)).unwrap_err()
        };
        for (from, to, said) in [
            ("reversed = [2, 4]", "reversed = [2, 9]", "reversed item 9"),
            ("min = 1", "min = 7", "not below max"),
            (
                "min = 1\nmax = 7",
                "min = 7\nmax = 1",
                "min 7 is not below max 1",
            ),
            ("items = 4", "items = 0", "at least one item"),
            ("items = [1, 2, 3, 4]", "items = []", "has no items"),
            (
                "items = [1, 2, 3, 4]",
                "items = [1, 2, 2, 4]",
                "item 2 twice",
            ),
            ("id = \"similarity\"", "id = \"Simil arity\"", "lower-case"),
        ] {
            let error = swap(from, to).to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
