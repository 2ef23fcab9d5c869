//! A table as CSV, Markdown, LaTeX and HTML.

use super::table::{Align, Cell, Column, Table};
use crate::markup::{self, Level};
use std::fmt::Write as _;

impl Table {
    /// Comma-separated values (RFC 4180), numbers in full precision, missing cells empty; of the table for machines where there is one.
    pub fn to_csv(&self) -> String {
        let shown = || self.columns.iter().map(|c| markup::plain(&c.header));
        let (heads, rows) = match &self.data {
            Some(data) => (data.heads.clone(), &data.rows),
            None => (shown().collect(), &self.rows),
        };
        let heads: Vec<String> = heads.iter().map(|head| csv_field(head)).collect();
        let mut out = heads.join(",") + "\r\n";
        for row in rows {
            let fields = row.iter().map(|cell| match cell {
                Cell::Number { value, .. } | Cell::Bounded { value, .. } => format!("{value}"),
                Cell::P(p) => format!("{p}"),
                Cell::Missing => String::new(),
                Cell::Text(text) => csv_field(text),
                Cell::Marked(text) => csv_field(&markup::plain(text)),
            });
            out.push_str(&fields.collect::<Vec<_>>().join(","));
            out.push_str("\r\n");
        }
        out
    }

    /// Aligned columns for a terminal: title, rows and notes; without rows no header.
    pub fn to_text(&self) -> String {
        let (heads, rows) = self.written(markup::plain);
        let rows: Vec<Vec<String>> = std::iter::once(heads).chain(rows).collect();
        let width = |j: usize| {
            let cells = rows.iter().filter_map(|row| row.get(j));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.columns.len()).map(width).collect();
        let mut out = format!("{}\n", markup::plain(&self.title));
        for row in rows.iter().filter(|_| !self.rows.is_empty()) {
            let mut line = String::new();
            for ((cell, width), column) in row.iter().zip(&widths).zip(&self.columns) {
                line.push_str(if line.is_empty() { "  " } else { "   " });
                let padding = " ".repeat(width - cell.chars().count());
                if column.align == Align::Right {
                    line.push_str(&padding);
                }
                line.push_str(cell);
                if column.align == Align::Left {
                    line.push_str(&padding);
                }
            }
            let _ = writeln!(out, "{}", line.trim_end());
        }
        for note in &self.notes {
            let _ = writeln!(out, "  {}", markup::plain(note));
        }
        out
    }

    /// A pipe table of GitHub's Markdown, with title and notes; without rows these alone.
    pub fn to_markdown(&self) -> String {
        let mut out = format!("**{}**\n\n", markdown(&self.title));
        let line = |cells: Vec<String>| {
            if cells.is_empty() {
                return String::new();
            }
            format!("| {} |\n", cells.join(" | "))
        };
        let (heads, rows) = self.written(markdown);
        out += &line(heads);
        let rule = |align| if align == Align::Right { "--:" } else { ":--" }.to_owned();
        out += &line(self.columns.iter().map(|column| rule(column.align)).collect());
        for row in rows {
            out += &line(row);
        }
        for note in &self.notes {
            let _ = write!(out, "\n{}\n", markdown(note));
        }
        out
    }

    /// A LaTeX `table` with `booktabs` rules, as wide as the text. Needs `\usepackage{booktabs,tabularx}`.
    pub fn to_latex(&self) -> String {
        // Words share what the numbers leave of the page's width.
        let words = ">{\\raggedright\\arraybackslash}X";
        let words_or_numbers = |(at, column): (usize, &Column)| match column.align {
            Align::Left => words,
            Align::Right if at == 0 => words,
            Align::Right => "r",
        };
        let columns: String = self.columns.iter().enumerate().map(words_or_numbers).collect();
        let small = if self.columns.len() > 6 {
            "\\footnotesize\n\\setlength{\\tabcolsep}{3pt}\n"
        } else {
            ""
        };
        let line = |cells: Vec<String>| format!("{} \\\\\n", cells.join(" & "));
        let mut out = format!(
            "\\begin{{table}}\n\\centering\n\\caption{{{}}}\n\\label{{tab:{}}}\n{small}\\begin{{tabularx}}{{\\linewidth}}{{{columns}}}\n\\toprule\n",
            latex(&self.title),
            self.name
        );
        let (heads, rows) = self.written(latex);
        out += &line(heads);
        out += "\\midrule\n";
        for row in rows {
            out += &line(row);
        }
        out += "\\bottomrule\n\\end{tabularx}\n";
        for note in &self.notes {
            let _ = writeln!(out, "\\par\\smallskip\\footnotesize {}", latex(note));
        }
        out += "\\end{table}\n";
        out
    }

