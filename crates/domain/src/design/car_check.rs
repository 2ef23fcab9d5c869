//! Reading a condition's car: one of its kinds, a place on the dial, somebody else's style.

use super::{
    condition::{Car, Matched},
    error::{Checked, DesignError, refuse},
    outcome::Style,
    toml_file::{CarToml, DialToml, ReplayToml},
};

const CARS: &str = "one of { dial = POINTS }, { across = true }, { mean = true }, { embedding = \"FILE.csv\" }, \
                    { other = \"matched\" }, { replay = \"own\" }, { free = true }, { recorded = true }";

/// How far donor and rider lie apart where the design does not say it, in standard deviations across the dial.
const APART_SD: [f64; 2] = [0.7, 2.5];

/// What a condition's table says of its car; `None` where the drive is recorded elsewhere.
pub(super) fn car(key: &str, raw: CarToml, style: Option<&Style>) -> Checked<Option<Car>> {
    let on_the_dial = raw.dial.is_some() || raw.across || raw.free || raw.other.is_some();
    let matched = matched(key, &raw)?;
    let dial = raw.dial.map(|d| dial(key, d, style)).transpose()?;
    let cars = [
        dial.map(Car::Dial),
        raw.across.then_some(Car::Across),
        raw.mean.then_some(Car::Mean),
        raw.embedding.map(Car::Embedding),
        matched.map(Car::Matched),
        raw.replay.map(|ReplayToml::Own| Car::Replay),
        raw.free.then_some(Car::Free),
    ];
    let mut given: Vec<Car> = cars.into_iter().flatten().collect();
    if given.len() > 1 {
        let kinds: Vec<&str> = given.iter().map(kind).collect();
        return refuse(key, kinds.join(" and "), CARS);
    }
    if given.is_empty() && !raw.recorded {
        return refuse(key, "no car", CARS);
    }
    if on_the_dial && style.is_none() {
        return refuse(
            key,
            "a place on the dial, and no `[style]`",
            "a `[style]` with the score that the dial turns, or a car without it: { mean = true }, { embedding = \"FILE.csv\" }, { recorded = true }",
        );
    }
    Ok(given.pop())
}

/// Somebody else's style.
fn matched(key: &str, raw: &CarToml) -> Checked<Option<Matched>> {
    let beside = [("from", raw.from.is_some()), ("apart", raw.apart.is_some())];
    if raw.other.is_none() {
        return match beside.into_iter().find(|(_, given)| *given) {
            Some((name, _)) => refuse(
                format!("{key}.{name}"),
                "a car that has nobody else's style",
                "it beside `other = \"matched\"` alone",
            ),
            None => Ok(None),
        };
    }
    let apart_sd = raw.apart.unwrap_or(APART_SD);
    let [least, most] = apart_sd;
    if !(least >= 0.0 && least < most && most.is_finite()) {
        return refuse(
            format!("{key}.apart"),
            format!("[{least}, {most}]"),
            "two distances in standard deviations, the shorter first, such as [0.7, 2.5]",
        );
    }
    let from = raw.from.unwrap_or_default();
    Ok(Some(Matched { from, apart_sd }))
}

/// The key of a kind of car.
fn kind(car: &Car) -> &'static str {
    match car {
        Car::Dial(_) => "`dial`",
        Car::Across => "`across`",
        Car::Mean => "`mean`",
        Car::Embedding(_) => "`embedding`",
        Car::Matched(_) => "`other`",
        Car::Replay => "`replay`",
        Car::Free => "`free`",
    }
}

/// Points of the dial; steps are so many `points` of the style.
fn dial(key: &str, raw: DialToml, style: Option<&Style>) -> Checked<f64> {
    let key = format!("{key}.dial");
    let points = match raw {
        DialToml::Points(points) => points,
        DialToml::Steps(text) => {
            let steps: f64 = text.trim().parse().map_err(|_| {
                DesignError::key(&key, format!("`{text}`"), "a number of steps, such as \"-1\"")
            })?;
            let step = style.map(|s| {
                s.points.ok_or_else(|| {
                    DesignError::key(
                        &key,
                        format!("`{text}` steps, and no `points` in `[style]`"),
                        "the points of a step in `[style]`, or points without quotes",
                    )
                })
            });
            steps * step.transpose()?.unwrap_or(1.0)
        }
    };
    let widest = style.and_then(|s| s.range).map_or(f64::MAX, |[l, h]| h - l);
    if points.is_finite() && points.abs() <= widest {
        Ok(points)
    } else {
        refuse(
            key,
            points,
            format!("at most {widest} points either way, the width of `style.range`"),
        )
    }
}
