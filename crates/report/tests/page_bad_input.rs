//! The page of what goes wrong: nobody left, ten thousand, names that try to be markup, numbers that are none.
#![expect(clippy::unwrap_used, reason = "a helper of a test stops at the first surprise")]

use base64::{Engine as _, engine::general_purpose::STANDARD};
use maveric_domain::ConditionId;
use maveric_report::claims::{Made, join, load};
use maveric_report::figures::domain;
use maveric_report::html::{Live, LiveContent, Section, SpaceDrive, SpacePerson, StyleSpace};
use maveric_report::tables::{Cell, Column, Exclusion, Table};
use maveric_report::{Context, Report, ReportError, render};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

const NASTY: &str =
    "</script><script>alert(1)</script> <b>&\"'\u{202e}\u{645}\u{631}\u{62d} \u{1f697}";

/// A page with one figure.
fn report() -> Report {
    let context = Context::synthetic(1);
    Report {
        sections: vec![Section {
            title: "One".into(),
            figures: vec![domain(&context).unwrap()],
            ..Section::default()
        }],
        ..Report::new("T", "S", &context)
    }
}

fn drive(name: impl Into<String>, i: usize) -> SpaceDrive {
    let x = i as f64;
    SpaceDrive {
        name: name.into(),
        at: [x.sin(), x.cos(), (2.0 * x).sin()],
        score_points: i.is_multiple_of(7).then_some(30.0),
        velocity_mps: 27.0 + x.sin(),
    }
}

fn space(drives: usize, people: usize) -> Live {
    let person = |i: usize| SpacePerson {
        own: drive(format!("{NASTY}{i}"), i),
        conditions: vec![(ConditionId::new("same").unwrap(), [0.1; 3])],
    };
    Live {
        below: "domain".into(),
        content: LiveContent::StyleSpace(StyleSpace {
            drives: (0..drives).map(|i| drive(NASTY, i)).collect(),
            people: (0..people).map(person).collect(),
            gradient: [0.0, 1.0, 0.0],
            ellipse: Some([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
            score: (11.0, 55.0, NASTY.to_owned()),
            dial: Vec::new(),
        }),
    }
}

fn index(report: &Report) -> String {
    String::from_utf8(render(report).unwrap()[0].bytes.clone()).unwrap()
}

/// The content of every `script` that a browser would run.
fn scripts(page: &str) -> Vec<&str> {
    let starts = page.split("<script>").skip(1);
    starts.map(|rest| rest.split("</script>").next().unwrap()).collect()
}

#[test]
fn only_the_pages_own_scripts_may_run() {
    let mut report = report();
    report.live.push(space(3, 3));
    report.ledger = Some(Vec::new());
    report.warnings.push(NASTY.into());
    let page = index(&report);
    let policy = page.split("script-src").nth(1).unwrap().split(';').next().unwrap();
    let found = scripts(&page);
    assert_eq!(found.len(), 4);
    for script in found {
        let hash = STANDARD.encode(Sha256::digest(script.as_bytes()));
        assert!(policy.contains(&format!("sha256-{hash}")), "{script}");
    }
    assert_eq!(policy.matches("sha256-").count(), 4);
    assert!(!policy.contains("unsafe"));
}

#[test]
fn a_page_without_results_is_still_a_page() {
    let mut report = report();
    report.sections.clear();
    let page = index(&report);
    for there in ["Nothing was left out.", "<h2 id=\"provenance\">", "Synthetic participants."] {
        assert!(page.contains(there), "{there}");
    }
}

#[test]
fn a_nasty_name_stays_a_name() {
    let mut report = report();
    report.live.push(space(2, 2));
    report.exclusions.push(Exclusion { who: NASTY.into(), what: NASTY.into(), why: NASTY.into() });
    report.methods.files.push(maveric_report::html::ParameterFile {
        path: NASTY.into(),
        text: format!("{NASTY}\n\n{NASTY}"),
    });
    report.provenance.parameters.push((NASTY.into(), NASTY.into()));
    let page = index(&report);
    assert!(!page.contains("<script>alert") && !page.contains("<b>&"));
    assert!(page.contains("<bdi>&lt;/script&gt;&lt;script&gt;alert(1)"));
    assert!(page.contains("\u{1f697}"));
}

#[test]
fn ten_thousand_people_make_a_page_of_bounded_size() {
    let mut report = report();
    report.live.push(space(10_000, 10_000));
    report.warnings = (0..10_000).map(|i| format!("warning {i}")).collect();
    report.sections[0].tables.push(Table {
        name: "people".into(),
        title: "People".into(),
        columns: vec![Column::left("Who"), Column::right("Value")],
        rows: (0..10_000).map(|i| vec![Cell::text(format!("P{i}")), Cell::count(i)]).collect(),
        notes: Vec::new(),
        data: None,
    });
    let files = render(&report).unwrap();
    let page = std::str::from_utf8(&files[0].bytes).unwrap();
    assert!(page.len() < 1_500_000, "{}", page.len());
    assert!(
        page.contains("the first 200 of 10,000 rows")
            || page.contains("the first 200 of 10000 rows")
    );
    assert!(page.contains("9000 further training drives and 9000 further participants"));
    assert!(page.contains("9950 further warnings"));
    let csv = files.iter().find(|f| f.path == "tables/people.csv").unwrap();
    assert_eq!(std::str::from_utf8(&csv.bytes).unwrap().lines().count(), 10_001);
}

#[test]
fn a_number_that_is_none_is_refused_by_name() {
    let mut report = report();
    let mut live = space(2, 0);
    let LiveContent::StyleSpace(inside) = &mut live.content else {
        unreachable!("made above");
    };
    inside.drives[1].velocity_mps = f64::NAN;
    report.live.push(live);
    let error = render(&report).unwrap_err();
    assert!(matches!(error, ReportError::Live { .. }));
    assert!(error.to_string().contains("NaN") && error.to_string().contains("domain"));
}

#[test]
fn what_has_nothing_to_show_or_no_figure_is_refused() {
    let mut empty = report();
    empty.live.push(space(0, 0));
    assert!(matches!(render(&empty), Err(ReportError::Live { .. })));
    let mut lost = report();
    lost.live.push(Live { below: "nowhere".into(), ..space(1, 1) });
    assert!(matches!(render(&lost), Err(ReportError::Live { .. })));
}

#[test]
fn the_ledger_links_to_what_the_page_has_and_to_nothing_else() {
    let mut report = report();
    let claims = load(maveric_data::CLAIMS).unwrap();
    let results =
        BTreeMap::from([("scenario.lanes".to_owned(), 2.0), ("line.adb.r".to_owned(), 0.9)]);
    let mut rows = join(&claims, &results).unwrap();
    for row in rows.iter_mut().filter(|row| row.ours.is_some()) {
        let shown = if row.claim.id == "lanes" { "figure-domain" } else { "figure-lost" };
        row.made = Some(Made { stage: "stats".into(), shown_in: Some(shown.into()) });
    }
    report.ledger = Some(rows);
    let page = index(&report);
    assert!(page.contains("href=\"#figure-domain\"") && !page.contains("#figure-lost"));
    assert_eq!(page.matches("data-verdict=").count(), claims.len());
    assert!(
        page.contains("the nearest that 12 people can give is 33.3\u{a0}%")
            || page.contains("the nearest that 12 people can give is 33.3 %")
    );
}
