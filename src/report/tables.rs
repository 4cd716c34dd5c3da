//! The lists of results as tables in CSV, in full precision: a row for each entry, and a column for
//! each of some keys of its JSON.

use serde::Serialize;
use serde_json::{Value, json};

use crate::result::{
    Certification, ClassSpread, DomainResult, QuantityResult, Reported,
    comparison::{Comparison, Sensitivity},
    impact::{Flip, Impact},
    margin::MarginStudy,
    study::{
        AtOffset, ParameterStudy, QuantitySpread, SelectionStudy, Study, StudyResult, SyncStudy,
    },
};

/// File name and content.
type File = (String, Vec<u8>);

/// An entry of results with further keys, or with other values of its own.
#[derive(Serialize)]
struct Entry<T: Serialize> {
    #[serde(flatten)]
    of: T,
    #[serde(flatten)]
    more: Value,
}

/// The entries of a list, each with further keys.
fn entries<T: Serialize>(list: &[T], more: Value) -> impl Iterator<Item = Entry<&T>> {
    list.iter().map(move |of| Entry { of, more: more.clone() })
}

/// The title of each column, and where its values stand in an entry: `low 95 % = interval/0`. A
/// title alone is the key, with blanks for underscores.
fn columns(titles: &str) -> Vec<(&str, String)> {
    let column = |column| {
        let (title, key) = str::split_once(column, " = ").unwrap_or((column, column));
        (title, format!("/{}", key.replace(' ', "_")))
    };
    titles.split(", ").map(column).collect()
}

/// A table with these [`columns`].
fn table<T: Serialize>(
    name: &str,
    titles: &str,
    entries: impl IntoIterator<Item = T>,
) -> Result<File, csv::Error> {
    written(name, &columns(titles), entries)
}

fn written<T: Serialize>(
    name: &str,
    columns: &[(&str, String)],
    entries: impl IntoIterator<Item = T>,
) -> Result<File, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(columns.iter().map(|(title, _)| title))?;
    for entry in entries {
        // Serialisation of plain values cannot fail.
        let entry = serde_json::to_value(entry).unwrap_or_default();
        let cell = |(_, key): &(&str, String)| entry.pointer(key).map_or_else(String::new, cell);
        writer.write_record(columns.iter().map(cell))?;
    }
    let bytes = writer.into_inner().map_err(|error| error.into_error())?;
    Ok((format!("{name}.csv"), bytes))
}

/// Numbers without the exponent that JSON has; the entries of a list with `;` between them.
fn text(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Array(all) => all.iter().map(text).collect::<Vec<_>>().join("; "),
        Value::Number(number) if number.is_f64() => number.as_f64().unwrap_or_default().to_string(),
        other => other.to_string(),
    }
}

/// A value as a cell that a spreadsheet does not interpret as a formula: such text gets an
/// apostrophe in front, the spreadsheets' own mark of text (OWASP, CSV Injection).
fn cell(value: &Value) -> String {
    let text = text(value);
    let formula =
        text.starts_with(['=', '+', '-', '@', '\t', '\r', '\n']) && text.parse::<f64>().is_err();
    if formula { format!("'{text}") } else { text }
}

