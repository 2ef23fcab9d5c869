//! The JSON schemas that the program prints, against the files that it ships.

use crate::support::{TempStudy, argv, root};
use serde_json::{Value, json};

fn printed(command: &str) -> Value {
    let text = TempStudy::new().maveric(&argv(command)).ok().stdout;
    serde_json::from_str(&text).unwrap()
}

/// The TOML files of a folder of the project that `is_one` picks, with their paths.
fn shipped(folder: &str, is_one: impl Fn(&Value) -> bool) -> Vec<(String, Value)> {
    let files = crate::support::files(&root().join(folder)).into_iter();
    let toml = files.filter(|path| path.extension().is_some_and(|end| end == "toml"));
    let read = |path: std::path::PathBuf| {
        let text = std::fs::read_to_string(&path).unwrap();
        (path.display().to_string(), toml::from_str::<Value>(&text).unwrap())
    };
    toml.map(read).filter(|(_, value)| is_one(value)).collect()
}

#[test]
fn shipped_designs_keep_to_the_printed_schema() {
    let schema = printed("design schema");
    let designs = shipped("study_data/designs", |_| true);
    assert!(!designs.is_empty());
    for (path, design) in designs {
        assert_eq!(fault(&schema, &design, &path), None);
    }
    let wrong = |design: Value| fault(&schema, &design, "").is_some();
    let right = json!({"study": {"title": "t"}, "condition": [{"id": "a", "car": {"dial": 0}}]});
    assert!(!wrong(right));
    assert!(wrong(json!({})), "without [study]");
    assert!(wrong(json!({"study": {"titel": "t"}})));
    assert!(wrong(json!({"study": {"title": 1}})));
    assert!(wrong(json!({"study": {"title": "t"}, "protocol": {"world": "mine"}})));
    assert!(wrong(json!({"study": {"title": "t"}, "style": {"score": "a.b", "range": [1]}})));
    assert!(wrong(json!({"study": {"title": "t"}, "protocol": {"rides_per_condition": 0}})));
}

#[test]
fn shipped_pipelines_keep_to_the_printed_schema() {
    let schema = printed("graph --format schema");
    let pipelines =
        shipped("pipelines", |file| file.get("stage").or(file.get("extends")).is_some());
    assert!(pipelines.len() > 5);
    for (path, pipeline) in pipelines {
        assert_eq!(fault(&schema, &pipeline, &path), None);
    }
    let stage = json!({"name": "a", "cmd": ["x"]});
    let wrong = |pipeline: Value| fault(&schema, &pipeline, "").is_some();
    assert!(!wrong(json!({"name": "p", "stage": [stage]})));
    assert!(wrong(json!({"name": "p"})), "no stage");
    assert!(wrong(json!({"name": "p", "stage": [stage], "fetch": {"a": "s3://b"}})));
}

#[test]
fn every_key_of_a_schema_is_explained() {
    for command in ["design schema", "graph --format schema"] {
        let mut keys = 0;
        explained(&printed(command), command, &mut keys);
        assert!(keys > 15, "{command}: {keys}");
    }
}

fn explained(schema: &Value, at: &str, keys: &mut usize) {
    for (key, property) in schema["properties"].as_object().into_iter().flatten() {
        let about = property["description"].as_str().unwrap_or_default();
        let is_plain = !about.contains('\n') && !about.contains("[`");
        assert!(about.ends_with('.') && is_plain, "{at}.{key}: {about:?}");
        *keys += 1;
    }
    let parts: Vec<(&String, &Value)> = match schema {
        Value::Object(object) => object.iter().collect(),
        _ => Vec::new(),
    };
    for (key, part) in parts {
        explained(part, &format!("{at}.{key}"), keys);
        for one in part.as_array().into_iter().flatten() {
            explained(one, &format!("{at}.{key}"), keys);
        }
    }
}

/// Words of a schema that are for people, or that the reader itself checks.
const PASSED_OVER: [&str; 8] = [
    "$schema",
    "title",
    "description",
    "default",
    "pattern",
    "propertyNames",
    "uniqueItems",
    "maxLength",
];

/// Where a value does not keep to a schema; `None` if it does.
fn fault(schema: &Value, value: &Value, at: &str) -> Option<String> {
    let rules = match schema {
        Value::Bool(true) => return None,
        Value::Object(rules) => rules,
        other => return Some(format!("{at}: no schema but {other}")),
    };
    let says = |what: &str| Some(format!("{at}: {value} is not of {what}"));
    for (rule, asked) in rules {
        let alternatives = || asked.as_array().into_iter().flatten();
        let fit = || alternatives().filter(|one| fault(one, value, at).is_none()).count();
        let number = || value.as_f64().zip(asked.as_f64());
        let count = || value.as_array().zip(asked.as_u64());
        let holds = match rule.as_str() {
            "type" if asked.is_array() => alternatives().any(|one| is_of(value, one)),
            "type" => is_of(value, asked),
            "enum" => alternatives().any(|one| one == value),
            "const" => asked == value,
            "anyOf" => fit() > 0,
            "oneOf" => fit() == 1,
            "allOf" => fit() == alternatives().count(),
            "minimum" => number().is_none_or(|(value, end)| value >= end),
            "exclusiveMinimum" => number().is_none_or(|(value, end)| value > end),
            "maximum" => number().is_none_or(|(value, end)| value <= end),
            "minItems" => count().is_none_or(|(list, end)| list.len() as u64 >= end),
            "maxItems" => count().is_none_or(|(list, end)| list.len() as u64 <= end),
            "minProperties" => value.as_object().is_none_or(|o| !o.is_empty()),
            "required" => value.as_object().is_none_or(|object| {
                alternatives().all(|key| object.contains_key(key.as_str().unwrap_or_default()))
            }),
            "properties" | "additionalProperties" | "items" => true,
            word => PASSED_OVER.contains(&word),
        };
        if !holds {
            return says(&format!("`{rule}` {asked}"));
        }
    }
    let object = value.as_object().into_iter().flatten();
    let mut in_object = object.map(|(key, inside)| {
        let property = schema["properties"].get(key);
        let schema = property.or(rules.get("additionalProperties"))?;
        if schema == false {
            return Some(format!("{at}: no key `{key}` in the schema"));
        }
        fault(schema, inside, &format!("{at}.{key}"))
    });
    let list = value.as_array().zip(rules.get("items"));
    let mut in_list = list.into_iter().flat_map(|(list, schema)| {
        let each = list.iter().enumerate();
        each.map(move |(i, one)| fault(schema, one, &format!("{at}[{i}]")))
    });
    in_object.find_map(|found| found).or_else(|| in_list.find_map(|found| found))
}

fn is_of(value: &Value, kind: &Value) -> bool {
    match kind.as_str().unwrap_or_default() {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        _ => false,
    }
}
