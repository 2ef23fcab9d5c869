//! Whatever a figure is given, it draws, or says in words why not: no panic, no hang, no empty picture, no markup of
//! somebody else's.

use crate::kinds;
use maveric_report::{Context, Figure, ReportError, figures};
use resvg::usvg;
use serde_json::Value;
use std::collections::BTreeSet;

/// A kind of figure with its made-up input as JSON, so that every number and list of it can be changed.
struct Kind {
    name: &'static str,
    input: Value,
    draw: fn(Value) -> Option<Result<Figure, ReportError>>,
}

macro_rules! kinds {
    ($($name:ident),* $(,)?) => {
        vec![$(Kind {
            name: stringify!($name),
            input: serde_json::to_value(kinds::$name::input()).unwrap(),
            // None: the changed JSON is no input at all, as when a list is where a number should be.
            draw: |value| {
                let input = serde_json::from_value(value).ok()?;
                Some(figures::$name(&input, &Context::synthetic(7)))
            },
        }),*]
    };
}

/// Every figure with an input, but `architecture`, whose input is the model's own layers.
fn kinds() -> Vec<Kind> {
    kinds![
        ablation,
        aggression_line,
        calibration,
        car_following,
        congruence,
        curves,
        dial_sweep,
        family,
        difference_panels,
        drive_overview,
        embedding_space,
        false_positives,
        fidelity,
        following_errors,
        interaction,
        learning_curve,
        perpendicular,
        preference,
        press_course,
        residuals,
        simulator_view,
        time_space,
        training_curves,
    ]
}

/// What holds of any answer: a picture with something in it, or an error that says what is wrong.
fn judge(kind: &Kind, what: &str, answer: &Result<Figure, ReportError>) {
    match answer {
        Ok(figure) => {
            let svg = &figure.svg;
            let of = |element: &str| svg.matches(element).count();
            let drawn = of("<polyline") + of("<polygon") + of("<circle") + of("<rect");
            assert!(drawn > 3 && of("<text") > 1, "{}, {what}: an empty picture", kind.name);
            assert!(!svg.contains("NaN") && !svg.contains("inf\""), "{}, {what}", kind.name);
            let read = usvg::Tree::from_str(svg, &usvg::Options::default());
            assert!(read.is_ok(), "{}, {what}: no XML", kind.name);
            for text in [&figure.caption, &figure.alt] {
                assert!(
                    !text.contains("NaN") && !text.contains("inf "),
                    "{}, {what}: {text}",
                    kind.name
                );
            }
        }
        Err(error) => {
            let words = error.to_string();
            assert!(words.contains('`') && words.len() > 20, "{}, {what}: {words}", kind.name);
        }
    }
}

/// Paths (JSON pointers) of what `wanted` holds of, the first of those that differ only by a place in a list.
fn places(value: &Value, wanted: fn(&Value) -> bool) -> Vec<String> {
    fn walk(
        value: &Value,
        (path, shape): (&str, &str),
        wanted: fn(&Value) -> bool,
        seen: &mut BTreeSet<String>,
        out: &mut Vec<String>,
    ) {
        if wanted(value) && seen.insert(shape.to_owned()) {
            out.push(path.to_owned());
        }
        match value {
            Value::Array(items) => {
                for (index, item) in items.iter().enumerate().take(3) {
                    let paths = (format!("{path}/{index}"), format!("{shape}/*"));
                    walk(item, (&paths.0, &paths.1), wanted, seen, out);
                }
            }
            Value::Object(fields) => {
                for (name, item) in fields {
                    let paths = (format!("{path}/{name}"), format!("{shape}/{name}"));
                    walk(item, (&paths.0, &paths.1), wanted, seen, out);
                }
            }
            _ => {}
        }
    }
    let mut out = Vec::new();
    walk(value, ("", ""), wanted, &mut BTreeSet::new(), &mut out);
    out
}

/// Draws with one place changed.
fn with(
    kind: &Kind,
    path: &str,
    change: impl FnOnce(&mut Value),
) -> Option<Result<Figure, ReportError>> {
    let mut input = kind.input.clone();
    change(input.pointer_mut(path).unwrap());
    (kind.draw)(input)
}

#[test]
fn a_list_without_entries_or_with_one_is_drawn_or_refused() {
    for kind in kinds() {
        let mut refused = 0;
        for path in places(&kind.input, Value::is_array) {
            for keep in [0, 1] {
                let answer = with(&kind, &path, |list| {
                    list.as_array_mut().unwrap().truncate(keep);
                });
                if let Some(answer) = answer {
                    refused += usize::from(answer.is_err());
                    judge(&kind, &format!("{path} cut to {keep}"), &answer);
                }
            }
        }
        // Every figure but the view of a moment and a list of counts needs at least one list of something.
        assert!(refused > 0 || kind.name == "simulator_view", "{} refuses nothing", kind.name);
    }
}

#[test]
fn a_missing_value_is_drawn_or_refused() {
    for kind in kinds() {
        for path in places(&kind.input, |value| !value.is_null()) {
            if let Some(answer) = with(&kind, &path, |value| *value = Value::Null) {
                judge(&kind, &format!("{path} missing"), &answer);
            }
        }
    }
}

