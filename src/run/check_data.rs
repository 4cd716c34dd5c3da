//! The data of a campaign checked without its records.

use crate::run::{
    data_rules::{nothing_usable, stop_on_fault},
    find,
    prelude::*,
    sections::{Facts, requirements, units, wanted},
    values::SectionValues,
};

/// Checks what a run reads before any record: the data of vehicles and sections, and wanted
/// operation. Records need not exist.
pub fn check_data(plan: &Plan, campaign: &Campaign, problems: &mut Problems) {
    let campaigns = Campaigns::from(campaign);
    campaigns.check(problems);
    let facts = Facts::read(plan, campaigns, problems);
    if find::applies(plan, campaign) {
        find::check_facts(plan, campaign, problems);
        wanted::points(plan, campaigns, &facts, problems);
        return;
    }
    let mut units = units::units(plan, campaigns, &facts, problems);
    wanted::points(plan, campaigns, &facts, problems);
    if problems.any_error() {
        return;
    }
    requirements::check_data(plan, &facts, &mut units);
    let told = match stop_on_fault(plan, &units, &[]) {
        Ok(()) if units.iter().any(|unit| unit.fault.is_none()) => return,
        Ok(()) => nothing_usable(&units, vec![SectionValues::default(); units.len()]),
        Err(told) => told,
    };
    problems.add(told.0);
}
