//! What an import did, in `origin.yaml`: the mapping, and for each record its source and the steps
//! with their numbers.

use serde::{Deserialize, Serialize};

use super::write::yaml_text;
use crate::problem::{Problem, Problems};
use crate::yaml::{Node, Value};

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
            if !matches!(item.value, Value::Map(_)) {
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

    pub(super) fn text(&self) -> String {
        let mut out = String::from("channels:\n");
        for (side, lines) in &self.channels {
            out +=
                &format!("  {}:{}\n", yaml_text(side), if lines.is_empty() { " []" } else { "" });
            out.extend(lines.iter().map(|line| format!("  - {}\n", yaml_text(line))));
        }
        if self.channels.is_empty() {
            out = "channels: {}\n".into();
        }
        out += if self.records.is_empty() { "records: []\n" } else { "records:\n" };
        for record in &self.records {
            for (index, (key, value)) in [
                ("side", &record.side),
                ("section", &record.section),
                ("file", &record.file),
                ("read as", &record.read_as),
            ]
            .into_iter()
            .enumerate()
            {
                out += &format!(
                    "{} {key}: {}\n",
                    if index == 0 { "-" } else { " " },
                    yaml_text(value)
                );
            }
            out += if record.steps.is_empty() { "  steps: []\n" } else { "  steps:\n" };
            out.extend(record.steps.iter().map(|step| format!("  - {}\n", yaml_text(step))));
        }
        out + &literal("mapping", &self.mapping)
    }
}

/// A text as a block in which its lines stand as they are; quoted if it has characters that a block
/// cannot hold.
fn literal(key: &str, text: &str) -> String {
    let text = text.replace("\r\n", "\n");
    let whole = text.trim_end_matches('\n');
    let plain = |letter: char| {
        letter == '\n'
            || !(letter.is_control()
                || matches!(letter, '\u{85}' | '\u{2028}' | '\u{2029}' | '\u{feff}'))
    };
    if whole.is_empty() || !whole.chars().all(plain) {
        return format!("{key}: {}\n", yaml_text(&text));
    }
    let lines: String = whole
        .split('\n')
        .map(|line| if line.is_empty() { "\n".to_string() } else { format!("  {line}\n") })
        .collect();
    format!("{key}: |2\n{lines}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;
    use crate::yaml;

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
        for mapping in [imported.mapping.clone(), "name: \u{7}\n".into()] {
            imported.mapping = mapping;
            let mut problems = Problems::default();
            let node = yaml::load(&Source::new("origin.yaml", imported.text()), &mut problems)
                .unwrap_or_else(|| panic!("{}", imported.text()));
            assert_eq!(
                Imported::read(&node, &mut problems).as_ref(),
                Some(&imported),
                "{}",
                imported.text()
            );
        }
        let node =
            yaml::load(&Source::new("o", "effects: []\n"), &mut Problems::default()).expect("YAML");
        assert_eq!(Imported::read(&node, &mut Problems::default()), None);
    }
}
