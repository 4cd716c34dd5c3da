//! The program as called: exit codes, what is said where, and that nothing half-written is left.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Runs the program in the project's folder.
fn run(arguments: &[&str]) -> (i32, String, String) {
    let output: Output = Command::new(env!("CARGO_BIN_EXE_fishplate"))
        .args(arguments)
        .current_dir(root())
        .output()
        .expect("the program runs");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code().unwrap_or(-1), text(&output.stdout), text(&output.stderr))
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

fn certify(campaign: &str, out: &Path, more: &[&str]) -> (i32, String, String) {
    let out = out.display().to_string();
    let mut arguments = vec!["certify", campaign, "--out", &out];
    arguments.extend(more);
    run(&arguments)
}

#[test]
fn exit_codes_follow_the_verdict() {
    let out = folder();
    let (code, printed, _) =
        certify("examples/coach", &out.path().join("a"), &["--only", "results"]);
    assert_eq!(code, 1);
    assert!(printed.contains("Verdict: not validated"), "{printed}");
    let (code, printed, _) =
        certify("examples/coach-good", &out.path().join("b"), &["--only", "results"]);
    assert_eq!(code, 0);
    assert!(printed.contains("Verdict: validated"), "{printed}");
    let (code, _, said) =
        certify("examples/coach", &out.path().join("c"), &["--protocol", "sprague-gears"]);
    assert_eq!(code, 2);
    assert!(said.contains("did you mean `sprague-geers`?"), "{said}");
    let (code, _, _) = certify("examples/nowhere", &out.path().join("c"), &[]);
    assert_eq!(code, 2);
    assert!(!out.path().join("c").exists(), "nothing is written where an input is wrong");
    let (code, _, _) = run(&["certify"]);
    assert_eq!(code, 2, "a command line without a campaign");
    fs::write(out.path().join("file"), "in the way").expect("a file");
    let (code, _, said) =
        certify("examples/coach", &out.path().join("file").join("below"), &["--only", "results"]);
    assert_eq!(code, 2, "{said}");
}

/// An assessment: one line for each estimate, all groups in results.json, values not under
/// `difference`.
#[test]
fn an_assessment_is_told_by_its_estimates() {
    let out = folder();
    let arguments = ["--protocol", "tests/cases/values/assessment.fp", "--only", "results"];
    let (code, printed, _) = certify("examples/coach-good", out.path(), &arguments);
    assert_eq!(code, 1);
    assert!(printed.contains("Verdict: not assessable") && !printed.contains("pairs"), "{printed}");
    let line = printed
        .lines()
        .find(|line| line.contains("One-dimensional estimate, running safety"))
        .expect("a line");
    assert!(
        line.contains("16 of 16, met") && line.contains("zone ") && line.contains(", wheelset "),
        "{line}"
    );
    assert_eq!(
        printed.matches("One-dimensional estimate, running safety").count(),
        2,
        "one for each quantity: {printed}"
    );

    let text = fs::read_to_string(out.path().join("results.json")).expect("results");
    let results: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let quantity = &results["quantities"][0];
    assert_eq!((quantity["assessed"].as_str(), quantity.get("metric")), (Some("measured"), None));
    assert!(
        quantity["values"][0].get("value").is_some()
            && quantity["values"][0].get("difference").is_none()
    );
    let groups = quantity["groups"].as_array().expect("groups");
    assert_eq!(groups.len(), quantity["statistics"].as_array().expect("statistics").len());
    for key in ["estimate", "n", "value", "low", "high", "limit", "ratio", "holds", "mean", "std"] {
        assert!(groups[0].get(key).is_some(), "{key}");
    }
    assert_eq!(groups[0]["keys"], serde_json::json!({"zone": "1", "wheelset": "1"}));
    let fitted = groups.iter().find_map(|group| group.get("regression")).expect("a regression");
    assert_eq!(fitted["unit"], "mm");

    let table = fs::read_to_string(out.path().join("tables/values.csv")).expect("a table");
    let mut rows = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    assert_eq!(
        rows.next().expect("a head")[5..],
        ["record", "simulated", "measured", "difference", "value", "samples"]
    );
    assert!(rows.all(|row| row[8].is_empty() && row[9].parse::<f64>().is_ok()));
}

