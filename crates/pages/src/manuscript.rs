//! What a paper is written from, as files: text in LaTeX, Markdown and Word, numbers as macros, references.

mod docx;
mod numbers;
mod references;

pub(crate) use references::Reference;

use maveric_report::{
    Report, ReportError,
    html::RenderedFile,
    markup,
    tables::{Table, latex, markdown},
};

/// A part of a text, with marks.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Block {
    /// Level 1 or 2, and the heading.
    Heading(u8, String),
    Paragraph(String),
}

/// The texts of a manuscript.
#[derive(Debug, Default)]
pub(crate) struct Manuscript {
    pub(crate) title: String,
    pub(crate) authors: Vec<String>,
    pub(crate) methods: Vec<Block>,
    pub(crate) results: Vec<Block>,
    pub(crate) references: Vec<Reference>,
}

impl Manuscript {
    /// The files below `manuscript/`, with the numbers and tables of the page.
    pub(crate) fn files(&self, report: &Report) -> Result<Vec<RenderedFile>, ReportError> {
        let tables = report.all_sections().flat_map(|section| &section.tables);
        let named = numbers::numbers(&report.cards, tables);
        let listed = references::listed(&self.references);
        let method = [&self.methods[..], &listed].concat();
        let cited = references::cited(&self.references);
        let file =
            |name: &str, bytes: Vec<u8>| RenderedFile { path: format!("manuscript/{name}"), bytes };
        let whole = [&self.methods[..], &self.results].concat();
        let tables = report.sections.iter().flat_map(|section| &section.tables);
        let tables: Vec<&Table> = tables.collect();
        Ok(vec![
            file("numbers.tex", numbers::tex(&named).into_bytes()),
            file("numbers.csv", numbers::csv(&named).into_bytes()),
            file("results.tex", in_latex(&self.results).into_bytes()),
            file("results.md", in_markdown(&self.results).into_bytes()),
            file("methods.tex", (in_latex(&self.methods) + &cited).into_bytes()),
            file("methods.md", in_markdown(&method).into_bytes()),
            file(
                "manuscript.docx",
                docx::document((&self.title, &self.authors), &whole, &tables, &listed)?,
            ),
            file("references.bib", references::bib(&self.references).into_bytes()),
        ])
    }
}

fn in_latex(blocks: &[Block]) -> String {
    let block = |block: &Block| match block {
        Block::Heading(1, text) => format!("\\section{{{}}}\n\n", latex(text)),
        Block::Heading(_, text) => format!("\\subsection{{{}}}\n\n", latex(text)),
        Block::Paragraph(text) => format!("{}\n\n", latex(text)),
    };
    blocks.iter().map(block).collect()
}

fn in_markdown(blocks: &[Block]) -> String {
    let block = |block: &Block| match block {
        Block::Heading(level, text) => {
            format!("{} {}\n\n", "#".repeat(usize::from(*level)), markdown(text))
        }
        Block::Paragraph(text) => format!("{}\n\n", markdown(text)),
    };
    blocks.iter().map(block).collect()
}

/// A text as a paragraph that means itself, whatever stands in it.
fn plainly(text: &str) -> Block {
    Block::Paragraph(markup::literal(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_text_is_headed_and_marked_in_latex_and_markdown_and_a_p_stays_a_p() {
        let blocks = [
            Block::Heading(2, "My *Scale*".to_owned()),
            Block::Paragraph("*t*(3) = 1.20, *p* < .001".to_owned()),
        ];
        assert_eq!(
            in_latex(&blocks),
            "\\subsection{My \\textit{Scale}}\n\n\\textit{t}(3) = 1.20, \\textit{p} \\textless{} .001\n\n"
        );
        assert_eq!(in_markdown(&blocks), "## My *Scale*\n\n*t*(3) = 1.20, *p* < .001\n\n");
    }
}
