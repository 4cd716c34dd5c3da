//! Values and limits of a campaign for a study, by stratum, section and quantity.

use crate::catalog::Statistic;
use crate::result::usable_sections;
use crate::run::pool::{Estimator, Pool, Pooled, PooledLimit, PooledMinimum, PooledQuantity, Rule};

/// Tolerance for rounding where a value equals its limit, which counts as met. Relative to the
/// limit.
const EQUAL: f64 = 1e-12;

/// Sections to select from, and the criteria for a selection.
#[derive(Clone, Debug)]
pub struct Case {
    pub strata: Vec<Stratum>,
    /// Names by index.
    pub sections: Vec<String>,
    pub quantities: Vec<Quantity>,
    pub rule: Rule,
}

#[derive(Clone, Debug)]
pub struct Stratum {
    pub zone: String,
    pub title: String,
    pub take: usize,
    /// Usable sections by index.
    pub members: Vec<usize>,
    /// Other sections of the zone, with the reason.
    pub not_used: Vec<(usize, String)>,
}

#[derive(Clone, Debug)]
pub struct Quantity {
    pub id: String,
    pub title: String,
    pub symbol: String,
    pub unit: String,
    /// Differences of every section.
    pub values: Vec<Vec<f64>>,
    /// Bit set of the signals that each section has.
    pub signals: Vec<u128>,
    pub minimum_signals: usize,
    pub minimum_pairs: usize,
    pub minimum_of_groups: Vec<PooledMinimum>,
    pub measures: Vec<Measure>,
}

/// A statistic and its limit.
#[derive(Clone, Debug)]
pub struct Measure {
    pub name: String,
    pub title: String,
    pub scope: String,
    pub limit: f64,
    pub at_least: bool,
    pub kind: Kind,
    /// Of [`Kind::Estimated`].
    pub estimator: Option<Estimator>,
    /// Factor of a value before it is compared with `low` and `high`.
    pub scale: f64,
    /// The limit is met from `low` to `high`.
    pub low: f64,
    pub high: f64,
    /// Values of each section, already divided by their own limits where each has one.
    pub values: Vec<Vec<f64>>,
}

/// How a statistic of several sections follows from sums over single sections.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Mean,
    /// Divisor n - `ddof`.
    Deviation {
        ddof: usize,
    },
    RootMeanSquare,
    Largest,
    Smallest,
    LargestMagnitude,
    /// Only from all values together.
    Pooled(Statistic),
    /// Only from all rows together, with the data of their sections.
    Estimated,
}

/// Reason why a study of a campaign is not possible.
pub type Refusal = String;

impl Case {
    /// Takes the pooled values of a run.
    ///
    /// `take` is the number of sections per zone if it differs from the protocol's.
    ///
    /// # Errors
    /// A zone has fewer usable sections than a selection takes, or the protocol has no criterion.
    pub fn of(pool: &Pool, take: Option<usize>) -> Result<Self, Refusal> {
        let Some(rule) = pool.rule else {
            return Err("the overall verdict is over other verdicts or judged by a person, so no selection of sections decides it".into());
        };
        if !pool.quantities.is_empty()
            && pool.quantities.iter().all(|quantity| quantity.limits.is_empty())
        {
            return Err(
                "no acceptance criterion applies, so no verdict depends on the sections".into()
            );
        }
        let mut strata = Vec::new();
        let of_zone = |inside: &dyn Fn(Option<&str>) -> bool| {
            let all = pool
                .sections
                .iter()
                .enumerate()
                .filter(|(_, section)| inside(section.zone.as_deref()));
            let (mut members, mut not_used) = (Vec::new(), Vec::new());
            for (at, section) in all {
                if section.used {
                    members.push(at);
                } else {
                    not_used.push((at, section.reason.clone().unwrap_or_default()));
                }
            }
            (members, not_used)
        };
        for zone in pool.zones.iter().filter(|zone| zone.needed > 0) {
            let (members, not_used) = of_zone(&|of| of == Some(zone.name.as_str()));
            strata.push(Stratum {
                zone: zone.name.clone(),
                title: zone.title.clone(),
                take: take.unwrap_or(zone.needed),
                members,
                not_used,
            });
        }
        if strata.is_empty() {
            let (members, not_used) = of_zone(&|_| true);
            let wanted = take.unwrap_or(pool.minimum.max(1));
            strata.push(Stratum {
                zone: "all".into(),
                title: "All sections".into(),
                take: wanted,
                members,
                not_used,
            });
        }
        for stratum in &strata {
            if stratum.members.len() < stratum.take {
                let (has, needs) =
                    (usable_sections(stratum.members.len(), stratum.members.len()), stratum.take);
                let why: Vec<String> = stratum
                    .not_used
                    .iter()
                    .take(3)
                    .map(|(at, why)| format!("{} is not used: {why}", pool.sections[*at].name))
                    .collect();
                let why =
                    if why.is_empty() { String::new() } else { format!(" ({})", why.join("; ")) };
                return Err(format!(
                    "zone {} has {has}, and a selection takes {needs}{why}",
                    stratum.zone
                ));
            }
        }
        let mut case = Self {
            strata,
            sections: pool.sections.iter().map(|section| section.name.clone()).collect(),
            quantities: pool.quantities.iter().map(quantity).collect(),
            rule,
        };
        for (first, repeat) in repeats(pool) {
            case.take_together(first, repeat);
        }
        for stratum in &case.strata {
            if stratum.members.len() < stratum.take {
                let (zone, has, needs) = (&stratum.zone, stratum.members.len(), stratum.take);
                return Err(format!(
                    "zone {zone} has {has} usable sites, and a selection takes {needs} (a repeat is no further section)"
                ));
            }
        }
        Ok(case)
    }

