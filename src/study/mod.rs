//! Dependence of a verdict on the selection of sections. Selections are computed from sums of
//! sections, without evaluating records again.
//!
//! | file | content |
//! |---|---|
//! | `case` | strata, values and limits of a campaign |
//! | `halves` | selections as pairs of two halves; a statistic as a sum of their contributions |
//! | `groups`, `buckets` | rows of selections with the columns in approximate order of the values |
//! | `spread`, `pilot`, `window` | exact order statistics of such sums, without storing them |
//! | `pooled` | statistics that are no sums, from the values of each selection |
//! | `listed`, `extremes` | order statistics from lists or sorted sums; of largest values, by binomial coefficients |
//! | `grid` | bounds of the order statistics of means, for any number of selections |
//! | `overall` | one statistic over all selections |
//! | `fails`, `verdicts` | bit sets of selections that do not meet a limit; the quantities that fail |
//! | `judged` | one selection from its sections |
//! | `counted` | what many selections say, with names |
//! | `enumerate` | all selections |
//! | `sampling`, `random`, `quartiles` | random selections, with intervals |
//! | `known` | statistics that are exact even where selections are random |
//! | `flips` | selections whose verdict changes with other values |
//! | `removal`, `greedy` | smallest sets that change the verdict; a set by greedy search |
//! | `reduce` | fewer sections with the same scatter |

mod buckets;
pub mod case;
pub mod counted;
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
mod pooled;
pub mod quartiles;
pub mod random;
mod reduce;
mod removal;
pub mod sampling;
pub mod spread;
pub mod verdicts;
mod window;

use crate::result::{
    Remark,
    study::{Counted, Removal, SelectionStudy, Stratum},
};
use case::Case;
use fails::Fails;
pub use reduce::reduced;

/// Settings of a study.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Number of selections up to which all are evaluated; beyond it, random ones.
    pub most: f64,
    /// Width of the 95 % interval of the share at which drawing stops.
    pub width: f64,
    pub seed: u64,
}

/// Largest number of enumerated selections: a bit set of them takes 25 MB, and about eight are
/// used.
pub const MOST: f64 = 2e8;

impl Default for Settings {
    fn default() -> Self {
        Self { most: MOST, width: 0.01, seed: 1 }
    }
}

impl Settings {
    /// Whether every selection of a case is evaluated.
    fn evaluates_all(&self, case: &Case) -> bool {
        case.combinations() <= self.most
            && case.measures().all(|(_, measure)| measure.is_countable(case))
    }
}

/// The smallest sets of sections that change the verdict on all sections.
pub fn smallest_removal(case: &Case) -> Removal {
    removal::smallest(case, case.judge(&case.usable()).0)
}

/// Evaluates the selections of a case, and the smallest sets of sections that change the verdict.
pub fn selections(case: &Case, settings: &Settings) -> SelectionStudy {
    let found = marked(case, settings).0;
    SelectionStudy { removal: Some(removal::smallest(case, found.verdict)), ..found }
}

/// The same without these sets, with the selections that are not validated if all were evaluated.
pub fn marked(case: &Case, settings: &Settings) -> (SelectionStudy, Option<Fails>) {
    let combinations = case.combinations();
    let (counted, fails) = if settings.evaluates_all(case) {
        let (counted, fails) = enumerate::marked(case);
        (counted, Some(fails))
    } else {
        (sampling::some(case, settings), None)
    };
    let usable = case.usable();
    let (verdict, _) = case.judge(&usable);
    let strata: Vec<Stratum> = case.strata.iter().map(|stratum| named(case, stratum)).collect();
    let by_zone = |count: fn(&Stratum) -> usize| {
        strata.iter().map(|stratum| (stratum.zone.clone(), count(stratum))).collect()
    };
    let found = SelectionStudy {
        counted: Counted { combinations, share: counted.share },
        sections_per_zone: by_zone(|stratum| stratum.sections.len()),
        taken_per_zone: by_zone(|stratum| stratum.take),
        strata,
        verdict,
        lacking: lacking(case),
        quantities: counted.quantities,
        sections: counted.sections,
        worst: counted.worst,
        removal: None,
        reduction: None,
        methods: counted.methods,
    };
    (found, fails)
}

/// Why no selection can be assessed: even the sections with the most pairs have fewer than a
/// quantity needs.
fn lacking(case: &Case) -> Option<Remark> {
    let most = |pairs: &dyn Fn(usize) -> usize| -> usize {
        let of_stratum = |stratum: &case::Stratum| {
            let mut all: Vec<usize> = stratum.members.iter().map(|&at| pairs(at)).collect();
            all.sort_unstable_by(|a, b| b.cmp(a));
            all.iter().take(stratum.take).sum::<usize>()
        };
        case.strata.iter().map(of_stratum).sum()
    };
    let of_quantity = |quantity: &case::Quantity| {
        let in_all = (quantity.minimum_pairs, most(&|at| quantity.values[at].len()));
        let of_groups = quantity
            .minimum_of_groups
            .iter()
            .map(|group| (group.needed, most(&|at| group.pairs[at])));
        let (needed, most) = std::iter::once(in_all)
            .chain(of_groups)
            .find(|(needed, most)| most < needed && *needed < usize::MAX)?;
        let quantity = quantity.symbol.clone();
        Some(Remark::NoSelectionSuffices { quantity, most, needed })
    };
    case.quantities.iter().find_map(of_quantity)
}

fn named(case: &Case, stratum: &case::Stratum) -> Stratum {
    let name = |at: usize| case.sections[at].clone();
    Stratum {
        zone: stratum.zone.clone(),
        title: stratum.title.clone(),
        take: stratum.take,
        sections: stratum.members.iter().map(|&at| name(at)).collect(),
        not_used: stratum.not_used.clone(),
    }
}
