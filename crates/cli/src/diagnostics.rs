//! A failure as a person reads it: what we were doing, why it failed, what to try.

use crate::interrupt::INTERRUPTED;
use maveric_pipeline::PipelineError;
use maveric_study::{StudyError, design::DESIGN_FILE};
use std::{
    borrow::Cow,
    error::Error,
    fmt,
    io::{IsTerminal as _, Write as _},
};

/// Says something on stderr. Where that cannot be written (`2>&1 | head -1`), nobody is told and
/// nothing else changes: `eprintln!` would end the program half-way.
macro_rules! tell {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        // One write a line: lines of programs that run side by side stay whole.
        let text = format!($($text)*) + "\n";
        let _ = std::io::stderr().write_all(crate::diagnostics::printable(&text).as_bytes());
    }};
}
pub(crate) use tell;

/// A text without characters that a terminal would obey: names of topics, columns and files come from elsewhere.
pub(crate) fn printable(text: &str) -> Cow<'_, str> {
    let obeyed = |c: char| {
        let turns = matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        turns || c.is_control() && c != '\n' && c != '\t'
    };
    if !text.contains(obeyed) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if obeyed(c) {
            out.extend(c.escape_unicode());
        } else {
            out.push(c);
        }
    }
    Cow::Owned(out)
}

/// Why a command ended without its result.
#[derive(Debug)]
pub(crate) enum Failure {
    Interrupted,
    /// A run of a pipeline was interrupted, and what it leaves has been told.
    InterruptedRun,
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
        self.help.as_ref().map(|h| Box::new(h) as Box<dyn std::fmt::Display>)
    }
}

/// An error in words alone.
#[derive(Debug)]
struct Said {
    text: String,
    source: Option<Box<Self>>,
}

impl fmt::Display for Said {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Error for Said {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.source.as_deref().map(|s| s as &(dyn Error + 'static))
    }
}

impl Said {
    fn from_error(error: &dyn Error) -> Self {
        Self {
            text: printable(&error.to_string()).into_owned(),
            source: error.source().map(|source| Box::new(Self::from_error(source))),
        }
    }
}

impl Failed {
    /// The same with texts that a terminal shows and does not obey.
    fn printable(&self) -> Self {
        Self {
            doing: printable(&self.doing).into_owned(),
            cause: Box::new(Said::from_error(&*self.cause)),
            help: self.help.as_deref().map(|help| printable(help).into_owned()),
        }
    }
}

impl Failure {
    /// Turns a study error into a failure of `doing`, such as "could not train".
    pub(crate) fn study(doing: &'static str) -> impl FnOnce(StudyError) -> Self {
        move |cause| match cause {
            StudyError::Interrupted => Self::Interrupted,
            cause => {
                let help = cause.suggestion();
                Self::new(doing, cause, help)
            }
        }
    }

    /// Turns a pipeline error into a failure of `doing`.
    pub(crate) fn pipeline(doing: &'static str) -> impl FnOnce(PipelineError) -> Self {
        move |cause| match cause {
            PipelineError::Interrupted => Self::Interrupted,
            cause if cause.is_usage() => {
                let help = cause.suggestion();
                let help = help.map_or_else(String::new, |help| format!(" ({help})"));
                Self::Usage(format!("{cause}{help}"))
            }
            cause => {
                let help = cause.suggestion();
                Self::new(doing, cause, help)
            }
        }
    }

    /// A failure that has been told, unless it was a success.
    pub(crate) fn told_unless(success: bool) -> Result<(), Self> {
        if success { Ok(()) } else { Err(Self::Told) }
    }

    /// There is nothing to run in the current directory.
    pub(crate) fn no_study() -> Self {
        Self::Failed(Failed {
            doing: "there is no study here".to_owned(),
            cause: format!("neither {DESIGN_FILE} nor pipelines/paper.toml is in this folder").into(),
            help: Some(
                "name a pipeline file, go to a study's folder, or make one: `maveric init my_study` for recordings of your own, \
                 `maveric init --paper` in an empty folder for the paper's study with made-up people"
                    .to_owned(),
            ),
        })
    }

    /// A failure of `doing`, with what to try.
    pub(crate) fn new(
        doing: &str,
        cause: impl std::error::Error + Send + Sync + 'static,
        help: Option<String>,
    ) -> Self {
        Self::Failed(Failed { doing: doing.to_owned(), cause: Box::new(cause), help })
    }

    /// Turns what the system said into a failure of `doing`.
    pub(crate) fn io(doing: &str, cause: std::io::Error) -> Self {
        Self::new(doing, cause, None)
    }

    /// Turns the failure to print into a failure.
    pub(crate) fn output(cause: std::io::Error) -> Self {
        Self::io("could not write the result", cause)
    }

    /// Why it failed and what to try, in a line.
    pub(crate) fn in_a_line(&self) -> String {
        let Self::Failed(failed) = self else {
            return self.text();
        };
        let first: &dyn Error = &*failed.cause;
        let causes = std::iter::successors(Some(first), |&cause| cause.source());
        let words = causes.map(ToString::to_string).chain(failed.help.clone());
        words.collect::<Vec<String>>().join(": ")
    }

    /// The failure in words, as [`Failure::report`] prints it without colours.
    pub(crate) fn text(&self) -> String {
        match self {
            Self::Interrupted | Self::InterruptedRun => "interrupted".to_owned(),
            Self::Told => "failed".to_owned(),
            Self::Usage(message) => message.clone(),
            Self::Failed(failed) => render(&failed.printable(), true),
        }
    }

    /// Prints the failure on stderr and says how the program ends: 1, 2 or 130.
    pub(crate) fn report(self) -> u8 {
        match self {
            Self::Interrupted => {
                tell!(
                    "interrupted; every result is whole or not there, and what is left hidden beside them (`.maveric-…`) is removed by a later run"
                );
                INTERRUPTED
            }
            Self::InterruptedRun => INTERRUPTED,
            Self::Told => 1,
            Self::Usage(message) => {
                tell!("error: {message}");
                2
            }
            // A reader that closed the pipe early (`maveric … | head`) wanted no more.
            Self::Failed(failed) if is_broken_pipe(&failed) => 0,
            Self::Failed(failed) => {
                let plain =
                    !std::io::stderr().is_terminal() || std::env::var_os("NO_COLOR").is_some();
                // With colours there are escape sequences of ours in it: its texts are made printable first.
                let _ = writeln!(std::io::stderr(), "{}", render(&failed.printable(), plain));
                1
            }
        }
    }
}

fn is_broken_pipe(failed: &Failed) -> bool {
    failed.cause.downcast_ref::<std::io::Error>().is_some_and(|e| {
        // Windows has a second number for it, that no process is at the other end, without a kind of its own.
        let nobody_reads = cfg!(windows) && e.raw_os_error() == Some(233);
        nobody_reads || e.kind() == std::io::ErrorKind::BrokenPipe
    })
}

/// `plain`: without colours and line breaks, for where no person reads.
fn render(failed: &Failed, plain: bool) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_would_obey_is_shown_and_other_text_is_left_alone() {
        assert_eq!(printable("/ego\u{1b}[2J\u{202e}x\r"), "/ego\\u{1b}[2J\\u{202e}x\\u{d}");
        assert!(matches!(printable("Größe\t3 m\n"), Cow::Borrowed(_)));
    }
}
