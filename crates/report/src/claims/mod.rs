//! The claims ledger: every number that the paper reports, ours beside it, and a verdict.

mod join;
mod ledger;
mod load;
mod recheck;

pub use join::{LedgerRow, Verdict, join};
pub use ledger::{ledger_table, verdict_counts};
pub use load::{Claim, DfSource, Printed, Quantity, Rule, load};
pub use recheck::{Recheck, recheck};
