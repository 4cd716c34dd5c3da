//! What a verdict rests on, for who asks what another choice of sections would have said: values of every section and every
//! limit with its bound, in the unit of the quantity.

use super::facts::{Facts, Known};
use super::limits::{Bounds, Part, applies, parts};
use super::pairs::SectionValues;
use super::sections::Unit;
use crate::catalog::Statistic;
use crate::check::plan::{Limit, Plan, Quantity};

pub use crate::check::plan::Rule;

#[derive(Clone, Debug)]
pub struct Pool {
    pub sections: Vec<Section>,
    /// Zones with the sections that each needs; empty where the protocol knows none.
    pub zones: Vec<Zone>,
    /// Usable sections needed in all.
    pub minimum: usize,
    pub quantities: Vec<PooledQuantity>,
    pub rule: Rule,
}

#[derive(Clone, Debug)]
pub struct Section {
    pub name: String,
    pub zone: Option<String>,
    pub used: bool,
    pub reason: Option<String>,
}

#[derive(Clone, Debug)]
pub struct Zone {
    pub name: String,
    pub title: String,
    pub needed: usize,
}

#[derive(Clone, Debug)]
pub struct PooledQuantity {
    pub id: String,
    pub title: String,
    pub symbol: String,
    pub unit: String,
    /// For every section, the signals recorded with their differences; empty for a section not used.
    pub values: Vec<Vec<(usize, f64)>>,
    pub minimum_signals: usize,
    pub minimum_pairs: usize,
    pub limits: Vec<PooledLimit>,
}

/// A limit that applies to this vehicle, for one of its scopes.
#[derive(Clone, Debug)]
pub struct PooledLimit {
    pub statistic: Statistic,
    pub ddof: usize,
    pub at_least: bool,
    /// `standard deviation (n-1)`
    pub title: String,
    /// `all`, `zone 1`
    pub scope: String,
    pub inside: Vec<bool>,
    /// One for each section where every value has its own limit, else one.
    pub bounds: Vec<f64>,
}

/// # Errors
/// None: a limit whose bound has no value is left out with its quantity told as not assessable by the run itself.
pub fn pool(plan: &Plan, facts: &Facts, units: &[Unit], values: &[SectionValues]) -> Pool {
    Pool {
        sections: units
            .iter()
            .map(|unit| Section {
                name: unit.name.clone(),
                zone: unit.zone.clone(),
                used: unit.fault.is_none(),
                reason: unit.fault.clone(),
            })
            .collect(),
        zones: plan
            .zones
            .iter()
            .map(|zone| Zone { name: zone.name.clone(), title: zone.title.clone(), needed: zone.minimum_sections })
            .collect(),
        minimum: plan.sections.minimum,
        quantities: plan
            .quantities
            .iter()
            .enumerate()
            .map(|(index, quantity)| pooled(plan, facts, quantity, index, units, values))
            .collect(),
        rule: plan.verdict.rule,
    }
}

fn pooled(plan: &Plan, facts: &Facts, quantity: &Quantity, index: usize, units: &[Unit], values: &[SectionValues]) -> PooledQuantity {
    let of_section = |(unit, values): (&Unit, &SectionValues)| {
        let pairs = values.pairs.get(index).filter(|_| unit.fault.is_none());
        let recorded = pairs.into_iter().flatten().enumerate();
        recorded.filter_map(|(signal, pair)| pair.map(|pair| (signal, quantity.unit.from_si(pair.difference)))).collect::<Vec<_>>()
    };
    let members: Vec<_> = units
        .iter()
        .zip(values)
        .filter(|(unit, _)| unit.fault.is_none())
        .flat_map(|(unit, values)| values.pairs.get(index).into_iter().flatten().flatten().map(move |pair| (unit, "", *pair)))
        .collect();
    let impossible =
        units.iter().zip(values).any(|(unit, values)| unit.fault.is_none() && values.impossible.iter().any(|(at, _)| *at == index));
    let mut limits = Vec::new();
    for limit in quantity.limits.iter().filter(|limit| applies(limit, facts) == Ok(true)) {
        for part in parts(plan, quantity, limit, &members) {
            limits.extend(of_part(plan, facts, quantity, limit, &part, units));
        }
    }
    PooledQuantity {
        id: quantity.id.clone(),
        title: quantity.title.clone(),
        symbol: quantity.symbol.clone(),
        unit: quantity.unit.text.clone(),
        values: units.iter().zip(values).map(of_section).collect(),
        minimum_signals: quantity.minimum_signals,
        // One that cannot be had of some section is not assessable, however many pairs the others give.
        minimum_pairs: if impossible { usize::MAX } else { quantity.minimum_pairs },
        limits,
    }
}

fn of_part(plan: &Plan, facts: &Facts, quantity: &Quantity, limit: &Limit, part: &Part<'_>, units: &[Unit]) -> Option<PooledLimit> {
    let inside = units.iter().map(|unit| part.has(unit, facts)).collect::<Result<Vec<_>, _>>().ok()?;
    let shown = |known: &Known<'_>, part: &Part<'_>| {
        Bounds { quantity, part, facts, known }.of(limit, 0).ok().map(|bound| quantity.unit.from_si(bound))
    };
    let bounds = if limit.statistic == Statistic::Each {
        let own = |unit: &Unit| match unit.fault {
            Some(_) => Some(f64::NAN),
            None => shown(&unit.known(facts), &Part::of_section(plan, unit)),
        };
        units.iter().map(own).collect::<Option<Vec<_>>>()?
    } else {
        vec![shown(&Known::vehicle(facts), part)?]
    };
    Some(PooledLimit {
        statistic: limit.statistic,
        ddof: limit.ddof,
        at_least: limit.at_least,
        title: limit.statistic.title(limit.ddof),
        scope: part.in_words(),
        inside,
        bounds,
    })
}
