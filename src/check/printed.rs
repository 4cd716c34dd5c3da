//! How values and limits are printed: the units of values, the words of limits.

use super::prelude::*;

impl Checker<'_> {
    /// The unit in which values are printed: as stated, else that of the signal, else SI.
    pub fn quantity_unit(
        &mut self,
        block: &Block,
        of: &Text,
        dimension: Dimension,
    ) -> Option<Unit> {
        if let Some(field) = block.field("in") {
            let unit = self.unit(&field.value)?;
            if unit.dimension != dimension {
                return self.refuse(
                    problem!(
                        "unit-mismatch",
                        field,
                        "the values are {}; the unit is that of {}",
                        dimension.in_words(),
                        unit.dimension.in_words()
                    )
                    .also(&of.span, dimension.in_words()),
                );
            }
            return Some(unit);
        }
        let signal = from_pest::of_places(of, self.problems)?.signal.node;
        Some(self.own_unit(&signal, dimension))
    }

    /// The declared unit of the first section column or vehicle datum in an expression that has
    /// this dimension.
    pub fn datum_unit(&self, expr: &Expr, dimension: Dimension) -> Option<Unit> {
        let datum = match &expr.kind {
            Kind::Column(index) => self.names.columns.get(*index)?,
            Kind::Vehicle(index) => self.names.vehicle.get(*index)?,
            Kind::Negative(inner) | Kind::Mapped(inner, _) => {
                return self.datum_unit(inner, dimension);
            }
            Kind::Binary(_, left, right) => {
                return self
                    .datum_unit(left, dimension)
                    .or_else(|| self.datum_unit(right, dimension));
            }
            Kind::Call(_, arguments) => {
                return arguments.iter().find_map(|argument| self.datum_unit(argument, dimension));
            }
            _ => return None,
        };
        match &datum.kind {
            DatumKind::Number(unit) if unit.dimension == dimension => Some(unit.clone()),
            _ => None,
        }
    }

    /// The unit of a channel or signal if its dimension agrees, else the SI unit.
    pub fn own_unit(&self, name: &str, dimension: Dimension) -> Unit {
        let own = self.names.signals.get(name).and_then(|signal| signal.unit.clone());
        own.filter(|unit| unit.dimension == dimension).unwrap_or_else(|| Unit::si(dimension))
    }
}

/// The words of a limit as printed: `2/3 of the limit of std` for `2/3 of limit of std`.
pub fn naming_limit(words: &str) -> String {
    words.replace(" limit of ", " the limit of ")
}
