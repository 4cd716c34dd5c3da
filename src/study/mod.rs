//! How far a verdict depends on the sections chosen: every selection, counted and not run.
//!
//! | file | what |
//! |---|---|
//! | `case` | strata, values and limits of a campaign |
//! | `halves` | selections as pairs of two halves; a statistic as a sum of their parts |
//! | `groups`, `buckets` | rows of selections with their columns in about the order of the values |
//! | `spread`, `pilot`, `window` | exact order statistics of such sums, without keeping them |
//! | `listed`, `extremes` | order statistics where values can be listed or sums only added; of largest values, by binomials |
//! | `grid` | bounds of the order statistics of means, however many selections there are |
//! | `overall` | one statistic over all selections |
//! | `fails`, `verdicts` | a bit for every selection that breaks a limit; by which quantities selections fail |
//! | `judged` | one selection from its sections |
//! | `enumerate` | all selections |
//! | `sampling`, `random`, `quartiles` | some of them, drawn at random, with intervals |
//! | `known` | what is known of all of them all the same |
//! | `flips` | selections whose verdict is another under other values |
//! | `removal`, `greedy` | smallest sets that change the verdict; some set, where not all can be tried |
//! | `reduce` | fewer sections with the same scatter |

mod buckets;
pub mod case;
pub mod enumerate;
pub mod extremes;
pub mod fails;
pub mod flips;
pub mod greedy;
pub mod grid;
pub mod groups;
pub mod halves;
pub mod judged;
mod known;
pub mod listed;
pub mod overall;
mod pilot;
pub mod quartiles;
pub mod random;
mod reduce;
mod removal;
pub mod sampling;
pub mod spread;
pub mod verdicts;
mod window;

use crate::result::study::{SelectionStudy, Stratum};
use case::Case;
use fails::Fails;
pub use reduce::reduced;

/// How a study is done where there is a choice.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Selections that are all looked at; more are drawn from.
    pub most: f64,
    /// Width of the interval of the share at which drawing ends.
    pub width: f64,
    pub seed: u64,
}

/// Selections that are enumerated: a set of bits, one for each, takes 25 MB, and there are about eight of them.
pub const MOST: f64 = 2e8;
/// Selections enumerated where a statistic has to be taken from all values together.
const MOST_POOLED: f64 = 2e6;

impl Default for Settings {
    fn default() -> Self {
        Self { most: MOST, width: 0.01, seed: 1 }
    }
}

impl Settings {
    /// Selections of a case that are all looked at.
    fn most_of(&self, case: &Case) -> f64 {
        let pooled = case.measures().any(|(_, measure)| matches!(measure.kind, case::Kind::Pooled(_)));
        if pooled { self.most.min(MOST_POOLED) } else { self.most }
    }
}

/// Every selection of a case, or as many as it takes, and the smallest sets of sections that decide the verdict.
pub fn selections(case: &Case, settings: &Settings) -> SelectionStudy {
    let found = marked(case, settings).0;
    SelectionStudy { removal: Some(removal::smallest(case, found.verdict)), ..found }
}

/// Every selection without such sets, and the marks of the selections that are not validated, if all were looked at.
pub fn marked(case: &Case, settings: &Settings) -> (SelectionStudy, Option<Fails>) {
    let combinations = case.combinations();
    let (counted, fails) = if combinations <= settings.most_of(case) {
        let (counted, fails) = enumerate::marked(case);
        (counted, Some(fails))
    } else {
        (sampling::some(case, settings), None)
    };
    let usable = case.usable();
    let (verdict, _) = case.judge(&usable);
    let found = SelectionStudy {
        strata: case.strata.iter().map(|stratum| named(case, stratum)).collect(),
        combinations,
        share: counted.share,
        verdict,
        quantities: counted.quantities,
        sections: counted.sections,
        worst: counted.worst,
        removal: None,
        reduction: None,
        methods: counted.methods,
    };
    (found, fails)
}

fn named(case: &Case, stratum: &case::Stratum) -> Stratum {
    let name = |at: usize| case.sections[at].clone();
    Stratum {
        zone: stratum.zone.clone(),
        title: stratum.title.clone(),
        take: stratum.take,
        sections: stratum.members.iter().map(|&at| name(at)).collect(),
        not_used: stratum.not_used.iter().map(|(at, why)| (name(*at), why.clone())).collect(),
    }
}
