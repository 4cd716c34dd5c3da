//! Verdicts with names: by limits, over one another, and left to a person, on the campaign of
//! straight lines.

use crate::common::straight;
use crate::common::texts::texts;

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use fishplate::certify::{Compiled, certify, compile};
use fishplate::check::{Overrides, family};
use fishplate::data::Campaign;
use fishplate::graph::Operation;
use fishplate::library;
use fishplate::problem::Problems;
use fishplate::report::{html, typst, view};
use fishplate::result::text;
use fishplate::result::{Certification, Outcome, Verdict, VerdictResult};
use fishplate::run::Settings;
use fishplate::source::Source;
use straight::write_campaign;

/// Means of the right wheel: measured 8.1 kN, simulated 7.725 kN, difference -0.375 kN; of the left
/// wheel, difference -0.0625 kN.
fn protocol() -> String {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/cases/check/good/verdicts.fp");
    fs::read_to_string(path).expect("a readable case")
}

fn replaced(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(protocol(), |text, (old, new)| {
        assert!(text.contains(old), "{old}");
        text.replacen(old, new, 1)
    })
}

fn compiled(text: &str) -> Compiled {
    let mut problems = Problems::default();
    let family = family::read(&Source::new("verdicts.fp", text), &library::parent, &mut problems);
    compile(family, &Overrides::new(), &mut problems)
        .unwrap_or_else(|| panic!("{}", problems.render(false)))
}

fn certified(changes: &[(&str, &str)]) -> Certification {
    let folder = tempfile::tempdir().expect("a folder");
    write_campaign(folder.path());
    let mut problems = Problems::default();
    let campaign = Campaign::open(folder.path(), &mut problems)
        .unwrap_or_else(|| panic!("{}", problems.render(false)));
    let protocol = compiled(&replaced(changes));
    certify(&protocol, &campaign, Settings { traces: 0 }, &|_| {})
        .unwrap_or_else(|problems| panic!("{}", problems.render(false)))
}

#[track_caller]
fn named<'a>(found: &'a Certification, name: &str) -> &'a VerdictResult {
    found.verdicts.iter().find(|verdict| verdict.name == name).expect("the verdict")
}

fn words(found: &Certification) -> Vec<(&str, &str)> {
    found.verdicts.iter().map(|verdict| (verdict.name.as_str(), verdict.word.as_str())).collect()
}

const MEASURED: &str = "from   measured\n  value  median\n  limit  mean 10 kN";
const MEASURED_FAILS: &str = "from   measured\n  value  median\n  limit  mean 8 kN";

#[test]
fn every_verdict_has_its_own_outcome_and_words() {
    let found = certified(&[]);
    let expected = [
        ("measured_test", "accepted"),
        ("virtual_test", "accepted"),
        ("agrees", "holds"),
        ("close", "near"),
        ("inspection", "open"),
        ("both", "holds"),
        ("enough", "holds"),
        ("released", "not assessable"),
        ("at_left", "holds"),
        ("at_right", "holds"),
    ];
    assert_eq!(words(&found), expected);
    assert_eq!(
        (found.verdict, found.verdict_in_words()),
        (Verdict::Validated, "accepted".to_string())
    );
    assert!(named(&found, "measured_test").overall && !named(&found, "virtual_test").overall);
    assert!(found.reasons.is_empty());
}