#[test]
fn the_same_input_gives_the_same_files() {
    let out = folder();
    let names =
        ["results.json", "report.pdf", "report.html", "tables/values.csv", "tables/summary.csv"];
    certify("examples/coach", &out.path().join("one"), &["--jobs", "1", "--quiet"]);
    let absolute = root().join("examples/coach").display().to_string();
    certify(&absolute, &out.path().join("two"), &["--jobs", "2", "--quiet"]);
    for name in names {
        let [one, two] = ["one", "two"]
            .map(|run| fs::read(out.path().join(run).join(name)).expect("a written file"));
        assert!(one == two, "{name} differs");
        let text = String::from_utf8_lossy(&one);
        assert!(
            !text.contains(&root().display().to_string()),
            "{name} names a folder of this machine"
        );
        if name.ends_with("json") {
            assert!(!text.contains("NaN") && !text.contains("inf"), "{name}");
        }
    }
}

#[test]
fn results_have_the_keys_of_the_contract() {
    let out = folder();
    certify("examples/coach", out.path(), &["--only", "results", "--quiet"]);
    let text = fs::read_to_string(out.path().join("results.json")).expect("results");
    let results: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    for key in ["fishplate", "protocol", "campaign", "verdict", "reasons", "quantities", "sections"]
    {
        assert!(results.get(key).is_some(), "{key}");
    }
    let ids: Vec<&str> = results["quantities"]
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(|quantity| quantity["id"].as_str())
        .collect();
    assert_eq!(
        ids,
        [
            "Y_qst",
            "Q_qst",
            "YQ_qst",
            "SigmaY_qst",
            "Y_max",
            "Q_max",
            "YQ_max",
            "SigmaY_max",
            "ay_rms",
            "az_rms",
            "ay_max",
            "az_max"
        ]
    );
    for key in [
        "unit",
        "pairs",
        "mean",
        "std",
        "limit_mean",
        "limit_std",
        "normalised_mean",
        "normalised_std",
        "holds",
        "values",
    ] {
        assert!(results["quantities"][0].get(key).is_some(), "{key}");
    }
    for key in ["section", "zone", "signal", "simulated", "measured", "difference"] {
        assert!(results["quantities"][0]["values"][0].get(key).is_some(), "{key}");
    }
    assert_eq!(results["sections"][0]["zone"], 1);
    assert_eq!(results["sections"][0]["used"], true);
}

