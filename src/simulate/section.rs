//! The sections of a campaign for simulators.

use crate::data::{
    Campaign, Heading,
    sites::sites,
    table::{Cell, Table},
};
use crate::problem::{Problem, Problems, error};
use crate::source::Source;
use crate::units::{Dimension, Unit};

/// A section to be simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    pub cell: Cell,
    /// Start and end on the axis in SI units; infinite for a record without a section table.
    pub start: f64,
    pub end: f64,
    /// In m/s, if the table has speeds.
    pub speed: Option<f64>,
    /// All columns of its row.
    pub facts: Vec<Fact>,
}

/// A cell of the section table.
#[derive(Clone, Debug, PartialEq)]
pub struct Fact {
    /// The column, without its unit.
    pub name: String,
    pub text: String,
    /// The unit of the column, if known.
    pub unit: Option<Unit>,
}

impl Section {
    /// A section without a campaign.
    pub fn nowhere() -> Self {
        Self::whole(Cell::new("record".to_string(), Source::new("", "").whole()))
    }

    /// A whole record.
    fn whole(cell: Cell) -> Self {
        Self { cell, start: f64::NEG_INFINITY, end: f64::INFINITY, speed: None, facts: Vec::new() }
    }

    pub fn name(&self) -> &str {
        &self.cell.value
    }

    /// A problem of this section, which its message names.
    pub fn named(&self, problem: Problem) -> Problem {
        Problem { says: format!("section `{}`: {}", self.name(), problem.says), ..problem }
    }

    /// The text of a column; the section's name for `section`.
    pub fn fact(&self, column: &str) -> Option<&str> {
        if column == "section" {
            return Some(self.name());
        }
        self.facts.iter().find(|fact| fact.name == column).map(|fact| fact.text.as_str())
    }

    /// The number in a column in SI units; unchanged if the column has no unit.
    pub fn number(&self, column: &str) -> Option<f64> {
        let fact = self.facts.iter().find(|fact| fact.name == column)?;
        let number = fact.text.trim().parse().ok().filter(|number: &f64| number.is_finite())?;
        Some(fact.unit.as_ref().map_or(number, |unit| unit.to_si(number)))
    }

    /// A column in words, `radius 280 m`; nothing if its cell is empty.
    pub fn says(&self, column: &str) -> Option<String> {
        let fact = self.facts.iter().find(|fact| fact.name == column)?;
        let unit = fact.unit.as_ref().map(Unit::suffix).unwrap_or_default();
        self.says_without_unit(column).map(|says| says + &unit)
    }

    /// The same without the unit, `radius 280`.
    pub fn says_without_unit(&self, column: &str) -> Option<String> {
        let text = self.fact(column).filter(|text| !text.is_empty())?;
        Some(format!("{column} {text}"))
    }
}

/// The sections of a campaign in the order of its table; none if a cell cannot be read or `repeat
/// of` is wrong.
pub fn sections(campaign: &Campaign, problems: &mut Problems) -> Option<Vec<Section>> {
    let Some(table) = &campaign.sections else {
        return Some(campaign.names.iter().cloned().map(Section::whole).collect());
    };
    let mut faults = Problems::default();
    let start = column(table, "start", None, &mut faults);
    let end = column(table, "end", None, &mut faults);
    let speed = match table.column("speed") {
        Some(_) => column(table, "speed", Some(Dimension::LENGTH / Dimension::TIME), &mut faults),
        None => Vec::new(),
    };
    // A number in an unknown unit would be taken as SI.
    let unit_of = |heading: &Heading| heading.unit.as_ref().map(|_| heading.unit(None)).transpose();
    let units: Vec<Option<Unit>> = table
        .columns
        .iter()
        .map(|heading| unit_of(heading).map_err(|fault| faults.push(fault)).ok().flatten())
        .collect();
    let readable = !faults.any_error();
    // An evaluation needs the sites of all sections: what is wrong with them is told before hours
    // of simulation.
    sites(table, &mut faults);
    let mut found = Vec::new();
    for (row, cell) in campaign.names.iter().enumerate().filter(|_| readable) {
        let number = |column: &[Option<f64>]| column.get(row).copied().flatten();
        let fact = |(at, heading): (usize, &Heading)| {
            let text = table.cell(row, at).map(|cell| cell.value.clone()).unwrap_or_default();
            Fact { name: heading.name.clone(), text, unit: units[at].clone() }
        };
        let facts = table.columns.iter().enumerate().map(fact).collect();
        match (number(&start), number(&end)) {
            (Some(start), Some(end)) => {
                found.push(Section { cell: cell.clone(), start, end, speed: number(&speed), facts })
            }
            _ => faults.push(error(
                "section",
                format!("section `{}` has no start or no end", cell.value),
                &cell.span,
            )),
        }
    }
    let whole = !faults.any_error();
    faults.0.into_iter().for_each(|fault| problems.push(fault));
    whole.then_some(found)
}

fn column(
    table: &Table,
    name: &str,
    dimension: Option<Dimension>,
    problems: &mut Problems,
) -> Vec<Option<f64>> {
    table.numbers_named(name, dimension).unwrap_or_else(|found| {
        problems.add(found);
        Vec::new()
    })
}
