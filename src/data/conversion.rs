//! A copy of a campaign with its records in another format.

use std::collections::BTreeSet;

use super::campaign::{CAMPAIGN_FILE, RUNS};
use super::hash::sha256;
use super::origin::{ORIGIN_FILE, ORIGIN_KEY};
use super::record::{Format, read_raw};
use super::text::read_any;
use super::write::{Entry, Outputs, campaign_yaml, csv, parquet, table_csv, yaml_text};
use super::{Campaign, RecordKind};
use crate::problem::{Problem, Problems};
use crate::source::{Source, Spanned};
use crate::yaml::{self, Node, Value};

/// The key of `campaign.yaml` that names the table of converted records.
const KEY: &str = "records_converted";
/// That table: each record with its hash, and from which file it was converted.
const TABLE: &str = "conversion.csv";

/// A record before and after: path inside its campaign, SHA-256.
struct Pair {
    before: (String, String),
    after: (String, String),
}

/// Numbers of records.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Converted {
    pub converted: usize,
    /// In the wanted format already.
    pub copied: usize,
    /// Named by the section table, but not there.
    pub missing: usize,
}

/// Adds all files of the copy to the outputs.
///
/// # Errors
/// Of reading a record, which must be whole; of writing. No file is in its place before
/// [`Outputs::commit`].
pub fn convert(
    campaign: &Campaign,
    to: Format,
    outputs: &mut Outputs,
) -> Result<Converted, Vec<Problem>> {
    let one = |problem: Problem| vec![problem];
    let (mut pairs, mut done, mut seen) = (Vec::new(), Converted::default(), BTreeSet::new());
    for which in RecordKind::ALL
        .into_iter()
        .filter(|kind| campaign.has(*kind))
        .flat_map(|kind| campaign.records(kind))
    {
        for name in &campaign.names {
            let place = match campaign.place_of(which, name) {
                Ok(place) if seen.insert(place.inside.clone()) => place,
                Ok(_) => continue,
                Err(problem) if problem.code == "file-missing" => {
                    done.missing += 1;
                    continue;
                }
                Err(problem) => return Err(one(problem)),
            };
            let before = read_any(&place.path, &place.shown).map_err(one)?;
            if Format::of(&place.path) == to {
                outputs.add(&place.inside, &before).map_err(one)?;
                done.copied += 1;
                continue;
            }
            let columns = read_raw(&place.path, &place.shown)?;
            let after = match to {
                Format::Csv => csv(&columns),
                Format::Parquet => parquet(&columns).map_err(one)?,
            };
            let stem = Format::stem(&place.inside).unwrap_or(&place.inside);
            let inside = format!("{stem}.{}", to.ending());
            outputs.add(&inside, &after).map_err(one)?;
            pairs.push(Pair {
                before: (place.inside.clone(), sha256(&before)),
                after: (inside, sha256(&after)),
            });
            done.converted += 1;
        }
    }
    rest(campaign, &pairs, outputs).map_err(one)?;
    Ok(done)
}

