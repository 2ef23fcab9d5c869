//! What questionnaires ask and how they are scored; its words are `texts/codebook.md`.

use crate::texts::{document, value};
use maveric_domain::Scale;
use maveric_report::ReportError;
use minijinja::{Value, context};

/// Markdown, a heading a scale.
///
/// # Errors
/// [`ReportError::Template`] for a text that asks for a value which is not given.
pub fn codebook(scales: &[Scale]) -> Result<String, ReportError> {
    let described = scales.iter().map(described);
    let values = context! { scales => described.collect::<Vec<Value>>() };
    document("codebook.md", include_str!("../texts/codebook.md"), values)
}

/// A scale with what follows from its items.
fn described(scale: &Scale) -> Value {
    let subscales = scale.subscales.iter().map(|subscale| {
        let items = subscale.items.iter().copied();
        let reversed: Vec<u32> = items.filter(|i| scale.is_reversed(subscale, *i)).collect();
        let (low, high) = scale.score_range(subscale);
        context! { reversed, low, high, ..value(subscale) }
    });
    context! {
        first => scale.column_of(1),
        last => scale.column_of(scale.items),
        subscales => subscales.collect::<Vec<Value>>(),
        ..value(scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wording_is_text_and_neither_mark_up_nor_a_cell_of_its_own() {
        let scale = "id = \"calm\"\ntitle = \"Calm <b>\"\nreference = \"Nobody | never\"\nitems = 1\nmin = 1\nmax = 5\nscoring = \"mean\"\n\
                     wording = [\"a | <script>b</script> & c\\u001b[2J\"]\n[[subscales]]\nid = \"calm\"\ntitle = \"Calm\"\nitems = [1]\n";
        let text = codebook(&[toml::from_str(scale).unwrap()]).unwrap();
        assert!(
            text.contains("| 1 | a \\| &lt;script&gt;b&lt;/script&gt; &amp; c[2J |"),
            "{text}"
        );
        assert!(
            text.contains("## Calm &lt;b&gt; (`calm`)") && text.contains("Nobody \\| never"),
            "{text}"
        );
    }
}
