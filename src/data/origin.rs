//! Origin of the records of a campaign written by a program: `origin.yaml`, named by the key
//! `origin` of `campaign.yaml`.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use crate::units::number::significant;
use crate::yaml::{FromNode, Key, Literal, Node, Reader, fields};

/// Name of the file.
pub const ORIGIN_FILE: &str = "origin.yaml";
/// The key of `campaign.yaml`.
pub const ORIGIN_KEY: &str = "origin";

fields! {
    /// Origin of the simulated records of a campaign. Keys of other programs are ignored.
    #[derive(Default, PartialEq, Serialize, Deserialize)]
    pub struct Origin: "an origin" or Ignored {
        /// Program and version.
        "program" program: Literal = Literal::default(),
        /// `simulate`, `diagnose` or `import`.
        "command" command: Literal = Literal::default(),
        /// Name of the campaign whose simulation was first changed.
        "campaign" campaign: Literal = Literal::default(),
        #[serde(skip_serializing_if = "Option::is_none")]
        "simulator" simulator: Option<String>,
        /// Effects in the simulated records, in the order in which they were added.
        "effects" effects: Vec<OriginEffect>,
        /// Measured records to which the sizes of the effects were fitted.
        #[serde(rename = "fitted to")]
        "fitted to" fitted_to: Vec<OriginFile>,
        /// Files from which the records were computed.
        "sources" sources: Vec<OriginFile>,
    } also {
        /// What an import did, if records were imported.
        #[serde(flatten)]
        imported: Option<Imported> = imported,
    }
}

fields! {
    /// An effect with its size.
    #[derive(Default, PartialEq, Serialize, Deserialize)]
    pub struct OriginEffect: "an effect of an origin" or Ignored {
        "effect" effect: String,
        "parameters" parameters: Vec<OriginParameter>,
        /// Channels of the effect; empty for an effect on the vehicle.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        "channels" channels: Vec<String>,
        /// Sections of the effect, if not all: `zone 3, 4`.
        #[serde(rename = "confined to", skip_serializing_if = "Option::is_none")]
        "confined to" confined_to: Option<String>,
    }
}

fields! {
    /// A parameter of an effect.
    #[derive(PartialEq, Serialize, Deserialize)]
    pub struct OriginParameter: "a parameter of an effect" or Ignored {
        "name" name: String,
        "value" value: f64,
        "unit" unit: String,
    }
}

fields! {
    /// A file by its path in its campaign.
    #[derive(PartialEq, Serialize, Deserialize)]
    pub struct OriginFile: "a file of an origin" or Ignored {
        "path" path: String,
        "sha256" sha256: String,
    }
}

impl OriginEffect {
    /// `friction = 0.23`, `sensor_gain: gain = 0.8 on Y_3R`, `payload: payload.mass = 3500 kg in
    /// zone 4`
    pub fn in_words(&self, equals: &str) -> String {
        let mut words = self.effect.clone();
        match &self.parameters[..] {
            [] => {}
            [one] => words += &format!("{equals}{}", one.in_words()),
            several => {
                let each =
                    several.iter().map(|one| format!("{}{equals}{}", one.name, one.in_words()));
                words += &format!(" ({})", each.collect::<Vec<_>>().join(", "));
            }
        }
        if !self.channels.is_empty() {
            words += &format!(" on {}", self.channels.join(", "));
        }
        if let Some(place) = &self.confined_to {
            words += &format!(" in {place}");
        }
        words
    }
}

impl OriginParameter {
    /// Three significant digits for a sentence; the file has all digits.
    fn in_words(&self) -> String {
        let rounded = significant(self.value, 3);
        match self.unit.as_str() {
            "-" => rounded.to_string(),
            unit => format!("{rounded} {unit}"),
        }
    }
}

impl Origin {
    /// Effects for a sentence: `friction = 0.23 and payload = 3500 kg`.
    pub fn effects_in_words(&self, equals: &str) -> String {
        self.effects.iter().map(|effect| effect.in_words(equals)).collect::<Vec<_>>().join(" and ")
    }

    /// The records of a side as an import wrote them; none if another program wrote them since.
    pub fn imported_records(&self, side: &str) -> impl Iterator<Item = &OriginFile> {
        let all = self.imported.iter().flat_map(|imported| &imported.records);
        all.filter(move |record| record.side == side).filter_map(|record| record.written.as_ref())
    }

