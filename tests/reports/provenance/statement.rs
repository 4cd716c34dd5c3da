//! The statement beside a report: its form, that it names every file with its hash, and that
//! nothing in it depends on the machine.

use std::collections::BTreeSet;
use std::fs;
use std::process::Command;

use serde_json::Value;
use sha2::{Digest, Sha256};

use super::program::{files, fishplate};
use super::{example, root, text, written};

fn statement() -> Value {
    serde_json::from_str(
        &fs::read_to_string(written().out().join("statement.json")).expect("readable"),
    )
    .expect("JSON")
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

#[test]
fn it_has_the_published_form() {
    let schema = fs::read_to_string(root().join("tests/cases/provenance/statement.schema.json"))
        .expect("readable");
    let schema: Value = serde_json::from_str(&schema).expect("JSON");
    let validator = jsonschema::validator_for(&schema).expect("a schema");
    let found = statement();
    let errors: Vec<String> = validator
        .iter_errors(&found)
        .map(|error| format!("{}: {error}", error.instance_path))
        .collect();
    assert!(errors.is_empty(), "{errors:#?}");
    // The schema does refuse.
    for change in [
        (|all: &mut Value| all["_type"] = "https://in-toto.io/Statement/v0.1".into())
            as fn(&mut Value),
        |all| drop(all["predicate"].as_object_mut().map(|map| map.remove("runDetails"))),
        |all| all["subject"][0]["digest"]["sha256"] = "12".into(),
        |all| all["predicate"]["runDetails"]["builder"]["id"] = "fishplate".into(),
    ] {
        let mut changed = found.clone();
        change(&mut changed);
        assert!(!validator.is_valid(&changed));
    }
}

/// Where the Python package of the in-toto project is installed (`.ci/run` does so), its message
/// types must read the statement: they refuse fields that are not in the published structure.
#[test]
fn the_reference_implementation_reads_it() {
    let own = root().join("target/validators/bin/python");
    let python = if own.is_file() { text(&own) } else { "python3".to_string() };
    let script = "import json, sys
try:
    import in_toto_attestation.v1.statement_pb2 as statement_pb2
    import in_toto_attestation.predicates.provenance.v1.provenance_pb2 as provenance_pb2
    from in_toto_attestation.v1.statement import Statement
    from google.protobuf import json_format
except ImportError:
    sys.exit(77)
text = open(sys.argv[1]).read()
message = json_format.Parse(text, statement_pb2.Statement())
Statement.copy_from_pb(message).validate()
json_format.Parse(json.dumps(json.loads(text)['predicate']), provenance_pb2.Provenance())
print('read')";
    let output = Command::new(python)
        .args(["-c", script])
        .arg(written().out().join("statement.json"))
        .output();
    match output {
        Ok(output) if output.status.success() => assert_eq!(output.stdout, b"read\n"),
        Ok(output) if output.status.code() != Some(77) => {
            panic!("{}", String::from_utf8_lossy(&output.stderr))
        }
        _ => crate::common::tools::skip("in-toto-attestation"),
    }
}

#[test]
fn it_names_every_file_with_its_hash() {
    let found = statement();
    let out = written().out();
    let mut named = BTreeSet::new();
    for subject in found["subject"].as_array().expect("a list") {
        let name = subject["name"].as_str().expect("a name");
        assert_eq!(
            subject["digest"]["sha256"],
            sha256(&fs::read(out.join(name)).expect("readable")),
            "{name}"
        );
        named.insert(out.join(name));
    }
    let there: BTreeSet<_> = files(&out)
        .into_iter()
        .filter(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            // The list of the files that were written, which the next run reads, is none of them.
            name != "statement.json" && !name.starts_with(".fishplate-")
        })
        .collect();
    assert_eq!(named, there);
    let campaign = written().campaign();
    let dependencies =
        found["predicate"]["buildDefinition"]["resolvedDependencies"].as_array().expect("a list");
    let mut read = 0;
    for dependency in dependencies {
        let name = dependency["name"].as_str().expect("a name");
        if let Some(inside) = name.strip_prefix("campaign/") {
            assert_eq!(
                dependency["digest"]["sha256"],
                sha256(&fs::read(campaign.join(inside)).expect("readable")),
                "{name}"
            );
            read += 1;
        }
    }
    assert!(
        read > 30 && dependencies.len() == read + 4,
        "{read} files of the campaign, four of the protocol"
    );
    let external = &found["predicate"]["buildDefinition"]["externalParameters"];
    assert_eq!(
        external["parameters"]["percentile_rule"],
        serde_json::json!({"value": "hazen", "setBy": "command line"})
    );
    assert_eq!(
        external["parameters"]["lowpass_frequency"],
        serde_json::json!({"value": "19.5 Hz", "setBy": "campaign"})
    );
}

#[test]
fn it_is_the_same_wherever_it_is_made() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut texts = Vec::new();
    for name in ["one", "another/deeper"] {
        let out = folder.path().join(name);
        let ran = fishplate(&[
            "certify",
            &text(&example("coach-good")),
            "--out",
            &text(&out),
            "--only",
            "results",
            "-q",
        ]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        texts.push(fs::read_to_string(out.join("statement.json")).expect("readable"));
    }
    assert_eq!(texts[0], texts[1]);
    assert!(!texts[0].contains(&text(folder.path())));
}
