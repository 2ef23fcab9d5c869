//! The manuscript as a document of Word.

use super::Block;
use docx_rs::{
    AlignmentType, Docx, LineSpacing, Paragraph, Run, Style, StyleType, TableCell, TableRow,
    VertAlignType, WidthType,
};
use maveric_report::{
    ReportError,
    markup::{self, Level, escape},
    tables::{Align, Table},
};
use std::io::Cursor;

const TEXT: usize = 22;
const SMALL: usize = 16;
/// Twentieths of a point below a paragraph.
const BELOW: u32 = 120;
/// The width of the text, in fiftieths of a percent.
const WHOLE_WIDTH: usize = 5000;

/// Texts, then every table as wide as the text, then the references; its properties have title and authors.
pub(super) fn document(
    (title, authors): (&str, &[String]),
    texts: &[Block],
    tables: &[&Table],
    references: &[Block],
) -> Result<Vec<u8>, ReportError> {
    let heading = |id: &str, name: &str, size: usize, level: usize| {
        Style::new(id, StyleType::Paragraph).name(name).size(size).bold().outline_lvl(level)
    };
    let mut document = Docx::new()
        .add_style(heading("Heading1", "heading 1", 32, 0))
        .add_style(heading("Heading2", "heading 2", 26, 1));
    for block in texts {
        document = document.add_paragraph(paragraph_of(block));
    }
    for table in tables.iter().filter(|table| !table.rows.is_empty()) {
        document = document
            .add_paragraph(Paragraph::new())
            .add_paragraph(marked(&table.title, TEXT).keep_next(true))
            .add_table(table_of(table));
        for note in &table.notes {
            document = document.add_paragraph(marked(note, SMALL));
        }
    }
    for block in references {
        document = document.add_paragraph(paragraph_of(block));
    }
    let mut bytes = Cursor::new(Vec::new());
    let mut document = document.build();
    document.doc_props.core = properties(title, authors).into_bytes();
    document
        .pack(&mut bytes)
        .map_err(|e| ReportError::Template { reason: format!("manuscript.docx: {e}") })?;
    Ok(bytes.into_inner())
}

/// What a program that is given the document reads of it. It is of no day: the same study has the same bytes.
fn properties(title: &str, authors: &[String]) -> String {
    let creator = authors.join("; ");
    let element = |name: &str, text: &str| format!("<dc:{name}>{}</dc:{name}>", escape(text));
    let author = (!creator.is_empty()).then(|| element("creator", &creator));
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\"?>\n\
         <cp:coreProperties xmlns:cp=\"http://schemas.openxmlformats.org/package/2006/metadata/core-properties\" \
         xmlns:dc=\"http://purl.org/dc/elements/1.1/\">{}{}</cp:coreProperties>",
        element("title", title),
        author.unwrap_or_default()
    )
}

fn paragraph_of(block: &Block) -> Paragraph {
    match block {
        Block::Heading(level, text) => marked(text, 0)
            .style(&format!("Heading{level}"))
            .line_spacing(LineSpacing::new().before(2 * BELOW).after(BELOW))
            .keep_next(true),
        Block::Paragraph(text) => marked(text, TEXT).line_spacing(LineSpacing::new().after(BELOW)),
    }
}

/// A paragraph of runs; of size 0 it has that of its style.
fn marked(text: &str, size: usize) -> Paragraph {
    markup::runs(text).into_iter().fold(Paragraph::new(), |paragraph, part| {
        let mut run = Run::new().add_text(part.text);
        if size > 0 {
            run = run.size(size);
        }
        if part.italic {
            run = run.italic();
        }
        let align = match part.level {
            Level::Line => None,
            Level::Lowered => Some(VertAlignType::SubScript),
            Level::Raised => Some(VertAlignType::SuperScript),
        };
        if let Some(align) = align {
            run.run_property = run.run_property.vert_align(align);
        }
        paragraph.add_run(run)
    })
}

fn table_of(table: &Table) -> docx_rs::Table {
    let row = |cells: Vec<String>| {
        let cells = cells.iter().zip(&table.columns).map(|(text, column)| {
            let side = match column.align {
                Align::Left => AlignmentType::Left,
                Align::Right => AlignmentType::Right,
            };
            TableCell::new().add_paragraph(marked(text, SMALL).align(side))
        });
        TableRow::new(cells.collect())
    };
    let heads = table.columns.iter().map(|column| column.header.clone());
    let rows = std::iter::once(heads.collect::<Vec<String>>()).chain(table.shown());
    docx_rs::Table::new(rows.map(row).collect()).width(WHOLE_WIDTH, WidthType::Pct)
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_report::tables::Cell;

    fn packed() -> Vec<u8> {
        let table = Table::of("t", "Speed & *M*", [1.5])
            .right("*M*_{a}", |v| Cell::number(Some(*v), 2))
            .noted("A <note>.");
        let texts =
            [Block::Heading(1, "Method".to_owned()), Block::Paragraph("*p* < .001".to_owned())];
        let authors = ["A. Author".to_owned(), "B. Author".to_owned()];
        document(("Calm & sporty", &authors), &texts, &[&table], &[]).unwrap()
    }

    #[test]
    fn the_same_manuscript_has_the_same_bytes() {
        assert_eq!(packed(), packed());
    }

    #[test]
    fn the_properties_have_title_and_authors_and_no_day() {
        let authors = ["A. Author".to_owned(), "B. Author".to_owned()];
        let core = properties("Calm & sporty", &authors);
        assert!(
            core.contains("<dc:title>Calm &amp; sporty</dc:title>")
                && core.contains("<dc:creator>A. Author; B. Author</dc:creator>"),
            "{core}"
        );
        assert!(!core.contains("1970"), "{core}");
        assert!(!properties("Calm", &[]).contains("creator"));
    }

    #[test]
    fn headings_marks_and_tables_are_those_of_the_text() {
        let bytes = packed();
        let read = docx_rs::read_docx(&bytes).unwrap().json();
        for part in ["Method", "Heading1", "1.50", "A <note>.", "subscript"] {
            assert!(read.contains(part), "{part} in {read}");
        }
        assert!(read.contains("\"width\": 5000") && read.contains("pct"), "{read}");
    }
}
