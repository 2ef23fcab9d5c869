//! Progress on stderr, where a person watches.

use crate::interrupt;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use maveric_study::Watch;
use std::io::IsTerminal as _;

/// Does work under a bar, until Ctrl-C.
pub(crate) fn watched<T>(work: impl FnOnce(Watch<'_>) -> T) -> T {
    let bar = bar();
    let show = |done: usize, total: usize, what: &str| {
        bar.set_length(total as u64);
        bar.set_position(done as u64);
        bar.set_message(what.to_owned());
    };
    let result = work(Watch::new(&show, interrupt::flag()));
    bar.finish_and_clear();
    result
}

/// A bar with rate and time left; silent when stderr is no terminal or `NO_COLOR` is set.
fn bar() -> ProgressBar {
    let watched = std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    let bar = ProgressBar::new(0);
    bar.set_draw_target(if watched {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    });
    if let Ok(style) =
        ProgressStyle::with_template("{msg} [{bar:30}] {pos}/{len} {per_sec} {eta} left")
    {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}
