//! The templates of the page, filled in.

use crate::error::ReportError;
use minijinja::{Environment, UndefinedBehavior, Value};

/// A template of this folder with its values; no empty lines.
pub(crate) fn fill(template: &str, values: Value) -> Result<String, ReportError> {
    let failed = |error: minijinja::Error| ReportError::Template { reason: format!("{error:#}") };
    let mut environment = Environment::new();
    environment.add_global("has_png", cfg!(feature = "png"));
    environment.add_global("has_pdf", cfg!(feature = "pdf"));
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    for (name, source) in [
        ("page.html", include_str!("templates/page.html")),
        ("table.html", include_str!("templates/table.html")),
        ("parts.html", include_str!("templates/parts.html")),
        ("ledger.html", include_str!("templates/ledger.html")),
        ("space.html", include_str!("templates/space.html")),
        ("player.html", include_str!("player/player.html")),
        ("watch.html", include_str!("player/watch.html")),
    ] {
        environment.add_template(name, source).map_err(failed)?;
    }
    let page =
        environment.get_template(template).and_then(|page| page.render(values)).map_err(failed)?;
    // The template's own statements leave empty lines behind.
    let lines = page.lines().filter(|line| !line.trim().is_empty());
    Ok(lines.fold(String::with_capacity(page.len()), |out, line| out + line + "\n"))
}

/// Only what this crate wrote itself, escaped where it was not ours.
pub(crate) fn safe(html: String) -> Value {
    Value::from_safe_string(html)
}
