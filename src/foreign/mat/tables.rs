//! Variables of MATLAB as tables of channels.
//!
//! Four layouts are read: a matrix with a list of names; vectors of the same length; a list of
//! structs with a name and a vector each; and structs of these. Other variables are facts, if they
//! are short, or left out.

use super::super::{Channel, Read, Table, conflict, filled};
use super::{Fields, Value};
use crate::problem::Problem;

/// Fields with the sampling rate in Hz, and with the step in seconds, as toolboxes name them. The
/// names are compared in lower case.
const RATES: &[&str] = &[
    "fs",
    "f_s",
    "fa",
    "rate",
    "samplerate",
    "sample_rate",
    "sampling_rate",
    "samplingrate",
    "abtastrate",
];
const STEPS: &[&str] = &["dt", "ts", "step", "increment", "wf_increment", "abtastzeit"];

/// Beginnings of the fields with units.
const UNITS: &[&str] = &["unit", "einheit", "dim"];

/// Longest text and largest number of values of a fact.
const LONGEST_FACT: usize = 200;
const MOST_NUMBERS: usize = 4;

/// The tables of a file.
pub fn tables_of(variables: Fields, shown: &str) -> Result<Read, Vec<Problem>> {
    let mut read = Read::default();
    let mut loose: Fields = Vec::new();
    for (name, value) in variables {
        match value.of_structs() {
            // Units of the vectors beside it.
            Value::Structs(elements)
                if is_units(&name)
                    && elements
                        .iter()
                        .flatten()
                        .all(|(_, value)| matches!(value, Value::Text(_))) =>
            {
                loose.push((name, Value::Structs(elements)));
            }
            Value::Structs(elements) => add_structs(&name, elements, &mut read),
            other => loose.push((name, other)),
        }
    }
    if let Some(table) = table(String::new(), loose, &mut read.tables) {
        if table.channels.is_empty() {
            read.facts.extend(table.facts)
        } else {
            read.tables.insert(0, table)
        }
        // What was left out of a file without any table is told below.
    }
    if read.tables.iter().all(|table| table.channels.is_empty()) {
        let left: Vec<String> = read
            .tables
            .iter()
            .flat_map(|table| &table.left_out)
            .map(|(name, why)| format!("`{name}`: {why}"))
            .take(3)
            .collect();
        let says = format!(
            "`{shown}` has no channels: neither vectors of numbers nor a matrix with a list of names"
        );
        let problem = Problem::error("no-numbers", says);
        return Err(if left.is_empty() { problem } else { problem.help(left.join("; ")) }.into());
    }
    read.tables.retain(|table| !table.channels.is_empty());
    Ok(read)
}

/// A struct is a table; the elements of a struct array are several, or the channels of one.
fn add_structs(name: &str, elements: Vec<Fields>, read: &mut Read) {
    let several = elements.len() > 1;
    if several && let Some(channels) = listed(&elements) {
        read.tables.push(Table { name: name.into(), channels, ..Table::default() });
        return;
    }
    for (index, fields) in elements.into_iter().enumerate() {
        let name = if several { format!("{name}({})", index + 1) } else { name.to_string() };
        let at = read.tables.len();
        if let Some(table) = table(name, fields, &mut read.tables) {
            read.tables.insert(at, table);
        }
    }
}

