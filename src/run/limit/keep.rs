//! Reduction of the sections to those that keep the scatter, as a step of the protocol.

use std::collections::HashSet;

use indexmap::IndexMap;

use super::pool::{Bounds, Pool, Pooled, PooledLimit, PooledQuantity, pool};
use crate::catalog::Statistic;
use crate::metrics::{
    moments::{Moment, Moments, Summed},
    reduction::{over, reduced},
};
use crate::result::study::Reduction;
use crate::run::{
    prelude::*,
    sections::{Facts, Unit},
    values::SectionValues,
};

/// Leaves out sections, where the protocol says so.
pub fn keep(
    plan: &Plan,
    facts: &Facts,
    units: &mut [Unit],
    values: &[SectionValues],
) -> Option<Reduction> {
    let keep = plan.sections.keep.as_ref()?;
    let reduction = reduce_units(keep, &pool(plan, facts, units, values), units);
    let left_out: HashSet<&String> = reduction.left_out.iter().collect();
    for unit in units.iter_mut().filter(|unit| left_out.contains(&unit.name)) {
        unit.refuse(Reason::LeftOutByReduction { kept: keep.words.clone() }, false);
    }
    Some(reduction)
}

fn reduce_units(keep: &Keep, pool: &Pool, units: &[Unit]) -> Reduction {
    let mut groups: IndexMap<String, Vec<usize>> = IndexMap::new();
    for (at, unit) in units.iter().enumerate().filter(|(_, unit)| unit.fault.is_none()) {
        let word = |column: &usize| match unit.columns.get(*column) {
            Some(Ok(Scalar::Word(word))) => word.clone(),
            Some(Ok(Scalar::Flag(flag))) => flag.to_string(),
            _ => String::new(),
        };
        let name = keep.each.iter().map(word).collect::<Vec<_>>().join(", ");
        groups.entry(name).or_default().push(at);
    }
    let limits = pool
        .quantities
        .iter()
        .flat_map(|quantity| quantity.limits.iter().map(move |limit| (quantity, limit)));
    let (symbols, measures): (Vec<&str>, Vec<Summed>) = limits
        .filter_map(|(quantity, limit)| Some((quantity.symbol.as_str(), measure(quantity, limit)?)))
        .unzip();
    let most: Vec<usize> = groups.values().map(|members| keep.most.min(members.len())).collect();
    let name = |at: usize| units[at].name.clone();
    reduction(groups, keep.most, &most, (&symbols, &measures), name).1
}

/// The members of each named group that are kept, `keep` of each, and what this says of the
/// scatter: of each measure with the symbol of its quantity. `most` is the number that was asked
/// for.
pub fn reduction(
    groups: impl IntoIterator<Item = (String, Vec<usize>)>,
    most: usize,
    keep: &[usize],
    (symbols, measures): (&[&str], &[Summed]),
    name: impl Fn(usize) -> String,
) -> (Vec<Vec<usize>>, Reduction) {
    let (titles, members): (Vec<String>, Vec<Vec<usize>>) = groups.into_iter().unzip();
    let kept = reduced(&members, keep, measures);
    let all = members.concat();
    let stay: HashSet<usize> = kept.iter().flatten().copied().collect();
    let named = |members: &[usize]| members.iter().map(|&at| name(at)).collect::<Vec<String>>();
    let left_out: Vec<usize> = all.iter().copied().filter(|at| !stay.contains(at)).collect();
    let scatter = std::iter::zip(over(measures, &all), over(measures, &kept.concat()));
    let scatter = symbols.iter().zip(scatter);
    let reduction = Reduction {
        most,
        left_out: named(&left_out),
        kept: titles.into_iter().zip(kept.iter().map(|kept| named(kept))).collect(),
        scatter: scatter.map(|(symbol, (all, after))| ((*symbol).to_owned(), all, after)).collect(),
    };
    (kept, reduction)
}

/// The standard deviation or root mean square of any sections, as a share of its limit.
fn measure(quantity: &PooledQuantity, limit: &PooledLimit) -> Option<Summed> {
    let Pooled::Statistic(Statistic::Named(entry), ddof) = limit.estimate else { return None };
    let kind = Moment::named(entry.name, ddof).filter(|kind| *kind != Moment::Mean)?;
    let Bounds::Common(bound) = limit.bounds else { return None };
    if bound <= 0.0 {
        return None;
    }
    let applies = |position: &usize| limit.positions.get(*position).copied().unwrap_or(true);
    let of_section = |(at, values): (usize, &Vec<(usize, f64)>)| {
        let inside = values
            .iter()
            .filter(|(position, _)| limit.inside[at] && applies(position))
            .map(|(_, value)| value / bound);
        Moments::about(0.0, &inside.collect::<Vec<f64>>())
    };
    let moments = quantity.values.iter().enumerate().map(of_section).collect();
    Some(Summed { kind, centre: 0.0, scale: 1.0, moments })
}
