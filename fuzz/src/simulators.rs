//! Catalogues of effects and descriptions of simulators.

use std::sync::Arc;

use fishplate::effects::{self, Action, Catalogue, Channel, Signals};
use fishplate::library;
use fishplate::problem::{Problem, Problems};
use fishplate::simulate::{model_parameters, read_program};
use fishplate::source::Source;

use super::promise;

/// A catalogue of effects. Its effects can be chosen by name, and its formulas give finite numbers
/// or say why they do not.
pub fn catalogue(input: &[u8]) {
    let Ok(text) = std::str::from_utf8(input) else { return };
    let source = Source::new("fuzz.yaml", text);
    let mut problems = Problems::default();
    let read = effects::read(&source, &shipped, &model_parameters(), &mut problems);
    promise::told(&problems.0);
    assert!(read.is_some() || problems.any_error(), "refused without a word");
    if let Some(catalogue) = read {
        applied(&catalogue);
    }
}

/// Only what the program carries may be extended.
fn shipped(name: &str, from: &Source) -> Result<Arc<Source>, Problem> {
    let known = library::CATALOGUES.iter().any(|catalogue| catalogue.name == name);
    if known {
        return library::parent_catalogue(name, from);
    }
    Err(Problem::error("no-such-catalogue", format!("there is no catalogue `{name}`")))
}

#[track_caller]
fn applied(catalogue: &Catalogue) {
    for effect in &catalogue.effects {
        for parameter in &effect.parameters {
            let numbers = [parameter.default, parameter.low, parameter.high];
            assert!(numbers.iter().all(|number| number.is_finite()), "{}", effect.name);
        }
        if let Err(problems) = effects::choose(catalogue, std::slice::from_ref(&effect.name)) {
            promise::told(&problems);
        }
        let Action::Formulas(formulas) = &effect.action else { continue };
        let values = [0.0, 1.0, -2.5, 1e6];
        let channel = |name: &String| Channel { name: name.clone(), values: values.to_vec() };
        let channels = catalogue.groups.iter().flat_map(|group| group.channels.iter().map(channel));
        let mut signals = Signals {
            axis: vec![0.0, 1.0, 2.0, 3.0],
            over_time: false,
            rate: 1.0,
            channels: channels.collect(),
        };
        let settings: Vec<f64> =
            effect.parameters.iter().map(|parameter| parameter.default).collect();
        if signals.compute(formulas, &settings).is_ok() {
            let mut computed = signals.channels.iter().flat_map(|channel| &channel.values);
            assert!(computed.all(|value| value.is_finite()), "{}", effect.name);
        }
    }
}

/// A description of a simulator. It is read, never run.
pub fn simulator(input: &[u8]) {
    let Ok(text) = std::str::from_utf8(input) else { return };
    let source = Source::new("sim.yaml", text);
    let mut problems = Problems::default();
    let program = read_program(&source, std::path::Path::new("."), &mut problems);
    promise::placed(&problems);
    assert!(program.is_some() || problems.any_error(), "refused without a word");
    if let Some(program) = program {
        assert!(!program.name.is_empty() && !program.command.is_empty());
        assert!(program.tolerance.is_finite() && program.timeout.as_nanos() > 0);
        for word in program.command.iter().chain(&program.set) {
            assert!(word.filled(&|_| "word".to_string()).len() < input.len() + 1024);
        }
    }
}
