//! What selections are taken from, made up, and every selection looked at by itself.

#![allow(dead_code, reason = "each test file uses a part of it")]

use fishplate::catalog::Statistic;
use fishplate::result::study::Spread;
use fishplate::result::{Direction, Scope};
use fishplate::run::pool::{Bounds, Pooled, PooledLimit, PooledQuantity, Section, Zone};
use fishplate::study::case::Case;
use fishplate::study::halves::subsets;

pub fn named(name: &str) -> Statistic {
    Statistic::named(name).expect("a statistic")
}

pub fn limit(statistic: &str, bound: f64, ddof: usize, sections: usize) -> PooledLimit {
    // As many as a section of these pools has values at most.
    const VALUES: usize = 64;
    let bounds = match statistic {
        "each" => Bounds::Own(vec![vec![bound; VALUES]; sections]),
        _ => Bounds::Common(bound),
    };
    let statistic = named(statistic);
    PooledLimit {
        estimate: Pooled::Statistic(statistic, ddof),
        direction: Direction::Magnitude,
        edge: false,
        title: statistic.title(ddof),
        scope: Scope::default(),
        inside: vec![true; sections],
        positions: Vec::new(),
        bounds,
    }
}

pub fn sections(zones: &[usize]) -> Vec<Section> {
    let of = zones.iter().enumerate().flat_map(|(zone, count)| (0..*count).map(move |_| zone + 1));
    of.enumerate()
        .map(|(at, zone)| Section {
            name: format!("S{:02}", at + 1),
            zone: Some(zone.to_string()),
            site: at,
            used: true,
            reason: None,
        })
        .collect()
}

pub fn zones(takes: &[usize]) -> Vec<Zone> {
    takes
        .iter()
        .enumerate()
        .map(|(at, needed)| Zone {
            name: (at + 1).to_string(),
            title: String::new(),
            needed: *needed,
        })
        .collect()
}

pub fn quantity(id: &str, values: Vec<Vec<f64>>, limits: Vec<PooledLimit>) -> PooledQuantity {
    PooledQuantity {
        id: id.into(),
        title: id.into(),
        symbol: id.into(),
        unit: "kN".into(),
        values: values.into_iter().map(|values| values.into_iter().enumerate().collect()).collect(),
        minimum_signals: 1,
        minimum_pairs: 1,
        minimum_of_groups: Vec::new(),
        limits,
    }
}

/// Every selection, as lists of sections.
pub fn every(case: &Case) -> Vec<Vec<usize>> {
    case.strata.iter().fold(vec![Vec::new()], |all: Vec<Vec<usize>>, stratum| {
        let choices = subsets(&stratum.members, stratum.take);
        all.iter()
            .flat_map(|before| {
                choices.iter().map(move |choice| {
                    before.iter().copied().chain(choice.iter().map(|&at| at as usize)).collect()
                })
            })
            .collect()
    })
}

/// What sorting all values says.
pub fn sorted(mut values: Vec<f64>) -> Option<Spread> {
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    let at = |share: f64| {
        let rank = last as f64 * share;
        let low = values[rank.floor() as usize];
        low + (rank - rank.floor()) * (values[(rank.floor() as usize + 1).min(last)] - low)
    };
    let (q1, q3) = (at(0.25), at(0.75));
    let reach = 1.5 * (q3 - q1);
    let outliers =
        values.iter().filter(|value| **value < q1 - reach || **value > q3 + reach).count() as u64;
    Some(Spread {
        min: values[0],
        q1,
        median: at(0.5),
        q3,
        max: values[last],
        outliers,
        count: values.len() as f64,
        exact: true,
        within: None,
        intervals: Default::default(),
    })
}
