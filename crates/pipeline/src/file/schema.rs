//! The JSON schema of pipeline files, from the same list of keys that the reader checks.

use serde_json::{Map, Value, json};

use super::keys::{Key, Kind, TOP_KEYS};

const NAME: &str = "^[A-Za-z0-9][A-Za-z0-9_-]*$";

/// The JSON schema of pipeline files, by which editors complete keys and explain them.
///
/// # Example
/// ```
/// let schema = maveric_pipeline::schema();
/// assert_eq!(schema["required"], serde_json::json!(["name"]));
/// ```
pub fn schema() -> Value {
    let mut schema = table(TOP_KEYS);
    schema["$schema"] = json!("http://json-schema.org/draft-07/schema#");
    schema["anyOf"] = json!([{"required": ["stage"]}, {"required": ["extends"]}]);
    schema["title"] = json!("A pipeline: stages, their commands, inputs and outputs");
    schema
}

fn table(keys: &[Key]) -> Value {
    let property = |key: &Key| {
        let mut value = of_kind(key.kind);
        value["description"] = json!(key.about);
        (key.name.to_owned(), value)
    };
    let required = keys.iter().filter(|key| key.required).map(|key| key.name);
    json!({
        "type": "object",
        "additionalProperties": false,
        "required": required.collect::<Vec<_>>(),
        "properties": keys.iter().map(property).collect::<Map<_, _>>(),
    })
}

fn of_kind(kind: Kind) -> Value {
    let single = json!({"type": ["string", "number", "boolean"]});
    match kind {
        Kind::Name => json!({"type": "string", "pattern": NAME}),
        Kind::Text => json!({"type": "string"}),
        Kind::Texts => json!({"type": "array", "items": {"type": "string"}}),
        Kind::Flag => json!({"type": "boolean"}),
        Kind::Count => json!({"type": "integer", "minimum": 1}),
        Kind::Values => json!({
            "type": "object",
            "propertyNames": {"pattern": NAME},
            "additionalProperties": single,
        }),
        Kind::Lists => json!({
            "type": "object",
            "propertyNames": {"pattern": NAME},
            "additionalProperties": {"type": "array", "minItems": 1, "items": single},
        }),
        Kind::Table(keys) => table(keys),
        Kind::Tables(keys) => json!({"type": "array", "minItems": 1, "items": table(keys)}),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_of_a_stage_is_explained() {
        let schema = schema();
        let stage = &schema["properties"]["stage"]["items"]["properties"];
        for (name, property) in stage.as_object().unwrap() {
            let about = property["description"].as_str().unwrap();
            assert!(about.len() > 20, "{name}");
        }
        assert_eq!(stage["resources"]["properties"]["cpus"]["minimum"], 1);
    }
}
