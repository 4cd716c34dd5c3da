//! What `certify` would refuse is told before any record is read, with its place in the mapping or
//! beside it.

use std::fs;
use std::path::Path;

use crate::import::imported;

const FOLDER: &str = "examples/foreign";

fn mapping() -> String {
    fs::read_to_string("examples/foreign/mapping.yaml").expect("the example")
}

/// The mapping with a change is refused, and says all of this; nothing is written.
fn refused(text: &str, folder: &str, parts: &[&str]) {
    let out = tempfile::tempdir().expect("a folder");
    let (problems, done) = imported(text, "mapping.yaml", Path::new(folder), &out.path().join("c"));
    let text = problems.render(false);
    assert!(
        !done && !out.path().join("c").exists() && parts.iter().all(|part| text.contains(part)),
        "{parts:?}\n{text}"
    );
}

/// The mapping with a file of it replaced by another text.
fn with_file(name: &str, change: impl Fn(&str) -> String, parts: &[&str]) {
    let folder = tempfile::tempdir().expect("a folder");
    let text = fs::read_to_string(Path::new(FOLDER).join(name)).expect("a file");
    let other = folder.path().join(format!("other_{name}"));
    fs::write(&other, change(&text)).expect("written");
    let shown = other.display().to_string();
    refused(
        &mapping().replace(&format!(": {name}"), &format!(": {shown}")),
        FOLDER,
        &[parts, &[shown.as_str()]].concat(),
    );
}

#[test]
fn tables_and_vehicle_are_checked() {
    with_file(
        "sections.csv",
        |text| text.replace("cant [mm]", "cant [s]"),
        &["column `cant`", "declared in mm"],
    );
    with_file(
        "sections.csv",
        |text| text.replace("start [m]", "start"),
        &["unit-missing", "column `start` has no unit"],
    );
    with_file(
        "vehicle.yaml",
        |text| text.replace("54.546 kN", "54.546 m"),
        &["vehicle-data", "is a length, not a force"],
    );
    with_file(
        "vehicle.yaml",
        |text| text.replace("54.546 kN", "54546 kN"),
        &["outside the range of the protocol"],
    );
    with_file(
        "vehicle.yaml",
        |text| text.replace(": passenger", ": coach"),
        &["`coach` is not one of passenger"],
    );
}

/// A section that cannot be used is one of the report; if none can, there is no report.
#[test]
fn a_table_without_a_usable_section() {
    with_file(
        "sections.csv",
        |text| text.replace("end [m]", "end [mm]"),
        &["no-usable-section", "its start is not before its end"],
    );
}

/// The needs are those with the parameters of the mapping.
#[test]
fn parameters_of_the_mapping_decide_what_is_needed() {
    let out = tempfile::tempdir().expect("a folder");
    let first = mapping().replace(
        "\nmeasurement:",
        "\ncampaign: {parameters: {evaluated_wheelsets: \"1, 2\"}}\n\nmeasurement:",
    );
    let without: String = first
        .lines()
        .filter(|line| !line.contains("_3R: ") && !line.contains("_3L: "))
        .map(|line| format!("{line}\n"))
        .collect();
    let (problems, done) =
        imported(&without, "mapping.yaml", Path::new(FOLDER), &out.path().join("c"));
    assert!(done && problems.0.is_empty(), "{}", problems.render(false));
    let other = without.replace("1, 2", "1, 3");
    let (problems, _) = imported(&other, "mapping.yaml", Path::new(FOLDER), &out.path().join("d"));
    assert!(problems.render(false).contains("`Y_3L`"), "{}", problems.render(false));
}

#[test]
fn further_keys_of_the_campaign_are_checked() {
    let with = |block: &str| {
        mapping().replace("\nmeasurement:", &format!("\ncampaign: {block}\n\nmeasurement:"))
    };
    refused(
        &with("{report: {authr: B. Example}}"),
        FOLDER,
        &["unknown-key", "a report has no key `authr`", "mapping.yaml:8:"],
    );
    refused(
        &with("{parameters: {sections_per_zon: 1}}"),
        FOLDER,
        &["unknown-parameter", "did you mean `sections_per_zone`"],
    );
    refused(&with("{parameters: {sections_per_zone: many}}"), FOLDER, &["mapping.yaml:8:"]);
}