#[test]
fn verdicts_over_others_follow_them() {
    let found = certified(&[(MEASURED, MEASURED_FAILS)]);
    assert_eq!((found.verdict, found.verdict_word()), (Verdict::NotValidated, "not accepted"));
    assert_eq!(named(&found, "measured_test").outcome, Outcome::DoesNotHold);
    assert!(
        texts(&found.reasons)[0].starts_with("measured_right: "),
        "{:?}",
        texts(&found.reasons)
    );
    let states =
        "Acceptance by the simulation: accepted, Acceptance by the measurement: not accepted";
    assert_eq!(
        texts(&named(&found, "agrees").reasons),
        [format!("{states}; required: virtual_test is measured_test")]
    );
    // The second way of `both`: the tests differ.
    assert_eq!(named(&found, "both").word, "holds");
    assert_eq!(named(&found, "enough").word, "holds");
    let far = [
        (
            "difference  signed\n  limit       mean 1 kN",
            "difference  signed\n  limit       mean 0.3 kN",
        ),
        (MEASURED, MEASURED_FAILS),
    ];
    let one_of_two = certified(&far);
    assert_eq!(named(&one_of_two, "close").word, "near");
    assert_eq!(
        (named(&one_of_two, "at_left").word.as_str(), named(&one_of_two, "at_right").word.as_str()),
        ("holds", "does not hold")
    );
    let far = [
        far[0],
        (
            "difference  signed\n  limit       mean 1 kN",
            "difference  signed\n  limit       mean 0.05 kN",
        ),
        far[1],
    ];
    let found = certified(&far);
    let close = named(&found, "close");
    assert_eq!(close.word, "far");
    assert_eq!(
        texts(&close.reasons)[0],
        "0 of 2 quantities meet their criteria; at least 1 required"
    );
    assert_eq!(close.reasons.len(), 3, "{:?}", texts(&close.reasons));
    assert_eq!(
        texts(&named(&found, "both").reasons),
        ["Simulation near the measurement: far; required: close holds"]
    );
    let enough = "at least 2 of measured_test, virtual_test, close hold";
    assert!(
        texts(&named(&found, "enough").reasons)[0].ends_with(enough),
        "{:?}",
        texts(&named(&found, "enough").reasons)
    );
}

/// Both fail: the tests agree all the same.
#[test]
fn the_same_outcome_is_the_same_whether_it_holds_or_not() {
    let simulated = MEASURED.replace("measured", "simulated");
    let found = certified(&[
        (MEASURED, MEASURED_FAILS),
        (&simulated, &MEASURED_FAILS.replace("measured", "simulated").replace('8', "7")),
    ]);
    assert_eq!(named(&found, "virtual_test").word, "not accepted");
    assert_eq!(named(&found, "agrees").word, "holds");
    assert_eq!(named(&found, "both").outcome, Outcome::DoesNotHold);
}

/// A quantity that cannot be assessed bars the verdicts that are about it, and those over them;
/// zones bar all that rest on limits.
#[test]
fn what_is_not_assessable_bars_its_own_verdicts() {
    let found = certified(&[(MEASURED, &format!("{MEASURED}\n  minimum pairs  9"))]);
    assert_eq!(found.verdict, Verdict::NotAssessable);
    assert_eq!(named(&found, "measured_test").word, "not assessable");
    assert_eq!(
        texts(&named(&found, "measured_test").reasons),
        ["measured_right: 4 pairs of section and signal; at least 9 required"]
    );
    assert_eq!(named(&found, "virtual_test").word, "accepted");
    assert_eq!(named(&found, "close").word, "near");
    let over = "Acceptance by the measurement: measured_right: 4 pairs of section and signal; at least 9 required";
    assert_eq!(texts(&named(&found, "agrees").reasons), [over]);
    assert_eq!(named(&found, "agrees").outcome, Outcome::NotAssessable);
    let found = certified(&[("minimum sections  2", "minimum sections  4")]);
    assert!(
        found
            .verdicts
            .iter()
            .filter(|verdict| verdict.name != "inspection")
            .all(|one| one.outcome == Outcome::NotAssessable)
    );
    assert_eq!(
        texts(&named(&found, "virtual_test").reasons),
        ["zone 2 has 3 usable sections; at least 4 required"]
    );
    assert_eq!(named(&found, "inspection").outcome, Outcome::Open);
}

