//! Everything a verdict depends on, for studies of the selection of sections: the values of every
//! section and every limit with its bound, in the unit of the quantity.

use std::{
    collections::{BTreeSet, HashMap, HashSet},
    sync::Arc,
};

use super::limits::{Judging, applying};
use crate::catalog::Statistic;
use crate::check::plan;
use crate::metrics::moments::{Moment, Moments};
use crate::result::{Direction, Scope};
use crate::run::{
    estimate::{Group, Member, RowGroup, Rows, used},
    prelude::*,
    sections::{Facts, Known, Unit, Vehicle},
    values::{Row, SectionValues},
};

pub use crate::check::plan::Rule;

#[derive(Clone, Debug)]
pub struct Pool {
    pub sections: Vec<Section>,
    /// Zones with the number of sections that each needs; empty where the protocol has no zones.
    pub zones: Vec<Zone>,
    /// Number of usable sections needed in total.
    pub minimum: usize,
    pub quantities: Vec<PooledQuantity>,
    /// The rule of the overall verdict; `None` where other verdicts or a person decide it.
    pub rule: Option<Rule>,
}

#[derive(Clone, Debug)]
pub struct Section {
    pub name: String,
    pub zone: Option<String>,
    /// Index of the first section of its site; repeats have the same.
    pub site: usize,
    pub used: bool,
    pub reason: Option<Reason>,
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
    /// For every section, the signals recorded with their differences; empty for a section not
    /// used.
    pub values: Vec<Vec<(usize, f64)>>,
    pub minimum_signals: usize,
    pub minimum_pairs: usize,
    pub minimum_of_groups: Vec<PooledMinimum>,
    pub limits: Vec<PooledLimit>,
}

/// How many pairs a group needs, and how many each section has of it.
#[derive(Clone, Debug)]
pub struct PooledMinimum {
    pub needed: usize,
    pub pairs: Vec<usize>,
}

/// The estimate of a limit.
#[derive(Clone, Debug)]
pub enum Pooled {
    /// A statistic with divisor n - `ddof`.
    Statistic(Statistic, usize),
    Estimate(Estimator),
}

/// A row with its section and the index of the section.
type Numbered = (usize, Unit, Row);

/// An estimate of a group of rows and its limit, for any selection of sections.
#[derive(Clone)]
pub struct Estimator {
    rules: Arc<(Plan, Facts)>,
    quantity: usize,
    limit: usize,
    /// The rows of the group.
    rows: Arc<Vec<Numbered>>,
    /// The rows of every quantity, where the estimate uses numbers of other quantities.
    others: Arc<Vec<Result<Vec<Numbered>, Reason>>>,
    bound: f64,
}

impl Estimator {
    /// Rows of a repeat are selected together with those of the section that it repeats.
    pub fn take_together(&mut self, first: usize, repeat: usize) {
        let moved = |(section, unit, row): &Numbered| {
            (if *section == repeat { first } else { *section }, unit.clone(), row.clone())
        };
        let all = |rows: &Vec<Numbered>| rows.iter().map(moved).collect();
        let others = self.others.iter();
        self.rows = Arc::new(all(&self.rows));
        self.others =
            Arc::new(others.map(|rows| rows.as_ref().map(all).map_err(Clone::clone)).collect());
    }

    /// Whether it needs rows of a section, given by index.
    pub fn concerns(&self, section: usize) -> bool {
        let has = |rows: &[Numbered]| rows.iter().any(|(number, ..)| *number == section);
        has(&self.rows) || self.others.iter().flatten().any(|rows| has(rows))
    }

