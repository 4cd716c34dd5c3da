//! Campaigns, tables and records, good ones and one file for each fault: `tests/cases/data`.

use std::path::{Path, PathBuf};

use fishplate::data::campaign::{Campaign, RecordKind};
use fishplate::data::checks::{Section, check_axis};
use fishplate::data::record::{Wanted, read_record};
use fishplate::data::table::{Table, not_portable};
use fishplate::data::text::read_text;
use fishplate::data::write::{Entry, OutColumn, Outputs, campaign_yaml, record_csv, table_csv};
use fishplate::problem::{Problem, Problems};
use fishplate::units::{Dimension, Unit};

const FORCE: Dimension = Dimension::of([1, 1, -2, 0, 0, 0]);

fn cases(path: &str) -> PathBuf {
    Path::new("tests/cases/data").join(path)
}

fn wanted() -> [Wanted; 3] {
    [
        Wanted::new("time", Dimension::TIME),
        Wanted::new("distance", Dimension::LENGTH),
        Wanted::new("Y_1R", FORCE),
    ]
}

/// `code file:line:column`, the file without its folders; only the code where a problem has no
/// place.
#[track_caller]
fn same(case: &str, problems: &[Problem], expected: &[&str]) {
    let found: Vec<String> = problems
        .iter()
        .map(|problem| match &problem.at {
            Some(at) => format!(
                "{} {}",
                problem.code,
                at.to_string().rsplit('/').next().unwrap_or_default()
            ),
            None => problem.code.to_string(),
        })
        .collect();
    let messages: String = problems.iter().map(|problem| problem.render(false) + "\n").collect();
    assert_eq!(found, expected, "{case}\n{messages}");
}

#[test]
fn faulty_records() {
    for (case, expected) in [
        ("missing_channel", &["unknown-channel missing_channel.csv:1:1"][..]),
        ("wrong_unit", &["unit-mismatch wrong_unit.csv:1:29"]),
        ("unknown_unit", &["unknown-unit unknown_unit.csv:1:29"]),
        ("no_unit", &["unit-missing no_unit.csv:1:23"]),
        ("no_units", &["unit-missing no_units.csv:1:1"]),
        ("units_in_row", &["units-in-row units_in_row.csv:2:1"]),
        ("unit_in_cell", &["units-in-cell unit_in_cell.csv:1:28"]),
        ("units_in_cells", &["units-in-cell units_in_cells.csv:1:6"]),
        ("other_brackets", &["unknown-channel other_brackets.csv:1:1"]),
        ("header_repeated", &["header-repeated header_repeated.csv:4:1"]),
        ("empty_cell", &["not-a-number empty_cell.csv:3:13"]),
        ("nan", &["not-finite nan.csv:3:13"]),
        ("infinite", &["not-finite infinite.csv:3:13"]),
        ("word", &["not-a-number word.csv:3:13"]),
        (
            "decimal_comma_quoted",
            &[
                "decimal-comma decimal_comma_quoted.csv:2:2",
                "decimal-comma decimal_comma_quoted.csv:2:10",
                "decimal-comma decimal_comma_quoted.csv:2:18",
            ],
        ),
        ("decimal_comma", &["decimal-comma decimal_comma.csv:2:1"]),
        ("semicolons", &["semicolon-separated semicolons.csv:1:9"]),
        ("tabs", &["tab-separated tabs.csv:1:9"]),
        ("too_many_values", &["ragged-row too_many_values.csv:3:19"]),
        ("too_few_values", &["ragged-row too_few_values.csv:3:7"]),
        ("duplicate_column", &["duplicate-column duplicate_column.csv:1:10"]),
        ("cut_off", &["truncated-row cut_off.csv:5:1"]),
        ("blank_line", &["blank-line blank_line.csv:4:1"]),
        ("stray_quote", &["stray-quote stray_quote.csv:3:13"]),
        ("header_only", &["no-rows"]),
        ("empty", &["file-empty"]),
        ("latin1", &["encoding latin1.csv:1:25"]),
        ("utf16", &["encoding"]),
        (
            "many",
            &[
                "not-a-number many.csv:2:13",
                "not-a-number many.csv:3:13",
                "not-a-number many.csv:4:13",
                "not-a-number many.csv:5:13",
                "not-a-number many.csv:6:13",
                "more-problems",
            ],
        ),
        ("absent", &["file-missing"]),
        ("", &["file-missing"]),
    ] {
        let path = cases("bad/record").join(format!("{case}.csv"));
        let problems = read_record(&path, &path.display().to_string(), &wanted()).expect_err(case);
        same(case, &problems, expected);
    }
}