    /// Heads and rows as shown, in another writing than our marks.
    fn written(&self, write: fn(&str) -> String) -> (Vec<String>, Vec<Vec<String>>) {
        let heads = self.columns.iter().map(|column| write(&column.header));
        let cells = |row: Vec<String>| row.iter().map(|cell| write(cell)).collect();
        let rows = self.shown().into_iter().map(cells);
        (heads.collect(), rows.collect())
    }

    /// An HTML `table` with caption and notes; everything escaped.
    pub fn to_html(&self) -> String {
        let side = |align| {
            if align == Align::Right { " class=\"number\"" } else { "" }
        };
        let title = markup::html(&self.title);
        let mut out =
            format!("<table id=\"table-{}\">\n<caption>{title}</caption>\n<thead><tr>", self.name);
        for column in &self.columns {
            let header = markup::html(&column.header);
            let _ = write!(out, "<th scope=\"col\"{}>{header}</th>", side(column.align));
        }
        out += "</tr></thead>\n<tbody>\n";
        for (row, shown) in self.rows.iter().zip(self.shown()) {
            out += "<tr>";
            let cells = row.iter().zip(&shown).zip(&self.columns);
            for (index, ((cell, shown), column)) in cells.enumerate() {
                let mut text = markup::html(shown);
                if matches!(cell, Cell::Text(_)) {
                    // A name written from right to left leaves the rest of the row alone.
                    text = format!("<bdi>{text}</bdi>");
                }
                let side = side(column.align);
                let _ = if index == 0 {
                    write!(out, "<th scope=\"row\"{side}>{text}</th>")
                } else {
                    write!(out, "<td{side}>{text}</td>")
                };
            }
            out += "</tr>\n";
        }
        out += "</tbody>\n</table>\n";
        for note in &self.notes {
            let _ = writeln!(out, "<p class=\"note\">{}</p>", markup::html(note));
        }
        out
    }
}

