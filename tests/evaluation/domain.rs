//! Wanted operation against what the sections cover: numbers against SciPy, groups, flat hulls,
//! faults of the table.

use crate::common::texts::{text, texts};
use std::fs;
use std::path::{Path, PathBuf};

use crate::common::campaign::{certified, lines, replace, tiny};
use crate::common::program::{certify, fishplate};
use fishplate::result::{Certification, Consequence, DomainResult, Verdict};
use serde_json::Value;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

const SHIPPED: &str = "en14363-2016-annex-t-application";

/// A variant of Annex T with a domain, written beside a campaign.
fn variant(folder: &Path, rules: &str) -> String {
    let path = folder.join("variant.fp");
    fs::write(
        &path,
        format!("protocol variant \"A variant\"\n  extends  en14363-2016-annex-t\n\n{rules}"),
    )
    .expect("written");
    path.display().to_string()
}

fn run(folder: &Path, rules: &str) -> Certification {
    let protocol = variant(folder, rules);
    certified(folder, &protocol, &[])
        .unwrap_or_else(|problems| panic!("{}", problems.render(false)))
}

/// `tests/cases/domain/make.py`: inside, distance and nearest point to 1e-12, in three coordinates
/// and in two.
#[test]
fn the_hull_is_that_of_scipy() {
    let expected: Value =
        serde_json::from_str(include_str!("../cases/domain/expected.json")).expect("JSON");
    let coach = root().join("examples/coach-good");
    let three = certified(&coach, SHIPPED, &[]).expect("a result");
    let folder = tempfile::tempdir().expect("a folder");
    let protocol = variant(folder.path(), "domain two\n  over  speed, cant_deficiency\n");
    let two = certified(&coach, &protocol, &[]).expect("a result");
    for (found, key) in [(&three, "three"), (&two, "two")] {
        let [result] = found.application.as_slice() else { panic!("one domain") };
        let expected = &expected[key];
        let mut corners: Vec<&str> = result
            .sections
            .iter()
            .filter(|one| one.corner)
            .map(|one| one.section.as_str())
            .collect();
        corners.sort_unstable();
        assert_eq!(serde_json::json!(corners), expected["corners"], "{key}");
        let points = expected["points"].as_array().expect("a list");
        assert_eq!(result.points.len(), points.len());
        for (found, expected) in result.points.iter().zip(points) {
            let near = |found: f64, expected: &Value| {
                (found - expected.as_f64().expect("a number")).abs() < 1e-12 * (1.0 + found.abs())
            };
            assert_eq!(
                (found.point.as_str(), found.inside),
                (expected["point"].as_str().expect("a name"), expected["inside"].as_bool())
            );
            assert!(
                near(found.distance.expect("a hull"), &expected["distance"]),
                "{key} {}",
                found.point
            );
            let nearest = found.nearest.as_ref().expect("a hull");
            let all = nearest.iter().zip(expected["nearest"].as_array().expect("a list"));
            assert!(
                all.into_iter().all(|(found, expected)| near(*found, expected)),
                "{key} {}: {nearest:?}",
                found.point
            );
            assert_eq!(found.nearest_section.as_deref(), expected["nearest_section"].as_str());
            assert!(
                near(found.section_distance.expect("a section"), &expected["section_distance"]),
                "{key} {}",
                found.point
            );
            let outside = found.outside_by.as_ref().expect("a hull");
            assert!(
                (0..nearest.len())
                    .all(|at| (outside[at] - (found.values[at] - nearest[at])).abs() < 1e-9),
                "{key} {}",
                found.point
            );
        }
    }
    // Told, and changes nothing.
    assert_eq!(three.verdict, Verdict::Validated);
    let told = three.findings.iter().filter(|finding| {
        finding.code == "outside-domain" && finding.consequence == Consequence::Note
    });
    assert_eq!(told.count(), 5);
    // Within every range, and outside the hull.
    let gentle = three.application[0]
        .points
        .iter()
        .find(|point| point.point == "gentle curve")
        .expect("there");
    assert_eq!(
        (gentle.inside, gentle.beyond_range.as_deref()),
        (Some(false), Some(&[0.0, 0.0, 0.0][..]))
    );
}

