//! Selection of the sections that, if measured again, would best discriminate two causes: T-optimal
//! design (Atkinson and Fedorov 1975) among further sections like those of each stratum.

use crate::diagnose::checks::channels::{View, part};
use crate::diagnose::fit::fitter::{Fitted, Fitter};
use crate::diagnose::linearise::{
    candidate::Candidate,
    mask::Mask,
    whiten::{Covariance, dot},
};
use crate::diagnose::run::Found;

/// Distance of two causes, in standard deviations of the allowed difference.
#[derive(Clone, Debug, PartialEq)]
pub struct Apart {
    pub now: f64,
    /// The distance with as many further sections like `sections`, the most effective kind.
    pub then: f64,
    pub sections: Vec<usize>,
}

/// The distance between a member of the answer and its rival.
pub fn apart(found: &Found, member: &Fitted, rival: &Fitted) -> Option<Apart> {
    let change = member.change(&found.fitted.candidates, &found.masks);
    let of = (&found.fitted.candidates[rival.candidate], &found.masks[rival.mask]);
    best(&found.alone.covariance, &found.seen.first_runs(), &found.strata, &change, of)
}

fn best(
    covariance: &Covariance,
    all: &[usize],
    strata: &[Vec<usize>],
    change: &[f64],
    (candidate, mask): (&Candidate, &Mask),
) -> Option<Apart> {
    let distance = |more: &[usize]| {
        let view =
            View { sections: [all, more].concat(), features: (0..covariance.size).collect() };
        let whitener = covariance.part(&view.sections, &view.features).whitener();
        let mut seen = candidate.clone();
        for node in seen.nodes.iter_mut().filter(|node| !node.change.is_empty()) {
            node.change = part(&mask.on(&node.change), covariance.size, &view);
        }
        let z = whitener.apply(&part(change, covariance.size, &view));
        let everywhere = Mask::everywhere(view.sections.len());
        let fitter = Fitter::new(&whitener, std::slice::from_ref(&seen), vec![everywhere]);
        let fitted = fitter.fit(&z, 0, 0)?;
        Some((dot(&z, &z) - fitted.fall).max(0.0).sqrt())
    };
    let now = distance(&[])?;
    let more = strata.iter().filter_map(|sections| Some((distance(sections)?, sections)));
    let (then, sections) = more.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Apart { now, then, sections: sections.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::linearise::candidate::Node;
    use crate::diagnose::linearise::response::ResponseError;

    /// Two features in each of four sections, unit noise. The effect changes both features equally.
    /// The rival does so in the first two sections and changes them in opposite directions in the
    /// last two. Only the last two discriminate.
    #[test]
    fn the_sections_in_which_rivals_differ_are_chosen() {
        let covariance = Covariance {
            diagonal: vec![1.0; 8],
            inside: Vec::new(),
            shared: Vec::new(),
            size: 2,
            response: ResponseError::default(),
        };
        let change = vec![2.0; 8];
        let nodes = vec![
            Node { size: 0.0, change: Vec::new() },
            Node { size: 10.0, change: vec![20.0, 20.0, 20.0, 20.0, 20.0, -20.0, 20.0, -20.0] },
        ];
        let rival = Candidate::path("rival", nodes);
        let everywhere = Mask::everywhere(4);
        let found = best(
            &covariance,
            &[0, 1, 2, 3],
            &[vec![0, 1], vec![2, 3]],
            &change,
            (&rival, &everywhere),
        )
        .expect("both change");
        // |a|^2 - (a'b)^2 / |b|^2, with b the rival at size 1.
        assert_eq!(found.sections, [2, 3]);
        assert!((found.now - (32.0_f64 - 16.0 * 16.0 / 32.0).sqrt()).abs() < 1e-9, "{}", found.now);
        assert!(
            (found.then - (48.0_f64 - 16.0 * 16.0 / 48.0).sqrt()).abs() < 1e-9,
            "{}",
            found.then
        );
    }
}
