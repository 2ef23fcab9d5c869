#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod analyse;
mod balance;
mod by_factor;
mod compare;
mod congruence;
mod consents;
mod contrast;
mod correlations;
mod crossed;
#[cfg(test)]
mod crossover_tests;
mod data;
mod describe;
mod design_test;
mod error;
pub mod exclusions;
mod family;
pub mod finding;
pub mod findings;
mod flow;
mod homophily;
mod hypotheses;
mod lent;
mod line;
mod mixed;
mod other_choice;
mod outcomes;
mod pairs;
mod person;
mod planned;
mod presses;
mod primary;
mod recommendation;
mod reproduction;
mod result;
mod retest;
mod sensitivity;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod turned;
pub mod verdict;
mod which;

pub use analyse::analyse;
pub use balance::{Balance, OrderBalance, PlacesOf};
pub use consents::{ConsentRow, ConsentVersion, FEWEST_AGREED, NotAgreed};
pub use data::{StudyData, Tables};
pub use describe::{Observed, observed};
pub use design_test::{Purpose, covariate_number};
pub use error::AnalysisError;
pub use exclusions::{Driven, LeftOut, Rule, Stopped, Why};
pub use finding::{Finding, Needed, Part, Question};
pub use flow::{Flow, LeftOutFor, NotAdmitted};
pub use homophily::least_that_holds;
pub use lent::{BesideLent, LentContrast};
pub use other_choice::{OtherChoice, Sensitivity, SensitivityRow};
pub use outcomes::shown_unit;
pub use person::Person;
pub use planned::{PlannedTest, held_against_baseline, planned};
pub use presses::{BeforePress, CoursePoint, FEWEST_PEOPLE, FEWEST_PRESSES, PressCourse, Presses};
pub use recommendation::{Learned, OnTheScale, Preferred, Reason, Recommendation};
pub use result::{
    Above, AggressionLine, Analysis, Bias, ByFactor, CongruenceCurve, CongruenceRow, Contrast,
    ContrastTest, Correlation, Described, Exclusion, FactorContrast, Group, HomophilyRow, Judged,
    Kept, LevelMean, LineRow, MixedRow, Nearer, Odds, Panel, PerceivedStyle, Preference,
    PrimaryOutcome, Reproduction, SimilarityRow, TestedFactor,
};
pub use retest::{FEWEST_FOR_ICC, Repeats, Retest, RidesCounted};
pub use turned::{Settled, Turns};
pub use verdict::Verdict;
pub use which::WhichRide;