/// Fields as one table; structs among them become tables of their own.
fn table(name: String, fields: Fields, others: &mut Vec<Table>) -> Option<Table> {
    if fields.is_empty() {
        return None;
    }
    let fields: Fields =
        fields.into_iter().map(|(name, value)| (name, value.of_structs())).collect();
    let mut table = Table { name, first_row: 1, ..Table::default() };
    facts(&fields, &mut table);
    if let Some((channels, used)) = matrix(&fields) {
        table.channels = channels;
        leave_out(fields.into_iter().filter(|(name, _)| !used.contains(name)), &mut table);
        return Some(table);
    }
    let (nested, flat): (Fields, Fields) =
        fields.into_iter().partition(|(_, value)| matches!(value, Value::Structs(_)));
    let units = nested.iter().find(|(name, _)| is_units(name)).cloned();
    let (nested, channels) = fields_as_channels(nested);
    table.channels.extend(channels);
    for (field, value) in nested {
        let Value::Structs(elements) = value else { continue };
        if units.as_ref().is_some_and(|(name, _)| *name == field) {
            continue;
        }
        // `signals` of Simulink, `Y` of dSPACE: their time is beside them.
        if let Some(channels) = listed(&elements) {
            table.channels.extend(channels);
            continue;
        }
        let path = if table.name.is_empty() { field } else { format!("{}.{field}", table.name) };
        let mut inner = Read::default();
        add_structs(&path, elements, &mut inner);
        others.append(&mut inner.tables);
    }
    vectors(flat, units.as_ref().map(|(_, value)| value), &mut table);
    Some(table)
}

/// Structs with a vector and its unit, one for each channel: `S.Y11.data`, `S.Y11.unit`. Two of the
/// same length at least; otherwise each is a table.
fn fields_as_channels(nested: Fields) -> (Fields, Vec<Channel>) {
    let channel = |(name, value): &(String, Value)| {
        let Value::Structs(elements) = value else { return None };
        let [fields] = &elements[..] else { return None };
        let mut vectors = fields.iter().filter_map(|(_, value)| match value {
            Value::Numbers { rows, columns, values } if values.len() > 1 => {
                Some((*rows == 1 || *columns == 1, values))
            }
            _ => None,
        });
        let plain =
            fields.iter().all(|(_, value)| matches!(value, Value::Numbers { .. } | Value::Text(_)));
        let (is_vector, values) = vectors.next().filter(|_| plain)?;
        let unit = fields.iter().find(|(name, _)| is_units(name)).and_then(|(_, unit)| unit.text());
        let (name, unit) = (name.clone(), unit.and_then(filled));
        let channel = Channel { name, unit, values: values.clone(), ..Channel::default() };
        (is_vector && vectors.next().is_none()).then(|| scaled(channel, fields, 0, 1))
    };
    let (found, others): (Fields, Fields) =
        nested.into_iter().partition(|field| channel(field).is_some());
    let channels: Vec<Channel> = found.iter().filter_map(channel).collect();
    let alike = channels.windows(2).all(|pair| pair[0].values.len() == pair[1].values.len());
    if channels.len() > 1 && alike {
        (others, channels)
    } else {
        (found.into_iter().chain(others).collect(), Vec::new())
    }
}

/// Fields with what the numbers are multiplied by, and with what is added then.
const SCALES: &[&str] = &[
    "scale",
    "scales",
    "scaling",
    "scalefactor",
    "scale_factor",
    "skalierung",
    "factor",
    "faktor",
    "gain",
    "slope",
];
const OFFSETS: &[&str] = &["offset", "offsets", "intercept"];

/// A channel with the scale and the offset of its number among so many, where fields state them.
fn scaled(mut channel: Channel, fields: &Fields, index: usize, count: usize) -> Channel {
    let number = |words: &[&str]| {
        let of = |name: &str| words.contains(&name.to_lowercase().as_str());
        fields.iter().filter(|(name, _)| of(name)).find_map(|(_, value)| match value {
            Value::Numbers { values, .. } if values.len() == count => values.get(index).copied(),
            _ => None,
        })
    };
    let (scale, offset) = (number(SCALES).unwrap_or(1.0), number(OFFSETS).unwrap_or(0.0));
    if (scale, offset) != (1.0, 0.0) {
        channel.values.iter_mut().for_each(|value| *value = *value * scale + offset);
        channel.comment = Some(format!("times {scale} plus {offset}, as the file states"));
    }
    channel
}

