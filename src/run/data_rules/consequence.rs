//! What a finding means for the verdict.

use crate::check::plan::OnFault;
use crate::result::Consequence;

/// The consequence of a finding, from the rule's `otherwise`. For `stop`, the run ends elsewhere.
pub fn consequence(otherwise: OnFault) -> Consequence {
    match otherwise {
        OnFault::Note => Consequence::Note,
        OnFault::NotUsed => Consequence::NotUsed,
        OnFault::NotAssessable | OnFault::Stop => Consequence::NotAssessable,
    }
}