fn csv_field(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) || text.starts_with(' ') || text.ends_with(' ') {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// A text with marks as GitHub's Markdown.
pub fn markdown(marked: &str) -> String {
    let mut out = String::new();
    for run in markup::runs(marked) {
        let mut text = String::new();
        let mut signs = run.text.chars().peekable();
        while let Some(sign) = signs.next() {
            match sign {
                '\n' | '\r' => text.push(' '),
                // Before a space `<` is text; before a letter it would open an element.
                '<' if signs.peek().is_none_or(|next| next.is_whitespace()) => text.push(sign),
                '<' | '>' | '&' | '|' | '*' | '_' | '`' | '[' | ']' | '\\' | '~' => {
                    text.push('\\');
                    text.push(sign);
                }
                _ => text.push(sign),
            }
        }
        if run.italic && !text.trim().is_empty() {
            text = format!("*{text}*");
        }
        let text = match run.level {
            Level::Line => text,
            Level::Lowered => format!("<sub>{text}</sub>"),
            Level::Raised => format!("<sup>{text}</sup>"),
        };
        out.push_str(&text);
    }
    out
}

/// A text with marks as LaTeX.
pub fn latex(marked: &str) -> String {
    let mut out = String::new();
    for run in markup::runs(marked) {
        let mut text: String = run.text.chars().map(latex_sign).collect();
        if run.italic {
            text = format!("\\textit{{{text}}}");
        }
        let text = match run.level {
            Level::Line => text,
            Level::Lowered => format!("\\textsubscript{{{text}}}"),
            Level::Raised => format!("\\textsuperscript{{{text}}}"),
        };
        out.push_str(&text);
    }
    out
}

/// Signs that pdfLaTeX does not take as they are.
fn latex_sign(sign: char) -> String {
    let known = match sign {
        '\\' => "\\textbackslash{}",
        '~' => "\\textasciitilde{}",
        '^' => "\\textasciicircum{}",
        '<' => "\\textless{}",
        '>' => "\\textgreater{}",
        '−' => "$-$",
        '×' => "$\\times$",
        '±' => "$\\pm$",
        '≤' => "$\\leq$",
        '≥' => "$\\geq$",
        '→' => "$\\rightarrow$",
        'α' => "$\\alpha$",
        'δ' => "$\\delta$",
        'ε' => "$\\varepsilon$",
        'η' => "$\\eta$",
        'κ' => "$\\kappa$",
        'ρ' => "$\\rho$",
        'τ' => "$\\tau$",
        '∞' => "$\\infty$",
        '†' => "\\textdagger{}",
        'χ' => "$\\chi$",
        'ω' => "$\\omega$",
        '²' => "\\textsuperscript{2}",
        '°' => "\\textdegree{}",
        '\n' | '\r' => " ",
        '&' | '%' | '$' | '#' | '_' | '{' | '}' => return format!("\\{sign}"),
        _ => return sign.to_string(),
    };
    known.to_owned()
}

#[cfg(test)]
mod tests {
    use super::super::table::Data;
    use super::*;
    use crate::error::ReportError;

    const NASTY: &str = "<b>\"A & B\"</b>, 50 % _x_ $y$ | *z* \\ {#}";

    fn table() -> Table {
        Table {
            name: "nasty".into(),
            title: "*η*^{2} & more".into(),
            columns: vec![Column::left("Who"), Column::right("*r*")],
            rows: vec![
                vec![Cell::text(NASTY), Cell::bounded(Some(-0.456_789), 2)],
                vec![Cell::text("=1+1"), Cell::Missing],
            ],
            notes: vec!["Note.".into()],
            data: None,
        }
    }

    #[test]
    fn html_shows_a_nasty_name_and_runs_none_of_it() {
        let html = table().to_html();
        assert!(
            html.contains("&lt;b&gt;&quot;A &amp; B&quot;&lt;/b&gt;, 50 % _x_ $y$ | *z* \\ {#}")
        );
        assert!(!html.contains("<b>"));
        assert!(html.contains("<i>η</i><sup>2</sup> &amp; more"));
        assert!(html.contains("<td class=\"number\">−.46</td>"));
    }

    #[test]
    fn csv_keeps_the_name_and_the_whole_number() {
        let csv = table().to_csv();
        let mut lines = csv.split("\r\n");
        assert_eq!(lines.next(), Some("Who,r"));
        assert_eq!(
            lines.next(),
            Some("\"<b>\"\"A & B\"\"</b>, 50 % _x_ $y$ | *z* \\ {#}\",-0.456789")
        );
        assert_eq!(lines.next(), Some("=1+1,"));
    }

    #[test]
    fn csv_is_the_table_for_machines_where_there_is_one() {
        let mut table = table();
        table.data = Some(Data {
            heads: vec!["who".into(), "r".into(), "p".into()],
            ids: vec!["eve".into()],
            rows: vec![vec![Cell::text("eve"), Cell::bounded(Some(0.5), 2), Cell::P(0.0004)]],
            units: Vec::new(),
        });
        assert_eq!(table.to_csv(), "who,r,p\r\neve,0.5,0.0004\r\n");
        assert!(table.to_markdown().contains("| Who |"));
        table.data.as_mut().unwrap().rows[0].pop();
        assert!(table.check().is_err());
    }

    #[test]
    fn a_p_below_a_bound_stays_as_it_is_written() {
        assert_eq!(markdown("*p* < .001 & <b>"), "*p* < .001 \\& \\<b\\>");
    }

    #[test]
    fn text_lines_up_whatever_the_letters() {
        let mut table = table();
        table.columns = vec![Column::left(""), Column::right("*p*_{Holm}")];
        table.rows = vec![
            vec![Cell::text("été"), Cell::text(".012")],
            vec![Cell::text("mimic"), Cell::text("−12.25")],
        ];
        table.notes = vec!["*W* = .57".to_owned()];
        let text = table.to_text();
        let lines: Vec<&str> = text.lines().skip(1).collect();
        assert_eq!(
            lines,
            ["          p_Holm", "  été       .012", "  mimic   −12.25", "  W = .57"]
        );
        table.rows.clear();
        assert_eq!(table.to_text().lines().count(), 2);
    }

    #[test]
    fn markdown_keeps_its_columns() {
        let markdown = table().to_markdown();
        let row = markdown.lines().find(|line| line.contains("A \\& B")).unwrap();
        assert!(row.contains("\\<b\\>") && row.contains("\\|") && row.contains("\\*z\\*"));
        let bars = row.replace("\\|", "").matches('|').count();
        assert_eq!(bars, 3);
    }

    #[test]
    fn latex_escapes_what_latex_reads() {
        let latex = table().to_latex();
        assert!(latex.contains("50 \\% \\_x\\_ \\$y\\$ | *z* \\textbackslash{} \\{\\#\\}"));
        assert!(latex.contains("\\caption{\\textit{$\\eta$}\\textsuperscript{2} \\& more}"));
        assert!(latex.contains("\\toprule") && latex.contains("$-$.46"));
    }

    #[test]
    fn a_row_that_is_too_short_is_refused() {
        let mut table = table();
        table.rows[1].pop();
        assert!(matches!(table.check(), Err(ReportError::TableShape { row: 1, found: 1, .. })));
    }

    #[test]
    fn a_number_that_is_none_is_refused() {
        let mut table = table();
        table.rows[0][1] = Cell::number(Some(f64::NAN), 2);
        assert!(matches!(table.check(), Err(ReportError::TableNumber { row: 0, column: 1, .. })));
    }

    /// Arabic, Hebrew, an override that turns the rest of a line round, an emoji of two joined signs.
    const FAR: &str = "\u{645}\u{631}\u{62d}\u{628}\u{627} \u{5e9}\u{5dc}\u{5d5}\u{5dd} \u{202e}x \u{1f468}\u{200d}\u{1f52c}";

    fn far() -> Table {
        let mut table = table();
        table.rows[0][0] = Cell::text(FAR);
        table
    }

    #[test]
    fn a_name_from_right_to_left_and_an_emoji_stay_whole_in_every_format() {
        assert!(far().to_html().contains(&format!("<bdi>{FAR}</bdi>")));
        assert!(far().to_csv().contains(FAR));
        assert!(far().to_markdown().contains(FAR));
        assert!(far().to_latex().contains(FAR));
    }

    #[test]
    fn a_missing_cell_is_a_dash_and_an_empty_field_in_csv() {
        let table = table();
        assert!(table.to_html().contains("<td class=\"number\">–</td>"));
        assert!(table.to_latex().contains("& – \\\\"));
        assert!(table.to_markdown().contains("| – |"));
        assert!(table.to_csv().ends_with("=1+1,\r\n"));
    }

    #[test]
    fn every_sign_that_latex_reads_is_escaped() {
        let mut table = table();
        table.rows[0][0] = Cell::text("\\ ~ ^ & % $ # _ { } < > − × ± ≤ ≥ → ² °");
        let latex = table.to_latex();
        let expected = "\\textbackslash{} \\textasciitilde{} \\textasciicircum{} \\& \\% \\$ \\# \\_ \\{ \\} \\textless{} \\textgreater{} \
                        $-$ $\\times$ $\\pm$ $\\leq$ $\\geq$ $\\rightarrow$ \\textsuperscript{2} \\textdegree{}";
        assert!(latex.contains(expected), "{latex}");
    }

    #[test]
    fn every_sign_that_pdflatex_does_not_take_becomes_its_command() {
        for (sign, command) in [
            ('\\', "\\textbackslash{}"),
            ('~', "\\textasciitilde{}"),
            ('^', "\\textasciicircum{}"),
            ('<', "\\textless{}"),
            ('>', "\\textgreater{}"),
            ('−', "$-$"),
            ('×', "$\\times$"),
            ('±', "$\\pm$"),
            ('≤', "$\\leq$"),
            ('≥', "$\\geq$"),
            ('→', "$\\rightarrow$"),
            ('α', "$\\alpha$"),
            ('δ', "$\\delta$"),
            ('ε', "$\\varepsilon$"),
            ('η', "$\\eta$"),
            ('κ', "$\\kappa$"),
            ('ρ', "$\\rho$"),
            ('τ', "$\\tau$"),
            ('∞', "$\\infty$"),
            ('†', "\\textdagger{}"),
            ('χ', "$\\chi$"),
            ('ω', "$\\omega$"),
            ('²', "\\textsuperscript{2}"),
            ('°', "\\textdegree{}"),
            ('\n', " "),
            ('\r', " "),
            ('&', "\\&"),
            ('%', "\\%"),
            ('$', "\\$"),
            ('#', "\\#"),
            ('_', "\\_"),
            ('{', "\\{"),
            ('}', "\\}"),
            ('a', "a"),
            ('é', "é"),
        ] {
            assert_eq!(latex_sign(sign), command, "{sign}");
        }
        assert_eq!(
            latex("*p*_{a} = 10^{2}"),
            "\\textit{p}\\textsubscript{a} = 10\\textsuperscript{2}"
        );
    }
}
