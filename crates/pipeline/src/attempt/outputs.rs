//! The outputs of a stage: room for them, what becomes of old ones, what is noted of new ones.

use super::{News, Run, Workshop};
use crate::cache::{Damaged, Ran};
use crate::check::Present;
use crate::own;
use crate::paths::with_ancestors;
use crate::{Failure, FailureCause, Graph, Manifest, PipelineError, Record, Stage, Warning};
use std::collections::BTreeMap;
use std::error::Error;
use std::fs;

impl Workshop<'_> {
    /// Takes the outputs of a stage from the cache, if they are in it.
    pub(super) fn restore(
        &self,
        stage: &Stage,
        now: &Present,
        tell: &mut dyn FnMut(News),
    ) -> Result<bool, PipelineError> {
        let Some(cache) = &self.cache else {
            return Ok(false);
        };
        let digest = now.made_from.digest();
        let cached = match cache.find(stage, &digest) {
            Ok(Some(cached)) => cached,
            Ok(None) => return Ok(false),
            Err(Damaged) => {
                let stage = stage.name.clone();
                tell(News::Warning(Warning::CacheDamaged { stage }));
                return Ok(false);
            }
        };
        self.begin(stage)?;
        if !cache.restore(stage, &digest, &cached, &self.place.root, &self.hasher)? {
            let stage = stage.name.clone();
            tell(News::Warning(Warning::CacheDamaged { stage }));
            return Ok(false);
        }
        if let Some(summary) = &cached.summary {
            self.keep_summary(stage, summary)?;
        }
        let made_from = now.made_from.clone();
        let record =
            self.record_of(stage, made_from, cached.seconds, cached.peak_memory, cached.outputs)?;
        self.ledger().finish(stage, record)?;
        Ok(true)
    }

    /// Enters a good run into the ledger, or says which inputs changed meanwhile or which outputs it did not make.
    pub(crate) fn record(
        &self,
        stage: &Stage,
        run: Run<'_>,
        tell: &mut dyn FnMut(News),
    ) -> Result<Option<FailureCause>, PipelineError> {
        // What has not been touched is not read again.
        let now = self.look(stage)?.made_from;
        let paths = run.made_from.inputs_apart(&now);
        if !paths.is_empty() {
            return self.inputs_changed(paths).map(Some);
        }
        let mut outputs = BTreeMap::new();
        let mut paths = Vec::new();
        for output in &stage.outputs {
            match self.hasher.content(output)? {
                Some(content) => drop(outputs.insert(output.clone(), content)),
                None => paths.push(output.clone()),
            }
        }
        if !paths.is_empty() {
            return Ok(Some(FailureCause::OutputsMissing { paths }));
        }
        if stage.summary {
            self.keep_summary(stage, run.stdout)?;
        }
        let (seconds, peak) = ((run.seconds * 1e3).round() / 1e3, run.peak_memory);
        let record = self.record_of(stage, run.made_from, seconds, peak, outputs)?;
        if let Some(cache) = &self.cache {
            let ran =
                Ran { seconds, peak_memory: peak, summary: stage.summary.then_some(run.stdout) };
            let (root, hasher) = (&self.place.root, &self.hasher);
            let kept = cache.keep(stage, &record.digest, &record.outputs, &ran, root, hasher);
            match kept {
                Err(PipelineError::Interrupted) | Ok(()) => {}
                Err(error) => tell(News::Warning(Warning::NotCached {
                    stage: stage.name.clone(),
                    message: with_sources(&error),
                })),
            }
        }
        self.ledger().finish(stage, record)?;
        Ok(None)
    }

    /// That these inputs are no longer what they were.
    pub(crate) fn inputs_changed(&self, paths: Vec<String>) -> Result<FailureCause, PipelineError> {
        let is_folder = |path: &&String| self.place.root.join(path).is_dir();
        let folder = paths.iter().find(is_folder);
        let newest = folder.map(|path| self.hasher.newest(path)).transpose()?;
        Ok(FailureCause::InputsChanged { newest: newest.flatten(), paths })
    }

    fn record_of(
        &self,
        stage: &Stage,
        made_from: Manifest,
        seconds: f64,
        peak_memory: Option<u64>,
        outputs: BTreeMap<String, String>,
    ) -> Result<Record, PipelineError> {
        let overrides = self.pipeline.overrides().iter();
        let mut files = BTreeMap::new();
        for output in outputs.keys() {
            match self.hasher.names(output)? {
                Some(names) if self.place.root.join(output).is_dir() => {
                    files.insert(output.clone(), names);
                }
                _ => {}
            }
        }
        Ok(Record {
            stage: stage.name.clone(),
            variant: self.pipeline.variant().map(str::to_owned),
            files,
            digest: made_from.digest(),
            seconds,
            peak_memory,
            row: stage.row.clone(),
            set: overrides
                .filter(|(name, _)| stage.params.contains_key(*name))
                .map(|(name, value)| (name.clone(), value.clone()))
                .collect(),
            made_from,
            outputs,
        })
    }

    fn keep_summary(&self, stage: &Stage, stdout: &str) -> Result<(), PipelineError> {
        let path = self.place.stdout_of(&stage.name, &stage.key());
        fs::write(&path, stdout).map_err(PipelineError::io("write", path))
    }

    /// Sees that nothing stands where the stage has its outputs but what runs made; what does
    /// is moved aside, where that was asked for, or the stage has failed. What a run that was cut
    /// off may have made is always moved aside.
    pub(crate) fn make_room(
        &self,
        graph: &Graph<'_>,
        stage: &Stage,
        files: &[String],
        tell: &mut dyn FnMut(News),
    ) -> Result<Option<Failure>, PipelineError> {
        if let Some(cause) = self.behind_link(stage)? {
            return Ok(Some(self.failure(stage, files, cause, Vec::new(), None)));
        }
        let mut ledger = self.ledger();
        let keys = ledger.overlapping(stage);
        let unknown = own::unknown(stage, &keys, ledger.get(), &self.hasher)?;
        drop(ledger);
        let (foreign, unsure) = (unknown.foreign, unknown.unsure);
        if !foreign.is_empty() && !self.move_aside {
            let cause = FailureCause::Foreign { paths: foreign };
            return Ok(Some(self.failure(stage, files, cause, Vec::new(), None)));
        }
        if !foreign.is_empty() {
            tell(News::Warning(Warning::MovedAside {
                stage: stage.name.clone(),
                files: foreign.len(),
                folders: own::move_aside(&foreign, graph, &self.place.root)?,
            }));
        }
        if !unsure.is_empty() {
            tell(News::Warning(Warning::CutOff {
                stage: stage.name.clone(),
                files: unsure.len(),
                folders: own::move_aside(&unsure, graph, &self.place.root)?,
            }));
        }
        Ok(None)
    }

    /// The first output that is reached through a link and is not what the last run had left:
    /// whoever set the link may have other things there. Outputs may be kept behind links.
    fn behind_link(&self, stage: &Stage) -> Result<Option<FailureCause>, PipelineError> {
        let record = self.ledger().get().record_of(stage).cloned();
        for (path, made) in record.iter().flat_map(|record| &record.outputs) {
            let target = |above: &str| fs::read_link(self.place.root.join(above)).ok();
            let link = with_ancestors(path).find_map(|above| Some((above, target(above)?)));
            if let Some((link, target)) = link
                && self.hasher.content(path)?.is_some_and(|there| there != *made)
            {
                let (path, link) = (path.clone(), link.to_owned());
                return Ok(Some(FailureCause::BehindLink { path, link, target }));
            }
        }
        Ok(None)
    }

    /// Notes that a stage is about to make its outputs, and removes what it had made before, so
    /// that a stage that makes fewer files leaves no old ones among the new.
    pub(crate) fn begin(&self, stage: &Stage) -> Result<(), PipelineError> {
        let past = {
            let mut ledger = self.ledger();
            ledger.begin(stage)?;
            ledger.get().left.get(&stage.key()).cloned()
        };
        own::clear(stage, &past.unwrap_or_default(), &self.place.root)?;
        let stdout = self.place.stdout_of(&stage.name, &stage.key());
        own::remove(&stdout).map_err(PipelineError::io("remove the old", &stdout))
    }

    /// Notes which files a stage left that did not end well.
    pub(crate) fn leave(&self, stage: &Stage) -> Result<(), PipelineError> {
        self.leave_some(stage, |_| true)
    }

    /// The same of a stage that cannot have made anything in the outputs which `is_own` does not pick.
    pub(crate) fn leave_some(
        &self,
        stage: &Stage,
        is_own: impl Fn(&str) -> bool,
    ) -> Result<(), PipelineError> {
        let outputs = stage.outputs.iter().filter(|output| is_own(output));
        let files = self.hasher.names_in(outputs)?;
        self.ledger().leave(&stage.key(), files)
    }
}

/// An error with what led to it.
fn with_sources(error: &(dyn Error + 'static)) -> String {
    let errors = std::iter::successors(Some(error), |&error| error.source());
    let texts: Vec<String> = errors.map(ToString::to_string).collect();
    texts.join(": ")
}
