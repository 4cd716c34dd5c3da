//! Adds effects to a section: parameters of the simulator, and operations on its signals.

use super::{Section, Simulator, Task};
use crate::effects::{Action, Applied, Catalogue, Formula, Operator, Parameter, Signals};
use crate::problem::{Problem, error};
use crate::yaml::Words;

/// Effects on one section.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// Parameters of the simulator, in its units.
    pub settings: Vec<(String, f64)>,
    /// Before the measuring chain, in the order chosen: formulas of an effect, with the values of
    /// all its parameters.
    pub formulas: Vec<(Vec<Formula>, Vec<f64>)>,
    /// In the order of the measuring chain.
    pub operators: Vec<(Operator, f64, Vec<String>)>,
}

impl Plan {
    /// The part of `effects` that acts on `section`, for a simulator.
    ///
    /// # Errors
    /// The catalogue does not define an effect for this simulator.
    pub fn new(
        catalogue: &Catalogue,
        effects: &[Applied],
        section: &Section,
        simulator: Option<&str>,
    ) -> Result<Self, Problem> {
        let mut plan = Self::default();
        for applied in effects {
            let here = |confined: &crate::effects::Confined| {
                section.fact(&confined.column).is_some_and(|value| confined.has(value))
            };
            let Some(effect) = catalogue.effect(&applied.effect) else { continue };
            if !applied.confined.as_ref().is_none_or(here) {
                continue;
            }
            if let Action::Formulas(formulas) = &effect.action {
                let neutral = |one: &Parameter| one.neutral.unwrap_or(one.default);
                let values: Vec<f64> = effect
                    .parameters
                    .iter()
                    .map(|one| applied.value(&one.name).unwrap_or_else(|| neutral(one)))
                    .collect();
                if values.iter().zip(&effect.parameters).any(|(value, one)| *value != neutral(one))
                {
                    plan.formulas.push((formulas.clone(), values));
                }
                continue;
            }
            for parameter in &effect.parameters {
                let Some(value) = applied.value(&parameter.name) else { continue };
                // Neutral values are set as well, since the vehicle file may differ. Operations
                // with neutral values are skipped.
                if parameter.neutral == Some(value) && effect.action != Action::Simulator {
                    continue;
                }
                if let Action::Signals(operator, _) = &effect.action {
                    plan.operators.push((*operator, value, applied.channels.clone()));
                    continue;
                }
                let of_simulator =
                    |name: &str| parameter.simulators.iter().find(|(known, ..)| known == name);
                let found = match simulator {
                    None => parameter.model.as_ref().map(|(key, factor)| (key, factor)),
                    Some(name) => of_simulator(name).map(|(_, key, factor)| (key, factor)),
                };
                let (key, factor) = found.ok_or_else(|| {
                    let simulator = simulator.unwrap_or("the built-in model");
                    unsaid(&effect.name, &parameter.name, simulator)
                })?;
                plan.set(key, value * factor);
            }
        }
        plan.operators.sort_by_key(|(operator, ..)| *operator);
        Ok(plan)
    }

    fn set(&mut self, key: &str, value: f64) {
        self.settings.retain(|(known, _)| known != key);
        self.settings.push((key.to_string(), value));
    }

    /// Recorded minus true position, in the unit of the axis.
    pub fn shift(&self) -> f64 {
        self.operators
            .iter()
            .filter(|(operator, ..)| *operator == Operator::Shift)
            .map(|(_, value, _)| value)
            .sum()
    }

    /// Applies the operations of the measuring chain to the signals of a section.
    ///
    /// # Errors
    /// An operation cannot be applied; the message names the section.
    pub fn operate(&self, signals: &mut Signals, section: &Section) -> Result<(), Problem> {
        let seed = section.name().bytes().fold(0xCBF2_9CE4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3)
        });
        let failed = |says: String| section.named(error("operator", says, &section.cell.span));
        for (formulas, values) in &self.formulas {
            signals.compute(formulas, values).map_err(failed)?;
        }
        for (operator, value, channels) in &self.operators {
            signals
                .apply(*operator, *value, channels, seed)
                .map_err(|says| failed(format!("{}: {says}", operator.word())))?;
        }
        Ok(())
    }
}