/// A judgement stays open, whatever the words; what is over it, or is it, is not assessable.
#[test]
fn a_person_decides_and_the_program_does_not() {
    let found = certified(&[]);
    let inspection = named(&found, "inspection");
    assert_eq!(
        (inspection.outcome, inspection.judged_by.as_deref()),
        (Outcome::Open, Some("the responsible test engineer"))
    );
    assert_eq!(texts(&inspection.reasons), ["to be judged by the responsible test engineer"]);
    let over = ["Condition of the contact surfaces: to be judged by the responsible test engineer"];
    assert_eq!(texts(&named(&found, "released").reasons), over);
    for rule in [
        "inspection holds",
        "inspection does not hold",
        "measured_test holds or inspection holds",
        "inspection is virtual_test",
    ] {
        let found = certified(&[(
            "verdict measured_test",
            &format!("verdict\n  validated  when {rule}\n\nverdict measured_test"),
        )]);
        assert_eq!(
            (found.verdict, found.verdict_word()),
            (Verdict::NotAssessable, "not assessable"),
            "{rule}"
        );
        assert_eq!(texts(&found.reasons), over, "{rule}");
    }
    let overall = certified(&[(
        "verdict measured_test",
        "verdict first\n  judged by  \"an engineer\"\n\nverdict measured_test",
    )]);
    assert_eq!(
        (overall.verdict, overall.verdict_word()),
        (Verdict::NotAssessable, "not assessable")
    );
    assert_eq!(texts(&overall.reasons), ["to be judged by an engineer"]);
}

/// The verdict without a name is the overall one wherever it stands, of all quantities unless its
/// rule is over others.
#[test]
fn the_verdict_without_a_name_is_the_overall_one() {
    let with = |block: &str| {
        certified(&[
            (MEASURED, MEASURED_FAILS),
            ("verdict inspection", &format!("{block}\n\nverdict inspection")),
        ])
    };
    let found = with("verdict\n  standard deviation  n");
    assert_eq!((found.verdict, found.own_word.as_deref()), (Verdict::NotValidated, None));
    assert!(found.verdicts.iter().all(|verdict| !verdict.overall));
    let found = with("verdict\n  words  fit for use, not fit for use");
    assert_eq!(found.verdict_in_words(), "not fit for use");
    let found = with("verdict\n  validated  when at least 3 quantities hold");
    assert_eq!(found.verdict, Verdict::Validated);
    let found = with(
        "verdict\n  validated  when virtual_test holds\n  words  fit for use, not fit for use",
    );
    assert_eq!((found.verdict, found.verdict_word()), (Verdict::Validated, "fit for use"));
    assert_eq!(found.protocol.verdict_rule, "fit for use when virtual_test holds");
}

#[test]
fn each_verdict_is_a_node_after_those_it_is_over() {
    let compiled = compiled(&protocol());
    let graph = &compiled.graph;
    assert_eq!(graph.verdicts.len(), 10);
    let of = |name: &str| {
        compiled
            .plan
            .verdicts
            .iter()
            .position(|verdict| verdict.name.as_deref() == Some(name))
            .expect("a verdict")
    };
    let node = &graph.nodes[graph.verdicts[of("agrees")]];
    assert!(matches!(node.operation, Operation::Verdict(_)));
    assert_eq!(
        node.inputs,
        [graph.verdicts[of("virtual_test")], graph.verdicts[of("measured_test")]]
    );
    // Written before what it is over.
    let early = replaced_order();
    let graph = &early.graph;
    assert!(
        graph.verdicts[0] > graph.verdicts[1]
            && graph.nodes[graph.verdicts[0]].inputs.contains(&graph.verdicts[1])
    );
}

fn replaced_order() -> Compiled {
    compiled(&replaced(&[(
        "verdict measured_test",
        "verdict first\n  holds  when measured_test holds\n\nverdict measured_test",
    )]))
}

