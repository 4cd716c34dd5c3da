//! Results in the form of the first versions, which state no `format`.

use serde_json::{Map, Value, json};

/// Whether results are in this form.
pub fn states_no_format(results: &Value) -> bool {
    results.get("format").is_none()
}

/// What they do not state, by its path: `*` is every entry of a list. The values stand for
/// nothing.
fn added() -> [(&'static str, Value); 11] {
    let scope = || json!({"scope_data": null});
    [
        ("", json!({"format": 0, "verdict_data": "not assessable"})),
        (
            "protocol",
            json!({
                "edition": null, "source": null, "scope": null, "notes": [], "filters": [],
                "channels": [], "graph_nodes": 0, "verdict_rule": "",
                "verdict_words": {"good": "", "bad": ""},
            }),
        ),
        ("campaign", json!({"report_data": [], "facts": []})),
        ("campaign.members.*", json!({"report_data": []})),
        (
            "quantities.*",
            json!({
                "symbol": "", "of": "", "filter": "", "processing": "", "comparison": "",
                "clause": null, "source": null, "notes": [], "has_sides": false, "from": null,
                "among": null, "against": null, "repeats": false, "spread": null,
            }),
        ),
        (
            "quantities.*.statistics.*",
            json!({
                "scope_data": null, "sample": {"mean": null, "std": null}, "regression": null,
                "divided_at": null, "outside": [], "limit_printed": "",
            }),
        ),
        ("quantities.*.reported.*", scope()),
        ("quantities.*.values.*", json!({"records": []})),
        ("reported.*", scope()),
        ("domain.*", scope()),
        ("sections.*", json!({"site": null})),
    ]
}

/// Calls a function with every object at a path.
fn each(value: &mut Value, path: &str, change: &mut dyn FnMut(&mut Map<String, Value>)) {
    let (first, rest) = path.split_once('.').unwrap_or((path, ""));
    match (first, value) {
        ("", Value::Object(entry)) => change(entry),
        ("*", Value::Array(list)) => list.iter_mut().for_each(|one| each(one, rest, change)),
        (key, Value::Object(entry)) => {
            entry.get_mut(key).into_iter().for_each(|one| each(one, rest, change));
        }
        _ => {}
    }
}

/// Brings results to the present form: adds what they do not state, and as data what they state
/// as text.
pub fn upgrade(results: &mut Value) {
    for (path, keys) in added() {
        each(results, path, &mut |entry| {
            for (key, value) in keys.as_object().into_iter().flatten() {
                let text = |key: &str| entry.get(key).and_then(Value::as_str).unwrap_or_default();
                let value = match key.as_str() {
                    "scope_data" => scope(text("scope"), entry.get("group")),
                    "records" => text("record").split(", ").collect(),
                    "site" => json!(text("section")),
                    "verdict_data" => match text("verdict") {
                        "requirements met" => json!("validated"),
                        "requirements not met" => json!("not validated"),
                        other => json!(other),
                    },
                    _ => value.clone(),
                };
                entry.entry(key).or_insert(value);
            }
        });
    }
}

/// What results of this format did not state at first.
const LATER: [&str; 9] = [
    "/language",
    "/template",
    "/provisional",
    "/deviations",
    "/protocol/own",
    "/protocol/shipped_edition",
    "/protocol/parameters_off_default",
    "/campaign/outside_table",
    "/removed",
];

/// Removes from results what those before do not state, of what may be missing, and adds the notes
/// that it replaces.
pub fn without_later(now: &mut Value, before: &Value) {
    for (key, at, note) in replaced(before) {
        if let Some(Value::Array(notes)) = now.get_mut(key) {
            notes.insert(at.min(notes.len()), note);
        }
    }
    if before.get("language").is_none() {
        now.get_mut("findings").into_iter().for_each(with_one_cause);
    }
    for pointer in LATER.into_iter().filter(|pointer| before.pointer(pointer).is_none()) {
        let (parent, key) = pointer.rsplit_once('/').unwrap_or_default();
        each(now, parent.trim_start_matches('/'), &mut |entry| drop(entry.shift_remove(key)));
    }
}

/// Findings with one cause each, of which two were one text.
fn with_one_cause(findings: &mut Value) {
    for finding in findings.as_array_mut().into_iter().flatten().filter_map(Value::as_object_mut) {
        let texts = finding.shift_remove("causes");
        let data = finding.shift_remove("causes_data");
        if let (Some(Value::Array(texts)), Some(Value::Array(data))) = (texts, data) {
            let texts: Vec<&str> = texts.iter().filter_map(Value::as_str).collect();
            finding.insert("cause".into(), texts.join("; ").into());
            let joined = data
                .into_iter()
                .reduce(|first, second| json!({"code": "both", "first": first, "second": second}));
            finding.insert("cause_data".into(), joined.unwrap_or_default());
        }
        finding.get_mut("explains").into_iter().for_each(with_one_cause);
    }
}

/// Removes the notes on values that are to be confirmed from results that do not list these values.
pub fn without_replaced(results: &mut Value) {
    for (key, at, _) in replaced(results).into_iter().rev() {
        results[key].as_array_mut().map(|notes| notes.remove(at));
    }
}

/// These notes: the list, the place in it, and the note.
fn replaced(results: &Value) -> Vec<(&'static str, usize, Value)> {
    let is_replaced = |note: &Value| match note.as_str() {
        Some(text) => text.starts_with("To be confirmed"),
        None => note["code"] == "to-be-confirmed",
    };
    let lists =
        ["notes", "notes_data"].into_iter().filter(|_| results.get("provisional").is_none());
    let notes = lists.flat_map(|key| {
        let notes = results.get(key).and_then(Value::as_array).into_iter().flatten().enumerate();
        notes.map(move |(at, note)| (key, at, note))
    });
    notes
        .filter(|(.., note)| is_replaced(note))
        .map(|(key, at, note)| (key, at, note.clone()))
        .collect()
}

/// Removes from results in the present form what those before did not state.
pub fn downgrade(results: &mut Value) {
    for (path, keys) in added().into_iter().filter(|(path, _)| *path != "sections.*") {
        each(results, path, &mut |entry| {
            entry.retain(|key, _| keys.get(key).is_none());
        });
    }
    if let Some(Value::Array(findings)) = results.get_mut("findings") {
        *findings = findings.iter().flat_map(of_each_place).collect();
    }
    sort_findings(results);
}

/// Brings findings into an order that does not depend on which of them were joined.
pub fn sort_findings(results: &mut Value) {
    if let Some(Value::Array(findings)) = results.get_mut("findings") {
        findings.sort_by_cached_key(ToString::to_string);
    }
}

/// A finding once for each of its places.
fn of_each_place(finding: &Value) -> Vec<Value> {
    let at_place = |place: &Value| {
        let mut finding = finding.clone();
        if let (Value::Object(finding), Value::Object(place)) = (&mut finding, place) {
            finding.remove("places");
            finding.extend(place.clone());
        }
        finding
    };
    finding["places"].as_array().into_iter().flatten().map(at_place).collect()
}

/// The data of a scope from its text: `zone 1, wheelset 2`. What is neither a zone nor one of the
/// keys is a condition.
fn scope(text: &str, keys: Option<&Value>) -> Value {
    let zones: Vec<&str> = match (text.strip_prefix("zone "), text.strip_prefix("zones ")) {
        (Some(one), _) => one.split(", ").take(1).collect(),
        (_, Some(all)) => all.split(", ").take_while(|zone| !zone.contains(' ')).collect(),
        _ => Vec::new(),
    };
    let mut keys = keys.cloned().unwrap_or_else(|| json!({}));
    let mut words: Vec<String> = Vec::new();
    if !zones.is_empty() {
        let plural = if zones.len() == 1 { "" } else { "s" };
        words.push(format!("zone{plural} {}", zones.join(", ")));
    }
    if let Some(keys) = keys.as_object_mut() {
        keys.shift_remove("zone");
        let word = |(key, member): (&String, &Value)| {
            format!("{key} {}", member.as_str().unwrap_or_default())
        };
        words.extend(keys.iter().map(word));
    }
    let known = words.join(", ");
    let rest = text.strip_prefix(known.as_str()).unwrap_or_default().trim_start_matches(", ");
    let condition = (!rest.is_empty() && rest != "all").then_some(rest);
    json!({"zones": zones, "keys": keys, "condition": condition})
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_causes_were_one_text() {
        let said = |says: &str| json!({"code": "said", "says": says});
        let finding =
            json!({"cause": "a", "causes": ["a", "b"], "causes_data": [said("a"), said("b")]});
        let none = json!({"cause": null, "causes": []});
        let mut now = json!({"language": "en", "findings": [finding, none]});
        without_later(&mut now, &json!({"findings": []}));
        let both = json!({"code": "both", "first": said("a"), "second": said("b")});
        let before = [json!({"cause": "a; b", "cause_data": both}), json!({"cause": null})];
        assert_eq!(now, json!({"findings": before}));
    }
}
