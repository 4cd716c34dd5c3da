//! Several protocols over one campaign, with every record read and filtered once; and what each
//! protocol makes of disturbed records.

use rayon::prelude::*;

use super::section;
use crate::check::plan::{EstimateKind, Plan};
use crate::data::Campaign;
use crate::graph::{self, Graph};
use crate::problem::Problems;
use crate::run::estimate::{Grouped, Part, parts};
use crate::run::limit::{Judging, applying};
use crate::run::record;
use crate::run::record::{Columns, Counts, Keys, Numbers, Sharing, Store, Trial};
use crate::run::sections::{Known, Unit, Vehicle};
use crate::run::values::{SectionValues, Shifts};
use crate::run::verdict::{Rows, members, rows, without_unused_originals};
use crate::run::{Evaluated, Prepared, Progress};

/// A protocol to evaluate with others.
#[derive(Clone, Copy, Debug)]
pub struct Rules<'a> {
    pub plan: &'a Plan,
    pub graph: &'a Graph,
    /// Whether it is evaluated on trials too.
    pub tried: bool,
}

/// What several protocols made of one campaign.
#[derive(Debug)]
pub struct Several {
    /// One for each protocol; where the campaign does not meet its needs, why.
    pub as_recorded: Vec<Result<Evaluated, Problems>>,
    /// For each trial, one for each protocol that is tried and whose needs are met.
    pub trials: Vec<Vec<Option<Evaluated>>>,
    /// Of the records as they are.
    pub counts: Counts,
}

/// The rules of a protocol that make numbers: what is asked of data has been asked of the records
/// as they were.
struct Bare {
    plan: Plan,
    graph: Graph,
}

impl Bare {
    fn of(plan: &Plan) -> Self {
        let mut plan = plan.clone();
        plan.plausibility.clear();
        plan.checks.clear();
        let graph = graph::from_plan(&plan);
        Self { plan, graph }
    }
}

/// Values of one section: by protocol, and by trial and protocol.
type OfSection = (Vec<Option<SectionValues>>, Vec<Vec<Option<SectionValues>>>, Counts);

/// Evaluates every section of a campaign by several protocols, as recorded and in trials.
pub fn several(
    rules: &[Rules<'_>],
    campaign: &Campaign,
    trials: &[Trial],
    progress: Progress<'_>,
) -> Several {
    let bare: Vec<Option<Bare>> = rules
        .iter()
        .map(|rules| (rules.tried && !trials.is_empty()).then(|| Bare::of(rules.plan)))
        .collect();
    let prepared: Vec<Result<Prepared<'_>, Problems>> = rules
        .par_iter()
        .map(|rules| Prepared::new(rules.plan, rules.graph, campaign.into()))
        .collect();
    let tried: Vec<Option<Prepared<'_>>> = bare
        .par_iter()
        .zip(&prepared)
        .map(|(bare, prepared)| {
            prepared.as_ref().ok()?;
            bare.as_ref()
                .and_then(|bare| Prepared::new(&bare.plan, &bare.graph, campaign.into()).ok())
        })
        .collect();
    let mut columns = Columns::default();
    for prepared in prepared.iter().flatten() {
        let Prepared { plan, graph, .. } = prepared;
        columns.add(&plan.axis.column, plan.time.as_ref().map(|time| time.column.as_str()), graph);
    }
    let together =
        Together { campaign, prepared: &prepared, tried: &tried, trials, columns: &columns };
    let of_sections: Vec<OfSection> = (0..campaign.names.len())
        .into_par_iter()
        .with_max_len(1)
        .map(|at| {
            let values = together.section(at, progress);
            progress(&campaign.names[at].value);
            values
        })
        .collect();
    collected(prepared, &tried, trials.len(), of_sections)
}

struct Together<'a> {
    campaign: &'a Campaign,
    prepared: &'a [Result<Prepared<'a>, Problems>],
    tried: &'a [Option<Prepared<'a>>],
    trials: &'a [Trial],
    columns: &'a Columns,
}

