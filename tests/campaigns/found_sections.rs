//! Sections that are found in continuous runs. `examples/run` is cut from a practice run whose
//! sections were found by an independent program, by the rules below.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use arrow_array::{Float64Array, RecordBatch};
use parquet::arrow::ArrowWriter;

use crate::common::program::fishplate;

fn done(words: &[&str], codes: &[i32]) -> String {
    let ran = fishplate(words);
    assert!(codes.contains(&ran.code), "{words:?}: {}{}", ran.stdout, ran.stderr);
    ran.stdout + &ran.stderr
}

/// Lengths by zone, speed within 2 km/h, curvature and cant constant from 30 m before to 15 m
/// behind, the first place on whole metres.
const RULES: &str = "protocol rules \"Rules of the practice run\"
  extends  en14363-2016-annex-t-found-sections

remove
  zone  every

zone 1 \"Straight track and very large radius curves\"
  where  direction is straight or radius >= 2500 m

zone 2 \"Large radius curves\"
  where  direction is not straight and 600 m < radius < 2500 m

zone 3 \"Small radius curves\"
  where  direction is not straight and 400 m <= radius <= 600 m

zone 4 \"Very small radius curves\"
  where  direction is not straight and 250 m <= radius < 400 m

sections
  length  250 m when zone is 1, 70 m when zone is 4, otherwise 100 m
  keep    at most 100 for each zone

find full_curve
  require  range of curvature <= 0.000000002 1/m and range of track_cant <= 0.000002 mm
";

/// Run, zone, start and end in m, cant deficiency in mm and speed in km/h of the independent
/// program.
const FOUND: [(&str, &str, f64, f64, f64, f64); 12] = [
    ("north", "1", 1229.0, 1479.0, 34.396, 147.7576),
    ("north", "1", 1479.0, 1729.0, 34.827, 148.2519),
    ("north", "1", 1842.0, 2092.0, 0.0, 150.0223),
    ("north", "2", 2367.0, 2467.0, 100.996, 143.1618),
    ("north", "1", 2782.0, 3032.0, 0.0, 150.0735),
    ("north", "2", 3311.0, 3411.0, 110.858, 140.361),
    ("south", "3", 7472.0, 7572.0, 93.781, 89.7959),
    ("south", "3", 7572.0, 7672.0, 95.135, 90.0798),
    ("south", "4", 8028.0, 8098.0, 85.655, 66.9639),
    ("south", "4", 8098.0, 8168.0, 86.443, 67.1581),
    ("south", "4", 8530.0, 8600.0, 90.48, 67.1042),
    ("south", "4", 8956.0, 9026.0, 72.955, 72.1199),
];

struct Found {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

fn found(folder: &Path, campaign: &str) -> Found {
    let (rules, table) = (folder.join("rules.fp"), folder.join("found.csv"));
    fs::write(&rules, RULES).expect("written");
    let shown = |path: &Path| path.display().to_string();
    done(&["sections", campaign, "--protocol", &shown(&rules), "--out", &shown(&table)], &[0]);
    let text = fs::read_to_string(&table).expect("a table");
    let mut lines =
        text.lines().map(|line| line.split(',').map(str::to_string).collect::<Vec<_>>());
    Found { header: lines.next().expect("a header"), rows: lines.collect() }
}

impl Found {
    fn cell<'a>(&self, row: &'a [String], name: &str) -> &'a str {
        &row[self
            .header
            .iter()
            .position(|heading| heading.split(" [").next() == Some(name))
            .expect(name)]
    }

    fn number(&self, row: &[String], name: &str) -> f64 {
        self.cell(row, name).parse().expect(name)
    }
}

