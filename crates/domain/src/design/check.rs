//! Reading a design: whether it agrees with itself.

use super::{
    car_check::car,
    condition::{Baseline, Car, Condition, Role, Sign},
    error::{Checked, DesignError, refuse},
    exclude::Exclude,
    factors,
    files::ModelFile,
    outcome::Style,
    own_measure::own_measures,
    people::{People, Wanted},
    ridden::ridden,
    tested::{compare, hypothesis, once, outcomes},
    toml_file::{
        CarToml, CellToml, ConditionToml, DesignToml, ModelToml, PeopleToml, RoleToml, StyleToml,
        Units,
    },
    validate::validate,
    which::which,
};
use crate::{design::Design, survey::ScoreRange, units::SpeedUnit};
use std::collections::BTreeMap;

/// Most conditions: a study compares them in pairs, of which these are 1,225 for every outcome.
const MOST_CONDITIONS: usize = 50;

impl Design {
    /// Reads a design and checks its shape.
    ///
    /// # Errors
    /// [`DesignError`] naming the key, what stands there and what would be possible.
    pub fn from_toml(text: &str) -> Result<Self, DesignError> {
        let raw: DesignToml = toml::from_str(text).map_err(|e| DesignError::from_toml(text, &e))?;
        design(raw)
    }
}

fn design(raw: DesignToml) -> Checked<Design> {
    if raw.study.title.trim().is_empty() {
        return refuse("study.title", "an empty text", "a title");
    }
    let people = people(raw.people);
    let style = raw.style.map(style).transpose()?;
    let beyond = raw.model.beyond;
    let model = model_file(raw.model)?;
    let learned = people.learn.is_some() || model.is_some();
    if raw.condition.is_empty() && raw.role.is_empty() {
        return refuse(
            "condition",
            "none",
            "at least one [[condition]], or [[role]]s in which people drove",
        );
    }
    let conditions = conditions(raw.condition, style.as_ref(), learned)?;
    let baseline = raw.baseline.map(|b| Baseline {
        label: b.label.unwrap_or_else(|| b.id.to_string()),
        id: b.id,
        by: b.by,
    });
    let roles = roles(raw.role, baseline.as_ref(), style.as_ref())?;
    let driven = roles.iter().map(|r| r.id);
    let driven: Vec<_> = driven.chain(baseline.iter().map(|b| b.id)).collect();
    validate(&raw.validate, &driven)?;
    let measures = own_measures(raw.measure)?;
    let compare = compare(raw.contrasts.compare, &conditions)?;
    let pairs = compare.pairs(&conditions);
    let outcomes = outcomes(raw.outcome, &conditions, &pairs)?;
    let hypotheses = raw
        .hypothesis
        .into_iter()
        .enumerate()
        .map(|(at, h)| hypothesis(at, h, &conditions, &pairs, &outcomes))
        .collect::<Checked<_>>()?;
    let (factors, crossed) = factors::factors(raw.factor, &conditions)?;
    let named = factors.iter().chain(&crossed);
    once("factor", named.map(|factor| factor.name.clone()))?;
    let level_contrasts = raw.contrasts.factors;
    factors::contrasts(&level_contrasts, &factors, &conditions)?;
    let of_conditions =
        conditions.iter().map(|c| (format!("condition.{}.label", c.id), c.label.as_str()));
    let of_factors =
        factors.iter().chain(&crossed).flat_map(|f| {
            let own_label =
                f.label.iter().map(|label| (format!("factor.{}.label", f.name), label.as_str()));
            own_label.chain(f.levels.iter().map(|(level, label)| {
                (format!("factor.{}.levels.{level}", f.name), label.as_str())
            }))
        });
    factors::printable(of_conditions.chain(of_factors))?;
    once("covariate", raw.covariate.iter().map(|c| c.column.clone()))?;
    factors::products(&raw.covariate, &conditions)?;
    exclude(&raw.exclude)?;
    raw.protocol.check()?;
    ridden(&raw.protocol, &conditions)?;
    which(&raw.protocol, &conditions)?;
    let speed_unit = match raw.study.units {
        Some(Units::Metric) => SpeedUnit::Kmh,
        Some(Units::Us) => SpeedUnit::Mph,
        None => SpeedUnit::default(),
    };
    Ok(Design {
        title: raw.study.title,
        authors: raw.study.authors,
        synthetic: raw.study.synthetic,
        speed_unit,
        files: raw.files,
        people,
        model,
        beyond,
        style,
        conditions,
        baseline,
        roles,
        measures,
        outcomes,
        hypotheses,
        compare,
        factors,
        crossed,
        level_contrasts,
        covariates: raw.covariate,
        homophily: raw.homophily,
        validate: raw.validate,
        protocol: raw.protocol,
        exclude: raw.exclude,
        amendments: raw.amendments,
    })
}

