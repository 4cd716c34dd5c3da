//! `results.json`: the result in machine-readable form; fixed order of keys, full precision, `null`
//! with a reason.

use serde_json::{Map, Value, json};

use super::{attached, estimates};
use crate::result::{
    CampaignInfo, Certification, ProtocolFile, ProtocolInfo, QuantityResult, Reported,
    StatisticResult, ZoneResult, report,
};

/// The complete result, ending in a line break.
pub fn results(found: &Certification) -> String {
    let mut root = Map::new();
    root.insert("fishplate".into(), json!(env!("CARGO_PKG_VERSION")));
    root.insert("protocol".into(), protocol(&found.protocol));
    root.insert("campaign".into(), campaign(&found.campaign));
    root.insert("verdict".into(), json!(found.verdict_words()));
    if let Some(word) = &found.own_word {
        root.insert("verdict_word".into(), json!(word));
    }
    root.insert("verdict_note".into(), json!(found.verdict_note));
    root.insert("reasons".into(), json!(found.reasons));
    if !found.verdicts.is_empty() {
        root.insert("verdicts".into(), json!(found.verdicts));
    }
    root.insert("quantities".into(), quantities(&found.quantities));
    root.insert(
        "sections".into(),
        Value::Array(found.sections.iter().map(|section| zone_as_number(json!(section))).collect()),
    );
    if !found.reported.is_empty() {
        root.insert("reported".into(), reported(&found.reported, "sections"));
    }
    if !found.found.is_empty() {
        root.insert("found_sections".into(), json!(found.found));
    }
    if let Some(reduction) = &found.reduction {
        root.insert("reduction".into(), json!(reduction));
    }
    root.insert("zones".into(), zones(&found.zones));
    root.insert("domain".into(), json!(found.domain));
    if !found.application.is_empty() {
        root.insert("application".into(), json!(found.application));
    }
    root.insert("findings".into(), json!(found.findings));
    root.insert("notes".into(), json!(found.notes));
    text(&Value::Object(root))
}

fn campaign(campaign: &CampaignInfo) -> Value {
    let mut entry = Map::new();
    entry.insert("name".into(), json!(campaign.name));
    if !campaign.members.is_empty() {
        entry.insert("members".into(), json!(campaign.members));
    }
    entry.insert("files".into(), json!(campaign.files));
    entry.insert("vehicle".into(), json!(campaign.vehicle));
    entry.insert("origin".into(), json!(campaign.origin));
    entry.insert("report".into(), report::tree(&campaign.report));
    Value::Object(entry)
}

/// A value in the format of the results, ending in a line break.
pub fn text(value: &Value) -> String {
    // Serialisation of plain values cannot fail.
    serde_json::to_string_pretty(value).unwrap_or_default() + "\n"
}

/// The zones of the results.
pub fn zones(zones: &[ZoneResult]) -> Value {
    Value::Array(zones.iter().map(|zone| zone_as_number(json!(zone))).collect())
}

/// The protocol of the results.
pub fn protocol(protocol: &ProtocolInfo) -> Value {
    let file = |(at, file): (usize, &ProtocolFile)| json!({"name": file.name, "sha256": file.sha256, "attached": attached::protocol_name(at, &file.name)});
    json!({
        "name": protocol.name,
        "title": protocol.title,
        "sha256": protocol.sha256,
        "parameters": protocol.parameters,
        "deviations": protocol.deviations,
        "files": protocol.files.iter().enumerate().map(file).collect::<Vec<_>>(),
    })
}

/// The quantities of the results.
pub fn quantities(quantities: &[QuantityResult]) -> Value {
    Value::Array(quantities.iter().map(quantity).collect())
}

