//! `study.json`: fixed order of keys, full precision, `null` with a reason.

use serde_json::{Map, Value, json};

use crate::result::study::{
    AtOffset, AtValue, Flips, Found, ParameterStudy, QuantitySpread, Selected, SelectionStudy,
    Spread, StatisticSpread, Study, SyncStudy,
};

/// The complete study, ending in a line break.
pub fn study(study: &Study) -> String {
    let mut root = Map::new();
    root.insert("fishplate".into(), json!(env!("CARGO_PKG_VERSION")));
    let kind = match &study.found {
        Found::Sections(_) => "sections",
        Found::Sync(_) => "sync",
        Found::Parameters(_) => "parameters",
    };
    root.insert("study".into(), json!(kind));
    let protocol = &study.protocol;
    root.insert(
        "protocol".into(),
        json!({"name": protocol.name, "title": protocol.title, "sha256": protocol.sha256, "parameters": protocol.parameters}),
    );
    let mut campaign = Map::from_iter([("name".to_string(), json!(study.campaign.name))]);
    if !study.campaign.members.is_empty() {
        campaign.insert("members".into(), json!(study.campaign.members));
    }
    campaign.insert("files".into(), json!(study.campaign.files));
    root.insert("campaign".into(), Value::Object(campaign));
    match &study.found {
        Found::Sections(found) => selections(&mut root, found),
        Found::Sync(found) => sync(&mut root, found),
        Found::Parameters(found) => parameters(&mut root, found),
    }
    root.insert("notes".into(), json!(study.notes));
    // Serialisation of plain values cannot fail.
    serde_json::to_string_pretty(&Value::Object(root)).unwrap_or_default() + "\n"
}

fn selections(root: &mut Map<String, Value>, found: &SelectionStudy) {
    shares(root, found);
    root.insert("verdict_all_sections".into(), json!(found.verdict));
    root.insert("quantities".into(), Value::Array(found.quantities.iter().map(quantity).collect()));
    let by_zone = |of: &dyn Fn(&crate::result::study::Stratum) -> usize| {
        Value::Object(
            found.strata.iter().map(|stratum| (stratum.zone.clone(), json!(of(stratum)))).collect(),
        )
    };
    root.insert("sections_per_zone".into(), by_zone(&|stratum| stratum.sections.len()));
    root.insert("taken_per_zone".into(), by_zone(&|stratum| stratum.take));
    root.insert("zones".into(), json!(found.strata));
    root.insert("sections".into(), json!(found.sections));
    root.insert("worst_selections".into(), json!(found.worst));
    root.insert("smallest_removal".into(), json!(found.removal));
    root.insert("reduction".into(), json!(found.reduction));
    root.insert("methods".into(), json!(found.methods));
}

/// Counts are integers as long as they are exact.
fn whole(count: f64) -> Value {
    if count < 9_007_199_254_740_992.0 { json!(count as u64) } else { json!(count) }
}

fn shares(root: &mut Map<String, Value>, found: &SelectionStudy) {
    let share = &found.share;
    root.insert("combinations".into(), whole(found.combinations));
    root.insert("validated".into(), if share.exact { json!(share.validated) } else { Value::Null });
    if !share.exact {
        root.insert("reason".into(), json!("not all selections were evaluated"));
    }
    root.insert("share_validated".into(), json!(share.share));
    root.insert("exact".into(), json!(share.exact));
    root.insert("interval_95".into(), json!(share.interval));
    root.insert("looked_at".into(), json!(share.looked_at));
    root.insert("validated_of_those".into(), json!(share.validated));
    root.insert("seed".into(), json!(share.seed));
}

fn quantity(quantity: &QuantitySpread) -> Value {
    let mut entry = Map::new();
    entry.insert("id".into(), json!(quantity.id));
    for name in ["mean", "std"] {
        let found = quantity
            .statistics
            .iter()
            .find(|statistic| statistic.name == name && statistic.scope == "all");
        entry.insert(
            name.into(),
            found.and_then(|statistic| statistic.spread.as_ref()).map_or(Value::Null, spread),
        );
    }
    entry.insert("share_failing".into(), json!(quantity.failing));
    entry.insert("share_failing_alone".into(), json!(quantity.alone));
    entry.insert(
        "statistics".into(),
        Value::Array(quantity.statistics.iter().map(statistic).collect()),
    );
    Value::Object(entry)
}