fn is_units(name: &str) -> bool {
    let name = name.to_lowercase();
    UNITS.iter().any(|unit| name.starts_with(unit))
}

impl Value {
    /// A cell array of structs as an array of structs.
    fn of_structs(self) -> Self {
        let single = |cell: &Self| matches!(cell, Self::Structs(elements) if elements.len() == 1);
        match self {
            Self::Cells(cells) if !cells.is_empty() && cells.iter().all(single) => {
                let elements = cells.into_iter().flat_map(|cell| match cell {
                    Self::Structs(elements) => elements,
                    _ => Vec::new(),
                });
                Self::Structs(elements.collect())
            }
            other => other,
        }
    }

    fn text(&self) -> Option<&str> {
        if let Self::Text(text) = self { Some(text) } else { None }
    }
}

/// The texts of a cell array, or the lines of a char matrix.
fn texts(value: &Value) -> Option<Vec<String>> {
    match value {
        Value::Cells(cells) => cells
            .iter()
            .map(|cell| match cell {
                Value::Text(text) => Some(text.clone()),
                // An empty cell is an empty array of numbers.
                Value::Numbers { values, .. } if values.is_empty() => Some(String::new()),
                _ => None,
            })
            .collect(),
        Value::Text(text) if text.contains('\n') => {
            Some(text.lines().map(|line| line.trim().to_string()).collect())
        }
        _ => None,
    }
}

/// A matrix with a list of names as long as it has columns, or else rows: its channels, and the
/// fields that they are made of.
fn matrix(fields: &Fields) -> Option<(Vec<Channel>, Vec<String>)> {
    let data = fields.iter().filter_map(|(name, value)| match value {
        Value::Numbers { rows, columns, values } if *rows > 1 || *columns > 1 => {
            Some((name, *rows, *columns, values))
        }
        _ => None,
    });
    let (data, rows, columns, values) = data.max_by_key(|(.., values)| values.len())?;
    let lists: Vec<(&String, Vec<String>)> =
        fields.iter().filter_map(|(name, value)| texts(value).map(|texts| (name, texts))).collect();
    let (names_field, names) = lists
        .iter()
        .find(|(name, list)| !is_units(name) && (list.len() == columns || list.len() == rows))?;
    let count = names.len();
    let units = lists.iter().find(|(name, list)| is_units(name) && list.len() == count);
    let by_column = count == columns;
    let channel = |index: usize| Channel {
        name: names[index].trim().to_string(),
        unit: units.and_then(|(_, units)| filled(&units[index])),
        values: if by_column {
            values[index * rows..(index + 1) * rows].to_vec()
        } else {
            values.iter().skip(index).step_by(rows).copied().collect()
        },
        ..Channel::default()
    };
    let mut used = vec![data.clone(), (*names_field).clone()];
    used.extend(units.map(|(name, _)| (*name).clone()));
    let channel = |index: usize| scaled(channel(index), fields, index, count);
    Some(((0..count).map(channel).collect(), used))
}

/// Elements with a vector of numbers and a name each: `Y(3).Name`, `Y(3).Data`, `Y(3).Unit`.
fn listed(elements: &[Fields]) -> Option<Vec<Channel>> {
    let channel = |fields: &Fields| {
        // The first text that is a unit or none.
        let text = |unit: bool| {
            fields
                .iter()
                .filter(|(name, _)| is_units(name) == unit)
                .find_map(|(_, value)| value.text())
        };
        let vectors = fields.iter().filter_map(|(_, value)| match value {
            Value::Numbers { rows, columns, values } if *rows == 1 || *columns == 1 => Some(values),
            _ => None,
        });
        let longest =
            vectors.max_by_key(|values| values.len()).filter(|values| values.len() > 1)?;
        let (name, unit) = (filled(text(false)?)?, text(true).and_then(filled));
        let channel = Channel { name, unit, values: longest.clone(), ..Channel::default() };
        Some(scaled(channel, fields, 0, 1))
    };
    let channels: Option<Vec<Channel>> = elements.iter().map(channel).collect();
    channels.filter(|channels| !channels.is_empty())
}