fn model_file(raw: ModelToml) -> Checked<Option<ModelFile>> {
    let made_up = raw.made_up;
    match raw.file {
        None if made_up => refuse(
            "model.made_up",
            "`true` without a `file`",
            "the model that learned from made-up people",
        ),
        file => Ok(file.map(|file| ModelFile { file, made_up })),
    }
}

/// Roles with ids of their own, scores on the scale of the style, and repeats of what stands there.
fn roles(
    raw: Vec<RoleToml>,
    baseline: Option<&Baseline>,
    style: Option<&Style>,
) -> Checked<Vec<Role>> {
    let role = |r: RoleToml| Role {
        label: r.label.unwrap_or_else(|| r.id.to_string()),
        id: r.id,
        by: r.by,
        score: r.score,
        repeats: r.repeats,
    };
    let roles: Vec<Role> = raw.into_iter().map(role).collect();
    once("role", roles.iter().map(|r| r.id.to_string()))?;
    for role in &roles {
        if baseline.is_some_and(|b| b.id == role.id) {
            return refuse(
                "role.id",
                format!("`{}`, the baseline's", role.id),
                "another id: a role is driven otherwise than the baseline",
            );
        }
        if let Some(score) = role.score {
            let outside = style
                .and_then(|s| s.range)
                .is_some_and(|[low, high]| !(low..=high).contains(&score));
            if !score.is_finite() || style.is_none() || outside {
                return refuse(
                    "role.score",
                    format!("{score} of `{}`", role.id),
                    "points within the range of `[style]`, which says what they are points of",
                );
            }
        }
        let Some(repeats) = role.repeats else {
            continue;
        };
        let first = roles.iter().find(|r| r.id == repeats);
        if first.is_none_or(|r| r.repeats.is_some() || r.id == role.id) {
            return refuse(
                "role.repeats",
                format!("`{repeats}` of `{}`", role.id),
                "the id of another role that repeats none itself",
            );
        }
        if role.score.is_some() {
            return refuse(
                "role.score",
                format!("a score of `{}`, which repeats `{repeats}`", role.id),
                "no score: it has that of the role it repeats",
            );
        }
    }
    Ok(roles)
}

fn people(raw: PeopleToml) -> People {
    let wanted = |cells: BTreeMap<String, CellToml>| -> Wanted {
        cells.into_iter().map(|(k, v)| (k, v.text())).collect()
    };
    People {
        file: raw.file.unwrap_or_else(|| "participants.csv".into()),
        learn: raw.learn.map(wanted),
        test: raw.test.map(wanted),
    }
}

fn style(raw: StyleToml) -> Checked<Style> {
    if let Some([low, high]) = raw.range.filter(|ends| ScoreRange::try_from(*ends).is_err()) {
        return refuse(
            "style.range",
            format!("[{low}, {high}]"),
            "the lowest score, then a higher one, both finite",
        );
    }
    if let Some(points) = raw.points.filter(|p| !(p.is_finite() && *p > 0.0)) {
        return refuse("style.points", points, "above 0");
    }
    Ok(Style {
        label: raw.label.unwrap_or_else(|| raw.score.to_string()),
        score: raw.score,
        range: raw.range,
        points: raw.points,
        aggression: raw.aggression.unwrap_or(Sign::Plus),
    })
}