/// The files of the copy but its records.
fn rest(campaign: &Campaign, pairs: &[Pair], outputs: &mut Outputs) -> Result<(), Problem> {
    let node = campaign.tree.get(ORIGIN_KEY);
    let origin_file = node.and_then(Node::scalar_text).map_or(ORIGIN_FILE, str::trim).to_string();
    let mut origin = node.filter(|node| matches!(node.value, Value::Map(_))).map(|node| {
        let entries: Vec<(&str, Entry<'_>)> = node
            .entries()
            .iter()
            .map(|(key, value)| (key.text.as_str(), Entry::Node(value)))
            .collect();
        campaign_yaml(&entries)
    });
    let place = |inside: &str| {
        campaign.place(&Spanned::new(inside.to_string(), campaign.tree.span.part(0..0)))
    };
    let origin_inside = place(&origin_file)?.inside;
    for inside in campaign.plain_files()? {
        let place = place(&inside)?;
        let bytes = read_any(&place.path, &place.shown)?;
        if node.is_some() && inside == origin_inside {
            origin = Some(String::from_utf8_lossy(&bytes).into_owned());
        } else if inside != CAMPAIGN_FILE && inside != TABLE {
            outputs.add(&inside, &bytes)?;
        }
    }
    if let Some(text) = origin {
        outputs.add(&origin_inside, fitted(text, pairs).as_bytes())?;
    }
    let kept =
        campaign.tree.entries().iter().filter(|(key, _)| key.text != KEY && key.text != ORIGIN_KEY);
    let mut entries: Vec<(&str, Entry<'_>)> =
        kept.map(|(key, node)| (key.text.as_str(), Entry::Node(node))).collect();
    if node.is_some() {
        entries.push((ORIGIN_KEY, Entry::Text(&origin_inside)));
    }
    entries.push((KEY, Entry::Text(TABLE)));
    outputs.add(CAMPAIGN_FILE, of_runs(campaign_yaml(&entries), pairs).as_bytes())?;
    let mut rows =
        vec![["record", "sha256", "converted from", "sha256 before"].map(str::to_string).to_vec()];
    rows.extend(pairs.iter().map(|Pair { before, after }| {
        vec![after.0.clone(), after.1.clone(), before.0.clone(), before.1.clone()]
    }));
    outputs.add(TABLE, table_csv(&rows).as_bytes())
}

/// The text of `campaign.yaml` with the converted records in place of those that it names, which
/// are those of runs.
fn of_runs(text: String, pairs: &[Pair]) -> String {
    let Some(tree) =
        yaml::load(&Source::new(CAMPAIGN_FILE, text.clone()), &mut Problems::default())
    else {
        return text;
    };
    let runs = tree.get(RUNS).map(Node::entries).unwrap_or_default();
    let files = runs
        .iter()
        .flat_map(|(_, run)| run.entries())
        .filter_map(|(_, file)| Some((file.span.clone(), file.scalar_text()?)));
    let of = |path: &str| pairs.iter().find(|pair| pair.before.0 == path.trim());
    let changes = files
        .filter_map(|(span, path)| Some((span.start..span.end, yaml_text(&of(path)?.after.0))))
        .collect();
    replaced(text, changes)
}

/// The text with other words at some places.
fn replaced(mut text: String, mut changes: Vec<(std::ops::Range<usize>, String)>) -> String {
    changes.sort_by_key(|(range, _)| std::cmp::Reverse(range.start));
    changes.into_iter().for_each(|(range, new)| text.replace_range(range, &new));
    text
}

/// The origin with the converted records in place of those to which the simulation was fitted:
/// `certify` recognises them by their hash.
fn fitted(text: String, pairs: &[Pair]) -> String {
    let Some(tree) = yaml::load(&Source::new(ORIGIN_FILE, text.clone()), &mut Problems::default())
    else {
        return text;
    };
    let Some(Value::List(items)) = tree.get("fitted to").map(|node| &node.value) else {
        return text;
    };
    let mut changes = Vec::new();
    for item in items {
        let (Some(path), Some(hash)) = (item.get("path"), item.get("sha256")) else { continue };
        let pair = pairs.iter().find(|pair| hash.scalar_text() == Some(pair.before.1.as_str()));
        if let Some(Pair { after, .. }) = pair {
            changes.push((path.span.start..path.span.end, yaml_text(&after.0)));
            changes.push((hash.span.start..hash.span.end, yaml_text(&after.1)));
        }
    }
    replaced(text, changes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_records_fitted_to_are_replaced() {
        let pair = Pair {
            before: ("m/S.csv".into(), "aa".into()),
            after: ("m/S.parquet".into(), "bb".into()),
        };
        let text = "sources:\n- path: m/S.csv\n  sha256: aa\nfitted to:\n- path: m/S.csv\n  sha256: aa\n- path: m/T.csv\n  sha256: cc\n";
        let expected = "sources:\n- path: m/S.csv\n  sha256: aa\nfitted to:\n- path: m/S.parquet\n  sha256: bb\n- path: m/T.csv\n  sha256: cc\n";
        assert_eq!(fitted(text.to_string(), &[pair]), expected);
        assert_eq!(fitted("effects: []\n".to_string(), &[]), "effects: []\n");
    }
}
