//! Section data that the protocol computes from others: words from numbers, numbers from numbers,
//! and what has no value or is stated twice. Numbers follow from the table of sections by the
//! formula written here; groups by computed words are those by the same words, typed.

use std::fs;
use std::path::Path;

use tempfile::TempDir;

use crate::common::campaign::{certified, lines, replace, tiny};
use crate::common::program::{certify, fishplate};
use fishplate::result::{Certification, SectionResult};

/// Conicity of S01 to S12, and its class: an edge is in the class above it.
const CONICITY: [(&str, &str); 12] = [
    ("0", "low"),
    ("0.1", "medium"),
    ("0.0999999999999", "low"),
    ("0.25", "high"),
    ("0.2499999999999", "medium"),
    ("0.7", "high"),
    ("", ""),
    ("0.05", "low"),
    ("0.10", "medium"),
    ("2.5e-1", "high"),
    ("0.3", "high"),
    ("0.2", "medium"),
];

/// The first section of [`tiny`] with a curve, counted from 0.
const FIRST_CURVE: usize = 3;

const HEAD: &str = r#"protocol classes "Classes of conicity"
  axis  distance in m
  time  time in s

place gear
  members  I, II

channel ay "Lateral acceleration"
  in  m/s^2
  at  each gear

section conicity "Equivalent conicity"
  in  -

section radius "Radius"
  in  m

section cant "Cant"
  in  mm

section speed "Speed"
  in  km/h

quantity ay_rms "Lateral acceleration, rms value"
  of          ay
  value       rms
  difference  simulated - measured
  limit       mean 1 m/s^2
"#;

const CLASS: &str = "section class \"Class of conicity\"\n  one of  low, medium, high\n";
const IS: &str = "  is      low when conicity < 0.1, medium when conicity < 0.25, otherwise high\n";
const BY_CLASS: &str = "quantity by_class \"The same by classes\"\n  of          ay\n  value       p95\n  difference  simulated - measured\n  limit       std 0.5 m/s^2 for each class\n  report      maximum for each class\n";

/// [`tiny`] with the conicities.
fn campaign() -> TempDir {
    let folder = tiny();
    lines(&folder.path().join("sections.csv"), |lines| {
        lines[0] += ",conicity [-]";
        for (line, (conicity, _)) in lines[1..].iter_mut().zip(CONICITY) {
            *line = format!("{line},{conicity}");
        }
    });
    folder
}

fn protocol(folder: &Path, rules: &[&str]) -> String {
    let path = folder.join("classes.fp");
    fs::write(&path, [&[HEAD], rules].concat().join("\n")).expect("written");
    path.display().to_string()
}

#[track_caller]
fn run(folder: &Path, rules: &[&str]) -> Certification {
    certified(folder, &protocol(folder, rules), &[])
        .unwrap_or_else(|problems| panic!("{}", problems.render(false)))
}

/// The problems of a run that is refused.
#[track_caller]
fn refused(folder: &Path, rules: &[&str]) -> String {
    let found = certify(folder, &["--protocol", &protocol(folder, rules), "--only", "results"]);
    assert_eq!(found.ran.code, 2, "{}", found.ran.stdout);
    found.ran.stderr
}

fn datum<'a>(section: &'a SectionResult, title: &str) -> &'a str {
    let found = section.columns.iter().find(|column| column.name == title);
    &found.unwrap_or_else(|| panic!("no `{title}`")).value
}

fn words(found: &Certification, title: &str) -> Vec<String> {
    found.sections.iter().map(|section| datum(section, title).to_string()).collect()
}

/// Why sections are not used, by name.
fn unused(found: &Certification) -> Vec<(String, String)> {
    let of = |section: &SectionResult| {
        let reason = section.reason.as_ref()?;
        Some((section.section.clone(), reason.text().to_string()))
    };
    found.sections.iter().filter_map(of).collect()
}

