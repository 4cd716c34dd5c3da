//! Checks the step of a transfer function: poles and zeros of the wording.

use super::{prelude::*, steps::phase, wordings::Filled};
use crate::catalog::{FormPart, StepEntry};
use crate::metrics::filter::{Roots, TransferFunction, Warping};

impl Checker<'_> {
    /// A transfer function: `transfer function poles 12.5 Hz quality 0.63 zero 12.5 Hz, gain 2`.
    /// Each frequency may be followed by its quality factor.
    pub fn transfer(
        &mut self,
        entry: &StepEntry,
        filled: &Filled,
        span: &Span,
    ) -> Option<StepSpec> {
        let mut numbers = filled.numbers.iter();
        let (_, dimension, _) = filled.numbers.first()?;
        // Poles and zeros.
        let mut found: [Option<Roots>; 2] = [None, None];
        let (mut which, mut two) = (0, false);
        for part in entry.form.head {
            match part {
                FormPart::Word(word @ ("pole" | "poles" | "zero" | "zeros")) => {
                    which = usize::from(word.starts_with("zero"));
                    two = word.ends_with('s');
                }
                FormPart::Word(_) => {}
                FormPart::Number(name, _) => {
                    let (quality, _, place) = numbers.next()?;
                    self.positive(name, *quality, place)?;
                    found[which] = Some(Roots::Two {
                        frequency: found[which]?.frequency(),
                        quality: *quality,
                    });
                }
                _ => {
                    let (frequency, own, place) = numbers.next()?;
                    self.suits("frequency", own == dimension, &dimension.in_words(), *own, place)?;
                    let undamped = Roots::Two { frequency: *frequency, quality: f64::INFINITY };
                    found[which] = Some(if two { undamped } else { Roots::One(*frequency) });
                }
            }
        }
        let [Some(poles), zeros] = found else { return None };
        let (gain, _) = filled.options.first().copied().flatten()?;
        if !(gain > 0.0 && gain.is_finite()) {
            return self.refuse(error("out-of-range", "the gain must be above zero", span));
        }
        let warping =
            if filled.choices[1] == "plain" { Warping::Plain } else { Warping::PreWarped };
        let function = TransferFunction { poles, zeros, gain };
        Some(StepSpec::Transfer { function, phase: phase(filled.choices[0]), warping })
    }
}
