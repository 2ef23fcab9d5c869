//! How somebody else wants every figure to look: palette, font, sizes, labels.

use super::theme::{self, Marker, hex};
use crate::error::ReportError;
use maveric_domain::ConditionId;
use plotters::style::RGBColor;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// What a style file says; what it leaves out stays as it is.
///
/// # Example
/// ```
/// let style = maveric_report::figures::Style::from_toml(
///     "[palette]\npurple = \"#000000\"\n[labels]\n\"Mean velocity\" = \"Speed\"\n",
/// )?;
/// assert!(maveric_report::figures::Style::from_toml("[palete]\n").is_err());
/// # drop(style);
/// # Ok::<(), maveric_report::ReportError>(())
/// ```
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Style {
    #[serde(default)]
    font: Font,
    #[serde(default)]
    size: Size,
    #[serde(default)]
    palette: BTreeMap<String, String>,
    #[serde(default)]
    conditions: BTreeMap<ConditionId, Looks>,
    #[serde(default)]
    labels: BTreeMap<String, String>,
    /// Files of fonts, as bytes; whoever reads the style file fills them in.
    #[serde(skip)]
    pub fonts: Vec<Vec<u8>>,
    #[serde(skip)]
    colours: BTreeMap<String, String>,
}

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Font {
    family: Option<String>,
    #[serde(default)]
    files: Vec<String>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Size {
    text: f64,
    one_column_mm: f64,
    two_columns_mm: f64,
}

impl Default for Size {
    fn default() -> Self {
        Self {
            text: 1.0,
            one_column_mm: theme::ONE_COLUMN_MM,
            two_columns_mm: theme::TWO_COLUMNS_MM,
        }
    }
}

/// How a condition looks instead.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Looks {
    pub(super) label: Option<String>,
    pub(super) color: Option<String>,
    pub(super) marker: Option<Marker>,
}

/// Names of the colours of the theme.
const NAMED: [(&str, RGBColor); 10] = [
    ("ink", theme::INK),
    ("muted", theme::MUTED),
    ("grey", theme::GREY),
    ("grid", theme::GRID),
    ("pale", theme::PALE),
    ("purple", theme::PURPLE),
    ("orange", theme::ORANGE),
    ("blue", theme::BLUE),
    ("green", theme::GREEN),
    ("ochre", theme::OCHRE),
];

/// Units of figures.
const UNITS: [&str; 14] =
    ["km/h", "mph", "m/s", "m/s²", "m/s³", "ft/s", "m", "s", "min", "h", "ft", "km", "mi", "%"];

/// The units that a label names, in their order: words of their own, with or without brackets. Of `Ride(s)` the bracket is part of the word.
fn units_in(label: &str) -> Vec<&'static str> {
    let mut plain = String::new();
    for sign in label.chars() {
        let in_word = sign == '(' && plain.ends_with(|c: char| c.is_ascii_alphabetic());
        plain.push(if in_word { '_' } else { sign });
    }
    let unit = |word: &str| UNITS.into_iter().find(|unit| *unit == word);
    let apart = |c: char| c.is_whitespace() || "()[],（）".contains(c);
    plain.split(apart).filter_map(unit).collect()
}

static STYLE: OnceLock<Style> = OnceLock::new();

/// Every figure that this process draws from now on looks like that. To be called once, before the first figure.
///
/// # Errors
/// [`ReportError::Style`] if one was chosen already.
pub fn use_style(style: Style) -> Result<(), ReportError> {
    let taken = |_| ReportError::Style {
        reason: "a style was chosen already, and figures may have been drawn with it".to_owned(),
    };
    STYLE.set(style).map_err(taken)
}

/// What was chosen, if anything.
pub(crate) fn current() -> Option<&'static Style> {
    STYLE.get()
}

/// Width of the drawing of a figure so wide, in millimetres: of larger text a smaller one, which is then enlarged.
pub(super) fn drawn_width(mm: f64) -> f64 {
    current().map_or(mm, |style| style.sizes((mm, mm)).1.0)
}