/// A shipped name means the shipped rules; a protocol of one's own says beside the verdict what it
/// changes of them, and `verify` says it again from the texts.
#[test]
fn a_verdict_says_whose_protocol_it_is() {
    let out = folder();
    let path = |name: &str| out.path().join(name).display().to_string();
    let write = |name: &str, text: &str| {
        fs::write(out.path().join(name), text).expect("a file");
        path(name)
    };
    let shipped = &fishplate::library::shipped("en14363-2016-annex-t").expect("shipped").text;
    let forged = write("forged.fp", &shipped.replace("std 5 kN", "std 500 kN"));
    let campaign = "examples/coach-good";
    let results = ["--only", "results"];
    let with = |protocol: &str, out: &str| {
        let more = [&["--protocol", protocol], &results[..]].concat();
        certify(campaign, Path::new(&path(out)), &more)
    };
    let (code, _, said) = with(&forged, "a");
    assert_eq!(code, 2);
    assert!(
        said.contains("shipped-name") && said.contains("extends en14363-2016-annex-t"),
        "{said}"
    );
    let child = write("child.fp", "protocol child \"x\"\n  extends  \"forged.fp\"\n");
    assert_eq!(with(&child, "a").0, 2);
    let copied = write("copied.fp", shipped);
    let (code, printed, said) = with(&copied, "b");
    assert_eq!((code, printed.contains("own protocol")), (0, false), "{said}");
    // A file of the shipped name in the current folder changes nothing.
    write("sprague-geers", "protocol x \"not this one\"\n");
    let own = Command::new(env!("CARGO_BIN_EXE_fishplate"))
        .args(["check", "sprague-geers"])
        .current_dir(out.path())
        .output();
    assert!(own.expect("the program runs").status.success());
    let relaxed = write(
        "relaxed.fp",
        "protocol relaxed \"Own\"\n  extends  en14363-2016-annex-t\n\nquantity Y_qst\n  limit  std 500 kN\n\n\
         quantity Q_qst\n  limit  std 8 kN * (1 + 0.01 * Q0/kN)\n\nquantity Y_max\n  limit  std 1 kN\n\n\
         remove\n  plausibility  live\n",
    );
    let (_, printed, said) = with(&relaxed, "c");
    let says = "own protocol, extends en14363-2016-annex-t: 4 rules changed, 3 relaxed \
                (quantity Y_qst, limit std; quantity Q_qst, limit std; plausibility live)";
    let verdict = printed.find("Verdict").unwrap_or_else(|| panic!("{said}"));
    assert!(printed[verdict..].contains(says), "{printed}");
    let (code, printed, _) = run(&["verify", &path("c"), campaign, "--protocol", &relaxed]);
    assert!(printed.contains(says), "{code} {printed}");
    let (_, printed, _) = run(&["verify", &path("b"), campaign]);
    assert!(printed.contains("shipped, edition 2"), "{printed}");
    let more = ["--set", "mean_limit_share=10", "--only", "results"];
    let (_, printed, _) = certify(campaign, Path::new(&path("d")), &more);
    let verdict = printed.find("Verdict").expect("a verdict");
    assert!(printed[verdict..].contains("`mean_limit_share` 10 (default 2/3"), "{printed}");
}

#[test]
fn protocols_are_checked_formatted_converted_and_compared() {
    let out = folder();
    let (code, _, said) = run(&[
        "check",
        "en14363-2016-annex-t",
        "protocols/en14363-2016-annex-t.yaml",
        "stationary-sway",
    ]);
    assert_eq!(code, 0, "{said}");
    let broken = out.path().join("broken.fp");
    fs::write(&broken, "protocol broken \"x\"\n  axis  distance in kN\n").expect("a file");
    let (code, printed, said) = run(&["check", &broken.display().to_string()]);
    assert_eq!(code, 2);
    assert!(
        printed.is_empty() && said.contains("unit-mismatch") && said.contains("no-quantity"),
        "{said}"
    );
    let loose = out.path().join("loose.fp");
    fs::write(&loose, "protocol   loose   \"x\"\n     extends en14363-2016-annex-t\n")
        .expect("a file");
    let loose = loose.display().to_string();
    assert_eq!(run(&["fmt", "--check", &loose]).0, 1);
    assert_eq!(run(&["fmt", &loose]).0, 0);
    assert_eq!(run(&["fmt", "--check", &loose]).0, 0);
    let yaml = out.path().join("annex.yaml").display().to_string();
    assert_eq!(run(&["convert", "en14363-2016-annex-t", "--to", "yaml", "-o", &yaml]).0, 0);
    let (code, printed, _) = run(&["diff", "en14363-2016-annex-t", &yaml]);
    assert_eq!((code, printed.as_str()), (0, "no rule differs\n"));
    let (_, printed, _) = run(&["convert", &yaml, "--to", "fp"]);
    assert_eq!(
        printed,
        fs::read_to_string(root().join("protocols/en14363-2016-annex-t.fp")).expect("the protocol")
    );
    let (_, printed, _) =
        run(&["diff", "en14363-2016-annex-t", "en14363-2016-annex-t-population-deviation"]);
    assert!(
        printed.contains("parameter variance_divisor") && printed.lines().count() < 8,
        "{printed}"
    );
}