/// What is wrong with many columns, or many times, is said once, with the words to write.
#[test]
fn a_fault_of_many_columns_is_one_problem() {
    for (case, says, help) in [
        (
            "no_units",
            "the column `time` has no unit; a time is needed; the same of `distance`, `Y_1R`",
            "`time [...]`",
        ),
        (
            "unit_in_cell",
            "the unit of `Y_1R` stands in a cell of its own",
            "in one cell: `Y_1R [kN]`",
        ),
        (
            "other_brackets",
            "has no columns `time`, `distance`, `Y_1R`",
            "`Y_1R [kN]` for `Y_1R/kN`",
        ),
        (
            "header_repeated",
            "the header stands between the rows again, in line 4, and once more",
            "one file holds one record",
        ),
    ] {
        let path = cases("bad/record").join(format!("{case}.csv"));
        let problems = read_record(&path, &path.display().to_string(), &wanted()).expect_err(case);
        let [problem] = problems.as_slice() else { panic!("{case}: {}", problems.len()) };
        assert!(problem.says.contains(says), "{case}: {}", problem.says);
        assert!(
            problem.help.as_ref().is_some_and(|told| told.contains(help)),
            "{case}: {:?}",
            problem.help
        );
    }
}

#[test]
fn records_that_cannot_be_evaluated() {
    let inside = Section { start: 100.2, end: 100.4, at: None };
    for (case, section, expected) in [
        ("bad/record/gap.csv", &inside, "gap gap.csv:6:1"),
        ("bad/record/time_repeated.csv", &inside, "time-not-increasing time_repeated.csv:4:1"),
        (
            "bad/record/distance_backwards.csv",
            &inside,
            "axis-not-increasing distance_backwards.csv:4:7",
        ),
        (
            "good/small/measurement/S01.csv",
            &Section { start: 90.0, end: 101.0, at: None },
            "outside-record",
        ),
    ] {
        let path = cases(case);
        let record = read_record(&path, &path.display().to_string(), &wanted()).expect(case);
        same(
            case,
            &check_axis(&record, "time", "distance", Some(section)).expect_err(case),
            &[expected],
        );
    }
}

#[test]
fn faulty_tables() {
    for (case, expected) in [
        ("duplicate_section", &["duplicate-name duplicate_section.csv:3:1"][..]),
        ("name_missing", &["name-missing name_missing.csv:3:1"]),
        ("ragged", &["ragged-row ragged.csv:3:13"]),
        (
            "decimal_comma",
            &["decimal-comma decimal_comma.csv:2:8", "decimal-comma decimal_comma.csv:3:8"],
        ),
        ("semicolons", &["semicolon-separated semicolons.csv:1:8"]),
        ("duplicate_column", &["duplicate-column duplicate_column.csv:1:28"]),
        ("blank_line", &["blank-line blank_line.csv:3:1"]),
        ("header_only", &["no-rows header_only.csv:1:1"]),
        ("empty", &["file-empty"]),
        ("unknown_unit", &["unknown-unit unknown_unit.csv:1:25"]),
        ("word", &["not-a-number word.csv:3:7"]),
        ("column_missing", &["unknown-column column_missing.csv:1:1"]),
        ("latin1", &["encoding latin1.csv:3:20"]),
    ] {
        let path = cases("bad/table").join(format!("{case}.csv"));
        let mut problems = Problems::default();
        let table = problems
            .value(read_text(&path, &path.display().to_string()))
            .and_then(|(text, hash)| Table::parse(text, hash, Some("section"), &mut problems));
        if let Some(table) = table {
            match table.need_column("start") {
                Ok(column) => problems.0.extend(
                    table.numbers(column, Some(Dimension::LENGTH)).err().unwrap_or_default(),
                ),
                Err(problem) => problems.push(problem),
            }
        }
        same(case, &problems.0, expected);
    }
}

