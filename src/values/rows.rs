//! The table of values as columns: those that a reader needs, and beside them the exact numbers in
//! SI, from which sections are judged.

use std::{
    collections::{BTreeSet, HashMap},
    sync::Arc,
};

use arrow_array::{
    Array, ArrayRef, Float64Array, RecordBatch, StringArray, UInt64Array,
    cast::AsArray,
    types::{Float64Type, UInt64Type},
};
use arrow_schema::{ArrowError, Field, Schema};

use super::Values;
use crate::check::plan::{DatumKind, Evaluation, Plan, Quantity, Scalar};
use crate::result::{FileHash, RecordName};
use crate::run::{Row, SectionValues, Unit};

const QUANTITY: &str = "quantity";
const SECTION: &str = "section";
const SIGNAL: &str = "signal";
const RECORD: &str = "record";
/// The names in `record`, of which there may be two.
const RECORDS: [&str; 2] = ["first_record", "second_record"];
const SAMPLES: &str = "samples";
/// Which of several values of a quantity.
const WHICH: &str = "which";
const SIMULATED_SI: &str = "simulated_si";
const MEASURED_SI: &str = "measured_si";
const VALUE_SI: &str = "value_si";
/// Columns that rows are made of again.
pub const OWN: [&str; 11] = [
    QUANTITY,
    SECTION,
    SIGNAL,
    RECORD,
    RECORDS[0],
    RECORDS[1],
    SAMPLES,
    WHICH,
    SIMULATED_SI,
    MEASURED_SI,
    VALUE_SI,
];

/// A row with all it belongs to.
struct Placed<'a> {
    quantity: &'a Quantity,
    unit: &'a Unit,
    label: &'a super::Label,
    values: &'a SectionValues,
    row: &'a Row,
}

/// The rows, ordered by quantity, section, place and record.
///
/// # Errors
/// Of Arrow.
pub fn table(plan: &Plan, values: &Values) -> Result<RecordBatch, ArrowError> {
    let mut rows: Vec<Placed<'_>> = Vec::new();
    for (index, quantity) in plan.quantities.iter().enumerate() {
        for ((number, of_section), label) in values.sections.iter().zip(&values.labels) {
            let Some(unit) = values.head.basis.units().get(*number) else { continue };
            let own = of_section.rows.get(index).into_iter().flatten();
            rows.extend(own.map(|row| Placed { quantity, unit, label, values: of_section, row }));
        }
    }
    let mut all = Columns { rows: &rows, found: Vec::new() };
    all.text("protocol", |_| Some(&plan.name));
    all.text("campaign", |row| Some(&row.label.campaign));
    all.text(QUANTITY, |row| Some(&row.quantity.id));
    all.text(SECTION, |row| Some(&row.unit.name));
    all.text(SIGNAL, |row| Some(&row.quantity.positions[row.row.position].name));
    let places = plan
        .quantities
        .iter()
        .flat_map(|quantity| &quantity.positions)
        .flat_map(|position| &position.places);
    for place in places.map(|(place, _)| place).collect::<BTreeSet<_>>() {
        all.text(place, |row| row.quantity.positions[row.row.position].places.get(place));
    }
    all.text(RECORD, |row| row.row.record.as_ref().map(ToString::to_string));
    all.text("run", |row| row.label.run.as_deref());
    all.text("site", |row| Some(&row.unit.site_name));
    all.text("state", |row| row.label.state.as_deref());
    for (index, datum) in plan.columns.iter().enumerate() {
        match &datum.kind {
            DatumKind::Number(unit) => {
                all.number(&format!("{} [{}]", datum.key, unit.text), |row| {
                    match &row.unit.columns[index] {
                        Ok(Scalar::Number(number)) => Some(unit.from_si(*number)),
                        _ => None,
                    }
                })
            }
            _ => all.text(&datum.key, |row| match &row.unit.columns[index] {
                Ok(Scalar::Word(word)) => Some(word.as_str()),
                Ok(Scalar::Flag(true)) => Some("true"),
                Ok(Scalar::Flag(false)) => Some("false"),
                _ => None,
            }),
        }
    }
    let shown = |row: &Placed<'_>, value: f64| row.quantity.unit.from_si(value);
    all.number("simulated", |row| row.row.simulated.map(|value| shown(row, value)));
    all.number("measured", |row| row.row.measured.map(|value| shown(row, value)));
    all.number("value", |row| Some(shown(row, row.row.value)));
    all.text("unit", |row| Some(&row.quantity.unit.text));
    all.count(SAMPLES, |row| row.row.samples);
    all.add("source_sha256", Arc::new(StringArray::from_iter_values(sources(&rows))));
    for (at, name) in RECORDS.into_iter().enumerate() {
        all.text(name, |row| match (&row.row.record, at) {
            (Some(RecordName::Single(name) | RecordName::Pair(name, _)), 0)
            | (Some(RecordName::Pair(_, name)), _) => Some(name),
            _ => None,
        });
    }
    all.count(WHICH, |row| row.row.which);
    all.number(SIMULATED_SI, |row| row.row.simulated);
    all.number(MEASURED_SI, |row| row.row.measured);
    all.number(VALUE_SI, |row| Some(row.row.value));
    all.batch()
}

