//! Values and limits of a campaign for a study, by stratum, section and quantity.

use crate::catalog::Statistic;
use crate::metrics::{
    moments::Moment,
    percentile::{Method, percentile},
};
use crate::result::{Direction, Reason, Scope, StatisticName, UnusedSection};
use crate::run::pool::{
    Bounds, Estimator, Pool, Pooled, PooledLimit, PooledMinimum, PooledQuantity, Rule,
};

/// Tolerance for rounding where a value equals its limit, which counts as met. Relative to the
/// limit.
const EQUAL: f64 = 1e-12;
/// Sections that are not used and named where too few are left.
const NAMED: usize = 3;

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
    pub not_used: Vec<(String, Reason)>,
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
    pub name: StatisticName,
    pub title: String,
    pub scope: Scope,
    pub limit: f64,
    pub direction: Direction,
    pub kind: Kind,
    evaluated: Evaluated,
    /// Factor of a value before it is compared with `low` and `high`.
    pub scale: f64,
    /// The limit is met from `low` to `high`.
    pub low: f64,
    pub high: f64,
    /// Values of each section, already divided by their own limits where each has one.
    pub values: Vec<Vec<f64>>,
}

/// What a statistic is evaluated by.
#[derive(Clone, Debug)]
enum Evaluated {
    /// From the values, with divisor n - `ddof`.
    Statistic(Statistic, usize),
    Rows(Estimator),
}

/// How a statistic of several sections follows from single sections.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Sum(Moment),
    Largest,
    Smallest,
    LargestMagnitude,
    /// Only from all values, or from all rows with the data of their sections.
    Values,
}

