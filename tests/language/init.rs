//! `init`: the draft passes `check`, has what the protocol needs and no more, and is a campaign
//! once its data are filled in.

use std::fs;
use std::path::Path;

use crate::common::campaign::{copy, lines, tiny};
use crate::common::program::{certify, files, fishplate, program, ran};
use serde_json::Value;

const ANNEX: &str = "en14363-2016-annex-t";

/// `init` of a folder with this name, and what it printed.
#[track_caller]
fn init(folder: &Path, arguments: &[&str]) {
    let done = ran(program().arg("init").arg(folder).args(arguments));
    assert_eq!(done.code, 0, "{}", done.stderr);
}

#[track_caller]
fn text(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn sound(protocol: &Path) {
    let path = protocol.to_str().expect("UTF-8");
    let checked = fishplate(&["check", path]);
    assert_eq!(checked.code, 0, "{}", checked.stderr);
    // A parent whose verdicts have names does not know of further quantities.
    let others = checked
        .stderr
        .lines()
        .filter(|line| line.starts_with("warning[") && !line.contains("quantity-without-verdict"));
    assert_eq!(others.count(), 0, "{}", checked.stderr);
    assert_eq!(fishplate(&["fmt", "--check", path]).code, 0, "not in canonical form");
}

fn needs(protocol: &str) -> Value {
    let found = fishplate(&["explain", protocol, "--stage", "needs", "--format", "json"]);
    serde_json::from_str(&found.stdout).expect("JSON")
}

/// `Y_1R [kN]` of each need in a list.
fn headings(list: &Value, name: &str, of: impl Fn(&Value) -> bool) -> Vec<String> {
    let heading = |need: &Value| match need["unit"].as_str() {
        Some(unit) => format!("{} [{unit}]", need[name].as_str().expect("a name")),
        None => need[name].as_str().expect("a name").to_string(),
    };
    list.as_array().expect("a list").iter().filter(|need| of(need)).map(heading).collect()
}

fn header(folder: &Path, name: &str) -> Vec<String> {
    text(folder, name).lines().next().expect("a header").split(',').map(str::to_string).collect()
}

/// The records of `tiny` in place of the empty ones, and its sections cell by cell below the header
/// of the draft.
fn fill(folder: &Path, from: &Path) {
    for side in ["simulation", "measurement"] {
        fs::remove_file(folder.join(side).join("S01.csv")).expect("removed");
        for record in fs::read_dir(from.join(side)).expect("a folder") {
            let record = record.expect("an entry");
            fs::copy(record.path(), folder.join(side).join(record.file_name())).expect("copied");
        }
    }
    let name = |heading: &str| heading.split(" [").next().unwrap_or_default().to_string();
    let given: Vec<String> =
        header(from, "sections.csv").iter().map(|heading| name(heading)).collect();
    let wanted: Vec<Option<usize>> = header(folder, "sections.csv")
        .iter()
        .map(|heading| given.iter().position(|known| *known == name(heading)))
        .collect();
    let rows = text(from, "sections.csv");
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        wanted.iter().map(|at| at.map_or("", |at| cells[at])).collect::<Vec<_>>().join(",")
    };
    let mut filled = vec![header(folder, "sections.csv").join(",")];
    filled.extend(rows.lines().skip(1).map(row));
    fs::write(folder.join("sections.csv"), filled.join("\n") + "\n").expect("written");
}

#[test]
fn a_list_of_channels_becomes_a_campaign() {
    let (parent, tiny) = (tempfile::tempdir().expect("a folder"), tiny());
    let folder = parent.path().join("Coach C44, run 2");
    init(&folder, &["--channels", "Y_1R [kN], Y_1L [kN], Y_3R [N], ay_I [m/s^2]"]);
    sound(&folder.join("protocol.fp"));
    let protocol = text(&folder, "protocol.fp");
    for part in [
        "protocol coach-c44-run-2-protocol",
        "members  1R, 1L, 3R",
        "column  \"Y_{position}\"",
        "quantity Y_rms",
        "quantity ay_I_rms",
        "To be set",
    ] {
        assert!(protocol.contains(part), "{part}: {protocol}");
    }
    let record = "time [s],distance [m],Y_1R [kN],Y_1L [kN],Y_3R [kN],ay_I [m/s^2]";
    assert_eq!(text(&folder, "measurement/S01.csv"), format!("{record}\n"));
    assert_eq!(text(&folder, "simulation/S01.csv"), format!("{record}\n"));
    assert!(!folder.join("vehicle.yaml").exists(), "no rule reads vehicle data");
    // Before the data are there, nothing is computed from nothing.
    let empty = certify(&folder, &["--only", "results"]);
    assert_eq!(empty.ran.code, 2, "{}", empty.ran.stdout);
    fill(&folder, tiny.path());
    let found = certify(&folder, &["--set", "Y_std_limit=50kN", "--only", "results"]);
    assert!(found.ran.code < 2, "{}", found.ran.stderr);
    let results = found.results();
    assert_eq!(results["quantities"].as_array().map(Vec::len), Some(2));
    assert!(
        results["sections"]
            .as_array()
            .is_some_and(|all| all.iter().all(|section| section["used"] == true)),
        "{}",
        results["sections"]
    );
    assert_ne!(results["verdict"], "not assessable", "{}", results["reasons"]);
}