/// For each row the hashes of the records that took part, the simulation first.
fn sources(rows: &[Placed<'_>]) -> Vec<Arc<str>> {
    let mut all: Vec<Arc<str>> = Vec::with_capacity(rows.len());
    for (at, row) in rows.iter().enumerate() {
        // Most rows are of the same records as the one before.
        let before = at.checked_sub(1).map(|before| &rows[before]);
        if before.is_some_and(|before| {
            std::ptr::eq(before.values, row.values) && before.row.record == row.row.record
        }) {
            all.push(Arc::clone(&all[at - 1]));
            continue;
        }
        let took = |file: &&FileHash| {
            file.record.as_ref().filter(|of| of.kind != "track").is_some_and(|of| {
                let (simulated, name) = (of.kind == "simulation", of.name.as_deref());
                RecordName::took_part(row.row.record.as_ref(), simulated, name)
            })
        };
        let hashes: Vec<&str> =
            row.values.files.iter().filter(took).map(|file| file.sha256.as_str()).collect();
        all.push(hashes.join(" ").into());
    }
    all
}

struct Columns<'a> {
    rows: &'a [Placed<'a>],
    found: Vec<(String, ArrayRef)>,
}

impl<'a> Columns<'a> {
    /// A place or a datum may have the name of another column, which then has it.
    fn add(&mut self, name: &str, cells: ArrayRef) {
        let reserved = OWN.contains(&name) || ["value", "simulated", "measured"].contains(&name);
        match self.found.iter().position(|(known, _)| known == name) {
            Some(at) if reserved => self.found[at].1 = cells,
            Some(_) => {}
            None => self.found.push((name.to_string(), cells)),
        }
    }

    fn text<T: AsRef<str>>(&mut self, name: &str, of: impl Fn(&'a Placed<'a>) -> Option<T>) {
        self.add(name, Arc::new(self.rows.iter().map(of).collect::<StringArray>()));
    }