/// Every section begins where that of the independent program does; its table has the cant
/// deficiency to 0.001 mm and the speed to 0.0001 km/h.
#[test]
fn the_sections_are_those_of_an_independent_program() {
    let folder = tempfile::tempdir().expect("a folder");
    let found = found(folder.path(), "examples/run");
    let places: Vec<_> = found
        .rows
        .iter()
        .map(|row| {
            (
                found.cell(row, "run"),
                found.cell(row, "zone"),
                found.number(row, "start"),
                found.number(row, "end"),
            )
        })
        .collect();
    assert_eq!(places, FOUND.map(|(run, zone, start, end, ..)| (run, zone, start, end)));
    for (row, (.., deficiency, speed)) in found.rows.iter().zip(FOUND) {
        assert!((found.number(row, "cant deficiency") - deficiency).abs() < 2e-3, "{row:?}");
        assert!((found.number(row, "speed") - speed).abs() < 1e-4, "{row:?}");
    }
}

/// A run as text gives the same sections and the same numbers as the run as Parquet: the stretches
/// are read in another way.
#[test]
fn runs_as_text_give_the_same_numbers() {
    let folder = tempfile::tempdir().expect("a folder");
    let copy = folder.path().join("copy").display().to_string();
    done(&["convert-records", "examples/run", "--to", "csv", "--out", &copy], &[0]);
    let (as_parquet, as_text) = (found(folder.path(), "examples/run"), found(folder.path(), &copy));
    assert_eq!(as_text.rows, as_parquet.rows);
    let numbers = |campaign: &str, name: &str| {
        let out = folder.path().join(name);
        done(
            &["certify", campaign, "--only", "results", "--out", &out.display().to_string()],
            &[0],
        );
        let text = fs::read_to_string(out.join("results.json")).expect("results");
        let results: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        assert_eq!(results["verdict"], "validated");
        (results["quantities"].clone(), results["sections"].as_array().map(Vec::len))
    };
    let (first, second) = (numbers("examples/run", "a"), numbers(&copy, "b"));
    assert_eq!(first, second);
    assert_eq!(first.1, Some(12));
}

/// A copy of the example with the table of the sections that are found in it.
fn with_table(copy: &Path) -> String {
    let shown = copy.display().to_string();
    done(&["convert-records", "examples/run", "--to", "parquet", "--out", &shown], &[0]);
    done(
        &["sections", "examples/run", "--out", &copy.join("sections.csv").display().to_string()],
        &[0],
    );
    let yaml = fs::read_to_string(copy.join("campaign.yaml")).expect("a campaign");
    fs::write(copy.join("campaign.yaml"), yaml + "sections: sections.csv\n").expect("written");
    shown
}

/// What is written as a table and used as such gives what is found and used at once.
#[test]
fn a_table_of_found_sections_can_be_used() {
    let folder = tempfile::tempdir().expect("a folder");
    let shown = with_table(&folder.path().join("copy"));
    let quantities = |campaign: &str, name: &str| {
        let out = folder.path().join(name);
        done(
            &["certify", campaign, "--only", "results", "--out", &out.display().to_string()],
            &[0],
        );
        let results: serde_json::Value =
            serde_json::from_str(&fs::read_to_string(out.join("results.json")).expect("results"))
                .expect("JSON");
        results["quantities"]
            .as_array()
            .expect("a list")
            .iter()
            .map(|quantity| quantity["std"].as_f64())
            .collect::<Vec<_>>()
    };
    let (found, used) = (quantities("examples/run", "a"), quantities(&shown, "b"));
    for (found, used) in found.iter().zip(&used) {
        let (Some(found), Some(used)) = (found, used) else { panic!("{found:?} {used:?}") };
        assert!((found - used).abs() < 1e-6 * found.abs(), "{found} {used}");
    }
}

