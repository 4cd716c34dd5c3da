//! `verify`: everything agrees as written; whatever is changed, in the campaign or in the report,
//! is told by its name.

use std::fs;
use std::path::Path;

use super::campaign::{cell, copy, lines, replace};
use super::program::{Ran, fishplate};
use super::{check, example, root, text, written};

fn verify(report: &Path, campaign: Option<&Path>, more: &[&str]) -> Ran {
    let (report, campaign) = (text(report), campaign.map(text));
    let mut arguments = vec!["verify", report.as_str()];
    arguments.extend(campaign.as_deref());
    arguments.extend(more);
    fishplate(&arguments)
}

#[test]
fn what_was_written_agrees_from_every_side() {
    let written = written();
    let campaign = written.campaign();
    for report in [written.pdf(), written.out(), written.results()] {
        let alone = verify(&report, None, &["--report-only"]);
        assert_eq!(alone.code, 0, "{}{}", alone.stdout, alone.stderr);
        for name in ["form", "protocol text", "protocol rules", "statistics"] {
            assert!(check(&alone, name).starts_with("agrees"), "{}", alone.stdout);
        }
        let both = verify(&report, Some(&campaign), &[]);
        assert_eq!(both.code, 0, "{}{}", both.stdout, both.stderr);
        assert!(
            check(&both, "input files").contains("42 files")
                && check(&both, "run again").starts_with("agrees"),
            "{}",
            both.stdout
        );
    }
    let pages = verify(&written.pdf(), Some(&campaign), &["--jobs", "1"]);
    assert!(check(&pages, "pages").contains("byte for byte"), "{}", pages.stdout);
    assert!(check(&pages, "protocol text").contains("4 files"), "{}", pages.stdout);
    let folder = verify(&written.out(), None, &[]);
    assert!(
        check(&folder, "statement").starts_with("agrees")
            && check(&folder, "results.json").starts_with("agrees")
    );
    // Nothing but the report is needed: the campaign's protocol may be gone.
    let bare = copy(&campaign);
    fs::remove_dir_all(bare.path().join("rules")).expect("removed");
    let ran = verify(&written.pdf(), Some(bare.path()), &[]);
    assert_eq!(ran.code, 0, "{}{}", ran.stdout, ran.stderr);
}

/// Results without a report find their protocol by its hash: shipped, or named.
#[test]
fn results_alone_find_their_protocol_by_its_hash() {
    let written = written();
    let bare = tempfile::tempdir().expect("a folder");
    let results = bare.path().join("results.json");
    fs::copy(written.results(), &results).expect("copied");
    let ran = verify(&results, None, &[]);
    assert_eq!(ran.code, 3, "{}", ran.stdout);
    assert!(
        check(&ran, "protocol text").contains("--protocol")
            && ran.stdout.contains("Result: the check could not be completed"),
        "{}",
        ran.stdout
    );
    let ran = verify(&results, Some(&written.campaign()), &[]);
    assert!(ran.code == 3 && check(&ran, "input files").starts_with("agrees"), "{}", ran.stdout);
    let given = text(&written.campaign().join("rules/p.fp"));
    let ran = verify(&results, Some(&written.campaign()), &["--protocol", &given]);
    assert_eq!(ran.code, 0, "{}{}", ran.stdout, ran.stderr);
    assert!(check(&ran, "run again").starts_with("agrees"), "{}", ran.stdout);
    let other = verify(&results, None, &["--protocol", "sprague-geers"]);
    assert!(check(&other, "protocol text").starts_with("NOT POSSIBLE"), "{}", other.stdout);
}

/// Metrics without sides, whole records without sections: every kind of protocol can be replayed
/// and run again.
#[test]
fn other_kinds_of_protocols_agree_too() {
    for (campaign, more) in [
        ("coach-good", vec![]),
        ("sprague-geers", vec!["--protocol", "sprague-geers"]),
        ("sway", vec!["--protocol", "stationary-sway"]),
    ] {
        let out = tempfile::tempdir().expect("a folder");
        let (folder, to) = (text(&example(campaign)), text(out.path()));
        let mut arguments = vec!["certify", &folder, "--out", &to, "--only", "results", "-q"];
        arguments.extend(more);
        let ran = fishplate(&arguments);
        assert!(ran.code <= 1, "{campaign}: {}", ran.stderr);
        let ran = verify(out.path(), Some(&example(campaign)), &[]);
        assert_eq!(ran.code, 0, "{campaign}: {}{}", ran.stdout, ran.stderr);
        assert!(check(&ran, "statistics").starts_with("agrees"), "{}", ran.stdout);
    }
}

