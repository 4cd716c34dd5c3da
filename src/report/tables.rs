//! All tables of the report as CSV.

use crate::result::{
    Certification, ClassSpread, CoordinateRange, DomainResult, OfRecord, QuantityResult, Reported,
    WantedPoint,
};

/// Columns of estimates without a limit; the quantity is empty where they are of sections.
const REPORTED: [&str; 12] = [
    "quantity",
    "estimate",
    "title",
    "scope",
    "where",
    "count",
    "n",
    "unit",
    "value",
    "low 95 %",
    "high 95 %",
    "reason",
];

fn reported_row(quantity: Option<&QuantityResult>, one: &Reported) -> Vec<String> {
    vec![
        quantity.map_or_else(String::new, |quantity| quantity.id.clone()),
        one.name.to_string(),
        one.title.clone(),
        one.scope.to_string(),
        one.condition.clone().unwrap_or_default(),
        one.count.number().to_string(),
        one.n.to_string(),
        one.unit.clone(),
        number(one.value),
        number(one.low),
        number(one.high),
        one.reason.clone().unwrap_or_default(),
    ]
}

/// File names and contents for the folder `tables/`.
///
/// # Errors
/// An error of the CSV writer, which writes to memory.
pub fn tables(found: &Certification) -> Result<Vec<(String, Vec<u8>)>, csv::Error> {
    let mut all = Vec::new();
    let mut add = |name: &str, header: &[&str], rows: Vec<Vec<String>>| -> Result<(), csv::Error> {
        all.push(csv_file(name, header, rows)?);
        Ok(())
    };
    let statistics = found.quantities.iter().flat_map(|quantity| {
        quantity.statistics.iter().map(|s| {
            vec![
                quantity.id.clone(),
                quantity.title.clone(),
                quantity.filter.clone(),
                quantity.processing.clone(),
                s.name.to_string(),
                s.scope.to_string(),
                s.count.to_string(),
                s.n.to_string(),
                s.unit.clone(),
                number(s.value),
                number(s.interval.map(|(low, _)| low)),
                number(s.interval.map(|(_, high)| high)),
                number(s.limit),
                number(s.normalised),
                s.holds.map_or(String::new(), |holds| holds.to_string()),
                s.marginal.to_string(),
                s.reason.clone().unwrap_or_default(),
            ]
        })
    });
    add(
        "summary",
        &[
            "quantity",
            "title",
            "filter",
            "processing",
            "statistic",
            "scope",
            "pairs",
            "n",
            "unit",
            "value",
            "low 95 %",
            "high 95 %",
            "limit",
            "normalised",
            "holds",
            "marginal",
            "reason",
        ],
        statistics.collect(),
    )?;
    let all_reported = found.reported.iter().map(|one| (None, one));
    let all_reported = all_reported.chain(
        found.quantities.iter().flat_map(|of| of.reported.iter().map(move |one| (Some(of), one))),
    );
    let rows: Vec<Vec<String>> =
        all_reported.map(|(quantity, one)| reported_row(quantity, one)).collect();
    if !rows.is_empty() {
        add("reported", &REPORTED, rows)?;
    }
    // A column of its own says which of several campaigns a row is of.
    let pooled = !found.campaign.members.is_empty();
    let header = |all: &[&'static str], after: usize| {
        let mut all = all.to_vec();
        if pooled {
            all.insert(after, "campaign");
        }
        all
    };
    let of = |campaign: &Option<String>| pooled.then(|| campaign.clone().unwrap_or_default());
    let pairs = found.quantities.iter().flat_map(|quantity| {
        quantity.values.iter().map(move |pair| {
            let campaign = of(&pair.campaign);
            let row = vec![
                quantity.id.clone(),
                quantity.unit.clone(),
                pair.section.clone(),
                pair.zone.clone().unwrap_or_default(),
                pair.signal.clone(),
                pair.record.as_ref().map(ToString::to_string).unwrap_or_default(),
                number(pair.simulated),
                number(pair.measured),
                number(quantity.has_sides.then_some(pair.difference)),
                number((!quantity.has_sides).then_some(pair.difference)),
                pair.samples.to_string(),
            ];
            with(row, campaign, 2)
        })
    });
    let columns = [
        "quantity",
        "unit",
        "section",
        "zone",
        "signal",
        "record",
        "simulated",
        "measured",
        "difference",
        "value",
        "samples",
    ];
    add("values", &header(&columns, 2), pairs.collect())?;
    if found.quantities.iter().any(|quantity| quantity.spread.is_some()) {
        add("spreads", &SPREADS, spreads(found, of_records))?;
        add("spreads_between", &SPREADS_BETWEEN, spreads(found, between))?;
    }
    add("sections", &section_header(found), section_rows(found))?;
    let checks = found.sections.iter().flat_map(|section| {
        section.checks.iter().map(|check| {
            vec![
                section.section.clone(),
                check.title.clone(),
                check.holds.map_or(String::new(), |holds| holds.to_string()),
                check.says.clone(),
            ]
        })
    });
    add("checks", &["section", "requirement", "holds", "found"], checks.collect())?;
    let findings = found.findings.iter().map(|finding| {
        let row = vec![
            finding.code.clone(),
            finding.section.clone().unwrap_or_default(),
            finding.record.clone().unwrap_or_default(),
            finding.channel.clone().unwrap_or_default(),
            number(finding.value),
            number(finding.expected),
            finding.unit.clone().unwrap_or_default(),
            finding.says.clone(),
            finding.cause.clone().unwrap_or_default(),
            finding.consequence.in_words().into(),
        ];
        with(row, of(&finding.campaign), 1)
    });
    add(
        "findings",
        &header(
            &[
                "rule",
                "section",
                "record",
                "channel",
                "value",
                "expected",
                "unit",
                "finding",
                "likely cause",
                "consequence",
            ],
            1,
        ),
        findings.collect(),
    )?;
    let zones = found.zones.iter().map(|z| {
        vec![
            z.zone.clone(),
            z.title.clone(),
            z.condition.clone(),
            z.given.to_string(),
            z.used.to_string(),
            z.minimum.to_string(),
            z.holds.to_string(),
        ]
    });
    add(
        "zones",
        &["zone", "title", "condition", "given", "used", "minimum", "holds"],
        zones.collect(),
    )?;
    if !found.found.is_empty() {
        let rows = found
            .found
            .iter()
            .flat_map(|found| found.runs.iter().map(move |run| (found, run)))
            .flat_map(|(found, run)| {
                run.stretches.iter().map(move |stretch| {
                    let of = found.campaign.clone().unwrap_or_default();
                    let ends = [stretch.from, stretch.to].map(|x| number(Some(x)));
                    let [from, to] = ends;
                    vec![
                        of,
                        run.run.clone(),
                        from,
                        to,
                        found.axis_unit.clone(),
                        stretch.places.to_string(),
                        stretch.reason.clone(),
                    ]
                })
            });
        add(
            "rejected",
            &["campaign", "run", "from", "to", "unit", "places", "reason"],
            rows.collect(),
        )?;
    }
    if let Some(reduction) = &found.reduction {
        let kept = reduction.kept.iter().flat_map(|(group, kept)| {
            kept.iter().map(move |one| vec![group.clone(), one.clone(), "true".into()])
        });
        let left =
            reduction.left_out.iter().map(|one| vec![String::new(), one.clone(), "false".into()]);
        add("reduction", &["group", "section", "kept"], kept.chain(left).collect())?;
    }
    let domain = found.domain.iter().map(|d| {
        vec![
            d.name.clone(),
            d.unit.clone(),
            d.scope.to_string(),
            number(Some(d.low)),
            number(Some(d.high)),
            d.count.to_string(),
        ]
    });
    add("domain", &["quantity", "unit", "scope", "low", "high", "sections"], domain.collect())?;
    if !found.application.is_empty() {
        let head = [
            "domain",
            "scope",
            "point",
            "inside",
            "distance",
            "coordinate",
            "unit",
            "value",
            "nearest",
            "outside by",
            "beyond range",
            "nearest section",
        ];
        add("application", &head, found.application.iter().flat_map(application_rows).collect())?;
    }
    let several = found.campaign.vehicle.iter().any(|item| item.of.is_some());
    let vehicle = found.campaign.vehicle.iter().chain(&found.campaign.facts).map(|item| {
        let unit = item.unit.clone().unwrap_or_default();
        let row = vec![
            item.name.clone(),
            item.value.clone(),
            unit,
            item.unit_assumed.to_string(),
            item.used.to_string(),
        ];
        with(row, several.then(|| item.of.clone().unwrap_or_default()), 5)
    });
    let mut columns = vec!["name", "value", "unit", "unit assumed", "used by the protocol"];
    columns.extend(several.then_some("of"));
    add("vehicle", &columns, vehicle.collect())?;
    let parameters = found.protocol.parameters.iter().map(|p| {
        vec![p.name.clone(), p.title.clone(), p.value.clone(), p.default.clone(), p.set_by.clone()]
    });
    add("parameters", &["parameter", "title", "value", "default", "set by"], parameters.collect())?;
    let deviations = found.protocol.deviations.iter().map(|d| {
        vec![
            d.rule.clone(),
            d.before.clone().unwrap_or_default(),
            d.after.clone().unwrap_or_default(),
        ]
    });
    add("deviations", &["rule", "parent", "this protocol"], deviations.collect())?;
    let files = found
        .campaign
        .files
        .iter()
        .map(|file| vec![file.path.clone(), file.bytes.to_string(), file.sha256.clone()]);
    add("files", &["file", "bytes", "sha256"], files.collect())?;
    Ok(all)
}

