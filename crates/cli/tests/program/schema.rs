//! The subset of JSON Schema 2020-12 that `docs/schemas` uses: type, properties, required, items,
//! additionalProperties, const, enum.

use serde_json::Value;
use std::path::{Path, PathBuf};

/// Path of the schemas, relative to a crate.
pub(crate) fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/schemas")
}

/// Checks a document against the schema that it names, `bulge.shape/1` against `shape.json`, and that it
/// fails without any of the required fields. Returns the name, and the number of these fields.
pub(crate) fn holds(document: &Value) -> (String, usize) {
    let name = document["schema"].as_str().unwrap();
    let kind = name.strip_prefix("bulge.").unwrap().strip_suffix("/1").unwrap().to_owned();
    let schema = std::fs::read_to_string(folder().join(format!("{kind}.json"))).unwrap();
    let schema: Value = serde_json::from_str(&schema).unwrap();
    assert_eq!(complaints(&schema, document), Vec::<String>::new(), "{kind}");
    let fields = without_one(&schema, document);
    for (place, without) in &fields {
        assert!(!complaints(&schema, without).is_empty(), "{kind} without {place} is not noticed");
    }
    (kind, fields.len())
}

/// Keywords without effect on validity.
const WORDS: [&str; 4] = ["$schema", "$id", "title", "description"];

/// Violations of a schema by a value: paths and reasons. An unknown keyword is a violation too.
fn complaints(schema: &Value, value: &Value) -> Vec<String> {
    let mut found = Vec::new();
    check(schema, value, "", &mut found);
    found
}

fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "boolean",
        Value::Number(_) => "number",
        Value::String(_) => "string",
        Value::Array(_) => "array",
        Value::Object(_) => "object",
    }
}

fn check(schema: &Value, value: &Value, at: &str, found: &mut Vec<String>) {
    for (keyword, says) in schema.as_object().unwrap() {
        match keyword.as_str() {
            "type" => {
                let kinds: Vec<&Value> =
                    says.as_array().map_or_else(|| vec![says], |all| all.iter().collect());
                if !kinds.iter().any(|name| *name == kind(value)) {
                    found.push(format!("{at} is {}, not {says}", kind(value)));
                }
            }
            "const" if says != value => found.push(format!("{at} is {value}, not {says}")),
            "enum" if !says.as_array().unwrap().contains(value) => {
                found.push(format!("{at} is {value}, none of {says}"));
            }
            "required" => {
                let names = says.as_array().unwrap().iter().map(|name| name.as_str().unwrap());
                let absent =
                    names.filter(|name| value.as_object().is_some_and(|object| !object.contains_key(*name)));
                found.extend(absent.map(|name| format!("{at}.{name} is missing")));
            }
            "properties" => {
                for (name, inner) in value.as_object().into_iter().flatten() {
                    if let Some(schema) = says.get(name) {
                        check(schema, inner, &format!("{at}.{name}"), found);
                    }
                }
            }
            "additionalProperties" => {
                let known = schema.get("properties");
                for (name, inner) in value.as_object().into_iter().flatten() {
                    if known.is_none_or(|known| known.get(name).is_none()) {
                        check(says, inner, &format!("{at}.{name}"), found);
                    }
                }
            }
            "items" => {
                for (place, inner) in value.as_array().into_iter().flatten().enumerate() {
                    check(says, inner, &format!("{at}[{place}]"), found);
                }
            }
            "const" | "enum" => {}
            word if WORDS.contains(&word) => {}
            other => found.push(format!("{at}: the schema says `{other}`, which isn't checked")),
        }
    }
}

/// For each field that the schema requires, the document without it (in lists only in the first object), with
/// the path of the field.
fn without_one(schema: &Value, document: &Value) -> Vec<(String, Value)> {
    let mut places = Vec::new();
    required(schema, document, "", &mut places);
    let without = |pointer: String| {
        let mut document = document.clone();
        let (parent, name) = pointer.rsplit_once('/').unwrap();
        document.pointer_mut(parent).unwrap().as_object_mut().unwrap().remove(name).unwrap();
        (pointer, document)
    };
    places.into_iter().map(without).collect()
}

fn required(schema: &Value, value: &Value, at: &str, places: &mut Vec<String>) {
    let names = schema.get("required").and_then(Value::as_array).into_iter().flatten();
    let own = names.filter_map(Value::as_str).filter(|name| value.get(name).is_some());
    places.extend(own.map(|name| format!("{at}/{name}")));
    for (name, inner) in schema.get("properties").and_then(Value::as_object).into_iter().flatten() {
        if let Some(value) = value.get(name) {
            required(inner, value, &format!("{at}/{name}"), places);
        }
    }
    if let (Some(inner), Some(first)) = (schema.get("items"), value.get(0)) {
        required(inner, first, &format!("{at}/0"), places);
    }
}
