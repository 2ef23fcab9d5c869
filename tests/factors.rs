//! Studies of several factors and of many conditions, with made-up answers: what their pages say, and that its numbers are those by hand.

use crate::support::{
    TempStudy, argv, copy,
    own_logs::{analysis, change, only_scales, scale},
    page::Page,
    tells,
};
use serde_json::Value;
use std::{collections::BTreeMap, fmt::Write as _, path::Path};

/// A nearly normal number about 0 that follows from its places: no generator, the same everywhere.
fn noise(person: usize, place: usize) -> f64 {
    let place = (place as u64 + 7).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let mut state = (person as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ place;
    let mut sum = 0.0;
    for _ in 0..6 {
        state ^= state >> 31;
        state = state.wrapping_mul(0x94d0_49bb_1331_11eb);
        sum += (state >> 40) as f64 / f64::from(1 << 24);
    }
    sum - 3.0
}

/// A study without logs, of conditions with these lines beside their id, whose people, values and answers are made up.
struct MadeUp<'a> {
    people: usize,
    conditions: Vec<(String, String)>,
    /// Further lines of `study.toml`, before `[exclude]`.
    more: &'a str,
    /// Of a person in a condition, in s.
    seconds: fn(usize, usize) -> f64,
}

fn who(person: usize) -> String {
    format!("P{:02}", person + 1)
}

/// Six of ten are novices.
fn is_novice(person: usize) -> bool {
    person % 10 < 6
}

fn age(person: usize) -> f64 {
    22.0 + (person * 7 % 31) as f64
}

impl MadeUp<'_> {
    fn study(&self) -> TempStudy {
        let study = TempStudy::new();
        let ids: Vec<&str> = self.conditions.iter().map(|(id, _)| id.as_str()).collect();
        let list = ids.join(",");
        let call = ["init", "mine", "--conditions", &list, "--style", "none"];
        study.maveric(&call).ok();
        only_scales(&study, "mine", &[("comfort", scale("comfort", 3, 1, 7, "mean"))]);
        let conditions: Vec<String> = self
            .conditions
            .iter()
            .map(|(id, lines)| {
                format!("[[condition]]\nid = \"{id}\"\n{lines}car = {{ recorded = true }}\n")
            })
            .collect();
        study.write(
            "mine/study.toml",
            format!(
                "[study]\ntitle = \"Made up for a test\"\nsynthetic = true\n[people]\nfile = \"participants.csv\"\n{}\
                 [[measure]]\nid = \"tor_s\"\ntitle = \"Take-over time\"\nunit = \"s\"\naggression = \"none\"\n\
                 [[outcome]]\nmeasure = \"tor_s\"\n[[outcome]]\nscale = \"comfort.total\"\nlabel = \"Comfort\"\n{}",
                conditions.concat(),
                self.more
            ),
        );
        let mut people = "participant,experience,age\n".to_owned();
        let mut measures = "participant,condition,tor_s\n".to_owned();
        let mut answers = "participant,moment,scale,item,answer\n".to_owned();
        for person in 0..self.people {
            let (id, novice) = (who(person), if is_novice(person) { "n" } else { "e" });
            let _ = writeln!(people, "{id},{novice},{}", age(person));
            for (place, condition) in ids.iter().enumerate() {
                let seconds = (self.seconds)(person, place);
                let _ = writeln!(measures, "{id},{condition},{seconds}");
                for item in 1..=3 {
                    let answer =
                        4.5 - 0.8 * (seconds - 3.0) + 1.4 * noise(person, 50 * item + place);
                    let answer = answer.round().clamp(1.0, 7.0);
                    let _ = writeln!(answers, "{id},{condition},comfort,{item},{answer}");
                }
            }
        }
        study.write("mine/participants.csv", people);
        study.write("mine/measures.csv", measures);
        study.write("mine/surveys/answers.csv", answers);
        study
    }
}

