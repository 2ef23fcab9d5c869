//! A study in the seat, through its server: people by scripts, whoever runs the study, and what neither may do.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test stops at the first surprise")]

mod collected;
mod decided;
mod languages;
mod left_out;
mod let_in;
mod limits;
mod live;
mod moments;
mod payment;
mod ranges;
mod repeated;
mod ride_only;
mod sessions;
mod shown_again;
mod stopping;
mod study;
mod styles;
mod support;
#[cfg(feature = "tls")]
mod tls;
mod withdrawing;