/// The tables of a certification.
///
/// # Errors
/// An error of the CSV writer, which writes to memory.
pub fn certification(found: &Certification) -> Result<Vec<File>, csv::Error> {
    // A column of its own says which of several campaigns a row is of.
    let campaign = if found.campaign.members.is_empty() { "" } else { "campaign, " };
    let mut files = of_quantities(&found.quantities, campaign)?;
    // Of sections, without a quantity.
    let of_sections = entries(&found.reported, json!({})).map(with_count);
    let of_quantities = found
        .quantities
        .iter()
        .flat_map(|of| entries(&of.reported, json!({"quantity": of.id})).map(with_count));
    let mut reported = of_sections.chain(of_quantities).peekable();
    if reported.peek().is_some() {
        let titles = "quantity, estimate, title, scope, where, count, n, unit, value, low 95 % = low, high 95 % = high, reason";
        files.insert(1, table("reported", titles, reported)?);
    }
    files.push(sections(found, campaign)?);
    let checks = found
        .sections
        .iter()
        .flat_map(|section| entries(&section.checks, json!({"section": section.section})));
    files.push(table("checks", "section, requirement = title, holds, found = says", checks)?);
    let titles = format!(
        "rule = code, explained by, {campaign}section, record, channel, value, expected, unit, finding = says, likely cause = cause, consequence, places"
    );
    let findings = found.findings.iter().flat_map(|first| {
        first.with_explained().map(move |of| {
            let by = (!std::ptr::eq(of, first)).then_some(&first.code);
            let (consequence, places) = (of.consequence.in_words(), super::findings::places(of));
            let more = json!({"explained by": by, "consequence": consequence, "places": places});
            Entry { of, more }
        })
    });
    files.push(table("findings", &titles, findings)?);
    let titles = "zone, title, condition, given, used, minimum, holds";
    files.push(table("zones", titles, &found.zones)?);
    if !found.found.is_empty() {
        let stretches = found.found.iter().flat_map(|of| {
            of.runs.iter().flat_map(move |run| {
                let of = json!({"campaign": of.campaign, "run": run.run, "unit": of.axis_unit});
                entries(&run.stretches, of)
            })
        });
        let titles = "campaign, run, from, to, unit, places, reason";
        files.push(table("rejected", titles, stretches)?);
    }
    if let Some(reduction) = &found.reduction {
        let row = |group: Option<&str>, section: &str| json!({"group": group, "section": section, "kept": group.is_some()});
        let kept = reduction
            .kept
            .iter()
            .flat_map(|(group, kept)| kept.iter().map(move |section| row(Some(group), section)));
        let left_out = reduction.left_out.iter().map(|section| row(None, section));
        files.push(table("reduction", "group, section, kept", kept.chain(left_out))?);
    }
    let titles = "quantity = name, unit, scope, low, high, sections = count";
    files.push(table("domain", titles, &found.domain)?);
    if !found.application.is_empty() {
        let titles = "domain, scope, point, inside, distance, coordinate, unit, value, nearest, outside by, beyond range, nearest section";
        files.push(table("application", titles, found.application.iter().flat_map(wanted))?);
    }
    let (vehicle, protocol) = (&found.campaign.vehicle, &found.protocol);
    let several = vehicle.iter().any(|item| item.of.is_some());
    let titles = "name, value, unit, unit assumed, used by the protocol = used".to_owned()
        + if several { ", of" } else { "" };
    files.push(table("vehicle", &titles, vehicle.iter().chain(&found.campaign.facts))?);
    let titles = "parameter = name, title, value, default, set by";
    files.push(table("parameters", titles, &protocol.parameters)?);
    let titles = "rule, parent = before, this protocol = after";
    files.push(table("deviations", titles, &protocol.deviations)?);
    files.push(table("files", "file = path, bytes, sha256", &found.campaign.files)?);
    Ok(files)
}

/// Of how many values or sections an estimate is.
fn with_count(of: Entry<&Reported>) -> Entry<Entry<&Reported>> {
    let more = json!({"count": of.of.count.number()});
    Entry { of, more }
}

