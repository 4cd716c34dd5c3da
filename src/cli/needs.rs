//! The needs of a protocol as text, JSON and CSV.

use std::fmt::Write;

use serde_json::{Value, json};

use crate::check::plan::Plan;
use crate::data::write::table_csv;
use crate::run::needs::{ChannelNeed, DatumNeed, Needs, Users};

/// Columns of the CSV form.
const HEADER: [&str; 11] = [
    "kind",
    "record",
    "name",
    "channel",
    "title",
    "unit",
    "words",
    "range",
    "default",
    "required",
    "needed by",
];

impl Users {
    fn all(&self) -> Vec<&str> {
        self.quantities.iter().chain(&self.rules).map(String::as_str).collect()
    }
}

pub fn text(plan: &Plan, needs: &Needs) -> String {
    let mut out = format!("{}: {}\n", plan.name, plan.title);
    for (heading, required) in
        [("channels", true), ("channels that rules look at only where they were recorded", false)]
    {
        let mut lines: Vec<(&ChannelNeed, Vec<&str>)> = Vec::new();
        for need in needs.channels.iter().filter(|need| need.required == required) {
            // The same column of both sides is one line.
            let same = |(known, _): &&mut (&ChannelNeed, Vec<&str>)| {
                (&known.column, &known.unit, known.users.all())
                    == (&need.column, &need.unit, need.users.all())
            };
            match lines.iter_mut().find(same) {
                Some((_, records)) => records.push(need.record),
                None => lines.push((need, vec![need.record])),
            }
        }
        if !lines.is_empty() {
            let _ = writeln!(out, "\n{heading}");
        }
        for (need, records) in lines {
            let _ = writeln!(
                out,
                "  {} [{}], {}\n      {}",
                need.column,
                need.unit,
                records.join(" and "),
                users(&need.users, required)
            );
        }
    }
    let tables = [
        ("columns of the table of sections", &needs.sections, true),
        ("columns of the table of wanted operation", &needs.application, false),
        ("vehicle data", &needs.vehicle, false),
    ];
    for (heading, data, of_sections) in tables {
        if !data.is_empty() {
            let _ = writeln!(out, "\n{heading}");
        }
        for need in data {
            let unit = need.unit.as_ref().map_or(String::new(), |unit| format!(" [{unit}]"));
            let words = if need.words.is_empty() {
                String::new()
            } else {
                format!(": {}", need.words.join(", "))
            };
            let range = need.range.as_ref().map_or(String::new(), |range| format!(", {range}"));
            let found = of_sections && is_found(needs, need);
            let or_required = || if found { ", found in runs" } else { ", required" }.to_string();
            let default = need
                .default
                .as_ref()
                .map_or_else(or_required, |default| format!(", default {default}"));
            let _ = writeln!(
                out,
                "  {}{unit}{words}{range}{default}\n      {}. {}",
                need.key,
                need.title,
                users(&need.users, false)
            );
        }
    }
    out
}

/// Whether a column of the table of sections is found in the runs of a campaign without such a
/// table.
fn is_found(needs: &Needs, need: &DatumNeed) -> bool {
    // The program finds names and places of sections itself.
    let given = ["section", "start", "end"];
    needs
        .found
        .as_ref()
        .is_some_and(|found| given.contains(&need.key.as_str()) || found.contains(&need.key))
}

/// Of a channel that numbers depend on, the plausibility rules are left out: they look at it only
/// besides.
fn users(users: &Users, required: bool) -> String {
    let all: Vec<&str> = users
        .all()
        .into_iter()
        .filter(|user| !required || !user.starts_with("plausibility "))
        .collect();
    if all.is_empty() { "no rule uses it".to_string() } else { format!("for {}", all.join(", ")) }
}

pub fn json(plan: &Plan, needs: &Needs) -> Value {
    let channels: Vec<Value> = needs
        .channels
        .iter()
        .map(|need| {
            json!({
                "record": need.record, "name": need.column, "channel": need.channel, "unit": need.unit, "required": need.required,
                "quantities": need.users.quantities, "rules": need.users.rules,
            })
        })
        .collect();
    let section = |need: &DatumNeed| {
        let mut json = datum(need);
        json["found"] = is_found(needs, need).into();
        json
    };
    json!({
        "protocol": plan.name, "title": plan.title, "channels": channels,
        "sections": needs.sections.iter().map(section).collect::<Vec<_>>(),
        "application": needs.application.iter().map(datum).collect::<Vec<_>>(),
        "vehicle": needs.vehicle.iter().map(datum).collect::<Vec<_>>(),
    })
}

fn datum(need: &DatumNeed) -> Value {
    json!({
        "name": need.key, "title": need.title, "unit": need.unit, "words": need.words, "range": need.range,
        "default": need.default, "required": need.required, "quantities": need.users.quantities, "rules": need.users.rules,
    })
}

pub fn csv(needs: &Needs) -> String {
    let required = |required: bool| if required { "yes" } else { "no" }.to_string();
    let mut rows: Vec<Vec<String>> = vec![HEADER.map(str::to_string).to_vec()];
    for need in &needs.channels {
        let none = String::new;
        rows.push(vec![
            "channel".into(),
            need.record.into(),
            need.column.clone(),
            need.channel.clone().unwrap_or_default(),
            none(),
            need.unit.clone(),
            none(),
            none(),
            none(),
            required(need.required),
            need.users.all().join("; "),
        ]);
    }
    for (kind, data) in [
        ("section", &needs.sections),
        ("application", &needs.application),
        ("vehicle", &needs.vehicle),
    ] {
        for need in data {
            rows.push(vec![
                kind.into(),
                String::new(),
                need.key.clone(),
                String::new(),
                need.title.clone(),
                need.unit.clone().unwrap_or_default(),
                need.words.join("; "),
                need.range.clone().unwrap_or_default(),
                need.default.clone().unwrap_or_default(),
                required(need.required),
                need.users.all().join("; "),
            ]);
        }
    }
    table_csv(&rows)
}
