//! Progress on stderr, where a person watches.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal as _;

/// A bar with rate and time left; silent when stderr is no terminal or `NO_COLOR` is set.
pub(crate) fn bar() -> ProgressBar {
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
