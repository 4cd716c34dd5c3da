//! What results say in words, for comparison.

use fishplate::result::Reason;

/// Each reason as its sentence.
pub fn texts(reasons: &[Reason]) -> Vec<String> {
    reasons.iter().map(|reason| reason.text().to_string()).collect()
}

/// A reason as its sentence.
pub fn text(reason: &Option<Reason>) -> Option<String> {
    reason.as_ref().map(|reason| reason.text().to_string())
}