/// Statistics, values and their spread.
fn of_quantities(all: &[QuantityResult], campaign: &str) -> Result<Vec<File>, csv::Error> {
    let statistics = all.iter().flat_map(|of| {
        let QuantityResult { id, title, filter, processing, .. } = of;
        let of_quantity =
            json!({"quantity": id, "title": title, "filter": filter, "processing": processing});
        entries(&of.statistics, of_quantity)
    });
    let values = all.iter().flat_map(|quantity| {
        let QuantityResult { id, unit, has_sides, .. } = quantity;
        quantity.values.iter().map(move |of| {
            // Those that are no differences stand in a column of their own.
            let [difference, value] =
                [*has_sides, !has_sides].map(|is| is.then_some(of.difference));
            let more =
                json!({"quantity": id, "unit": unit, "difference": difference, "value": value});
            Entry { of, more }
        })
    });
    let mut files = vec![
        table(
            "summary",
            "quantity, title, filter, processing, statistic = name, scope, pairs = count, n, unit, value, low 95 % = interval/0, high 95 % = interval/1, limit, direction, normalised, holds, marginal, reason, lower edge = edges/0/limit, upper edge = edges/1/limit",
            statistics,
        )?,
        table(
            "values",
            &format!(
                "quantity, unit, {campaign}section, zone, signal, record, simulated, measured, difference, value, samples"
            ),
            values,
        )?,
    ];
    let mut classes: Vec<Entry<&ClassSpread>> = Vec::new();
    for quantity in all {
        let QuantityResult { id, unit, spread, .. } = quantity;
        classes.extend(spread.iter().flat_map(|spread| {
            let of = json!({"quantity": id, "unit": unit, "center": spread.center});
            entries(&spread.classes, of)
        }));
    }
    if all.iter().any(|quantity| quantity.spread.is_some()) {
        let records = classes.iter().flat_map(|Entry { of, more }| {
            let more = json!({"class": more, "zone": of.zone});
            entries(&of.records, more)
        });
        let titles = "quantity = class/quantity, unit = class/unit, center = class/center, zone, record, values, mean deviation = mean, standard deviation = std, largest deviation = largest/value, section = largest/section, signal = largest/signal, root mean square = rms, rank";
        files.push(table("spreads", titles, records)?);
        let between = classes.iter().map(|of| {
            let more = json!({"records": of.of.records.len()});
            Entry { of, more }
        });
        let titles = "quantity, unit, center, zone, records, places, range of means, std of means, mean range, mean std, largest range = widest/value, section = widest/section, signal = widest/signal";
        files.push(table("spreads_between", titles, between)?);
    }
    Ok(files)
}

/// With the columns that the protocol declares.
fn sections(found: &Certification, campaign: &str) -> Result<File, csv::Error> {
    let titles = format!("{campaign}section, zone, start, end, length, unit = axis_unit");
    let own = found.sections.first().into_iter().flat_map(|section| &section.columns);
    let own = own.enumerate().map(|(at, item)| (&*item.name, format!("/columns/{at}/value")));
    let all: Vec<_> =
        columns(&titles).into_iter().chain(own).chain(columns("used, reason")).collect();
    written("sections", &all, &found.sections)
}

/// A row for each point of wanted operation and coordinate.
fn wanted(result: &DomainResult) -> impl Iterator<Item = impl Serialize> {
    result.points.iter().flat_map(move |of| {
        result.coordinates.iter().enumerate().map(move |(at, coordinate)| {
            let number = |list: &Option<Vec<f64>>| list.as_ref().map(|list| list[at]);
            let more = json!({
                "domain": result.domain, "scope": result.scope,
                "coordinate": coordinate.name, "unit": coordinate.unit, "value": of.values[at],
                "nearest": number(&of.nearest), "outside_by": number(&of.outside_by),
                "beyond_range": number(&of.beyond_range),
            });
            Entry { of, more }
        })
    })
}

/// The tables of a study.
///
/// # Errors
/// As [`certification`].
pub fn study(study: &Study) -> Result<Vec<File>, csv::Error> {
    match &study.found {
        StudyResult::Sections(found) => of_selections(found),
        StudyResult::Sync(found) => of_offsets(found),
        StudyResult::Parameters(found) => of_parameters(found),
        StudyResult::Margin(found) => of_margin(found),
    }
}

const SPREAD: &str = "quantity, statistic = name, scope, limit, all sections, min = normalised/min, q1 = normalised/q1, median = normalised/median, q3 = normalised/q3, max = normalised/max, outliers, exact = normalised/exact, quartiles within = normalised/quartiles_within, q1 low 95 % = normalised/q1_interval_95/0, q1 high 95 % = normalised/q1_interval_95/1, median low 95 % = normalised/median_interval_95/0, median high 95 % = normalised/median_interval_95/1, q3 low 95 % = normalised/q3_interval_95/0, q3 high 95 % = normalised/q3_interval_95/1, share failing";

fn spread(quantity: &QuantitySpread) -> impl Iterator<Item = impl Serialize> {
    quantity.statistics.iter().map(|of| {
        // A number of selections may exceed the integers that are exact.
        let outliers = of.spread.map(|spread| spread.outliers as f64);
        Entry { of, more: json!({"quantity": quantity.id, "outliers": outliers}) }
    })
}

