//! What an import did, in `origin.yaml`: the mapping, and for each record its source and the steps
//! with their numbers.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::problem::{Problem, Problems};
use crate::yaml::{self, Node};

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Imported {
    /// The text of the mapping.
    pub mapping: String,
    /// For each side what its channels were made of, `Y_1L = -ST1 Y li`.
    pub channels: Vec<(String, Vec<String>)>,
    pub records: Vec<ImportedRecord>,
}

/// How one record was made.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ImportedRecord {
    /// `measurement` or `simulation`.
    pub side: String,
    pub section: String,
    /// The file that it was read from, as the mapping names it.
    pub file: String,
    /// What was detected in the file.
    pub read_as: String,
    /// What was done, in order.
    pub steps: Vec<String>,
}

impl Imported {
    /// Reads the keys of an import; `None` if the origin has none.
    pub(super) fn read(node: &Node, problems: &mut Problems) -> Option<Self> {
        let mapping = node.get("mapping")?.scalar_text()?.to_string();
        let mut channels = Vec::new();
        for (key, list) in node.get("channels").map_or(&[][..], Node::entries) {
            channels.push((
                key.text.clone(),
                list.items().iter().map(|item| item.raw.clone()).collect(),
            ));
        }
        let mut records = Vec::new();
        for item in node.get("records").map_or(&[][..], Node::items) {
            if !matches!(item.value, yaml::Value::Map(_)) {
                let says =
                    format!("a record of `records` must be a map, not {}", item.kind_in_words());
                problems.push(Problem::error("wrong-kind", says).at(&item.span));
                continue;
            }
            let text = |key: &str| {
                item.get(key).and_then(Node::scalar_text).unwrap_or_default().to_string()
            };
            records.push(ImportedRecord {
                side: text("side"),
                section: text("section"),
                file: text("file"),
                read_as: text("read as"),
                steps: item
                    .get("steps")
                    .map_or(&[][..], Node::items)
                    .iter()
                    .map(|step| step.raw.clone())
                    .collect(),
            });
        }
        Some(Self { mapping, channels, records })
    }

    /// The entries of an import in `origin.yaml`.
    pub(super) fn entries(&self) -> [(String, Value); 3] {
        let records = self.records.iter().map(|record| {
            json!({
                "side": record.side,
                "section": record.section,
                "file": record.file,
                "read as": record.read_as,
                "steps": record.steps,
            })
        });
        let channels = self.channels.iter().map(|(side, lines)| (side.clone(), json!(lines)));
        [
            ("channels".into(), Value::Object(channels.collect())),
            ("records".into(), records.collect()),
            ("mapping".into(), json!(self.mapping.replace("\r\n", "\n"))),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::origin::Origin;
    use crate::source::Source;

    #[test]
    fn what_is_written_is_read_back() {
        let record = ImportedRecord {
            side: "measurement".into(),
            section: "S01".into(),
            file: "raw/Messung: S01.csv".into(),
            read_as: "csv; separator `;`".into(),
            steps: vec!["1794 rows at 200 Hz".into(), "- odd".into()],
        };
        let mut imported = Imported {
            mapping: "  name: x\n\n# remark: \"y\"\nmeasurement:\n  files: a\n".into(),
            channels: vec![
                ("measurement".into(), vec!["Y_1L = -ST1 Y li".into()]),
                ("simulation".into(), Vec::new()),
            ],
            records: vec![record, ImportedRecord::default()],
        };
        let own = imported.mapping.clone();
        for mapping in [
            own.as_str(),
            "name: \u{7}\n",
            "",
            "\n",
            "a\n\n\n",
            "\n\n a\n",
            "no",
            "\u{feff}a: \u{2028}\n",
            "a\tb \n \n",
        ] {
            imported.mapping = mapping.into();
            let mut problems = Problems::default();
            let origin = Origin { imported: Some(imported.clone()), ..Origin::default() };
            let text = origin.text();
            let node = yaml::load(&Source::new("origin.yaml", text.as_str()), &mut problems)
                .unwrap_or_else(|| panic!("{text}"));
            let found = Imported::read(&node, &mut problems);
            assert_eq!(found.as_ref(), Some(&imported), "{text}");
        }
        let node =
            yaml::load(&Source::new("o", "effects: []\n"), &mut Problems::default()).expect("YAML");
        assert_eq!(Imported::read(&node, &mut Problems::default()), None);
    }
}
