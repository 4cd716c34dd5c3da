//! Comparison of two results, number by number; differences are identified by their paths.

use serde_json::Value;

/// Relative tolerance: another processor may sum in another order.
pub const SHARE: f64 = 1e-9;
/// Absolute tolerance in any unit: differences of equal values are not exactly zero.
pub const NEAR: f64 = 1e-12;

/// A difference between two results.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Path in the first result: `quantities[4].values[17].measured`.
    pub path: String,
    /// Names of the list entries on the path: `Y_max, S05, Y_1R`.
    pub of: String,
    /// `None`: missing.
    pub before: Option<String>,
    pub after: Option<String>,
}

/// Result of a comparison.
#[derive(Clone, Debug, Default)]
pub struct Compared {
    pub differences: Vec<Difference>,
    /// Count of numbers compared.
    pub numbers: usize,
    /// Count of numbers that agree only within the tolerance.
    pub rounded: usize,
}

/// Keys that identify entries of a list, so that an additional entry does not change those after
/// it.
const NAMES: &[&str] = &[
    "id", "name", "path", "zone", "campaign", "section", "signal", "scope", "rule", "code",
    "channel",
];

/// Compares two results completely.
pub fn compare(before: &Value, after: &Value, at: &str) -> Compared {
    let mut compared = Compared::default();
    compared.values(before, after, &Way { path: at.to_string(), of: String::new() });
    compared
}

#[derive(Clone, Debug)]
struct Way {
    path: String,
    of: String,
}

impl Way {
    fn key(&self, key: &str) -> Self {
        let dot = if self.path.is_empty() { "" } else { "." };
        Self { path: format!("{}{dot}{key}", self.path), of: self.of.clone() }
    }

    fn entry(&self, at: usize, name: Option<&str>) -> Self {
        let of = match (name, self.of.as_str()) {
            (None, of) => of.to_string(),
            (Some(name), "") => name.to_string(),
            (Some(name), of) => format!("{of}, {name}"),
        };
        Self { path: format!("{}[{at}]", self.path), of }
    }
}

impl Compared {
    fn differs(&mut self, way: &Way, before: Option<&Value>, after: Option<&Value>) {
        self.differences.push(Difference {
            path: way.path.clone(),
            of: way.of.clone(),
            before: before.map(shown),
            after: after.map(shown),
        });
    }

    fn values(&mut self, before: &Value, after: &Value, way: &Way) {
        match (before, after) {
            (Value::Object(old), Value::Object(new)) => {
                // A version before has texts without the data that stand beside them now.
                let text_of = |key: &str| match key {
                    "data" => Some("says".to_owned()),
                    key => key.strip_suffix("_data").map(str::to_owned),
                };
                let both = |key: &String| old.contains_key(key) && new.contains_key(key);
                let text =
                    |key: &String| both(key) || !text_of(key).is_some_and(|text| both(&text));
                for (key, old) in old.iter().filter(|(key, _)| text(key)) {
                    match new.get(key) {
                        Some(new) => self.values(old, new, &way.key(key)),
                        None => self.differs(&way.key(key), Some(old), None),
                    }
                }
                for (key, new) in new.iter().filter(|(key, _)| text(key) && !old.contains_key(*key))
                {
                    self.differs(&way.key(key), None, Some(new));
                }
            }
            (Value::Array(old), Value::Array(new)) => self.lists(old, new, way),
            (Value::Number(old), Value::Number(new)) => {
                self.numbers += 1;
                match (old.as_f64(), new.as_f64()) {
                    _ if old == new => {}
                    (Some(old), Some(new))
                        if (old - new).abs() <= (SHARE * old.abs().max(new.abs())).max(NEAR) =>
                    {
                        self.rounded += 1
                    }
                    _ => self.differs(way, Some(before), Some(after)),
                }
            }
            _ if before == after => {}
            _ => self.differs(way, Some(before), Some(after)),
        }
    }