fn of_selections(found: &SelectionStudy) -> Result<Vec<File>, csv::Error> {
    let worst = found.worst.iter().map(|of| {
        let more = json!({"sections": of.sections.join(" ")});
        Entry { of, more }
    });
    let removal = found.removal.iter().flat_map(|removal| &removal.sets);
    let removal =
        removal.map(|set| json!({"sections_removed": set.len(), "sections": set.join(" ")}));
    let mut files = vec![
        table("spread", SPREAD, found.quantities.iter().flat_map(spread))?,
        table(
            "importance",
            "section, zone, share validated with it = with, share validated without it = without",
            &found.sections,
        )?,
        table("failing", "quantity = id, share failing, share failing alone", &found.quantities)?,
        table("worst", "quantity, statistic = title, scope, normalised, sections", worst)?,
        table("removal", "sections removed, sections", removal)?,
    ];
    if let Some(reduction) = &found.reduction {
        let kept = reduction.kept.iter().flat_map(|(zone, kept)| {
            kept.iter().map(move |section| json!({"zone": zone, "section": section}))
        });
        files.push(table("kept", "zone, section", kept)?);
    }
    Ok(files)
}

fn of_offsets(found: &SyncStudy) -> Result<Vec<File>, csv::Error> {
    let offset = |at: &AtOffset| json!({"offset": at.offset.value()});
    let all = || found.offsets.iter();
    let offsets = all().map(|of| {
        let reason = of.selections.counted().err().map(|reason| reason.text());
        Entry { of, more: json!({"offset": of.offset.value(), "reason": reason}) }
    });
    let spreads = all().filter(|at| at.selections.counted().is_ok()).flat_map(|at| {
        let rows = at.quantities.iter().flat_map(spread);
        rows.map(move |of| Entry { of, more: offset(at) })
    });
    let selected = all().flat_map(|at| entries(&at.selected, offset(at)));
    Ok(vec![
        table(
            "offsets",
            "offset, share validated, share no longer validated = selections_changed/share_no_longer_validated, share newly validated = selections_changed/share_newly_validated, verdict on all sections = verdict_all_sections, changes = verdict_changes, reason",
            offsets,
        )?,
        table("spread", &format!("offset, {SPREAD}"), spreads)?,
        table(
            "one_selection",
            "offset, quantity = id, statistic, scope, normalised, holds",
            selected,
        )?,
        table(
            "estimates",
            "section, zone, offset = shift, low 95 % = low, high 95 % = high, correlation",
            &found.estimates,
        )?,
    ])
}

fn of_parameters(found: &ParameterStudy) -> Result<Vec<File>, csv::Error> {
    let all = || found.parameters.iter();
    let values = all()
        .flat_map(|parameter| entries(&parameter.values, json!({"parameter": parameter.name})));
    let statistics = all().flat_map(|parameter| {
        parameter.values.iter().flat_map(|at| {
            let of = json!({"parameter": parameter.name, "value": at.value});
            entries(&at.statistics, of)
        })
    });
    Ok(vec![
        table(
            "parameters",
            "parameter, value, as it is, verdict, largest statistic = largest/statistic, normalised = largest/normalised, share validated, reason",
            values,
        )?,
        table(
            "statistics",
            "parameter, value, quantity = id, statistic, scope, normalised, holds",
            statistics,
        )?,
    ])
}

fn of_margin(found: &MarginStudy) -> Result<Vec<File>, csv::Error> {
    let margins = found.margin.iter().map(|of| {
        let reason = of.reason.as_ref().map(|reason| reason.text());
        let more = json!({"flips_with": of.flips_with.join(" "), "columns": of.columns.join(" "), "reason": reason});
        Entry { of, more }
    });
    let mut files = vec![table(
        "margin",
        "change, of, low, high, unit, exact, verdict below = verdict_low, verdict above = verdict_high, searched from = searched/from, searched to = searched/to, step = searched/step, columns, as it is, flips with, tried, reason",
        margins,
    )?];
    if let Some(probability) = &found.probability {
        let drawn = probability
            .channels
            .iter()
            .map(|of| Entry { of, more: json!({"columns": of.columns.join(" ")}) });
        files.push(table(
            "uncertainties",
            "channel, of, standard, unit, correlated, columns",
            drawn,
        )?);
        files.push(table(
            "risks",
            "quantity, statistic, scope, unit, value, limit, standard uncertainty, risk of, risk, guard band, within guard band",
            &probability.limits,
        )?);
    }
    Ok(files)
}

