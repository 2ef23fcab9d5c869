//! Which stage waits for which, and in what order they run.

use std::collections::{BTreeMap, BTreeSet};

use crate::error::{CycleStep, PipelineError, nearest};
use crate::paths::{below, normalise, with_ancestors};
use crate::{Pipeline, Place, Stage};

/// A pipeline whose stages have an order: no circle, and one maker for each file.
///
/// Stages are numbered as in [`Pipeline::stages`].
#[derive(Debug)]
pub struct Graph<'p> {
    pipeline: &'p Pipeline,
    makers: BTreeMap<String, usize>,
    needs: Vec<Vec<Need>>,
    users: Vec<BTreeSet<usize>>,
    order: Vec<usize>,
}

/// That a stage reads `input`, which stage `maker` makes, whole or in part.
#[derive(Debug, Clone)]
pub(crate) struct Need {
    pub(crate) input: String,
    pub(crate) maker: usize,
}

impl<'p> Graph<'p> {
    /// Finds who makes what each stage reads. Looks at no file.
    ///
    /// An input is made by the stage that has it, or a directory above it, among its
    /// outputs; a directory is also made by every stage with an output inside.
    ///
    /// # Errors
    /// [`PipelineError::TwoMakers`] if outputs of two stages are the same or lie in one
    /// another, [`PipelineError::Cycle`] if stages wait for each other.
    pub fn new(pipeline: &'p Pipeline) -> Result<Self, PipelineError> {
        let stages = pipeline.stages();
        let makers = makers(stages)?;
        let needs: Vec<Vec<Need>> = stages.iter().map(|s| needs(s, &makers)).collect();
        let mut users = vec![BTreeSet::new(); stages.len()];
        for (user, needs) in needs.iter().enumerate() {
            for need in needs {
                users[need.maker].insert(user);
            }
        }
        let order = order(stages, &needs, &users)?;
        Ok(Self { pipeline, makers, needs, users, order })
    }

    /// The stages so that each comes after all that it needs, otherwise as in the file.
    pub fn ordered(&self) -> impl Iterator<Item = &'p Stage> {
        self.order.iter().map(|&i| self.stage(i))
    }

    pub(crate) fn pipeline(&self) -> &'p Pipeline {
        self.pipeline
    }

    pub(crate) fn order(&self) -> &[usize] {
        &self.order
    }

    pub(crate) fn stage(&self, index: usize) -> &'p Stage {
        &self.pipeline.stages()[index]
    }

    pub(crate) fn needs(&self, index: usize) -> &[Need] {
        &self.needs[index]
    }

    /// The stages that a stage waits for.
    pub(crate) fn makers(&self, index: usize) -> BTreeSet<usize> {
        self.needs[index].iter().map(|need| need.maker).collect()
    }

    pub(crate) fn users(&self, index: usize) -> &BTreeSet<usize> {
        &self.users[index]
    }

    /// The stages that the targets name, without what is upstream; none for no targets.
    ///
    /// A target is a stage, all stages of a fan-out, a file that a stage makes, or a directory in which stages make
    /// files.
    pub(crate) fn named(&self, targets: &[String]) -> Result<BTreeSet<usize>, PipelineError> {
        let mut named = BTreeSet::new();
        for target in targets {
            let mut matches: BTreeSet<usize> = (0..self.users.len())
                .filter(|&i| self.stage(i).name == *target || self.stage(i).family == *target)
                .collect();
            if let (true, Some(path)) = (matches.is_empty(), normalise(target)) {
                matches.extend(with_ancestors(&path).find_map(|above| self.makers.get(above)));
                matches.extend(below(&self.makers, &path).map(|(_, maker)| maker));
            }
            if matches.is_empty() {
                let stages = self.pipeline.stages().iter().map(|s| s.name.as_str());
                let outputs = self.makers.keys().map(String::as_str);
                return Err(PipelineError::UnknownTarget {
                    target: target.clone(),
                    pipeline: self.pipeline.name().to_owned(),
                    nearest: nearest(target, stages.chain(outputs)),
                });
            }
            named.extend(matches);
        }
        Ok(named)
    }

    /// The targets and everything upstream; all stages for no targets.
    pub(crate) fn wanted(&self, targets: &[String]) -> Result<BTreeSet<usize>, PipelineError> {
        if targets.is_empty() {
            return Ok((0..self.users.len()).collect());
        }
        let mut wanted = BTreeSet::new();
        let mut open: Vec<usize> = self.named(targets)?.into_iter().collect();
        while let Some(index) = open.pop() {
            if wanted.insert(index) {
                open.extend(self.needs[index].iter().map(|need| need.maker));
            }
        }
        Ok(wanted)
    }

    /// Refuses wanted stages with an input that is not there and that nobody makes.
    pub(crate) fn check_sources(
        &self,
        wanted: &BTreeSet<usize>,
        place: &Place,
    ) -> Result<(), PipelineError> {
        for &index in wanted {
            let stage = self.stage(index);
            let made_inputs: BTreeSet<&str> =
                self.needs[index].iter().map(|n| n.input.as_str()).collect();
            let missing =
                |input: &&str| !made_inputs.contains(input) && !place.root.join(input).exists();
            if let Some(input) = stage.reads().find(missing) {
                return Err(PipelineError::MissingInput {
                    stage: stage.name.clone(),
                    input: input.to_owned(),
                    nearest: nearest(input, self.makers.keys().map(String::as_str)),
                    help: stage.inputs_help.clone(),
                });
            }
        }
        Ok(())
    }
}

