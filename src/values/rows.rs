//! The table of values as columns: those that a reader needs, and beside them the exact numbers in SI, from which sections are judged.

use std::collections::BTreeSet;

use super::Values;
use crate::check::plan::{DatumKind, Evaluation, Plan, Quantity, Scalar};
use crate::result::{FileHash, took_part};
use crate::run::{Row, SectionValues, Unit};

/// A column of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    pub name: String,
    pub cells: Cells,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Cells {
    Texts(Vec<Option<String>>),
    Numbers(Vec<Option<f64>>),
    Counts(Vec<u64>),
}

const QUANTITY: &str = "quantity";
const SECTION: &str = "section";
const SIGNAL: &str = "signal";
const RECORD: &str = "record";
const SAMPLES: &str = "samples";
/// Which of several values of a quantity.
const WHICH: &str = "which";
const SIMULATED_SI: &str = "simulated_si";
const MEASURED_SI: &str = "measured_si";
const VALUE_SI: &str = "value_si";
/// Columns that rows are made of again.
const OWN: [&str; 9] = [QUANTITY, SECTION, SIGNAL, RECORD, SAMPLES, WHICH, SIMULATED_SI, MEASURED_SI, VALUE_SI];

/// A row with all it belongs to.
struct Placed<'a> {
    quantity: &'a Quantity,
    unit: &'a Unit,
    label: &'a super::Label,
    values: &'a SectionValues,
    row: &'a Row,
}

/// The rows, ordered by quantity, section, place and record.
pub fn columns(plan: &Plan, values: &Values) -> Vec<Column> {
    let mut rows: Vec<Placed<'_>> = Vec::new();
    for (index, quantity) in plan.quantities.iter().enumerate() {
        for ((number, of_section), label) in values.sections.iter().zip(&values.labels) {
            let Some(unit) = values.head.basis.units().get(*number) else { continue };
            let own = of_section.rows.get(index).into_iter().flatten();
            rows.extend(own.map(|row| Placed { quantity, unit, label, values: of_section, row }));
        }
    }
    let mut all = Columns { rows: &rows, found: Vec::new() };
    all.text("protocol", |_| Some(plan.name.clone()));
    all.text("campaign", |row| Some(row.label.campaign.clone()));
    all.text(QUANTITY, |row| Some(row.quantity.id.clone()));
    all.text(SECTION, |row| Some(row.unit.name.clone()));
    all.text(SIGNAL, |row| Some(row.quantity.positions[row.row.position].name.clone()));
    let places = plan.quantities.iter().flat_map(|quantity| &quantity.positions).flat_map(|position| &position.places);
    for place in places.map(|(place, _)| place).collect::<BTreeSet<_>>() {
        let of = |row: &Placed<'_>| {
            let places = &row.quantity.positions[row.row.position].places;
            places.iter().find(|(name, _)| name == place).map(|(_, member)| member.clone())
        };
        all.text(place, of);
    }
    all.text(RECORD, |row| row.row.record.as_deref().map(str::to_string));
    all.text("run", |row| row.label.run.clone());
    all.text("site", |row| Some(row.unit.site_name.clone()));
    all.text("state", |row| row.label.state.clone());
    for (index, datum) in plan.columns.iter().enumerate() {
        match &datum.kind {
            DatumKind::Number(unit) => all.number(&format!("{} [{}]", datum.key, unit.text), |row| match &row.unit.columns[index] {
                Ok(Scalar::Number(number)) => Some(unit.from_si(*number)),
                _ => None,
            }),
            _ => all.text(&datum.key, |row| match &row.unit.columns[index] {
                Ok(Scalar::Word(word)) => Some(word.clone()),
                Ok(Scalar::Flag(flag)) => Some(flag.to_string()),
                _ => None,
            }),
        }
    }
    let shown = |row: &Placed<'_>, value: f64| row.quantity.unit.from_si(value);
    all.number("simulated", |row| row.row.simulated.map(|value| shown(row, value)));
    all.number("measured", |row| row.row.measured.map(|value| shown(row, value)));
    all.number("value", |row| Some(shown(row, row.row.value)));
    all.text("unit", |row| Some(row.quantity.unit.text.clone()));
    all.count(SAMPLES, |row| row.row.samples);
    all.text("source_sha256", |row| Some(sources(row)));
    all.count(WHICH, |row| row.row.which);
    all.number(SIMULATED_SI, |row| row.row.simulated);
    all.number(MEASURED_SI, |row| row.row.measured);
    all.number(VALUE_SI, |row| Some(row.row.value));
    all.found
}

