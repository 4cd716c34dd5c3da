//! All tables of the report as CSV, in full precision.

use crate::report::document::{Cell, cells};
use crate::result::{
    Certification, ClassSpread, CoordinateRange, DomainResult, OfRecord, QuantityResult, Reported,
    SectionResult, WantedPoint,
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

fn reported_row(quantity: Option<&QuantityResult>, one: &Reported) -> Vec<Cell> {
    cells![
        quantity.map(|quantity| quantity.id.clone()),
        one.name,
        one.title,
        one.scope,
        one.condition,
        one.count.number(),
        one.n,
        one.unit,
        one.value,
        one.low,
        one.high,
        one.reason
    ]
}

/// Rows that are made while they are written.
type Rows<'a> = dyn Iterator<Item = Vec<Cell>> + 'a;

/// File names and contents for the folder `tables/`.
///
/// # Errors
/// An error of the CSV writer, which writes to memory.
pub fn tables(found: &Certification) -> Result<Vec<(String, Vec<u8>)>, csv::Error> {
    let mut all = Vec::new();
    let mut add = |name: &str, header: &[&str], rows: &mut Rows<'_>| -> Result<(), csv::Error> {
        all.push(csv_file(name, header, rows)?);
        Ok(())
    };
    let mut statistics = found.quantities.iter().flat_map(|quantity| {
        quantity.statistics.iter().map(|s| {
            cells![
                quantity.id,
                quantity.title,
                quantity.filter,
                quantity.processing,
                s.name,
                s.scope,
                s.count,
                s.n,
                s.unit,
                s.value,
                s.interval.map(|(low, _)| low),
                s.interval.map(|(_, high)| high),
                s.limit,
                s.normalised,
                s.holds,
                s.marginal,
                s.reason
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
        &mut statistics,
    )?;
    let all_reported = found.reported.iter().map(|one| (None, one));
    let all_reported = all_reported.chain(
        found.quantities.iter().flat_map(|of| of.reported.iter().map(move |one| (Some(of), one))),
    );
    let mut rows = all_reported.map(|(quantity, one)| reported_row(quantity, one)).peekable();
    if rows.peek().is_some() {
        add("reported", &REPORTED, &mut rows)?;
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
    let of = |campaign: &Option<String>| pooled.then(|| campaign.into());
    let mut pairs = found.quantities.iter().flat_map(|quantity| {
        quantity.values.iter().map(move |pair| {
            let campaign = of(&pair.campaign);
            let row = cells![
                quantity.id,
                quantity.unit,
                pair.section,
                pair.zone,
                pair.signal,
                pair.record,
                pair.simulated,
                pair.measured,
                quantity.has_sides.then_some(pair.difference),
                (!quantity.has_sides).then_some(pair.difference),
                pair.samples
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
    add("values", &header(&columns, 2), &mut pairs)?;
    if found.quantities.iter().any(|quantity| quantity.spread.is_some()) {
        add("spreads", &SPREADS, &mut spreads(found, of_records))?;
        add("spreads_between", &SPREADS_BETWEEN, &mut spreads(found, between))?;
    }
    add("sections", &section_header(found), &mut found.sections.iter().map(section_row))?;
    let mut checks = found.sections.iter().flat_map(|section| {
        section
            .checks
            .iter()
            .map(|check| cells![section.section, check.title, check.holds, check.says])
    });
    add("checks", &["section", "requirement", "holds", "found"], &mut checks)?;
    let mut findings = found.findings.iter().map(|finding| {
        let row = cells![
            finding.code,
            finding.section,
            finding.record,
            finding.channel,
            finding.value,
            finding.expected,
            finding.unit,
            String::from(finding.text()),
            finding.cause,
            finding.consequence.in_words()
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
        &mut findings,
    )?;
    let mut zones = found
        .zones
        .iter()
        .map(|z| cells![z.zone, z.title, z.condition, z.given, z.used, z.minimum, z.holds]);
    add("zones", &["zone", "title", "condition", "given", "used", "minimum", "holds"], &mut zones)?;
    if !found.found.is_empty() {
        let mut rows = found
            .found
            .iter()
            .flat_map(|found| found.runs.iter().map(move |run| (found, run)))
            .flat_map(|(found, run)| {
                run.stretches.iter().map(move |stretch| {
                    cells![
                        found.campaign,
                        run.run,
                        stretch.from,
                        stretch.to,
                        found.axis_unit,
                        stretch.places,
                        stretch.reason
                    ]
                })
            });
        add("rejected", &["campaign", "run", "from", "to", "unit", "places", "reason"], &mut rows)?;
    }
    if let Some(reduction) = &found.reduction {
        let kept = reduction
            .kept
            .iter()
            .flat_map(|(group, kept)| kept.iter().map(move |one| cells![group, one, true]));
        let left = reduction.left_out.iter().map(|one| cells![Cell::BLANK, one, false]);
        add("reduction", &["group", "section", "kept"], &mut kept.chain(left))?;
    }
    let mut domain =
        found.domain.iter().map(|d| cells![d.name, d.unit, d.scope, d.low, d.high, d.count]);
    add("domain", &["quantity", "unit", "scope", "low", "high", "sections"], &mut domain)?;
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
        add("application", &head, &mut found.application.iter().flat_map(application_rows))?;
    }
    let several = found.campaign.vehicle.iter().any(|item| item.of.is_some());
    let mut vehicle = found.campaign.vehicle.iter().chain(&found.campaign.facts).map(|item| {
        let row = cells![item.name, item.value, item.unit, item.unit_assumed, item.used];
        with(row, several.then(|| (&item.of).into()), 5)
    });
    let mut columns = vec!["name", "value", "unit", "unit assumed", "used by the protocol"];
    columns.extend(several.then_some("of"));
    add("vehicle", &columns, &mut vehicle)?;
    let mut parameters = found
        .protocol
        .parameters
        .iter()
        .map(|p| cells![p.name, p.title, p.value, p.default, p.set_by]);
    add("parameters", &["parameter", "title", "value", "default", "set by"], &mut parameters)?;
    let mut deviations =
        found.protocol.deviations.iter().map(|d| cells![d.rule, d.before, d.after]);
    add("deviations", &["rule", "parent", "this protocol"], &mut deviations)?;
    let mut files =
        found.campaign.files.iter().map(|file| cells![file.path, file.bytes, file.sha256]);
    add("files", &["file", "bytes", "sha256"], &mut files)?;
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
    rows: impl Fn(&ClassSpread) -> Vec<Vec<Cell>>,
) -> impl Iterator<Item = Vec<Cell>> {
    let of_quantity = move |quantity: &QuantityResult| -> Vec<Vec<Cell>> {
        let Some(spread) = &quantity.spread else { return Vec::new() };
        let of_class = |class: &ClassSpread| {
            let of = cells![quantity.id, quantity.unit, spread.center, class.zone];
            rows(class).into_iter().map(move |row| [of.clone(), row].concat())
        };
        spread.classes.iter().flat_map(of_class).collect()
    };
    found.quantities.iter().flat_map(of_quantity)
}

fn of_records(class: &ClassSpread) -> Vec<Vec<Cell>> {
    let row = |one: &OfRecord| {
        cells![
            one.record,
            one.values,
            one.mean,
            one.std,
            one.largest.value,
            one.largest.section,
            one.largest.signal,
            one.rms,
            one.rank
        ]
    };
    class.records.iter().map(row).collect()
}

fn between(class: &ClassSpread) -> Vec<Vec<Cell>> {
    let numbers = [
        class.range_of_means,
        class.std_of_means,
        class.mean_range,
        class.mean_std,
        class.widest.value,
    ];
    let mut row = cells![class.records.len(), class.places];
    row.extend(numbers.map(Cell::from));
    row.extend(cells![class.widest.section, class.widest.signal]);
    vec![row]
}

/// A row with one more cell, if there is one.
fn with(mut row: Vec<Cell>, cell: Option<Cell>, at: usize) -> Vec<Cell> {
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
    rows: impl IntoIterator<Item = Vec<Cell>>,
) -> Result<(String, Vec<u8>), csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header)?;
    for row in rows {
        writer.write_record(row.iter().map(|cell| inert(&cell.in_file()).into_owned()))?;
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

fn section_row(section: &SectionResult) -> Vec<Cell> {
    let mut row = cells![
        section.section,
        section.zone,
        section.start,
        section.end,
        section.length,
        section.axis_unit
    ];
    row.extend(section.columns.iter().map(|column| Cell::from(&column.value)));
    row.extend(cells![section.used, section.reason]);
    with(row, section.campaign.as_ref().map(Cell::from), 0)
}

/// One row for each point of wanted operation and coordinate.
fn application_rows(result: &DomainResult) -> Vec<Vec<Cell>> {
    let of_point = |point: &WantedPoint| {
        let at = |list: &Option<Vec<f64>>, at: usize| list.as_ref().map(|list| list[at]);
        let row = |(index, of): (usize, &CoordinateRange)| {
            cells![
                result.domain,
                result.scope,
                point.point,
                point.inside,
                point.distance,
                of.name,
                of.unit,
                point.values[index],
                at(&point.nearest, index),
                at(&point.outside_by, index),
                at(&point.beyond_range, index),
                point.nearest_section
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
        let (_, bytes) = csv_file("t", &["a"], [cells!["=1+1"]]).expect("written");
        assert_eq!(bytes, b"a\n'=1+1\n");
    }
}