/// Checks that confinements refer to an existing column and value of the section table.
///
/// # Errors
/// `no-such-section`, with the nearest value.
pub fn check_confined(effects: &[Applied], sections: &[Section]) -> Vec<Problem> {
    let mut problems = Vec::new();
    for applied in effects {
        let Some(confined) = &applied.confined else { continue };
        for value in &confined.values {
            if sections.iter().any(|section| section.fact(&confined.column) == Some(value)) {
                continue;
            }
            let says = format!(
                "`{}` is confined to the {} `{value}`, but no section has this value",
                applied.effect, confined.column
            );
            let mut known: Vec<&str> =
                sections.iter().filter_map(|section| section.fact(&confined.column)).collect();
            known.sort_unstable();
            known.dedup();
            problems.push(Problem::error("no-such-section", says).suggest(value, known));
        }
        if confined.values.is_empty() {
            let says = format!("`{}` is confined to no {}", applied.effect, confined.column);
            problems.push(
                Problem::error("no-such-section", says)
                    .help("write `in zones 3, 4` or `in sections S01, S02`"),
            );
        }
    }
    problems
}

fn unsaid(effect: &str, parameter: &str, simulator: &str) -> Problem {
    Problem::error(
        "not-simulated",
        format!("the catalogue does not define how {simulator} adds `{parameter}` of `{effect}`"),
    )
    .help("name the simulator's parameter under `simulators` or `model` of the effect's parameter")
}

/// Simulates a section with effects. With `recorded`, a simulation from elsewhere, the effects are
/// an increment: recorded + (simulator with effects - simulator without), so that differences
/// between the two simulators cancel.
///
/// # Errors
/// Of the simulator, of the catalogue (see [`Plan::new`]) and of operations.
pub fn simulate(
    simulator: &dyn Simulator,
    catalogue: &Catalogue,
    effects: &[Applied],
    section: &Section,
    recorded: Option<&Signals>,
) -> Result<Signals, Problem> {
    let plan = Plan::new(catalogue, effects, section, simulator.catalogue_name())?;
    let run = |settings: &[(String, f64)], shift: f64| {
        simulator.run(&Task { section, settings, shift, inside_only: false })
    };
    let mut signals = match recorded {
        None => run(&plan.settings, plan.shift())?,
        Some(recorded) if plan.settings.is_empty() => recorded.clone(),
        Some(recorded) => incremented(recorded, &run(&plan.settings, 0.0)?, &run(&[], 0.0)?),
    };
    plan.operate(&mut signals, section)?;
    Ok(signals)
}

/// `recorded + (with - without)`, by position; channels that the simulator does not have are
/// unchanged.
pub fn incremented(recorded: &Signals, with: &Signals, without: &Signals) -> Signals {
    let mut sum = recorded.clone();
    for channel in &mut sum.channels {
        let (Some(with), Some(base)) =
            (with.channel(&channel.name), without.channel(&channel.name))
        else {
            continue;
        };
        let difference: Vec<f64> =
            with.values.iter().zip(&base.values).map(|(with, base)| with - base).collect();
        let mut at = 0;
        for (x, value) in recorded.axis.iter().zip(&mut channel.values) {
            *value += interpolated(&without.axis, &difference, *x, &mut at);
        }
    }
    sum
}

/// Linear interpolation, constant beyond the ends; `at` is the interval of the last call.
pub fn interpolated(axis: &[f64], values: &[f64], x: f64, at: &mut usize) -> f64 {
    let last = axis.len().min(values.len()).saturating_sub(1);
    while *at + 1 < last && axis[*at + 1] <= x {
        *at += 1;
    }
    let (from, to) = (*at, (*at + 1).min(last));
    if to == from {
        return values.get(from).copied().unwrap_or(0.0);
    }
    let share = ((x - axis[from]) / (axis[to] - axis[from])).clamp(0.0, 1.0);
    values[from] + share * (values[to] - values[from])
}
