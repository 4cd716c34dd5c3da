//! What a reader must know of the rules to read a verdict: it stands beside the verdict.

use crate::result::{Certification, OwnProtocol, Remark};
use crate::words::Text;

/// Whose protocol it is, if it is not a shipped one, and parameters that are not at their default.
pub fn beside_verdict(found: &Certification) -> Vec<Text> {
    let own = found.protocol.own.iter().map(OwnProtocol::text);
    let set = found.deviations.iter().map(|deviation| &deviation.what);
    own.chain(set.filter(|what| is_of_rules(what)).map(Remark::text)).collect()
}

/// Whether a remark is of the rules, and so stands beside the verdict.
pub fn is_of_rules(note: &Remark) -> bool {
    matches!(note, Remark::ParametersSet { .. })
}
