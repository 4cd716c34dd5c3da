//! Records, tables and `campaign.yaml` as text, in the format of the readers.

use std::fmt::Write;

use super::{
    columnar::{FileColumn, Values, parquet, rows_of},
    digits::Digits,
};
use crate::data::{format::Format, prelude::*};

/// A column to be written: values in SI units, its unit, and its number of decimals.
#[derive(Clone, Copy, Debug)]
pub struct OutColumn<'a> {
    pub name: &'a str,
    pub unit: &'a Unit,
    pub values: &'a [f64],
    pub decimals: usize,
}

impl OutColumn<'_> {
    fn heading(&self) -> String {
        format!("{} [{}]", self.name, self.unit)
    }
}

/// A record with a header line `name [unit],...` and one line per sample of the shortest column.
///
/// # Errors
/// `not-finite`: the first value that is not finite, by column and row of the file.
pub fn record_csv(columns: &[OutColumn<'_>]) -> Result<String, Problem> {
    let rows = columns.iter().map(|column| column.values.len()).min().unwrap_or(0);
    let mut text = table_csv(&[columns.iter().map(OutColumn::heading).collect::<Vec<_>>()]);
    text.reserve(rows * columns.len() * 8);
    for row in 0..rows {
        for (at, column) in columns.iter().enumerate() {
            let value = column.unit.from_si(column.values[row]);
            if !value.is_finite() {
                return Err(problem!(
                    "not-finite",
                    "the value of `{}` in row {} is not finite",
                    column.name,
                    row + 2
                ));
            }
            text.push_str(if at == 0 { "" } else { "," });
            push_number(&mut text, value, column.decimals);
        }
        text.push('\n');
    }
    Ok(text)
}

/// A record in a format. Both formats hold the same numbers, with the decimals of the columns.
///
/// # Errors
/// As [`record_csv`], and `write-failed`.
pub fn record(format: Format, columns: &[OutColumn<'_>]) -> Result<Vec<u8>, Problem> {
    let text = record_csv(columns)?;
    if format == Format::Csv {
        return Ok(text.into_bytes());
    }
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); columns.len()];
    for line in text.lines().skip(1) {
        let numbers = line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN));
        values.iter_mut().zip(numbers).for_each(|(values, number)| values.push(number));
    }
    let file = |(column, values): (&OutColumn<'_>, Vec<f64>)| FileColumn {
        heading: column.heading(),
        values: Values::Numbers(values),
        digits: Some(Digits::Decimals(column.decimals)),
    };
    parquet(&columns.iter().zip(values).map(file).collect::<Vec<_>>())
}

/// The bytes of a file with these columns.
///
/// # Errors
/// As [`parquet()`].
pub fn in_format(format: Format, columns: &[FileColumn]) -> Result<Vec<u8>, Problem> {
    match format {
        Format::Csv => Ok(csv(columns)),
        Format::Parquet => parquet(columns),
    }
}

/// The bytes of a text with these columns.
pub fn csv(columns: &[FileColumn]) -> Vec<u8> {
    let headings: Vec<&str> = columns.iter().map(|column| column.heading.as_str()).collect();
    (csv_header(&headings) + &csv_rows(columns)).into_bytes()
}

/// The first line of the text of a record.
pub fn csv_header(headings: &[&str]) -> String {
    table_csv(&[headings])
}

/// The other lines. Numbers have the form of their column, or else the fewest digits that give the
/// same double again.
pub fn csv_rows(columns: &[FileColumn]) -> String {
    let mut text = String::new();
    for row in 0..rows_of(columns) {
        for (at, column) in columns.iter().enumerate() {
            text.push_str(if at == 0 { "" } else { "," });
            match &column.values {
                Values::Numbers(values) => {
                    let value = values.get(row).copied().unwrap_or(f64::NAN);
                    text.push_str(&Digits::exact(column.digits, value));
                }
                Values::Texts(texts) => {
                    push_cell(&mut text, texts.get(row).map_or("", String::as_str));
                }
            }
        }
        text.push('\n');
    }
    text
}

/// Line breaks cannot stand in a cell of a record: they become blanks.
fn push_cell(text: &mut String, cell: &str) {
    if cell.contains([',', '"', '\n', '\r']) || cell.trim() != cell {
        let _ = write!(text, "\"{}\"", cell.replace('"', "\"\"").replace(['\n', '\r'], " "));
    } else {
        text.push_str(cell);
    }
}

/// Writes a number, but never `-0.00`.
fn push_number(text: &mut String, value: f64, decimals: usize) {
    let start = text.len();
    // Writing to a string cannot fail.
    let _ = write!(text, "{value:.decimals$}");
    if text[start..].starts_with('-')
        && text[start..].bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'))
    {
        text.remove(start);
    }
}

/// Rows of cells as CSV, quoted where needed; the header is the first row.
pub fn table_csv<S: AsRef<[u8]>>(rows: &[impl AsRef<[S]>]) -> String {
    let mut writer = csv::WriterBuilder::new().flexible(true).from_writer(Vec::new());
    // Writing to memory and rows of different length cannot fail.
    rows.iter().for_each(|row| drop(writer.write_record(row.as_ref())));
    writer.into_inner().ok().and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_default()
}

