//! Reduction of the sections to those that keep the scatter, as a step of the protocol.

use std::collections::HashSet;

use super::pool::{Pool, Pooled, PooledLimit, PooledQuantity, pool};
use crate::catalog::Statistic;
use crate::check::plan::{Keep, Plan, Scalar};
use crate::metrics::reduction::{Measure, reduced};
use crate::result::study::Reduction;
use crate::run::sections::{Facts, Unit};
use crate::run::values::SectionValues;

/// Leaves out sections, where the protocol says so. With `before`, those that another evaluation of
/// the campaign left out.
pub fn keep(
    plan: &Plan,
    facts: &Facts,
    units: &mut [Unit],
    values: &[SectionValues],
    before: Option<&Reduction>,
) -> Option<Reduction> {
    let keep = plan.sections.keep.as_ref()?;
    let reduction =
        before.cloned().unwrap_or_else(|| of(keep, &pool(plan, facts, units, values), units));
    let left_out: HashSet<&String> = reduction.left_out.iter().collect();
    for unit in units.iter_mut().filter(|unit| left_out.contains(&unit.name)) {
        unit.refuse(
            format!("left out by the reduction to {}, which keeps the scatter", keep.words),
            false,
        );
    }
    Some(reduction)
}

fn of(keep: &Keep, pool: &Pool, units: &[Unit]) -> Reduction {
    let mut groups: Vec<(String, Vec<usize>)> = Vec::new();
    for (at, unit) in units.iter().enumerate().filter(|(_, unit)| unit.fault.is_none()) {
        let word = |column: &usize| match unit.columns.get(*column) {
            Some(Ok(Scalar::Word(word))) => word.clone(),
            Some(Ok(Scalar::Flag(flag))) => flag.to_string(),
            _ => String::new(),
        };
        let name = keep.each.iter().map(word).collect::<Vec<_>>().join(", ");
        match groups.iter_mut().find(|(known, _)| *known == name) {
            Some((_, members)) => members.push(at),
            None => groups.push((name, vec![at])),
        }
    }
    let limits = pool
        .quantities
        .iter()
        .flat_map(|quantity| quantity.limits.iter().map(move |limit| (quantity, limit)));
    let (symbols, measures): (Vec<&String>, Vec<Measure>) = limits
        .filter_map(|(quantity, limit)| Some((&quantity.symbol, measure(quantity, limit)?)))
        .unzip();
    let scatter = |members: &[usize]| {
        measures.iter().map(|measure| measure.over(members)).collect::<Vec<f64>>()
    };
    let members: Vec<Vec<usize>> = groups.iter().map(|(_, members)| members.clone()).collect();
    let most: Vec<usize> = members.iter().map(|members| keep.most.min(members.len())).collect();
    let kept = reduced(&members, &most, &measures);
    let name = |at: &usize| units[*at].name.clone();
    let (all, after) = (scatter(&members.concat()), scatter(&kept.concat()));
    let stay: HashSet<usize> = kept.iter().flatten().copied().collect();
    Reduction {
        most: keep.most,
        left_out: members.concat().iter().filter(|at| !stay.contains(at)).map(name).collect(),
        kept: groups
            .into_iter()
            .zip(&kept)
            .map(|((group, _), kept)| (group, kept.iter().map(name).collect()))
            .collect(),
        scatter: symbols
            .into_iter()
            .zip(all.iter().zip(&after))
            .map(|(symbol, (all, after))| (symbol.clone(), *all, *after))
            .collect(),
    }
}

/// The standard deviation or root mean square of any sections, as a share of its limit.
fn measure(quantity: &PooledQuantity, limit: &PooledLimit) -> Option<Measure> {
    let ddof = match limit.estimate {
        Pooled::Statistic(Statistic::Named(entry), ddof) if entry.name == "std" => {
            Some(ddof as f64)
        }
        Pooled::Statistic(Statistic::Named(entry), _) if entry.name == "rms" => None,
        _ => return None,
    };
    let bound = limit.bounds.first().copied().filter(|bound| *bound > 0.0)?;
    let applies = |position: &usize| limit.positions.get(*position).copied().unwrap_or(true);
    let of_section = |(at, values): (usize, &Vec<(usize, f64)>)| {
        let inside = values
            .iter()
            .filter(|(position, _)| limit.inside[at] && applies(position))
            .map(|(_, value)| value / bound);
        inside.fold([0.0; 3], |[n, x, xx], value| [n + 1.0, x + value, xx + value * value])
    };
    Some(Measure {
        ddof,
        scale: 1.0,
        sums: quantity.values.iter().enumerate().map(of_section).collect(),
    })
}
