//! Everything a verdict depends on, for studies of the selection of sections: the values of every
//! section and every limit with its bound, in the unit of the quantity.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::sync::Arc;

use super::limits::{Judging, applying};
use crate::catalog::Statistic;
use crate::check::evaluate::number;
use crate::check::plan::{
    Decision, EstimateKind, Kind, Limit, MinimumOfGroups, OfGroup, Plan, Quantity, Taking,
};
use crate::metrics::moments::{Moment, Moments};
use crate::result::{Reason, Scope};
use crate::run::estimate::{Group, Grouped, Member, Part, Rows, Table, Used, members, parts};
use crate::run::sections::{Facts, Known, Unit, Vehicle};
use crate::run::values::{Row, SectionValues};

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
    fn new(
        rules: &Arc<(Plan, Facts)>,
        judging: &Judging<'_>,
        limit: &Limit,
        part: &Part<'_>,
        units: &Units<'_>,
    ) -> Self {
        let Judging { plan, facts, quantity, members, table, .. } = *judging;
        let inside = part.members(facts, members).unwrap_or_default();
        let numbered = |member: &Member<'_>| {
            Some((units.number(member.unit)?, member.unit.clone(), member.row.clone()))
        };
        let rows = inside.iter().filter_map(numbered).collect();
        let others = match limit.estimate.others().is_empty() {
            true => Vec::new(),
            false => table
                .iter()
                .map(|rows| rows.clone().map(|rows| rows.iter().filter_map(numbered).collect()))
                .collect(),
        };
        let bound = judging.common_bound(limit, part, &inside).unwrap_or(f64::NAN);
        Self {
            rules: Arc::clone(rules),
            quantity: plan
                .quantities
                .iter()
                .position(|known| known.id == quantity.id)
                .unwrap_or_default(),
            limit: quantity
                .limits
                .iter()
                .position(|known| known.span == limit.span && known.scope.same(&limit.scope))
                .unwrap_or_default(),
            rows: Arc::new(rows),
            others: Arc::new(others),
            bound,
        }
    }

    /// Rows of a repeat are selected together with those of the section that it repeats.
    pub fn take_together(&mut self, first: usize, repeat: usize) {
        let moved = |(section, unit, row): &Numbered| {
            (if *section == repeat { first } else { *section }, unit.clone(), row.clone())
        };
        let all = |rows: &Vec<Numbered>| rows.iter().map(moved).collect();
        self.rows = Arc::new(all(&self.rows));
        self.others = Arc::new(
            self.others.iter().map(|rows| rows.as_ref().map(all).map_err(Clone::clone)).collect(),
        );
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
        let others: Vec<Result<Vec<Member<'_>>, Reason>> = self
            .others
            .iter()
            .zip(&plan.quantities)
            .map(|(rows, quantity)| {
                rows.as_ref().map(|rows| among(rows, quantity, sections)).map_err(Clone::clone)
            })
            .collect();
        let table: Vec<Result<&[Member<'_>], Reason>> = others
            .iter()
            .map(|rows| rows.as_ref().map(Vec::as_slice).map_err(Clone::clone))
            .collect();
        let EstimateKind::Of(of) = &limit.estimate.kind else { return None };
        let group =
            Group { plan, facts, positions: &quantity.positions, members: &members, table: &table };
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
    pub at_least: bool,
    /// As printed: `standard deviation (n-1)`.
    pub title: String,
    pub scope: Scope,
    pub inside: Vec<bool>,
    /// For each position of the quantity, whether the limit applies to its values; all where it
    /// states none.
    pub positions: Vec<bool>,
    /// One bound for each section where every value has its own limit, else one.
    pub bounds: Vec<f64>,
}

/// All sections, and the number of each by its name: an archive has thousands of them.
struct Units<'a> {
    all: &'a [Unit],
    numbers: HashMap<&'a str, usize>,
}

impl<'a> Units<'a> {
    fn of(all: &'a [Unit]) -> Self {
        Self {
            all,
            numbers: all
                .iter()
                .enumerate()
                .rev()
                .map(|(number, unit)| (unit.name.as_str(), number))
                .collect(),
        }
    }

    fn number(&self, unit: &Unit) -> Option<usize> {
        self.numbers.get(unit.name.as_str()).copied()
    }
}

/// Limits whose bound has no value are left out; the run itself reports their quantity as not
/// assessable.
pub fn pool(plan: &Plan, facts: &Facts, units: &[Unit], values: &[SectionValues]) -> Pool {
    let (rule, about) = match &plan.overall().decision {
        Decision::Limits { rule, quantities } => (Some(*rule), quantities.as_slice()),
        Decision::Verdicts(_) | Decision::Person(_) => (None, &[][..]),
    };
    let rules = Arc::new((plan.clone(), facts.clone()));
    let used: Vec<(&Unit, &SectionValues)> =
        units.iter().zip(values).filter(|(unit, _)| unit.fault.is_none()).collect();
    let rows = Rows::of_all(plan, facts, &used);
    let table: Vec<_> = rows.iter().map(Rows::usable).collect();
    let all = Units::of(units);
    Pool {
        sections: units
            .iter()
            .map(|unit| Section {
                name: unit.name.clone(),
                zone: unit.zone.clone(),
                site: unit.site,
                used: unit.fault.is_none(),
                reason: unit.fault.clone(),
            })
            .collect(),
        zones: plan
            .zones
            .iter()
            .map(|zone| Zone {
                name: zone.name.clone(),
                title: zone.title.clone(),
                needed: zone.minimum_sections,
            })
            .collect(),
        minimum: plan.sections.minimum,
        quantities: about
            .iter()
            .map(|&index| pooled(&rules, index, (&all, values, used.as_slice()), &table))
            .collect(),
        rule,
    }
}