#[test]
fn every_stage_can_be_printed() {
    for (stage, format, holds) in [
        ("ast", "text", "quantity Y_qst"),
        ("ast", "json", "\"blocks\""),
        ("plan", "text", "quantity Y_qst [kN]"),
        ("plan", "json", "\"quantities\""),
        ("graph", "text", "low-pass 20 Hz"),
        ("graph", "json", "\"nodes\""),
        ("graph", "dot", "digraph"),
        ("graph", "svg", "<svg"),
    ] {
        let (code, printed, said) =
            run(&["explain", "en14363-2016-annex-t", "--stage", stage, "--format", format]);
        assert_eq!(code, 0, "{stage} {format}: {said}");
        assert!(printed.contains(holds), "{stage} {format}");
    }
    assert_eq!(
        run(&["explain", "en14363-2016-annex-t", "--stage", "plan", "--format", "svg"]).0,
        2
    );
    let own = folder();
    let file = own.path().join("own.fp").display().to_string();
    let text = "protocol own \"Own\"\n  extends kraft\n";
    fs::write(&file, text).expect("written");
    for words in
        [&["explain", &file, "-o", &file][..], &["convert", &file, "--to", "yaml", "-o", &file]]
    {
        let (code, _, said) = run(words);
        assert!(
            code == 2
                && said.contains("error[output-is-input]")
                && fs::read_to_string(&file).is_ok_and(|now| now == text),
            "{said}"
        );
    }
    let (code, printed, _) = run(&["explain"]);
    assert_eq!(code, 0);
    assert!(printed.contains("sprague-geers") && printed.contains("sliding <"), "{printed}");
}

#[test]
fn help_shows_an_example_and_the_rest_is_at_hand() {
    for command in [
        "certify",
        "check",
        "fmt",
        "convert",
        "explain",
        "diff",
        "protocols",
        "schema",
        "completions",
        "man",
    ] {
        let (code, printed, _) = run(&[command, "--help"]);
        assert_eq!(code, 0, "{command}");
        assert!(
            printed.contains("Example")
                && printed.contains("--quiet")
                && printed.contains("--color"),
            "{command}: {printed}"
        );
    }
    assert!(run(&["completions", "bash"]).1.contains("fishplate"));
    let out = folder();
    assert_eq!(run(&["man", "--out", &out.path().display().to_string()]).0, 0);
    assert!(
        out.path().join("fishplate.1").is_file()
            && out.path().join("fishplate-certify.1").is_file()
    );
    let (_, printed, _) = run(&["protocols"]);
    assert!(printed.lines().count() >= 6 && printed.contains("stationary-sway"));
    let (_, printed, _) = run(&["schema"]);
    assert_eq!(
        printed,
        fs::read_to_string(root().join("protocols/protocol.schema.json")).expect("the schema")
    );
}

#[test]
fn settings_of_the_command_line_are_checked() {
    let out = folder();
    let said = |set: &str| {
        let (code, _, said) =
            certify("examples/coach", &out.path().join("x"), &["--only", "results", "--set", set]);
        assert_eq!(code, 2, "{set}");
        said
    };
    assert!(said("lowpass_frequenzy=20 Hz").contains("did you mean `lowpass_frequency`?"));
    assert!(said("lowpass_frequency=20 kN").contains("unit-mismatch"));
    assert!(said("percentile_rule=hasen").contains("did you mean `hazen`?"));
    assert!(said("lowpass_order=99").contains("out-of-range"));
    assert!(said("nothing").contains("--set name=value"));
    let count = said("sections_per_zone=2.5");
    assert!(
        count.contains("must be a whole number, this is sections_per_zone = 2.5")
            && count.contains("set here"),
        "{count}"
    );
    let order = said("lowpass_order=2.5");
    assert!(
        order.contains("the order must be a whole number from 1 to 20, this is 2.5")
            && order.contains("set here"),
        "{order}"
    );
    let place = said("evaluated_wheelsets=5");
    assert_eq!(place.matches("error[").count(), 1, "{place}");
    // What follows from a value outside its range is not told.
    let outside = said("sections_per_zone=-1");
    assert!(
        outside.contains("`-1` is outside the range") && !outside.contains("not-a-count"),
        "{outside}"
    );
    let twice = ["--only", "results", "--set", "lowpass_order=4", "--set", "lowpass_order = 2"];
    let (code, _, said) = certify("examples/coach", &out.path().join("x"), &twice);
    assert!(
        code == 2 && said.contains("error[set-twice]: the parameter `lowpass_order` is set twice"),
        "{said}"
    );
}