/// `#rrggbb` as channels.
pub(super) fn colour(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#').filter(|d| d.len() == 6 && d.is_ascii())?;
    let channel = |at: usize| u8::from_str_radix(digits.get(at..at + 2)?, 16).ok();
    Some([channel(0)?, channel(2)?, channel(4)?])
}

/// What a colour turns into on the dark page; none of what is no colour.
pub(crate) fn hex_on_dark(text: &str) -> Option<String> {
    let [r, g, b] = colour(text)?;
    Some(theme::on_dark(RGBColor(r, g, b)))
}

impl Style {
    /// Reads a style file.
    ///
    /// # Errors
    /// [`ReportError::Style`] for a key or a colour that is none, a size out of range, or a label of another unit.
    pub fn from_toml(text: &str) -> Result<Self, ReportError> {
        let failed = |reason: String| ReportError::Style { reason };
        let mut style: Self = toml::from_str(text).map_err(|e| failed(e.to_string()))?;
        let usable = |key: &str, value: f64, low: f64, high: f64| {
            let wrong = || failed(format!("`{key}` is {value}, expected {low} to {high}"));
            (low..=high).contains(&value).then_some(()).ok_or_else(wrong)
        };
        usable("size.text", style.size.text, 0.5, 3.0)?;
        usable("size.one_column_mm", style.size.one_column_mm, 40.0, 300.0)?;
        usable("size.two_columns_mm", style.size.two_columns_mm, 40.0, 600.0)?;
        for (name, to) in &style.palette {
            let names: Vec<&str> = NAMED.iter().map(|(name, _)| *name).collect();
            let known = NAMED.iter().find(|(known, _)| known == name).map(|(_, c)| hex(*c));
            let from = known.or_else(|| colour(name).map(|_| name.to_lowercase()));
            let from = from.ok_or_else(|| {
                failed(format!(
                    "`palette.{name}` is no colour, expected `#rrggbb` or one of {}",
                    names.join(", ")
                ))
            })?;
            let to = colour(to).map(|_| to.to_lowercase()).ok_or_else(|| {
                failed(format!("`palette.{name}` is `{to}`, expected a colour as `#rrggbb`"))
            })?;
            style.colours.insert(from, to);
        }
        for (id, look) in &style.conditions {
            if let Some(wrong) = look.color.as_ref().filter(|c| colour(c).is_none()) {
                return Err(failed(format!(
                    "`conditions.{id}.color` is `{wrong}`, expected a colour as `#rrggbb`"
                )));
            }
        }
        for (label, other) in &style.labels {
            let (units, others) = (units_in(label), units_in(other));
            if units != others {
                let named = |units: &[&str]| match units {
                    [] => "no unit".to_owned(),
                    units => units.join(" and "),
                };
                return Err(failed(format!(
                    "`labels.\"{label}\"` is `{other}`, which names {}, expected {}: the numbers stay as they are",
                    named(&others),
                    named(&units)
                )));
            }
        }
        Ok(style)
    }

    /// The files of fonts that it names, from the style file's folder.
    pub fn font_files(&self) -> &[String] {
        &self.font.files
    }

    pub(crate) fn family(&self) -> Option<&str> {
        self.font.family.as_deref()
    }

    pub(super) fn look(&self, id: ConditionId) -> Option<&Looks> {
        self.conditions.get(&id)
    }

    /// Another label, where one was asked for.
    pub(super) fn label(&self, text: &str) -> Option<&str> {
        self.labels.get(text).map(String::as_str)
    }