/// Sections with records of their own give the numbers of the sections in the runs, but for the
/// band-pass from 0.4 Hz on, which has not wholly settled in the two lengths beside a section: in
/// the run it has more.
#[test]
fn sections_are_cut_out_of_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    for format in ["csv", "parquet"] {
        let cut = folder.path().join(format);
        let shown = cut.display().to_string();
        let said = done(&["sections", "examples/run", "--cut", &shown, "--records", format], &[0]);
        assert!(said.contains("written: 36 records of 12 sections"), "{said}");
        assert!(
            cut.join(format!("measurement/S01.{format}")).is_file()
                && !cut.join("records").exists()
        );
        let table = fs::read_to_string(cut.join("sections.csv")).expect("a table");
        let header = table.lines().next().expect("a header");
        assert!(
            header.starts_with("section,start [m],end [m]") && header.contains("Country")
                || header.contains("country"),
            "{header}"
        );
        let account = fs::read_to_string(cut.join("cut.csv")).expect("an account");
        assert!(
            account.contains(&format!("measurement/S12.{format}"))
                && account.contains("south,records/south-measured.parquet"),
            "{account}"
        );
        let number = |value: &serde_json::Value| value.as_f64().expect("a number");
        let numbers = |campaign: &str, name: &str| -> Vec<(String, f64)> {
            let out = folder.path().join(name);
            done(
                &["certify", campaign, "--only", "results", "--out", &out.display().to_string()],
                &[0],
            );
            let text = fs::read_to_string(out.join("results.json")).expect("results");
            let results: serde_json::Value = serde_json::from_str(&text).expect("JSON");
            let quantities = results["quantities"].as_array().expect("a list");
            let values = quantities
                .iter()
                .flat_map(|quantity| quantity["values"].as_array().expect("values"));
            values
                .flat_map(|value| {
                    ["simulated", "measured"]
                        .map(|side| (value["signal"].to_string(), number(&value[side])))
                })
                .collect()
        };
        let (in_runs, cut) = (numbers("examples/run", "a"), numbers(&shown, "b"));
        assert_eq!(in_runs.len(), cut.len());
        let mut largest: f64 = 0.0;
        for ((signal, one), (_, other)) in in_runs.iter().zip(&cut) {
            let differ = (one - other).abs() / one.abs().max(1e-3);
            assert!(
                differ < if signal.starts_with("\"a") { 0.01 } else { 1e-6 },
                "{signal} {one} {other}"
            );
            largest = largest.max(differ);
        }
        assert!(largest > 1e-4, "sections of a run share stretches: {largest}");
    }
}

/// Takes one force from a record, at the first sample beyond a distance in m.
fn without_number(record: &Path, beyond: f64) {
    let file = fs::File::open(record).expect("a record");
    let builder = parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder::try_new(file)
        .expect("Parquet");
    let schema = Arc::clone(builder.schema());
    let batches: Vec<RecordBatch> =
        builder.build().expect("a reader").map(|batch| batch.expect("rows")).collect();
    let place = |name: &str| {
        schema.fields().iter().position(|field| field.name().starts_with(name)).expect("a column")
    };
    let numbers = |batch: &RecordBatch, at: usize| {
        batch.column(at).as_primitive::<Float64Type>().values().to_vec()
    };
    let mut writer =
        ArrowWriter::try_new(fs::File::create(record).expect("a file"), Arc::clone(&schema), None)
            .expect("a writer");
    let mut taken = false;
    for batch in batches {
        let mut columns = batch.columns().to_vec();
        let row = numbers(&batch, place("distance"))
            .iter()
            .position(|at| *at > beyond)
            .filter(|_| !taken);
        if let Some(row) = row {
            let mut forces = numbers(&batch, place("Y_1R"));
            forces[row] = f64::NAN;
            columns[place("Y_1R")] = Arc::new(Float64Array::from(forces));
            taken = true;
        }
        writer
            .write(&RecordBatch::try_new(Arc::clone(&schema), columns).expect("columns"))
            .expect("written");
    }
    writer.close().expect("closed");
}