const SPREADS: [&str; 13] = [
    "quantity",
    "unit",
    "center",
    "zone",
    "record",
    "values",
    "mean deviation",
    "standard deviation",
    "largest deviation",
    "section",
    "signal",
    "root mean square",
    "rank",
];

const SPREADS_BETWEEN: [&str; 13] = [
    "quantity",
    "unit",
    "center",
    "zone",
    "records",
    "places",
    "range of means",
    "std of means",
    "mean range",
    "mean std",
    "largest range",
    "section",
    "signal",
];

/// Rows for each quantity with several records and each class of sections, after what these are.
fn spreads(
    found: &Certification,
    rows: impl Fn(&ClassSpread) -> Vec<Vec<String>>,
) -> Vec<Vec<String>> {
    let of_quantity = |quantity: &QuantityResult| -> Vec<Vec<String>> {
        let Some(spread) = &quantity.spread else { return Vec::new() };
        let of_class = |class: &ClassSpread| {
            let of = [
                quantity.id.clone(),
                quantity.unit.clone(),
                spread.center.clone(),
                class.zone.clone().unwrap_or_default(),
            ];
            rows(class).into_iter().map(move |row| [of.to_vec(), row].concat())
        };
        spread.classes.iter().flat_map(of_class).collect()
    };
    found.quantities.iter().flat_map(of_quantity).collect()
}

