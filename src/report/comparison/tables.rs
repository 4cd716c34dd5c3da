//! All tables of a comparison as CSV, in full precision.

use crate::report::tables::csv_file;
use crate::result::comparison::Comparison;

fn number(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

fn flag(value: Option<bool>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

/// File names and contents for the folder `tables/`.
///
/// # Errors
/// An error of the CSV writer, which writes to memory.
pub fn tables(found: &Comparison) -> Result<Vec<(String, Vec<u8>)>, csv::Error> {
    let verdicts = found.verdicts.iter().map(|one| {
        vec![
            one.campaign.clone(),
            one.protocol.clone(),
            one.verdict.clone(),
            flag(one.holds),
            one.decided_by.clone().unwrap_or_default(),
            number(one.ratio),
            one.sections_used.to_string(),
            one.reasons.join("; "),
        ]
    });
    let ratios = found.ratios.iter().map(|one| {
        vec![
            one.campaign.clone(),
            one.protocol.clone(),
            one.metric.clone(),
            one.quantity.clone(),
            one.estimate.clone(),
            one.scope.to_string(),
            one.unit.clone(),
            number(one.value),
            number(one.limit),
            number(one.ratio),
            flag(one.holds),
            one.reason.clone().unwrap_or_default(),
        ]
    });
    let scores = found.scores.iter().map(|one| {
        let metric = one.metric.clone().unwrap_or_default();
        vec![
            one.campaign.clone(),
            one.section.clone(),
            one.protocol.clone(),
            metric,
            one.score.to_string(),
            one.limited.to_string(),
        ]
    });
    let agreement = found.agreement.iter().map(|one| {
        let counts = one.contingency.map_or([None; 4], |[[a, b], [c, d]]| [a, b, c, d].map(Some));
        let mut row = vec![
            one.of.clone(),
            one.protocol.clone().unwrap_or_default(),
            one.a.clone(),
            one.b.clone(),
            one.sections.to_string(),
        ];
        row.extend(counts.map(|count| count.map_or_else(String::new, |count| count.to_string())));
        row.extend([number(one.spearman), one.reason.clone().unwrap_or_default()]);
        row
    });
    let sensitivity = found.sensitivity.iter().flat_map(|one| {
        one.sizes.iter().enumerate().map(move |(at, size)| {
            vec![
                one.protocol.clone(),
                one.metric.clone(),
                one.disturbance.clone(),
                size.to_string(),
                number(one.values.get(at).copied().flatten()),
                number(one.largest.get(at).copied().flatten()),
                one.verdicts_changed.get(at).map_or_else(String::new, ToString::to_string),
                one.verdicts.to_string(),
                one.reasons.get(at).cloned().flatten().unwrap_or_default(),
            ]
        })
    });
    let differences = found.differences.iter().map(|one| {
        vec![
            one.rule.clone(),
            one.words.clone(),
            one.campaign.clone(),
            one.verdict_before.clone(),
            one.verdict_after.clone().unwrap_or_default(),
            number(one.ratio_before),
            number(one.ratio_after),
            one.reason.clone().unwrap_or_default(),
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
            verdicts.collect(),
        )?,
        csv_file(
            "ratios",
            &[
                "campaign", "protocol", "metric", "quantity", "estimate", "scope", "unit", "value",
                "limit", "ratio", "holds", "reason",
            ],
            ratios.collect(),
        )?,
        csv_file(
            "scores",
            &["campaign", "section", "protocol", "metric", "score", "limited"],
            scores.collect(),
        )?,
        csv_file(
            "agreement",
            &[
                "of", "protocol", "a", "b", "sections", "both met", "a only", "b only", "neither",
                "spearman", "reason",
            ],
            agreement.collect(),
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
            sensitivity.collect(),
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
            differences.collect(),
        )?,
    ])
}
