//! All tables of the report as CSV.

use crate::result::Certification;

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
                s.name.clone(),
                s.scope.clone(),
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
    let pairs = found.quantities.iter().flat_map(|quantity| {
        quantity.values.iter().map(|pair| {
            vec![
                quantity.id.clone(),
                quantity.unit.clone(),
                pair.section.clone(),
                pair.zone.clone().unwrap_or_default(),
                pair.signal.clone(),
                pair.record.clone().unwrap_or_default(),
                number(pair.simulated),
                number(pair.measured),
                number(quantity.has_sides.then_some(pair.difference)),
                number((!quantity.has_sides).then_some(pair.difference)),
                pair.samples.to_string(),
            ]
        })
    });
    let header = ["quantity", "unit", "section", "zone", "signal", "record", "simulated", "measured", "difference", "value", "samples"];
    add("values", &header, pairs.collect())?;
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
        vec![
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
        ]
    });
    add(
        "findings",
        &["rule", "section", "record", "channel", "value", "expected", "unit", "finding", "likely cause", "consequence"],
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
    add("zones", &["zone", "title", "condition", "given", "used", "minimum", "holds"], zones.collect())?;
    let domain = found
        .domain
        .iter()
        .map(|d| vec![d.name.clone(), d.unit.clone(), d.scope.clone(), number(Some(d.low)), number(Some(d.high)), d.count.to_string()]);
    add("domain", &["quantity", "unit", "scope", "low", "high", "sections"], domain.collect())?;
    let vehicle = found.campaign.vehicle.iter().chain(&found.campaign.facts).map(|item| {
        let unit = item.unit.clone().unwrap_or_default();
        vec![item.name.clone(), item.value.clone(), unit, item.unit_assumed.to_string(), item.used.to_string()]
    });
    add("vehicle", &["name", "value", "unit", "unit assumed", "used by the protocol"], vehicle.collect())?;
    let parameters = found
        .protocol
        .parameters
        .iter()
        .map(|p| vec![p.name.clone(), p.title.clone(), p.value.clone(), p.default.clone(), p.set_by.clone()]);
    add("parameters", &["parameter", "title", "value", "default", "set by"], parameters.collect())?;
    let deviations = found
        .protocol
        .deviations
        .iter()
        .map(|d| vec![d.rule.clone(), d.before.clone().unwrap_or_default(), d.after.clone().unwrap_or_default()]);
    add("deviations", &["rule", "parent", "this protocol"], deviations.collect())?;
    let files = found.campaign.files.iter().map(|file| vec![file.path.clone(), file.bytes.to_string(), file.sha256.clone()]);
    add("files", &["file", "bytes", "sha256"], files.collect())?;
    Ok(all)
}

/// A cell that a spreadsheet does not interpret as a formula: such text gets an apostrophe in front, the spreadsheets' own mark of text
/// (OWASP, CSV Injection).
fn inert(cell: &str) -> std::borrow::Cow<'_, str> {
    let formula = cell.starts_with(['=', '+', '-', '@', '\t', '\r', '\n']) && cell.parse::<f64>().is_err();
    if formula { format!("'{cell}").into() } else { cell.into() }
}

/// A table as a file.
///
/// # Errors
/// An error of the CSV writer, which writes to memory.
pub fn csv_file(name: &str, header: &[&str], rows: Vec<Vec<String>>) -> Result<(String, Vec<u8>), csv::Error> {
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
        row
    };
    found.sections.iter().map(row).collect()
}

/// Full precision; an empty cell for a missing number.
fn number(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| value.to_string())
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
