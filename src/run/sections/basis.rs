//! What the values of sections are judged with: the same for every part of a campaign, and without
//! any record.

use serde::{Deserialize, Serialize};

use super::{facts::Facts, unit::Unit, wanted::Point};
use crate::result::DataItem;
use crate::run::prelude::*;

/// Data read before any record.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Basis {
    pub facts: Facts,
    pub units: Vec<Unit>,
    /// Wanted operation, for each domain.
    pub wanted: Vec<Vec<Point>>,
    pub notes: Vec<Remark>,
}

impl Basis {
    /// The sections, in the order of their numbers.
    pub fn units(&self) -> &[Unit] {
        &self.units
    }

    /// The vehicle data that the protocol reads.
    pub fn vehicle(&self, plan: &Plan) -> Vec<DataItem> {
        self.facts.items(plan)
    }

    /// Whether it is one of a plan, as a file may claim.
    ///
    /// # Errors
    /// What does not agree, in words.
    pub fn check(&self, plan: &Plan) -> Result<(), String> {
        let vehicle = |data: usize| data == plan.vehicle.len();
        if self.facts.vehicles.is_empty() {
            return Err("it has no vehicle".into());
        }
        if !self.facts.vehicles.iter().all(|of| vehicle(of.data.len()) && vehicle(of.assumed.len()))
        {
            return Err("its vehicle data are not those that the protocol reads".into());
        }
        for unit in &self.units {
            let inside = unit.vehicle < self.facts.vehicles.len()
                && unit.original.is_none_or(|original| original < self.units.len());
            if unit.columns.len() != plan.columns.len() || !inside {
                return Err(format!("its section {} is not one of the protocol", unit.name));
            }
        }
        let of_domain = |(domain, points): (&Domain, &Vec<Point>)| {
            points.iter().all(|point| {
                point.values.len() == domain.over.len() && point.group.len() == domain.each.len()
            })
        };
        if self.wanted.len() != plan.domains.len()
            || !plan.domains.iter().zip(&self.wanted).all(of_domain)
        {
            return Err("its wanted operation is not that of the protocol".into());
        }
        Ok(())
    }
}
