//! Texts that are templates: the pipeline of a design, the `study.toml` of a new study.

use minijinja::{Environment, UndefinedBehavior, Value, syntax::SyntaxConfig};

/// The pipeline that follows from a design.
pub(crate) const PIPELINE: &str = include_str!("texts/pipeline.toml");
/// What a stranger reads of an export.
pub(crate) const EXPORT_README: &str = include_str!("texts/export_readme.md");
/// The commented design of a new study.
pub(crate) const STUDY: &str = include_str!("texts/study.toml");

/// One of these templates with its values; a line that is a statement of the template alone leaves nothing behind.
pub(crate) fn fill(template: &str, values: Value) -> String {
    let mut syntax = SyntaxConfig::builder();
    syntax.trim_blocks(true).lstrip_blocks(true);
    syntax.keep_trailing_newline(true);
    let mut environment = Environment::new();
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    #[expect(
        clippy::expect_used,
        reason = "the templates are this crate's own, and a test fills each of them"
    )]
    {
        environment.set_syntax(syntax.build().expect("the usual marks"));
        let text = environment.render_str(template, values);
        text.expect("a template of ours")
    }
}
