//! All tables of a study as CSV, in full precision.

use crate::report::document::{Cell, cells};
use crate::report::tables::csv_file;
use crate::result::study::{
    AtValue, Found, ParameterStudy, QuantitySpread, SelectionStudy, Study, SyncStudy,
};

type Row = Vec<Cell>;
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
            let mut row = cells![quantity.id, statistic.name, statistic.scope, statistic.limit];
            row.push(statistic.overall.into());
            match &statistic.spread {
                Some(spread) => {
                    row.extend(
                        [spread.min, spread.q1, spread.median, spread.q3, spread.max]
                            .map(Cell::from),
                    );
                    row.extend(cells![spread.outliers, spread.exact, spread.within]);
                    let ends = spread.intervals.all().into_iter();
                    row.extend(
                        ends.flat_map(|ends| {
                            cells![ends.map(|ends| ends.0), ends.map(|ends| ends.1)]
                        }),
                    );
                }
                None => row.extend(vec![Cell::BLANK; 14]),
            }
            row.push(statistic.failing.into());
            row
        })
        .collect()
}

fn sections(found: &SelectionStudy) -> Result<Tables, csv::Error> {
    let importance =
        found.sections.iter().map(|one| cells![one.section, one.zone, one.with, one.without]);
    let failing = found
        .quantities
        .iter()
        .map(|quantity| cells![quantity.id, quantity.failing, quantity.alone]);
    let worst = found.worst.iter().map(|one| {
        cells![one.quantity, one.title, one.scope, one.normalised, one.sections.join(" ")]
    });
    let removal = found
        .removal
        .iter()
        .flat_map(|removal| &removal.sets)
        .map(|set| cells![set.len(), set.join(" ")]);
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
        let kept = reduction
            .kept
            .iter()
            .flat_map(|(zone, kept)| kept.iter().map(move |section| cells![zone, section]));
        all.push(csv_file("kept", &["zone", "section"], kept)?);
    }
    Ok(all)
}

fn sync(found: &SyncStudy) -> Result<Tables, csv::Error> {
    let (mut offsets, mut all, mut one) = (Vec::new(), Vec::new(), Vec::new());
    for at in &found.offsets {
        let offset = at.offset.value();
        let share = at.selections.counted().ok().map(|counted| counted.share.share);
        let reason = at.selections.counted().err().cloned();
        let flips = at.flips.compared();
        let (lost, gained) = (flips.map(|flips| flips.lost), flips.map(|flips| flips.gained));
        offsets.push(cells![
            offset,
            share,
            lost,
            gained,
            at.verdict.in_words(),
            at.changes.join("; "),
            reason
        ]);
        if at.selections.counted().is_ok() {
            all.extend(
                spread(&at.quantities).into_iter().map(|row| [vec![offset.into()], row].concat()),
            );
        }
        one.extend(
            at.selected
                .iter()
                .map(|one| cells![offset, one.id, one.name, one.scope, one.normalised, one.holds]),
        );
    }
    let estimates = found.estimates.iter().map(|one| {
        let mut row = cells![one.section, one.zone];
        row.extend([one.shift, one.low, one.high, one.correlation].map(Cell::from));
        row
    });
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
                cells![
                    parameter.name,
                    at.value,
                    one.id,
                    one.name,
                    one.scope,
                    one.normalised,
                    one.holds
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
    cells![
        name,
        at.value,
        at.is_base,
        at.verdict.in_words(),
        at.largest.as_ref().map(|largest| largest.statistic.clone()),
        at.largest.as_ref().map(|largest| largest.normalised),
        at.share,
        at.reason
    ]
}