fn pooled(
    rules: &Arc<(Plan, Facts)>,
    index: usize,
    (units, values, used): (&Units<'_>, &[SectionValues], &Used<'_>),
    table: &Table<'_>,
) -> PooledQuantity {
    let (plan, facts) = rules.as_ref();
    let quantity = &plan.quantities[index];
    let members = members(quantity, index, used);
    let of_section = |(unit, values): (&Unit, &SectionValues)| {
        let rows = values.rows.get(index).filter(|_| unit.fault.is_none()).into_iter().flatten();
        rows.map(|row| (row.position, quantity.unit.from_si(row.value))).collect::<Vec<_>>()
    };
    let impossible =
        used.iter().any(|(_, values)| values.impossible.iter().any(|(at, _)| *at == index));
    let judging = Judging { plan, facts, quantity, members: &members, table, too_few: &[] };
    let mut limits = Vec::new();
    for limit in &quantity.limits {
        for part in parts(plan, Grouped::values(quantity), &limit.scope, &members, facts) {
            limits.extend(of_part(rules, &judging, limit, &part, units));
        }
    }
    PooledQuantity {
        id: quantity.id.clone(),
        title: quantity.title.clone(),
        symbol: quantity.symbol.clone(),
        unit: quantity.unit.text.clone(),
        values: units.all.iter().zip(values).map(of_section).collect(),
        minimum_signals: quantity.minimum_signals,
        // A quantity that cannot be evaluated in some section is not assessable, however many pairs
        // the others give.
        minimum_pairs: if impossible { usize::MAX } else { quantity.minimum_pairs },
        minimum_of_groups: quantity
            .minimum_of_groups
            .iter()
            .flat_map(|minimum| minima(minimum, &judging, units))
            .collect(),
        limits,
    }
}

/// A minimum, group by group. Where it cannot be told which rows belong to a group, no selection of
/// sections has enough.
fn minima(
    minimum: &MinimumOfGroups,
    judging: &Judging<'_>,
    units: &Units<'_>,
) -> Vec<PooledMinimum> {
    let Judging { plan, facts, quantity, members, .. } = *judging;
    let of_part = |part: &Part<'_>| {
        let mut signals: Vec<BTreeSet<&str>> = vec![BTreeSet::new(); units.all.len()];
        for member in part.members(facts, members).unwrap_or_default() {
            if let Some(number) = units.number(member.unit) {
                signals[number].insert(member.signal);
            }
        }
        PooledMinimum { needed: minimum.needed, pairs: signals.iter().map(BTreeSet::len).collect() }
    };
    parts(plan, Grouped::values(quantity), &minimum.scope, members, facts)
        .iter()
        .map(of_part)
        .collect()
}

fn of_part(
    rules: &Arc<(Plan, Facts)>,
    judging: &Judging<'_>,
    limit: &Limit,
    part: &Part<'_>,
    units: &Units<'_>,
) -> Option<PooledLimit> {
    let Judging { plan, facts, quantity, members, .. } = *judging;
    let own = applying(limit, facts, part.members(facts, members).ok()?).ok()??;
    let inside = if part.by_section() || facts.vehicles.len() > 1 {
        let named: HashSet<&str> = own.iter().map(|member| member.unit.name.as_str()).collect();
        units.all.iter().map(|unit| named.contains(unit.name.as_str())).collect()
    } else {
        units
            .all
            .iter()
            .map(|unit| part.has_section(unit, facts))
            .collect::<Result<Vec<_>, _>>()
            .ok()?
    };
    let positions = part.positions(quantity);
    let shown =
        |bound: Result<f64, Reason>| bound.ok().map(|bound| judging.unit(limit).from_si(bound));
    let bounds = if matches!(limit.estimate.kind, EstimateKind::Each) {
        let own = |unit: &Unit| match unit.fault {
            Some(_) => Some(f64::NAN),
            None => shown(judging.bound(
                limit,
                &Part::of_section(plan, limit, unit),
                &[],
                &unit.known(facts),
            )),
        };
        units.all.iter().map(own).collect::<Option<Vec<_>>>()?
    } else {
        // Data of sections can be used in the limit. This bound is that of all sections; an
        // estimate computes its own.
        vec![shown(judging.common_bound(limit, part, &own))?]
    };
    let estimate = match limit.estimate.statistic() {
        Some((statistic, ddof)) => Pooled::Statistic(statistic, ddof),
        None => Pooled::Estimate(Estimator::new(rules, judging, limit, part, units)),
    };
    Some(PooledLimit {
        estimate,
        at_least: limit.at_least,
        title: limit.estimate.title.clone(),
        scope: part.scope(),
        inside,
        positions,
        bounds,
    })
}
