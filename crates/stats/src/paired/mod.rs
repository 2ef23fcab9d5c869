//! Comparisons of two conditions at a time.

pub(crate) mod conover;
pub(crate) mod nemenyi;
pub(crate) mod pooled;
pub(crate) mod signed_ranks;
pub(crate) mod t;
pub(crate) mod wilcoxon;