#[test]
fn a_table_of_sections_of_runs_names_the_run() {
    let text = fs::read_to_string("examples/run/recorded/mapping.yaml").expect("the example");
    let sections = Path::new(FOLDER).canonicalize().expect("a folder").join("sections.csv");
    let with = text.replace("vehicle:", &format!("sections: {}\nvehicle:", sections.display()));
    refused(
        &with,
        "examples/run/recorded",
        &["column-missing", "no column `run`", "with a run in each row: north"],
    );
    let one = text.replace("../records/{run}-track.parquet", "../records/north-track.parquet");
    refused(
        &one,
        "examples/run/recorded",
        &["file-missing", "a path with `{run}` in place of its name", "run `north`"],
    );
}

/// A position is left out as the evaluation does it; a quantity without any position, or an axis,
/// is an error.
#[test]
fn a_channel_that_was_not_measured() {
    let out = tempfile::tempdir().expect("a folder");
    let text = mapping().replace("    Q_3R: ST3 Q re\n", "");
    let (problems, done) =
        imported(&text, "mapping.yaml", Path::new(FOLDER), &out.path().join("c"));
    let said = problems.render(false);
    assert!(
        done && said.contains("warning[position-left-out]: `Q_3R` of the measurement is not mapped; its position is left out"),
        "{said}"
    );
    let text = text.replace("    Q_3R: Q13\n", "    Q_3_R: Q13\n");
    refused(&text, FOLDER, &["error[channel-missing]", "is `Q_3R` meant?"]);
    refused(
        &mapping().replace("    az_I: WK1 z..\n    az_II: WK2 z..\n", ""),
        FOLDER,
        &["error[channel-missing]", "`az_I`, `az_II`"],
    );
    refused(
        &mapping().replace("  distance: Weg\n", ""),
        FOLDER,
        &["error[channel-missing]", "`distance`"],
    );
}

/// What the search for sections reads is needed as well.
#[test]
fn a_channel_of_the_search_must_be_there() {
    let text = fs::read_to_string("examples/run/recorded/mapping.yaml").expect("the example");
    let without = text.replacen("channels: as named", "channels: {Y_1L: Y_1L}", 1);
    refused(&without, "examples/run/recorded", &["error[channel-missing]", "`speed`"]);
}

/// With a table of sections, nothing is searched.
#[test]
fn a_table_of_sections_needs_no_channel_of_the_search() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = folder.path().join("sections.csv");
    fs::write(&table, "section,run,start [m],end [m]\nA,north,1000,1500\n").expect("written");
    let text = fs::read_to_string("examples/run/recorded/mapping.yaml").expect("the example");
    let text = text.replacen("channels: as named", "channels: {Y_1L: Y_1L}", 1);
    let text = text.replace("vehicle:", &format!("sections: {}\nvehicle:", table.display()));
    let (problems, done) = imported(
        &text,
        "mapping.yaml",
        Path::new("examples/run/recorded"),
        &folder.path().join("c"),
    );
    let said = problems.render(false);
    assert!(
        !done
            && said.contains("error[channel-missing]")
            && said.contains("`Y_1R`")
            && !said.contains("`speed`"),
        "{said}"
    );
}

/// Where channels keep their names, only the file tells what is missing.
#[test]
fn channels_as_named_must_be_those_of_the_protocol() {
    let text = mapping();
    let (start, end) =
        (text.find("  channels:").expect("channels"), text.find("\nsimulation:").expect("a side"));
    let text = format!("{}  channels: as named\n{}", &text[..start], &text[end..]);
    refused(
        &text,
        FOLDER,
        &["error[channel-missing]", "Messung_S06.csv", "`Y_1R`", "in place of `as named`"],
    );
}