fn makers(stages: &[Stage]) -> Result<BTreeMap<String, usize>, PipelineError> {
    let mut makers = BTreeMap::new();
    let two_makers = |path: &str, a: usize, b: usize| PipelineError::TwoMakers {
        path: path.to_owned(),
        first: stages[a.min(b)].name.clone(),
        second: stages[a.max(b)].name.clone(),
    };
    for (index, stage) in stages.iter().enumerate() {
        for output in &stage.outputs {
            if let Some(other) = makers.insert(output.clone(), index) {
                return Err(two_makers(output, other, index));
            }
        }
    }
    for (output, &index) in &makers {
        let above = with_ancestors(output).skip(1);
        if let Some(&other) = above.filter_map(|path| makers.get(path)).find(|&&i| i != index) {
            return Err(two_makers(output, other, index));
        }
    }
    Ok(makers)
}

fn needs(stage: &Stage, makers: &BTreeMap<String, usize>) -> Vec<Need> {
    let mut needs = Vec::new();
    for input in stage.reads() {
        let above = with_ancestors(input).find_map(|path| makers.get(path));
        let inside = below(makers, input).map(|(_, maker)| maker);
        let maker_indices: BTreeSet<usize> = above.into_iter().chain(inside).copied().collect();
        needs
            .extend(maker_indices.into_iter().map(|maker| Need { input: input.to_owned(), maker }));
    }
    needs
}

/// Kahn's order, the earliest stage of the file first among those that could come next.
fn order(
    stages: &[Stage],
    needs: &[Vec<Need>],
    users: &[BTreeSet<usize>],
) -> Result<Vec<usize>, PipelineError> {
    let makers_of = |i: usize| needs[i].iter().map(|n| n.maker).collect::<BTreeSet<_>>();
    let mut waiting: Vec<usize> = (0..stages.len()).map(|i| makers_of(i).len()).collect();
    let mut ready: BTreeSet<usize> = (0..stages.len()).filter(|&i| waiting[i] == 0).collect();
    let mut order = Vec::with_capacity(stages.len());
    while let Some(next) = ready.pop_first() {
        order.push(next);
        for &user in &users[next] {
            waiting[user] -= 1;
            if waiting[user] == 0 {
                ready.insert(user);
            }
        }
    }
    if order.len() == stages.len() {
        return Ok(order);
    }
    let stuck: BTreeSet<usize> = (0..stages.len()).filter(|&i| waiting[i] > 0).collect();
    Err(PipelineError::Cycle { steps: circle(stages, needs, &stuck) })
}

