//! `maveric clean`.

use super::print_as;
use crate::{
    diagnostics::Failure,
    place::{PipelineArgs, place},
};
use maveric_study::outcome::Format;

/// Remove what a pipeline's stages made, and nothing else
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples: maveric clean pipelines/smoke.toml -n          what would go
          maveric clean pipelines/paper.toml report      only one stage's outputs

What was edited by hand stays, unless --force is given.")]
pub(crate) struct Clean {
    /// Pipeline file; then stages or files to remove, all when none are named
    #[arg(value_name = "PIPELINE] [STAGE")]
    words: Vec<String>,
    #[command(flatten)]
    pipeline: PipelineArgs,
    /// Say what would be removed; remove nothing
    #[arg(short = 'n', long)]
    dry_run: bool,
    /// Also remove outputs that were edited by hand
    #[arg(long)]
    force: bool,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Clean {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let (file, targets) = PipelineArgs::split(self.words);
        let pipeline = self.pipeline.read(&file)?;
        let place = place(&file)?;
        let cleaned =
            maveric_pipeline::clean(&pipeline, &place, &targets, self.force, self.dry_run)
                .map_err(Failure::pipeline("could not clean up"))?;
        let verb = if self.dry_run { "would remove" } else { "removed" };
        let removed = cleaned.removed.iter().map(|path| format!("{verb} {path}"));
        let kept = cleaned.kept.iter();
        let kept = kept.map(|path| {
            format!(
                "kept {path}: it was edited by hand, or its run was cut off (--force removes it)"
            )
        });
        let foreign = cleaned.foreign.iter();
        let foreign = foreign.map(|path| format!("kept {path}: no run made it"));
        let mut lines: Vec<String> = removed.chain(kept).chain(foreign).collect();
        if lines.is_empty() {
            lines.push("nothing to remove".to_owned());
        }
        print_as(self.format, &cleaned, &lines)
    }
}
