//! The graph as text, DOT, Mermaid and SVG.

mod svg;

use std::collections::BTreeSet;

use crate::Graph;

impl Graph<'_> {
    /// A line a stage, in the order in which they run, with the stages that it waits for.
    pub fn text(&self) -> String {
        let width = self.ordered().map(|s| s.name.len()).max().unwrap_or(0);
        let line = |&user: &usize| {
            let name = &self.stage(user).name;
            let makers: Vec<&str> = self.makers_of(user).map(|i| self.name(i)).collect();
            if makers.is_empty() {
                format!("{name}\n")
            } else {
                format!("{name:width$}  <- {}\n", makers.join(", "))
            }
        };
        self.order().iter().map(line).collect()
    }

    /// The graph for Graphviz.
    pub fn dot(&self) -> String {
        let node = |&i: &usize| format!("  \"{}\";\n", self.name(i));
        let edge = |(a, b)| format!("  \"{}\" -> \"{}\";\n", self.name(a), self.name(b));
        let nodes: String = self.order().iter().map(node).collect();
        let edges: String = self.edges().map(edge).collect();
        let name = self.pipeline().name();
        format!("digraph \"{name}\" {{\n  rankdir=LR;\n  node [shape=box];\n{nodes}{edges}}}\n")
    }

    /// The graph for Mermaid, which Markdown viewers draw.
    pub fn mermaid(&self) -> String {
        // Ids of our own: Mermaid gives a meaning to words such as `end`.
        let node = |&i: &usize| format!("  s{i}[\"{}\"]\n", self.name(i));
        let nodes: String = self.order().iter().map(node).collect();
        let edge = |(maker, user)| format!("  s{maker} --> s{user}\n");
        let edges: String = self.edges().map(edge).collect();
        format!("flowchart LR\n{nodes}{edges}")
    }

    /// The graph as a picture of its own, stages left of what needs them.
    pub fn svg(&self) -> String {
        svg::draw(self)
    }

    fn name(&self, stage: usize) -> &str {
        &self.stage(stage).name
    }

    fn makers_of(&self, stage: usize) -> impl Iterator<Item = usize> {
        let makers: BTreeSet<usize> = self.needs(stage).iter().map(|n| n.maker).collect();
        makers.into_iter()
    }

    /// Maker and user, each pair once, in the order in which the users run.
    fn edges(&self) -> impl Iterator<Item = (usize, usize)> {
        let order = self.order().iter();
        order.flat_map(|&user| self.makers_of(user).map(move |maker| (maker, user)))
    }
}

#[cfg(test)]
mod tests {
    use crate::Graph;
    use crate::testing::pipeline;

    #[test]
    fn the_graph_reads_the_same_in_each_form() {
        let p = pipeline(&[("make", &[], &["a", "b"]), ("use", &["a", "b"], &["c"])]);
        let graph = Graph::new(&p).unwrap();
        assert_eq!(graph.text(), "make\nuse   <- make\n");
        assert_eq!(
            graph.dot(),
            "digraph \"test\" {\n  rankdir=LR;\n  node [shape=box];\n  \"make\";\n  \"use\";\n  \
             \"make\" -> \"use\";\n}\n"
        );
        assert_eq!(
            graph.mermaid(),
            "flowchart LR\n  s0[\"make\"]\n  s1[\"use\"]\n  s0 --> s1\n"
        );
        let svg = graph.svg();
        assert_eq!(svg.matches("<rect").count(), 2);
        assert_eq!(
            svg.matches("<path").count(),
            1 + 1,
            "an edge and the arrow head"
        );
    }
}