    /// The estimate as a function of sums, where it takes only means, standard deviations and root
    /// mean squares of its rows.
    pub fn from_sums(&self, sections: usize) -> Option<FromSums<'_>> {
        let (plan, facts) = self.rules.as_ref();
        let EstimateKind::Of(of) = &plan.quantities[self.quantity].limits[self.limit].estimate.kind
        else {
            return None;
        };
        let of_sums = |taking: &Taking| match taking {
            Taking::Statistic(Statistic::Named(entry), ddof) => Moment::named(entry.name, *ddof),
            _ => None,
        };
        let taken = of.taken.iter().map(of_sums).collect::<Option<Vec<_>>>()?;
        let mut reads_vehicle = false;
        of.expr.visit(&mut |part| reads_vehicle |= matches!(part.kind, Kind::Vehicle(_)));
        let vehicles: BTreeSet<usize> = self.rows.iter().map(|(_, unit, _)| unit.vehicle).collect();
        if reads_vehicle && vehicles.len() > 1 {
            return None;
        }
        let vehicle = &facts.vehicles[vehicles.first().copied().unwrap_or(0)];
        // Sums about the common mean avoid cancellation.
        let centre = self.rows.iter().map(|(.., row)| row.value).sum::<f64>()
            / self.rows.len().max(1) as f64;
        let mut sums = vec![Moments::default(); sections];
        for (section, _, row) in self.rows.iter() {
            let x = row.value - centre;
            sums[*section] = sums[*section].plus(Moments { n: 1.0, x, xx: x * x });
        }
        Some(FromSums { vehicle, of, taken, centre, sums, bound: self.bound })
    }

    /// The estimate over the rows of some sections, given by index, divided by the limit over all
    /// sections; `None` where it is not defined.
    pub fn over(&self, sections: &[usize]) -> Option<f64> {
        let (plan, facts) = self.rules.as_ref();
        let quantity = &plan.quantities[self.quantity];
        let limit = &quantity.limits[self.limit];
        let members = among(&self.rows, quantity, sections);
        let others = self.others.iter().zip(&plan.quantities);
        let others: Vec<Result<Vec<Member<'_>>, Reason>> = others
            .map(|(rows, quantity)| {
                rows.as_ref().map(|rows| among(rows, quantity, sections)).map_err(Clone::clone)
            })
            .collect();
        let table: Vec<Result<&[Member<'_>], Reason>> =
            others.iter().map(|rows| rows.as_deref().map_err(Clone::clone)).collect();
        let EstimateKind::Of(of) = &limit.estimate.kind else { return None };
        let quantity = Some(quantity);
        let group = Group { plan, facts, quantity, members: &members, table: &table };
        group.number(of).ok().map(|value| value / self.bound).filter(|value| value.is_finite())
    }
}

/// An estimate of which a selection of sections needs no more than the sums of its values.
#[derive(Debug)]
pub struct FromSums<'a> {
    vehicle: &'a Vehicle,
    of: &'a OfGroup,
    taken: Vec<Moment>,
    centre: f64,
    /// Of each section, about the centre.
    pub sums: Vec<Moments>,
    bound: f64,
}

impl FromSums<'_> {
    /// As [`Estimator::over`], for sections with these sums in all.
    pub fn over(&self, total: Moments) -> Option<f64> {
        let Moments { n, x, .. } = total;
        let of = |moment: &Moment| match moment {
            Moment::Deviation { ddof } if n <= *ddof => Err(Reason::NoValue),
            _ if n < 1.0 => Err(Reason::NoValue),
            Moment::Mean => Ok(self.centre + x / n),
            Moment::Deviation { ddof } => Ok((total.squares() / (n - ddof)).sqrt()),
            Moment::RootMeanSquare => {
                Ok((total.squares() / n + (self.centre + x / n).powi(2)).sqrt())
            }
        };
        let taken: Vec<Result<f64, Reason>> = self.taken.iter().map(of).collect();
        let value =
            number(&self.of.expr, &Known { inputs: &taken, ..Known::vehicle(self.vehicle) });
        value.ok().map(|value| value / self.bound).filter(|value| value.is_finite())
    }
}

/// The rows of some sections, given by index.
fn among<'a>(rows: &'a [Numbered], quantity: &'a Quantity, sections: &[usize]) -> Vec<Member<'a>> {
    let inside = rows.iter().filter(|(section, ..)| sections.contains(section));
    inside
        .map(|(_, unit, row)| Member { unit, signal: &quantity.positions[row.position].name, row })
        .collect()
}

impl std::fmt::Debug for Estimator {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Estimator")
            .field("quantity", &self.quantity)
            .field("limit", &self.limit)
            .field("rows", &self.rows.len())
            .finish()
    }
}

