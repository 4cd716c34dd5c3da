//! What was done differently than the standard and the protocol say.

use crate::check::plan::Plan;
use crate::result::{Departed, DeviationFrom, Finding, FindingData, ProtocolInfo, Remark};

/// All deviations; of the remarks of a run, those that are some are taken out.
pub fn all(
    plan: &Plan,
    protocol: &ProtocolInfo,
    findings: &[Finding],
    notes: &mut Vec<Remark>,
) -> Vec<DeviationFrom> {
    let left_out = plan.leaves_out.iter().map(|says| Remark::LeavesOut { says: says.clone() });
    let changed = Some(protocol.deviations.len()).filter(|rules| *rules > 0);
    let changed = changed.map(|rules| Remark::RulesChanged { rules });
    let unchecked = notes.extract_if(.., |note| {
        matches!(
            note,
            Remark::Unchecked { .. } | Remark::NotAssessed { .. } | Remark::RulesNotChecked { .. }
        )
    });
    let parameters = protocol.parameters_off_default.clone();
    let set = (!parameters.is_empty()).then_some(Remark::ParametersSet { parameters });
    let of_protocol = changed.into_iter().chain(set).chain(unchecked).chain(edited(findings));
    let from = |from| move |what| DeviationFrom { from, what };
    left_out
        .map(from(Departed::Standard))
        .chain(of_protocol.map(from(Departed::Protocol)))
        .collect()
}

/// Records that were changed after their import, where the campaign gives the reason.
fn edited(findings: &[Finding]) -> impl Iterator<Item = Remark> {
    findings.iter().flat_map(Finding::places).filter_map(|place| match &place.data {
        FindingData::RecordChanged { file, reason: Some(reason), .. } => {
            Some(Remark::RecordEdited { file: file.clone(), reason: reason.clone() })
        }
        _ => None,
    })
}
