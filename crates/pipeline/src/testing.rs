//! Short pipelines for unit tests.

use crate::Pipeline;

/// A pipeline named `test` of stages (name, inputs, outputs) that all call `x`.
pub(crate) fn pipeline(stages: &[(&str, &[&str], &[&str])]) -> Pipeline {
    let table = |(name, inputs, outputs): &(&str, &[&str], &[&str])| {
        format!(
            "[[stage]]\nname = '{name}'\ncmd = ['x']\ninputs = {inputs:?}\noutputs = {outputs:?}\n"
        )
    };
    let tables: String = stages.iter().map(table).collect();
    parsed(&format!("name = 'test'\n{tables}"))
}

/// The pipeline of a text.
pub(crate) fn parsed(text: &str) -> Pipeline {
    let settings = crate::Settings::default();
    Pipeline::parse(text, "test.toml".as_ref(), ".".as_ref(), &settings).unwrap()
}