/// A fault in a stretch concerns the sections that would read it by themselves, not others that
/// share the stretch.
#[test]
fn a_fault_concerns_the_sections_that_read_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let copy = folder.path().join("copy");
    let shown = with_table(&copy);
    let results = |name: &str, codes: &[i32]| -> serde_json::Value {
        let out = folder.path().join(name);
        done(&["certify", &shown, "--only", "results", "--out", &out.display().to_string()], codes);
        serde_json::from_str(&fs::read_to_string(out.join("results.json")).expect("results"))
            .expect("JSON")
    };
    let before = results("before", &[0]);
    // The second section of the south needs its samples and two lengths of 100 m on each side. The
    // first shares its stretch, and ends its own need 100 m earlier.
    let sections = before["sections"].as_array().expect("a list");
    let second = sections
        .iter()
        .filter(|section| section["start"].as_f64().is_some_and(|start| start > 7000.0))
        .nth(1)
        .expect("in the south");
    let (name, end) =
        (second["section"].as_str().expect("a name"), second["end"].as_f64().expect("an end"));
    without_number(&copy.join("records/south-measured.parquet"), end + 150.0);
    let after = results("after", &[0, 1, 2]);
    let of = |results: &serde_json::Value| -> Vec<(String, String, f64)> {
        let values =
            results["quantities"].as_array().expect("a list").iter().flat_map(|quantity| {
                let of_value = |value: &serde_json::Value| {
                    let place = format!("{} {}", quantity["id"], value["signal"]);
                    (
                        value["section"].as_str().expect("a name").to_string(),
                        place,
                        value["measured"].as_f64().expect("a number"),
                    )
                };
                quantity["values"]
                    .as_array()
                    .expect("values")
                    .iter()
                    .map(of_value)
                    .collect::<Vec<_>>()
            });
        values.filter(|(section, ..)| section != name).collect()
    };
    // Whoever asks for a value of the section that shares the stretch has it from the same samples:
    // a trace, which reads fewer channels, and parts.
    let first = sections
        .iter()
        .rfind(|section| section["end"].as_f64() < second["end"].as_f64())
        .expect("before it");
    for (quantity, signal) in [("ay_rms", "ay_I"), ("az_max", "az_II"), ("Y_max", "Y_1R")] {
        let at = folder.path().join("after/results.json").display().to_string();
        let said = done(
            &[
                "trace",
                &at,
                quantity,
                first["section"].as_str().expect("a name"),
                signal,
                "--campaign",
                &shown,
            ],
            &[0],
        );
        assert!(said.contains("as in the report") && !said.contains("NOT"), "{said}");
    }
    let part =
        |number: usize| folder.path().join(format!("{number}.parquet")).display().to_string();
    for number in 0..5 {
        done(
            &["reduce", &shown, "--shard", &format!("{number}/5"), "--out", &part(number)],
            &[0, 1],
        );
    }
    let parts: Vec<String> = (0..5).map(part).collect();
    let judged = folder.path().join("judged").display().to_string();
    let words: Vec<&str> = ["judge", "--only", "results", "--out", &judged]
        .into_iter()
        .chain(parts.iter().map(String::as_str))
        .collect();
    done(&words, &[0, 1, 2]);
    let judged = fs::read(folder.path().join("judged/results.json")).expect("results");
    assert!(
        judged == fs::read(folder.path().join("after/results.json")).expect("results"),
        "parts and the whole differ"
    );

    let reason = |section: &serde_json::Value| section["reason"].as_str().map(str::to_string);
    let told = after["sections"]
        .as_array()
        .expect("a list")
        .iter()
        .find(|section| section["section"] == name)
        .and_then(reason);
    assert!(told.as_deref().is_some_and(|told| told.contains("`Y_1R`")), "{told:?}");
    let (before, after) = (of(&before), of(&after));
    assert_eq!(before.len(), after.len(), "only {name} has the fault");
    for ((section, place, one), (.., other)) in before.iter().zip(&after) {
        assert!(
            (one - other).abs() < 0.01 * one.abs().max(1e-3),
            "{section} {place} {one} {other}"
        );
    }
}