const STYLES: [&str; 2] = ["calm", "sporty"];
const TRAFFIC: [&str; 3] = ["free", "dense", "jam"];
const LABELS: &str = "[[factor]]\nwithin = \"style\"\nlabel = \"Driving style\"\nlevels = { calm = \"Calm\", sporty = \"Sporty\" }\n\
    [[factor]]\nwithin = \"traffic\"\nlabel = \"Traffic\"\nlevels = { free = \"Free flow\", dense = \"Dense\", jam = \"Jam\" }\n\
    [[factor]]\ncolumn = \"experience\"\nlabel = \"Experience\"\nlevels = { n = \"Novice\", e = \"Expert\" }\n\
    [[covariate]]\ncolumn = \"age\"\nlabel = \"Age in years\"\n\
    [contrasts]\nfactors = [\n  { style = [\"sporty\", \"calm\"] },\n  { style = [\"sporty\", \"calm\"], traffic = [\"jam\", \"free\"] },\n  \
    { experience = [\"n\", \"e\"], style = [\"sporty\", \"calm\"], traffic = \"jam\" },\n  { experience = [\"n\", \"e\"] },\n]\n";

/// Of a person in a style (0 calm) and traffic: sporty takes longer in denser traffic, most for novices.
fn crossed_seconds(person: usize, place: usize) -> f64 {
    let (style, traffic) = (place / 3, place % 3);
    let novice = f64::from(u8::from(is_novice(person)));
    let own = 0.5 * noise(person, 900) + 0.01 * age(person);
    let value = 2.0 + own + 0.3 * (style * traffic) as f64 + 0.2 * novice * style as f64;
    ((value + 0.5 * noise(person, place)) * 1000.0).round() / 1000.0
}

/// Two styles in three kinds of traffic, novices and experts, and their age.
fn crossed(people: usize) -> TempStudy {
    let conditions = (0..6).map(|place| {
        let (style, traffic) = (STYLES[place / 3], TRAFFIC[place % 3]);
        let label = format!("{style}, {traffic}");
        let levels = format!("levels = {{ style = \"{style}\", traffic = \"{traffic}\" }}");
        (format!("{style}-{traffic}"), format!("label = \"{label}\"\n{levels}\n"))
    });
    MadeUp { people, conditions: conditions.collect(), more: LABELS, seconds: crossed_seconds }
        .study()
}

/// Twelve cars in one row.
fn twelve(more: &str) -> TempStudy {
    let conditions = (0..12).map(|place| {
        let label = format!("label = \"Setting {} of the car\"\n", place + 1);
        (format!("c{:02}", place + 1), label)
    });
    MadeUp {
        people: 60,
        conditions: conditions.collect(),
        more,
        seconds: |person, place| {
            let value = 2.5 + 0.5 * noise(person, 900) + 0.08 * place as f64;
            ((value + 0.5 * noise(person, place)) * 1000.0).round() / 1000.0
        },
    }
    .study()
}

fn run(study: &TempStudy) -> Value {
    study.mine("run").ok();
    // To look at: what a person would see is not what a test can judge.
    if let Some(folder) = std::env::var_os("KEEP_STUDIES") {
        let name = std::thread::current().name().unwrap().to_owned();
        copy(&study.path("mine"), &Path::new(&folder).join(name));
    }
    analysis(study)
}

fn panel<'a>(analysis: &'a Value, outcome: &str) -> &'a Value {
    let mut panels = analysis["panels"].as_array().unwrap().iter();
    panels.find(|p| p["outcome"] == outcome && p["group"].is_null()).unwrap()
}

#[track_caller]
fn close(found: &Value, expected: f64) {
    let found = found.as_f64().unwrap();
    assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{found}, not {expected}");
}

/// Mean and variance of a list.
fn moments(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0))
}