/// A limit that applies to this vehicle, for one of its groups.
#[derive(Clone, Debug)]
pub struct PooledLimit {
    pub estimate: Pooled,
    pub direction: Direction,
    /// One of two edges of a limit.
    pub edge: bool,
    /// As printed: `standard deviation (n-1)`.
    pub title: String,
    pub scope: Scope,
    pub inside: Vec<bool>,
    /// For each position of the quantity, whether the limit applies to its values; all where it
    /// states none.
    pub positions: Vec<bool>,
    pub bounds: Bounds,
}

/// What values are compared with, in the unit of the limit.
#[derive(Clone, Debug)]
pub enum Bounds {
    Common(f64),
    /// Every value has its own limit: of each section in the order of its values.
    Own(Vec<Vec<f64>>),
}

/// What a pool is made of.
struct Making<'a> {
    rules: Arc<(Plan, Facts)>,
    units: &'a [Unit],
    values: &'a [SectionValues],
    /// The number of each section by its name: an archive has thousands of them.
    numbers: HashMap<&'a str, usize>,
}

/// Limits whose bound has no value are left out; the run itself reports their quantity as not
/// assessable.
pub fn pool(plan: &Plan, facts: &Facts, units: &[Unit], values: &[SectionValues]) -> Pool {
    let (rule, about) = match &plan.overall().decision {
        Decision::Limits { rule, quantities, draws: None } => (Some(*rule), quantities.as_slice()),
        _ => (None, &[][..]),
    };
    let used = used(units, values);
    let rows = Rows::of_all(plan, facts, &used);
    let table: Vec<_> = rows.iter().map(Rows::usable).collect();
    // Of sections of the same name the first.
    let numbered = units.iter().enumerate().rev();
    let making = Making {
        rules: Arc::new((plan.clone(), facts.clone())),
        units,
        values,
        numbers: numbered.map(|(number, unit)| (unit.name.as_str(), number)).collect(),
    };
    let rows_reason = |index: usize| rows[index].reason.as_ref();
    let of_quantity = |&index: &usize| {
        let (quantity, members) = (&plan.quantities[index], &rows[index].members);
        let rows = Group { plan, facts, quantity: Some(quantity), members, table: &table };
        let absent = rows_reason(index).is_some_and(Reason::is_of_optional);
        making.quantity(index, &Judging { quantity, rows, too_few: &[] }, absent)
    };
    let section = |unit: &Unit| Section {
        name: unit.name.clone(),
        zone: unit.zone.clone(),
        site: unit.site,
        used: unit.fault.is_none(),
        reason: unit.fault.clone(),
    };
    let zone = |zone: &plan::Zone| Zone {
        name: zone.name.clone(),
        title: zone.title.clone(),
        needed: zone.minimum_sections,
    };
    Pool {
        sections: units.iter().map(section).collect(),
        zones: plan.zones.iter().map(zone).collect(),
        minimum: plan.sections.minimum,
        quantities: about.iter().map(of_quantity).collect(),
        rule,
    }
}