/// One run of the example as a campaign of its own, with one section a zone.
fn one_run(folder: &Path, run: &str, other: &str) -> String {
    let to = folder.join("runs").join(run);
    fs::create_dir_all(to.join("records")).expect("a folder");
    let example = Path::new("examples/run");
    for file in ["vehicle.yaml", "profile.csv"] {
        fs::copy(example.join(file), to.join(file)).expect("copied");
    }
    for kind in ["measured", "simulated", "track"] {
        let file = format!("records/{run}-{kind}.parquet");
        fs::copy(example.join(&file), to.join(&file)).expect("copied");
    }
    let yaml = fs::read_to_string(example.join("campaign.yaml")).expect("a campaign");
    let (before, from) = yaml.split_once(&format!("  {other}:\n")).expect("the other run");
    let after: Vec<&str> = from.lines().skip_while(|line| line.starts_with("    ")).collect();
    let yaml = format!("{before}{}\n", after.join("\n"))
        .replace("sections_per_zone: 2", "sections_per_zone: 1");
    fs::write(to.join("campaign.yaml"), yaml).expect("written");
    to.display().to_string()
}

/// `diagnose` and `blind` work on the sections that are found, in references as well. A catalogue
/// with one effect keeps it short.
#[test]
fn runs_are_diagnosed_by_their_sections() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name).display().to_string();
    let (north, south) =
        (one_run(folder.path(), "north", "south"), one_run(folder.path(), "south", "north"));
    let shipped = fs::read_to_string("effects/bogie-vehicle.yaml").expect("the catalogue");
    let (_, effects) = shipped.split_once("\neffects:\n").expect("effects");
    let removed = effects
        .lines()
        .take_while(|line| line.is_empty() || line.starts_with(' '))
        .filter(|line| {
            line.starts_with("  ")
                && !line.starts_with("   ")
                && line.ends_with(':')
                && *line != "  friction:"
        })
        .map(|line| format!("{line} remove\n"));
    let few = format!(
        "catalogue: few\ntitle: One effect\nextends: bogie-vehicle\neffects:\n{}",
        removed.collect::<String>()
    );
    fs::write(at("few.yaml"), few).expect("written");
    let json = |path: &str| -> serde_json::Value {
        serde_json::from_str(&fs::read_to_string(at(path)).expect("a result")).expect("JSON")
    };

    // The friction of the example is the same on both sides; what its change would do is computed
    // with the sections found as well.
    let truth =
        r#"{"kind": "single", "effects": [{"name": "friction", "parameters": {"friction": 0.2}}]}"#;
    fs::write(Path::new(&south).join("truth.json"), truth).expect("written");
    done(&["blind", &south, "--effects", &at("few.yaml"), "--out", &at("blind")], &[0]);
    let case = &json("blind/blind.json")["cases"][0];
    assert_eq!(
        (&case["fault"], &case["verdict"]),
        (&serde_json::Value::Null, &"no significant gap".into()),
        "{case:#}"
    );
    assert!(case["detectability"].as_f64().is_some_and(|distance| distance > 5.0), "{case:#}");

    done(
        &[
            "diagnose",
            &south,
            "--reference",
            &north,
            "--effects",
            &at("few.yaml"),
            "--out",
            &at("out"),
        ],
        &[0, 1],
    );
    let (alone, beside) = (json("blind/south/diagnosis.json"), json("out/diagnosis.json"));
    let standing = |found: &serde_json::Value| {
        found["notes"].to_string().contains("standing discrepancy of the simulation was estimated")
    };
    assert!(!standing(&alone) && standing(&beside), "{:#} {:#}", alone["notes"], beside["notes"]);
    assert_eq!((&alone["how"]["sections"], &beside["how"]["sections"]), (&6.into(), &6.into()));
}

