//! The program as a process. What a command computes is tested where it lives.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test stops at the first surprise")]

mod cli;
mod designs;
mod factors;
mod labs;
mod left_out;
mod limits;
mod outputs;
mod outputs_dictionary;
mod own_measures;
mod paper_in_the_seat;
mod people_tables;
mod pipeline;
mod recovery;
mod repeats;
mod schemas;
mod stats_cli;
mod stats_designs;
mod support;
mod whole_studies;
mod your_own_study;