    fn number(&mut self, name: &str, of: impl Fn(&Placed<'_>) -> Option<f64>) {
        self.add(name, Arc::new(self.rows.iter().map(of).collect::<Float64Array>()));
    }

    fn count(&mut self, name: &str, of: impl Fn(&Placed<'_>) -> usize) {
        let counts = self.rows.iter().map(|row| of(row) as u64);
        self.add(name, Arc::new(UInt64Array::from_iter_values(counts)));
    }

    fn batch(self) -> Result<RecordBatch, ArrowError> {
        let field =
            |(name, cells): &(String, ArrayRef)| Field::new(name, cells.data_type().clone(), true);
        let schema = Schema::new(self.found.iter().map(field).collect::<Vec<_>>());
        let cells = self.found.into_iter().map(|(_, cells)| cells).collect();
        RecordBatch::try_new(Arc::new(schema), cells)
    }
}

/// Puts the rows of the table into the sections, which are given by number.
///
/// # Errors
/// A row is not one of the protocol and of these sections, in words.
pub fn into_sections(
    plan: &Plan,
    units: &[Unit],
    table: &[RecordBatch],
    sections: &mut [(usize, SectionValues)],
) -> Result<(), String> {
    for (_, of_section) in sections.iter_mut() {
        of_section.rows = vec![Vec::new(); plan.quantities.len()];
    }
    let named = |(at, (number, _)): (usize, &(usize, SectionValues))| {
        Some((units.get(*number)?.name.as_str(), at))
    };
    let places: HashMap<&str, usize> =
        sections.iter().enumerate().rev().filter_map(named).collect();
    let mut before = 0;
    for batch in table {
        add(plan, &places, (before, batch), sections)?;
        before += batch.num_rows();
    }
    Ok(())
}

/// A column by its name, as an array of its kind.
fn typed<'a, T>(
    table: &'a RecordBatch,
    name: &str,
    kind: &str,
    cast: impl Fn(&'a ArrayRef) -> Option<&'a T>,
) -> Result<&'a T, String> {
    let column = table.column_by_name(name).and_then(cast);
    column.ok_or_else(|| format!("it has no column `{name}` of {kind}"))
}

/// The rows of one batch; `places` are those of the sections among `sections`, by name.
fn add(
    plan: &Plan,
    places: &HashMap<&str, usize>,
    (before, table): (usize, &RecordBatch),
    sections: &mut [(usize, SectionValues)],
) -> Result<(), String> {
    let texts = |name| typed(table, name, "texts", |column| column.as_string_opt::<i32>());
    let numbers =
        |name| typed(table, name, "numbers", |column| column.as_primitive_opt::<Float64Type>());
    let counts =
        |name| typed(table, name, "counts", |column| column.as_primitive_opt::<UInt64Type>());
    let (quantities, names, signals) = (texts(QUANTITY)?, texts(SECTION)?, texts(SIGNAL)?);
    let (first, second) = (texts(RECORDS[0])?, texts(RECORDS[1])?);
    let (simulated, measured, values) =
        (numbers(SIMULATED_SI)?, numbers(MEASURED_SI)?, numbers(VALUE_SI)?);
    let (samples, which) = (counts(SAMPLES)?, counts(WHICH)?);
    for row in 0..table.num_rows() {
        let number = |numbers: &Float64Array| numbers.is_valid(row).then(|| numbers.value(row));
        let count = |counts: &UInt64Array| if counts.is_valid(row) { counts.value(row) } else { 0 };
        let record = |names: &StringArray| names.is_valid(row).then(|| names.value(row).into());
        let [quantity, name, signal] = [quantities, names, signals]
            .map(|texts| if texts.is_valid(row) { texts.value(row) } else { "" });
        let shown = before + row + 1;
        let wrong =
            || format!("row {shown}: the protocol has no value of `{quantity}` at `{signal}`");
        let index =
            plan.quantities.iter().position(|known| known.id == quantity).ok_or_else(wrong)?;
        let known = &plan.quantities[index];
        let position = known.positions.iter().position(|position| position.name == signal);
        let position = position.ok_or_else(wrong)?;
        let several = match known.evaluation.as_ref() {
            Evaluation::Values { values, .. } => values.len(),
            _ => 1,
        };
        let which = usize::try_from(count(which)).ok().filter(|which| *which < several);
        let (value, which) = number(values).zip(which).ok_or_else(wrong)?;
        let place = places.get(name);
        let place = *place
            .ok_or_else(|| format!("row {shown}: the section `{name}` is not one of this part"))?;
        sections[place].1.rows[index].push(Row {
            position,
            which,
            record: RecordName::joined(record(first).as_ref(), record(second).as_ref()),
            simulated: number(simulated),
            measured: number(measured),
            value,
            samples: usize::try_from(count(samples)).unwrap_or(usize::MAX),
        });
    }
    Ok(())
}