#[test]
fn a_number_beyond_all_measure_is_drawn_or_refused() {
    for kind in kinds() {
        for path in places(&kind.input, Value::is_f64) {
            for value in [1e308, -1e308, 1e-308, 0.0, -1.0] {
                let answer = with(&kind, &path, |number| *number = Value::from(value)).unwrap();
                judge(&kind, &format!("{path} = {value}"), &answer);
            }
        }
    }
}

/// Sets every number with decimals to the same value.
fn level(value: &mut Value, to: f64) {
    match value {
        Value::Array(items) => items.iter_mut().for_each(|item| level(item, to)),
        Value::Object(fields) => fields.values_mut().for_each(|item| level(item, to)),
        Value::Number(number) if number.is_f64() => *value = Value::from(to),
        _ => {}
    }
}

#[test]
fn equal_values_are_drawn_or_refused() {
    for kind in kinds() {
        for to in [0.0, 0.5, 1e9] {
            let mut input = kind.input.clone();
            level(&mut input, to);
            if let Some(answer) = (kind.draw)(input) {
                judge(&kind, &format!("all {to}"), &answer);
            }
        }
    }
}

#[test]
fn no_name_becomes_markup() {
    const NASTY: &str = "<script>alert(1)</script> & \"x\" 'y' *z*_{q} \u{202e}\u{0645}\u{0631}\u{062d}\u{0628}\u{0627} \u{1f697}\u{0}]]>";
    for kind in kinds() {
        for path in places(&kind.input, Value::is_string) {
            let answer = with(&kind, &path, |text| *text = NASTY.into());
            let Some(answer) = answer else { continue };
            judge(&kind, &format!("{path} nasty"), &answer);
            let Ok(figure) = answer else { continue };
            let allowed = [
                "svg", "title", "desc", "metadata", "rect", "polyline", "polygon", "circle",
                "text", "tspan",
            ];
            let document = usvg::roxmltree::Document::parse(&figure.svg).unwrap();
            for node in document.descendants().filter(usvg::roxmltree::Node::is_element) {
                let element = node.tag_name().name();
                assert!(allowed.contains(&element), "{}, {path}: <{element}>", kind.name);
                for attribute in node.attributes() {
                    assert!(!attribute.name().starts_with("on"), "{}, {path}", kind.name);
                }
            }
            let caption = maveric_report::markup::html(&figure.caption);
            assert!(!caption.contains("<script"), "{}, {path}", kind.name);
        }
    }
}

#[test]
fn signs_that_the_font_lacks_are_owned_up_to() {
    let mut input = kinds::following_errors::input();
    input.drivers[0] = "\u{0645}\u{0631}\u{062d}\u{0628}\u{0627} \u{1f697}".into();
    let figure = figures::following_errors(&input, &Context::real()).unwrap();
    assert!(figure.svg.contains(">????? ?</text>"));
    assert!(
        figure.caption.contains("A question mark stands for a sign that the figure’s font lacks.")
    );
}

#[test]
fn what_is_not_a_number_is_refused_by_name() {
    /// Puts a value into an input and draws.
    type Put = (&'static str, fn(f64) -> Result<Figure, ReportError>);
    macro_rules! put {
        ($($name:ident: |$input:ident, $value:ident| $change:expr),* $(,)?) => {
            vec![$((stringify!($name), {
                fn draw($value: f64) -> Result<Figure, ReportError> {
                    let mut $input = kinds::$name::input();
                    $change;
                    figures::$name(&$input, &Context::real())
                }
                draw as fn(f64) -> Result<Figure, ReportError>
            })),*]
        };
    }
    let all: Vec<Put> = put![
        ablation: |i, v| i.variants[1].losses[0][2] = Some(v),
        aggression_line: |i, v| i.panels[2].points[3].1 = v,
        calibration: |i, v| i.bins[2].observed = v,
        car_following: |i, v| i.series[1].gap_m[70] = v,
        family: |i, v| i.panels[1].cells[1][1].as_mut().unwrap()[0] = v,
        congruence: |i, v| i.panels[2].curves[1].as_mut().unwrap().points[7].1 = v,
        curves: |i, v| i.panels[1].curves[2][3].high = v,
        dial_sweep: |i, v| i.panels[0].drivers[1][2] = Some(v),
        difference_panels: |i, v| i.panels[5].rows[3][1] = Some(v),
        drive_overview: |i, v| i.speed_mps[9] = v,
        embedding_space: |i, v| i.points[3].embedding[1] = v,
        false_positives: |i, v| i.parts[1].rates[2] = v,
        fidelity: |i, v| i.measures[0].car.low = v,
        following_errors: |i, v| i.models[1].gap_rmse_m[2] = v,
        learning_curve: |i, v| i.panels[1].points[2].high = v,
        perpendicular: |i, v| i.panels[1].points[2].angle_rad = v,
        residuals: |i, v| i.panels[1].mean = v,
        simulator_view: |i, v| i.ego.x_m = v,
        time_space: |i, v| i.leads[2].x_m[5] = v,
        training_curves: |i, v| i.terms[3].train[7] = v,
    ];
    for (name, draw) in all {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let refused = draw(value);
            let known = matches!(
                refused,
                Err(ReportError::NotFinite { .. } | ReportError::OutOfRange { .. })
            );
            assert!(known, "{name} with {value}: {refused:?}");
        }
    }
}
