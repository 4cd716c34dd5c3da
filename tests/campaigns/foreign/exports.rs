//! Sound files that measuring systems, simulation programs and offices export: read, or refused
//! with what is not read. The files are in `tests/cases/foreign`; the values are those that the
//! texts show, and those of scipy 1.17, pyarrow 25 and openpyxl 3.1 for the others.

use fishplate::foreign::{File, Options, read};

use super::loggers::{case, channel, good, imported, refused};

/// Channels as `name [unit]`, and the second value of each.
fn described(file: &File) -> (Vec<String>, Vec<f64>) {
    let channels = || file.tables.iter().flat_map(|table| &table.channels);
    let name = |channel: &fishplate::foreign::Channel| {
        format!("{} [{}]", channel.name, channel.unit.as_deref().unwrap_or(""))
    };
    (channels().map(name).collect(), channels().map(|channel| channel.values[1]).collect())
}

#[track_caller]
fn names_and_values(name: &str, names: &[&str], values: &[f64]) {
    let (found, second) = described(&good(name));
    assert_eq!(found, names, "{name}");
    for (found, wanted) in second.iter().zip(values) {
        assert!((found - wanted).abs() < 1e-9, "{name}: {second:?}");
    }
    assert_eq!(second.len(), values.len(), "{name}");
}

#[test]
fn headers_of_texts() {
    let three = ["time [s]", "s [m]", "Y11 [kN]"];
    names_and_values("quoted-header.dat", &three, &[0.005, 100.2, 3.08]);
    names_and_values("blanks-header.dat", &three, &[0.005, 100.2, 3.08]);
    names_and_values("line-break-in-name.csv", &["t [s]", "Y [kN]", "Z [kN]"], &[0.1, 1.0, 2.0]);
    let two = ["t []", "Y []"];
    names_and_values("sep-line.csv", &two, &[0.1, 1.0]);
    names_and_values("minus-sign.csv", &two, &[0.01, -1.75]);
    names_and_values("quoted-decimal-comma.csv", &two, &[0.01, 1.75]);
    let names = ["TIME [(s)]", "DISTANCE [(m)]", "WSET 1 RIGHT Y [(kN)]", "WSET 1 RIGHT Q [(kN)]"];
    let names: Vec<String> = names.iter().map(|name| name.replace(['(', ')'], "")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    names_and_values("two-line-names.lis", &names, &[0.005, 100.2, 3.08, 54.035]);
    let (found, second) = described(&good("vampire.lis"));
    assert_eq!(
        found[..4],
        ["TIME [s]", "DISTANCE [m]", "WSET 1 RIGHT Y [kN]", "WSET 1 RIGHT Q [kN]"]
    );
    assert_eq!((found.len(), second[0]), (24, 0.005));
}

#[test]
fn lines_after_the_numbers_are_left_out() {
    let file = good("footer.csv");
    assert_eq!(channel(&file, "Y11").values.len(), 18);
    let fact = file.facts.iter().find(|(name, _)| name == "lines after the numbers");
    assert_eq!(fact.map(|(_, said)| said.as_str()), Some("left out from line 21"));
}

#[test]
fn kilometres_and_metres_are_a_distance() {
    let columns = imported(
        "  files: chainage.csv\n  time: {rate: 100 Hz}\n  distance: Location\n  channels: {v: Speed}\n",
    );
    assert_eq!(columns[1].1[..5], [130_999.0, 130_999.25, 130_999.5, 130_999.75, 131_000.0]);
}

/// At 2 s the value jumps from 2 to 3: two rows of one time, of which the later one counts.
#[test]
fn events_of_a_simulation_are_no_fault_of_the_clock() {
    let side = |rate: &str| {
        format!(
            "  files: event-rows.csv\n  time: {{from: time, unit: s}}\n{rate}  channels: {{y: {{from: y, unit: m}}}}\n"
        )
    };
    let columns = imported(&side("  rate: 10 Hz\n"));
    assert_eq!(columns[0].1.len(), 60);
    for (time, value) in columns[0].1.iter().zip(&columns[1].1) {
        let wanted = if *time < 1.99 { *time } else { time + 1.0 };
        assert!((value - wanted).abs() < 1e-6, "{time}: {value}");
    }
    refused(&side(""), "time-not-increasing");
}

#[test]
fn arrays_of_structs_and_scales_of_matlab() {
    let three = ["time [s]", "s [m]", "Y11 [kN]"];
    let values = [0.005, 100.2, 3.079_978_668_373_267_6];
    names_and_values("cells.mat", &three, &values);
    names_and_values("perchannel.mat", &three, &values);
    // Whole numbers with `scale` and `offset` for each column: 308 hundredths of a kN.
    names_and_values("scale.mat", &three, &[0.005, 100.2, 3.08]);
}

#[test]
fn sheets_of_excel() {
    let names = ["Zeit [s]", "Weg [m]", "Y re [kN]"];
    names_and_values("comma-text.xlsx", &names, &[0.005, 100.2, 3.079_978_668_373_268]);
    let file = good("comma-text.xlsx");
    assert_eq!(channel(&file, "Y re").values[7], 3.55);
    let file = good("cover-merged.xlsx");
    let tables: Vec<&str> = file.tables.iter().map(|table| table.name.as_str()).collect();
    assert_eq!(tables, ["S01", "S02"]);
    let names = ["Zeit [s]", "Weg [m]", "Radsatz 1 Y re [kN]", "Radsatz 1 Q re [kN]"];
    assert_eq!(described(&file).0[..4], names);
    assert!(file.facts.contains(&("Deckblatt: Radlast".into(), "54.5".into())), "{:?}", file.facts);
}

#[test]
fn what_is_not_read_is_named() {
    for (name, part) in [
        ("stream.arrow", "is an Arrow stream, which is not read"),
        ("gzip.parquet", "is compressed with GZIP, which is not read"),
        ("hdf5-old-layout.mat", "a data layout of version 2"),
    ] {
        let problems = read(&case(name), name, &Options::default()).expect_err(name);
        assert_eq!(problems[0].code, "format-not-read", "{name}: {}", problems[0].says);
        assert!(problems[0].says.contains(part), "{name}: {}", problems[0].says);
    }
}

/// A unit that is proposed is of the dimension that is wanted, or the same written in another way.
#[test]
fn a_unit_that_is_proposed_fits() {
    let text = refused(
        "  files: unit-advice.csv\n  time: t\n  distance: s\n  channels: {Y: F, a: a}\n",
        "unknown-unit",
    );
    assert!(text.contains("units: {\"kp\": ...}"), "{text}");
    assert!(text.contains("units: {\"m/s**2\": m/s^2}"), "{text}");
}

#[test]
fn a_draft_lists_what_is_left_out() {
    for (name, part) in [
        ("decimals.parquet", "type Decimal"),
        (
            "unknown-stamps.csv",
            "# left out: t (its cells are text, such as `01-Mar-2030 10:00:00`)",
        ),
    ] {
        let run = std::process::Command::new(env!("CARGO_BIN_EXE_fishplate"))
            .args(["import", "--draft"])
            .arg(case(name))
            .output()
            .expect("the program");
        let text = String::from_utf8_lossy(&run.stdout).into_owned();
        assert!(text.contains("# left out: ") && text.contains(part), "{name}: {text}");
    }
}