/// The tables of a comparison.
///
/// # Errors
/// As [`certification`].
pub fn comparison(found: &Comparison) -> Result<Vec<File>, csv::Error> {
    Ok(vec![
        table(
            "verdicts",
            "campaign, protocol, verdict, holds, decided by, ratio, sections used, reasons",
            &found.verdicts,
        )?,
        table(
            "ratios",
            "campaign, protocol, metric, quantity, estimate, scope, unit, value, limit, ratio, holds, reason",
            &found.ratios,
        )?,
        table(
            "scores",
            "campaign, section, protocol, metric, score, shortfall, limited",
            &found.scores,
        )?,
        table(
            "agreement",
            "of, protocol, a, b, sections, both met = contingency/0/0, a only = contingency/0/1, b only = contingency/1/0, neither = contingency/1/1, spearman, reason",
            &found.agreement,
        )?,
        table(
            "sensitivity",
            "protocol, metric, disturbance, size, rms change, largest, verdicts changed, verdicts, reason",
            found.sensitivity.iter().flat_map(by_size),
        )?,
        table(
            "differences",
            "rule, difference = words, campaign, verdict before, verdict after, ratio before, ratio after, reason",
            &found.differences,
        )?,
    ])
}

/// The tables of what a change would have decided.
///
/// # Errors
/// As [`certification`].
pub fn impact(found: &Impact) -> Result<Vec<File>, csv::Error> {
    let of_flip = |of: &Flip| json!({"campaign": of.campaign});
    let minimal = found.flips.iter().flat_map(|of| {
        let set = |rules| json!({"campaign": of.campaign, "rules": rules, "exact": of.exact});
        of.minimal.iter().map(set)
    });
    let margins = found.flips.iter().flat_map(|of| entries(&of.margin, of_flip(of)));
    Ok(vec![
        table("rules", "rule, before, after, cannot be applied alone = reason", &found.rules)?,
        table("verdicts", "campaign = name, from, before, after, reasons", &found.archive)?,
        table("flips", "campaign, before, after, exact", &found.flips)?,
        table("minimal", "campaign, rules, exact", minimal)?,
        table("margins", "campaign, rule, changed, limit = value, flips at, unit", margins)?,
        table("near", "campaign, verdict, rule, limit = value, flips at, unit", &found.near)?,
        table("shares", "by, group, campaigns, before, after", &found.shares)?,
        table("not_replayed", "campaign, quantities, sections", &found.not_replayed)?,
    ])
}

/// A row for each size of a disturbance.
fn by_size(of: &Sensitivity) -> impl Iterator<Item = impl Serialize> {
    of.sizes.iter().enumerate().map(move |(at, size)| {
        let reason = of.reasons.get(at).and_then(Option::as_ref);
        let more = json!({
            "size": size, "rms_change": of.values.get(at), "largest": of.largest.get(at),
            "verdicts_changed": of.verdicts_changed.get(at),
            "reason": reason.map(|reason| reason.text()),
        });
        Entry { of, more }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_cell_is_a_formula() {
        for formula in ["=1+1", "+A1", "-A1", "@SUM(A1)", "\t=1", "\r=1", "-"] {
            assert_eq!(cell(&json!(formula)), format!("'{formula}"));
        }
        for plain in ["", "-1.5", "+2", "-1e-3", "1+1", "Y_1R", "a=b"] {
            assert_eq!(cell(&json!(plain)), plain);
        }
        let (_, bytes) = table("t", "a", [json!({"a": "=1+1"})]).expect("written");
        assert_eq!(bytes, b"a\n'=1+1\n");
    }

    #[test]
    fn a_column_has_a_key_and_numbers_are_exact() {
        let row = json!({"all_sections": 1e21, "interval": [-0.1, null], "n": 3, "in": true});
        let (_, bytes) =
            table("t", "all sections, low = interval/0, high = interval/1, n, in, of", [row])
                .expect("written");
        let text = "all sections,low,high,n,in,of\n1000000000000000000000,-0.1,,3,true,\n";
        assert_eq!(String::from_utf8_lossy(&bytes), text);
    }
}
