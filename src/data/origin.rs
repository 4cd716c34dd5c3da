//! Origin of the records of a campaign written by a program: `origin.yaml`, named by the key
//! `origin` of `campaign.yaml`.

pub use super::imported::{Imported, ImportedRecord};

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::problem::{Problem, Problems};
use crate::yaml::{self, Node};

/// Name of the file.
pub const ORIGIN_FILE: &str = "origin.yaml";
/// The key of `campaign.yaml`.
pub const ORIGIN_KEY: &str = "origin";

/// Origin of the simulated records of a campaign.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// Program and version.
    pub program: String,
    /// `simulate`, `diagnose` or `import`.
    pub command: String,
    /// Name of the campaign whose simulation was first changed.
    pub campaign: String,
    pub simulator: Option<String>,
    /// Effects in the simulated records, in the order in which they were added.
    pub effects: Vec<OriginEffect>,
    /// Measured records to which the sizes of the effects were fitted.
    pub fitted_to: Vec<OriginFile>,
    /// Files from which the records were computed.
    pub sources: Vec<OriginFile>,
    /// What an import did, if records were imported.
    pub imported: Option<Imported>,
}

/// An effect with its size.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OriginEffect {
    pub effect: String,
    /// Name, value, unit.
    pub parameters: Vec<(String, f64, String)>,
    /// Channels of the effect; empty for an effect on the vehicle.
    pub channels: Vec<String>,
    /// Sections of the effect, if not all: `zone 3, 4`.
    pub confined_to: Option<String>,
}

/// A file by its path in its campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OriginFile {
    pub path: String,
    pub sha256: String,
}

impl OriginEffect {
    fn value(&self) -> Value {
        let parameters = self.parameters.iter();
        let parameters: Vec<Value> = parameters
            .map(|(name, value, unit)| json!({ "name": name, "value": value, "unit": unit }))
            .collect();
        let mut all = json!({ "effect": self.effect, "parameters": parameters });
        if !self.channels.is_empty() {
            all["channels"] = json!(self.channels);
        }
        if let Some(sections) = &self.confined_to {
            all["confined to"] = json!(sections);
        }
        all
    }

    /// `friction = 0.23`, `sensor_gain: gain = 0.8 on Y_3R`, `payload: payload.mass = 3500 kg in
    /// zone 4`
    pub fn in_words(&self, equals: &str) -> String {
        let value = |value: f64, unit: &str| {
            format!(
                "{}{}",
                short(value),
                if unit == "-" { String::new() } else { format!(" {unit}") }
            )
        };
        let mut words = match &self.parameters[..] {
            [(_, one, unit)] => format!("{}{equals}{}", self.effect, value(*one, unit)),
            [] => self.effect.clone(),
            several => {
                let all: Vec<String> = several
                    .iter()
                    .map(|(name, one, unit)| format!("{name}{equals}{}", value(*one, unit)))
                    .collect();
                format!("{} ({})", self.effect, all.join(", "))
            }
        };
        if !self.channels.is_empty() {
            words = format!("{words} on {}", self.channels.join(", "));
        }
        self.confined_to.as_ref().map_or(words.clone(), |place| format!("{words} in {place}"))
    }
}

/// Three significant digits for a sentence; the file has all digits.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    format!("{rounded}")
}

impl Origin {
    /// Effects for a sentence: `friction = 0.23 and payload = 3500 kg`.
    pub fn effects_in_words(&self, equals: &str) -> String {
        self.effects.iter().map(|effect| effect.in_words(equals)).collect::<Vec<_>>().join(" and ")
    }

    /// Reads the file, or the map in `campaign.yaml`. Unknown keys, from other programs, are
    /// ignored.
    ///
    /// Problems: `wrong-kind`.
    pub fn read(node: &Node, problems: &mut Problems) -> Option<Self> {
        if !matches!(node.value, yaml::Value::Map(_)) {
            let says =
                format!("an origin must be a map of keys and values, not {}", node.kind_in_words());
            problems.push(Problem::error("wrong-kind", says).at(&node.span));
            return None;
        }
        let before = problems.errors();
        let text = |key: &str| node.get(key).and_then(Node::scalar_text).map(str::to_string);
        let origin = Self {
            program: text("program").unwrap_or_default(),
            command: text("command").unwrap_or_default(),
            campaign: text("campaign").unwrap_or_default(),
            simulator: text("simulator"),
            effects: items(node, "effects", problems)
                .into_iter()
                .filter_map(|node| effect(node, problems))
                .collect(),
            fitted_to: items(node, "fitted to", problems)
                .into_iter()
                .filter_map(|node| file(node, problems))
                .collect(),
            sources: items(node, "sources", problems)
                .into_iter()
                .filter_map(|node| file(node, problems))
                .collect(),
            imported: Imported::read(node, problems),
        };
        (problems.errors() == before).then_some(origin)
    }