fn of_records(class: &ClassSpread) -> Vec<Vec<String>> {
    let row = |one: &OfRecord| {
        vec![
            one.record.clone(),
            one.values.to_string(),
            one.mean.to_string(),
            number(one.std),
            one.largest.value.to_string(),
            one.largest.section.clone(),
            one.largest.signal.clone(),
            one.rms.to_string(),
            one.rank.to_string(),
        ]
    };
    class.records.iter().map(row).collect()
}

fn between(class: &ClassSpread) -> Vec<Vec<String>> {
    let numbers = [
        class.range_of_means,
        class.std_of_means,
        class.mean_range,
        class.mean_std,
        class.widest.value,
    ];
    let mut row = vec![class.records.len().to_string(), class.places.to_string()];
    row.extend(numbers.map(|value| value.to_string()));
    row.extend([class.widest.section.clone(), class.widest.signal.clone()]);
    vec![row]
}

/// A row with one more cell, if there is one.
fn with(mut row: Vec<String>, cell: Option<String>, at: usize) -> Vec<String> {
    if let Some(cell) = cell {
        row.insert(at, cell);
    }
    row
}

/// A cell that a spreadsheet does not interpret as a formula: such text gets an apostrophe in
/// front, the spreadsheets' own mark of text (OWASP, CSV Injection).
fn inert(cell: &str) -> std::borrow::Cow<'_, str> {
    let formula =
        cell.starts_with(['=', '+', '-', '@', '\t', '\r', '\n']) && cell.parse::<f64>().is_err();
    if formula { format!("'{cell}").into() } else { cell.into() }
}

