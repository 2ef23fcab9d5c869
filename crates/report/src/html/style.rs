//! How the page looks: its rules, its font, its colours by day and at night.

use crate::figures::{
    ConditionLook, Context, DARK, current_style, font_face_css, hex, hex_on_dark, on_dark,
};
use plotters::style::RGBColor;
use std::fmt::Write as _;

/// A colour a condition as a variable below `root`, light and dark.
pub(crate) fn condition_colours(context: &Context, root: &str) -> String {
    let variables = |of: fn(RGBColor) -> String| {
        let one = |look: &ConditionLook| format!("--of-{}:{};", look.id, of(look.rgb()));
        context.conditions.iter().map(one).collect::<String>()
    };
    format!(
        "{root}{{{}}}\n@media screen and (prefers-color-scheme: dark) {{{root}{{{}}}}}\n",
        variables(hex),
        variables(on_dark)
    )
}

/// The page's own rules, the font, and the colours that the figures turn to in the dark.
pub(crate) fn style(context: &Context) -> String {
    let mut out = String::from(font_face_css());
    out.push_str(include_str!("templates/page.css"));
    out.push_str(&condition_colours(context, ":root"));
    out.push_str("@media screen and (prefers-color-scheme: dark) {\n");
    let drawn = DARK.map(|(light, dark)| (light, dark.to_owned()));
    let looks = context.conditions.iter().map(ConditionLook::rgb);
    let colours = looks.filter(|c| DARK.iter().all(|(light, _)| light != c));
    for (light, dark) in drawn.into_iter().chain(colours.map(|c| (c, on_dark(c)))) {
        let light = hex(light);
        // A colour that a style put in the place of one of ours turns into one of its own.
        let other = current_style().and_then(|style| style.recoloured(&light));
        let (light, dark) = match other {
            Some(other) => (other.to_owned(), hex_on_dark(other).unwrap_or(dark)),
            None => (light, dark),
        };
        let _ = writeln!(
            out,
            "figure svg [fill=\"{light}\"]{{fill:{dark}}} figure svg [stroke=\"{light}\"]{{stroke:{dark}}}"
        );
    }
    out.push_str("}\n");
    out
}
