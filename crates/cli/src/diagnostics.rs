//! A failure as a person reads it: what we were doing, why it failed, what to try.

use crate::interrupt::INTERRUPTED;
use maveric_pipeline::PipelineError;
use maveric_study::StudyError;
use std::{io::IsTerminal as _, process::ExitCode};

/// Says something on stderr. Where that cannot be written (`2>&1 | head -1`), nobody is told and
/// nothing else changes: `eprintln!` would end the program half-way.
macro_rules! tell {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stderr(), $($text)*);
    }};
}
pub(crate) use tell;

/// Why a command ended without its result.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Interrupted: say little.
    Interrupted,
    /// The work failed.
    Failed(Failed),
    /// The work failed, and its failures have been told as they happened.
    Told,
    /// The request makes no sense as written.
    Usage(String),
}

/// What we were doing, why it failed, and what to try.
#[derive(Debug, thiserror::Error)]
#[error("{doing}")]
pub(crate) struct Failed {
    doing: String,
    #[source]
    cause: Box<dyn std::error::Error + Send + Sync>,
    help: Option<String>,
}

impl miette::Diagnostic for Failed {
    fn help<'a>(&'a self) -> Option<Box<dyn std::fmt::Display + 'a>> {
        self.help
            .as_ref()
            .map(|h| Box::new(h) as Box<dyn std::fmt::Display>)
    }
}

impl Failure {
    /// Turns a study error into a failure of `doing`, such as "could not train".
    pub(crate) fn study(doing: &'static str) -> impl FnOnce(StudyError) -> Self {
        move |cause| match cause {
            StudyError::Interrupted => Self::Interrupted,
            cause => {
                let help = cause.suggestion();
                Self::Failed(Failed {
                    doing: doing.to_owned(),
                    cause: Box::new(cause),
                    help,
                })
            }
        }
    }

    /// Turns a pipeline error into a failure of `doing`.
    pub(crate) fn pipeline(doing: &'static str) -> impl FnOnce(PipelineError) -> Self {
        move |cause| match cause {
            PipelineError::Interrupted => Self::Interrupted,
            cause => {
                let help = cause.suggestion();
                Self::Failed(Failed {
                    doing: doing.to_owned(),
                    cause: Box::new(cause),
                    help,
                })
            }
        }
    }

    /// Turns what the system said into a failure of `doing`.
    pub(crate) fn io(doing: &str, cause: std::io::Error) -> Self {
        Self::Failed(Failed {
            doing: doing.to_owned(),
            cause: Box::new(cause),
            help: None,
        })
    }

    /// Turns the failure to print into a failure.
    pub(crate) fn output(cause: std::io::Error) -> Self {
        Self::io("could not write the result", cause)
    }

    /// Prints the failure on stderr and says how the program ends: 1, 2 or 130.
    pub(crate) fn report(self) -> ExitCode {
        match self {
            Self::Interrupted => {
                tell!("interrupted; nothing was left half-written");
                ExitCode::from(INTERRUPTED)
            }
            Self::Told => ExitCode::FAILURE,
            Self::Usage(message) => {
                tell!("error: {message}");
                ExitCode::from(2)
            }
            // A reader that closed the pipe early (`maveric … | head`) wanted no more.
            Self::Failed(failed) if is_broken_pipe(&failed) => ExitCode::SUCCESS,
            Self::Failed(failed) => {
                tell!("{}", render(&failed));
                ExitCode::FAILURE
            }
        }
    }
}

fn is_broken_pipe(failed: &Failed) -> bool {
    failed
        .cause
        .downcast_ref::<std::io::Error>()
        .is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
}

fn render(failed: &Failed) -> String {
    let plain = !std::io::stderr().is_terminal() || std::env::var_os("NO_COLOR").is_some();
    let theme = if plain {
        miette::GraphicalTheme::unicode_nocolor()
    } else {
        miette::GraphicalTheme::unicode()
    };
    // Not wrapped where no person reads: a script greps for whole messages.
    let handler = miette::GraphicalReportHandler::new_themed(theme).with_width(if plain {
        10_000
    } else {
        100
    });
    let mut text = String::new();
    if handler.render_report(&mut text, failed).is_err() {
        text = format!("{failed}: {}", failed.cause);
    }
    text.trim_end().to_owned()
}