    /// The size on paper, and that of the drawing which is then enlarged so that text has the size asked for.
    pub(super) fn sizes(&self, (width, height): (f64, f64)) -> ((f64, f64), (f64, f64)) {
        let factor = if width <= theme::ONE_COLUMN_MM {
            self.size.one_column_mm / theme::ONE_COLUMN_MM
        } else {
            self.size.two_columns_mm / theme::TWO_COLUMNS_MM
        };
        let shown = (width * factor, height * factor);
        (shown, (shown.0 / self.size.text, shown.1 / self.size.text))
    }

    /// A colour of the theme as this style has it.
    pub(crate) fn recoloured(&self, colour: &str) -> Option<&str> {
        self.colours.get(colour).map(String::as_str)
    }

    /// The drawing with its colours and its font.
    pub(super) fn dressed(&self, svg: &str) -> String {
        let mut out = String::with_capacity(svg.len());
        let mut rest = svg;
        while let Some(at) = rest.find("=\"#") {
            let (before, after) = rest.split_at(at + 2);
            out.push_str(before);
            let old = after.get(..7).unwrap_or_default();
            out.push_str(self.recoloured(old).unwrap_or(old));
            rest = &after[old.len()..];
        }
        out.push_str(rest);
        match self.family() {
            Some(family) => {
                let family = crate::markup::escape(&family.replace('\'', ""));
                out.replacen("font-family=\"'", &format!("font-family=\"'{family}','"), 1)
            }
            None => out,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_style_recolours_a_drawing_in_one_pass_and_names_its_font_first() {
        let style = Style::from_toml(
            "[font]\nfamily = \"Helvetica\"\n[palette]\nink = \"#882e72\"\n\"#882e72\" = \"#000000\"\n",
        )
        .unwrap();
        let svg = "<svg font-family=\"'Maveric Sans',x\"><a fill=\"#222222\" stroke=\"#882E72\"/><b fill=\"#882e72\"/>#222222</svg>";
        assert_eq!(
            style.dressed(svg),
            "<svg font-family=\"'Helvetica','Maveric Sans',x\"><a fill=\"#882e72\" stroke=\"#882E72\"/><b fill=\"#000000\"/>#222222</svg>"
        );
    }

    #[test]
    fn a_label_may_have_other_words_around_its_unit() {
        let text = "[labels]\n\"Mean velocity (km/h)\" = \"Geschwindigkeit in km/h\"\n\"Driver's gap (s)\" = \"Abstand in s\"\n\"Gap (m)\" = \"min. Abstand [m]\"\n\"Speed (m/s)\" = \"速度(m/s)\"\n\"Ride(s)\" = \"Fahrten\"\n";
        let style = Style::from_toml(text).unwrap();
        assert_eq!(style.label("Driver's gap (s)"), Some("Abstand in s"));
    }

    #[test]
    fn larger_text_is_a_smaller_drawing_enlarged() {
        let style = Style::from_toml("[size]\ntext = 1.25\none_column_mm = 90\n").unwrap();
        let ((w, h), (dw, dh)) = style.sizes((85.0, 60.0));
        assert!((w - 90.0).abs() < 1e-9 && (dw - 72.0).abs() < 1e-9);
        assert!((h / w - dh / dw).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_colour_no_size_and_no_key_is_refused_by_name() {
        for (text, named) in [
            ("[palette]\npink = \"#ffffff\"\n", "palette.pink"),
            ("[palette]\nink = \"black\"\n", "palette.ink"),
            ("[size]\ntext = 9\n", "size.text"),
            ("[conditions.calm]\ncolor = \"red\"\n", "conditions.calm.color"),
            ("[colors]\n", "colors"),
            ("[labels]\n\"Mean velocity (km/h)\" = \"Speed (mph)\"\n", "names mph, expected km/h"),
            ("[labels]\n\"Gap (m)\" = \"Distance\"\n", "names no unit, expected m"),
            ("[labels]\n\"Mean velocity\" = \"Speed in m/s\"\n", "names m/s, expected no unit"),
        ] {
            let message = Style::from_toml(text).unwrap_err().to_string();
            assert!(message.contains(named), "{message}");
        }
    }
}
