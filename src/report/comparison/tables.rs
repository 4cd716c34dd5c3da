//! All tables of a comparison as CSV, in full precision.

use crate::report::document::{Cell, cells};
use crate::report::tables::csv_file;
use crate::result::comparison::Comparison;

/// File names and contents for the folder `tables/`.
///
/// # Errors
/// An error of the CSV writer, which writes to memory.
pub fn tables(found: &Comparison) -> Result<Vec<(String, Vec<u8>)>, csv::Error> {
    let verdicts = found.verdicts.iter().map(|one| {
        cells![
            one.campaign,
            one.protocol,
            one.verdict,
            one.holds,
            one.decided_by,
            one.ratio,
            one.sections_used,
            one.reasons.iter().map(|one| one.text().into()).collect::<Vec<String>>().join("; ")
        ]
    });
    let ratios = found.ratios.iter().map(|one| {
        cells![
            one.campaign,
            one.protocol,
            one.metric,
            one.quantity,
            one.estimate,
            one.scope,
            one.unit,
            one.value,
            one.limit,
            one.ratio,
            one.holds,
            one.reason
        ]
    });
    let scores = found.scores.iter().map(|one| {
        cells![one.campaign, one.section, one.protocol, one.metric, one.score, one.limited]
    });
    let agreement = found.agreement.iter().map(|one| {
        let counts = one.contingency.map_or([None; 4], |[[a, b], [c, d]]| [a, b, c, d].map(Some));
        let mut row = cells![one.of, one.protocol, one.a, one.b, one.sections];
        row.extend(counts.map(|count| count.map_or(Cell::BLANK, Cell::from)));
        row.extend(cells![one.spearman, one.reason]);
        row
    });
    let sensitivity = found.sensitivity.iter().flat_map(|one| {
        one.sizes.iter().enumerate().map(move |(at, size)| {
            cells![
                one.protocol,
                one.metric,
                one.disturbance,
                *size,
                one.values.get(at).copied().flatten(),
                one.largest.get(at).copied().flatten(),
                one.verdicts_changed.get(at).copied().map_or(Cell::BLANK, Cell::from),
                one.verdicts,
                one.reasons.get(at).cloned().flatten()
            ]
        })
    });
    let differences = found.differences.iter().map(|one| {
        cells![
            one.rule,
            one.words,
            one.campaign,
            one.verdict_before,
            one.verdict_after,
            one.ratio_before,
            one.ratio_after,
            one.reason
        ]
    });
    Ok(vec![
        csv_file(
            "verdicts",
            &[
                "campaign",
                "protocol",
                "verdict",
                "holds",
                "decided by",
                "ratio",
                "sections used",
                "reasons",
            ],
            verdicts,
        )?,
        csv_file(
            "ratios",
            &[
                "campaign", "protocol", "metric", "quantity", "estimate", "scope", "unit", "value",
                "limit", "ratio", "holds", "reason",
            ],
            ratios,
        )?,
        csv_file(
            "scores",
            &["campaign", "section", "protocol", "metric", "score", "limited"],
            scores,
        )?,
        csv_file(
            "agreement",
            &[
                "of", "protocol", "a", "b", "sections", "both met", "a only", "b only", "neither",
                "spearman", "reason",
            ],
            agreement,
        )?,
        csv_file(
            "sensitivity",
            &[
                "protocol",
                "metric",
                "disturbance",
                "size",
                "rms change",
                "largest",
                "verdicts changed",
                "verdicts",
                "reason",
            ],
            sensitivity,
        )?,
        csv_file(
            "differences",
            &[
                "rule",
                "difference",
                "campaign",
                "verdict before",
                "verdict after",
                "ratio before",
                "ratio after",
                "reason",
            ],
            differences,
        )?,
    ])
}