/// The wheel sensor of the measurement counts 3 m too much in 1 km, and begins 1 m ahead. The shift
/// that is found at each section is the opposite of that in its middle; corrected, the numbers are
/// those of the run without drift.
#[test]
fn a_drift_of_the_distance_is_found_and_corrected() {
    let drift = |x: f64| 1.0 + 0.003 * (x - 1150.0);
    let folder = tempfile::tempdir().expect("a folder");
    let copy = folder.path().join("copy");
    let shown = copy.display().to_string();
    done(&["convert-records", "examples/run", "--to", "csv", "--out", &shown], &[0]);
    let results = |name: &str| {
        let out = folder.path().join(name);
        done(&["certify", &shown, "--only", "results", "--out", &out.display().to_string()], &[0]);
        let text = fs::read_to_string(out.join("results.json")).expect("results");
        serde_json::from_str::<serde_json::Value>(&text).expect("JSON")
    };
    let sound = results("sound");
    let record = copy.join("records/north-measured.csv");
    let text = fs::read_to_string(&record).expect("a record");
    let moved = text.lines().enumerate().map(|(row, line)| {
        let mut cells: Vec<String> = line.split(',').map(str::to_string).collect();
        if row > 0 {
            let x: f64 = cells[1].parse().expect("a distance");
            cells[1] = format!("{:.4}", x + drift(x));
        }
        cells.join(",") + "\n"
    });
    fs::write(&record, moved.collect::<String>()).expect("written");
    let yaml = fs::read_to_string(copy.join("campaign.yaml")).expect("a campaign");
    fs::write(
        copy.join("campaign.yaml"),
        yaml.replace("    country: DE", "    country: DE\n    drift: correct"),
    )
    .expect("written");
    let corrected = results("corrected");
    let run = &corrected["found_sections"][0]["runs"][0];
    let points = run["drift"]["points"].as_array().expect("points");
    assert!(points.len() >= 4 && run["drift"]["corrected"] == true, "{run:#}");
    for point in points {
        let (start, shift) =
            (point["start"].as_f64().expect("a start"), point["shift"].as_f64().expect("a shift"));
        let length = if start < 2300.0 || start > 2700.0 && start < 3100.0 { 250.0 } else { 100.0 };
        let expected = -drift(start + length / 2.0);
        assert!((shift - expected).abs() < 0.3, "{start}: {shift} for {expected}");
    }
    // Along the whole run as well, at places of the simulation.
    let along = run["drift"]["along"].as_array().expect("points");
    assert!(
        along.len() >= 2
            && run["drift"]["windows"]
                .as_u64()
                .is_some_and(|looked| looked as usize >= along.len()),
        "{run:#}"
    );
    for point in along {
        let (at, shift) =
            (point["at"].as_f64().expect("a place"), point["shift"].as_f64().expect("a shift"));
        assert!((shift + drift(at)).abs() < 0.3, "{at}: {shift} for {}", -drift(at));
    }
    // What the program finds without a drift is within a few centimetres of nothing.
    for point in
        sound["found_sections"][0]["runs"][0]["drift"]["points"].as_array().expect("points")
    {
        assert!(point["shift"].as_f64().is_some_and(|shift| shift.abs() < 0.2), "{point}");
    }
    let std = |results: &serde_json::Value| -> Vec<f64> {
        results["quantities"]
            .as_array()
            .expect("a list")
            .iter()
            .filter_map(|quantity| quantity["std"].as_f64())
            .collect()
    };
    for (sound, corrected) in std(&sound).into_iter().zip(std(&corrected)) {
        assert!((sound - corrected).abs() < 0.15 * sound, "{sound} {corrected}");
    }
}

#[test]
fn what_cannot_be_looked_into_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("found.csv").display().to_string();
    let refused = |words: &[&str], code: &str| {
        let said = done(words, &[2]);
        assert!(said.contains(&format!("error[{code}]")), "{said}");
        assert!(!Path::new(&out).exists());
    };
    refused(&["sections", "examples/coach", "--out", &out], "no-search");
    refused(
        &[
            "sections",
            "examples/coach",
            "--protocol",
            "en14363-2016-annex-t-found-sections",
            "--out",
            &out,
        ],
        "no-runs",
    );
    refused(
        &[
            "sections",
            "examples/run",
            "--set",
            "speed_change=0.1 km/h",
            "--set",
            "steady_before=200 m",
            "--set",
            "steady_behind=200 m",
            "--out",
            &out,
        ],
        "nothing-found",
    );
    refused(
        &["simulate", "examples/run", "--protocol", "en14363-2016-annex-t", "--out", &out],
        "no-sections",
    );
    refused(&["sections", "examples/coach", "--cut", &out], "no-runs");
    // A protocol that does not look for sections leaves nothing to cut, and none of it may be
    // written among the records.
    refused(
        &["diagnose", "examples/run", "--protocol", "en14363-2016-annex-t", "--out", &out],
        "no-sections",
    );
    let copy = folder.path().join("copy");
    done(
        &["convert-records", "examples/run", "--to", "csv", "--out", &copy.display().to_string()],
        &[0],
    );
    let shown = copy.display().to_string();
    refused(&["sections", &shown, "--cut", &shown], "output-is-input");
    fs::copy(copy.join("records/south-measured.csv"), copy.join("records/north-measured.csv"))
        .expect("copied");
    refused(&["sections", &copy.display().to_string(), "--out", &out], "records-apart");
}