    /// The text of `origin.yaml`.
    pub fn text(&self) -> String {
        // Texts, numbers and lists can always be written.
        serde_yaml::to_string(self).unwrap_or_default()
    }
}

/// What an import did, if there was one: it states its mapping.
fn imported<C>(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Imported> {
    node.get("mapping")?;
    Imported::from_node(reader, key, node)
}

fields! {
    /// What an import did: the mapping, and for each record its source and the steps.
    #[derive(Default, PartialEq, Serialize, Deserialize)]
    pub struct Imported: "an import" or Ignored {
        /// For each side what its channels were made of, `Y_1L = -ST1 Y li`.
        "channels" channels: IndexMap<String, Vec<String>>,
        "records" records: Vec<ImportedRecord>,
        /// The text of the mapping.
        "mapping" mapping: Literal,
    }
}

fields! {
    /// How one record was made.
    #[derive(PartialEq, Serialize, Deserialize)]
    pub struct ImportedRecord: "a record of an import" or Ignored {
        /// `measurement`, `simulation` or `track`.
        "side" side: String,
        "section" section: String,
        /// The file that it was read from, as the mapping names it.
        "file" file: String,
        /// What was detected in the file.
        #[serde(rename = "read as")]
        "read as" read_as: String,
        /// What was done, in order.
        "steps" steps: Vec<String>,
    } also {
        /// The record in the campaign, as it was written: its `path` and `sha256`.
        #[serde(flatten)]
        written: Option<OriginFile> = written,
    }
}

/// The record that was written, if its path is stated.
fn written<C>(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<OriginFile> {
    node.get("path")?;
    OriginFile::from_node(reader, key, node)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::Problems;
    use crate::source::Source;
    use crate::yaml;

    fn read(text: &str) -> (Option<Origin>, Problems) {
        let mut problems = Problems::default();
        let node = yaml::load(&Source::new("origin.yaml", text), &mut problems).expect("YAML");
        let before = problems.errors();
        let origin: Option<Origin> = Reader { with: (), problems: &mut problems }.file(&node);
        (origin.filter(|_| problems.errors() == before), problems)
    }

    #[test]
    fn what_is_written_is_read_back() {
        let effect = |name: &str, parameters: &[(&str, f64, &str)]| OriginEffect {
            effect: name.into(),
            parameters: parameters
                .iter()
                .map(|(name, value, unit)| OriginParameter {
                    name: (*name).into(),
                    value: *value,
                    unit: (*unit).into(),
                })
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
            program: Literal("fishplate 0.1.0".into()),
            command: Literal("diagnose".into()),
            campaign: Literal("Coach: first".into()),
            simulator: Some("x: y".into()),
            effects: vec![
                effect("friction", &[("friction", 0.230_417, "-")]),
                gain,
                effect("payload", &[("a", 3500.0, "kg"), ("b", -0.1, "m")]),
            ],
            fitted_to: vec![file("measurement/S01.csv")],
            sources: vec![file("campaign.yaml"), file("track/S01.csv")],
            imported: Some(Imported {
                mapping: Literal("  name: x\n\n# remark: \"y\"\nmeasurement:\n  files: a\n".into()),
                channels: [
                    ("measurement".into(), vec!["Y_1L = -ST1 Y li".into()]),
                    ("simulation".into(), Vec::new()),
                ]
                .into(),
                records: vec![ImportedRecord {
                    side: "measurement".into(),
                    section: "S01".into(),
                    file: "raw/Messung: S01.csv".into(),
                    read_as: "csv; separator `;`".into(),
                    steps: vec!["1794 rows at 200 Hz".into(), "- odd".into()],
                    written: Some(OriginFile {
                        path: "measurement/S01.csv".into(),
                        sha256: "12e4".into(),
                    }),
                }],
            }),
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
        for odd in [
            "name: \u{7}\n",
            "",
            "\n",
            "a\n\n\n",
            "\n\n a\n",
            "no",
            "\u{feff}a: \u{2028}\n",
            "a\tb \n \n",
        ] {
            let imported = Some(Imported { mapping: Literal(odd.into()), ..Imported::default() });
            let least = Origin { program: Literal("x".into()), imported, ..Origin::default() };
            assert_eq!(read(&least.text()).0, Some(least));
        }
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
                        .all(|problem| ["wrong-kind", "key-missing"].contains(&problem.code)
                            && problem.at.is_some()),
                "{text}"
            );
        }
        assert!(read("mapping: map.yaml\n").0.is_some());
    }
}