#[test]
fn a_file_is_not_written_onto_a_folder() {
    let out = folder();
    let path = out.path().display().to_string();
    let refused = |arguments: &[&str]| {
        let (code, _, said) = run(arguments);
        assert!(
            code == 2 && said.contains("error[not-a-file]") && said.contains("is a folder"),
            "{arguments:?}: {said}"
        );
    };
    refused(&["reduce", "examples/coach", "--out", &path]);
    refused(&["sections", "examples/run", "--out", &path]);
    refused(&["import", "--draft", "examples/coach/simulation/S01.csv", "--out", &path]);
    assert_eq!(fs::read_dir(out.path()).expect("the folder").count(), 0);
    let file = out.path().join("file");
    fs::write(&file, "").expect("written");
    let (code, _, said) = run(&["man", "--out", &file.display().to_string()]);
    assert!(code == 2 && said.contains("error[not-a-folder]"), "{said}");
}

#[test]
fn counts_begin_at_one() {
    for arguments in [
        &["certify", "examples/coach", "--jobs", "0"][..],
        &["study", "sections", "examples/coach", "--reduce", "0"],
    ] {
        let (code, _, said) = run(&[arguments, &["--out", "x"]].concat());
        assert!(code == 2 && said.contains("expected a whole number from 1"), "{said}");
    }
}

/// A link stays and its target is written; what is no file, such as a pipe, gets the bytes and
/// stays too.
#[cfg(unix)]
#[test]
fn an_output_goes_through_links_and_into_pipes() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("target"), "old").expect("written");
    std::os::unix::fs::symlink("target", path("link")).expect("linked");
    std::os::unix::fs::symlink("nothing", path("dangling")).expect("linked");
    let (_, expected, _) = run(&["convert", "kraft", "--to", "yaml"]);
    let to = |name: &str| {
        run(&["convert", "kraft", "--to", "yaml", "-o", &path(name).display().to_string()])
    };
    assert_eq!(to("link").0, 0);
    assert!(
        path("link").is_symlink()
            && fs::read_to_string(path("target")).expect("readable") == expected
    );
    let (code, _, said) = to("dangling");
    assert!(code == 3 && path("dangling").is_symlink() && said.contains("write-failed"), "{said}");
    let (code, printed, said) = run(&["convert", "kraft", "--to", "yaml", "-o", "/dev/stdout"]);
    assert_eq!((code, printed), (0, expected), "{said}");
}