#[test]
fn faulty_campaigns() {
    for (case, expected) in [
        ("yaml_syntax", &["yaml-syntax campaign.yaml:2:10"][..]),
        ("yaml_tab", &["tab-indentation campaign.yaml:3:2"]),
        ("duplicate_key", &["duplicate-key campaign.yaml:2:1"]),
        ("no_name", &["key-missing campaign.yaml:1:1"]),
        ("not_a_map", &["wrong-kind campaign.yaml:1:1"]),
        ("empty", &["file-empty"]),
        ("vehicle_missing", &["file-missing campaign.yaml:2:10"]),
        ("vehicle_is_list", &["wrong-kind vehicle.yaml:1:1"]),
        ("vehicle_outside", &["path-outside campaign.yaml:2:10"]),
        ("sections_absolute", &["path-outside campaign.yaml:3:11"]),
        ("section_name_outside", &["path-outside sections.csv:3:1"]),
        ("key_is_list", &["wrong-kind campaign.yaml:3:11"]),
        ("records_twice", &["duplicate-name campaign.yaml:5:27"]),
        ("records_none", &["no-records campaign.yaml:5:13"]),
        ("records_nested", &["wrong-kind campaign.yaml:5:21"]),
        ("records_outside", &["path-outside campaign.yaml:5:34"]),
        ("track_is_list", &["wrong-kind campaign.yaml:6:8"]),
        ("no_records", &["no-records campaign.yaml:3:14"]),
        ("folder_missing", &["folder-missing campaign.yaml:3:14"]),
        ("parameter_is_list", &["wrong-kind campaign.yaml:7:11"]),
        ("key_in_report", &["unknown-key campaign.yaml:5:3"]),
        ("key_in_parameters", &["unknown-key campaign.yaml:4:3"]),
        ("key_too_deep", &["yaml-syntax campaign.yaml:2:10"]),
        ("absent", &["folder-missing"]),
        ("no_records/measurement", &["file-missing"]),
    ] {
        let mut problems = Problems::default();
        assert!(
            Campaign::open(&cases("bad/campaign").join(case), &mut problems).is_none(),
            "{case}"
        );
        same(case, &problems.0, expected);
    }
}

#[test]
fn a_missing_record_is_told_where_the_section_stands() {
    let mut problems = Problems::default();
    let campaign =
        Campaign::open(&cases("bad/campaign/record_missing"), &mut problems).expect("opens");
    let missing = campaign
        .record_place(RecordKind::Simulation, &campaign.names[1])
        .expect_err("no such record");
    // S01.csv is there, but it is the record of another section.
    assert_eq!(missing.help, None);
    same("record", &[missing], &["file-missing sections.csv:3:1"]);
    let missing =
        campaign.record_place(RecordKind::Track, &campaign.names[0]).expect_err("no such folder");
    same("folder", &[missing], &["key-missing campaign.yaml:1:1"]);
}

