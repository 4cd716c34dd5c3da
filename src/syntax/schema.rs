//! The JSON Schema of the YAML form. Editors use it to complete and check protocols.

use serde_json::{Map, Value, json};

use super::keys::{KINDS, Key, Kind, Sort};

/// The schema (draft 2020-12), generated from [`KINDS`].
pub fn json_schema() -> Value {
    let groups: Map<String, Value> =
        KINDS.iter().map(|kind| (kind.group.to_owned(), group(kind))).collect();
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Fishplate protocol",
        "description": "A validation protocol in its YAML form.",
        "type": "object",
        "properties": groups,
        "required": ["protocol"],
        "additionalProperties": false,
        "$defs": {
            "text": { "type": "string", "minLength": 1 },
            "phrase": { "type": ["string", "number", "boolean"], "minLength": 1 },
            "name": { "type": "string", "pattern": "^[A-Za-z0-9_][A-Za-z0-9_.-]*$" },
            "family_name": { "type": "string", "pattern": "^([A-Za-z0-9_]|\\{[A-Za-z0-9_]+\\})([A-Za-z0-9_.-]|\\{[A-Za-z0-9_]+\\})*$" }
        }
    })
}

fn group(kind: &Kind) -> Value {
    if kind.single {
        let mut block = block(kind);
        block.insert("type".into(), json!("object"));
        if kind.named {
            if let Some(Value::Object(fields)) = block.get_mut("properties") {
                fields.shift_insert(
                    0,
                    "name".into(),
                    json!({ "$ref": "#/$defs/name", "description": "The name that other protocols use." }),
                );
            }
            block.insert("required".into(), json!(["name"]));
        }
        return Value::Object(block);
    }
    json!({
        "description": kind.about,
        "type": "object",
        "propertyNames": { "$ref": if kind.has_families() { "#/$defs/family_name" } else { "#/$defs/name" } },
        "additionalProperties": block(kind)
    })
}

/// The fields of one block; a block without fields can be empty.
fn block(kind: &Kind) -> Map<String, Value> {
    let mut fields = Map::new();
    fields.insert(
        "title".into(),
        json!({ "$ref": "#/$defs/text", "description": "The title in reports." }),
    );
    fields.extend(kind.keys.iter().map(|key| (key.word.to_owned(), field(key))));
    let mut block = Map::new();
    block.insert("description".into(), json!(kind.about));
    block.insert("type".into(), json!(["object", "null"]));
    block.insert("properties".into(), Value::Object(fields));
    block.insert("additionalProperties".into(), json!(false));
    block
}

fn field(key: &Key) -> Value {
    let one = match key.sort {
        Sort::Text => json!({ "$ref": "#/$defs/text" }),
        Sort::Phrase => json!({ "$ref": "#/$defs/phrase" }),
    };
    let mut field = Map::new();
    field.insert("description".into(), json!(key.about));
    field.insert("examples".into(), json!([key.example]));
    if key.many || key.list {
        field
            .insert("anyOf".into(), json!([one, { "type": "array", "items": one, "minItems": 1 }]));
    } else if let Value::Object(one) = one {
        field.extend(one);
    }
    Value::Object(field)
}