#[test]
fn a_changed_campaign_is_told_by_file_and_number() {
    let written = written();
    let changed = |change: &dyn Fn(&Path)| {
        let campaign = copy(&written.campaign());
        change(campaign.path());
        let ran = verify(&written.pdf(), Some(campaign.path()), &["--all"]);
        assert_eq!(ran.code, 1, "{}{}", ran.stdout, ran.stderr);
        assert!(ran.stdout.contains("Result: differs ("), "{}", ran.stdout);
        ran.stdout
    };
    // One sample.
    let out =
        changed(&|campaign| cell(&campaign.join("measurement/S05.csv"), 361, "Y_1R [kN]", "11.29"));
    assert!(out.contains("changed: measurement/S05.csv: SHA-256 "), "{out}");
    assert!(
        out.contains("].measured (Y_max, zone 2, S05, Y_1R): ") && out.contains(" in the report, "),
        "{out}"
    );
    assert!(!out.contains("measurement/S06.csv"), "{out}");
    // A byte that changes no number.
    let out = changed(&|campaign| {
        lines(&campaign.join("sections.csv"), |lines| lines.push(String::new()))
    });
    assert!(out.contains("changed: sections.csv") && out.contains("all 2"), "{out}");
    assert!(out.contains("not checked  pages"), "what differs already is not told twice: {out}");
    // A record gone.
    let out =
        changed(&|campaign| fs::remove_file(campaign.join("simulation/S01.csv")).expect("removed"));
    assert!(
        out.contains("missing: simulation/S01.csv")
            && out.contains("no longer read: simulation/S01.csv"),
        "{out}"
    );
    assert!(out.contains("sections[0].used (zone 1, S01): true in the report, false now"), "{out}");
    assert!(out.contains("verdict: `not validated` in the report, `not assessable` now"), "{out}");
    // A section more.
    let out = changed(&|campaign| {
        for kind in ["simulation", "measurement", "track"] {
            fs::copy(campaign.join(kind).join("S01.csv"), campaign.join(kind).join("X01.csv"))
                .expect("copied");
        }
        lines(&campaign.join("sections.csv"), |lines| {
            let more = lines[1].replacen("S01", "X01", 1);
            lines.push(more);
        });
    });
    assert!(
        out.contains("extra: measurement/X01.csv is read now, but was not read for the report"),
        "{out}"
    );
    assert!(out.contains("(zone 1, X01): missing in the report"), "{out}");
    // The vehicle.
    let out = changed(&|campaign| {
        replace(&campaign.join("vehicle.yaml"), "category: passenger", "category: freight")
    });
    assert!(out.contains("changed: vehicle.yaml") && out.contains("limit_std"), "{out}");
    // No campaign any more.
    let out =
        changed(&|campaign| fs::write(campaign.join("campaign.yaml"), "name: [").expect("written"));
    assert!(
        out.contains("changed: campaign.yaml")
            && out.contains("the campaign can no longer be evaluated"),
        "{out}"
    );
}

