//! Declared tolerances of a campaign, converted to the units of the catalogue.

use std::collections::HashMap;

use crate::data::{Campaign, campaign::Fact};
use crate::diagnose::settings::Settings;
use crate::problem::{Problem, Problems};
use crate::units::Unit;

/// The map of `campaign.yaml` with the tolerances.
const GROUP: &str = "declared_tolerances";

/// Declared standard deviations by name.
#[derive(Clone, Debug, Default)]
pub struct Declared {
    values: HashMap<String, f64>,
    /// Names that are not in the catalogue.
    pub unknown: Vec<String>,
    /// Whether the campaign declares any tolerance.
    pub any: bool,
}

impl Declared {
    /// Reads the declared tolerances.
    ///
    /// Problems: `wrong-kind` for a value that is not a number from 0 on, `unknown-unit`,
    /// `unit-mismatch`; a warning for a name that is not in the catalogue.
    pub fn read(campaign: &Campaign, settings: &Settings, problems: &mut Problems) -> Self {
        let known = settings.tolerated();
        let mut declared = Self::default();
        for fact in campaign.facts.iter().filter(|fact| fact.group == GROUP) {
            declared.any = true;
            let Some((_, unit)) = known.iter().find(|(name, _)| *name == fact.name) else {
                let says = format!(
                    "the catalogue has no tolerance `{}`: the declared value is not used",
                    fact.name
                );
                let names = known.iter().map(|(name, _)| *name);
                problems.push(
                    Problem::warning("unknown-tolerance", says)
                        .at(&fact.span)
                        .suggest(&fact.name, names),
                );
                declared.unknown.push(fact.name.clone());
                continue;
            };
            match in_unit(fact, unit) {
                Ok(value) => {
                    declared.values.insert(fact.name.clone(), value);
                }
                Err(problem) => problems.push(problem.at(&fact.span)),
            }
        }
        declared
    }

    /// One standard deviation, in the unit of the catalogue; nothing where the campaign declares
    /// none.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.values.get(name).copied()
    }
}

fn in_unit(fact: &Fact, wanted: &Unit) -> Result<f64, Problem> {
    let number =
        fact.text.trim().parse::<f64>().ok().filter(|number| number.is_finite() && *number >= 0.0);
    let number = number.ok_or_else(|| {
        let says = format!(
            "the tolerance `{}` is one standard deviation, a number from 0 on, not `{}`",
            fact.name, fact.text
        );
        Problem::error("wrong-kind", says)
    })?;
    let text = fact.unit.as_deref().unwrap_or("-");
    let unit = Unit::parse(text).map_err(|unknown| {
        let problem =
            Problem::error("unknown-unit", format!("`{}` is not a known unit", unknown.word));
        match unknown.near {
            Some(near) => problem.help(format!("did you mean `{near}`?")),
            None => problem,
        }
    })?;
    if unit.dimension != wanted.dimension {
        let says = format!(
            "the tolerance `{}` is declared in {unit}, the catalogue reads it in {wanted}",
            fact.name
        );
        return Err(
            Problem::error("unit-mismatch", says).help(format!("write `{} [{wanted}]`", fact.name))
        );
    }
    Ok(wanted.from_si(unit.to_si(number)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;

    fn fact(name: &str, unit: Option<&str>, text: &str) -> Fact {
        let span = Source::new("campaign.yaml", "").span(0..0);
        Fact {
            group: GROUP.into(),
            name: name.into(),
            unit: unit.map(str::to_string),
            text: text.into(),
            span,
        }
    }

    #[test]
    fn units_are_converted_and_what_is_no_standard_deviation_is_refused() {
        let millimetres = Unit::parse("mm").expect("known");
        assert_eq!(in_unit(&fact("cant", Some("mm"), "3.0"), &millimetres).ok(), Some(3.0));
        let metres = in_unit(&fact("cant", Some("m"), "0.003"), &millimetres).expect("a length");
        assert!((metres - 3.0).abs() < 1e-12, "{metres}");
        let code = |fact: &Fact| in_unit(fact, &millimetres).expect_err("refused").code;
        assert_eq!(code(&fact("cant", Some("kN"), "3")), "unit-mismatch");
        assert_eq!(code(&fact("cant", None, "3")), "unit-mismatch");
        assert_eq!(code(&fact("cant", Some("furlong"), "3")), "unknown-unit");
        for text in ["-1", "nan", "inf", "about 3", ""] {
            assert_eq!(code(&fact("cant", Some("mm"), text)), "wrong-kind", "{text}");
        }
    }
}
