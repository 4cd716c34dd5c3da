//! Words that depend on what the protocol is about: a validation, an assessment, a comparison of
//! records.

use crate::result::{Certification, Kind, Verdict};

/// Words of a report.
#[derive(Clone, Debug)]
pub struct Wording {
    /// Above the name of the campaign on the cover.
    pub over: String,
    /// `Validation report`
    pub report: &'static str,
    /// Title of the chapter of the conditions over the sections used.
    pub domain: &'static str,
    /// What that chapter says of other conditions.
    pub outside: &'static str,
    /// `Pairs / n`
    pub count: &'static str,
    /// Head of what the values of a quantity are.
    pub comparison: &'static str,
}

pub fn wording(found: &Certification) -> Wording {
    let (report, domain, outside, rows) = match found.kind() {
        Kind::Validation if found.own_word.is_some() => {
            ("Comparison report", "Validity domain", NOT_DEMONSTRATED, "Pairs")
        }
        Kind::Validation => ("Validation report", "Validity domain", NOT_DEMONSTRATED, "Pairs"),
        Kind::Assessment => (
            "Assessment report",
            "Test conditions",
            "The requirements have not been assessed outside these ranges.",
            "Values",
        ),
        Kind::Comparison => (
            "Comparison report",
            "Test conditions",
            "The records have not been compared outside these ranges.",
            "Values",
        ),
        Kind::Mixed => {
            ("Validation and assessment report", "Validity domain", NOT_DEMONSTRATED, "Values")
        }
    };
    let count = if rows == "Pairs" { "Pairs / n" } else { "Values / n" };
    let comparison = match found.kind() {
        Kind::Validation => "Difference or metric",
        Kind::Assessment => "Values",
        Kind::Comparison => "Difference",
        Kind::Mixed => "Difference, metric or values",
    };
    Wording { over: over(found), report, domain, outside, count, comparison }
}

const NOT_DEMONSTRATED: &str =
    "Agreement between simulation and measurement has not been demonstrated outside these ranges.";

fn over(found: &Certification) -> String {
    let of_sides = match found.reads() {
        (true, false) => "simulated",
        (false, true) => "measured",
        _ => "simulated and measured",
    };
    match found.kind() {
        // A protocol that does not speak of validation gives its verdict in words of its own.
        Kind::Validation if found.own_word.is_some() => {
            "Comparison of simulated and measured records".into()
        }
        Kind::Validation => "Validation of a vehicle simulation model".into(),
        Kind::Assessment => format!("Assessment of a vehicle by {of_sides} records"),
        Kind::Comparison if found.reads() == (true, false) => {
            "Comparison of simulation codes".into()
        }
        Kind::Comparison => format!("Comparison of {of_sides} records"),
        Kind::Mixed => "Validation of a simulation model and assessment of a vehicle".into(),
    }
}

/// The verdict as a sentence.
pub fn sentence(found: &Certification) -> &'static str {
    if found.own_word.is_some() {
        return super::verdicts::sentence(found);
    }
    if found.kind() == Kind::Validation {
        return match found.verdict {
            Verdict::Validated => {
                "All acceptance criteria of the protocol are met. The simulation model is validated for the domain stated in this report."
            }
            Verdict::NotValidated => {
                "At least one acceptance criterion is not met. The simulation model is not validated."
            }
            Verdict::NotAssessable => {
                "The campaign does not contain the data that the protocol requires. The simulation model cannot be assessed."
            }
        };
    }
    match found.verdict {
        Verdict::Validated => {
            "The requirements of the protocol are met for the conditions stated in this report."
        }
        Verdict::NotValidated => "At least one requirement of the protocol is not met.",
        Verdict::NotAssessable => {
            "The requirements cannot all be assessed: the campaign does not contain the data that the protocol requires."
        }
    }
}

/// The statement about the simulation; `None` where no simulated record is in a quantity. That
/// nothing was changed after the comparison is printed only of a comparison with measurements whose
/// campaign has no origin that contradicts it.
pub fn simulation_statement(found: &Certification) -> Option<String> {
    let (simulated, measured) = found.reads();
    if !simulated {
        return None;
    }
    let obtained = "The simulation results named in this report were obtained with the model and the settings described";
    let origin = found.campaign.origin.as_ref().filter(|origin| !origin.only_imported());
    Some(match origin {
        Some(origin) => format!("{obtained}. {}.", origin.says),
        None if measured && found.kind() != Kind::Assessment => {
            format!("{obtained}, and were not changed after the comparison with the measurement.")
        }
        None => format!("{obtained}."),
    })
}

/// The statement about the measurement; `None` where no measured record is in a quantity.
pub fn measurement_statement(found: &Certification) -> Option<&'static str> {
    found.reads().1.then_some(
        "The measured records named in this report are those of the test runs described. Channels, calibration and sections were checked.",
    )
}
