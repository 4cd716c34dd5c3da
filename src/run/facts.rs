//! Vehicle data as the protocol names them, and what names of expressions stand for while running.

use crate::check::evaluate::Values;
use crate::check::plan::{Datum, DatumKind, Plan, Scalar};
use crate::data::Campaign;
use crate::problem::{Problem, Problems};
use crate::result::DataItem;

/// Values of the vehicle, one for each [`Plan::vehicle`].
#[derive(Clone, Debug)]
pub struct Facts {
    pub vehicle: Vec<Scalar>,
}

impl Facts {
    /// Reads every vehicle datum the protocol declares; a missing or ill-formed one is a problem.
    pub fn read(plan: &Plan, campaign: &Campaign, problems: &mut Problems) -> Self {
        let vehicle = plan.vehicle.iter().map(|datum| vehicle_datum(datum, campaign, problems).unwrap_or(Scalar::Number(0.0))).collect();
        Self { vehicle }
    }
}

/// A value as a report prints it, in the unit the protocol declares.
pub fn item(datum: &Datum, value: Option<&Scalar>) -> DataItem {
    let unit = if let DatumKind::Number(unit) = &datum.kind { Some(unit) } else { None };
    let value = match value {
        Some(Scalar::Number(value)) => trimmed(unit.map_or(*value, |unit| unit.from_si(*value))),
        Some(Scalar::Word(word)) => word.clone(),
        Some(Scalar::Flag(flag)) => flag.to_string(),
        None => String::new(),
    };
    DataItem { name: datum.title.clone(), value, unit: unit.map(|unit| unit.text.clone()), used: true }
}

/// A number of a table without the tail that conversion between units leaves: `56.3`, not `56.300000000000004`.
pub fn trimmed(value: f64) -> String {
    let rounded: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

fn vehicle_datum(datum: &Datum, campaign: &Campaign, problems: &mut Problems) -> Option<Scalar> {
    let Some(node) = campaign.vehicle.lookup(&datum.key) else {
        if let Some(default) = &datum.default {
            return Some(default.clone());
        }
        let known: Vec<&str> = campaign.vehicle.entries().iter().map(|(key, _)| key.text.as_str()).collect();
        problems.push(
            Problem::error("missing-vehicle-data", format!("the vehicle file has no `{}` ({})", datum.key, datum.title))
                .at(&campaign.vehicle.span.part(0..1))
                .also(&datum.span, "the protocol needs it")
                .suggest(&datum.key, known),
        );
        return None;
    };
    let text = node.scalar_text().unwrap_or("").trim().to_string();
    match scalar(&datum.kind, &text) {
        Ok(value) => Some(value),
        Err(says) => {
            problems
                .push(Problem::error("vehicle-data", format!("`{}`: {says}", datum.key)).at(&node.span).also(&datum.span, "declared here"));
            None
        }
    }
}

/// A text as a value of the declared kind; numbers are in the declared unit.
pub fn scalar(kind: &DatumKind, text: &str) -> Result<Scalar, String> {
    match kind {
        DatumKind::Number(unit) => match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(Scalar::Number(unit.to_si(number))),
            _ if text.contains(',') => Err(format!("`{text}` has a decimal comma; numbers are written with a point")),
            _ => Err(format!("`{text}` is not a number (in {unit})")),
        },
        DatumKind::Flag => match text {
            "true" => Ok(Scalar::Flag(true)),
            "false" => Ok(Scalar::Flag(false)),
            _ => Err(format!("`{text}` is neither true nor false")),
        },
        DatumKind::Words(words) => {
            if words.iter().any(|word| word == text) {
                return Ok(Scalar::Word(text.to_string()));
            }
            // A zone written as 1.0 is zone 1.
            let number = text.parse::<f64>().ok().and_then(|number| words.iter().find(|word| word.parse() == Ok(number)));
            match (number, crate::problem::nearest(text, words.iter().map(String::as_str))) {
                (Some(word), _) => Ok(Scalar::Word(word.clone())),
                (None, Some(near)) => Err(format!("`{text}` is none of {}; did you mean `{near}`?", words.join(", "))),
                (None, None) => Err(format!("`{text}` is none of {}", words.join(", "))),
            }
        }
    }
}

/// What names stand for in one section; parts that are not known give the reason.
#[derive(Debug)]
pub struct Known<'a> {
    pub facts: &'a Facts,
    pub columns: Option<&'a [Result<Scalar, String>]>,
    pub extent: Option<(f64, f64)>,
    pub inputs: &'a [Result<f64, String>],
    pub sides: Option<(f64, f64)>,
}

impl<'a> Known<'a> {
    pub fn vehicle(facts: &'a Facts) -> Self {
        Self { facts, columns: None, extent: None, inputs: &[], sides: None }
    }
}

impl Values for Known<'_> {
    fn vehicle(&self, index: usize) -> Result<Scalar, String> {
        Ok(self.facts.vehicle[index].clone())
    }

    fn column(&self, index: usize) -> Result<Scalar, String> {
        match self.columns {
            Some(columns) => columns[index].clone(),
            None => Err("it differs from section to section".into()),
        }
    }

    fn extent(&self) -> Result<(f64, f64), String> {
        self.extent.ok_or_else(|| "there is no section here".into())
    }

    fn input(&self, index: usize) -> Result<f64, String> {
        self.inputs.get(index).cloned().unwrap_or_else(|| Err("there is no signal here".into()))
    }

    fn sides(&self) -> Result<(f64, f64), String> {
        self.sides.ok_or_else(|| "there is no pair of values here".into())
    }

    fn limit_of(&self, statistic: &str) -> Result<f64, String> {
        Err(format!("the limit of {statistic} is not known here"))
    }
}