/// Walks upstream among stages that all wait until one comes round again.
fn circle(stages: &[Stage], needs: &[Vec<Need>], stuck: &BTreeSet<usize>) -> Vec<CycleStep> {
    let mut walked: Vec<(usize, &Need)> = Vec::new();
    let mut current = stuck.first().copied();
    while let Some(stage) = current {
        if let Some(start) = walked.iter().position(|(seen, _)| *seen == stage) {
            walked.drain(..start);
            break;
        }
        let next = needs[stage].iter().find(|need| stuck.contains(&need.maker));
        walked.extend(next.map(|need| (stage, need)));
        current = next.map(|need| need.maker);
    }
    let step = |(stage, need): (usize, &Need)| CycleStep {
        stage: stages[stage].name.clone(),
        file: need.input.clone(),
        maker: stages[need.maker].name.clone(),
    };
    walked.into_iter().map(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{parsed, pipeline};

    fn names<'a>(stages: impl IntoIterator<Item = &'a Stage>) -> Vec<&'a str> {
        stages.into_iter().map(|s| s.name.as_str()).collect()
    }

    /// The stages that the one of this place in the file waits for.
    fn before<'a>(graph: &Graph<'a>, place: usize) -> Vec<&'a str> {
        names(graph.makers(place).into_iter().map(|maker| graph.stage(maker)))
    }

    #[test]
    fn stages_run_after_what_they_need_and_otherwise_in_the_order_of_the_file() {
        let p = pipeline(&[
            ("c", &["b.txt", "a.txt"], &["c.txt"]),
            ("b", &["a.txt"], &["b.txt"]),
            ("z", &[], &["z.txt"]),
            ("a", &[], &["a.txt"]),
        ]);
        let graph = Graph::new(&p).unwrap();
        assert_eq!(names(graph.ordered()), ["z", "a", "b", "c"]);
        assert_eq!(before(&graph, 0), ["b", "a"]);
    }

    #[test]
    fn a_file_in_an_output_directory_is_made_by_its_stage() {
        let p = pipeline(&[
            ("drives", &[], &["out/drives"]),
            ("first", &["out/drives/one.csv"], &["one.txt"]),
            ("all", &["out"], &["all.txt"]),
        ]);
        let graph = Graph::new(&p).unwrap();
        assert_eq!(before(&graph, 1), ["drives"]);
        assert_eq!(before(&graph, 2), ["drives"]);
    }

    #[test]
    fn a_circle_is_printed_and_nothing_else() {
        let p = pipeline(&[
            ("after", &["a.txt"], &["after.txt"]),
            ("a", &["c.txt"], &["a.txt"]),
            ("b", &["a.txt"], &["b.txt"]),
            ("c", &["b.txt"], &["c.txt"]),
        ]);
        assert_eq!(
            Graph::new(&p).unwrap_err().to_string(),
            "stages wait for each other in a circle: `a` needs `c.txt` from `c`, \
             `c` needs `b.txt` from `b`, `b` needs `a.txt` from `a`"
        );
    }

    #[test]
    fn two_stages_cannot_make_one_file_or_write_into_the_others_directory() {
        for outputs in [["x", "x"], ["x", "x/y"], ["x/y/z", "x"]] {
            let p = pipeline(&[("a", &[], &outputs[..1]), ("b", &[], &outputs[1..])]);
            let error = Graph::new(&p).unwrap_err();
            assert!(matches!(error, PipelineError::TwoMakers { .. }), "{error}");
        }
    }

    #[test]
    fn a_target_brings_everything_upstream_and_nothing_else() {
        let p = pipeline(&[
            ("a", &[], &["out/a"]),
            ("b", &["out/a"], &["out/b"]),
            ("c", &["out/b"], &["c"]),
        ]);
        let graph = Graph::new(&p).unwrap();
        let wanted = |target: &str| graph.wanted(&[target.to_owned()]);
        assert_eq!(wanted("b").unwrap(), BTreeSet::from([0, 1]));
        assert_eq!(wanted("out/a/x.csv").unwrap(), BTreeSet::from([0]));
        assert_eq!(wanted("out").unwrap(), BTreeSet::from([0, 1]));
        let error = wanted("out/bb").unwrap_err();
        assert_eq!(error.suggestion().as_deref(), Some("did you mean `out/b`?"));
    }

    #[test]
    fn ten_thousand_stages_are_ordered() {
        let table = |i: usize| {
            let input = (!i.is_multiple_of(100)).then(|| format!("out/{}.txt", i - 1));
            let inputs: Vec<String> = input.into_iter().collect();
            format!(
                "[[stage]]\nname = 's{i}'\ncmd = ['x']\ninputs = {inputs:?}\n\
                 outputs = ['out/{i}.txt']\n"
            )
        };
        let tables: String = (0..10_000).map(table).collect();
        let p = parsed(&format!("name = 'p'\n{tables}"));
        assert_eq!(Graph::new(&p).unwrap().order().len(), 10_000);
    }
}