fn conditions(
    raw: Vec<ConditionToml>,
    style: Option<&Style>,
    learned: bool,
) -> Checked<Vec<Condition>> {
    if raw.len() > MOST_CONDITIONS {
        return refuse("condition", raw.len().to_string(), format!("at most {MOST_CONDITIONS}"));
    }
    let Some(first) = raw.first() else {
        return Ok(Vec::new());
    };
    once("condition.id", raw.iter().map(|c| c.id.to_string()))?;
    let label = |c: &ConditionToml| c.label.clone().unwrap_or_else(|| c.id.to_string());
    once("condition.label", raw.iter().map(label))?;
    let factors = |c: &ConditionToml| c.levels.keys().cloned().collect::<Vec<_>>();
    let expected = factors(first);
    if let Some(other) = raw.iter().find(|c| factors(c) != expected) {
        let quoted = |names: &[String]| match names {
            [] => "no factor".to_owned(),
            names => names.join(", "),
        };
        return refuse(
            format!("condition.{}.levels", other.id),
            quoted(&factors(other)),
            format!("{}, as in `{}`", quoted(&expected), first.id),
        );
    }
    for factor in &expected {
        let level = first.levels.get(factor);
        if raw.iter().all(|c| c.levels.get(factor) == level) {
            return refuse(
                format!("condition.levels.{factor}"),
                format!("`{}` in every condition", level.map_or("", String::as_str)),
                "at least two levels of a factor",
            );
        }
    }
    raw.into_iter().enumerate().map(|(place, c)| condition(place, c, style, learned)).collect()
}

fn condition(
    place: usize,
    raw: ConditionToml,
    style: Option<&Style>,
    learned: bool,
) -> Checked<Condition> {
    let key = |field: &str| format!("condition.{}.{field}", raw.id);
    let color = raw
        .color
        .as_ref()
        .map(|text| {
            text.parse().map_err(|()| {
                DesignError::key(key("color"), format!("`{text}`"), "#rrggbb, such as #0072B2")
            })
        })
        .transpose()?;
    let raw_car = raw.car.unwrap_or(CarToml { recorded: true, ..CarToml::default() });
    let recorded = raw_car.recorded;
    let car = car(&key("car"), raw_car, style)?;
    // What was driven is driven again without a model, and nowhere but where it was driven.
    let replayed = car == Some(Car::Replay);
    if car.is_some() && !replayed && !learned {
        return refuse(
            key("car"),
            "a learned car",
            "people to learn from (`[people] learn`), a `[model] file`, or `car = { recorded = true }` alone",
        );
    }
    Ok(Condition {
        label: raw.label.unwrap_or_else(|| raw.id.to_string()),
        id: raw.id,
        place,
        color,
        recorded: recorded || replayed || car.is_none(),
        car,
        levels: raw.levels,
        expected: raw.expected,
    })
}

fn exclude(rules: &Exclude) -> Checked<()> {
    let reasons = rules.people.iter().map(|(id, why)| (id.as_str(), why));
    let reasons = reasons.chain(rules.drives.iter().map(|(id, why)| (id.as_str(), why)));
    for (id, why) in reasons {
        if why.trim().is_empty() {
            return refuse(format!("exclude: {id}"), "an empty text", "the reason");
        }
    }
    let shortest = rules.drive_shorter_than_s;
    if let Some(seconds) = shortest.filter(|s| !(s.is_finite() && *s > 0.0)) {
        return refuse("exclude.drive_shorter_than_s", seconds, "seconds above 0");
    }
    Ok(())
}