/// A table as a file.
///
/// # Errors
/// An error of the CSV writer, which writes to memory.
pub fn csv_file(
    name: &str,
    header: &[&str],
    rows: Vec<Vec<String>>,
) -> Result<(String, Vec<u8>), csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header)?;
    for row in rows {
        writer.write_record(row.iter().map(|cell| inert(cell).into_owned()))?;
    }
    let bytes = writer.into_inner().map_err(|error| error.into_error())?;
    Ok((format!("{name}.csv"), bytes))
}

fn section_header(found: &Certification) -> Vec<&str> {
    let mut header = vec!["section", "zone", "start", "end", "length", "unit"];
    if let Some(first) = found.sections.first() {
        header.extend(first.columns.iter().map(|column| column.name.as_str()));
    }
    header.extend(["used", "reason"]);
    if !found.campaign.members.is_empty() {
        header.insert(0, "campaign");
    }
    header
}

fn section_rows(found: &Certification) -> Vec<Vec<String>> {
    let row = |section: &crate::result::SectionResult| {
        let mut row = vec![
            section.section.clone(),
            section.zone.clone().unwrap_or_default(),
            number(Some(section.start)),
            number(Some(section.end)),
            number(Some(section.length)),
            section.axis_unit.clone(),
        ];
        row.extend(section.columns.iter().map(|column| column.value.clone()));
        row.extend([section.used.to_string(), section.reason.clone().unwrap_or_default()]);
        with(row, section.campaign.clone(), 0)
    };
    found.sections.iter().map(row).collect()
}

/// Full precision; an empty cell for a missing number.
fn number(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}

/// One row for each point of wanted operation and coordinate.
fn application_rows(result: &DomainResult) -> Vec<Vec<String>> {
    let of_point = |point: &WantedPoint| {
        let at = |list: &Option<Vec<f64>>, at: usize| number(list.as_ref().map(|list| list[at]));
        let row = |(index, of): (usize, &CoordinateRange)| {
            vec![
                result.domain.clone(),
                result.scope.clone(),
                point.point.clone(),
                point.inside.map_or(String::new(), |inside| inside.to_string()),
                number(point.distance),
                of.name.clone(),
                of.unit.clone(),
                number(Some(point.values[index])),
                at(&point.nearest, index),
                at(&point.outside_by, index),
                at(&point.beyond_range, index),
                point.nearest_section.clone().unwrap_or_default(),
            ]
        };
        result.coordinates.iter().enumerate().map(row).collect::<Vec<_>>()
    };
    result.points.iter().flat_map(of_point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_cell_is_a_formula() {
        for formula in ["=1+1", "+A1", "-A1", "@SUM(A1)", "\t=1", "\r=1", "-"] {
            assert_eq!(inert(formula), format!("'{formula}"));
        }
        for plain in ["", "-1.5", "+2", "-1e-3", "1+1", "Y_1R", "a=b"] {
            assert_eq!(inert(plain), plain);
        }
        let (_, bytes) = csv_file("t", &["a"], vec![vec!["=1+1".into()]]).expect("written");
        assert_eq!(bytes, b"a\n'=1+1\n");
    }
}
