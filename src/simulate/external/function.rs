//! A Python function as a simulator: what it is given, and what it answers.

use serde_json::{Map, Value, json};

use super::{
    super::made::{first, lacks, unit_in, wanted},
    External,
    cache::Key,
    covers,
    python::{Columns, Workers},
};
use crate::data::{
    Heading, RecordKind,
    record::{Wanted, listed_headings, read_headings, read_record},
};
use crate::effects::{Action, Catalogue, Channel, Signals};
use crate::problem::{Problem, error};
use crate::simulate::{Section, Task};
use crate::units::{Dimension, Unit};

const TIME: &str = "time";
const DISTANCE: &str = "distance";
/// The entry of `inputs` with the row of the section table.
const ROW: &str = "section";

impl External<'_> {
    /// Adds what the function is given beside parameters to a key.
    pub(super) fn add_inputs(&self, key: &mut Key, section: &Section) -> Result<(), Problem> {
        let kind = self.input_kind();
        let place = self.campaign.record_place(kind, &section.cell)?;
        key.add_file("record", &place.path)?;
        key.add("row", &row(section).to_string());
        Ok(())
    }

    /// The folder of inputs; without one, time and distance of the campaign's simulation.
    fn input_kind(&self) -> RecordKind {
        if self.campaign.has(RecordKind::Track) {
            RecordKind::Track
        } else {
            RecordKind::Simulation
        }
    }

    /// The columns that the function is given, in the units of their file.
    fn inputs(&self, section: &Section) -> Result<Columns, Problem> {
        let kind = self.input_kind();
        let place = self.campaign.record_place(kind, &section.cell)?;
        let headings = read_headings(&place.path, &place.inside).map_err(first)?;
        let given = |name: &str| kind == RecordKind::Track || name == TIME || name == DISTANCE;
        let wanted = Wanted::all(headings.iter().filter(|heading| given(&heading.name)));
        let record = read_record(&place.path, &place.inside, &wanted).map_err(first)?;
        let column = |column: &crate::data::Column| {
            (
                column.name.clone(),
                column.values.iter().map(|value| column.unit.from_si(*value)).collect(),
            )
        };
        Ok(record.columns.iter().map(column).collect())
    }

    /// Calls the function for a section; returns the record and its text.
    pub(super) fn ask(
        &self,
        workers: &Workers,
        task: &Task<'_>,
    ) -> Result<(Signals, Vec<u8>), Problem> {
        let section = task.section;
        let inputs = self.inputs(section)?;
        let given = || {
            let columns = inputs.iter().map(|(name, values)| (name.clone(), json!(values)));
            Value::Object(columns.chain([(ROW.to_string(), row(section))]).collect())
        };
        let mut parameters = self.values(workers)?;
        for (name, value) in task.settings {
            match parameters.iter_mut().find(|(known, _)| known == name) {
                Some(known) => known.1 = *value,
                None => return Err(self.no_parameter(workers, name)),
            }
        }
        let made = workers.call(section.name(), &parameters, &given).map_err(|failed| {
            let problem = self.told(&failed, Some(section));
            let set: Vec<String> =
                task.settings.iter().map(|(name, value)| format!("{name} = {value}")).collect();
            let called = || format!("it was called with {}", set.join(", "));
            problem.help_if((!set.is_empty()).then(called))
        })?;
        self.signals(section, &inputs, made)
            .map_err(|problem| section.named(problem).at(&section.cell.span))
    }

    /// The parameters of the function with the values of the vehicle file.
    fn values(&self, workers: &Workers) -> Result<Vec<(String, f64)>, Problem> {
        let names = workers.parameters().map_err(|failed| self.told(&failed, None))?;
        let value = |name: &String| {
            let node = self.campaign.vehicle.lookup(name).ok_or_else(|| {
                let known =
                    self.campaign.vehicle.entries().iter().map(|(key, _)| key.text.as_str());
                let says = format!(
                    "`{}` has the parameter `{name}`, for which the vehicle file has no value",
                    self.program.name
                );
                let problem = error("key-missing", says, &self.program.span);
                problem.suggest(name, known.filter(|known| !names.iter().any(|name| name == known)))
            })?;
            let number = node.number().or_else(|| with_unit(node.scalar_text()?));
            let wrong = || error("wrong-kind", format!("`{name}` must be a number"), &node.span);
            Ok((name.clone(), number.ok_or_else(wrong)?))
        };
        names.iter().map(value).collect()
    }

    /// Checks the parameters of a Python function against the vehicle file and a catalogue, before
    /// the first run.
    ///
    /// # Errors
    /// The function cannot be loaded; a parameter that one of them has and another has not.
    pub fn check(&self, catalogue: &Catalogue) -> Result<(), Vec<Problem>> {
        let Some(workers) = &self.workers else { return Ok(()) };
        self.values(workers)?;
        let names = workers.parameters().map_err(|failed| vec![self.told(&failed, None)])?;
        let mut problems = Vec::new();
        for effect in catalogue.effects.iter().filter(|effect| effect.action == Action::Simulator) {
            let set = effect.parameters.iter().flat_map(|parameter| &parameter.simulators);
            for (_, name, _) in set.filter(|(simulator, name, _)| {
                *simulator == self.program.name && !names.contains(name)
            }) {
                problems.push(Problem {
                    at: Some(effect.span.clone()),
                    ..self.no_parameter(workers, name)
                });
            }
        }
        if problems.is_empty() { Ok(()) } else { Err(problems) }
    }

    fn no_parameter(&self, workers: &Workers, name: &str) -> Problem {
        let names = workers.parameters().unwrap_or_default();
        let says = format!("`{}` has no parameter `{name}`", self.program.name);
        let problem = error("unknown-parameter", says, &self.program.span);
        let problem = problem.suggest(name, names.iter().map(String::as_str));
        if problem.help.is_some() {
            problem
        } else {
            problem.help(format!("its file lists in PARAMETERS: {}", names.join(", ")))
        }
    }

    /// A record in the units of the campaign's simulation, with its text.
    fn signals(
        &self,
        section: &Section,
        inputs: &Columns,
        made: Columns,
    ) -> Result<(Signals, Vec<u8>), Problem> {
        let shown = format!("the answer of {}", self.program.name);
        let known = self.headings(section);
        let mut columns = columns(&known, &shown, made)?;
        // Axes that the function does not give are those of its inputs.
        for (axis, dimension) in [(DISTANCE, Dimension::LENGTH), (TIME, Dimension::TIME)] {
            if let (false, Some((_, values))) = (
                columns.iter().any(|(name, ..)| name == axis),
                inputs.iter().find(|(name, _)| name == axis),
            ) {
                let unit = unit_in(&self.input_headings(section), axis);
                let unit = unit.unwrap_or_else(|| Unit::si(dimension));
                columns.insert(0, (axis.into(), unit, values.clone()));
            }
        }
        let si = |axis: &str| {
            let (_, unit, values) = columns.iter().find(|(name, ..)| name == axis)?;
            Some(values.iter().map(|value| unit.to_si(*value)).collect::<Vec<f64>>())
        };
        let Some(time) = si(TIME) else {
            return Err(wrong(format!("{shown} has no `{TIME}`, and its inputs have none")));
        };
        let (over_time, axis) =
            si(DISTANCE).map_or((true, time.clone()), |distance| (false, distance));
        if let Some((name, _, values)) =
            columns.iter().find(|(.., values)| values.len() != time.len())
        {
            return Err(wrong(format!(
                "{shown}: `{name}` has {} samples, `{TIME}` has {}",
                values.len(),
                time.len()
            )));
        }
        let span = time.last().zip(time.first()).map_or(0.0, |(last, first)| last - first);
        if time.len() < 2 || span <= 0.0 {
            return Err(wrong(format!("{shown} has too few samples: {}", time.len())));
        }
        covers(&axis, section)?;
        if let Some(at) = axis.windows(2).position(|pair| pair[1] <= pair[0]) {
            return Err(Problem::error(
                "not-increasing",
                format!("{shown}: the axis does not increase at sample {}", at + 1),
            ));
        }
        let wanted = wanted(&known, &self.program.channels);
        let names: Vec<&str> = columns.iter().map(|(name, ..)| name.as_str()).collect();
        if let Some(name) = wanted.iter().find(|name| !names.contains(name)) {
            return Err(lacks(&shown, name, &names, &wanted));
        }
        let text = text(&columns);
        let channel = |(name, unit, values): (String, Unit, Vec<f64>)| {
            let to = unit_in(&known, &name).unwrap_or_else(|| unit.clone());
            let values = if to.factor == unit.factor {
                values
            } else {
                values.iter().map(|value| to.from_si(unit.to_si(*value))).collect()
            };
            Channel { name, values }
        };
        let channels = columns
            .into_iter()
            .filter(|(name, ..)| name != TIME && name != DISTANCE)
            .map(channel)
            .collect();
        Ok((Signals { axis, over_time, rate: (time.len() - 1) as f64 / span, channels }, text))
    }

    fn input_headings(&self, section: &Section) -> Vec<Heading> {
        let place = self.campaign.record_place(self.input_kind(), &section.cell);
        place
            .ok()
            .and_then(|place| read_headings(&place.path, &place.inside).ok())
            .unwrap_or_default()
    }
}

