//! A copy of a campaign with its records in another format.

use std::collections::BTreeSet;

use super::{
    Campaign, RecordKind,
    campaign::{CAMPAIGN_FILE, RUNS},
    hash::sha256,
    origin::{ORIGIN_FILE, ORIGIN_KEY},
    record::{Format, read_raw},
    text::read_any,
    write::{Entry, Outputs, campaign_yaml, campaign_yaml_with, in_format, table_csv},
};
use crate::data::prelude::*;

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
    let (mut pairs, mut done, mut seen) = (Vec::new(), Converted::default(), BTreeSet::new());
    let kinds = RecordKind::ALL.into_iter().filter(|kind| campaign.has(*kind));
    for which in kinds.flat_map(|kind| campaign.records(kind)) {
        for name in &campaign.names {
            let place = match campaign.place_of(which, name) {
                Ok(place) if seen.insert(place.inside.clone()) => place,
                Ok(_) => continue,
                Err(problem) if problem.code == "file-missing" => {
                    done.missing += 1;
                    continue;
                }
                Err(problem) => return Err(problem.into()),
            };
            let before = read_any(&place.path, &place.shown)?;
            if Format::of(&place.path) == to {
                outputs.add(&place.inside, &before)?;
                done.copied += 1;
                continue;
            }
            let after = in_format(to, &read_raw(&place.path, &place.shown)?)?;
            let inside = to.file(Format::stem(&place.inside).unwrap_or(&place.inside));
            outputs.add(&inside, &after)?;
            let before = (place.inside, sha256(&before));
            pairs.push(Pair { before, after: (inside, sha256(&after)) });
            done.converted += 1;
        }
    }
    rest(campaign, &pairs, outputs)?;
    Ok(done)
}

/// The files of the copy but its records.
fn rest(campaign: &Campaign, pairs: &[Pair], outputs: &mut Outputs) -> Result<(), Problem> {
    let node = campaign.tree.get(ORIGIN_KEY);
    let mut origin = node.filter(|node| matches!(node.value, Value::Map(_))).map(|node| {
        let entries = node.entries().iter();
        let entries = entries.map(|(key, value)| (key.text.as_str(), Entry::Node(value)));
        campaign_yaml(&entries.collect::<Vec<_>>())
    });
    let named = node.and_then(Node::scalar_text).map_or(ORIGIN_FILE, str::trim);
    let origin_inside = campaign.inner(named)?.inside;
    for (inside, bytes) in campaign.plain_files()? {
        if node.is_some() && inside == origin_inside {
            origin = Some(String::from_utf8_lossy(&bytes).into_owned());
        } else if inside != CAMPAIGN_FILE && inside != TABLE {
            outputs.add(&inside, &bytes)?;
        }
    }
    if let Some(text) = origin {
        outputs.add(&origin_inside, fitted(text, pairs).as_bytes())?;
    }
    let mut tree = campaign.tree.clone();
    if let Value::Map(entries) = &mut tree.value
        && let Some((_, runs)) = entries.iter_mut().find(|(key, _)| key.text == RUNS)
    {
        name_converted(runs, pairs);
    }
    let origin = node.map(|_| (ORIGIN_KEY, Entry::Text(&origin_inside)));
    let new: Vec<_> = origin.into_iter().chain([(KEY, Entry::Text(TABLE))]).collect();
    let text = campaign_yaml_with(&tree, &[KEY, ORIGIN_KEY], &new);
    outputs.add(CAMPAIGN_FILE, text.as_bytes())?;
    let mut rows = vec![["record", "sha256", "converted from", "sha256 before"]];
    rows.extend(pairs.iter().map(|Pair { before, after }| {
        [after.0.as_str(), after.1.as_str(), before.0.as_str(), before.1.as_str()]
    }));
    outputs.add(TABLE, table_csv(&rows).as_bytes())
}

/// Puts the converted records in place of those that the runs of a campaign name.
fn name_converted(runs: &mut Node, pairs: &[Pair]) {
    let Value::Map(entries) = &mut runs.value else { return };
    for (_, run) in entries {
        let Value::Map(files) = &mut run.value else { continue };
        for (_, file) in files {
            let path = file.scalar_text().map(str::trim);
            if let Some(pair) = pairs.iter().find(|pair| path == Some(pair.before.0.as_str())) {
                file.value = Value::Text(pair.after.0.clone());
            }
        }
    }
}

/// The origin with the converted records in place of those to which the simulation was fitted and of
/// those that an import wrote: `certify` recognises them by their hash.
fn fitted(text: String, pairs: &[Pair]) -> String {
    let Ok(mut origin) = serde_yaml::from_str::<serde_yaml::Value>(&text) else { return text };
    let mut changed = false;
    // The file that a simulation was fitted to may have another path in its own campaign.
    for (list, by) in [("fitted to", "sha256"), ("records", "path")] {
        let files = origin.get_mut(list).and_then(serde_yaml::Value::as_sequence_mut);
        for file in files.into_iter().flatten().filter_map(serde_yaml::Value::as_mapping_mut) {
            let is = |key: &str, known: &str| {
                file.get(key).and_then(serde_yaml::Value::as_str) == Some(known)
            };
            let known = |Pair { before: (path, sha256), .. }: &&Pair| {
                is(by, if by == "path" { path } else { sha256 })
            };
            let Some(Pair { before, after }) = pairs.iter().find(known) else { continue };
            // That of a record that was changed before stays another one.
            if is("sha256", &before.1) {
                file.insert("sha256".into(), after.1.as_str().into());
            }
            file.insert("path".into(), after.0.as_str().into());
            changed = true;
        }
    }
    if changed { serde_yaml::to_string(&origin).unwrap_or(text) } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_records_fitted_to_are_replaced() {
        let pair = Pair {
            before: ("m/S.csv".into(), "aa".into()),
            after: ("m/S.parquet".into(), "12e4".into()),
        };
        let text = "sources:\n- path: m/S.csv\n  sha256: aa\nfitted to:\n- path: m/S.csv\n  sha256: aa\n- path: m/T.csv\n  sha256: cc\n";
        let expected = "sources:\n- path: m/S.csv\n  sha256: aa\nfitted to:\n- path: m/S.parquet\n  sha256: '12e4'\n- path: m/T.csv\n  sha256: cc\n";
        assert_eq!(fitted(text.to_string(), &[pair]), expected);
        assert_eq!(fitted("effects: []\n".to_string(), &[]), "effects: []\n");
        let pair = |name: &str, hash: &str| Pair {
            before: (format!("m/{name}.csv"), "aa".into()),
            after: (format!("m/{name}.parquet"), hash.into()),
        };
        let record = |(name, hash): (&str, &str)| format!("- path: m/{name}\n  sha256: {hash}\n");
        let records = |all: [(&str, &str); 3]| format!("records:\n{}", all.map(record).concat());
        let text = records([("S.csv", "aa"), ("T.csv", "cc"), ("U.csv", "dd")]);
        let expected = records([("S.parquet", "ee"), ("T.parquet", "cc"), ("U.csv", "dd")]);
        let pairs = [pair("S", "ee"), pair("T", "ff")];
        assert_eq!(fitted(text, &pairs), expected, "T was changed before");
    }
}
