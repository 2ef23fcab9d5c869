//! What questionnaires ask and how they are scored; its words are `texts/codebook.md`.

use crate::texts::{document, value};
use maveric_domain::{
    Design, Scale,
    design::Sign,
    survey::{Item, ItemWords, Norms},
};
use maveric_report::ReportError;
use minijinja::{Value, context};
use path_slash::PathExt as _;

/// Markdown, a heading a scale; of a study with measures of its own these too.
///
/// # Errors
/// [`ReportError::Template`] for a text that asks for a value which is not given.
pub fn codebook(scales: &[Scale], design: Option<&Design>) -> Result<String, ReportError> {
    let described = scales.iter().map(described);
    let measures = design.into_iter().flat_map(Design::measures).map(|m| {
        let aggression = match m.aggression {
            Some(Sign::Plus) => "up",
            Some(Sign::Minus) => "down",
            None => "not known",
        };
        context! { id => m.id.as_str(), title => m.title.as_str(), unit => m.unit.as_str(), aggression }
    });
    let values = context! {
        scales => described.collect::<Vec<Value>>(),
        measures => measures.collect::<Vec<Value>>(),
        measured_in => design.map(|d| d.files().measures.to_slash_lossy().into_owned()),
    };
    document("codebook.md", include_str!("../texts/codebook.md"), values)
}

/// The answers that have words, each with its number.
pub fn named_answers(item: &Item, words: &ItemWords) -> String {
    let ends = [item.min, item.max];
    let answers: Vec<i32> = match words.anchors.len() {
        2 => ends.to_vec(),
        _ => item.answers().collect(),
    };
    let named = answers.iter().zip(&words.anchors);
    let named: Vec<String> = named.map(|(answer, word)| format!("{answer} {word}")).collect();
    named.join("; ")
}

/// What publications say of a subscale's scores: by what was chosen nobody's scores are to be judged.
fn published(norms: Option<&Norms>) -> Value {
    let scores = norms.filter(|n| n.is_published());
    let alpha = norms.filter(|n| n.is_alpha_published());
    let of_alpha = alpha.and_then(|n| n.alpha_source.as_ref());
    let of_alpha = of_alpha.map(|source| format!("alpha: {source}"));
    let of_scores = scores.map(|n| n.source.clone());
    let sources: Vec<String> = of_scores.into_iter().chain(of_alpha).collect();
    context! {
        mean => scores.map(|n| n.mean),
        sd => scores.map(|n| n.sd),
        alpha => alpha.map(|n| n.alpha),
        source => sources.join("; "),
    }
}

/// A scale with what follows from its items.
fn described(scale: &Scale) -> Value {
    let subscales = scale.subscales.iter().map(|subscale| {
        let items = scale.items_of(subscale);
        let reversed = items.iter().copied();
        let reversed = reversed.filter(|i| scale.is_reversed(subscale, *i));
        let reversed: Vec<u32> = reversed.collect();
        // A weight such as 9.54 leaves a tail of binary digits.
        let rounded = |score: f64| (score * 1e9).round() / 1e9;
        let (low, high) = scale.score_range(subscale);
        let (low, high) = (rounded(low), rounded(high));
        let published = published(subscale.norms.as_ref());
        context! { reversed, low, high, items, published, ..value(subscale) }
    });
    let worded = scale.wording.items.iter().zip(&scale.items).enumerate();
    let worded = worded.map(|(place, (words, item))| {
        let text = words.text.clone();
        let wording = words.pair.as_ref().map_or(text, |[left, right]| {
            format!("{left} – {right}")
        });
        context! { number => place + 1, wording, range => item.range(), kind => item.kind.name(), expected => item.expected, optional => item.optional, anchors => named_answers(item, words) }
    });
    let words = worded.collect::<Vec<Value>>();
    context! {
        count => scale.count(),
        ranges => scale.ranges(),
        worded => scale.wording.worded(),
        turned => scale.items.first().map(|i| i.min + i.max),
        languages => scale.languages().map(str::to_owned).collect::<Vec<String>>(),
        words,
        first => scale.column_of(1),
        last => scale.column_of(scale.count()),
        subscales => subscales.collect::<Vec<Value>>(),
        published => scale.subscales.iter().filter_map(|s| s.norms.as_ref()).any(|n| n.is_published() || n.is_alpha_published()),
        published_correlations => scale.correlations.iter().filter(|c| c.source != Norms::CHOSEN).map(value).collect::<Vec<Value>>(),
        ..value(scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_chosen_for_made_up_people_is_no_norm() {
        let text = |source: &str, alpha: &str| {
            let scale = format!(
                "id = \"calm\"\ntitle = \"Calm\"\nreference = \"R\"\nitems = 1\nmin = 1\nmax = 7\nscoring = \"mean\"\n\
                 [[subscales]]\nid = \"calm\"\ntitle = \"Calm\"\nitems = [1]\nnorms = {{ mean = 4.3, sd = 0.9, alpha = 0.87, source = \"{source}\"{alpha} }}\n"
            );
            codebook(&[Scale::from_toml(&scale).unwrap()], None).unwrap()
        };
        let chosen = text("chosen", "");
        assert!(
            !chosen.contains("4.3")
                && !chosen.contains("0.87")
                && chosen.contains("| reversed | range |\n"),
            "{chosen}"
        );
        let alpha = text("chosen", ", alpha_source = \"Houston\"");
        assert!(alpha.contains(" |  |  | 0.87 | alpha: Houston |\n"), "{alpha}");
        let all = text("Houston", "");
        assert!(all.contains(" | 4.3 | 0.9 | 0.87 | Houston |\n"), "{all}");
    }

    #[test]
    fn a_wording_is_text_and_neither_mark_up_nor_a_cell_of_its_own() {
        let scale = "id = \"calm\"\ntitle = \"Calm <b>\"\nreference = \"Nobody | never\"\nitems = 1\nmin = 1\nmax = 5\nscoring = \"mean\"\n\
                     wording = [\"a | <script>b</script> & c\\u001b[2J\"]\n[[subscales]]\nid = \"calm\"\ntitle = \"Calm\"\nitems = [1]\n";
        let text = codebook(&[Scale::from_toml(scale).unwrap()], None).unwrap();
        assert!(text.contains("| 1 | a \\| &lt;script&gt;b&lt;/script&gt; &amp; c[2J |"), "{text}");
        assert!(
            text.contains("## Calm &lt;b&gt; (`calm`)") && text.contains("Nobody \\| never"),
            "{text}"
        );
    }
}