/// The value of a key in `campaign.yaml`.
#[derive(Clone, Copy, Debug)]
pub enum Entry<'a> {
    Text(&'a str),
    Number(f64),
    /// As read from another file.
    Node(&'a Node),
}

/// `campaign.yaml` or another map of keys and values.
pub fn campaign_yaml(entries: &[(&str, Entry<'_>)]) -> String {
    let mut text = String::new();
    for (key, entry) in entries {
        text += &yaml_text(key);
        text.push(':');
        match entry {
            Entry::Text(value) => text += &format!(" {}\n", yaml_text(value)),
            Entry::Number(value) => text += &format!(" {value}\n"),
            Entry::Node(node) => push_node(&mut text, node, 1),
        }
    }
    text
}

/// The text of a `campaign.yaml` with other entries in place of some keys; the new ones stand last.
pub fn campaign_yaml_with(tree: &Node, without: &[&str], new: &[(&str, Entry<'_>)]) -> String {
    let kept = tree.entries().iter().filter(|(key, _)| !without.contains(&key.text.as_str()));
    let kept = kept.map(|(key, node)| (key.text.as_str(), Entry::Node(node)));
    campaign_yaml(&kept.chain(new.iter().copied()).collect::<Vec<_>>())
}

/// The value after a key or a dash, with its line break.
fn push_node(text: &mut String, node: &Node, depth: usize) {
    let indent = " ".repeat(2 * depth);
    match &node.value {
        Value::List(items) if items.is_empty() => text.push_str(" []\n"),
        Value::Map(entries) if entries.is_empty() => text.push_str(" {}\n"),
        Value::List(items) => {
            text.push('\n');
            for item in items {
                *text += &format!("{indent}-");
                push_node(text, item, depth + 1);
            }
        }
        Value::Map(entries) => {
            text.push('\n');
            for (key, value) in entries {
                *text += &format!("{indent}{}:", yaml_text(&key.text));
                push_node(text, value, depth + 1);
            }
        }
        Value::Text(value) => *text += &format!(" {}\n", yaml_text(value)),
        Value::Null => text.push('\n'),
        Value::Bool(_) | Value::Number(_) => *text += &format!(" {}\n", node.raw),
    }
}

/// A text as a YAML scalar that is read back as the same text: plain if this is certain, else in
/// double quotes.
pub fn yaml_text(value: &str) -> String {
    const WORDS: [&str; 10] = ["true", "false", "null", "yes", "no", "on", "off", "y", "n", "~"];
    // A unit in brackets may follow a word; `: ` and ` #` may not, so texts with colons and hashes
    // are quoted.
    let plain = value.starts_with(|letter: char| letter.is_alphabetic() || letter == '_')
        && value
            .chars()
            .all(|letter| letter.is_alphanumeric() || " _-./^()[]²³µ°%,;+*=".contains(letter))
        && !value.ends_with(' ')
        && !WORDS.contains(&value.to_lowercase().as_str());
    if plain {
        return value.to_string();
    }
    let mut text = String::from("\"");
    for letter in value.chars() {
        match letter {
            '"' => text.push_str("\\\""),
            '\\' => text.push_str("\\\\"),
            '\n' => text.push_str("\\n"),
            '\t' => text.push_str("\\t"),
            _ if letter.is_control()
                || matches!(
                    letter,
                    '\u{feff}' | '\u{2028}' | '\u{2029}' | '\u{fffe}' | '\u{ffff}'
                ) =>
            {
                text += &format!("\\U{:08x}", u32::from(letter));
            }
            _ => text.push(letter),
        }
    }
    text.push('"');
    text
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::problem::Problems;
    use crate::source::Source;
    use crate::yaml;

    fn load(text: &str) -> Node {
        let mut problems = Problems::default();
        yaml::load(&Source::new("t", text), &mut problems)
            .unwrap_or_else(|| panic!("{text}\n{}", problems.render(false)))
    }

    /// Equality of trees without places.
    fn same(a: &Node, b: &Node) -> bool {
        match (&a.value, &b.value) {
            (Value::List(a), Value::List(b)) => {
                a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b))
            }
            (Value::Map(a), Value::Map(b)) => {
                a.len() == b.len()
                    && a.iter().zip(b).all(|(a, b)| a.0.text == b.0.text && same(&a.1, &b.1))
            }
            (a, b) => a == b,
        }
    }

    #[test]
    fn numbers_have_the_decimals_asked_for() {
        let unit = Unit::parse("kN").expect("known");
        let time = Unit::parse("s").expect("known");
        let columns = [
            OutColumn { name: "time", unit: &time, values: &[0.0, 0.005], decimals: 3 },
            OutColumn { name: "Y", unit: &unit, values: &[-1.0, 1234.567], decimals: 2 },
        ];
        assert_eq!(record_csv(&columns), Ok("time [s],Y [kN]\n0.000,0.00\n0.005,1.23\n".into()));
        let bad = [OutColumn { name: "Y", unit: &unit, values: &[1.0, f64::NAN], decimals: 2 }];
        assert!(record_csv(&bad).is_err_and(|problem| problem.says.contains("row 3")));
    }

    #[test]
    fn a_tree_is_read_back_as_it_was() {
        let root = load(
            "a: {b: [1.50, no, 'x: y', [], {}], c: ~, 'd e [kN]': true}\nf: \"5\"\ng:\n- - 1\n  - k: v\n",
        );
        let entries: Vec<_> = root
            .entries()
            .iter()
            .map(|(key, node)| (key.text.as_str(), Entry::Node(node)))
            .collect();
        let text = campaign_yaml(&entries);
        assert!(same(&root, &load(&text)), "{text}");
    }

    proptest! {
        #[test]
        fn any_text_is_read_back(key in "[^\u{0}]{1,12}", value in any::<String>()) {
            let text = campaign_yaml(&[(key.as_str(), Entry::Text(&value)), ("number \u{0}", Entry::Number(0.1))]);
            let root = load(&text);
            prop_assert_eq!(&root.entries()[0].0.text, &key);
            prop_assert_eq!(&root.entries()[0].1.value, &Value::Text(value));
            prop_assert_eq!(root.entries()[1].1.number(), Some(0.1));
        }
    }
}