    /// A repeat is taken with the section that it repeats, as one member of its zone.
    fn take_together(&mut self, first: usize, repeat: usize) {
        for stratum in &mut self.strata {
            stratum.members.retain(|section| *section != repeat);
        }
        for quantity in &mut self.quantities {
            let values = std::mem::take(&mut quantity.values[repeat]);
            quantity.values[first].extend(values);
            quantity.signals[first] |= std::mem::take(&mut quantity.signals[repeat]);
            for minimum in &mut quantity.minimum_of_groups {
                // A repeat has the signals of the section that it repeats.
                minimum.pairs[first] =
                    minimum.pairs[first].max(std::mem::take(&mut minimum.pairs[repeat]));
            }
            for measure in &mut quantity.measures {
                let values = std::mem::take(&mut measure.values[repeat]);
                measure.values[first].extend(values);
                if let Some(estimator) = &mut measure.estimator {
                    estimator.take_together(first, repeat);
                }
            }
        }
        let name = std::mem::take(&mut self.sections[repeat]);
        self.sections[first] = format!("{} with {name}", self.sections[first]);
        self.sections[repeat] = name;
    }

    /// Restricts the case to the sections of another case.
    ///
    /// # Errors
    /// A zone has fewer common sections than a selection takes.
    pub fn with_sections_of(&self, other: &Self) -> Result<Self, Refusal> {
        let mut case = self.clone();
        let theirs = other.usable();
        for stratum in &mut case.strata {
            stratum.members.retain(|section| theirs.contains(section));
            if stratum.members.len() < stratum.take {
                let (zone, has, needs) = (&stratum.zone, stratum.members.len(), stratum.take);
                return Err(format!(
                    "zone {zone} has {has} sections usable in both cases, and a selection takes {needs}"
                ));
            }
        }
        Ok(case)
    }

    /// Number of selections; rounded beyond 2^53.
    pub fn combinations(&self) -> f64 {
        self.strata.iter().map(|stratum| choose(stratum.members.len(), stratum.take)).product()
    }

    /// Every limit with its quantity.
    pub fn measures(&self) -> impl Iterator<Item = (usize, &Measure)> {
        self.quantities
            .iter()
            .enumerate()
            .flat_map(|(at, quantity)| quantity.measures.iter().map(move |measure| (at, measure)))
    }
}

/// Each used section that repeats another used one of its zone, with the first of these.
fn repeats(pool: &Pool) -> Vec<(usize, usize)> {
    let alike = |a: usize, b: usize| {
        let (a, b) = (&pool.sections[a], &pool.sections[b]);
        a.used && b.used && a.site == b.site && a.zone == b.zone
    };
    (0..pool.sections.len())
        .filter_map(|at| Some(((0..at).find(|&first| alike(first, at))?, at)))
        .collect()
}

/// Binomial coefficient.
pub fn choose(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |product, at| (product * (n - at) as f64 / (at + 1) as f64).round())
}

