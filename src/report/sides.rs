//! What the two values of a pair are called: simulated and measured, a record and what is central
//! of all, a repeat and its original.

use crate::result::{Certification, QuantityResult, Trace};

/// Names of the two values of a pair.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sides {
    /// In a sentence: `simulated`, `measured`.
    pub one: &'static str,
    pub other: String,
    /// In narrow heads of tables.
    pub short: [&'static str; 2],
}

impl Sides {
    pub fn of(quantity: &QuantityResult) -> Self {
        let (one, other, short) = match (&quantity.among, quantity.repeats) {
            (Some(_), _) => {
                let center =
                    quantity.spread.as_ref().map(|spread| format!("{} of all", spread.center));
                let short = if quantity.against.is_some() { "other" } else { "all" };
                let other = quantity.against.as_ref().map(|title| title.to_lowercase()).or(center);
                ("record", other.unwrap_or_else(|| "all records".to_owned()), ["rec.", short])
            }
            (None, true) => ("repeat", "original".to_owned(), ["rep.", "orig."]),
            (None, false) => ("simulated", "measured".to_owned(), ["sim.", "meas."]),
        };
        Self { one, other, short }
    }

    /// As heads of columns: `Simulated`, `Measured`.
    pub fn heads(&self) -> [String; 2] {
        [capital(self.one), capital(&self.other)]
    }

    /// What pairs are, and their differences: `simulated against measured values`
    pub fn against(&self) -> String {
        match self.one {
            "simulated" => format!("{} against {} values", self.one, self.other),
            "repeat" => "repeats against originals".to_owned(),
            _ => format!("each {} against the {}", self.one, self.other),
        }
    }
}

/// The names of the two curves of a plot.
pub fn of_trace(trace: &Trace, found: &Certification) -> (&'static str, &'static str) {
    let repeats =
        found.quantities.iter().any(|quantity| quantity.id == trace.quantity && quantity.repeats);
    if repeats { ("repeat", "original") } else { ("simulated", "measured") }
}

/// With a capital at the start.
pub fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_gets_a_capital() {
        assert_eq!(["record", "ähnlich", "", "S"].map(capital), ["Record", "Ähnlich", "", "S"]);
    }
}
