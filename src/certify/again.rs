//! A protocol compiled again from its text and the values of its parameters, as a report or a file
//! of values carries them.

use std::{cell::Cell, sync::Arc};

use serde::{Deserialize, Serialize};

use super::{Compiled, compile};
use crate::check::{Override, Overrides, family, plan::SetBy};
use crate::problem::{Problem, Problems};
use crate::result::{Confirmation, ConfirmedValue, ParameterInfo};
use crate::source::Source;
use crate::syntax::document::Text;

/// Compiles a protocol from its files, in the order of [`family::Family::sources`].
pub fn again(
    sources: &[Arc<Source>],
    (parameters, confirmed): (&[Setting], &[Confirmation]),
    problems: &mut Problems,
) -> Option<Compiled> {
    // Texts are asked for in the order in which they are carried.
    let asked = Cell::new(0);
    let next = |_: &str, _: &Source| {
        asked.set(asked.get() + 1);
        sources.get(asked.get()).cloned().ok_or_else(|| {
            let says = "the protocol extends or uses one that is not carried with it";
            Problem::error("protocol-missing", says)
        })
    };
    let family = family::read(sources.first()?, &next, problems);
    if problems.any_error() {
        return None;
    }
    compile(family, &overrides(parameters, confirmed), problems)
}

fn overrides(parameters: &[Setting], confirmed: &[Confirmation]) -> Overrides {
    let mut overrides = Overrides::new();
    overrides.confirmed = confirmed.to_vec();
    for parameter in parameters {
        let set_by = match parameter.set_by.as_str() {
            "campaign" => SetBy::Campaign,
            "command line" => SetBy::CommandLine,
            _ => continue,
        };
        let source = Source::new(format!("parameter {}", parameter.name), parameter.value.clone());
        let text = Text { text: parameter.value.clone(), span: source.whole(), exact: true };
        overrides.insert(parameter.name.clone(), Override { text, set_by });
    }
    overrides
}

/// Confirmations that count, as a campaign states them.
pub fn confirmations(of: &[ConfirmedValue], edition: &Option<String>) -> Vec<Confirmation> {
    let one = |ConfirmedValue { value, signed }: &ConfirmedValue| Confirmation {
        name: value.name.clone(),
        value: value.value.clone(),
        unit: value.unit.clone(),
        clause: value.clause.clone(),
        edition: edition.clone(),
        signed: signed.clone(),
    };
    of.iter().map(one).collect()
}

/// The value of a parameter, and what set it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Setting {
    pub name: String,
    /// With its unit.
    pub value: String,
    /// As in [`ParameterInfo`].
    pub set_by: String,
}

impl Setting {
    /// What a report states of a parameter.
    pub fn of(ParameterInfo { name, value, set_by, .. }: ParameterInfo) -> Self {
        Self { name, value, set_by }
    }
}

/// The text of a protocol with the values of its parameters: all that it needs to be compiled
/// again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rules {
    /// Name and text of each file; the protocol first.
    pub files: Vec<(String, String)>,
    pub parameters: Vec<Setting>,
    /// Confirmations that count.
    #[serde(default)]
    pub confirmed: Vec<Confirmation>,
}

impl Rules {
    pub fn of(compiled: &Compiled) -> Self {
        let file = |source: &Arc<Source>| (source.file_name(), source.text.clone());
        Self {
            files: compiled.family.sources.iter().map(file).collect(),
            parameters: compiled
                .plan
                .parameters
                .iter()
                .map(super::parameter_info)
                .map(Setting::of)
                .collect(),
            confirmed: confirmations(&compiled.plan.values.confirmed, &compiled.plan.edition),
        }
    }

    /// The parameters that were set, and the values that were confirmed.
    pub fn overrides(&self) -> Overrides {
        overrides(&self.parameters, &self.confirmed)
    }

    pub fn compiled(&self, problems: &mut Problems) -> Option<Compiled> {
        // The number tells files of the same name apart.
        let source = |(at, (name, text)): (usize, &(String, String))| {
            Source::new(format!("{}/{name}", at + 1), text.clone())
        };
        let sources: Vec<Arc<Source>> = self.files.iter().enumerate().map(source).collect();
        again(&sources, (&self.parameters, &self.confirmed), problems)
    }
}