impl Together<'_> {
    fn section(&self, at: usize, progress: Progress<'_>) -> OfSection {
        let cell = &self.campaign.names[at];
        let place = self.prepared.iter().flatten().find_map(|prepared| {
            let extent = prepared.basis.units.get(at).and_then(|unit| unit.extent)?;
            let unit = &prepared.basis.units[at];
            let part = unit
                .stretch
                .map(|stretch| stretch.part(prepared.plan))
                .or_else(|| record::part(prepared.plan, unit));
            Some((prepared.plan.axis.column.clone(), extent, part))
        });
        let store = Store::new(self.campaign, cell, self.columns, place);
        let mut numbers = Numbers::default();
        let mut keys =
            |prepared: &Prepared<'_>| numbers.keys(&prepared.work(), &prepared.basis.units[at]);
        let as_recorded: Vec<Option<Keys>> =
            self.prepared.iter().map(|prepared| prepared.as_ref().ok().map(&mut keys)).collect();
        let bare: Vec<Option<Keys>> =
            self.tried.iter().map(|prepared| prepared.as_ref().map(&mut keys)).collect();
        let one = |store: &Store<'_>,
                   prepared: Option<&Prepared<'_>>,
                   (of, keys): (usize, &Option<Keys>)| {
            let (prepared, keys) = prepared.zip(keys.as_ref())?;
            // In a trial, a section is evaluated on the stretch on which it is as recorded.
            let soundness = &self.prepared[of].as_ref().ok()?.soundness;
            let unit = &prepared.basis.units[at];
            if unit.fault.is_some() {
                return Some(SectionValues::default());
            }
            let work = record::Work {
                shared: Some(Sharing { store, keys }),
                soundness,
                ..prepared.work()
            };
            section::of_section(&work, unit, &Shifts::NONE).pop()
        };
        let values = self
            .prepared
            .iter()
            .zip(as_recorded.iter().enumerate())
            .map(|(prepared, keys)| one(&store, prepared.as_ref().ok(), keys))
            .collect();
        let counts = store.counts();
        let in_trial = |trial: &Trial| {
            let store = store.with(*trial);
            let values = self
                .tried
                .iter()
                .zip(bare.iter().enumerate())
                .map(|(prepared, keys)| one(&store, prepared.as_ref(), keys))
                .collect();
            progress(&cell.value);
            values
        };
        (values, self.trials.iter().map(in_trial).collect(), counts)
    }
}