/// An edge is in the class above it, however it is written; an empty cell is in none. Every number
/// by classes is that of the campaign in which the words were typed.
#[test]
fn words_follow_from_numbers() {
    let folder = campaign();
    let computed = run(folder.path(), &[CLASS, IS, BY_CLASS]);
    assert_eq!(words(&computed, "Class of conicity"), CONICITY.map(|(_, class)| class));
    assert!(unused(&computed).is_empty());

    lines(&folder.path().join("sections.csv"), |lines| {
        lines[0] += ",class";
        for (line, (_, class)) in lines[1..].iter_mut().zip(CONICITY) {
            *line = format!("{line},{class}");
        }
    });
    let typed = run(folder.path(), &[CLASS, BY_CLASS]);
    let numbers = |found: &Certification| {
        let of = found.quantities.iter().find(|one| one.id == "by_class").expect("the quantity");
        let statistics =
            of.statistics.iter().map(|one| (one.scope.keys.clone(), one.value, one.holds));
        let reported = of.reported.iter().map(|one| (one.scope.keys.clone(), one.value, None));
        statistics.chain(reported).collect::<Vec<_>>()
    };
    // Three classes, and the section of none of them.
    assert_eq!(numbers(&computed).len(), 2 * 4);
    assert_eq!(numbers(&computed), numbers(&typed));
}

/// Data may use others that stand further down, and the vehicle: the cant deficiency is that of the
/// formula, its class that of this number.
#[test]
fn numbers_follow_from_numbers() {
    let rules = [
        "section large \"Large deficiency\"\n  one of  true, false\n  is      deficiency > most",
        "section most \"Largest deficiency\"\n  in  mm\n  is  90 mm when vehicle.category is freight, otherwise 130 mm",
        "section deficiency \"Deficiency\"\n  in  mm\n  is  1500 mm * speed^2 / (9.81 m/s^2 * radius) - cant when radius > 0 m",
        "vehicle category \"Category\"\n  one of  passenger, freight",
    ];
    let folder = campaign();
    for (category, most) in [("passenger", 130.0), ("freight", 90.0)] {
        let vehicle = folder.path().join("vehicle.yaml");
        let text = fs::read_to_string(&vehicle).expect("readable");
        fs::write(&vehicle, text.replace("category: passenger", &format!("category: {category}")))
            .expect("written");
        let found = run(folder.path(), &rules);
        let number = |section: &SectionResult, title: &str| {
            datum(section, title).parse::<f64>().expect("a number")
        };
        for section in &found.sections[..FIRST_CURVE] {
            assert_eq!(
                (datum(section, "Deficiency"), datum(section, "Large deficiency")),
                ("", "")
            );
        }
        let mut large = 0;
        for section in &found.sections[FIRST_CURVE..] {
            let speed = number(section, "Speed") / 3.6;
            let expected = 1500.0 * speed.powi(2) / (9.81 * number(section, "Radius"))
                - number(section, "Cant");
            assert!((number(section, "Deficiency") - expected).abs() < 1e-9, "{expected}");
            assert_eq!(number(section, "Largest deficiency"), most);
            let is_large = expected > most;
            assert_eq!(datum(section, "Large deficiency"), is_large.to_string());
            large += usize::from(is_large);
        }
        // Of three kinds of curves, with 87.6 mm, 101.2 mm and 108.9 mm.
        assert_eq!(large, if most > 110.0 { 0 } else { 6 }, "{category}");
    }
}

/// What has no value is told where a rule needs it, with the reason; it is never a number.
#[test]
fn what_has_no_value() {
    let rest = "quantity high_only \"Where the class is high\"\n  of          ay\n  value       rms\n  where       class is high\n  difference  simulated - measured\n  limit       mean 1 m/s^2";
    let closed = IS.replace("otherwise high", "high when conicity <= 0.5");
    let folder = campaign();
    let found = run(folder.path(), &[CLASS, &closed]);
    // Nothing needs the class.
    assert!(unused(&found).is_empty());
    assert_eq!(datum(&found.sections[5], "Class of conicity"), "");
    let found = run(folder.path(), &[CLASS, &closed, rest]);
    let (none, empty) = (
        "no case of `low when conicity < 0.1, medium when conicity < 0.25, high when conicity <= 0.5` applies",
        "`conicity` is empty (sections.csv, row 8)",
    );
    let expected = [("S06", none), ("S07", empty)].map(|(name, why)| (name.into(), why.into()));
    assert_eq!(unused(&found), expected);

    let inverse = "section inverse \"Inverse\"\n  in  -\n  is  1 / conicity\n\nsection steep \"Steep\"\n  one of  true, false\n  is      inverse < 100";
    let steep = rest.replace("class is high", "steep");
    let found = run(folder.path(), &[inverse, &steep]);
    let expected = [("S01", "`1 / conicity` is not a finite number"), ("S07", empty)];
    let told = unused(&found);
    assert_eq!(told.len(), expected.len(), "{told:?}");
    for ((section, says), (name, why)) in told.iter().zip(expected) {
        assert!(section == name && says.contains(why), "{told:?}");
    }
}