#[test]
fn a_good_campaign() {
    for path in [cases("good/small"), cases("good/small/campaign.yaml")] {
        let mut problems = Problems::default();
        let campaign = Campaign::open(&path, &mut problems)
            .unwrap_or_else(|| panic!("{}", problems.render(false)));
        assert_eq!(campaign.name, "small");
        assert_eq!(campaign.protocol.as_ref().map(|name| name.value.as_str()), Some("coach-check"));
        assert_eq!(
            campaign.vehicle.lookup("name").and_then(|node| node.scalar_text()),
            Some("coach")
        );
        let facts: Vec<_> = campaign
            .facts
            .iter()
            .map(|fact| {
                (fact.group.as_str(), fact.name.as_str(), fact.unit.as_deref(), fact.text.as_str())
            })
            .collect();
        assert_eq!(
            facts,
            [
                ("", "sampling_rate", Some("Hz"), "200"),
                ("", "simulation_ran_on", None, "measured track"),
                ("declared_tolerances", "Y offset", Some("kN"), "0.50")
            ]
        );
        let parameters: Vec<_> = campaign
            .parameters
            .iter()
            .map(|set| (set.name.text.as_str(), set.value.raw.as_str()))
            .collect();
        assert_eq!(parameters, [("window", "2 m"), ("percentile", "99.85")]);
        let (record, file) = campaign
            .read(RecordKind::Measurement.into(), &campaign.names[0], &wanted(), None)
            .expect("a record");
        assert_eq!((file.path.as_str(), record.rows), ("measurement/S01.csv", 4));
        assert_eq!(record.columns[2].values, [1500.0, -2250.0, 3000.0, 3500.0]);
        let table = campaign.sections.as_ref().expect("a table");
        let at = table
            .need_column("start")
            .map(|column| table.cell(0, column).map(|cell| cell.span.clone()))
            .expect("there");
        let axis = check_axis(
            &record,
            "time",
            "distance",
            Some(&Section { start: 100.2, end: 100.4, at }),
        )
        .expect("even");
        assert_eq!((axis.sampling_rate, axis.rows), (200.0, 1..3));
        assert_eq!(
            campaign.files.iter().map(|file| file.path.as_str()).collect::<Vec<_>>(),
            ["campaign.yaml", "vehicle.yaml", "sections.csv"]
        );
    }
}

#[test]
fn what_is_written_is_read_back() {
    let temp = tempfile::tempdir().expect("a temporary folder");
    let folder = temp.path().join("made");
    let mut problems = Problems::default();
    let old = Campaign::open(&cases("good/small"), &mut problems).expect("opens");
    let (record, _) =
        old.read(RecordKind::Simulation.into(), &old.names[0], &wanted(), None).expect("a record");
    let columns: Vec<OutColumn<'_>> = record
        .columns
        .iter()
        .map(|column| OutColumn {
            name: &column.name,
            unit: &column.unit,
            values: &column.values,
            decimals: 3,
        })
        .collect();
    let text = record_csv(&columns).expect("finite");
    let table = old.sections.as_ref().expect("a table");
    let header = table.columns.iter().map(|column| column.span.text().to_string()).collect();
    let rows = std::iter::once(header).chain(
        table.rows.iter().map(|row| row.iter().map(|cell| cell.value.clone()).collect::<Vec<_>>()),
    );
    let yaml = campaign_yaml(&[
        ("name", Entry::Text("made: again")),
        ("vehicle", Entry::Text("vehicle.yaml")),
        ("sections", Entry::Text("sections.csv")),
        ("measurement", Entry::Text("measurement")),
        ("sampling_rate [Hz]", Entry::Number(200.0)),
        ("parameters", Entry::Node(old.tree.get("parameters").expect("there"))),
    ]);
    let mut outputs = Outputs::new(&folder);
    outputs.add("campaign.yaml", yaml.as_bytes()).expect("added");
    outputs.add("vehicle.yaml", b"name: coach\n").expect("added");
    outputs.add("sections.csv", table_csv(&rows.collect::<Vec<_>>()).as_bytes()).expect("added");
    outputs.add("measurement/S01.csv", text.as_bytes()).expect("added");
    outputs.commit().expect("written");

    let new = Campaign::open(&folder, &mut problems)
        .unwrap_or_else(|| panic!("{}", problems.render(false)));
    assert_eq!(new.name, "made: again");
    assert_eq!(new.parameters.len(), 2);
    assert_eq!(new.facts[0].text, "200");
    assert_eq!(new.sections.as_ref().map(|table| table.rows.len()), Some(2));
    let (again, _) =
        new.read(RecordKind::Measurement.into(), &new.names[0], &wanted(), None).expect("a record");
    assert_eq!(again.columns, record.columns);
}

