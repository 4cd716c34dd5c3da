//! What all selections, or random ones, say together: shares, spreads, worst selections, and the
//! influence of each section.

use super::case::Case;
use crate::result::{
    Direction, Reason, StatisticName,
    study::{Importance, QuantitySpread, Share, Spread, StatisticSpread, WorstSelection},
};

/// Results of many selections.
#[derive(Debug)]
pub struct Counted {
    pub share: Share,
    pub quantities: Vec<QuantitySpread>,
    pub sections: Vec<Importance>,
    pub worst: Vec<WorstSelection>,
    pub methods: Vec<String>,
}

/// What selections say of one limit.
#[derive(Debug)]
pub struct LimitCount {
    pub spread: Option<Spread>,
    /// Number of selections that do not meet it.
    pub failing: u64,
    /// The sections of the worst selection in order, and its value, if it does not meet the limit.
    pub worst: Option<(Vec<usize>, f64)>,
}

/// Numbers of selections by quantity and by section.
#[derive(Debug)]
pub struct Numbers {
    /// For each quantity, selections that do not meet one of its limits, and those in which it
    /// alone fails.
    pub quantities: Vec<(u64, u64)>,
    /// For each section, selections with it, and validated ones of these.
    pub sections: Vec<(u64, u64)>,
}

impl Counted {
    /// Names what was counted; `limits` are in the order of the case.
    pub fn new(
        case: &Case,
        share: Share,
        limits: Vec<LimitCount>,
        numbers: &Numbers,
        methods: Vec<String>,
    ) -> Self {
        let share_of = |count: u64| count as f64 / share.looked_at as f64;
        let usable = case.usable();
        let name = |&at: &usize| case.sections[at].clone();
        let (mut worst, mut quantities) = (Vec::new(), Vec::new());
        let mut limits = limits.into_iter();
        for (quantity, (failing, alone)) in case.quantities.iter().zip(&numbers.quantities) {
            let mut statistics = Vec::new();
            for (measure, found) in quantity.measures.iter().zip(limits.by_ref()) {
                statistics.push(StatisticSpread {
                    name: measure.name.clone(),
                    title: measure.title.clone(),
                    scope: measure.scope.clone(),
                    limit: measure.limit,
                    at_least: measure.direction == Direction::AtLeast,
                    overall: measure.over(usable.iter().copied()),
                    failing: share_of(found.failing),
                    reason: found.spread.is_none().then_some(Reason::UndefinedInAnySelection),
                    spread: found.spread,
                });
                worst.extend(found.worst.map(|(sections, normalised)| WorstSelection {
                    quantity: quantity.id.clone(),
                    symbol: quantity.symbol.clone(),
                    title: measure.title.clone(),
                    scope: measure.scope.clone(),
                    normalised,
                    sections: sections.iter().map(name).collect(),
                }));
            }
            let of = |name: &StatisticName| {
                let all = |one: &&StatisticSpread| one.name == *name && one.scope.is_all();
                statistics.iter().find(all).and_then(|one| one.spread)
            };
            quantities.push(QuantitySpread {
                mean: of(&StatisticName::Mean),
                std: of(&StatisticName::StandardDeviation),
                id: quantity.id.clone(),
                title: quantity.title.clone(),
                symbol: quantity.symbol.clone(),
                unit: quantity.unit.clone(),
                failing: share_of(*failing),
                alone: Some(share_of(*alone)),
                statistics,
            });
        }
        let of_section = |(stratum, at): (usize, usize)| {
            let (with, good) = numbers.sections[at];
            let part = |all: u64, good: u64| (all > 0).then(|| good as f64 / all as f64);
            Importance {
                section: name(&at),
                zone: case.strata[stratum].zone.clone(),
                with: part(with, good),
                without: part(share.looked_at - with, share.validated - good),
            }
        };
        let sections = case.members().map(of_section).collect();
        Self { share, quantities, sections, worst, methods }
    }
}