/// Of an optional column that is absent nothing follows: what needs it is not assessed, also when a
/// result is verified. A word that was changed in a result is found.
#[test]
fn what_is_absent_and_what_is_changed() {
    let folder = campaign();
    let rules = [CLASS, IS, BY_CLASS];
    let path = protocol(folder.path(), &rules);
    let out = |name: &str| folder.path().join(name).display().to_string();
    let ran = |out: &str| {
        let campaign = folder.path().display().to_string();
        let ran = fishplate(&[
            "certify",
            &campaign,
            "--protocol",
            &path,
            "--only",
            "results",
            "--out",
            out,
        ]);
        assert_eq!(ran.code, 0, "{}{}", ran.stdout, ran.stderr);
        format!("{out}/results.json")
    };
    let verify =
        |results: &str| fishplate(&["verify", results, "--protocol", &path, "--report-only"]);
    let results = ran(&out("whole"));
    let good = verify(&results);
    assert_eq!(good.code, 0, "{}{}", good.stdout, good.stderr);
    replace(Path::new(&results), "\"value\": \"low\"", "\"value\": \"high\"");
    let campaign = folder.path().display().to_string();
    let changed = fishplate(&["verify", &results, "--protocol", &path, &campaign]);
    assert_eq!(changed.code, 1, "{}{}", changed.stdout, changed.stderr);
    assert!(changed.stdout.contains("sections[0].columns[4].value"), "{}", changed.stdout);

    replace(
        Path::new(&path),
        "conicity\"\n  in  -",
        "conicity\"\n  in        -\n  optional  not assessed",
    );
    lines(&folder.path().join("sections.csv"), |lines| {
        for line in lines {
            line.truncate(line.rfind(',').expect("cells"));
        }
    });
    let results = ran(&out("absent"));
    let text = fs::read_to_string(&results).expect("readable");
    let found: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let by_class = &found["quantities"][1];
    assert_eq!(by_class["statistics"][0]["reason"], "there is no column `conicity`");
    let again = verify(&results);
    assert_eq!(again.code, 0, "{}{}", again.stdout, again.stderr);
}

/// Two sources of one datum are refused where it is stated.
#[test]
fn what_is_computed_is_not_stated() {
    let folder = campaign();
    let table = folder.path().join("sections.csv");
    lines(&table, |lines| {
        lines[0] += ",class";
        lines[1..].iter_mut().for_each(|line| *line += ",low");
    });
    let says = refused(folder.path(), &[CLASS, IS]);
    for part in [
        "error[computed-column]: the protocol computes `class`, and the table of sections states it",
        "sections.csv:1:",
        "section class \"Class of conicity\"",
        "computed here",
        "help: remove the column, or rename it",
    ] {
        assert!(says.contains(part), "`{part}` is not in:\n{says}");
    }
}