/// Every kind of number and word in the results, changed by hand: the check that must find it,
/// without the campaign.
#[test]
fn changed_results_do_not_agree_with_themselves() {
    let written = written();
    let whole = fs::read_to_string(written.results()).expect("readable");
    let parsed: serde_json::Value = serde_json::from_str(&whole).expect("JSON");
    let folder = tempfile::tempdir().expect("a folder");
    // The report beside them gives the protocol only if it carries the same results, so it is
    // named.
    let protocol = text(&written.campaign().join("rules/p.fp"));
    let found = |change: &dyn Fn(&mut serde_json::Value)| {
        let mut changed = parsed.clone();
        change(&mut changed);
        assert!(changed != parsed, "nothing was changed");
        let path = folder.path().join("results.json");
        fs::write(&path, serde_json::to_string_pretty(&changed).expect("JSON") + "\n")
            .expect("written");
        let ran = verify(&path, None, &["--protocol", &protocol]);
        assert_eq!(ran.code, 1, "{}{}", ran.stdout, ran.stderr);
        ran
    };
    let number = |value: &mut serde_json::Value, by: f64| {
        *value = serde_json::json!(value.as_f64().expect("a number") + by)
    };
    type Change<'a> = (&'a str, &'a dyn Fn(&mut serde_json::Value));
    let changes: &[Change<'_>] = &[
        ("statistics", &|all| all["verdict"] = "validated".into()),
        ("statistics", &|all| all["reasons"] = serde_json::json!([])),
        ("statistics", &|all| number(&mut all["quantities"][2]["mean"], -0.02)),
        ("statistics", &|all| number(&mut all["quantities"][2]["limit_mean"], 0.1)),
        ("statistics", &|all| all["quantities"][2]["holds"] = true.into()),
        ("statistics", &|all| {
            number(&mut all["quantities"][0]["statistics"][0]["normalised"], 0.001)
        }),
        ("statistics", &|all| number(&mut all["quantities"][4]["values"][17]["measured"], 0.01)),
        ("statistics", &|all| number(&mut all["quantities"][4]["values"][17]["difference"], 1e-6)),
        ("statistics", &|all| all["quantities"][4]["statistics"][0]["rule"]["line"] = 6.into()),
        ("statistics", &|all| all["quantities"][4]["pairs"] = 51.into()),
        ("statistics", &|all| drop(all["quantities"][4]["values"].as_array_mut().map(Vec::pop))),
        ("statistics", &|all| all["sections"][3]["used"] = false.into()),
        ("statistics", &|all| all["zones"][0]["used"] = 2.into()),
        // A curve of this radius is of another zone.
        ("statistics", &|all| {
            let columns = all["sections"][12]["columns"].as_array_mut().expect("a list");
            let radius = columns
                .iter_mut()
                .find(|column| column["name"] == "radius" || column["unit"] == "m")
                .expect("a radius");
            radius["value"] = "5000".into();
        }),
        ("protocol rules", &|all| all["protocol"]["title"] = "Theirs".into()),
        ("protocol rules", &|all| all["protocol"]["parameters"][0]["default"] = "9".into()),
        ("protocol rules", &|all| all["protocol"]["deviations"] = serde_json::json!([])),
        ("protocol text", &|all| all["protocol"]["sha256"] = "00".into()),
    ];
    for (at, (name, change)) in changes.iter().enumerate() {
        let ran = found(change);
        assert!(check(&ran, name).starts_with("DIFFERS"), "change {at}: {}", ran.stdout);
    }
    // A key twice: readers differ in which one they take.
    let path = folder.path().join("results.json");
    fs::write(
        &path,
        whole.replacen("  \"verdict\"", "  \"verdict\": \"validated\",\n  \"verdict\"", 1),
    )
    .expect("written");
    let ran = verify(&path, None, &["--protocol", &protocol]);
    assert_eq!(ran.code, 1);
    assert!(check(&ran, "form").starts_with("DIFFERS"), "{}", ran.stdout);
}

/// Files of an output folder that are of different runs.
#[test]
fn a_folder_of_two_runs_is_told() {
    let folder = copy(&written().out());
    replace(&folder.path().join("results.json"), "\"zone\": 2", "\"zone\": 3");
    replace(&folder.path().join("tables/summary.csv"), "kN", "MN");
    fs::remove_file(folder.path().join("report.html")).expect("removed");
    let ran = verify(folder.path(), None, &[]);
    assert_eq!(ran.code, 1, "{}", ran.stdout);
    assert!(check(&ran, "results.json").starts_with("DIFFERS"), "{}", ran.stdout);
    for says in ["changed: results.json", "changed: tables/summary.csv", "missing: report.html"] {
        assert!(ran.stdout.contains(says), "{says}:\n{}", ran.stdout);
    }
}