fn quantity(quantity: &QuantityResult) -> Value {
    let mut entry = Map::new();
    entry.insert("id".into(), json!(quantity.id));
    entry.insert("title".into(), json!(quantity.title));
    entry.insert("unit".into(), json!(quantity.unit));
    entry.insert("pairs".into(), json!(quantity.values.len()));
    entry.insert("n".into(), json!(quantity.n));
    let named = |name: &str| {
        quantity
            .statistics
            .iter()
            .find(|statistic| statistic.name == name && statistic.scope == "all")
    };
    let (mean, std) = (named("mean"), named("std"));
    if quantity.has_sides && (mean.is_some() || std.is_some()) {
        let value = |of: Option<&StatisticResult>| json!(of.and_then(|statistic| statistic.value));
        let limit = |of: Option<&StatisticResult>| json!(of.and_then(|statistic| statistic.limit));
        let share =
            |of: Option<&StatisticResult>| json!(of.and_then(|statistic| statistic.normalised));
        entry.insert("mean".into(), value(mean));
        entry.insert("std".into(), value(std));
        entry.insert("limit_mean".into(), limit(mean));
        entry.insert("limit_std".into(), limit(std));
        entry.insert("normalised_mean".into(), share(mean));
        entry.insert("normalised_std".into(), share(std));
    } else {
        // The statistic closest to its limit represents the quantity; all statistics follow.
        let worst = quantity
            .statistics
            .iter()
            .max_by(|a, b| a.normalised.unwrap_or(-1.0).total_cmp(&b.normalised.unwrap_or(-1.0)));
        match &quantity.from {
            Some(side) => entry.insert("assessed".into(), json!(side)),
            None => entry.insert("metric".into(), json!(quantity.comparison)),
        };
        entry.insert("statistic".into(), json!(worst.map(|statistic| statistic.name.as_str())));
        entry.insert("value".into(), json!(worst.and_then(|statistic| statistic.value)));
        entry.insert("limit".into(), json!(worst.and_then(|statistic| statistic.limit)));
    }
    entry.insert("holds".into(), json!(quantity.holds));
    entry.insert("reason".into(), json!(quantity.reason));
    entry.insert("rule".into(), json!(quantity.rule));
    entry.insert("statistics".into(), json!(quantity.statistics));
    if quantity.from.is_some() {
        entry
            .insert("groups".into(), Value::Array(quantity.statistics.iter().map(group).collect()));
    }
    if !quantity.reported.is_empty() {
        entry.insert("reported".into(), reported(&quantity.reported, "values"));
    }
    let values = quantity.values.iter().map(|pair| {
        let mut row = Map::new();
        if pair.campaign.is_some() {
            row.insert("campaign".into(), json!(pair.campaign));
        }
        row.insert("section".into(), json!(pair.section));
        row.insert("zone".into(), json!(pair.zone));
        row.insert("signal".into(), json!(pair.signal));
        if pair.taken.is_some() {
            row.insert("taken".into(), json!(pair.taken));
        }
        if pair.record.is_some() {
            row.insert("record".into(), json!(pair.record));
        }
        if quantity.has_sides {
            row.insert("simulated".into(), json!(pair.simulated));
            row.insert("measured".into(), json!(pair.measured));
            row.insert("difference".into(), json!(pair.difference));
        } else {
            row.insert("value".into(), json!(pair.difference));
        }
        row.insert("samples".into(), json!(pair.samples));
        zone_as_number(Value::Object(row))
    });
    entry.insert("values".into(), Value::Array(values.collect()));
    Value::Object(entry)
}

/// One estimate of one group of an assessed quantity.
fn group(one: &StatisticResult) -> Value {
    let keys: Map<String, Value> = match (one.group.as_slice(), estimates::zones(one).as_slice()) {
        ([], [zone]) => Map::from_iter([("zone".to_owned(), json!(zone))]),
        (keys, _) => keys.iter().map(|(key, member)| (key.clone(), json!(member))).collect(),
    };
    let regression = one.regression.as_ref().map(|found| {
        json!({
            "regressor": found.regressor, "unit": found.regressor_unit, "intercept": found.intercept, "slope": found.slope,
            "target": found.target,
        })
    });
    let mut entry = Map::new();
    entry.insert("keys".into(), Value::Object(keys));
    entry.insert("estimate".into(), json!(one.name));
    entry.insert("values".into(), json!(one.count));
    entry.insert("n".into(), json!(one.n));
    entry.insert("mean".into(), json!(one.sample.mean));
    entry.insert("std".into(), json!(one.sample.std));
    entry.insert("value".into(), json!(one.value));
    entry.insert("low".into(), json!(one.interval.map(|(low, _)| low)));
    entry.insert("high".into(), json!(one.interval.map(|(_, high)| high)));
    entry.insert("limit".into(), json!(one.limit));
    entry.insert("ratio".into(), json!(one.normalised));
    entry.insert("holds".into(), json!(one.holds));
    entry.insert("reason".into(), json!(one.reason));
    if let Some(regression) = regression {
        entry.insert("regression".into(), regression);
    }
    Value::Object(entry)
}

/// Estimates without a limit; `of` is what is counted.
fn reported(all: &[Reported], of: &str) -> Value {
    let one = |one: &Reported| {
        let mut entry = Map::new();
        entry.insert(
            "keys".into(),
            one.group.iter().map(|(key, member)| (key.clone(), json!(member))).collect(),
        );
        entry.insert("where".into(), json!(one.condition));
        entry.insert("estimate".into(), json!(one.name));
        entry.insert("title".into(), json!(one.title));
        entry.insert("scope".into(), json!(one.scope));
        entry.insert(of.into(), json!(one.count));
        entry.insert("n".into(), json!(one.n));
        entry.insert("unit".into(), json!(one.unit));
        entry.insert("value".into(), json!(one.value));
        entry.insert("low".into(), json!(one.interval.map(|(low, _)| low)));
        entry.insert("high".into(), json!(one.interval.map(|(_, high)| high)));
        entry.insert("reason".into(), json!(one.reason));
        entry.insert("rule".into(), json!(one.rule));
        Value::Object(entry)
    };
    Value::Array(all.iter().map(one).collect())
}

/// Writes the name of a zone as a number if it is an integer.
fn zone_as_number(mut entry: Value) -> Value {
    if let Some(zone) = entry.get_mut("zone")
        && let Some(number) = zone
            .as_str()
            .and_then(|zone| zone.parse::<i64>().ok().filter(|number| number.to_string() == zone))
    {
        *zone = json!(number);
    }
    entry
}