/// [`tiny`] with a state: straights and zone 2 tare, zones 3 and 4 laden; wanted operation of three
/// states.
fn two_states() -> tempfile::TempDir {
    let folder = tiny();
    lines(&folder.path().join("sections.csv"), |lines| {
        lines[0].push_str(",state");
        for (nth, line) in lines.iter_mut().skip(1).enumerate() {
            line.push_str(if nth < 6 { ",tare" } else { ",laden" });
            // Speeds that differ, so that the hull is not flat.
            let (rest, state) = line.rsplit_once(',').expect("cells");
            let (rest, speed) = rest.rsplit_once(',').expect("cells");
            let speed = speed.parse::<f64>().expect("a number") + (nth % 3) as f64;
            *line = format!("{rest},{speed},{state}");
        }
    });
    replace(
        &folder.path().join("campaign.yaml"),
        "sections: sections.csv",
        "sections: sections.csv\napplication: wanted.csv",
    );
    let wanted = "point,state,cant deficiency [mm],speed [m/s],remark\na,tare,0,40.1,inside\nb,tare,0,50,outside\nc,laden,40,20,none\n\
                  d,empty,0,10,no section\n";
    fs::write(folder.path().join("wanted.csv"), wanted).expect("written");
    folder
}

const STATES: &str = "section state \"State\"\n  one of  tare, laden, empty\n\ndomain wanted \"Wanted\"\n  over  speed, cant_deficiency for each state\n";

#[track_caller]
fn of<'a>(found: &'a Certification, scope: &str) -> &'a DomainResult {
    found
        .application
        .iter()
        .find(|result| result.scope == scope)
        .unwrap_or_else(|| panic!("no {scope}"))
}

#[test]
fn every_group_has_its_own_hull() {
    let folder = two_states();
    let found = run(folder.path(), STATES);
    let scopes: Vec<&str> = found.application.iter().map(|result| result.scope.as_str()).collect();
    assert_eq!(scopes, ["State tare", "State laden", "State empty"]);
    let tare = of(&found, "State tare");
    assert_eq!(
        (tare.group["state"].as_str(), tare.sections.len(), text(&tare.reason).as_deref()),
        ("tare", 6, None)
    );
    // The table is in m/s, results are in the unit of the section data.
    assert!((tare.points[0].values[0] - 40.1 * 3.6).abs() < 1e-9);
    assert_eq!((tare.points[0].inside, tare.points[1].inside), (Some(true), Some(false)));
    // Speed 144 to 146 km/h at 0 mm: 180 km/h is 34 km/h beyond them, of a range of 108 to 146.
    let beyond = tare.points[1].beyond_range.as_ref().expect("sections");
    assert!((beyond[0] - 34.0).abs() < 1e-9 && beyond[1] == 0.0, "{beyond:?}");
    let empty = of(&found, "State empty");
    assert_eq!(text(&empty.reason).as_deref(), Some("no section of State empty is used"));
    assert_eq!((empty.points[0].inside, empty.points[0].nearest_section.as_deref()), (None, None));
    let codes: Vec<&str> = found
        .findings
        .iter()
        .map(|finding| finding.code.as_str())
        .filter(|code| code.ends_with("domain"))
        .collect();
    assert_eq!(codes.iter().filter(|code| **code == "no-domain").count(), 1);
    assert_eq!(found.verdict, Verdict::Validated);
}

#[test]
fn what_lies_outside_can_decide() {
    let folder = two_states();
    let found = run(folder.path(), &format!("{STATES}  otherwise  not assessable\n"));
    assert_eq!(found.verdict, Verdict::NotAssessable);
    assert_eq!(
        texts(&found.reasons)[0],
        "Wanted, State tare: 1 of 2 points of wanted operation outside what the sections cover; see the findings"
    );
    assert!(
        texts(&found.reasons)
            .contains(&"Wanted, State empty: no section of State empty is used".to_string()),
        "{:?}",
        texts(&found.reasons)
    );
}

#[test]
fn flat_hulls_are_said_to_be_flat() {
    let folder = two_states();
    for (over, reason) in [
        ("speed, 2 * speed", "the sections lie on one line: their hull is flat"),
        (
            "speed, cant_deficiency, speed + cant_deficiency * 1 km/h/mm",
            "the sections lie in one plane: their hull is flat",
        ),
        (
            "speed, cant_deficiency * 0",
            "all sections have the same value of Cant deficiency * 0: their hull is flat",
        ),
    ] {
        let found = run(folder.path(), &format!("domain flat \"Flat\"\n  over  {over}\n"));
        assert_eq!(text(&found.application[0].reason).as_deref(), Some(reason), "{over}");
        assert!(
            found.application[0]
                .points
                .iter()
                .all(|point| point.inside.is_none() && point.distance.is_none())
        );
        assert!(found.application[0].sections.iter().all(|section| !section.corner));
    }
    // One coordinate: the hull is the range.
    let found = run(folder.path(), "domain one \"One\"\n  over  speed\n");
    let inside: Vec<Option<bool>> =
        found.application[0].points.iter().map(|point| point.inside).collect();
    assert_eq!(inside, [Some(true), Some(false), Some(true), Some(false)]);
    // Radii of straights are empty.
    let found = run(
        folder.path(),
        "domain radii \"Radii\"\n  over  speed, radius + 0 * speed * 1 s\n  otherwise  note\n\nsection radius\n  default  0 m\n",
    );
    assert_eq!(found.application[0].left_out.len(), 0);
}