/// One byte of a page: the numbers inside stay as they are, the pages do not.
#[test]
fn a_changed_page_is_told() {
    let written = written();
    let mut bytes = fs::read(written.pdf()).expect("readable");
    let stream = bytes.windows(7).position(|window| window == b"stream\n").expect("a stream") + 40;
    bytes[stream] ^= 1;
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("changed.pdf");
    fs::write(&path, &bytes).expect("written");
    let ran = verify(&path, Some(&written.campaign()), &[]);
    assert_eq!(ran.code, 1, "{}", ran.stdout);
    assert!(
        check(&ran, "pages").starts_with("DIFFERS")
            && check(&ran, "run again").starts_with("agrees"),
        "{}",
        ran.stdout
    );
    let plots = verify(&written.pdf(), Some(&written.campaign()), &["--plots", "2"]);
    assert!(plots.code == 1 && plots.stdout.contains("--plots"), "{}", plots.stdout);
}

#[test]
fn paths_in_a_report_do_not_leave_the_campaign() {
    let folder = copy(&written().out());
    let path = folder.path().join("results.json");
    replace(&path, "\"path\": \"sections.csv\"", "\"path\": \"../../../../etc/passwd\"");
    fs::remove_file(folder.path().join("report.pdf")).expect("removed");
    let ran = verify(&path, Some(&written().campaign()), &[]);
    assert_eq!(ran.code, 1, "{}", ran.stdout);
    assert!(ran.stdout.contains("not readable: ../../../../etc/passwd"), "{}", ran.stdout);
}

#[test]
fn what_is_no_report_is_refused_with_help() {
    let folder = tempfile::tempdir().expect("a folder");
    let refused = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).expect("written");
        let ran = verify(&path, None, &[]);
        assert_eq!(ran.code, 2, "{name}: {}{}", ran.stdout, ran.stderr);
        assert!(ran.stdout.is_empty());
        ran.stderr
    };
    assert!(refused("a.pdf", b"hello").contains("is not a PDF"));
    assert!(
        refused("a.json", b"{}")
            .contains("not a results file of `certify`: missing field `fishplate`")
    );
    assert!(refused("a.json", b"{\"a\": ").contains("results-unreadable"));
    assert!(refused("a.json", b"").contains("file-empty"));
    assert!(refused("a.json", &[b'['; 100_000]).contains("results-unreadable"));
    let many = format!("[{}0]", "0,".repeat(9_000_000));
    assert!(refused("a.json", many.as_bytes()).contains("more than 2000000 values"));
    let ran = verify(folder.path(), None, &[]);
    assert!(ran.code == 2 && ran.stderr.contains("there is neither"), "{}", ran.stderr);
    assert_eq!(verify(&folder.path().join("none.pdf"), None, &[]).code, 2);
    let ran = verify(&written().pdf(), Some(&folder.path().join("nowhere")), &[]);
    assert!(ran.code == 2 && ran.stderr.contains("folder-missing"), "{}", ran.stderr);
    // A report of a study carries other numbers.
    let out = text(&folder.path().join("study"));
    let study = fishplate(&["study", "sections", &text(&example("coach")), "--out", &out, "-q"]);
    assert!(study.code <= 1, "{}", study.stderr);
    let ran = verify(&folder.path().join("study/report.pdf"), None, &[]);
    assert!(
        ran.code == 2
            && ran.stderr.contains("written by `study`; its attachments are study.json; only"),
        "{}",
        ran.stderr
    );
}

/// Results of the first versions state no format: they are read, verified and traced as those of
/// now. The file was written by version 0.1.0.
#[test]
fn results_without_a_format_are_verified_and_traced() {
    let results = root().join("tests/cases/provenance/without-format.json");
    let campaign = example("two-link-arm");
    let protocol = campaign.join("protocol.fp");
    let ran =
        fishplate(&["verify", &text(&results), &text(&campaign), "--protocol", &text(&protocol)]);
    assert_eq!(ran.code, 0, "{}{}", ran.stdout, ran.stderr);
    let changed = tempfile::tempdir().expect("a temporary folder");
    let changed = changed.path().join("results.json");
    let before = std::fs::read_to_string(&results).expect("readable");
    let after = before.replacen("\"holds\": true", "\"holds\": false", 1);
    assert_ne!(before, after);
    std::fs::create_dir_all(changed.parent().expect("a folder")).expect("made");
    std::fs::write(&changed, after).expect("written");
    let ran = fishplate(&["verify", &text(&changed), "--protocol", &text(&protocol)]);
    assert_eq!(ran.code, 1, "{}{}", ran.stdout, ran.stderr);
}