/// Wanted operation has the numbers from which the coordinates and the groups of a domain follow.
#[test]
fn wanted_operation_is_computed_too() {
    let folder = campaign();
    replace(
        &folder.path().join("campaign.yaml"),
        "sections: sections.csv",
        "sections: sections.csv\napplication: wanted.csv",
    );
    let domain = "section wear \"Wear number\"\n  in  -\n  is  100 * conicity\n\ndomain wanted \"Wanted\"\n  over  wear, speed for each class";
    let wanted = folder.path().join("wanted.csv");
    let write = |text: &str| fs::write(&wanted, text).expect("written");
    write("point,conicity [-],speed [km/h]\na,0.1,108\nb,0.25,60\n");
    let found = run(folder.path(), &[CLASS, IS, domain]);
    let points: Vec<(String, Vec<f64>)> = found
        .application
        .iter()
        .flat_map(|of| of.points.iter().map(|one| (of.scope.clone(), one.values.clone())))
        .collect();
    let expected = [
        ("Class of conicity medium", vec![10.0, 108.0]),
        ("Class of conicity high", vec![25.0, 60.0]),
    ];
    assert_eq!(points.len(), expected.len(), "{points:?}");
    for (found, (scope, values)) in points.iter().zip(expected) {
        assert_eq!(found.0, scope);
        let near = found.1.iter().zip(&values).all(|(one, other)| (one - other).abs() < 1e-9);
        assert!(near, "{points:?}");
    }
    write("point,conicity [-],speed [km/h]\na,,108\n");
    let says = refused(folder.path(), &[CLASS, IS, domain]);
    assert!(says.contains("wanted-value") && says.contains("`conicity` is empty"), "{says}");
    write("point,conicity [-],speed [km/h],class\na,0.1,108,low\n");
    let says = refused(folder.path(), &[CLASS, IS, domain]);
    let part = "the protocol computes `class`, and the table of wanted operation states it";
    assert!(says.contains(part) && says.contains("wanted.csv:1:"), "{says}");
}

/// Of a vehicle in several states, a section has the data of its own state.
#[test]
fn the_vehicle_is_that_of_the_section() {
    let folder = campaign();
    let file = |name: &str| folder.path().join(name);
    let states = "vehicle: {tare: vehicle.yaml, laden: laden.yaml}";
    replace(&file("campaign.yaml"), "vehicle: vehicle.yaml", states);
    fs::copy(file("vehicle.yaml"), file("laden.yaml")).expect("copied");
    replace(&file("laden.yaml"), "static_wheel_load: 50", "static_wheel_load: 60 kN");
    let state = |at: usize| if at.is_multiple_of(3) { "laden" } else { "tare" };
    lines(&file("sections.csv"), |lines| {
        lines[0] += ",state";
        for (at, line) in lines[1..].iter_mut().enumerate() {
            *line = format!("{line},{}", state(at));
        }
    });
    let rules = [
        "vehicle load \"Load\"\n  in   kN\n  key  static_wheel_load",
        "section heavy \"Heavy\"\n  one of  true, false\n  is      load >= 60 kN",
    ];
    let found = run(folder.path(), &rules);
    let expected: Vec<String> = (0..12).map(|at| (state(at) == "laden").to_string()).collect();
    assert_eq!(words(&found, "Heavy"), expected);
}

/// A variant computes what its parent reads from the table, and the reverse.
#[test]
fn a_variant_takes_the_datum_from_elsewhere() {
    let folder = campaign();
    let column = "  column  \"conicity class\"\n";
    protocol(folder.path(), &[CLASS, column, "  default  low\n"]);
    let variant = |name: &str, parent: &str, field: &str| {
        let path = folder.path().join(name);
        let text = format!(
            "protocol variant \"A variant\"\n  extends  \"{parent}\"\n\nsection class\n{field}"
        );
        fs::write(&path, text).expect("written");
        path.display().to_string()
    };
    let class = |protocol: &str| {
        let found = certified(folder.path(), protocol, &[])
            .unwrap_or_else(|problems| panic!("{}", problems.render(false)));
        words(&found, "Class of conicity")
    };
    let computes = variant("computes.fp", "classes.fp", IS);
    let reads = variant("reads.fp", "computes.fp", column);
    let expected = CONICITY.map(|(_, class)| class);
    assert_eq!(class(&computes), expected);
    lines(&folder.path().join("sections.csv"), |lines| {
        lines[0] += ",conicity class";
        lines[1..].iter_mut().for_each(|line| *line += ",medium");
    });
    assert_eq!(class(&reads), ["medium"; 12]);
    // The column has another name than the datum that is computed.
    assert_eq!(class(&computes), expected);
}
