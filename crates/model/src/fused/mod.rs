//! The training kernel: a tile of rows through all five sub-networks and back while it is in the near caches.
//!
//! Rows of data lie one after the other, their features along the vectors ([`matrix`]); two products do all the
//! work ([`product`]); weights are kept as those products read them ([`layout`]); what a first layer makes of a
//! driver's `w` is a row of a table, made once a batch ([`roster`]); [`through`] takes a stack of layers, [`tile`] all
//! five sub-networks, [`batch`] splits a batch into lanes whose sums are taken in a fixed order.
//!
//! Every sum runs in one order whatever the vectors' width, so AVX2 and AVX-512 agree to the last bit, and plain
//! code, which has no fused multiply and add, to rounding. The tests hold losses and gradients against the central
//! differences of plain double-precision loops.

pub(crate) mod batch;
pub(crate) mod layout;
pub(crate) mod matrix;
pub(crate) mod product;
pub(crate) mod roster;
#[cfg(test)]
mod tests;
pub(crate) mod through;
pub(crate) mod tile;