fn quantity(pooled: &PooledQuantity) -> Quantity {
    Quantity {
        id: pooled.id.clone(),
        title: pooled.title.clone(),
        symbol: pooled.symbol.clone(),
        unit: pooled.unit.clone(),
        values: pooled
            .values
            .iter()
            .map(|values| values.iter().map(|(_, value)| *value).collect())
            .collect(),
        signals: pooled
            .values
            .iter()
            .map(|values| values.iter().fold(0, |all, (signal, _)| all | 1 << (signal % 128)))
            .collect(),
        minimum_signals: pooled.minimum_signals,
        minimum_pairs: pooled.minimum_pairs,
        minimum_of_groups: pooled.minimum_of_groups.clone(),
        measures: pooled.limits.iter().map(|limit| measure(pooled, limit)).collect(),
    }
}

fn measure(pooled: &PooledQuantity, limit: &PooledLimit) -> Measure {
    let (statistic, ddof) = match &limit.estimate {
        Pooled::Statistic(statistic, ddof) => (Some(*statistic), *ddof),
        Pooled::Estimate(_) => (None, 0),
    };
    let each = statistic == Some(Statistic::Each);
    let kind = statistic.map_or(Kind::Estimated, |statistic| match statistic {
        Statistic::Each if limit.at_least => Kind::Smallest,
        Statistic::Each => Kind::LargestMagnitude,
        Statistic::Percentile(_) => Kind::Pooled(statistic),
        Statistic::Named(entry) => match entry.name {
            "mean" => Kind::Mean,
            "std" => Kind::Deviation { ddof },
            "rms" => Kind::RootMeanSquare,
            "maximum" => Kind::Largest,
            "minimum" => Kind::Smallest,
            "peak" => Kind::LargestMagnitude,
            _ => Kind::Pooled(statistic),
        },
    });
    let (bound, scale) = if each || kind == Kind::Estimated {
        (1.0, 1.0)
    } else {
        let bound = limit.bounds[0];
        if bound > 0.0 { (1.0, 1.0 / bound) } else { (bound, 1.0) }
    };
    let room = EQUAL * bound.abs();
    let (low, high) =
        if limit.at_least { (bound - room, f64::INFINITY) } else { (-bound - room, bound + room) };
    let of_section = |(at, values): (usize, &Vec<(usize, f64)>)| {
        if !limit.inside[at] {
            return Vec::new();
        }
        let own = if each && limit.bounds[at] > 0.0 { 1.0 / limit.bounds[at] } else { 1.0 };
        values
            .iter()
            .filter(|(position, _)| limit.positions.get(*position).copied().unwrap_or(true))
            .map(|(_, value)| value * own)
            .collect()
    };
    Measure {
        name: statistic.map_or_else(|| limit.title.clone(), Statistic::name),
        estimator: match &limit.estimate {
            Pooled::Estimate(estimator) => Some(estimator.clone()),
            Pooled::Statistic(..) => None,
        },
        title: limit.title.clone(),
        scope: limit.scope.clone(),
        limit: if each { 1.0 } else { limit.bounds[0] },
        at_least: limit.at_least,
        kind,
        scale,
        low,
        high,
        values: pooled.values.iter().enumerate().map(of_section).collect(),
    }
}

impl Measure {
    /// The statistic over some sections divided by the limit; `None` where it is not defined.
    pub fn over(&self, sections: impl Iterator<Item = usize>) -> Option<f64> {
        if let Some(estimator) = &self.estimator {
            return estimator.over(&sections.collect::<Vec<usize>>());
        }
        let values: Vec<f64> = sections.flat_map(|at| self.values[at].iter().copied()).collect();
        let named = |name: &str, ddof: usize| match Statistic::named(name) {
            Some(Statistic::Named(entry)) => (entry.run)(&values, ddof),
            _ => None,
        };
        let value = match self.kind {
            Kind::Mean => named("mean", 0),
            Kind::Deviation { ddof } => named("std", ddof),
            Kind::RootMeanSquare => named("rms", 0),
            Kind::Largest => named("maximum", 0),
            Kind::Smallest => named("minimum", 0),
            Kind::LargestMagnitude => named("peak", 0),
            Kind::Pooled(Statistic::Percentile(percent)) => crate::metrics::percentile::percentile(
                &values,
                percent,
                crate::metrics::percentile::Method::Linear,
            )
            .ok(),
            Kind::Pooled(Statistic::Named(entry)) => (entry.run)(&values, 0),
            Kind::Pooled(Statistic::Each) | Kind::Estimated => None,
        };
        value.map(|value| value * self.scale).filter(|value| value.is_finite())
    }

    pub fn holds(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}