/// Values by section, put together by protocol.
fn collected(
    prepared: Vec<Result<Prepared<'_>, Problems>>,
    tried: &[Option<Prepared<'_>>],
    trials: usize,
    of_sections: Vec<OfSection>,
) -> Several {
    let mut by_protocol: Vec<Vec<SectionValues>> = vec![Vec::new(); prepared.len()];
    let mut by_trial: Vec<Vec<Vec<SectionValues>>> = vec![vec![Vec::new(); prepared.len()]; trials];
    let mut counts = Vec::new();
    for (values, in_trials, count) in of_sections {
        by_protocol.iter_mut().zip(values).for_each(|(all, values)| all.extend(values));
        for (all, values) in by_trial.iter_mut().zip(in_trials) {
            all.iter_mut().zip(values).for_each(|(all, values)| all.extend(values));
        }
        counts.push(count);
    }
    let as_recorded: Vec<Result<Evaluated, Problems>> = prepared
        .into_iter()
        .zip(by_protocol)
        .map(|(prepared, values)| {
            prepared.and_then(|prepared| {
                prepared.basis.evaluated(
                    prepared.plan,
                    values.into_iter().map(Some).collect(),
                    true,
                    None,
                )
            })
        })
        .collect();
    let in_trial = |(at, values): (usize, Vec<SectionValues>)| {
        let (prepared, base) = (tried[at].as_ref()?, as_recorded[at].as_ref().ok()?);
        // The sections that are used are those of the records as they are, as far as the trial
        // gives values.
        let mut units = base.units.clone();
        for (unit, values) in units.iter_mut().zip(&values) {
            if let Some(fault) = &values.fault {
                unit.refuse(fault.clone(), true);
            }
        }
        let values = without_unused_originals(prepared.plan, &units, values);
        let (findings, notes, files) = (Vec::new(), Vec::new(), Vec::new());
        let application = Vec::new();
        let reduction = base.reduction.clone();
        let facts = base.facts.clone();
        Some(Evaluated {
            facts,
            units,
            values,
            findings,
            application,
            notes,
            reduction,
            missing: None,
            files,
        })
    };
    let trials = by_trial
        .into_iter()
        .map(|values| values.into_iter().enumerate().map(in_trial).collect())
        .collect();
    Several { as_recorded, trials, counts: counts.into_iter().sum() }
}

/// A value of a section against the limit of an estimate.
#[derive(Clone, Debug)]
pub struct SectionRatio {
    /// Index into the plan's quantities.
    pub quantity: usize,
    /// Index into the limits of the quantity; `None` of a quantity without one, of which the value
    /// itself stands here.
    pub limit: Option<usize>,
    pub section: String,
    /// The largest of |value| / limit of the section's values.
    pub ratio: f64,
}

impl Evaluated {
    /// Names of the sections, and why one is not used.
    pub fn sections(&self) -> impl Iterator<Item = (&str, Option<&str>)> {
        self.units.iter().map(|unit| (unit.name.as_str(), unit.fault.as_deref()))
    }

    /// The same with some sections only; the others are not used.
    #[must_use]
    pub fn with_sections(&self, keeps: &dyn Fn(&str) -> bool) -> Self {
        let mut units = self.units.clone();
        units
            .iter_mut()
            .filter(|unit| !keeps(&unit.name))
            .for_each(|unit| unit.refuse("left out".into(), false));
        self.with(units, self.values.clone())
    }

    /// The same with the values of one quantity only.
    #[must_use]
    pub fn with_quantity(&self, quantity: usize) -> Self {
        let mut values = self.values.clone();
        for values in &mut values {
            values
                .rows
                .iter_mut()
                .enumerate()
                .filter(|(at, _)| *at != quantity)
                .for_each(|(_, rows)| rows.clear());
        }
        self.with(self.units.clone(), values)
    }

    fn with(&self, units: Vec<Unit>, values: Vec<SectionValues>) -> Self {
        let (findings, notes, files) = (self.findings.clone(), Vec::new(), Vec::new());
        let application = self.application.clone();
        let reduction = self.reduction.clone();
        let (facts, missing) = (self.facts.clone(), self.missing.clone());
        Self { facts, units, values, findings, application, notes, reduction, missing, files }
    }

    /// Each limit's ratios of single sections: what is pooled is taken against the limit of the
    /// pool.
    pub fn section_ratios(&self, plan: &Plan) -> Vec<SectionRatio> {
        let used: Vec<(&Unit, &SectionValues)> =
            self.units.iter().zip(&self.values).filter(|(unit, _)| unit.fault.is_none()).collect();
        let all: Vec<Rows<'_>> = plan
            .quantities
            .iter()
            .enumerate()
            .map(|(index, quantity)| rows(plan, quantity, index, &used, &self.facts))
            .collect();
        let table: Vec<_> = all.iter().map(Rows::usable).collect();
        let mut found = Vec::new();
        for (index, quantity) in plan.quantities.iter().enumerate() {
            let members = members(quantity, index, &used);
            if quantity.limits.is_empty() {
                for member in &members {
                    largest(
                        &mut found,
                        index,
                        None,
                        &member.unit.name,
                        quantity.unit.from_si(member.row.value).abs(),
                    );
                }
            }
            let judging = Judging {
                plan,
                facts: &self.facts,
                quantity,
                members: &members,
                table: &table,
                too_few: &[],
            };
            for (at, limit) in quantity.limits.iter().enumerate() {
                // An estimate in a unit of its own is no value of a section.
                if limit
                    .estimate
                    .unit
                    .as_ref()
                    .is_some_and(|unit| unit.dimension != quantity.unit.dimension)
                {
                    continue;
                }
                let each = matches!(limit.estimate.kind, EstimateKind::Each);
                for part in
                    parts(plan, Grouped::values(quantity), &limit.scope, &members, &self.facts)
                {
                    let inside = part
                        .members(&self.facts, &members)
                        .map(|inside| applying(limit, &self.facts, inside));
                    let Ok(Ok(Some(inside))) = inside else { continue };
                    let of_vehicle = |vehicle: &Vehicle| {
                        judging.bound(limit, &part, &inside, &Known::vehicle(vehicle))
                    };
                    let pooled = self.facts.agreed(&inside, of_vehicle, f64::to_string);
                    for member in &inside {
                        let bound = match each {
                            true => {
                                let part = Part::of_section(plan, limit, member.unit);
                                judging.bound(
                                    limit,
                                    &part,
                                    &[*member],
                                    &member.unit.known(&self.facts),
                                )
                            }
                            false => pooled.clone(),
                        };
                        if let Some(ratio) = bound
                            .ok()
                            .and_then(|bound| ratio(member.row.value, bound, limit.at_least))
                        {
                            largest(&mut found, index, Some(at), &member.unit.name, ratio);
                        }
                    }
                }
            }
        }
        found
    }
}

fn ratio(value: f64, bound: f64, at_least: bool) -> Option<f64> {
    let ratio = if at_least { bound / value } else { value.abs() / bound };
    (ratio.is_finite() && ratio >= 0.0).then_some(ratio)
}

fn largest(
    found: &mut Vec<SectionRatio>,
    quantity: usize,
    limit: Option<usize>,
    section: &str,
    ratio: f64,
) {
    // Rows of a quantity stand section by section, so its entry is among the last ones.
    let same = |one: &&mut SectionRatio| {
        one.quantity == quantity && one.limit == limit && one.section == section
    };
    match found
        .iter_mut()
        .rev()
        .take_while(|one| one.quantity == quantity && one.limit == limit)
        .find(same)
    {
        Some(one) => one.ratio = one.ratio.max(ratio),
        None => found.push(SectionRatio { quantity, limit, section: section.to_string(), ratio }),
    }
}
