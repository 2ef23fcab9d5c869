//! The graph for Graphviz and for Mermaid.

use std::collections::{BTreeMap, BTreeSet};

use crate::Graph;

/// What is drawn: the stages, those of one fan-out as one.
struct Picture<'g> {
    pipeline: &'g str,
    /// In the order in which (the first of) the stages run.
    nodes: Vec<Node>,
}

struct Node {
    /// The stage; of a fan-out also how many there are.
    label: String,
    /// Numbers of the nodes whose files it reads, itself not among them.
    makers: BTreeSet<usize>,
}

impl<'g> Picture<'g> {
    fn new(graph: &'g Graph<'_>) -> Self {
        let mut numbers: BTreeMap<&str, usize> = BTreeMap::new();
        let mut members: Vec<Vec<usize>> = Vec::new();
        for &stage in graph.order() {
            let next = members.len();
            let number = *numbers.entry(&graph.stage(stage).family).or_insert(next);
            if number == next {
                members.push(Vec::new());
            }
            members[number].push(stage);
        }
        let node = |(number, stages): (usize, &Vec<usize>)| {
            let needs = stages.iter().flat_map(|&stage| graph.needs(stage));
            let makers = needs.map(|need| numbers[graph.stage(need.maker).family.as_str()]);
            let first = graph.stage(stages[0]);
            Node {
                label: match stages.len() {
                    1 => first.name.clone(),
                    many => format!("{} (x{many})", first.family),
                },
                makers: makers.filter(|&maker| maker != number).collect(),
            }
        };
        Self {
            pipeline: graph.pipeline().name(),
            nodes: members.iter().enumerate().map(node).collect(),
        }
    }

    /// Maker and user, each pair once.
    fn edges(&self) -> impl Iterator<Item = (usize, usize)> {
        let nodes = self.nodes.iter().enumerate();
        nodes.flat_map(|(user, node)| node.makers.iter().map(move |&maker| (maker, user)))
    }
}

impl Graph<'_> {
    /// The graph for Graphviz. Here and for Mermaid the stages of a fan-out are drawn as one.
    pub fn dot(&self) -> String {
        let picture = Picture::new(self);
        let label = |i: usize| &picture.nodes[i].label;
        let node = |node: &Node| format!("  \"{}\";\n", node.label);
        let edge = |(a, b)| format!("  \"{}\" -> \"{}\";\n", label(a), label(b));
        let nodes: String = picture.nodes.iter().map(node).collect();
        let edges: String = picture.edges().map(edge).collect();
        let name = picture.pipeline;
        format!("digraph \"{name}\" {{\n  rankdir=LR;\n  node [shape=box];\n{nodes}{edges}}}\n")
    }

    /// The graph for Mermaid, which Markdown viewers draw.
    pub fn mermaid(&self) -> String {
        let picture = Picture::new(self);
        // Ids of our own: Mermaid gives a meaning to words such as `end`.
        let node = |(i, node): (usize, &Node)| format!("  s{i}[\"{}\"]\n", node.label);
        let nodes: String = picture.nodes.iter().enumerate().map(node).collect();
        let edge = |(maker, user)| format!("  s{maker} --> s{user}\n");
        let edges: String = picture.edges().map(edge).collect();
        format!("flowchart LR\n{nodes}{edges}")
    }
}

#[cfg(test)]
mod tests {
    use crate::Graph;
    use crate::testing::{parsed, pipeline};

    #[test]
    fn both_forms_name_each_stage_and_what_it_waits_for() {
        let p = pipeline(&[("make", &[], &["a", "b"]), ("use", &["a", "b"], &["c"])]);
        let graph = Graph::new(&p).unwrap();
        assert_eq!(
            graph.dot(),
            "digraph \"test\" {\n  rankdir=LR;\n  node [shape=box];\n  \"make\";\n  \"use\";\n  \
             \"make\" -> \"use\";\n}\n"
        );
        assert_eq!(graph.mermaid(), "flowchart LR\n  s0[\"make\"]\n  s1[\"use\"]\n  s0 --> s1\n");
    }

    #[test]
    fn a_fan_out_is_drawn_as_one() {
        let text = "name = 'p'\n[[stage]]\nname = 'fit'\nmatrix = {i = [1, 2, 3]}\n\
                    cmd = ['x']\noutputs = ['out/{i}']\n\
                    [[stage]]\nname = 'join'\ncmd = ['x']\ninputs = ['out']\noutputs = ['all']\n";
        let p = parsed(text);
        let graph = Graph::new(&p).unwrap();
        assert_eq!(
            graph.mermaid(),
            "flowchart LR\n  s0[\"fit (x3)\"]\n  s1[\"join\"]\n  s0 --> s1\n"
        );
    }
}
