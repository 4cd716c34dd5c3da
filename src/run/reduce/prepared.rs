//! What is opened and checked before any record is read.

use crate::check::plan::{Plan, Side};
use crate::data::campaign::OFFSET;
use crate::data::{Campaign, Campaigns};
use crate::graph::Graph;
use crate::problem::{Problem, Problems};
use crate::result::{Remark, SectionOffset};
use crate::run::data_rules::stop_on_fault;
use crate::run::record::{Soundness, Work};
use crate::run::sections::{Basis, Facts, Unit, columns, requirements, stretches, units, wanted};

/// Called after each record, from any thread.
pub type Progress<'a> = &'a (dyn Fn(&str) + Sync);

/// Data read before any record, for one protocol.
#[derive(Debug)]
pub struct Prepared<'a> {
    pub plan: &'a Plan,
    pub graph: &'a Graph,
    campaigns: Campaigns<'a>,
    pub basis: Basis,
    present: Vec<Vec<Vec<bool>>>,
    recorded: Vec<Vec<Vec<bool>>>,
    pub soundness: Soundness,
}

impl<'a> Prepared<'a> {
    /// # Errors
    /// The campaigns do not have what the protocol asks for; a section is faulty, and the protocol
    /// states `stop`.
    pub fn new(
        plan: &'a Plan,
        graph: &'a Graph,
        campaigns: Campaigns<'a>,
    ) -> Result<Self, Problems> {
        let mut problems = Problems::default();
        campaigns.check(&mut problems);
        for asked in &plan.campaigns {
            let names = || campaigns.iter().map(|campaign| campaign.short_name.value.as_str());
            if !names().any(|name| name == asked.value) {
                let says = format!("none of the campaigns is called `{}`", asked.value);
                let problem = Problem::error("unknown-campaign", says)
                    .at(&asked.span)
                    .suggest(&asked.value, names());
                let known = names().collect::<Vec<_>>().join("; ");
                problems.push(if problem.help.is_some() {
                    problem
                } else {
                    problem.help(format!("there is {known}"))
                });
            }
        }
        members(plan, campaigns, &mut problems);
        let facts = Facts::read(plan, campaigns, &mut problems);
        let mut units = units::units(plan, campaigns, &mut problems);
        let wanted = wanted::points(plan, campaigns, &facts, &mut problems);
        if problems.any_error() {
            return Err(problems);
        }
        let mut notes = Vec::new();
        let (mut present, mut recorded) = (Vec::new(), Vec::new());
        for (number, campaign) in campaigns.iter().enumerate() {
            let units: Vec<&Unit> = units.iter().filter(|unit| unit.campaign == number).collect();
            let seen = columns::seen_columns(plan, campaign, &units);
            present.push(columns::present_columns(
                plan, graph, campaign, &seen, &facts, &units, &mut notes,
            ));
            recorded.push(columns::recorded_positions(graph, &seen, &facts, &units));
            if plan.reads(Side::Measured) {
                notes.extend(shifted(campaign));
            }
        }
        requirements::check_data(plan, &facts, &mut units);
        stop_on_fault(plan, &units, &[])?;
        stretches::share(plan, campaigns, &mut units);
        Ok(Self {
            plan,
            graph,
            campaigns,
            basis: Basis { facts, units, wanted, notes },
            present,
            recorded,
            soundness: Soundness::default(),
        })
    }

    /// What records are evaluated with, each alone.
    pub fn work(&self) -> Work<'_> {
        Work {
            plan: self.plan,
            graph: self.graph,
            campaigns: self.campaigns,
            facts: &self.basis.facts,
            units: &self.basis.units,
            present: &self.present,
            recorded: &self.recorded,
            shared: None,
            soundness: &self.soundness,
            stretches: None,
        }
    }
}

/// What the table of sections adds to the axis of the measurement.
fn shifted(campaign: &Campaign) -> Option<Remark> {
    let (_, axis, _) = campaign.offsets().next()?;
    let of =
        |(section, _, offset): (&str, &str, f64)| SectionOffset { section: section.into(), offset };
    Some(Remark::Shifted {
        axis: axis.into(),
        unit: if axis == "distance" { "m" } else { "s" }.into(),
        column: OFFSET.into(),
        offsets: campaign.offsets().map(of).collect(),
    })
}

/// What a protocol calls by name must be in every campaign.
fn members(plan: &Plan, campaigns: Campaigns<'_>, problems: &mut Problems) {
    for (number, campaign) in campaigns.iter().enumerate() {
        let of = campaigns.name_of(number).map_or_else(String::new, |name| format!(" {name}"));
        for record in &plan.records {
            let kind = record.side.kind();
            let all = campaign.records(kind);
            let names: Vec<&str> = all
                .iter()
                .filter_map(|which| campaign.record_called(*which).map(AsRef::as_ref))
                .collect();
            for member in
                record.members.iter().filter(|member| !names.contains(&member.value.as_str()))
            {
                let says = format!("the campaign{of} has no {} `{}`", kind.key(), member.value);
                let problem = Problem::error("unknown-record", says)
                    .at(&member.span)
                    .suggest(&member.value, names.iter().copied());
                let named = campaign.tree.get(kind.key()).map(|node| node.span.clone());
                let problem = named
                    .map_or(problem.clone(), |at| problem.also(&at, "the records of the campaign"));
                problems.push(match (&problem.help, names.is_empty()) {
                    (Some(_), _) => problem,
                    (None, true) => problem.help(format!(
                        "give its records names in campaign.yaml: `{}: {{{}: folder}}`",
                        kind.key(),
                        member.value
                    )),
                    (None, false) => problem.help(format!("there is {}", names.join(", "))),
                });
            }
        }
    }
}