impl Making<'_> {
    fn number(&self, member: &Member<'_>) -> Option<usize> {
        self.numbers.get(member.unit.name.as_str()).copied()
    }

    /// One that is not assessed has no limits.
    fn quantity(&self, index: usize, judging: &Judging<'_>, absent: bool) -> PooledQuantity {
        let quantity = judging.quantity;
        let of_section = |(unit, values): (&Unit, &SectionValues)| {
            let rows = values.rows.get(index).filter(|_| unit.fault.is_none());
            rows.into_iter()
                .flatten()
                .map(|row| (row.position, quantity.unit.from_si(row.value)))
                .collect::<Vec<_>>()
        };
        let sections = || self.units.iter().zip(self.values);
        let impossible = sections().any(|(unit, values)| {
            let mut own = values.impossible.iter().filter(|(at, _)| *at == index);
            unit.fault.is_none() && own.any(|(_, reason)| !reason.is_of_optional())
        });
        let mut limits = Vec::new();
        for (at, limit) in quantity.limits.iter().enumerate().filter(|_| !absent) {
            for part in judging.rows.parts(&limit.scope) {
                limits.extend(self.limit((index, at), judging, &part));
            }
        }
        let minima = quantity.minimum_of_groups.iter();
        PooledQuantity {
            id: quantity.id.clone(),
            title: quantity.title.clone(),
            symbol: quantity.symbol.clone(),
            unit: quantity.unit.text.clone(),
            values: sections().map(of_section).collect(),
            minimum_signals: quantity.minimum_signals,
            // A quantity that cannot be evaluated in some section is not assessable, however many
            // pairs the others give.
            minimum_pairs: if impossible { usize::MAX } else { quantity.minimum_pairs },
            minimum_of_groups: minima.flat_map(|minimum| self.minima(minimum, judging)).collect(),
            limits,
        }
    }

    /// A minimum, group by group. Where it cannot be told which rows belong to a group, no
    /// selection of sections has enough.
    fn minima(&self, minimum: &MinimumOfGroups, judging: &Judging<'_>) -> Vec<PooledMinimum> {
        let of_part = |part: RowGroup<'_>| {
            let mut signals: Vec<BTreeSet<&str>> = vec![BTreeSet::new(); self.units.len()];
            for member in part.members.unwrap_or_default() {
                if let Some(number) = self.number(&member) {
                    signals[number].insert(member.signal);
                }
            }
            let pairs = signals.iter().map(BTreeSet::len).collect();
            PooledMinimum { needed: minimum.needed, pairs }
        };
        judging.rows.parts(&minimum.scope).into_iter().map(of_part).collect()
    }

    /// The limit `at` of the quantity `index`, for one of its groups.
    fn limit(
        &self,
        (index, at): (usize, usize),
        judging: &Judging<'_>,
        part: &RowGroup<'_>,
    ) -> Option<PooledLimit> {
        let facts = judging.rows.facts;
        let limit = &judging.quantity.limits[at];
        let own = applying(limit, facts, part.members.clone().ok()?).ok()??;
        let inside: Vec<bool> = if part.by_section() || facts.vehicles.len() > 1 {
            let named: HashSet<&str> = own.iter().map(|member| member.unit.name.as_str()).collect();
            self.units.iter().map(|unit| named.contains(unit.name.as_str())).collect()
        } else {
            let inside = self.units.iter().map(|unit| part.has_section(unit, facts));
            inside.collect::<Result<_, _>>().ok()?
        };
        let shown = |bound: Result<f64, Reason>| Some(judging.unit(limit).from_si(bound.ok()?));
        let bounds = if matches!(limit.estimate.kind, EstimateKind::Each) {
            let mut bounds = vec![Vec::new(); self.units.len()];
            for member in judging.rows.members {
                let found = shown(judging.own_bound(limit, member.unit, &[*member]))?;
                bounds[self.number(member)?].push(found);
            }
            Bounds::Own(bounds)
        } else {
            // Data of sections can be used in the limit. This bound is that of all sections; an
            // estimate computes its own.
            Bounds::Common(shown(judging.common_bound(limit, part, &own))?)
        };
        let estimate = match limit.estimate.statistic() {
            Some((statistic, ddof)) => Pooled::Statistic(statistic, ddof),
            None => {
                let inside = part.members.clone().unwrap_or_default();
                let others = match limit.estimate.others().is_empty() {
                    true => Vec::new(),
                    false => judging
                        .rows
                        .table
                        .iter()
                        .map(|rows| rows.clone().map(|rows| self.numbered(rows)))
                        .collect(),
                };
                Pooled::Estimate(Estimator {
                    rules: Arc::clone(&self.rules),
                    quantity: index,
                    limit: at,
                    rows: Arc::new(self.numbered(&inside)),
                    others: Arc::new(others),
                    bound: judging.common_bound(limit, part, &inside).unwrap_or(f64::NAN),
                })
            }
        };
        Some(PooledLimit {
            estimate,
            direction: limit.direction,
            edge: limit.edge,
            title: limit.estimate.title.clone(),
            scope: part.scope(),
            inside,
            positions: part.positions(judging.quantity),
            bounds,
        })
    }

    fn numbered(&self, members: &[Member<'_>]) -> Vec<Numbered> {
        let numbered = |member: &Member<'_>| {
            Some((self.number(member)?, member.unit.clone(), member.row.clone()))
        };
        members.iter().filter_map(numbered).collect()
    }
}