#[test]
fn without_a_section_table_every_measured_record_is_a_section() {
    let temp = tempfile::tempdir().expect("a temporary folder");
    let mut outputs = Outputs::new(temp.path());
    outputs
        .add("campaign.yaml", b"\xef\xbb\xbfname: two\r\nmeasurement: records\r\n")
        .expect("added");
    for name in ["b", "a", ".hidden"] {
        outputs.add(&format!("records/{name}.csv"), b"time [s]\n0\n1\n").expect("added");
    }
    outputs.commit().expect("written");
    let mut problems = Problems::default();
    let campaign = Campaign::open(temp.path(), &mut problems)
        .unwrap_or_else(|| panic!("{}", problems.render(false)));
    assert_eq!(
        campaign.names.iter().map(|name| name.value.as_str()).collect::<Vec<_>>(),
        ["a", "b"]
    );
    assert!(campaign.sections.is_none() && campaign.vehicle.entries().is_empty());
}

#[cfg(unix)]
#[test]
fn a_record_that_links_out_of_the_folder_is_not_read() {
    let temp = tempfile::tempdir().expect("a temporary folder");
    let secret = temp.path().join("secret.csv");
    std::fs::write(&secret, "time [s]\n1\n").expect("written");
    let mut outputs = Outputs::new(temp.path().join("campaign"));
    outputs
        .add("campaign.yaml", b"name: x\nmeasurement: m\nsections: sections.csv\n")
        .expect("added");
    outputs.add("sections.csv", b"section\nS01\n").expect("added");
    outputs.add("m/other.csv", b"").expect("added");
    outputs.commit().expect("written");
    std::os::unix::fs::symlink(&secret, temp.path().join("campaign/m/S01.csv")).expect("linked");
    let mut problems = Problems::default();
    let campaign = Campaign::open(&temp.path().join("campaign"), &mut problems)
        .unwrap_or_else(|| panic!("{}", problems.render(false)));
    let refused = campaign
        .read(RecordKind::Measurement.into(), &campaign.names[0], &[], None)
        .expect_err("outside");
    assert_eq!(refused[0].code, "path-outside");
}

#[test]
fn units_of_the_file_are_kept() {
    let record = read_record(&cases("good/small/measurement/S01.csv"), "S01.csv", &wanted())
        .expect("a record");
    assert_eq!(record.columns[2].unit, Unit::parse("kN").expect("known"));
}

/// Names that are devices on Windows, end in a point, or differ by case alone.
#[test]
fn names_that_no_other_system_has_are_told() {
    let told = |names: &[&str]| {
        let text = format!("section\n{}\n", names.join("\n"));
        let mut problems = Problems::default();
        let source = fishplate::source::Source::new("sections.csv", text.as_str());
        let table = Table::parse(source, String::new(), Some("section"), &mut problems);
        let table = table.unwrap_or_else(|| panic!("{}", problems.render(false)));
        not_portable(&table, &mut problems);
        problems.0.iter().map(|one| one.says.clone()).collect::<Vec<_>>()
    };
    assert_eq!(
        told(&["S01", "console", "com", "com12", "auxiliary", "lpt0"]),
        Vec::<String>::new()
    );
    assert_eq!(told(&["aux"]), ["`aux` is the name of a device on Windows"]);
    assert_eq!(told(&["COM7.a"]), ["`COM7.a` is the name of a device on Windows"]);
    assert_eq!(told(&["S1."]), ["`S1.` ends in a point, which Windows drops from names"]);
    assert_eq!(told(&["Straße", "s1", "S1"]), ["`s1` and `S1` differ by case alone"]);
}