#[test]
fn sections_without_a_value_are_left_out() {
    let folder = two_states();
    lines(&folder.path().join("wanted.csv"), |lines| {
        lines.truncate(2);
        lines[0].push_str(",radius [m]");
        lines[1].push_str(",400");
    });
    let found = run(folder.path(), "domain radii \"Radii\"\n  over  speed, 1 / radius\n");
    assert_eq!(found.application[0].left_out, ["S01", "S02", "S03"]);
    assert_eq!(found.application[0].sections.len(), 9);
}

/// Each fault stands at its place; nothing is written.
#[test]
fn faults_of_the_table() {
    let faults: [(&str, &str, &[&str]); 8] = [
        (
            "speed [m/s]",
            "velocity [m/s]",
            &["missing-column", "wanted.csv:1:1", "no column `speed`"],
        ),
        ("speed [m/s]", "speed [kN]", &["unit-mismatch", "wanted.csv:1:", "a speed is needed"]),
        ("speed [m/s]", "speed", &["unit-missing", "wanted.csv:1:"]),
        ("point,", "name,", &["unknown-column", "no column `point`"]),
        ("\nb,", "\na,", &["duplicate-name", "wanted.csv:3:1"]),
        (
            "tare,0,50",
            "tare,0,fast",
            &["wanted-value", "wanted.csv:3:10", "`fast` is not a number"],
        ),
        ("tare,0,50", "tare,0,", &["wanted-value", "wanted.csv:3:1", "`speed` is empty"]),
        ("b,tare", "b,tara", &["wanted-value", "wanted.csv:3:3", "did you mean `tare`?"]),
    ];
    for (from, to, words) in faults {
        let folder = two_states();
        replace(&folder.path().join("wanted.csv"), from, to);
        refused(folder.path(), words);
    }
    let folder = two_states();
    lines(&folder.path().join("wanted.csv"), |lines| lines.truncate(1));
    refused(folder.path(), &["no-rows", "wanted.csv:1:1"]);
    let folder = two_states();
    replace(&folder.path().join("campaign.yaml"), "application: wanted.csv\n", "");
    refused(
        folder.path(),
        &["key-missing", "campaign.yaml:1:1", "no `application`", "variant.fp:"],
    );
    let folder = two_states();
    replace(&folder.path().join("campaign.yaml"), "application:", "aplication:");
    refused(folder.path(), &["unknown-key", "did you mean `application`?"]);
    let folder = two_states();
    replace(&folder.path().join("campaign.yaml"), "wanted.csv", "../wanted.csv");
    refused(folder.path(), &["path-outside"]);
}

#[track_caller]
fn refused(folder: &Path, words: &[&str]) {
    let protocol = variant(folder, STATES);
    let found = certify(folder, &["--protocol", &protocol, "--only", "results"]);
    assert_eq!(found.ran.code, 2, "{}", found.ran.stderr);
    for word in words {
        assert!(found.ran.stderr.contains(word), "`{word}` is not in:\n{}", found.ran.stderr);
    }
}

/// What the result says of wanted operation follows from the values in it; a changed word is found.
#[test]
fn a_report_is_verified() {
    let folder = two_states();
    let protocol = variant(folder.path(), &format!("{STATES}  otherwise  not assessable\n"));
    let found = certify(folder.path(), &["--protocol", &protocol, "--only", "html"]);
    assert_eq!(found.ran.code, 1, "{}", found.ran.stderr);
    assert!(
        found
            .text("tables/application.csv")
            .starts_with("domain,scope,point,inside,distance,coordinate,unit,value,")
    );
    let page = found.text("report.html");
    assert!(
        page.contains("1 of 2 points of wanted operation lie outside")
            && page.contains("figure-application-0")
    );
    let results = found.folder().join("results.json").display().to_string();
    let verify = || {
        fishplate(&[
            "verify",
            &results,
            "--protocol",
            &protocol,
            &folder.path().display().to_string(),
        ])
    };
    let good = verify();
    assert_eq!(good.code, 0, "{}{}", good.stdout, good.stderr);
    replace(Path::new(&results), "\"inside\": false", "\"inside\": true");
    let changed = verify();
    assert_eq!(changed.code, 1, "{}{}", changed.stdout, changed.stderr);
    assert!(
        format!("{}{}", changed.stdout, changed.stderr).contains("application[0].points[1].inside"),
        "{}",
        changed.stdout
    );
}