#[test]
fn reports_have_the_verdicts_and_lines_for_the_judgement() {
    let found = certified(&[]);
    let data = view::document(&found);
    let result = &data.cover.as_ref().expect("a cover").result;
    assert_eq!(
        (result.finding.word.as_str(), result.label.as_deref()),
        ("accepted", Some("Verdict: Acceptance by the measurement"))
    );
    assert!(!result.sentence.contains("validated"), "{}", result.sentence);
    let page =
        html::html(&data, &[]).unwrap_or_else(|problems| panic!("{}", problems.render(false)));
    for wanted in [
        "Condition of the contact surfaces",
        "<p>To be judged by the responsible test engineer: worn, or as new. Rail and wheel are looked at after the runs.</p>",
        "<dt>Judgement</dt>",
        "not assessable",
    ] {
        assert!(page.contains(wanted), "{wanted}");
    }
    let pdf = typst::typeset(&data, &[], &[])
        .unwrap_or_else(|problems| panic!("{}", problems.render(false)));
    assert!(pdf.warnings.0.is_empty(), "{}", pdf.warnings.render(false));
    let results: serde_json::Value = serde_json::from_str(&text(&found)).expect("JSON");
    assert_eq!(
        (results["verdict"].as_str(), results["verdict_word"].as_str()),
        (Some("requirements met"), Some("accepted"))
    );
    assert_eq!(results["verdicts"][4]["judged_by"], "the responsible test engineer");
    assert_eq!(results["verdicts"][4]["outcome"], "open");
}

/// The program: exit code by the overall verdict, `verify` computes the verdicts again, `study`
/// refuses one over others.
#[test]
fn the_program_certifies_verifies_and_refuses_to_study() {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = folder.path().join("campaign");
    write_campaign(&campaign);
    let run = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_fishplate"));
        let ran =
            command.current_dir(folder.path()).args(arguments).output().expect("the program runs");
        (
            ran.status.code(),
            String::from_utf8_lossy(&ran.stdout).into_owned()
                + &String::from_utf8_lossy(&ran.stderr),
        )
    };
    fs::write(folder.path().join("named.fp"), protocol()).expect("a file");
    let (code, said) = run(&[
        "certify",
        "campaign",
        "--protocol",
        "named.fp",
        "--out",
        "out",
        "--only",
        "results",
    ]);
    assert_eq!(code, Some(0), "{said}");
    for wanted in [
        "Verdict, Acceptance by the measurement: accepted\n",
        "Condition of the contact surfaces: open\n",
    ] {
        assert!(said.contains(wanted), "{said}");
    }
    let (code, said) = run(&["verify", "out", "campaign", "--protocol", "named.fp"]);
    assert_eq!(code, Some(0), "{said}");
    let results = fs::read_to_string(folder.path().join("out/results.json")).expect("results");
    for (old, new) in [
        ("\"word\": \"near\"", "\"word\": \"far\""),
        ("\"verdict_word\": \"accepted\"", "\"verdict_word\": \"excellent\""),
    ] {
        fs::write(folder.path().join("out/results.json"), results.replacen(old, new, 1))
            .expect("a file");
        let (code, said) = run(&["verify", "out", "--protocol", "named.fp"]);
        assert_eq!(code, Some(1), "{said}");
        assert!(said.contains("follows from the values"), "{said}");
    }
    let (code, said) = run(&[
        "study",
        "sections",
        "campaign",
        "--protocol",
        "named.fp",
        "--out",
        "study",
        "--take",
        "1",
    ]);
    assert_eq!(code, Some(0), "{said}");
    // A study speaks in the words of the protocol, in the terminal and in the report.
    assert!(
        said.contains("of the selections have the verdict 'accepted'")
            && said.contains("  Accepted: "),
        "{said}"
    );
    let page = fs::read_to_string(folder.path().join("study/report.html")).expect("a page");
    assert!(!page.split("id=\"protocol\"").next().unwrap_or(&page).contains("validated"));
    let json = fs::read_to_string(folder.path().join("study/study.json")).expect("study.json");
    assert!(
        json.contains("\"verdict_all_sections\": \"validated\"")
            && json.contains("\"share_validated\""),
        "{json}"
    );
    let over = protocol().replacen(
        "verdict measured_test",
        "verdict first\n  holds  when measured_test holds\n\nverdict measured_test",
        1,
    );
    fs::write(folder.path().join("over.fp"), over).expect("a file");
    let (code, said) =
        run(&["study", "sections", "campaign", "--protocol", "over.fp", "--out", "refused"]);
    assert_eq!(code, Some(2), "{said}");
    assert!(
        said.contains("error[study-verdict]: the overall verdict `first` is over other verdicts"),
        "{said}"
    );
    assert!(!folder.path().join("refused").exists());
}