#[test]
fn the_header_of_a_record_is_a_list_of_channels() {
    let (parent, tiny) = (tempfile::tempdir().expect("a folder"), tiny());
    let folder = parent.path().join("new");
    let record = tiny.path().join("measurement/S01.csv");
    init(&folder, &["--channels-from", record.to_str().expect("UTF-8")]);
    sound(&folder.join("protocol.fp"));
    let mut expected = header(tiny.path(), "measurement/S01.csv");
    let mut found = header(&folder, "measurement/S01.csv");
    expected.sort();
    found.sort();
    assert_eq!(found, expected);
    fill(&folder, tiny.path());
    let found = certify(&folder, &["--only", "results"]);
    assert!(found.ran.code < 2, "{}", found.ran.stderr);
    // A record over the distance alone has no filter.
    let plain = parent.path().join("plain.csv");
    fs::write(&plain, "distance [m],z1 [mm],z2 [mm]\n").expect("written");
    let folder = parent.path().join("distance");
    init(&folder, &["--channels-from", plain.to_str().expect("UTF-8")]);
    sound(&folder.join("protocol.fp"));
    assert!(!text(&folder, "protocol.fp").contains("low-pass"));
}

#[test]
fn a_variant_has_what_its_parent_needs_and_gives_the_same_numbers() {
    let (parent, tiny) = (tempfile::tempdir().expect("a folder"), tiny());
    let folder = parent.path().join("variant");
    init(&folder, &["--extends", ANNEX]);
    sound(&folder.join("protocol.fp"));
    let needs = needs(ANNEX);
    for (record, side) in
        [("simulated", "simulation"), ("measured", "measurement"), ("track", "track")]
    {
        assert_eq!(
            header(&folder, &format!("{side}/S01.csv")),
            headings(&needs["channels"], "name", |need| need["record"] == record)
        );
    }
    assert_eq!(header(&folder, "sections.csv"), headings(&needs["sections"], "name", |_| true));
    let vehicle = text(&folder, "vehicle.yaml");
    for need in needs["vehicle"].as_array().expect("a list") {
        let line = format!(
            "{}{}:",
            if need["required"] == true { "\n" } else { "# " },
            need["name"].as_str().expect("a name")
        );
        assert!(vehicle.contains(&line), "{line}: {vehicle}");
        assert!(vehicle.contains(need["title"].as_str().expect("a title")), "{vehicle}");
    }
    fill(&folder, tiny.path());
    let empty = certify(&folder, &["--only", "results"]);
    assert_eq!(empty.ran.code, 2);
    assert!(empty.ran.stderr.contains("`static_wheel_load` has no value"), "{}", empty.ran.stderr);
    let given = text(tiny.path(), "vehicle.yaml");
    lines(&folder.join("vehicle.yaml"), |lines| {
        for line in lines.iter_mut().filter(|line| line.ends_with(':') && !line.starts_with('#')) {
            *line = given
                .lines()
                .find(|known| known.starts_with(line.as_str()))
                .expect("the vehicle has it")
                .to_string();
        }
    });
    let (found, expected) =
        (certify(&folder, &["--only", "results"]), certify(tiny.path(), &["--only", "results"]));
    assert_eq!(found.ran.code, expected.ran.code, "{}", found.ran.stderr);
    let verdicts = |results: &Value| (results["verdict"].clone(), results["zones"].clone());
    assert_eq!(verdicts(&found.results()), verdicts(&expected.results()));
    let values = |results: &Value| {
        let all = results["quantities"].as_array().expect("a list").iter();
        all.map(|quantity| (quantity["id"].clone(), quantity["values"].clone())).collect::<Vec<_>>()
    };
    assert_eq!(values(&found.results()), values(&expected.results()));
}

