//! The claims ledger: every number that the paper reports, ours beside it, and a verdict.

mod join;
mod ledger;
mod load;
mod recheck;
mod self_check;

pub use join::{LedgerRow, LeftOpen, Made, Verdict, join};
pub use ledger::{ledger_table, verdict_counts};
pub(crate) use ledger::{ours, own_figures, rule, theirs};
pub use load::{Claim, DfSource, Printed, Quantity, Rule, load};
pub use recheck::{Recheck, recheck};
pub use self_check::{SelfCheck, self_check};
