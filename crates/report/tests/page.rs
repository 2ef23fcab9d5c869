//! The page and its files.
#![expect(clippy::unwrap_used, reason = "a helper of a test stops at the first surprise")]

#[path = "../examples/gallery/made_up.rs"]
mod made_up;

use maveric_report::html::RenderedFile;
use maveric_report::tables::{Cell, Column, Table};
use maveric_report::{Context, Report, ReportError, render};
use std::sync::OnceLock;

/// Rendering pictures takes most of the time: the whole report is rendered once.
fn files() -> &'static [RenderedFile] {
    static FILES: OnceLock<Vec<RenderedFile>> = OnceLock::new();
    FILES.get_or_init(|| render(&made_up::report(&Context::synthetic(3)).unwrap()).unwrap())
}

fn index(files: &[RenderedFile]) -> &str {
    assert_eq!(files[0].path, "index.html");
    std::str::from_utf8(&files[0].bytes).unwrap()
}

/// A report with one small figure.
fn short(context: &Context) -> Report {
    let mut report = made_up::report(context).unwrap();
    report.sections[0].figures.retain(|figure| figure.name == "embedding-space");
    report
}

#[test]
fn a_synthetic_page_says_so_before_anything_else() {
    let page = index(files());
    let banner = page.find("Synthetic participants.</strong>").unwrap();
    assert!(banner < page.find("<h1>").unwrap());
    let real = render(&short(&Context::real())).unwrap();
    assert!(!index(&real).contains("class=\"banner\""));
}

#[test]
fn a_page_of_drives_by_a_script_says_so_too() {
    let scripted = Context { scripted: true, ..Context::real() };
    let files = render(&short(&scripted)).unwrap();
    let page = index(&files);
    assert!(page.find("Driven by a script.</strong>").unwrap() < page.find("<h1>").unwrap());
    assert!(page.contains("driven by a script</text>"));
}

#[test]
fn the_answers_stand_before_everything_else_and_the_supplement_is_folded_behind() {
    let page = index(files());
    let at = |what: &str| page.find(what).unwrap_or_else(|| panic!("{what}"));
    assert!(at("id=\"card-made-up\"") < at("id=\"contents\""));
    assert!(page.contains("They do not, &lt;b&gt;whatever&lt;/b&gt; is drawn."));
    for said in [
        "floor: 0",
        "ceiling: 1",
        "Grey bar: the floor.",
        "Why you might doubt this",
        "href=\"#table-accuracy\"",
        "<span class=\"verdict half\">not shown",
    ] {
        assert!(page.contains(said), "{said}");
    }
    let fold = at("<details class=\"supplement\"");
    for behind in ["id=\"methods\"", "id=\"ledger\"", "id=\"exclusions\"", "id=\"provenance\""] {
        assert!(fold < at(behind), "{behind}");
    }
    assert!(at("id=\"section-1\"") < fold);
    assert!(files().iter().any(|f| f.path == "figures/card-made-up.svg"));
}

#[test]
fn every_paragraph_that_was_given_stands_on_the_page() {
    let report = made_up::report(&Context::synthetic(3)).unwrap();
    let page = index(files());
    let intros = report.sections.iter().flat_map(|section| &section.intro);
    let given = report.summary.iter().chain(&report.methods.text);
    let mut paragraphs = 0;
    for text in given.chain(intros) {
        let marked = maveric_report::markup::html(text);
        assert!(page.contains(&marked), "{marked}");
        paragraphs += 1;
    }
    assert!(paragraphs > 3, "{paragraphs}");
}

#[test]
fn a_card_links_to_nothing_that_the_page_has_not_and_two_of_one_name_are_refused() {
    let mut report = short(&Context::synthetic(3));
    report.cards[0].see = Some("table-nowhere".into());
    assert!(!index(&render(&report).unwrap()).contains("table-nowhere"));
    report.cards.push(report.cards[0].clone());
    assert!(matches!(render(&report), Err(ReportError::DuplicateName { .. })));
}

#[test]
fn the_page_needs_nothing_from_outside() {
    let page = index(files());
    assert!(page.contains("default-src &#x27;none&#x27;") || page.contains("default-src 'none'"));
    for outside in ["src=", "href=\"http", "url(http", "@import", "unsafe-eval"] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert_eq!(page.matches("@font-face").count(), 3);
}

#[test]
fn what_somebody_typed_stays_text() {
    let mut report = short(&Context::synthetic(3));
    "</title><script>1</script>".clone_into(&mut report.title);
    report.warnings.push("<img src=x onerror=1>".into());
    report.provenance.command = "a && b \"c\"".into();
    let files = render(&report).unwrap();
    let page = index(&files);
    assert!(!page.contains("<img"));
    // The page's own four scripts and one block of data, each as it was written.
    assert_eq!(page.matches("<script").count(), 5);
    assert_eq!(page.matches("</script").count(), 5);
    assert!(page.contains("&lt;img src=x onerror=1&gt;"));
    assert!(page.contains("P03 ") && page.contains("&lt;b&gt;&amp;"));
}

#[test]
fn ids_are_unique() {
    let page = index(files());
    let mut ids: Vec<&str> =
        page.split(" id=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), count);
}

#[test]
fn every_figure_and_table_is_a_file_too() {
    let has = |path: &str| files().iter().any(|file| file.path == path && !file.bytes.is_empty());
    for path in [
        "figures/difference-panels.svg",
        "figures/difference-panels.png",
        "tables/claims.csv",
        "tables/exclusions.tex",
        "tables/accuracy.md",
        "tables/correlations.html",
    ] {
        assert!(has(path), "{path}");
    }
}

#[test]
fn the_same_report_gives_the_same_bytes() {
    let report = short(&Context::synthetic(3));
    assert_eq!(render(&report).unwrap(), render(&report).unwrap());
}

#[test]
fn two_tables_of_one_name_are_refused() {
    let mut report = short(&Context::synthetic(3));
    let table = report.sections[1].tables[0].clone();
    report.sections[1].tables.push(table);
    assert!(matches!(render(&report), Err(ReportError::DuplicateName { .. })));
}

#[test]
fn a_name_that_leads_out_of_the_folder_is_refused() {
    let mut report = short(&Context::synthetic(3));
    report.sections[1].tables.push(Table {
        name: "../../x".into(),
        title: "x".into(),
        columns: vec![Column::left("a")],
        rows: vec![vec![Cell::text("b")]],
        notes: Vec::new(),
        data: None,
    });
    assert!(matches!(render(&report), Err(ReportError::BadName { .. })));
}