    fn lists(&mut self, old: &[Value], new: &[Value], way: &Way) {
        let names = |list: &[Value]| {
            list.iter().map(name).collect::<Option<Vec<String>>>().filter(|names| unique(names))
        };
        let (Some(old_names), Some(new_names)) = (names(old), names(new)) else {
            for (at, value) in old.iter().enumerate() {
                match new.get(at) {
                    Some(other) => {
                        self.values(value, other, &way.entry(at, name(value).as_deref()))
                    }
                    None => self.differs(&way.entry(at, name(value).as_deref()), Some(value), None),
                }
            }
            for (at, value) in new.iter().enumerate().skip(old.len()) {
                self.differs(&way.entry(at, name(value).as_deref()), None, Some(value));
            }
            return;
        };
        let places: std::collections::BTreeMap<&str, usize> =
            new_names.iter().enumerate().map(|(at, name)| (name.as_str(), at)).collect();
        for (at, (value, name)) in old.iter().zip(&old_names).enumerate() {
            match places.get(name.as_str()) {
                Some(&other) => self.values(value, &new[other], &way.entry(at, Some(name))),
                None => self.differs(&way.entry(at, Some(name)), Some(value), None),
            }
        }
        let known: std::collections::BTreeSet<&str> =
            old_names.iter().map(String::as_str).collect();
        for (at, (value, name)) in new
            .iter()
            .zip(&new_names)
            .enumerate()
            .filter(|(_, (_, name))| !known.contains(name.as_str()))
        {
            self.differs(&way.entry(at, Some(name)), None, Some(value));
        }
        // The same entries in another order.
        let kept = |names: &[String], of: &[String]| {
            let of: std::collections::BTreeSet<&String> = of.iter().collect();
            names.iter().filter(|name| of.contains(name)).cloned().collect::<Vec<_>>()
        };
        if kept(&old_names, &new_names) != kept(&new_names, &old_names) {
            let order = |names: &[String]| Value::String(names.join("; "));
            self.differs(&way.key("order"), Some(&order(&old_names)), Some(&order(&new_names)));
        }
    }
}

/// The name of an entry of a list; `None` if it has none.
fn name(value: &Value) -> Option<String> {
    let parts = NAMES.iter().filter_map(|key| match value.get(key)? {
        Value::String(text) if *key == "zone" => Some(format!("zone {text}")),
        Value::String(text) => Some(text.clone()),
        Value::Number(number) if *key == "zone" => Some(format!("zone {number}")),
        _ => None,
    });
    let parts: Vec<String> = parts.collect();
    (!parts.is_empty()).then(|| parts.join(", "))
}

fn unique(names: &[String]) -> bool {
    names.iter().collect::<std::collections::BTreeSet<_>>().len() == names.len()
}

/// A value on one line, shortened if long.
fn shown(value: &Value) -> String {
    const LONGEST: usize = 80;
    let text = match value {
        Value::Null => "nothing".into(),
        Value::String(text) => format!("`{text}`"),
        Value::Object(entries) => format!("an entry of {} keys", entries.len()),
        Value::Array(list) => format!("a list of {}", list.len()),
        other => other.to_string(),
    };
    if text.chars().count() <= LONGEST {
        text
    } else {
        text.chars().take(LONGEST).chain("…".chars()).collect()
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn paths(before: &Value, after: &Value) -> Vec<String> {
        compare(before, after, "")
            .differences
            .into_iter()
            .map(|one| format!("{} ({})", one.path, one.of))
            .collect()
    }

    #[test]
    fn entries_are_known_by_name_so_that_one_more_moves_nothing() {
        let before = json!({"values": [{"section": "S1", "signal": "a", "x": 1.0}, {"section": "S2", "signal": "a", "x": 2.0}]});
        let after = json!({"values": [{"section": "S2", "signal": "a", "x": 2.5}, {"section": "S3", "signal": "a", "x": 1.0}]});
        assert_eq!(
            paths(&before, &after),
            ["values[0] (S1, a)", "values[1].x (S2, a)", "values[1] (S3, a)"]
        );
        assert_eq!(
            paths(&json!([{"id": "a"}, {"id": "b"}]), &json!([{"id": "b"}, {"id": "a"}])),
            ["order ()"]
        );
    }

    #[test]
    fn rounding_is_no_difference_and_a_digit_is() {
        let compared = compare(&json!([1.0, 0.0, 3]), &json!([1.0 + 1e-12, 1e-13, 3]), "");
        assert_eq!((compared.differences.len(), compared.numbers, compared.rounded), (0, 3, 2));
        assert_eq!(paths(&json!({"a": 1.0}), &json!({"a": 1.000_001})), ["a ()"]);
        assert_eq!(paths(&json!({"a": null}), &json!({"a": 0})), ["a ()"]);
    }
}
