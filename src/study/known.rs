//! Order statistics that are computed for all selections even where there are too many to
//! enumerate.

use rayon::prelude::*;

use super::{
    case::{Case, Kind, Measure},
    extremes,
    grid::Additive,
    halves::{Halves, Parts},
    listed::sums,
};
use crate::metrics::moments::Moment;
use crate::result::study::Spread;

/// Largest number of choices of a half that is listed for an exact statistic.
const MOST_LISTED: f64 = 2e6;

/// For every limit its order statistics over all selections, where they can be computed without
/// random selections.
pub fn known(case: &Case) -> Vec<Option<Spread>> {
    let (rows, columns) = Halves::sizes(case);
    let halves = (rows <= MOST_LISTED && columns <= MOST_LISTED).then(|| Halves::of(case));
    let combinations = case.combinations();
    let measures: Vec<&Measure> = case.measures().map(|(_, measure)| measure).collect();
    let of = |measure: &&Measure| match (measure.kind, &halves) {
        (Kind::Sum(Moment::Deviation { .. }), _) => None,
        (Kind::Values, _) => measure.listed_alone(case).map(Spread::from),
        (Kind::Largest | Kind::Smallest | Kind::LargestMagnitude, _) => {
            extremes::over_all(case, measure).map(Spread::from)
        }
        (Kind::Sum(_), Some(halves)) => match measure.parts(halves) {
            Parts::Sums { blocks, form, .. } => sums(&blocks, form).map(Spread::from),
            Parts::Extremes { .. } | Parts::Pooled => None,
        },
        (Kind::Sum(_), None) => Additive::of(case, measure)?.spread(combinations),
    };
    measures.par_iter().with_max_len(1).map(of).collect()
}

/// One sentence for each method used.
pub fn methods(known: &[Option<Spread>]) -> Vec<String> {
    let (all, exact) = (known.len(), known.iter().flatten().filter(|spread| spread.exact).count());
    let surely: Vec<f64> = known.iter().flatten().filter_map(|spread| spread.within).collect();
    let mut methods = Vec::new();
    if exact > 0 {
        methods.push(format!(
            "{exact} of {all} statistics are nevertheless exact: selections with a largest value up to a bound are counted by binomial coefficients, order statistics of means follow from sorted half selections, and estimates of one group are evaluated for every choice of its sections."
        ));
    }
    if !surely.is_empty() {
        let widest = surely.iter().copied().fold(0.0, f64::max);
        methods.push(format!(
            "{} of {all} statistics, which are means, are computed for all selections: minima and maxima exactly, quartiles within ± {widest:.1e}, by counting the contributions of the sections on a grid.",
            surely.len()
        ));
    }
    methods
}
