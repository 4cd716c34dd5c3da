//! The table of values, one row for each section, position and record or pair of records: rows with
//! their sections, and what their vehicles agree on.

use std::collections::{BTreeSet, HashMap};

use crate::check::plan::{Independent, Plan, Scalar};
use crate::result::{OfVehicle, Reason, VehicleValue};
use crate::run::sections::{Facts, Unit, Vehicle};
use crate::run::values::Row;

/// A row with its section.
#[derive(Clone, Copy, Debug)]
pub struct Member<'a> {
    pub unit: &'a Unit,
    /// Name of its position.
    pub signal: &'a str,
    pub row: &'a Row,
}

/// The rows of every quantity, or the reason why they cannot be used.
pub type Table<'a> = [Result<&'a [Member<'a>], Reason>];

/// The index of the independent unit of each member.
pub fn independent(plan: &Plan, members: &[Member<'_>]) -> Vec<usize> {
    independent_of(plan, members.iter().map(|member| member.unit))
}

/// By what units of independence are told apart.
#[derive(PartialEq, Eq, Hash)]
enum Key<'u> {
    Site(usize),
    Name(&'u str),
    /// Its bits.
    Number(u64),
    Flag(bool),
}

/// The index of the independent unit of each section.
pub fn independent_of<'u>(plan: &Plan, units: impl Iterator<Item = &'u Unit>) -> Vec<usize> {
    let mut known: HashMap<(usize, Key<'u>), usize> = HashMap::new();
    let one = |unit: &'u Unit| {
        let key = match plan.independent {
            Independent::Site => Key::Site(unit.site),
            Independent::Section => Key::Name(&unit.name),
            Independent::Column(index) => match &unit.columns[index] {
                Ok(Scalar::Word(word)) => Key::Name(word),
                Ok(Scalar::Number(number)) => Key::Number(number.to_bits()),
                Ok(Scalar::Flag(flag)) => Key::Flag(*flag),
                // A section that does not state its unit counts as part of its site.
                Err(_) => Key::Site(unit.site),
            },
        };
        let next = known.len();
        *known.entry((unit.copy, key)).or_insert(next)
    };
    units.map(one).collect()
}

/// Number of independent units of the members.
pub fn count_independent(plan: &Plan, members: &[Member<'_>]) -> usize {
    independent(plan, members).into_iter().collect::<BTreeSet<_>>().len()
}

impl Facts {
    /// The vehicles of some rows, each once; all where there are no rows.
    pub fn among(&self, members: &[Member<'_>]) -> Vec<&Vehicle> {
        if self.vehicles.len() == 1 || members.is_empty() {
            return self.vehicles.iter().collect();
        }
        let used: BTreeSet<usize> = members.iter().map(|member| member.unit.vehicle).collect();
        used.into_iter().map(|number| &self.vehicles[number]).collect()
    }

    /// What holds of the vehicles of some rows, if it is the same for all of them.
    ///
    /// # Errors
    /// It has no value, or differs; `shown` tells the values.
    pub fn agreed<T: PartialEq>(
        &self,
        members: &[Member<'_>],
        mut of: impl FnMut(&Vehicle) -> Result<T, Reason>,
        shown: impl Fn(T) -> VehicleValue,
    ) -> Result<T, Reason> {
        let mut found: Vec<(&Vehicle, T)> = Vec::new();
        for vehicle in self.among(members) {
            let value = of(vehicle).map_err(|reason| vehicle.told(reason))?;
            if found.iter().all(|(_, known)| *known != value) {
                found.push((vehicle, value));
            }
        }
        if found.len() > 1 {
            let each = |(vehicle, value): (&Vehicle, T)| OfVehicle {
                value: shown(value),
                vehicle: vehicle.of.clone().unwrap_or_default(),
            };
            return Err(Reason::DependsOnVehicle { values: found.into_iter().map(each).collect() });
        }
        found.pop().map(|(_, value)| value).ok_or(Reason::NoVehicle)
    }
}