/// The hashes of the records that took part, the simulation first.
fn sources(row: &Placed<'_>) -> String {
    let took = |file: &&FileHash| {
        let record = file.record.as_ref();
        record.is_some_and(|of| of.kind != "track" && took_part(row.row.record.as_deref(), of.kind == "simulation", of.name.as_deref()))
    };
    row.values.files.iter().filter(took).map(|file| file.sha256.as_str()).collect::<Vec<_>>().join(" ")
}

struct Columns<'a> {
    rows: &'a [Placed<'a>],
    found: Vec<Column>,
}

impl Columns<'_> {
    /// A place or a datum may have the name of another column, which then has it.
    fn add(&mut self, name: &str, cells: Cells) {
        let reserved = OWN.contains(&name) || name == "value" || name == "simulated" || name == "measured";
        match self.found.iter().position(|column| column.name == name) {
            Some(at) if reserved => self.found[at].cells = cells,
            Some(_) => {}
            None => self.found.push(Column { name: name.to_string(), cells }),
        }
    }

    fn text(&mut self, name: &str, of: impl Fn(&Placed<'_>) -> Option<String>) {
        self.add(name, Cells::Texts(self.rows.iter().map(of).collect()));
    }

    fn number(&mut self, name: &str, of: impl Fn(&Placed<'_>) -> Option<f64>) {
        self.add(name, Cells::Numbers(self.rows.iter().map(of).collect()));
    }

    fn count(&mut self, name: &str, of: impl Fn(&Placed<'_>) -> usize) {
        self.add(name, Cells::Counts(self.rows.iter().map(|row| of(row) as u64).collect()));
    }
}

/// Puts the rows of the table into the sections, which are given by number.
///
/// # Errors
/// A row is not one of the protocol and of these sections, in words.
pub fn into_sections(plan: &Plan, units: &[Unit], columns: &[Column], sections: &mut [(usize, SectionValues)]) -> Result<(), String> {
    let texts = |name: &str| match columns.iter().find(|column| column.name == name).map(|column| &column.cells) {
        Some(Cells::Texts(texts)) => Ok(texts),
        _ => Err(format!("it has no column `{name}` of texts")),
    };
    let numbers = |name: &str| match columns.iter().find(|column| column.name == name).map(|column| &column.cells) {
        Some(Cells::Numbers(numbers)) => Ok(numbers),
        _ => Err(format!("it has no column `{name}` of numbers")),
    };
    let counts = |name: &str| match columns.iter().find(|column| column.name == name).map(|column| &column.cells) {
        Some(Cells::Counts(counts)) => Ok(counts),
        _ => Err(format!("it has no column `{name}` of counts")),
    };
    let (quantities, names, signals, records) = (texts(QUANTITY)?, texts(SECTION)?, texts(SIGNAL)?, texts(RECORD)?);
    let (simulated, measured, values) = (numbers(SIMULATED_SI)?, numbers(MEASURED_SI)?, numbers(VALUE_SI)?);
    let (samples, which) = (counts(SAMPLES)?, counts(WHICH)?);
    for (_, of_section) in sections.iter_mut() {
        of_section.rows = vec![Vec::new(); plan.quantities.len()];
    }
    // Rows of a section stand together.
    let mut last = 0;
    for row in 0..values.len() {
        let text = |texts: &Vec<Option<String>>| texts.get(row).cloned().flatten().unwrap_or_default();
        let (quantity, name, signal) = (text(quantities), text(names), text(signals));
        let wrong = || format!("row {}: the protocol has no value of `{quantity}` at `{signal}`", row + 1);
        let index = plan.quantities.iter().position(|known| known.id == quantity).ok_or_else(wrong)?;
        let known = &plan.quantities[index];
        let position = known.positions.iter().position(|position| position.name == signal).ok_or_else(wrong)?;
        let which = usize::try_from(which.get(row).copied().unwrap_or(0)).map_err(|_| wrong())?;
        let several = if let Evaluation::Values { values, .. } = known.evaluation.as_ref() { values.len() } else { 1 };
        let value = values[row].ok_or_else(wrong)?;
        if which >= several {
            return Err(wrong());
        }
        let is_of = |at: usize| sections.get(at).and_then(|(number, _)| units.get(*number)).is_some_and(|unit| unit.name == name);
        if !is_of(last) {
            let none = || format!("row {}: the section `{name}` is not one of this part", row + 1);
            last = (0..sections.len()).find(|at| is_of(*at)).ok_or_else(none)?;
        }
        sections[last].1.rows[index].push(Row {
            position,
            which,
            record: records.get(row).cloned().flatten().map(Into::into),
            simulated: simulated.get(row).copied().flatten(),
            measured: measured.get(row).copied().flatten(),
            value,
            samples: usize::try_from(samples.get(row).copied().unwrap_or(0)).unwrap_or(usize::MAX),
        });
    }
    Ok(())
}