fn wrong(says: String) -> Problem {
    Problem::error("simulator-output", says)
}

/// The columns of an answer, each with its name and unit; without a unit, in that of the campaign's
/// simulation, whose headings are `known`.
fn columns(
    known: &[Heading],
    shown: &str,
    made: Columns,
) -> Result<Vec<(String, Unit, Vec<f64>)>, Problem> {
    let mut columns: Vec<(String, Unit, Vec<f64>)> = Vec::new();
    for (written, values) in made {
        let heading = listed_headings(&written, shown)
            .ok()
            .filter(|found| found.len() == 1)
            .and_then(|mut found| found.pop());
        let name = heading.as_ref().map_or(written.clone(), |heading| heading.name.clone());
        let own = unit_in(known, &name);
        let unit = match heading.filter(|heading| heading.unit.is_some()) {
            Some(heading) => heading.unit(own.as_ref().map(|unit| unit.dimension))?,
            None => own.unwrap_or_else(Unit::one),
        };
        if columns.iter().any(|(known, ..)| *known == name) {
            return Err(wrong(format!("{shown} has `{name}` twice")));
        }
        columns.push((name, unit, values));
    }
    Ok(columns)
}

/// The SI value of a number with its unit: `54.5 kN`.
fn with_unit(text: &str) -> Option<f64> {
    let (number, unit) = text.trim().split_once(' ')?;
    Some(Unit::parse(unit).ok()?.to_si(number.parse().ok()?))
}

/// The row of the section table: numbers as numbers, everything else as text.
fn row(section: &Section) -> Value {
    let mut row = Map::new();
    row.insert("section".into(), json!(section.name()));
    for fact in &section.facts {
        let number = fact.text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
        row.insert(
            fact.name.clone(),
            number.map_or_else(|| json!(fact.text), |number| json!(number)),
        );
    }
    Value::Object(row)
}

/// The record as CSV with every digit, so that one from the cache is the same.
fn text(columns: &[(String, Unit, Vec<f64>)]) -> Vec<u8> {
    let line = |cells: Vec<String>| cells.join(",") + "\n";
    let mut text = line(columns.iter().map(|(name, unit, _)| format!("{name} [{unit}]")).collect());
    for row in 0..columns.first().map_or(0, |(.., values)| values.len()) {
        text += &line(columns.iter().map(|(.., values)| values[row].to_string()).collect());
    }
    text.into_bytes()
}
