//! Checks whether records extend far enough beyond their section for slow filters to settle.

use std::collections::BTreeSet;

use super::section_values::SectionValues;
use crate::check::plan::StepSpec;
use crate::graph::{NodeId, Operation};
use crate::metrics::filter::{Band, Roots};
use crate::result::Remark;
use crate::run::record::{Opened, Work};
use crate::run::sections::Unit;

/// One note for all sections used whose record is too short for a slow filter.
pub fn margin_note<'a>(used: impl Iterator<Item = &'a SectionValues>) -> Option<Remark> {
    let margins: Vec<Option<f64>> = used.map(|values| values.short_margin).collect();
    let short: Vec<f64> = margins.iter().copied().flatten().collect();
    let least = short.iter().copied().reduce(f64::min)?;
    let (_, rms, extreme) = MARGIN_TRIALS
        .iter()
        .rev()
        .find(|(margin, _, _)| *margin <= least)
        .copied()
        .unwrap_or(MARGIN_TRIALS[0]);
    Some(Remark::ShortMargins {
        short: short.len(),
        sections: margins.len(),
        least,
        needed: SLOW_FILTER_MARGIN,
        frequency: SLOW_FILTER,
        rms,
        extreme,
    })
}

/// Effect of a short margin: margin in s, and the largest change in % of an rms value and of an
/// extreme value (0.15 and 99.85 % values), compared with records that extend 3.2 s beyond the
/// section. Source: own trials with car body accelerations of seven sections of three simulated
/// campaigns (28 values of each kind), band-pass 0.4 to 10 Hz, order 4, zero-phase. Evaluated parts
/// of 2 to 4 s, for which the ends have the largest effect. Half of the values changed by less than
/// a fifth of this.
const MARGIN_TRIALS: [(f64, u8, u8); 7] = [
    (0.0, 50, 75),
    (0.25, 19, 50),
    (0.5, 16, 41),
    (1.0, 9, 27),
    (1.5, 7, 16),
    (2.0, 4, 10),
    (3.0, 2, 10),
];

/// Frequency in Hz below which a filter needs this margin, and the margin in s on each side of the
/// section (own trials: 5 s keep the error at a 0.4 Hz edge below 0.5 % of an rms value).
const SLOW_FILTER: f64 = 1.0;
const SLOW_FILTER_MARGIN: f64 = 5.0;

/// Lowest edge frequency of a filter, or the frequency of its slowest pole.
fn lowest_frequency(step: &StepSpec) -> Option<f64> {
    match step {
        StepSpec::Butterworth { band, .. } => match band {
            Band::LowPass(edge)
            | Band::HighPass(edge)
            | Band::BandPass(edge, _)
            | Band::BandStop(edge, _) => Some(*edge),
        },
        StepSpec::Transfer { function, .. } => match function.poles {
            Roots::One(frequency) => Some(frequency),
            // At low quality there are two real poles; the lower one is near this frequency.
            Roots::Two { frequency, quality } => Some(frequency * quality.min(1.0)),
        },
        _ => None,
    }
}

/// Whether one of the nodes is a slow filter.
pub fn slow(work: &Work<'_>, needed: &BTreeSet<NodeId>) -> bool {
    needed.iter().any(|&id| match &work.graph.nodes[id].operation {
        Operation::Step(step) => {
            lowest_frequency(step).is_some_and(|frequency| frequency < SLOW_FILTER)
        }
        _ => false,
    })
}

/// Notes the margin of a record that a slow filter ran over, if it is too short.
pub fn note_margins(unit: &Unit, slow: bool, opened: &Opened, values: &mut SectionValues) {
    let Some((before, after)) = opened.margins else { return };
    if slow && unit.extent.is_some() && before.min(after) < SLOW_FILTER_MARGIN {
        values.short_margin = Some(before.min(after));
    }
}
