//! The limit of one group of rows: its bound with factors, and the limits that it refers to.

use crate::result::Direction;
use crate::run::{
    estimate::{Closeness, Group, RowGroup},
    prelude::*,
    sections::{Known, Limits, Vehicle},
};

pub fn applies(limit: &Limit, vehicle: &Vehicle) -> Result<bool, Reason> {
    limit.only_when.as_ref().map_or(Ok(true), |condition| flag(condition, &Known::vehicle(vehicle)))
}

/// The limits of one quantity, for one group of its rows.
#[derive(Clone, Copy, Debug)]
pub struct OfGroup<'a> {
    quantity: &'a Quantity,
    part: &'a RowGroup<'a>,
    /// Data of its sections can be used in a limit.
    group: Group<'a>,
    known: &'a Known<'a>,
    /// How many limits refer to the one that is computed.
    depth: usize,
}

impl<'a> OfGroup<'a> {
    pub fn new(
        quantity: &'a Quantity,
        part: &'a RowGroup<'a>,
        group: Group<'a>,
        known: &'a Known<'a>,
    ) -> Self {
        Self { quantity, part, group, known, depth: 0 }
    }

    /// A limit with its factors, SI. So are those that it refers to.
    pub fn bound(&self, limit: &Limit) -> Result<f64, Reason> {
        let limits = self.group.plan.quantities.iter().map(|quantity| quantity.limits.len());
        if self.depth > limits.sum() {
            return Err(Reason::LimitDependsOnItself);
        }
        let mut taken = self.group.taken(&limit.bound);
        let mut sides = None;
        // The limit of a single value may depend on it.
        if matches!(limit.estimate.kind, EstimateKind::Each) {
            let row = match self.group.members {
                [member] => Some(member.row),
                _ => None,
            };
            taken.insert(0, row.map(|row| row.value).ok_or(Reason::NoValue));
            sides = row.and_then(|row| row.simulated.zip(row.measured));
        }
        let names = Known { inputs: &taken, limits: Some(self), sides, ..*self.known };
        let mut value = number(&limit.bound.expr, &names)?;
        for (factor, condition) in &limit.factors {
            if flag(condition, &names)? {
                value *= number(factor, &names)?;
            }
        }
        if value <= 0.0 && limit.direction == Direction::Magnitude {
            return Err(Reason::LimitNotPositive);
        }
        Ok(value)
    }
}

impl Limits for OfGroup<'_> {
    /// One for just this group has priority over one for all.
    fn limit_of(&self, name: &LimitName) -> Result<f64, Reason> {
        let Group { plan, table, .. } = self.group;
        let quantity = name.of.as_ref().map_or(self.quantity, |(at, _)| &plan.quantities[*at]);
        let mut found: Option<(Closeness, &Limit)> = None;
        for limit in quantity.limits.iter().filter(|limit| limit.estimate.name == name.estimate) {
            let Some(closeness) = self.part.covered_by(&limit.scope) else { continue };
            if applies(limit, self.known.vehicle)?
                && found.is_none_or(|(before, _)| closeness > before)
            {
                found = Some((closeness, limit));
            }
        }
        let (_, limit) = found.ok_or_else(|| Reason::NoLimitOf { estimate: name.to_string() })?;
        let deeper = OfGroup { depth: self.depth + 1, ..*self };
        let Some((at, id)) = &name.of else { return deeper.bound(limit) };
        // A bound may be taken from the values that it limits: those of the other quantity.
        let group = Group { quantity: Some(quantity), members: &[], ..self.group };
        let rows = match limit.bound.taken.is_empty() {
            true => Ok(Vec::new()),
            false => table[*at]
                .clone()
                .and_then(|rows| self.part.rows_of(&group.with(rows), &limit.scope)),
        };
        let rows = rows.map_err(|reason| reason.about(Subject::Quantity, id))?;
        OfGroup { quantity, group: group.with(&rows), ..deeper }.bound(limit)
    }
}