/// Vectors, each a channel; those that are not of the most frequent length are left out.
fn vectors(fields: Fields, units: Option<&Value>, table: &mut Table) {
    let lengths: Vec<usize> = fields
        .iter()
        .filter_map(|(_, value)| length(value))
        .chain(table.channels.iter().map(|channel| channel.values.len()))
        .collect();
    let count = |length: usize| lengths.iter().filter(|other| **other == length).count();
    let rows = lengths.iter().copied().max_by_key(|length| (count(*length), *length));
    let of_struct: Fields = match units {
        Some(Value::Structs(elements)) => elements.first().cloned().unwrap_or_default(),
        _ => Fields::new(),
    };
    let beside: Fields =
        fields.iter().filter(|(_, value)| value.text().is_some()).cloned().collect();
    // In the struct of units, or beside the vector: `y_unit`.
    let unit_of = |name: &str| {
        let texts = |list: &Fields, known: &dyn Fn(&str) -> bool| {
            let mut texts = list.iter().filter(|(field, _)| known(field));
            texts.find_map(|(_, value)| value.text()).map(|text| text.trim().to_string())
        };
        let ends = ["_unit", "_units", "_einheit"].map(|end| format!("{name}{end}"));
        let of_struct = texts(&of_struct, &|field| field == name).and_then(|unit| filled(&unit));
        let beside = texts(&beside, &|field| ends.iter().any(|end| end == field));
        let beside = beside.and_then(|unit| filled(&unit));
        let other_unit = conflict(of_struct.as_deref(), beside.clone());
        (of_struct.or(beside), other_unit)
    };
    let mut rest = Vec::new();
    for (name, value) in fields {
        match value {
            Value::Numbers { rows: high, columns: wide, values }
                if length_of(high, wide).is_some() && length_of(high, wide) == rows =>
            {
                let rows = rows.unwrap_or(1).max(1);
                let several = values.len() / rows > 1;
                for (index, part) in values.chunks(rows).enumerate() {
                    let name =
                        if several { format!("{name}({})", index + 1) } else { name.clone() };
                    let ((unit, other_unit), values) = (unit_of(&name), part.to_vec());
                    let channel = Channel { name, unit, other_unit, values, ..Channel::default() };
                    table.channels.push(channel);
                }
            }
            other => rest.push((name, other)),
        }
    }
    leave_out(rest.into_iter(), table);
}

/// Number of samples of a vector, or of the columns of a matrix that is higher than wide; `None`
/// for a single number.
fn length(value: &Value) -> Option<usize> {
    match value {
        Value::Numbers { rows, columns, .. } => length_of(*rows, *columns),
        _ => None,
    }
}

fn length_of(rows: usize, columns: usize) -> Option<usize> {
    match (rows, columns) {
        (1, 1) | (0, _) | (_, 0) => None,
        (1, columns) => Some(columns),
        (rows, _) => Some(rows),
    }
}

fn leave_out(fields: impl Iterator<Item = (String, Value)>, table: &mut Table) {
    for (name, value) in fields {
        let why = match value {
            Value::Other(why) => why.to_string(),
            Value::Numbers { rows, columns, .. } if rows * columns > MOST_NUMBERS => {
                format!("it has {rows} x {columns} values, unlike the channels")
            }
            Value::Cells(_) => "a cell array".into(),
            Value::Structs(_) => "a struct beside the matrix".into(),
            Value::Text(text) if text.len() > LONGEST_FACT => "a long text".into(),
            Value::Text(_) | Value::Numbers { .. } => continue,
        };
        table.left_out.push((name, why));
    }
}