fn spread(spread: &Spread) -> Value {
    json!({
        "min": spread.min, "q1": spread.q1, "median": spread.median, "q3": spread.q3, "max": spread.max,
        "outliers": spread.outliers, "count": whole(spread.count), "exact": spread.exact, "quartiles_within": spread.within,
        "q1_interval_95": spread.intervals.map(|all| all[0]), "median_interval_95": spread.intervals.map(|all| all[1]),
        "q3_interval_95": spread.intervals.map(|all| all[2]),
    })
}

fn statistic(statistic: &StatisticSpread) -> Value {
    json!({
        "name": statistic.name, "title": statistic.title, "scope": statistic.scope, "limit": statistic.limit,
        "at_least": statistic.at_least, "all_sections": statistic.overall, "share_failing": statistic.failing,
        "normalised": statistic.spread.as_ref().map(spread),
        "reason": if statistic.spread.is_none() { json!("not defined for any selection") } else { Value::Null },
    })
}

fn flips(flips: &Flips) -> Value {
    json!({
        "compared": whole(flips.compared), "share_no_longer_validated": flips.lost, "share_newly_validated": flips.gained,
        "exact": flips.exact, "no_longer_interval_95": flips.lost_interval, "newly_interval_95": flips.gained_interval,
    })
}

fn selected(one: &Selected) -> Value {
    json!({"id": one.id, "statistic": one.name, "scope": one.scope, "normalised": one.normalised, "holds": one.holds})
}

fn sync(root: &mut Map<String, Value>, found: &SyncStudy) {
    let metres = found.axis_unit == "m";
    let at_offset = |at: &AtOffset| {
        let mut entry = Map::new();
        entry.insert((if metres { "offset_m" } else { "offset" }).into(), json!(at.offset));
        match &at.study {
            Ok(study) => shares(&mut entry, study),
            Err(reason) => {
                entry.insert("share_validated".into(), Value::Null);
                entry.insert("reason".into(), json!(reason));
            }
        }
        entry.insert("verdict_changes".into(), json!(at.changes));
        entry.insert(
            "selections_changed".into(),
            at.flips.as_ref().map_or_else(|reason| json!({"reason": reason}), flips),
        );
        entry.insert("verdict_all_sections".into(), json!(at.verdict));
        entry.insert("reasons".into(), json!(at.reasons));
        entry.insert(
            "one_selection".into(),
            Value::Array(at.selected.iter().map(selected).collect()),
        );
        let quantities = at
            .study
            .as_ref()
            .map_or_else(|_| Vec::new(), |study| study.quantities.iter().map(quantity).collect());
        entry.insert("quantities".into(), Value::Array(quantities));
        let lost =
            at.lost.iter().map(|(section, reason)| json!({"section": section, "reason": reason}));
        entry.insert("sections_lost".into(), Value::Array(lost.collect()));
        Value::Object(entry)
    };
    root.insert("axis_unit".into(), json!(found.axis_unit));
    root.insert("offsets".into(), Value::Array(found.offsets.iter().map(at_offset).collect()));
    root.insert("one_selection".into(), json!(found.selection));
    root.insert("estimated_offsets".into(), json!(found.estimates));
    root.insert("corrected".into(), json!(found.corrected));
}

fn parameters(root: &mut Map<String, Value>, found: &ParameterStudy) {
    let at_value = |at: &AtValue| {
        json!({
            "value": at.value, "as_it_is": at.is_base, "verdict": at.verdict, "reasons": at.reasons,
            "largest": at.largest.as_ref().map(|(which, value)| json!({"statistic": which, "normalised": value})),
            "combinations": whole(at.combinations), "share_validated": at.share.map(|share| share.share),
            "exact": at.share.map(|share| share.exact), "interval_95": at.share.and_then(|share| share.interval), "reason": at.reason,
            "statistics": at.statistics.iter().map(selected).collect::<Vec<_>>(),
        })
    };
    root.insert("as_it_is".into(), at_value(&found.base));
    let varied = found.parameters.iter().map(|parameter| {
        json!({
            "name": parameter.name, "title": parameter.title, "as_it_is": parameter.base, "decides": parameter.decides,
            "values": parameter.values.iter().map(at_value).collect::<Vec<_>>(),
        })
    });
    root.insert("parameters".into(), Value::Array(varied.collect()));
}
