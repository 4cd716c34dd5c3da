//! Reduction of the sections to those that keep the scatter, as a step of the protocol.

use super::facts::Facts;
use super::pool::{Pool, Pooled, PooledLimit, PooledQuantity, pool};
use super::section_values::SectionValues;
use super::unit::Unit;
use crate::catalog::Statistic;
use crate::check::plan::{Keep, Plan, Scalar};
use crate::metrics::reduction::reduced;
use crate::result::study::Reduction;

/// Leaves out sections, where the protocol says so. With `before`, those that another evaluation of the campaign left out.
pub fn keep(plan: &Plan, facts: &Facts, units: &mut [Unit], values: &[SectionValues], before: Option<&Reduction>) -> Option<Reduction> {
    let keep = plan.sections.keep.as_ref()?;
    let reduction = before.cloned().unwrap_or_else(|| of(keep, &pool(plan, facts, units, values), units));
    for unit in units.iter_mut().filter(|unit| reduction.left_out.contains(&unit.name)) {
        unit.refuse(format!("left out by the reduction to {}, which keeps the scatter", keep.words), false);
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
    let measures: Vec<(&PooledQuantity, Sums)> = pool
        .quantities
        .iter()
        .flat_map(|quantity| quantity.limits.iter().filter_map(move |limit| Some((quantity, Sums::of(quantity, limit)?))))
        .collect();
    let scatter = |members: &[usize]| -> Vec<f64> { measures.iter().map(|(_, sums)| sums.over(members)).collect() };
    let members: Vec<Vec<usize>> = groups.iter().map(|(_, members)| members.clone()).collect();
    let most: Vec<usize> = members.iter().map(|members| keep.most.min(members.len())).collect();
    let kept = reduced(&members, &most, &scatter);
    let name = |at: &usize| units[*at].name.clone();
    let (all, after) = (scatter(&members.concat()), scatter(&kept.concat()));
    Reduction {
        most: keep.most,
        left_out: members.concat().iter().filter(|at| !kept.iter().flatten().any(|kept| kept == *at)).map(name).collect(),
        kept: groups.into_iter().zip(&kept).map(|((group, _), kept)| (group, kept.iter().map(name).collect())).collect(),
        scatter: measures
            .iter()
            .zip(all.iter().zip(&after))
            .map(|((quantity, _), (all, after))| (quantity.symbol.clone(), *all, *after))
            .collect(),
    }
}

/// Sums of each section, from which a standard deviation or root mean square of any sections follows, as a share of its limit.
struct Sums {
    /// The divisor is n - `ddof`; `None` for a root mean square.
    ddof: Option<f64>,
    /// Number of values, their sum and sum of squares, divided by the limit.
    sections: Vec<(f64, f64, f64)>,
}

impl Sums {
    fn of(quantity: &PooledQuantity, limit: &PooledLimit) -> Option<Self> {
        let ddof = match limit.estimate {
            Pooled::Statistic(Statistic::Named(entry), ddof) if entry.name == "std" => Some(ddof as f64),
            Pooled::Statistic(Statistic::Named(entry), _) if entry.name == "rms" => None,
            _ => return None,
        };
        let bound = limit.bounds.first().copied().filter(|bound| *bound > 0.0)?;
        let applies = |position: &usize| limit.positions.get(*position).copied().unwrap_or(true);
        let of_section = |(at, values): (usize, &Vec<(usize, f64)>)| {
            let inside = values.iter().filter(|(position, _)| limit.inside[at] && applies(position)).map(|(_, value)| value / bound);
            inside.fold((0.0, 0.0, 0.0), |(n, x, xx), value| (n + 1.0, x + value, xx + value * value))
        };
        Some(Self { ddof, sections: quantity.values.iter().enumerate().map(of_section).collect() })
    }

    /// 0 where it is not defined.
    fn over(&self, members: &[usize]) -> f64 {
        let sums = members.iter().map(|&at| self.sections[at]);
        let (n, x, xx) = sums.fold((0.0, 0.0, 0.0), |(n, x, xx), of| (n + of.0, x + of.1, xx + of.2));
        let value = match self.ddof {
            None => (xx / n).sqrt(),
            Some(ddof) if n > ddof => ((xx - x * x / n).max(0.0) / (n - ddof)).sqrt(),
            Some(_) => 0.0,
        };
        if value.is_finite() { value } else { 0.0 }
    }
}
