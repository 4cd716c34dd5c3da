//! The empty campaign: a description, tables and records with the headers that a protocol needs,
//! and a vehicle file to fill in.

use std::fmt::Write;

use serde_json::json;

use super::{File, filled};
use crate::data::write::{table_csv, yaml_text};
use crate::problem::Problem;
use crate::run::needs::{DatumNeed, Needs};

const TEMPLATE: &str = include_str!("../../templates/init/campaign.yaml");
/// Name of the section and of the records that are there to be filled in.
const FIRST: &str = "S01";
/// Name of the first point of wanted operation.
const FIRST_POINT: &str = "P01";

/// # Errors
/// `internal`: the template cannot be filled.
pub fn files(name: &str, needs: &Needs) -> Result<Vec<File>, Problem> {
    let reads = |record: &str| needs.channels.iter().any(|need| need.record == record);
    let data = json!({
        "name": yaml_text(name),
        "vehicle": !needs.vehicle.is_empty(),
        "sections": !needs.sections.is_empty(),
        "application": !needs.application.is_empty(),
        "measured": reads("measured"),
        "simulated": reads("simulated"),
        "track": reads("track"),
    });
    let mut files = vec![("campaign.yaml".to_string(), filled(TEMPLATE, &data)?)];
    if !needs.vehicle.is_empty() {
        files.push(("vehicle.yaml".into(), vehicle(&needs.vehicle)));
    }
    for (path, table, first) in [
        ("sections.csv", &needs.sections, FIRST),
        ("application.csv", &needs.application, FIRST_POINT),
    ] {
        if !table.is_empty() {
            let header: Vec<String> =
                table.iter().map(|need| heading(&need.key, need.unit.as_deref())).collect();
            let mut row = vec![String::new(); header.len()];
            row[0] = first.to_string();
            files.push((path.into(), table_csv(&[header, row])));
        }
    }
    for (record, folder) in
        [("measured", "measurement"), ("simulated", "simulation"), ("track", "track")]
    {
        let columns = needs.channels.iter().filter(|need| need.record == record);
        let header: Vec<String> =
            columns.map(|need| heading(&need.column, Some(&need.unit))).collect();
        if !header.is_empty() {
            files.push((format!("{folder}/{FIRST}.csv"), table_csv(&[header])));
        }
    }
    Ok(files)
}

/// `radius [m]`
fn heading(name: &str, unit: Option<&str>) -> String {
    unit.map_or_else(|| name.to_string(), |unit| format!("{name} [{unit}]"))
}

/// The vehicle file: a key for each value, in comments what it is. Values that may be missing are
/// comments altogether.
fn vehicle(needs: &[DatumNeed]) -> String {
    let mut text = String::from(
        "# Data of the vehicle that the protocol reads. A number may have its unit: `54.5 kN`. A key in a comment may be\n\
         # missing; the value that stands there then holds.\n",
    );
    let mut open: Vec<&str> = Vec::new();
    // Keys with points are nested; those of one map stand together.
    let mut sorted: Vec<(&DatumNeed, Vec<&str>)> =
        needs.iter().map(|need| (need, need.key.split('.').collect())).collect();
    let first = |map: &str| needs.iter().position(|need| need.key.split('.').next() == Some(map));
    sorted.sort_by_key(|(_, parts)| parts.first().and_then(|map| first(map)));
    for (need, parts) in &sorted {
        let Some((key, maps)) = parts.split_last() else { continue };
        let mark = if need.required { "" } else { "# " };
        let common = open.iter().zip(maps).take_while(|(a, b)| a == b).count();
        if need.required {
            for (depth, map) in maps.iter().enumerate().skip(common) {
                let _ = writeln!(text, "{:1$}{2}:", "", 2 * depth, yaml_text(map));
            }
            open = maps.to_vec();
        }
        let indent = 2 * maps.len();
        let _ = writeln!(text, "\n{:indent$}# {}", "", told(need));
        if need.required {
            let _ = writeln!(text, "{:indent$}{}:", "", yaml_text(key));
        } else {
            let default = need.default.as_deref().unwrap_or_default();
            let _ = writeln!(text, "{mark}{:indent$}{}: {default}", "", need.key);
        }
    }
    text
}

/// `Static vertical wheel force; in kN; 10 kN to 200 kN; for Q_qst, Q_max`
fn told(need: &DatumNeed) -> String {
    let mut parts = vec![need.title.clone()];
    parts.extend(need.unit.as_ref().filter(|unit| *unit != "-").map(|unit| format!("in {unit}")));
    parts.extend((!need.words.is_empty()).then(|| need.words.join(" | ")));
    parts.extend(need.range.clone());
    let users: Vec<&str> =
        need.users.quantities.iter().chain(&need.users.rules).map(String::as_str).collect();
    parts.extend((!users.is_empty()).then(|| format!("for {}", users.join(", "))));
    parts.join("; ").replace(['\n', '\r'], " ")
}