/// Estimate, t and degrees of freedom of weighted groups' means, each with its own variance (Welch and Satterthwaite).
fn welch(groups: &[(f64, Vec<f64>)]) -> [f64; 3] {
    let (mut estimate, mut variance, mut below) = (0.0, 0.0, 0.0);
    for (weight, scores) in groups {
        let (mean, square) = moments(scores);
        let n = scores.len() as f64;
        let part = weight * weight * square / n;
        estimate += weight * mean;
        variance += part;
        below += part * part / (n - 1.0);
    }
    [estimate, estimate / variance.sqrt(), variance * variance / below]
}

const PEOPLE: usize = 30;

#[test]
fn a_design_of_two_factors_a_group_and_a_covariate_has_its_means_effects_and_contrasts_by_hand() {
    let analysis = run(&crossed(PEOPLE));
    let time = panel(&analysis, "tor_s");
    let by_factor = &time["by_factor"];
    let names: Vec<&str> = by_factor["factors"]
        .as_array()
        .unwrap()
        .iter()
        .map(|f| f["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["experience", "style", "traffic"]);
    // Each person's contrast of the style: averaged, in a jam less in free traffic, and in a jam.
    let cell = |p: usize, style: usize, traffic: usize| crossed_seconds(p, 3 * style + traffic);
    let sporty = |p: usize, traffic: usize| cell(p, 1, traffic) - cell(p, 0, traffic);
    let mean = |p: usize| (0..3).map(|t| sporty(p, t)).sum::<f64>() / 3.0;
    let rise = |p: usize| sporty(p, 2) - sporty(p, 0);
    let jam = |p: usize| sporty(p, 2);
    let of = |score: &dyn Fn(usize) -> f64, novice: bool| -> Vec<f64> {
        (0..PEOPLE).filter(|p| is_novice(*p) == novice).map(score).collect()
    };
    let contrasts = by_factor["contrasts"].as_array().unwrap();
    assert_eq!(contrasts.len(), 4);
    let expected = [
        welch(&[(0.5, of(&mean, true)), (0.5, of(&mean, false))]),
        welch(&[(0.5, of(&rise, true)), (0.5, of(&rise, false))]),
        welch(&[(1.0, of(&jam, true)), (-1.0, of(&jam, false))]),
    ];
    for (contrast, [estimate, t, df]) in contrasts.iter().zip(expected) {
        assert_eq!(contrast["method"], "unpooled", "{contrast}");
        close(&contrast["estimate"], estimate);
        close(&contrast["statistic"], t);
        close(&contrast["df"], df);
    }
    // Between people the age is taken out: by the slope within groups.
    let all = |p: usize| (0..6).map(|place| crossed_seconds(p, place)).sum::<f64>() / 6.0;
    let (mut over, mut square) = (0.0, 0.0);
    for p in 0..PEOPLE {
        let from = age(p) - moments(&of(&age, is_novice(p))).0;
        over += from * (all(p) - moments(&of(&all, is_novice(p))).0);
        square += from * from;
    }
    let apart =
        |score: &dyn Fn(usize) -> f64| moments(&of(score, true)).0 - moments(&of(score, false)).0;
    assert_eq!(contrasts[3]["method"], "regression");
    close(&contrasts[3]["estimate"], apart(&all) - over / square * apart(&age));
    // Holm's step down over the four, by hand.
    let p: Vec<f64> = contrasts.iter().map(|c| c["p"].as_f64().unwrap()).collect();
    let mut order: Vec<usize> = (0..4).collect();
    order.sort_by(|a, b| p[*a].total_cmp(&p[*b]));
    let mut least: f64 = 0.0;
    for (rank, at) in order.into_iter().enumerate() {
        least = least.max((p[at] * (4 - rank) as f64).min(1.0));
        close(&contrasts[at]["p_holm"], least);
    }
    // The mean of sporty in a jam counts both groups alike, and so do the marginal means.
    let means = by_factor["means"].as_array().unwrap();
    let mean_of = |effect: &str, levels: &[&str]| {
        let mut rows = means.iter();
        let levels: Vec<Value> = levels.iter().map(|l| (*l).into()).collect();
        rows.find(|m| m["effect"] == effect && m["levels"] == Value::from(levels.clone())).unwrap()
    };
    let here = |p: usize| cell(p, 1, 2);
    let both = f64::midpoint(moments(&of(&here, true)).0, moments(&of(&here, false)).0);
    close(&mean_of("style:traffic", &["sporty", "jam"])["mean"], both);
    let novices = mean_of("experience:style:traffic", &["n", "sporty", "jam"]);
    close(&novices["mean"], moments(&of(&here, true)).0);
    assert_eq!((&novices["n"], novices["within"].is_array()), (&18.into(), true));
    // Three interactions of two factors: five, four and five simple effects, and each its own family.
    let simple = by_factor["simple"].as_array().unwrap();
    assert_eq!(simple.len(), 4 + 5 + 5, "{simple:?}");
}

#[test]
fn its_page_calls_factors_by_their_labels_and_draws_the_interaction() {
    let study = crossed(PEOPLE);
    run(&study);
    let page = Page::read(&study.path("mine/report/index.html"));
    page.says(&[
        "Experience × Driving style × Traffic",
        "Driving style: Sporty − Calm × Traffic: Jam − Free flow",
        "Means by factor",
        "Simple effects",
        "Age in years",
        "The declared contrasts of factors",
    ]);
    for name in ["interaction.svg", "interaction-a.svg"] {
        let figures = study.path("mine/report/figures");
        let svg = std::fs::read_to_string(figures.join(name)).unwrap();
        for text in [">Free flow<", ">Sporty<", ">Traffic<"] {
            assert!(svg.contains(text), "{name}: {text}");
        }
        assert!(svg.contains("Synthetic participants"), "{name}");
    }
    let results = study.read("mine/report/manuscript/results.md");
    tells(&results, &["Declared contrasts of factors"]);
    // Six conditions, and no contrast of conditions was declared: no bracket.
    let panels = study.path("mine/report/figures/difference-panels.svg");
    let svg = std::fs::read_to_string(panels).unwrap();
    assert!(!svg.contains("***</text>"), "{svg}");
}

/// Times that are far from normal between people and that everybody orders as the conditions stand.
fn ordered_alike(more: &str) -> TempStudy {
    let conditions = ["calm", "normal", "sporty"];
    MadeUp {
        people: 20,
        conditions: conditions.map(|id| (id.to_owned(), String::new())).into(),
        more,
        seconds: |person, place| {
            let late = 8.0 * ((noise(person, place) + 3.0) / 6.0).powi(8);
            ((2.0 + place as f64 + late) * 1000.0).round() / 1000.0
        },
    }
    .study()
}

#[test]
fn an_effect_of_which_everybody_orders_the_levels_alike_is_said_wherever_effects_are() {
    let study = ordered_alike("[[factor]]\ncolumn = \"experience\"\nlabel = \"Experience\"\n");
    run(&study);
    let row = |table: &str, start: &str| {
        let table = study.read(&format!("mine/report/tables/{table}.csv"));
        let found = table.lines().find(|line| line.starts_with(start));
        assert!(found.is_some(), "no {start} in: {table}");
    };
    // χ² of n people and three levels is 2 n where all agree.
    row("omnibus", "tor_s,,condition,chi2,20,40,2,,");
    row("simple-effects", "tor_s,condition,experience,n,12,24,2,,");
    row("simple-effects", "tor_s,condition,experience,e,8,16,2,,");
    let said = ["condition: *χ*<sup>2</sup>(2, *N* = 20) = 40.00, *p* < .001"];
    tells(&study.read("mine/report/manuscript/results.md"), &said);
    Page::read(&study.path("mine/report/index.html")).says(&["F has no bound"]);
}

#[test]
fn the_call_that_an_export_gives_finds_the_numbers_of_the_page() {
    let study = ordered_alike("");
    let found = study.mine("run").ok();
    study.write("key", "a secret of this test alone");
    study.mine("export --key ../key --out ../shared").ok();
    let readme = study.read("shared/README.md");
    let (_, call) = readme.split_once("`maveric stats compare ").unwrap();
    let call = argv(call.split('`').next().unwrap());
    let call = [&["stats", "compare"][..], &call[..], &["--apa"]].concat();
    let again = study.maveric_in("shared", &call).ok();
    let said = "χ²(2, N = 20) = 40.00, p_exact < .001, W = 1.00";
    let over = format!("Take-over time over the conditions: {said}");
    tells(&found.stdout, &[over.as_str()]);
    tells(&again.stdout, &[format!("omnibus: {said}").as_str()]);
}

#[test]
fn twelve_conditions_have_at_most_six_brackets_names_that_are_whole() {
    let pairs: Vec<String> = (2..=12).map(|c| format!("[\"c{c:02}\", \"c01\"]")).collect();
    let study = twelve(&format!("[contrasts]\ncompare = [{}]\n", pairs.join(", ")));
    run(&study);
    let page = Page::read(&study.path("mine/report/index.html"));
    page.says(&["at most 6 a panel, those with the smallest p"]);
    let figures = study.path("mine/report/figures");
    for name in ["difference-panels.svg", "difference-panels-a.svg"] {
        let svg = std::fs::read_to_string(figures.join(name)).unwrap();
        let panels = if name.ends_with("-a.svg") { 1 } else { 2 };
        let names = svg.matches(">Setting 12").count() + svg.matches(">Setting<").count();
        assert!(names >= panels, "{name}: {svg}");
        let stars = svg.matches("*</text>").count();
        assert!((1..=6 * panels).contains(&stars), "{name}: {stars} brackets");
    }
}

#[test]
fn an_unknown_factor_level_or_label_is_refused_by_what_there_is_and_nothing_is_written() {
    let study = crossed(10);
    let sound = study.read("mine/study.toml");
    let wrong: BTreeMap<(&str, &str), &[&str]> = BTreeMap::from([
        (
            ("{ style = [\"sporty\", \"calm\"] },", "{ stile = [\"sporty\", \"calm\"] },"),
            &["contrasts.factors[1]", "`stile`", "did you mean `style`?"][..],
        ),
        (
            ("\"calm\"], traffic = \"jam\" }", "\"calm\"], traffic = \"jamm\" }"),
            &["contrasts.factors[3].traffic", "`jamm`", "did you mean `jam`?"],
        ),
        (
            ("{ experience = [\"n\", \"e\"] }", "{ experience = \"n\" }"),
            &["contrasts.factors[4]", "no pair of levels"],
        ),
        (
            ("levels = { calm = \"Calm\",", "levels = { clam = \"Calm\","),
            &["factor.style.levels", "`clam`", "did you mean `calm`?"],
        ),
        (
            ("within = \"traffic\"", "within = \"trafic\""),
            &["factor.within", "`trafic`", "did you mean `traffic`?"],
        ),
        (
            (
                "label = \"Traffic\"",
                "label = \"Traffic that is so dense that nobody in it can say where it begins, or ends\"",
            ),
            &["factor.traffic.label", "at most 60"],
        ),
    ]);
    for ((from, to), words) in wrong {
        assert!(sound.contains(from), "{from}");
        study.write("mine/study.toml", sound.replacen(from, to, 1));
        study.mine("run").failed(1, words);
        assert!(!study.path("mine/results").exists(), "{to}");
    }
    // Which levels there are between people, their table alone knows.
    study.write(
        "mine/study.toml",
        sound.replacen("{ experience = [\"n\", \"e\"] }", "{ experience = [\"n\", \"x\"] }", 1),
    );
    let ran = study.mine("run");
    assert_eq!(ran.status, Some(1));
    for words in ["`[contrasts] factors` names `x` of `experience`", "expected one of e, n"] {
        assert!(ran.stderr.contains(words), "{}", ran.stderr);
    }
    assert!(!study.path("mine/results/analysis.json").exists());
    assert!(!study.path("mine/report").exists());
    change(&study, "mine/study.toml", "\"x\"", "\"e\"");
    study.mine("run").ok();
}
