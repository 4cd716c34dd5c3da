//! All tables of a study as CSV, in full precision.

use crate::report::tables::csv_file;
use crate::result::study::{
    AtValue, Found, ParameterStudy, QuantitySpread, SelectionStudy, Study, SyncStudy,
};

type Row = Vec<String>;
type Tables = Vec<(String, Vec<u8>)>;

/// File names and contents for the folder `tables/`.
///
/// # Errors
/// An error of the CSV writer, which writes to memory.
pub fn tables(study: &Study) -> Result<Tables, csv::Error> {
    match &study.found {
        Found::Sections(found) => sections(found),
        Found::Sync(found) => sync(found),
        Found::Parameters(found) => parameters(found),
    }
}

fn number(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}

const SPREAD: [&str; 20] = [
    "quantity",
    "statistic",
    "scope",
    "limit",
    "all sections",
    "min",
    "q1",
    "median",
    "q3",
    "max",
    "outliers",
    "exact",
    "quartiles within",
    "q1 low 95 %",
    "q1 high 95 %",
    "median low 95 %",
    "median high 95 %",
    "q3 low 95 %",
    "q3 high 95 %",
    "share failing",
];

fn spread(quantities: &[QuantitySpread]) -> Vec<Row> {
    let statistics = quantities.iter().flat_map(|quantity| {
        quantity.statistics.iter().map(move |statistic| (quantity, statistic))
    });
    statistics
        .map(|(quantity, statistic)| {
            let mut row = vec![
                quantity.id.clone(),
                statistic.name.to_string(),
                statistic.scope.to_string(),
                statistic.limit.to_string(),
            ];
            row.push(number(statistic.overall));
            match &statistic.spread {
                Some(spread) => {
                    row.extend(
                        [spread.min, spread.q1, spread.median, spread.q3, spread.max]
                            .map(|value| value.to_string()),
                    );
                    row.extend([
                        spread.outliers.to_string(),
                        spread.exact.to_string(),
                        number(spread.within),
                    ]);
                    row.extend(spread.intervals.all().into_iter().flat_map(|ends| {
                        [number(ends.map(|ends| ends.0)), number(ends.map(|ends| ends.1))]
                    }));
                }
                None => row.extend((0..14).map(|_| String::new())),
            }
            row.push(statistic.failing.to_string());
            row
        })
        .collect()
}

fn sections(found: &SelectionStudy) -> Result<Tables, csv::Error> {
    let importance = found
        .sections
        .iter()
        .map(|one| {
            vec![one.section.clone(), one.zone.clone(), number(one.with), number(one.without)]
        })
        .collect();
    let failing = found
        .quantities
        .iter()
        .map(|quantity| {
            vec![quantity.id.clone(), quantity.failing.to_string(), number(quantity.alone)]
        })
        .collect();
    let worst = found
        .worst
        .iter()
        .map(|one| {
            vec![
                one.quantity.clone(),
                one.title.clone(),
                one.scope.to_string(),
                one.normalised.to_string(),
                one.sections.join(" "),
            ]
        })
        .collect();
    let removal = found
        .removal
        .iter()
        .flat_map(|removal| &removal.sets)
        .map(|set| vec![set.len().to_string(), set.join(" ")])
        .collect();
    let mut all = vec![
        csv_file("spread", &SPREAD, spread(&found.quantities))?,
        csv_file(
            "importance",
            &["section", "zone", "share validated with it", "share validated without it"],
            importance,
        )?,
        csv_file("failing", &["quantity", "share failing", "share failing alone"], failing)?,
        csv_file("worst", &["quantity", "statistic", "scope", "normalised", "sections"], worst)?,
        csv_file("removal", &["sections removed", "sections"], removal)?,
    ];
    if let Some(reduction) = &found.reduction {
        let kept = reduction.kept.iter().flat_map(|(zone, kept)| {
            kept.iter().map(move |section| vec![zone.clone(), section.clone()])
        });
        all.push(csv_file("kept", &["zone", "section"], kept.collect())?);
    }
    Ok(all)
}

fn sync(found: &SyncStudy) -> Result<Tables, csv::Error> {
    let (mut offsets, mut all, mut one) = (Vec::new(), Vec::new(), Vec::new());
    for at in &found.offsets {
        let offset = at.offset.value().to_string();
        let (share, reason) = match at.selections.counted() {
            Ok(counted) => (counted.share.share.to_string(), String::new()),
            Err(reason) => (String::new(), reason.to_owned()),
        };
        let flips = at.flips.compared();
        let (lost, gained) =
            (number(flips.map(|flips| flips.lost)), number(flips.map(|flips| flips.gained)));
        offsets.push(vec![
            offset.clone(),
            share,
            lost,
            gained,
            at.verdict.in_words().to_owned(),
            at.changes.join("; "),
            reason,
        ]);
        all.extend(
            spread(&at.quantities).into_iter().map(|row| [vec![offset.clone()], row].concat()),
        );
        one.extend(at.selected.iter().map(|one| {
            vec![
                offset.clone(),
                one.id.clone(),
                one.name.to_string(),
                one.scope.to_string(),
                number(one.normalised),
                one.holds.to_string(),
            ]
        }));
    }
    let estimates = found
        .estimates
        .iter()
        .map(|one| {
            let mut row = vec![one.section.clone(), one.zone.clone().unwrap_or_default()];
            row.extend([one.shift, one.low, one.high, one.correlation].map(number));
            row
        })
        .collect();
    let head = [&["offset"][..], &SPREAD[..]].concat();
    Ok(vec![
        csv_file(
            "offsets",
            &[
                "offset",
                "share validated",
                "share no longer validated",
                "share newly validated",
                "verdict on all sections",
                "changes",
                "reason",
            ],
            offsets,
        )?,
        csv_file("spread", &head, all)?,
        csv_file(
            "one_selection",
            &["offset", "quantity", "statistic", "scope", "normalised", "holds"],
            one,
        )?,
        csv_file(
            "estimates",
            &["section", "zone", "offset", "low 95 %", "high 95 %", "correlation"],
            estimates,
        )?,
    ])
}

fn parameters(found: &ParameterStudy) -> Result<Tables, csv::Error> {
    let (mut values, mut statistics) = (Vec::new(), Vec::new());
    for parameter in &found.parameters {
        for at in &parameter.values {
            values.push(value(&parameter.name, at));
            statistics.extend(at.statistics.iter().map(|one| {
                vec![
                    parameter.name.clone(),
                    at.value.clone(),
                    one.id.clone(),
                    one.name.to_string(),
                    one.scope.to_string(),
                    number(one.normalised),
                    one.holds.to_string(),
                ]
            }));
        }
    }
    Ok(vec![
        csv_file(
            "parameters",
            &[
                "parameter",
                "value",
                "as it is",
                "verdict",
                "largest statistic",
                "normalised",
                "share validated",
                "reason",
            ],
            values,
        )?,
        csv_file(
            "statistics",
            &["parameter", "value", "quantity", "statistic", "scope", "normalised", "holds"],
            statistics,
        )?,
    ])
}

fn value(name: &str, at: &AtValue) -> Row {
    vec![
        name.to_owned(),
        at.value.clone(),
        at.is_base.to_string(),
        at.verdict.in_words().to_owned(),
        at.largest.as_ref().map_or_else(String::new, |largest| largest.statistic.clone()),
        number(at.largest.as_ref().map(|largest| largest.normalised)),
        number(at.share),
        at.reason.clone().unwrap_or_default(),
    ]
}
