//! The JSON schema of `study.toml`, from the types that read it.

use super::toml_file::DesignToml;
use schemars::{generate::SchemaSettings, transform::transform_subschemas};
use serde_json::Value;

/// Returns the JSON schema of `study.toml`, by which editors complete keys and explain them.
pub fn schema() -> Value {
    let settings = SchemaSettings::draft07().with(|settings| {
        settings.inline_subschemas = true;
        settings.transforms.push(Box::new(for_editors));
    });
    let mut schema = settings.into_generator().into_root_schema_for::<DesignToml>();
    schema.insert("title".into(), "study.toml: the design of a study".into());
    schema.into()
}

/// TOML has no null, and an editor shows one paragraph.
fn for_editors(schema: &mut schemars::Schema) {
    transform_subschemas(&mut for_editors, schema);
    let Some(object) = schema.as_object_mut() else {
        return;
    };
    object.remove("title");
    object.remove("format");
    let is_told = |default: &Value| match default {
        Value::Null | Value::Object(_) => false,
        Value::Array(list) => !list.is_empty(),
        _ => true,
    };
    if !object.get("default").is_some_and(is_told) {
        object.remove("default");
    }
    if let Some(Value::String(text)) = object.get_mut("description") {
        let first = text.split("\n\n").next().unwrap_or_default();
        *text = first.replace('\n', " ");
    }
    if let Some(Value::Array(types)) = object.get_mut("type") {
        types.retain(|name| name != "null");
        if let [one] = &types[..] {
            let one = one.clone();
            object.insert("type".to_owned(), one);
        }
    }
    if let Some(Value::Array(words)) = object.get_mut("enum") {
        words.retain(|word| !word.is_null());
    }
    if let Some(Value::Array(any)) = object.get_mut("anyOf") {
        any.retain(|one| one["type"] != "null");
        if let [Value::Object(one)] = &any[..] {
            let one = one.clone();
            object.remove("anyOf");
            for (key, value) in one {
                object.entry(key).or_insert(value);
            }
        }
    }
}
