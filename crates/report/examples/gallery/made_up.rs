//! A report of every figure and table. The numbers come from sines and mean nothing.

#[path = "kinds/mod.rs"]
pub(crate) mod kinds;

use kinds::{PARTICIPANTS, conditions, figures, wobble};
use maveric_report::claims::{join, load};
use maveric_report::html::{
    Input, Live, LiveContent, Methods, ParameterFile, Provenance, Section, SpaceDrive, SpacePerson,
    StyleSpace,
};
use maveric_report::tables::{Cell, Exclusion, Table};
use maveric_report::{Card, CardNumber, Context, Report, ReportError, Tone, apa};
use std::collections::BTreeMap;

fn tables() -> Vec<Table> {
    let accuracy = [("Mean velocity", 0.96, 0.936), ("Mean headway time", 0.79, 0.802)];
    let percent = |share: f64| Cell::number(Some(100.0 * share), 1);
    vec![
        Table::of("accuracy", "How near Mimic comes to the own drive (%)", accuracy)
            .text("Measure", |row| row.0)
            .right("*n*", |_| Cell::count(PARTICIPANTS))
            .right("Accuracy", |row| percent(row.1))
            .right("Paper", |row| percent(row.2))
            .noted("Accuracy: 1 − |car − driver| / driver, mean over drivers. No test."),
        Table::of("correlations", "Personality against ratings", ["Conscientiousness <script>"])
            .text("Independent", |row| *row)
            .text("Dependent", |_| "M−C competence")
            .left("Here", |_| Cell::Marked(apa::rho(-0.51, 22, 0.011).markup().to_owned()))
            .left("Paper", |_| Cell::Marked(apa::rho(-0.71, 22, 0.0001).markup().to_owned()))
            .noted(format!("*n* = {PARTICIPANTS} participants.")),
    ]
}

fn style_space() -> StyleSpace {
    let embedding = |i: usize| [wobble(i, 1), wobble(i, 2), wobble(i, 3)].map(|v| 2.0 * v);
    let drive = |i: usize, name: String| SpaceDrive {
        name,
        at: embedding(i),
        score_points: Some(33.0 + 20.0 * wobble(i, 4)),
        velocity_mps: 29.0 + 4.5 * wobble(i, 5),
    };
    StyleSpace {
        drives: (0..30).map(|i| drive(i, format!("D{i:02} </script>"))).collect(),
        people: (40..46)
            .map(|i| SpacePerson {
                own: drive(i, format!("P{i} <b>&\u{202e}")),
                conditions: vec![
                    (conditions()[0], embedding(i)),
                    (conditions()[1], embedding(i).map(|v| v + 0.8)),
                    (conditions()[2], embedding(i).map(|v| v - 0.8)),
                ],
            })
            .collect(),
        gradient: [1.0, 1.0, 1.0],
        ellipse: Some([[0.7, -0.7, 0.0], [0.4, 0.4, -0.8]]),
        score: (11.0, 55.0, "ADB score".into()),
        dial: [2, 0, 1].map(|i| conditions()[i]).to_vec(),
    }
}

fn card() -> Card {
    Card {
        name: "made-up".into(),
        question: "Do sines say anything?".into(),
        answer: "They do not, <b>whatever</b> is drawn.".into(),
        tone: Tone::Open,
        verdict: "not shown".into(),
        rule: "Shown if *p* < .05.".into(),
        number: Some(CardNumber {
            value: "*r* = .30".into(),
            floor: "0".into(),
            ceiling: "1".into(),
        }),
        plot: Some(kinds::intervals::input()),
        doubt: "Sines are no data.".into(),
        see: Some("table-accuracy".into()),
        tests: vec!["*r*(22) = .30, *p* = .154".into()],
    }
}

pub(crate) fn report(context: &Context) -> Result<Report, ReportError> {
    let claims = load(maveric_data::CLAIMS)?;
    let results = BTreeMap::from([
        ("line.mean_velocity.r".to_owned(), 0.3),
        ("line.mean_velocity.p".to_owned(), 0.154),
        ("accuracy.mimic.mean_velocity".to_owned(), 96.0),
        ("participants.study2.n".to_owned(), 24.0),
        ("nearer.mean_velocity.aggressive.p".to_owned(), 0.02),
        ("nearer.mean_velocity.aggressive.direction".to_owned(), 1.0),
        ("correlation.openness.ma_discomfort.r".to_owned(), -0.1),
    ]);
    let (title, subtitle) = (
        "Gallery of made-up numbers",
        "Every figure and table that a report can have, drawn from sines.",
    );
    Ok(Report {
        cards: vec![card()],
        summary: vec![
            "Made up: position on the aggression line with ADB, *r*(22) = .30, *p* = .154".into(),
            "Made up: mimic accuracy of mean velocity, 96.0%".into(),
        ],
        sections: vec![
            Section {
                title: "Figures".into(),
                intro: vec!["All of these are drawn from sines, and mean nothing.".into()],
                figures: figures(context)?,
                tables: Vec::new(),
            },
            Section { title: "Tables".into(), tables: tables(), ..Section::default() },
        ],
        live: vec![Live {
            below: "embedding-space".into(),
            content: LiveContent::StyleSpace(style_space()),
        }],
        methods: Methods {
            text: vec!["Sines, wobbled.".into()],
            files: vec![ParameterFile {
                path: "study_data/effects.toml".into(),
                text: "# nothing\n[of]\nthis = \"<is> & used\"\n".into(),
            }],
        },
        ledger: Some(join(&claims, &results)?),
        exclusions: vec![Exclusion {
            who: "P03 \u{202e}<b>&".into(),
            what: "time headway merge back".into(),
            why: "never merged back in Cautious".into(),
        }],
        warnings: vec!["Two drives met only five of the six lead vehicles.".into()],
        provenance: Provenance {
            version: env!("CARGO_PKG_VERSION").into(),
            seed: context.seed,
            command: "cargo run -p maveric-report --example gallery -- FOLDER".into(),
            parameters: vec![
                ("window_s".into(), "4.0".into()),
                ("embedding.size".into(), "3".into()),
            ],
            inputs: vec![Input {
                path: "study_data/claims.toml".into(),
                hash: "0f1e2d3c4b5a".into(),
            }],
        },
        ..Report::new(title, subtitle, context)
    })
}