#[test]
fn every_shipped_protocol_can_be_extended() {
    let parent = tempfile::tempdir().expect("a folder");
    for name in fishplate::library::names() {
        let folder = parent.path().join(name);
        init(&folder, &["--extends", name, "--channels", "Y_1R [kN], z_1 [mm], z_2 [mm]"]);
        sound(&folder.join("protocol.fp"));
    }
    let application =
        header(&parent.path().join("en14363-2016-annex-t-application"), "application.csv");
    assert_eq!(
        application,
        headings(&needs("en14363-2016-annex-t-application")["application"], "name", |_| true)
    );
    assert_eq!(application[0], "point");
    // A protocol that is a file is copied, since a campaign extends nothing outside of it.
    let mine = parent.path().join("mine.fp");
    fs::write(&mine, format!("protocol mine \"Mine\"\n  extends  {ANNEX}\n")).expect("written");
    let folder = parent.path().join("of-a-file");
    init(&folder, &["--extends", mine.to_str().expect("UTF-8")]);
    sound(&folder.join("protocol.fp"));
    assert_eq!(text(&folder, "mine.fp"), fs::read_to_string(&mine).expect("readable"));
}

#[test]
fn names_that_the_language_has_taken_get_others() {
    let parent = tempfile::tempdir().expect("a folder");
    let list = "mean [kN], of [m], 1.5g [gn], N [N], a b [N s/m], p95 [%], wheelset [1/m], start [m], time [s], rms [-], Übergang [°]";
    let folder = parent.path().join("1 – odd");
    init(&folder, &["--channels", list]);
    sound(&folder.join("protocol.fp"));
    assert_eq!(text(&folder, "measurement/S01.csv").split(',').count(), list.split(',').count());
}

#[test]
fn faults_have_their_place_and_nothing_is_written() {
    let parent = tempfile::tempdir().expect("a folder");
    let folder = parent.path().join("new");
    let refused = |arguments: &[&str], says: &[&str]| {
        let before = files(parent.path());
        let done = ran(program().arg("init").arg(&folder).args(arguments));
        assert_eq!(done.code, 2, "{arguments:?}: {}", done.stdout);
        says.iter().for_each(|part| assert!(done.stderr.contains(part), "{part}: {}", done.stderr));
        assert_eq!(files(parent.path()), before);
    };
    refused(
        &["--channels", "Y [kn]"],
        &["error[unknown-unit]", "--channels:1:4", "did you mean `kN`?"],
    );
    refused(
        &["--channels", "Y [kN], Y [N]"],
        &["error[duplicate-column]", "--channels:1:9", "the first of them"],
    );
    refused(&["--channels", "Y"], &["error[unit-missing]", "`Y [...]`"]);
    refused(&["--channels", ""], &["error[file-empty]"]);
    refused(&["--channels", "time [s]"], &["error[no-channels]"]);
    refused(&["--channels", "a\"b [m]"], &["error[channel-name]"]);
    refused(&["--channels", "a [m], , b [m]"], &["error[name-missing]", "--channels:1:7"]);
    refused(
        &["--extends", "en14363-2016-anex-t"],
        &["error[no-such-protocol]", "did you mean `en14363-2016-annex-t`?"],
    );
    refused(&["--channels-from", "no/such.csv"], &["error[file-missing]"]);
    let record = parent.path().join("record.csv");
    fs::write(&record, "Y [kN],Q [kN]\n").expect("written");
    refused(&["--channels-from", record.to_str().expect("UTF-8")], &["error[no-axis]"]);
    assert_eq!(ran(program().arg("init").arg(&folder)).code, 2);
    // A folder that has something in it, and a file in its place.
    fs::create_dir(&folder).expect("a folder");
    fs::write(folder.join("notes.txt"), "mine").expect("written");
    refused(&["--channels", "Y [kN]"], &["error[folder-not-empty]", "`notes.txt`"]);
    fs::remove_file(folder.join("notes.txt")).expect("removed");
    let copied = copy(&folder);
    init(copied.path(), &["--channels", "Y [kN]"]);
    fs::remove_dir(&folder).expect("removed");
    fs::write(&folder, "a file").expect("written");
    refused(&["--channels", "Y [kN]"], &["error[folder-not-empty]"]);
}