/// The sections that are found are simulated: each has the record that the model makes of the track
/// cut for it, and the campaign that is written has a file for each.
#[test]
fn the_sections_found_in_runs_are_simulated() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name).display().to_string();
    done(
        &["simulate", "examples/run", "--effect", "friction=0.2", "--out", &at("simulated")],
        &[0],
    );
    done(&["sections", "examples/run", "--cut", &at("cut")], &[0]);
    done(&["simulate", &at("cut"), "--effect", "friction=0.2", "--out", &at("again")], &[0]);
    let records = |name: &str| {
        let mut all: Vec<_> = fs::read_dir(Path::new(&at(name)).join("simulation"))
            .expect("records")
            .map(|one| one.expect("a file").path())
            .collect();
        all.sort();
        all.iter()
            .map(|path| {
                (path.file_name().expect("a name").to_owned(), fs::read(path).expect("bytes"))
            })
            .collect::<Vec<_>>()
    };
    let made = records("simulated");
    assert_eq!(made.len(), 12);
    assert!(made == records("again"), "the records differ from those of the cut sections");
    done(&["certify", &at("simulated"), "--only", "results", "--out", &at("report")], &[0, 1]);
}

/// Neighbouring sections share a stretch of a run. `compare` evaluates each for two protocols
/// together, and many times.
#[test]
fn compare_has_the_numbers_of_certify() {
    let folder = tempfile::tempdir().expect("a folder");
    let json = |path: &str| -> serde_json::Value {
        serde_json::from_str(&fs::read_to_string(folder.path().join(path)).expect("written"))
            .expect("JSON")
    };
    let out = |name: &str| folder.path().join(name).display().to_string();
    let text = "protocol bare \"Without plausibility rules\"\n  extends  en14363-2016-annex-t-found-sections\n\nremove\n  plausibility  every\n";
    let bare = out("bare.fp");
    fs::write(&bare, text).expect("written");
    let named = "en14363-2016-annex-t-found-sections";
    done(
        &[
            "compare",
            "examples/run",
            "--protocol",
            named,
            "--protocol",
            &bare,
            "--out",
            &out("both"),
        ],
        &[0, 1],
    );
    let both = json("both/comparison.json");
    for (protocol, file) in [(named, named), ("bare", &bare)] {
        let alone = format!("{protocol}-alone");
        done(
            &[
                "certify",
                "examples/run",
                "--protocol",
                file,
                "--only",
                "results",
                "--out",
                &out(&alone),
            ],
            &[0, 1],
        );
        let alone = json(&format!("{alone}/results.json"));
        let mut compared = 0;
        for ratio in both["ratios"]
            .as_array()
            .expect("a list")
            .iter()
            .filter(|ratio| ratio["protocol"] == protocol)
        {
            let quantity = alone["quantities"]
                .as_array()
                .expect("a list")
                .iter()
                .find(|known| known["id"] == ratio["quantity"]);
            let number = if ratio["metric"] == "mean" { "mean" } else { "std" };
            assert_eq!(
                quantity.map(|quantity| &quantity[number]),
                Some(&ratio["value"]),
                "{ratio}"
            );
            compared += 1;
        }
        assert_eq!(compared, 24);
    }
}
