//! Smallest detectable sizes of the effects.

use crate::diagnose::run::{Found, length};
use crate::result::diagnosis::Detectable;

/// Per effect and parameter, the smallest detectable sizes to either side of neutral: those whose
/// change has the length from which nine of ten single effects are named in drawn campaigns. None
/// where no length suffices.
pub fn detectable(found: &Found) -> Vec<Detectable> {
    let mut list: Vec<Detectable> = Vec::new();
    for candidate in found
        .alone
        .candidates
        .iter()
        .filter(|candidate| !candidate.discrete && candidate.fixed.is_empty())
    {
        let Some(neutral) = candidate.neutral().filter(|neutral| neutral.is_finite()) else {
            continue;
        };
        let mut nodes: Vec<(f64, f64)> = candidate
            .nodes
            .iter()
            .filter(|node| !node.change.is_empty())
            .map(|node| (node.size - neutral, length(&found.alone.whitener, &node.change)))
            .collect();
        nodes.sort_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
        let below = nodes.iter().copied().filter(|(away, _)| *away < 0.0);
        let above = nodes.iter().copied().filter(|(away, _)| *away > 0.0);
        let needed = found.rates.calibration.length;
        let (below, above) = (
            needed.and_then(|needed| long_enough(below, needed)),
            needed.and_then(|needed| long_enough(above, needed)),
        );
        let nearer = |a: f64, b: f64| if a.abs() <= b.abs() { a } else { b };
        let made = Detectable {
            effect: candidate.effect.clone(),
            parameter: candidate.size.clone(),
            unit: candidate.unit.text.clone(),
            neutral,
            smallest: below.zip(above).map(|(a, b)| nearer(a, b)).or(below).or(above),
            below,
            above,
        };
        let alike = |known: &&mut Detectable| {
            known.effect == made.effect
                && known.parameter == made.parameter
                && known.unit == made.unit
        };
        match list.iter_mut().find(alike) {
            Some(_) if candidate.channels.is_empty() => {}
            Some(known) => {
                let farther = |a: Option<f64>, b: Option<f64>| {
                    a.zip(b).map(|(a, b)| if a.abs() >= b.abs() { a } else { b })
                };
                known.smallest = farther(known.smallest, made.smallest);
                (known.below, known.above) =
                    (farther(known.below, made.below), farther(known.above, made.above));
            }
            None => list.push(made),
        }
    }
    list
}

/// The distance from neutral at which the whitened change reaches a length. `nodes` are distances
/// and lengths in increasing order, linear in between. Nothing if it does not reach it.
fn long_enough(nodes: impl Iterator<Item = (f64, f64)>, needed: f64) -> Option<f64> {
    let mut before = (0.0, 0.0);
    for (away, long) in nodes {
        if long >= needed {
            return Some(before.0 + (away - before.0) * (needed - before.1) / (long - before.1));
        }
        before = (away, long);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lengths 2 at distance 1 and 6 at distance 3: length 5 at 1 + 2 * 3 / 4.
    #[test]
    fn what_can_be_seen_lies_between_the_sizes_that_were_tried() {
        assert_eq!(long_enough([(1.0, 2.0), (3.0, 6.0)].into_iter(), 5.0), Some(2.5));
        assert_eq!(long_enough([(-2.0, 10.0)].into_iter(), 5.0), Some(-1.0));
        assert_eq!(long_enough([(1.0, 2.0), (3.0, 4.0)].into_iter(), 5.0), None);
    }
}
