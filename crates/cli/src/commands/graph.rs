//! `maveric graph`.

use super::{print_json, print_lines};
use crate::{
    diagnostics::Failure,
    place::{DEFAULT_PIPELINE, PipelineArgs},
};
use maveric_pipeline::Graph as StageGraph;
use std::path::PathBuf;

/// Show which stage needs which
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: maveric graph pipelines/paper.toml --format mermaid")]
pub(crate) struct Graph {
    /// Pipeline to read
    #[arg(default_value = DEFAULT_PIPELINE)]
    file: PathBuf,
    #[command(flatten)]
    pipeline: PipelineArgs,
    /// How to print the graph
    #[arg(long, value_enum, default_value_t)]
    format: GraphFormat,
}

/// How a graph is printed.
#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
enum GraphFormat {
    /// For Graphviz
    #[default]
    Dot,
    /// For Markdown pages
    Mermaid,
    /// The JSON schema of pipeline files, for editors
    Schema,
}

impl Graph {
    pub(crate) fn run(self) -> Result<(), Failure> {
        if matches!(self.format, GraphFormat::Schema) {
            return print_json(&maveric_pipeline::schema());
        }
        let pipeline = self.pipeline.read(&self.file)?;
        let graph =
            StageGraph::new(&pipeline).map_err(Failure::pipeline("could not order the stages"))?;
        let is_mermaid = matches!(self.format, GraphFormat::Mermaid);
        let text = if is_mermaid { graph.mermaid() } else { graph.dot() };
        print_lines(&[text.trim_end().to_owned()])
    }
}
