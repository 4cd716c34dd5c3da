//! What a reader must know of the rules to read a verdict: it stands beside the verdict.

use crate::result::{Certification, OwnProtocol, Remark};
use crate::words::Text;

/// Whose protocol it is, if it is not a shipped one, parameters that are not at their default, and
/// quantities that are not assessed.
pub fn beside_verdict(found: &Certification) -> Vec<Text> {
    let own = found.protocol.own.iter().map(OwnProtocol::text);
    let set = found.deviations.iter().map(|deviation| &deviation.what);
    own.chain(set.filter(|what| is_of_rules(what)).map(Remark::text)).collect()
}

/// Whether a remark is of the rules or of what the verdict does not speak of, and so stands beside
/// it.
pub fn is_of_rules(note: &Remark) -> bool {
    matches!(note, Remark::ParametersSet { .. } | Remark::NotAssessed { .. })
}
