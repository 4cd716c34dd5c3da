//! `explain --stage clauses`: what stands for each clause of a law.

use std::fs;

use crate::common::program::fishplate;
use serde_json::Value;

fn clauses(protocol: &str) -> Value {
    let ran = fishplate(&["explain", protocol, "--stage", "clauses", "--format", "json"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    serde_json::from_str(&ran.stdout).expect("JSON")
}

/// Each clause with what stands for it and the number of rules.
fn standings(found: &Value) -> Vec<(String, String, usize)> {
    let text = |value: &Value| value.as_str().expect("a text").to_string();
    let one = |clause: &Value| {
        let rules = clause["rules"].as_array().expect("a list").len();
        (text(&clause["clause"]), text(&clause["standing"]), rules)
    };
    found["clauses"].as_array().expect("a list").iter().map(one).collect()
}

#[test]
fn every_limit_of_the_shipped_laws_names_its_clause() {
    for protocol in ["cfr-213-333", "cfr-238-appendix-c", "cfr-238-appendix-c-stationary"] {
        let found = clauses(protocol);
        assert_eq!(found["limits_without_clause"], serde_json::json!([]), "{protocol}");
        let standings = standings(&found);
        let has = |of: &str| standings.iter().any(|(_, standing, _)| standing == of);
        assert!(has("computed") && has("judged by a person"), "{standings:?}");
    }
    let standings = standings(&clauses("cfr-213-333"));
    assert!(standings.iter().any(|(_, standing, rules)| standing == "not covered" && *rules == 0));
    // Both rows of the car body are one family.
    let transient = standings.iter().find(|(clause, ..)| clause.ends_with("carbody, transient"));
    assert_eq!(
        transient.map(|(_, standing, rules)| (standing.as_str(), *rules)),
        Some(("computed", 2))
    );
}

#[test]
fn a_clause_that_a_rule_computes_in_part_is_judged_for_the_rest() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("own.fp");
    let text = |more: &str| {
        format!(
            "protocol own \"Own\"\n  extends cfr-238-appendix-c\n\nclause side \"The rest\"\n  \
             clause \"49 CFR 238,  Appendix C, truck side L/V\"\n{more}"
        )
    };
    fs::write(&path, text("  judged by \"a person\"\n")).expect("written");
    let name = path.to_string_lossy().into_owned();
    let of_side = |found: &Value| {
        let all = standings(found);
        all.into_iter().find(|(clause, ..)| clause.ends_with("truck side L/V")).expect("listed")
    };
    assert_eq!(of_side(&clauses(&name)).1, "computed, and judged by a person");
    fs::write(&path, text("")).expect("written");
    assert_eq!(of_side(&clauses(&name)).1, "computed");
    // A clause without its name, and a paraphrase of no clause.
    let nameless = "protocol own \"Own\"\n  extends cfr-238-appendix-c\n\nclause side \"The rest\"\n  \
                    judged by \"a person\"\n\nestimate e\n  is mean\n  paraphrase \"Own words\"\n";
    fs::write(&path, nameless).expect("written");
    let ran = fishplate(&["check", &name]);
    assert_eq!((ran.code, ran.stderr.matches("missing-field").count()), (2, 2), "{}", ran.stderr);
}
