//! The claims as a file states them.

use crate::error::ReportError;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// One number that the paper reports.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Claim {
    /// Unique; lower-case letters, digits, hyphens.
    pub id: String,
    /// What the number is.
    pub text: String,
    /// Part of the paper's results.
    pub section: String,
    /// What kind of number.
    pub quantity: Quantity,
    /// The number, as the paper prints it.
    pub printed: Printed,
    /// The p printed with a coefficient.
    pub printed_p: Option<Printed>,
    /// Degrees of freedom of a coefficient.
    pub df: Option<u32>,
    /// Where they come from.
    pub df_from: Option<DfSource>,
    /// Under which key our result is found.
    pub key: String,
    /// How ours is compared.
    pub rule: Rule,
    /// A share or a mean of whole numbers over so many people: it is checked whether it can be one.
    pub of: Option<u32>,
    /// Ids of the claims that this one should be the sum of.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sum_of: Vec<String>,
    /// Sizes were chosen so that ours comes near: it is shown, and no finding.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub tuned: bool,
    /// What a reader should know.
    pub note: Option<String>,
}

/// Kinds of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Pearson's correlation.
    R,
    /// Spearman's correlation.
    Rho,
    /// A p value.
    P,
    /// Per cent: 93.6 for 93.6 %.
    Percent,
    /// Miles an hour.
    Mph,
    /// A time in years.
    Years,
    /// A time in minutes.
    Minutes,
    /// Points of a scale.
    Points,
    /// How many there are.
    Count,
    /// A factor of a speed.
    Factor,
    /// A difference in the measure's unit, of which the paper gives the direction only.
    Difference,
}

impl Quantity {
    /// Decimals shown of ours.
    pub(crate) fn decimals(self) -> usize {
        match self {
            Self::R | Self::Rho | Self::Factor | Self::Difference => 2,
            Self::P => 3,
            Self::Percent | Self::Mph | Self::Years => 1,
            Self::Minutes | Self::Points | Self::Count => 0,
        }
    }

    /// Written after the number.
    pub(crate) fn unit(self) -> &'static str {
        match self {
            Self::Percent => " %",
            Self::Mph => " mph",
            Self::Years => " years",
            Self::Minutes => " min",
            Self::Points => " points",
            Self::R | Self::Rho | Self::P | Self::Count | Self::Factor | Self::Difference => "",
        }
    }
}

/// Where degrees of freedom come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DfSource {
    /// Printed with the coefficient.
    Printed,
    /// The number of participants minus two.
    Participants,
}

/// How ours is compared with the paper's.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Rule {
    /// Same sign; and of similar size if within the tolerance.
    Direction {
        /// Greatest distance that counts as similar.
        tolerance: f64,
    },
    /// Within the tolerance.
    Near {
        /// Greatest distance.
        tolerance: f64,
    },
    /// Our p is below a bound.
    PBelow {
        /// What the p must be below.
        bound: f64,
    },
    /// Our p is above a bound.
    PAbove {
        /// What the p must be above.
        bound: f64,
    },
    /// Our value is above the printed one.
    Above,
    /// Our value is below the printed one.
    Below,
    /// Whoever runs the study sets it: no finding, whatever ours is.
    ByDesign {},
}

/// A number as printed: `-.5`, `<.001`, `93.6`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Printed {
    text: String,
    /// The number, or the bound.
    pub value: f64,
    /// `<` or `>` if it is a bound.
    pub bound: Option<char>,
}

impl TryFrom<String> for Printed {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let bound = text.chars().next().filter(|sign| matches!(sign, '<' | '>'));
        let digits = text.trim_start_matches(['<', '>']);
        let value: f64 =
            digits.parse().map_err(|_| format!("`{text}` is not a number as printed"))?;
        if !value.is_finite() {
            return Err(format!("`{text}` is not a finite number"));
        }
        Ok(Self { text, value, bound })
    }
}

impl From<Printed> for String {
    fn from(printed: Printed) -> Self {
        printed.text
    }
}

impl Printed {
    /// As printed, with a true minus sign.
    pub fn text(&self) -> String {
        self.text.replace('-', "−").replace('<', "< ").replace('>', "> ")
    }

    /// Decimals printed.
    pub(crate) fn decimals(&self) -> usize {
        self.text.split_once('.').map_or(0, |(_, after)| after.len())
    }

    /// As in the file: `-.5`, `<.001`.
    pub(crate) fn as_written(&self) -> &str {
        &self.text
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    claim: Vec<Claim>,
}

/// Reads the claims from the text of a TOML file, in its order.
///
/// # Errors
/// [`ReportError::Claims`] if it is not such a file, [`ReportError::DuplicateName`] for an id that
/// is used twice, [`ReportError::Claim`] for a coefficient outside −1..1, degrees of freedom
/// without a source, or a sum of claims that are not there.
pub fn load(toml: &str) -> Result<Vec<Claim>, ReportError> {
    let file: File =
        toml::from_str(toml).map_err(|error| ReportError::Claims { reason: error.to_string() })?;
    let mut seen = BTreeSet::new();
    for claim in &file.claim {
        if !seen.insert(&claim.id) {
            return Err(ReportError::DuplicateName { name: claim.id.clone() });
        }
        let wrong = |reason: &str| {
            Err(ReportError::Claim { id: claim.id.clone(), reason: reason.to_owned() })
        };
        let coefficient = matches!(claim.quantity, Quantity::R | Quantity::Rho);
        if coefficient && claim.printed.value.abs() > 1.0 {
            return wrong("a correlation lies between -1 and 1");
        }
        if claim.df.is_some() != claim.df_from.is_some() {
            return wrong("`df` and `df_from` belong together");
        }
        if claim.df == Some(0) || claim.of == Some(0) {
            return wrong("`df` and `of` must be above 0");
        }
        if let Some(id) =
            claim.sum_of.iter().find(|id| file.claim.iter().all(|other| other.id != **id))
        {
            return wrong(&format!("`sum_of` names `{id}`, which is no claim"));
        }
    }
    Ok(file.claim)
}
