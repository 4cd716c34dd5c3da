//! Provenance of the report files as an in-toto Statement v1 with a predicate of SLSA Provenance
//! v1, which other programs can read.
//!
//! Formats: in-toto Attestation Framework, "Statement" and "ResourceDescriptor"; SLSA v1.0,
//! "Provenance". It contains neither time nor host, so that the same input gives the same bytes.

use std::{collections::BTreeSet, path::Path};

use serde_json::{Map, Value, json};

use super::check::Check;
use crate::data::{fingerprint::fingerprint, hash::sha256, text::read_bytes};
use crate::disk::{self, SetKind};
use crate::result::Certification;

/// File name.
pub const FILE: &str = "statement.json";

const STATEMENT: &str = "https://in-toto.io/Statement/v1";
const PREDICATE: &str = "https://slsa.dev/provenance/v1";
/// Build type, which defines the external parameters: a package URL of the page that describes
/// them.
const CERTIFY: &str = "pkg:cargo/fishplate?run=certify-v1#docs/provenance.md";
const BUILDER: &str = "pkg:cargo/fishplate";

/// The statement about the files of a report; each with its path inside the output folder.
pub fn statement(found: &Certification, files: &[(String, Vec<u8>)]) -> String {
    let subject: Vec<Value> =
        files.iter().map(|(name, bytes)| resource(name, &sha256(bytes))).collect();
    let protocol = &found.protocol;
    let parameters: Map<String, Value> = protocol
        .parameters
        .iter()
        .map(|parameter| {
            (parameter.name.clone(), json!({"value": parameter.value, "setBy": parameter.set_by}))
        })
        .collect();
    let mut dependencies: Vec<Value> = protocol
        .files
        .iter()
        .map(|file| resource(&format!("protocol/{}", file.name), &file.sha256))
        .collect();
    dependencies.extend(
        found
            .campaign
            .files
            .iter()
            .map(|file| resource(&format!("campaign/{}", file.path), &file.sha256)),
    );
    let mut campaign = Map::from_iter([("name".to_string(), json!(found.campaign.name))]);
    if !found.campaign.members.is_empty() {
        let names: Vec<&str> =
            found.campaign.members.iter().map(|member| member.short_name.as_str()).collect();
        campaign.insert("members".into(), json!(names));
    }
    let statement = json!({
        "_type": STATEMENT,
        "subject": subject,
        "predicateType": PREDICATE,
        "predicate": {
            "buildDefinition": {
                "buildType": CERTIFY,
                "externalParameters": {
                    "protocol": {"name": protocol.name, "sha256": protocol.sha256},
                    "parameters": parameters,
                    "campaign": campaign,
                },
                "internalParameters": {},
                "resolvedDependencies": dependencies,
            },
            "runDetails": {
                "builder": {"id": BUILDER, "version": {"fishplate": env!("CARGO_PKG_VERSION")}},
            },
        },
    });
    // Serialisation of plain values cannot fail.
    serde_json::to_string_pretty(&statement).unwrap_or_default() + "\n"
}

fn resource(name: &str, sha256: &str) -> Value {
    json!({"name": name, "digest": {"sha256": sha256}})
}

/// Compares the files of an output folder with its statement, which must name all of them.
pub fn check(folder: &Path) -> Check {
    const NAME: &str = "statement";
    /// Maximum size; a statement about 100 000 files has about 15 million bytes.
    const LARGEST: u64 = 64 << 20;
    let path = folder.join(FILE);
    let bytes = match read_bytes(&path, FILE, LARGEST) {
        Ok(bytes) => bytes,
        Err(problem) => {
            return Check::differs(NAME, "the statement cannot be read", vec![problem.says]);
        }
    };
    let value: Value = serde_json::from_slice(&bytes).unwrap_or(Value::Null);
    let subjects = value["subject"].as_array().filter(|_| value["_type"] == STATEMENT);
    let Some(subjects) = subjects else {
        let says = format!("`{FILE}` is not an in-toto Statement v1");
        return Check::differs(NAME, says, Vec::new());
    };
    let (mut details, mut named) = (Vec::new(), BTreeSet::new());
    for subject in subjects {
        let (Some(name), Some(said)) =
            (subject["name"].as_str(), subject["digest"]["sha256"].as_str())
        else {
            details.push("a subject has no name or no SHA-256".into());
            continue;
        };
        named.insert(name);
        match fingerprint(folder, name) {
            Ok(Some((hash, _))) if hash == said => {}
            Ok(Some((hash, _))) => details
                .push(format!("changed: {name}: SHA-256 {said} in the statement, {hash} now")),
            Ok(None) => details.push(format!("missing: {name}")),
            Err(problem) => details.push(format!("not readable: {name}: {}", problem.says)),
        }
    }
    details.extend(unnamed(folder, &named));
    let agrees = format!(
        "{} files have the SHA-256 given in {FILE}, and there are no others",
        subjects.len()
    );
    Check::of(NAME, agrees, "files differ from those in the statement", details)
}

/// What lies in an output folder and its folders without being named by the statement.
fn unnamed(folder: &Path, named: &BTreeSet<&str>) -> Vec<String> {
    let folders: BTreeSet<&str> =
        named.iter().filter_map(|name| Some(name.rsplit_once('/')?.0)).collect();
    let mut found = Vec::new();
    for inside in std::iter::once("").chain(folders.iter().copied()) {
        for name in disk::names(&folder.join(inside)).unwrap_or_default() {
            let name = name.to_string_lossy();
            let path =
                if inside.is_empty() { name.to_string() } else { format!("{inside}/{name}") };
            let signed = path.strip_suffix(disk::SIGNATURE).unwrap_or(&path);
            let known = signed == FILE
                || named.contains(signed)
                || folders.contains(path.as_str())
                || path == SetKind::Report.manifest();
            if !known {
                found.push(format!("not in the statement: {path}"));
            }
        }
    }
    found
}