impl Case {
    /// Takes the pooled values of a run.
    ///
    /// `take` is the number of sections per zone if it differs from the protocol's.
    ///
    /// # Errors
    /// A zone has fewer usable sections than a selection takes, or the protocol has no criterion.
    pub fn of(pool: &Pool, take: Option<usize>) -> Result<Self, Reason> {
        let Some(rule) = pool.rule else {
            return Err(Reason::NoSelectionDecides);
        };
        if !pool.quantities.is_empty()
            && pool.quantities.iter().all(|quantity| quantity.limits.is_empty())
        {
            return Err(Reason::NothingDependsOnSections);
        }
        let mut limits = pool.quantities.iter().flat_map(|quantity| &quantity.limits);
        if matches!(rule, Rule::AtLeastLimits(_)) && limits.any(|limit| limit.edge) {
            return Err(Reason::EdgesCounted);
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
                    let reason = section.reason.clone().unwrap_or(Reason::LeftOut);
                    not_used.push((section.name.clone(), reason));
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
        let mut case = Self {
            strata,
            sections: pool.sections.iter().map(|section| section.name.clone()).collect(),
            quantities: pool.quantities.iter().map(quantity).collect(),
            rule,
        };
        case.enough(|stratum, zone, sections| Reason::TooFewToSelect {
            zone,
            sections,
            take: stratum.take,
            unused: stratum
                .not_used
                .iter()
                .take(NAMED)
                .cloned()
                .map(|(section, reason)| UnusedSection { section, reason })
                .collect(),
        })?;
        for (first, repeat) in repeats(pool) {
            case.take_together(first, repeat);
        }
        case.enough(|stratum, zone, sites| Reason::TooFewSitesToSelect {
            zone,
            sites,
            take: stratum.take,
        })?;
        Ok(case)
    }

    /// `lack` makes the reason of a zone and the number of its members.
    ///
    /// # Errors
    /// A zone has fewer sections than a selection takes.
    fn enough(&self, lack: impl Fn(&Stratum, String, usize) -> Reason) -> Result<(), Reason> {
        let short = self.strata.iter().find(|stratum| stratum.members.len() < stratum.take);
        match short {
            Some(stratum) => Err(lack(stratum, stratum.zone.clone(), stratum.members.len())),
            None => Ok(()),
        }
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
                if let Evaluated::Rows(estimator) = &mut measure.evaluated {
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
    pub fn with_sections_of(&self, other: &Self) -> Result<Self, Reason> {
        let mut case = self.clone();
        let theirs = other.usable();
        for stratum in &mut case.strata {
            stratum.members.retain(|section| theirs.contains(section));
        }
        case.enough(|stratum, zone, sections| Reason::TooFewInBoth {
            zone,
            sections,
            take: stratum.take,
        })?;
        Ok(case)
    }

    /// Number of selections; rounded beyond 2^53.
    pub fn combinations(&self) -> f64 {
        self.strata.iter().map(|stratum| choose(stratum.members.len(), stratum.take)).product()
    }

    /// Every usable section with its stratum, both by index.
    pub fn members(&self) -> impl Iterator<Item = (usize, usize)> {
        let strata = self.strata.iter().enumerate();
        strata.flat_map(|(number, stratum)| stratum.members.iter().map(move |&at| (number, at)))
    }

    /// Number of sections that each stratum has beyond those of a selection.
    pub fn spare(&self) -> Vec<usize> {
        self.strata.iter().map(|stratum| stratum.members.len() - stratum.take).collect()
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
    let (name, evaluated) = match &limit.estimate {
        Pooled::Estimate(estimator) => (limit.title.clone(), Evaluated::Rows(estimator.clone())),
        Pooled::Statistic(statistic, ddof) => {
            // Every value meets its limit if the one nearest to it does.
            let nearest = match limit.direction {
                Direction::Magnitude => "peak",
                Direction::AtMost => "maximum",
                Direction::AtLeast => "minimum",
            };
            let each = *statistic == Statistic::Each;
            let over = Statistic::named(nearest).filter(|_| each).unwrap_or(*statistic);
            (statistic.name(), Evaluated::Statistic(over, *ddof))
        }
    };
    let kind = match &evaluated {
        Evaluated::Statistic(Statistic::Named(entry), ddof) => match entry.name {
            "maximum" => Kind::Largest,
            "minimum" => Kind::Smallest,
            "peak" => Kind::LargestMagnitude,
            name => Moment::named(name, *ddof).map_or(Kind::Values, Kind::Sum),
        },
        _ => Kind::Values,
    };
    let (bound, scale) = match (&evaluated, &limit.bounds) {
        (Evaluated::Statistic(..), Bounds::Common(bound)) if *bound > 0.0 => (1.0, 1.0 / bound),
        (Evaluated::Statistic(..), Bounds::Common(bound)) => (*bound, 1.0),
        _ => (1.0, 1.0),
    };
    let room = EQUAL * bound.abs();
    let (low, high) = match limit.direction {
        Direction::Magnitude => (-bound - room, bound + room),
        Direction::AtMost => (f64::NEG_INFINITY, bound + room),
        Direction::AtLeast => (bound - room, f64::INFINITY),
    };
    let of_section = |(at, values): (usize, &Vec<(usize, f64)>)| {
        if !limit.inside[at] {
            return Vec::new();
        }
        let own = |row: usize| match &limit.bounds {
            Bounds::Own(bounds) if bounds[at][row] > 0.0 => 1.0 / bounds[at][row],
            _ => 1.0,
        };
        values
            .iter()
            .enumerate()
            .filter(|(_, (position, _))| limit.positions.get(*position).copied().unwrap_or(true))
            .map(|(row, (_, value))| value * own(row))
            .collect()
    };
    Measure {
        name: name.into(),
        title: limit.title.clone(),
        scope: limit.scope.clone(),
        limit: match limit.bounds {
            Bounds::Common(bound) => bound,
            Bounds::Own(_) => 1.0,
        },
        direction: limit.direction,
        kind,
        evaluated,
        scale,
        low,
        high,
        values: pooled.values.iter().enumerate().map(of_section).collect(),
    }
}

impl Measure {
    /// Whether the lower of two values is nearer to the limit, or farther beyond it.
    pub fn low_is_worse(&self, low: f64, high: f64) -> bool {
        match self.direction {
            Direction::Magnitude => -low > high,
            Direction::AtMost => false,
            Direction::AtLeast => true,
        }
    }

    /// The statistic over some sections divided by the limit; `None` where it is not defined.
    pub fn over(&self, sections: impl Iterator<Item = usize>) -> Option<f64> {
        let (statistic, ddof) = match &self.evaluated {
            Evaluated::Rows(rows) => return rows.over(&sections.collect::<Vec<usize>>()),
            Evaluated::Statistic(statistic, ddof) => (*statistic, *ddof),
        };
        let values: Vec<f64> = sections.flat_map(|at| self.values[at].iter().copied()).collect();
        let value = match statistic {
            Statistic::Percentile(percent) => percentile(&values, percent, Method::Linear).ok(),
            Statistic::Named(entry) => (entry.run)(&values, ddof),
            Statistic::Each => None,
        };
        value.map(|value| value * self.scale).filter(|value| value.is_finite())
    }

    /// Whether a value meets the limit.
    pub fn holds(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// The estimator of a statistic that needs the data of its sections.
    pub fn estimator(&self) -> Option<&Estimator> {
        match &self.evaluated {
            Evaluated::Rows(estimator) => Some(estimator),
            Evaluated::Statistic(..) => None,
        }
    }

    /// For a largest value, a smallest value or a largest magnitude: the sign that makes it a
    /// largest value, and that value of each section.
    pub fn extremes(&self) -> Option<(f64, Vec<Option<f64>>)> {
        let (sign, magnitude) = match self.kind {
            Kind::Largest => (1.0, false),
            Kind::Smallest => (-1.0, false),
            Kind::LargestMagnitude => (1.0, true),
            Kind::Sum(_) | Kind::Values => return None,
        };
        let of_value =
            |value: &f64| sign * self.scale * if magnitude { value.abs() } else { *value };
        let of_section = |values: &Vec<f64>| values.iter().map(of_value).reduce(f64::max);
        Some((sign, self.values.iter().map(of_section).collect()))
    }
}
