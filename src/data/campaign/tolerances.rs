//! What a diagnosis tolerates of a channel against its uncertainty.

use super::{facts::Fact, uncertainty::Uncertainty};
use crate::data::prelude::*;

/// The map of `campaign.yaml` with what a diagnosis tolerates.
const TOLERANCES: &str = "declared_tolerances";

/// In the tolerances, what is of every channel: `channel gain [-]`.
const EVERY_CHANNEL: &str = "channel";

/// Relative difference up to which two numbers state the same uncertainty: both are rounded to two
/// or three digits.
const SAME: f64 = 0.01;

/// What the diagnosis tolerates of a channel must be what its uncertainty is.
///
/// Problem: `uncertainty-contradiction`.
pub fn check_tolerances(all: &[Uncertainty], facts: &[Fact], problems: &mut Problems) {
    for of in all {
        let word = of.size.word();
        let names = [of.channel.value.as_str(), EVERY_CHANNEL].map(|name| format!("{name} {word}"));
        for fact in
            facts.iter().filter(|fact| fact.group == TOLERANCES && names.contains(&fact.name))
        {
            let unit = Unit::parse(fact.unit.as_deref().unwrap_or("-"));
            let declared = fact.text.trim().parse().ok().zip(unit.ok());
            // What is no number or unit, the diagnosis refuses.
            let Some(declared) = declared.map(|(number, unit): (f64, Unit)| unit.to_si(number))
            else {
                continue;
            };
            let stated = of.size.si();
            if (declared - stated).abs() <= SAME * declared.max(stated) {
                continue;
            }
            let problem = problem!(
                "uncertainty-contradiction",
                &of.span,
                "the standard uncertainty of the {word} of `{}` is another one than `{}` among the declared tolerances",
                of.channel.value,
                fact.name
            );
            problems.push(
                problem
                    .also(&fact.span, "declared here")
                    .help("write the same standard deviation in both, or leave the tolerance out"),
            );
        }
    }
}