/// Short texts and a few numbers are facts; some of them state the rate.
fn facts(fields: &Fields, table: &mut Table) {
    for (name, value) in fields {
        let lower = name.to_lowercase();
        match value {
            Value::Text(text) if text.len() <= LONGEST_FACT && !text.is_empty() => {
                table.facts.push((name.clone(), text.clone()))
            }
            Value::Numbers { values, .. } if (1..=MOST_NUMBERS).contains(&values.len()) => {
                let words: Vec<String> = values.iter().map(f64::to_string).collect();
                table.facts.push((name.clone(), words.join(" ")));
                let number = values[0];
                if number.is_finite() && number > 0.0 && values.len() == 1 && table.rate.is_none() {
                    if RATES.contains(&lower.as_str()) {
                        table.rate = Some(number);
                    } else if STEPS.contains(&lower.as_str()) {
                        table.rate = Some(1.0 / number);
                    }
                }
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(rows: usize, columns: usize) -> Value {
        Value::Numbers { rows, columns, values: (0..rows * columns).map(|at| at as f64).collect() }
    }

    fn cells(texts: &[&str]) -> Value {
        Value::Cells(texts.iter().map(|text| Value::Text((*text).into())).collect())
    }

    fn text(text: &str) -> Value {
        Value::Text(text.into())
    }

    fn fields(list: Vec<(&str, Value)>) -> Fields {
        list.into_iter().map(|(name, value)| (name.to_string(), value)).collect()
    }

    fn read(list: Vec<(&str, Value)>) -> Vec<Table> {
        tables_of(fields(list), "f").expect("tables").tables
    }

    fn described(table: &Table) -> Vec<String> {
        table
            .channels
            .iter()
            .map(|channel| {
                format!(
                    "{} {} {:?}",
                    channel.name,
                    channel.unit.as_deref().unwrap_or("?"),
                    channel.values
                )
            })
            .collect()
    }

    #[test]
    fn a_matrix_with_names_may_lie_either_way() {
        for data in [
            numbers(3, 2),
            Value::Numbers { rows: 2, columns: 3, values: vec![0.0, 3.0, 1.0, 4.0, 2.0, 5.0] },
        ] {
            let element = fields(vec![
                ("names", cells(&["t", "y"])),
                ("units", cells(&["s", "kN"])),
                ("data", data),
                ("fs", numbers(1, 1)),
            ]);
            let tables = read(vec![("S01", Value::Structs(vec![element]))]);
            assert_eq!(described(&tables[0]), ["t s [0.0, 1.0, 2.0]", "y kN [3.0, 4.0, 5.0]"]);
            assert_eq!((tables[0].name.as_str(), tables[0].facts.len()), ("S01", 1));
        }
    }

    #[test]
    fn vectors_are_channels() {
        let units = Value::Structs(vec![fields(vec![("y", text("kN"))])]);
        let tables = read(vec![
            ("t", numbers(3, 1)),
            ("y", numbers(1, 3)),
            ("t_unit", text("s")),
            ("units", units),
            ("x0", numbers(1, 1)),
            ("z", numbers(1, 7)),
        ]);
        assert_eq!(described(&tables[0]), ["t s [0.0, 1.0, 2.0]", "y kN [0.0, 1.0, 2.0]"]);
        assert_eq!(
            tables[0].left_out.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
            ["z"]
        );
    }

    #[test]
    fn lists_of_structs_are_channels() {
        let element = |name: &str| {
            fields(vec![("Name", text(name)), ("Unit", text("kN")), ("Data", numbers(1, 3))])
        };
        let tables = read(vec![("Y", Value::Structs(vec![element("a"), element("b")]))]);
        assert_eq!(described(&tables[0]), ["a kN [0.0, 1.0, 2.0]", "b kN [0.0, 1.0, 2.0]"]);
    }

    #[test]
    fn a_file_without_channels_is_refused() {
        assert!(
            tables_of(fields(vec![("a", text("x"))]), "f")
                .is_err_and(|problems| problems[0].code == "no-numbers")
        );
    }
}
