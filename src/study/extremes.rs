//! Largest and smallest values over all selections, counted by binomial coefficients without
//! forming selections.

use super::{
    case::{Case, Measure, choose},
    listed::{Listed, weighted},
};

/// Order statistics of a largest value, a smallest value or a largest magnitude. `None` for other
/// statistics, and where no selection has a value.
///
/// The largest value of a selection is at most a bound if that of each of its sections is. The
/// number of such selections is the product, over the zones, of the choices among the sections
/// within the bound.
pub fn over_all(case: &Case, measure: &Measure) -> Option<Listed> {
    let (sign, of_sections) = measure.extremes()?;
    let of_section = |at: usize| of_sections[at].unwrap_or(f64::NEG_INFINITY);
    let strata: Vec<(usize, Vec<f64>)> = case
        .strata
        .iter()
        .map(|stratum| {
            let mut values: Vec<f64> = stratum.members.iter().map(|&at| of_section(at)).collect();
            values.sort_unstable_by(f64::total_cmp);
            (stratum.take, values)
        })
        .collect();
    let upto = |bound: f64| -> f64 {
        let choices = |(take, values): &(usize, Vec<f64>)| {
            let members = values.partition_point(|value| *value <= bound);
            if members < *take { 0.0 } else { choose(members, *take) }
        };
        strata.iter().map(choices).product()
    };
    let mut values: Vec<f64> = strata
        .iter()
        .flat_map(|(_, values)| values)
        .copied()
        .filter(|value| value.is_finite())
        .collect();
    values.sort_unstable_by(f64::total_cmp);
    values.dedup();
    let mut before = upto(f64::NEG_INFINITY);
    let mut list = Vec::with_capacity(values.len());
    for value in values {
        let now = upto(value);
        if now > before {
            list.push((sign * value, now - before));
        }
        before = now;
    }
    if sign < 0.0 {
        list.reverse();
    }
    weighted(&list)
}