    /// The text of `origin.yaml`.
    pub fn text(&self) -> String {
        let files = |files: &[OriginFile]| {
            files.iter().map(|file| json!({ "path": file.path, "sha256": file.sha256 })).collect()
        };
        let (fitted_to, sources): (Vec<Value>, Vec<Value>) =
            (files(&self.fitted_to), files(&self.sources));
        let effects: Vec<Value> = self.effects.iter().map(OriginEffect::value).collect();
        let mut all = json!({
            "program": self.program,
            "command": self.command,
            "campaign": self.campaign,
            "simulator": self.simulator,
            "effects": effects,
            "fitted to": fitted_to,
            "sources": sources,
        });
        let imported = self.imported.as_ref().map(Imported::entries);
        if let Value::Object(all) = &mut all {
            all.retain(|_, value| !value.is_null());
            all.extend(imported.into_iter().flatten());
        }
        // Texts, numbers, lists and maps can always be written.
        serde_yaml::to_string(&all).unwrap_or_default()
    }
}

/// The items of an optional list.
fn items<'a>(node: &'a Node, key: &str, problems: &mut Problems) -> Vec<&'a Node> {
    match node.get(key) {
        None => Vec::new(),
        Some(list) => match &list.value {
            yaml::Value::List(items) => items.iter().collect(),
            yaml::Value::Null => Vec::new(),
            _ => {
                let says = format!("`{key}` must be a list, not {}", list.kind_in_words());
                problems.push(Problem::error("wrong-kind", says).at(&list.span));
                Vec::new()
            }
        },
    }
}

fn text(node: &Node, key: &str, problems: &mut Problems) -> Option<String> {
    let found = node.get(key).and_then(Node::scalar_text).map(str::to_string);
    if found.is_none() {
        problems.push(
            Problem::error("wrong-kind", format!("`{key}` must be given, as text")).at(&node.span),
        );
    }
    found
}

fn file(node: &Node, problems: &mut Problems) -> Option<OriginFile> {
    Some(OriginFile {
        path: text(node, "path", problems)?,
        sha256: text(node, "sha256", problems)?,
    })
}

fn effect(node: &Node, problems: &mut Problems) -> Option<OriginEffect> {
    let effect = text(node, "effect", problems)?;
    let mut parameters = Vec::new();
    for one in items(node, "parameters", problems) {
        let Some(value) = one.get("value").and_then(Node::number) else {
            problems.push(
                Problem::error("wrong-kind", "a parameter must have a `value` that is a number")
                    .at(&one.span),
            );
            continue;
        };
        parameters.push((text(one, "name", problems)?, value, text(one, "unit", problems)?));
    }
    let channels = items(node, "channels", problems)
        .iter()
        .filter_map(|one| one.scalar_text().map(str::to_string))
        .collect();
    let confined_to = node.get("confined to").and_then(Node::scalar_text).map(str::to_string);
    Some(OriginEffect { effect, parameters, channels, confined_to })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;

    fn read(text: &str) -> (Option<Origin>, Problems) {
        let mut problems = Problems::default();
        let node = yaml::load(&Source::new("origin.yaml", text), &mut problems).expect("YAML");
        (Origin::read(&node, &mut problems), problems)
    }

    #[test]
    fn what_is_written_is_read_back() {
        let effect = |name: &str, parameters: &[(&str, f64, &str)]| OriginEffect {
            effect: name.into(),
            parameters: parameters
                .iter()
                .map(|(name, value, unit)| ((*name).into(), *value, (*unit).into()))
                .collect(),
            ..OriginEffect::default()
        };
        let gain = OriginEffect {
            channels: vec!["Y_3R".into()],
            confined_to: Some("zone 3, 4".into()),
            ..effect("sensor_gain", &[("gain: \"odd\"", 0.812_345, "-")])
        };
        let file = |path: &str| OriginFile { path: path.into(), sha256: "00ff".repeat(16) };
        let origin = Origin {
            program: "fishplate 0.1.0".into(),
            command: "diagnose".into(),
            campaign: "Coach: first".into(),
            simulator: Some("x: y".into()),
            effects: vec![
                effect("friction", &[("friction", 0.230_417, "-")]),
                gain,
                effect("payload", &[("a", 3500.0, "kg"), ("b", -0.1, "m")]),
            ],
            fitted_to: vec![file("measurement/S01.csv")],
            sources: vec![file("campaign.yaml"), file("track/S01.csv")],
            imported: Some(Imported { mapping: "name: x\n".into(), ..Imported::default() }),
        };
        let (found, problems) = read(&origin.text());
        assert_eq!(
            (found.as_ref(), problems.0.len()),
            (Some(&origin), 0),
            "{}",
            problems.render(false)
        );
        assert_eq!(
            origin.effects_in_words(" = "),
            "friction = 0.23 and sensor_gain = 0.812 on Y_3R in zone 3, 4 and payload (a = 3500 kg, b = -0.1 m)"
        );
        assert_eq!(read(&Origin::default().text()).0, Some(Origin::default()));
    }

    #[test]
    fn what_is_no_origin_is_told() {
        for text in [
            "- 1\n",
            "effects: friction\n",
            "effects:\n- 1\n",
            "fitted to:\n- path: a\n",
            "effects:\n- effect: a\n  parameters:\n  - name: a\n",
        ] {
            let (found, problems) = read(text);
            assert!(
                found.is_none()
                    && problems
                        .0
                        .iter()
                        .all(|problem| problem.code == "wrong-kind" && problem.at.is_some()),
                "{text}"
            );
        }
        assert!(read("mapping: map.yaml\n").0.is_some());
    }
}
