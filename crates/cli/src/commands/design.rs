//! `maveric design`.

use super::{print_json, print_outcome, today};
use crate::diagnostics::Failure;
use maveric_study::outcome::Format;
use maveric_study::stages::{declare, freeze, orders};
use std::path::PathBuf;

/// The study's design as the text of a preregistration; frozen, so that the page can say what differs; orders of its conditions; the schema of its file
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples: maveric design describe > preregistration.md
          maveric design freeze --design my_study/study.toml
          maveric design orders --people 24
          maveric design schema > schema.json")]
pub(crate) struct Design {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, clap::Subcommand)]
enum What {
    /// Print the design in plain English, with the power that a rehearsal of it found
    Describe(Describe),
    /// Write study.lock beside the design: what was declared, and when
    Freeze(Args),
    /// Write a table of people with the order in which each meets the conditions, balanced by a Williams or Latin square
    Orders(WriteOrders),
    /// Print the JSON schema of study.toml, by which an editor completes and explains its keys
    Schema,
}

#[derive(Debug, clap::Args)]
struct WriteOrders {
    #[command(flatten)]
    args: Args,
    #[command(flatten)]
    asked: orders::Orders,
}

#[derive(Debug, clap::Args)]
struct Describe {
    #[command(flatten)]
    args: Args,
    /// What `maveric rehearse` found for this design (JSON); rehearsal/rehearsal.json beside the design when not given
    #[arg(long, value_name = "FILE")]
    power: Option<PathBuf>,
}

#[derive(Debug, clap::Args)]
struct Args {
    /// Design of the study (TOML); study.toml of the current directory when not given, else the paper's
    #[arg(long, value_name = "FILE")]
    design: Option<PathBuf>,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Design {
    pub(crate) fn run(self) -> Result<(), Failure> {
        match self.what {
            What::Describe(Describe { args: a, power }) => {
                print_outcome(a.format, "could not describe the design", |_| {
                    declare::describe(a.design.as_deref(), power.as_deref())
                })
            }
            What::Orders(WriteOrders { args: a, asked }) => {
                print_outcome(a.format, "could not write the orders", |_| {
                    orders::orders(a.design.as_deref(), &asked)
                })
            }
            What::Schema => print_json(&maveric_domain::design::schema()),
            What::Freeze(a) => {
                let today = today();
                print_outcome(a.format, "could not freeze the design", |_| {
                    freeze::freeze(a.design.as_deref(), &today)
                })
            }
        }
    }
}