/// What cannot be an output is told before the work, and what cannot be printed is told at all.
#[test]
fn outputs_that_cannot_be_written() {
    let folder = folder();
    fs::write(folder.path().join("file"), "x").expect("written");
    for out in ["file", "file/inside"] {
        let (code, _, said) =
            certify("examples/coach", &folder.path().join(out), &["--only", "results"]);
        assert!(code == 2 && said.contains("error[not-a-folder]"), "{said}");
    }
    // The files of runs are read as well.
    let run = folder.path().join("run");
    assert!(
        Command::new("cp")
            .arg("-r")
            .arg("examples/run")
            .arg(&run)
            .status()
            .expect("started")
            .success()
    );
    let (code, _, said) =
        certify(&run.display().to_string(), &run.join("records"), &["--only", "results"]);
    assert!(
        code == 2
            && said.contains("error[output-is-input]")
            && !run.join("records/results.json").exists(),
        "{said}"
    );
    let out = folder.path().join("report").display().to_string();
    for arguments in [
        &["protocols"][..],
        &["explain", "kraft", "--format", "json"],
        &["certify", "examples/coach-good", "--only", "results", "--out", &out],
        &["completions", "bash"],
        &["--help"],
        &["--version"],
    ] {
        let Ok(full) = fs::OpenOptions::new().write(true).open("/dev/full") else { return };
        let program = Command::new(env!("CARGO_BIN_EXE_fishplate"))
            .args(arguments)
            .current_dir(root())
            .stdout(full)
            .output()
            .expect("the program runs");
        let said = String::from_utf8_lossy(&program.stderr).into_owned();
        assert_eq!(program.status.code(), Some(3), "{arguments:?}: {said}");
        let help = arguments[0].starts_with('-');
        assert!(help || said.contains("standard output cannot be written"), "{said}");
    }
    assert!(Path::new(&out).join("results.json").exists(), "the files are there");
}

/// No name writes a line of the terminal that reads like a verdict.
#[cfg(unix)]
#[test]
fn names_with_line_breaks_stay_on_their_line() {
    let folder = folder();
    let campaign = folder.path().join("coach");
    let copied = Command::new("cp").args(["-r", "examples/coach"]).arg(&campaign).status();
    assert!(copied.expect("started").success());
    let spoof = "x\nVerdict: validated\r\nVerdict: validated\u{2028}\u{85}Verdict: validated";
    let quoted = serde_json::to_string(spoof).expect("JSON");
    let file = campaign.join("campaign.yaml");
    let text = fs::read_to_string(&file).expect("there");
    let lines = text.lines().map(|line| match line.starts_with("name:") {
        true => format!("name: {quoted}\n"),
        false => format!("{line}\n"),
    });
    fs::write(&file, lines.collect::<String>()).expect("written");
    let protocol = folder.path().join("own.yaml");
    let own = format!(
        "protocol:\n  own:\n    title: {quoted}\n    extends: en14363-2016-annex-t\n    edition: {quoted}\n"
    );
    fs::write(&protocol, own).expect("written");
    let out = folder.path().join("report");
    let [campaign, protocol] = [campaign, protocol].map(|path| path.display().to_string());
    let told = |printed: (i32, String, String)| {
        let text = format!("{}{}", printed.1, printed.2);
        let lines = text.lines().filter(|line| line.trim_start().starts_with("Verdict: validated"));
        assert_eq!(lines.count(), 0, "{text}");
        text
    };
    let with = ["--only", "results", "--protocol", protocol.as_str()];
    told(certify(&campaign, &out, &with));
    told(certify(&campaign, &out, &["--only", "results"]));
    told(run(&["verify", &out.display().to_string()]));
    told(run(&["certify", spoof, "--out", spoof]));
    told(run(&["certify", &campaign, "--out", "x", "--protocol", spoof]));
    told(run(&["certify", &campaign, "--out", "x", "--set", &format!("{spoof}=1")]));
    assert!(told(run(&["certify", &format!("--{spoof}")])).contains("unexpected argument"));
}

/// Without a diagnosis there are no scores, and nothing is written.
#[test]
fn blind_without_a_diagnosis_is_an_error() {
    let folder = folder();
    let campaign = folder.path().join("broken");
    fs::create_dir(&campaign).expect("made");
    fs::write(campaign.join("campaign.yaml"), "name: [\n").expect("written");
    let (from, out) = (campaign.display().to_string(), folder.path().join("out"));
    let blind = |more: &[&str]| {
        run(&[&["blind", &from, "--out", &out.display().to_string()], more].concat())
    };
    for (more, says) in
        [(&["--protocol", "nope"][..], "error[no-such-protocol]"), (&[], "error[no-diagnosis]")]
    {
        let (code, _, said) = blind(more);
        assert!(code == 2 && said.contains(says) && !out.exists(), "{said}");
    }
}
