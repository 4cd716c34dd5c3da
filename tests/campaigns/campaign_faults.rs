//! Every kind of bad input of a campaign, end to end: exit code, message, place, and what is
//! written.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::campaign::{cell, lines, replace, tiny};
use crate::common::program::{Certified, certify, files};

const RESULTS: [&str; 2] = ["--only", "results"];

/// The tiny campaign with one change.
fn with(change: impl FnOnce(&Path)) -> Certified {
    let folder = tiny();
    change(folder.path());
    certify(folder.path(), &RESULTS)
}

fn bytes(path: &Path, change: impl FnOnce(Vec<u8>) -> Vec<u8>) {
    fs::write(path, change(fs::read(path).expect("readable"))).expect("written");
}

/// Keeps the header and every n-th row.
fn thinned(path: &Path, nth: usize) {
    lines(path, |lines| {
        let mut row = 0;
        lines.retain(|_| {
            row += 1;
            row == 1 || (row - 2) % nth == 0
        });
    });
}

/// What stands beside `parameters` instead of below it sets nothing, and says so.
#[test]
fn a_parameter_at_the_margin_is_told() {
    let found = with(|campaign| {
        let path = campaign.join("campaign.yaml");
        let text = fs::read_to_string(&path).expect("readable");
        fs::write(&path, text + "lowpass_frequency: 10 Hz\n").expect("written");
    });
    assert_eq!(found.ran.code, 0, "{}", found.ran.stderr);
    for part in [
        "warning[fact-like-parameter]: `lowpass_frequency`",
        "campaign.yaml:6:20",
        "below `parameters`",
    ] {
        assert!(found.ran.stderr.contains(part), "{part}: {}", found.ran.stderr);
    }
}

/// A record that is one line, as of old Apple programs, is told as such: by `certify`, and by the
/// values of a part, which stay small.
#[test]
fn a_record_with_carriage_returns_alone() {
    let path = "measurement/S01.csv";
    let found = with(|campaign| {
        bytes(&campaign.join(path), |text| {
            text.into_iter().map(|c| if c == b'\n' { b'\r' } else { c }).collect()
        })
    });
    let reason =
        found.ran.stdout.lines().find(|line| line.contains("S01 not used")).expect("a reason");
    assert!(
        reason.contains("the lines end with a carriage return (CR) alone") && reason.len() < 300,
        "{reason}"
    );
}

#[test]
fn a_sound_campaign_validates() {
    let found = with(|_| {});
    assert_eq!(found.ran.code, 0, "{}{}", found.ran.stdout, found.ran.stderr);
    assert!(
        found.results()["sections"]
            .as_array()
            .expect("a list")
            .iter()
            .all(|section| section["used"] == true)
    );
}

/// A fault in one section: it is not used, with this reason, and zone 1 has one section too few.
#[test]
fn one_faulty_section_is_not_used() {
    const M: &str = "measurement/S01.csv";
    const S: &str = "simulation/S01.csv";
    type Change = fn(&Path);
    let cases: &[(&str, Change, &str)] = &[
        (
            "missing file",
            |campaign| fs::remove_file(campaign.join(M)).expect("removed"),
            "there is no file `measurement/S01.csv` or `S01.parquet` (sections.csv, row 2)",
        ),
        (
            "missing channel",
            |campaign| replace(&campaign.join(S), "Y_1R [kN]", "Y1R [kN]"),
            "`simulation/S01.csv` has no column `Y_1R`: did you mean `Y1R`?",
        ),
        (
            "wrong unit",
            |campaign| replace(&campaign.join(M), "Q_3L [kN]", "Q_3L [m/s^2]"),
            "the column `Q_3L` is in m/s^2, which is an acceleration; a force is needed (measurement/S01.csv, row 1)",
        ),
        (
            "unknown unit",
            |campaign| replace(&campaign.join(M), "Q_3L [kN]", "Q_3L [kp]"),
            "the unit of the column `Q_3L`: `kp` is not a known unit (measurement/S01.csv, row 1)",
        ),
        (
            "no unit",
            |campaign| replace(&campaign.join(M), "Q_3L [kN]", "Q_3L"),
            "the column `Q_3L` has no unit; a force is needed (measurement/S01.csv, row 1): write the unit in square brackets: `Q_3L [...]`, or `Q_3L [-]` for a plain number",
        ),
        (
            "time goes back",
            |campaign| cell(&campaign.join(M), 100, "time [s]", "0.5"),
            "`time` goes back from 0.98 s to 0.5 s at row 101 of `measurement/S01.csv`; it must increase",
        ),
        (
            "distance stands still",
            |campaign| cell(&campaign.join(M), 100, "distance [m]", "39.200"),
            "`distance` stays at 39.2 m at row 101 of `measurement/S01.csv`; it must increase",
        ),
        (
            "gap",
            |campaign| lines(&campaign.join(M), |lines| drop(lines.drain(100..120))),
            "`time` has a gap of 0.21 s between rows 100 and 101 of `measurement/S01.csv`, 21 sampling steps",
        ),
        (
            "uneven step",
            |campaign| cell(&campaign.join(M), 100, "time [s]", "0.994"),
            "the step of `time` is 0.014 s at row 101 of `measurement/S01.csv`, 0.01 s on average: records must have a constant sampling rate",
        ),
        (
            "NaN",
            |campaign| cell(&campaign.join(S), 7, "ay_I [m/s^2]", "NaN"),
            "`ay_I`: `NaN` is not a finite number (simulation/S01.csv, row 8)",
        ),
        (
            "infinite",
            |campaign| cell(&campaign.join(S), 7, "ay_I [m/s^2]", "-inf"),
            "`ay_I`: `-inf` is not a finite number (simulation/S01.csv, row 8)",
        ),
        (
            "word",
            |campaign| cell(&campaign.join(S), 7, "ay_I [m/s^2]", "overload"),
            "`ay_I`: `overload` is not a number (simulation/S01.csv, row 8)",
        ),
        (
            "empty cell",
            |campaign| cell(&campaign.join(S), 7, "ay_I [m/s^2]", ""),
            "`ay_I`: the cell is empty; expected a number (simulation/S01.csv, row 8)",
        ),
        (
            "decimal comma in quotes",
            |campaign| cell(&campaign.join(S), 7, "ay_I [m/s^2]", "\"0,25\""),
            "`ay_I`: `0,25` has a decimal comma; numbers are written with a point (simulation/S01.csv, row 8)",
        ),
        (
            "decimal comma",
            |campaign| {
                lines(&campaign.join(S), |lines| {
                    lines.iter_mut().skip(1).for_each(|line| *line = line.replace('.', ","))
                })
            },
            "the row has 28 values, the header 14 columns: the numbers seem to have decimal commas (simulation/S01.csv, row 2 and 4 more): write numbers with a point; and 821 more problems in `simulation/S01.csv`",
        ),
        (
            "semicolon",
            |campaign| {
                lines(&campaign.join(S), |lines| {
                    lines.iter_mut().for_each(|line| *line = line.replace(',', ";"))
                })
            },
            "the columns are separated by semicolons, not by commas (simulation/S01.csv, row 1): write a comma between the columns and a point in the numbers",
        ),
        (
            "semicolon and decimal comma",
            |campaign| {
                lines(&campaign.join(S), |lines| {
                    lines
                        .iter_mut()
                        .for_each(|line| *line = line.replace(',', ";").replace('.', ","))
                });
            },
            "the columns are separated by semicolons, not by commas (simulation/S01.csv, row 1): write a comma between the columns and a point in the numbers",
        ),
        (
            "empty file",
            |campaign| fs::write(campaign.join(M), "").expect("written"),
            "`measurement/S01.csv` is empty",
        ),
        (
            "header only",
            |campaign| lines(&campaign.join(M), |lines| lines.truncate(1)),
            "`measurement/S01.csv` has a header and no samples",
        ),
        (
            "cut off",
            |campaign| bytes(&campaign.join(M), |bytes| bytes[..bytes.len() - 60].to_vec()),
            "the file ends inside a row: 7 of 14 values (measurement/S01.csv, row 827): the file may have been cut off; export or copy it again",
        ),
        (
            "UTF-16",
            |campaign| {
                bytes(&campaign.join(M), |bytes| {
                    [0xff, 0xfe]
                        .into_iter()
                        .chain(bytes.into_iter().flat_map(|byte| [byte, 0]))
                        .collect()
                });
            },
            "`measurement/S01.csv` is UTF-16 text, not UTF-8: save the file as UTF-8",
        ),
        (
            "Latin-1",
            |campaign| {
                bytes(&campaign.join(M), |bytes| [b"K\xf6ln [-],".as_slice(), &bytes].concat())
            },
            "byte 2 of `measurement/S01.csv`, hexadecimal f6, is not UTF-8: save the file as UTF-8",
        ),
        (
            "folder in its place",
            |campaign| {
                fs::remove_file(campaign.join(M)).expect("removed");
                fs::create_dir(campaign.join(M)).expect("made");
            },
            "there is no file `measurement/S01.csv` or `S01.parquet` (sections.csv, row 2)",
        ),
        (
            "section outside the record",
            |campaign| cell(&campaign.join("sections.csv"), 1, "end [m]", "500"),
            "the section from 40 m to 500 m is not inside `simulation/S01.csv`, which has `distance` from 0 m to 330 m: 170 m at the end missing (sections.csv, row 2); the section from 40 m to 500 m is not inside `measurement/S01.csv`, which has `distance` from 0 m to 330 m: 170 m at the end missing (sections.csv, row 2)",
        ),
        (
            "section reversed",
            |campaign| cell(&campaign.join("sections.csv"), 1, "end [m]", "30"),
            "its start is not before its end (sections.csv, row 2)",
        ),
        (
            "no start",
            |campaign| cell(&campaign.join("sections.csv"), 1, "start [m]", ""),
            "`start` is empty (sections.csv, row 2)",
        ),
        (
            "start with a comma",
            |campaign| cell(&campaign.join("sections.csv"), 1, "start [m]", "\"40,5\""),
            "`start`: `40,5` has a decimal comma; numbers are written with a point (sections.csv, row 2)",
        ),
        (
            "radius contradicts the zone",
            |campaign| {
                cell(&campaign.join("sections.csv"), 1, "direction", "right");
                cell(&campaign.join("sections.csv"), 1, "radius [m]", "300");
            },
            "does not meet the condition of zone 1: not met: direction is straight or (radius > 600 m and |cant_deficiency| <= 40 mm), to be confirmed against the standard; found: direction right, curve radius 300 m",
        ),
        (
            "no radius",
            |campaign| cell(&campaign.join("sections.csv"), 1, "direction", "right"),
            "it cannot be determined whether it meets the condition of zone 1: `radius` is empty (sections.csv, row 2)",
        ),
        (
            "zone unknown",
            |campaign| cell(&campaign.join("sections.csv"), 1, "zone [-]", "7"),
            "`zone`: `7` is not one of 1, 2, 3, 4 (sections.csv, row 2)",
        ),
        (
            "zone empty",
            |campaign| cell(&campaign.join("sections.csv"), 1, "zone [-]", ""),
            "`zone` is empty (sections.csv, row 2)",
        ),
        (
            "direction misspelt",
            |campaign| cell(&campaign.join("sections.csv"), 1, "direction", "straigth"),
            "`direction`: `straigth` is not one of right, left, straight; did you mean `straight`? (sections.csv, row 2)",
        ),
        (
            "too short",
            |campaign| cell(&campaign.join("sections.csv"), 1, "end [m]", "289.9"),
            "minimum length: 249.9 m; at least 250 m required",
        ),
        (
            "Q is zero",
            |campaign| cell(&campaign.join(M), 300, "Q_1R [kN]", "0.00"),
            "Samples out of line; required: spike <= larger of (larger of 9 * noise_floor, 1.3 * std), 3 * siblings(spike) or resolution > 0.3 * std or repeated > 25 %",
        ),
    ];
    for (case, change, reason) in cases {
        let found = with(change);
        assert_eq!(found.ran.code, 1, "{case}: {}{}", found.ran.stdout, found.ran.stderr);
        assert_eq!(found.reason("S01").as_deref(), Some(*reason), "{case}");
        let results = found.results();
        assert_eq!(results["verdict"], "not assessable", "{case}");
        assert_eq!(
            results["reasons"][0], "zone 1 has 2 usable sections; at least 3 required",
            "{case}"
        );
        assert_eq!(results["quantities"][0]["pairs"], 44, "{case}");
        let line = format!("  S01 not used: {reason}\n");
        assert!(found.ran.stdout.contains(&line), "{case}: {}", found.ran.stdout);
    }
}

/// The values of all quantities, for campaigns that must give the same.
fn values(found: &Certified) -> Vec<f64> {
    assert!(found.ran.code <= 1, "{}", found.ran.stderr);
    let results = found.results();
    let pairs = results["quantities"]
        .as_array()
        .expect("a list")
        .iter()
        .flat_map(|quantity| quantity["values"].as_array().expect("a list").clone());
    pairs
        .flat_map(|pair| {
            ["simulated", "measured", "difference"].map(|key| pair[key].as_f64().expect("a number"))
        })
        .collect()
}

fn records(campaign: &Path) -> Vec<PathBuf> {
    ["measurement", "simulation"].into_iter().flat_map(|kind| files(&campaign.join(kind))).collect()
}

#[test]
fn line_ends_and_byte_order_marks_make_no_difference() {
    let plain = values(&with(|_| {}));
    let windows = with(|campaign| {
        for path in files(campaign) {
            bytes(&path, |text| {
                let text = String::from_utf8(text).expect("UTF-8");
                format!("\u{feff}{}", text.replace('\n', "\r\n")).into_bytes()
            });
        }
    });
    assert_eq!(values(&windows), plain);
}

#[test]
fn units_are_converted() {
    let plain = values(&with(|_| {}));
    let newtons = with(|campaign| {
        for path in records(campaign) {
            lines(&path, |lines| {
                let at =
                    lines[0].split(',').position(|heading| heading == "Q_1L [kN]").expect("there");
                lines[0] =
                    lines[0].replace("Q_1L [kN]", "Q_1L [N]").replace("time [s]", "time [ms]");
                for line in lines.iter_mut().skip(1) {
                    let mut cells: Vec<String> = line.split(',').map(str::to_string).collect();
                    for at in [0, at] {
                        let number: f64 = cells[at].parse().expect("a number");
                        cells[at] = format!("{:.3}", number * 1000.0);
                    }
                    *line = cells.join(",");
                }
            });
        }
        replace(&campaign.join("sections.csv"), "radius [m]", "radius [km]");
        for row in 4..=12 {
            lines(&campaign.join("sections.csv"), |lines| {
                let mut cells: Vec<String> = lines[row].split(',').map(str::to_string).collect();
                cells[4] = (cells[4].parse::<f64>().expect("a radius") / 1000.0).to_string();
                lines[row] = cells.join(",");
            });
        }
    });
    let newtons = values(&newtons);
    assert_eq!(newtons.len(), plain.len());
    for (a, b) in newtons.iter().zip(&plain) {
        // Rounding of decimal numbers times 1000, and of the sampling rate, only.
        assert!((a - b).abs() <= 1e-9 * (1.0 + b.abs()), "{a} {b}");
    }
}

#[test]
fn simulation_and_measurement_may_differ_in_rate_and_extent() {
    let found = with(|campaign| {
        for path in files(&campaign.join("measurement")) {
            thinned(&path, 2);
            lines(&path, |lines| drop(lines.drain(1..20)));
        }
    });
    assert_eq!(found.ran.code, 0, "{}{}", found.ran.stdout, found.ran.stderr);
    assert_eq!(found.reason("S01"), None);
}

#[test]
fn a_position_that_no_record_has_is_left_out_with_a_note() {
    let found = with(|campaign| {
        for path in files(&campaign.join("measurement")) {
            replace(&path, "Q_3L [kN]", "spare [kN]");
        }
    });
    assert_eq!(found.ran.code, 0, "{}{}", found.ran.stdout, found.ran.stderr);
    let results = found.results();
    let note = "`Q_3L` is in no record of the measurement; its position is left out";
    assert!(
        results["notes"].as_array().expect("a list").iter().any(|found| found == note),
        "{}",
        results["notes"]
    );
    let pairs: Vec<u64> = results["quantities"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|quantity| quantity["pairs"].as_u64().expect("a count"))
        .collect();
    assert_eq!(pairs, [48, 36, 36, 24, 48, 36, 36, 24, 24, 24, 24, 24]);
}

#[test]
fn too_few_signals_are_not_assessable() {
    let found = with(|campaign| {
        for path in files(&campaign.join("measurement")) {
            replace(&path, "az_II [m/s^2]", "spare [m/s^2]");
        }
    });
    assert_eq!(found.ran.code, 1);
    let results = found.results();
    assert_eq!(results["verdict"], "not assessable");
    assert_eq!(
        results["reasons"],
        serde_json::json!([
            "az_rms: 1 signal recorded; at least 2 required",
            "az_max: 1 signal recorded; at least 2 required"
        ])
    );
    let quantity = &results["quantities"][9];
    assert_eq!(
        (quantity["holds"].is_null(), quantity["reason"].as_str()),
        (true, Some("1 signal recorded; at least 2 required"))
    );
}

#[test]
fn too_few_sections_are_not_assessable() {
    let found = with(|campaign| lines(&campaign.join("sections.csv"), |lines| drop(lines.pop())));
    assert_eq!(found.ran.code, 1);
    assert_eq!(found.results()["reasons"][0], "zone 4 has 2 usable sections; at least 3 required");
    assert!(
        found.ran.stdout.contains(
            "Verdict: not assessable\n  zone 4 has 2 usable sections; at least 3 required\n"
        ),
        "{}",
        found.ran.stdout
    );
}

#[test]
fn the_report_says_why_a_section_is_not_used() {
    let folder = tiny();
    cell(&folder.path().join("measurement/S05.csv"), 9, "Y_1R [kN]", "NaN");
    let found = certify(folder.path(), &["--only", "html"]);
    assert_eq!(found.ran.code, 1);
    let html = found.text("report.html");
    assert!(
        html.replace("&#x2f;", "/")
            .contains("`Y_1R`: `NaN` is not a finite number (measurement/S05.csv, row 10)")
    );
}

/// A protocol may say that the first faulty section ends the run.
#[test]
fn a_protocol_may_stop_at_a_fault() {
    let folder = tiny();
    let protocol = folder.path().join("strict.fp");
    fs::write(
        &protocol,
        "protocol strict \"Stops\"\n  extends  en14363-2016-annex-t\n\nsections\n  faulty  stop\n",
    )
    .expect("written");
    let strict = ["--protocol", protocol.to_str().expect("UTF-8"), "--only", "results"];
    assert_eq!(certify(folder.path(), &strict).ran.code, 0);
    cell(&folder.path().join("measurement/S05.csv"), 9, "Y_1R [kN]", "NaN");
    let found = certify(folder.path(), &strict);
    assert_eq!(found.ran.code, 2, "{}{}", found.ran.stdout, found.ran.stderr);
    for part in [
        "error[not-finite]",
        "measurement/S05.csv:10:",
        "error[faulty-section]: section S05 is faulty",
        "sections.csv:6:1",
    ] {
        assert!(found.ran.stderr.contains(part), "{part}\n{}", found.ran.stderr);
    }
    assert_eq!(found.ran.stdout, "");
}

/// Faults of the campaign as a whole: nothing is written.
#[test]
fn unusable_campaigns() {
    type Change = fn(&Path);
    let cases: &[(&str, Change, &[&str])] = &[
        (
            "no campaign file",
            |campaign| fs::remove_file(campaign.join("campaign.yaml")).expect("removed"),
            &[
                "error[file-missing]",
                "/campaign.yaml`",
                "a campaign is a folder with a file `campaign.yaml`",
            ],
        ),
        (
            "no folder",
            |campaign| fs::remove_dir_all(campaign).expect("removed"),
            &["error[folder-missing]: there is no folder"],
        ),
        (
            "no name",
            |campaign| replace(&campaign.join("campaign.yaml"), "name: Tiny\n", ""),
            &[
                "error[key-missing]: `name` is missing: what the campaign is called",
                "campaign.yaml:1:1",
            ],
        ),
        (
            "no vehicle file",
            |campaign| fs::remove_file(campaign.join("vehicle.yaml")).expect("removed"),
            &["error[file-missing]", "campaign.yaml:2:10"],
        ),
        (
            "vehicle datum missing",
            |campaign| {
                replace(&campaign.join("vehicle.yaml"), "static_wheel_load", "static_wheelload")
            },
            &[
                "error[missing-vehicle-data]: the vehicle file has no `static_wheel_load` (Static vertical wheel force)",
                "vehicle.yaml:1:1",
                "help: did you mean `static_wheelload`?",
            ],
        ),
        (
            "vehicle datum ill-formed",
            |campaign| {
                replace(
                    &campaign.join("vehicle.yaml"),
                    "static_wheel_load: 50",
                    "static_wheel_load: '50,5'",
                )
            },
            &[
                "error[vehicle-data]: `static_wheel_load`: `50,5` has a decimal comma",
                "vehicle.yaml:5:21",
            ],
        ),
        (
            "vehicle word unknown",
            |campaign| replace(&campaign.join("vehicle.yaml"), "passenger", "pasenger"),
            &[
                "error[vehicle-data]: `category`: `pasenger` is not one of passenger, locomotive, freight; did you mean `passenger`?",
                "vehicle.yaml:2:11",
            ],
        ),
        (
            "no section table",
            |campaign| fs::remove_file(campaign.join("sections.csv")).expect("removed"),
            &["error[file-missing]", "campaign.yaml:3:11"],
        ),
        (
            "no sections named",
            |campaign| replace(&campaign.join("campaign.yaml"), "sections: sections.csv\n", ""),
            &["error[no-sections]", "campaign.yaml:1:1"],
        ),
        (
            "section column missing",
            |campaign| {
                replace(&campaign.join("sections.csv"), "cant deficiency [mm]", "deficiency [mm]")
            },
            &[
                "error[missing-column]: the table of sections has no column `cant deficiency`",
                "sections.csv:1:1",
                "did you mean `deficiency`?",
            ],
        ),
        (
            "section column in a wrong unit",
            |campaign| replace(&campaign.join("sections.csv"), "speed [km/h]", "speed [kN]"),
            &[
                "error[unit-mismatch]: the column `speed` is in kN, which is a force; a speed is needed",
                "sections.csv:1:95",
            ],
        ),
        (
            "duplicate section",
            |campaign| cell(&campaign.join("sections.csv"), 2, "section", "S01"),
            &[
                "error[duplicate-name]: two rows are called `S01`",
                "sections.csv:3:1",
                "the first of them",
            ],
        ),
        (
            "empty section table",
            |campaign| fs::write(campaign.join("sections.csv"), "").expect("written"),
            &["error[file-empty]", "campaign.yaml:3:11"],
        ),
        (
            "sections with semicolons",
            |campaign| replace(&campaign.join("sections.csv"), ",", ";"),
            &["error[semicolon-separated]", "sections.csv:1:8"],
        ),
        (
            "campaign in UTF-16",
            |campaign| {
                bytes(&campaign.join("campaign.yaml"), |text| {
                    [0xff, 0xfe]
                        .into_iter()
                        .chain(text.into_iter().flat_map(|byte| [byte, 0]))
                        .collect()
                })
            },
            &["error[encoding]", "UTF-16 text, not UTF-8"],
        ),
        (
            "sections in Latin-1",
            |campaign| {
                bytes(&campaign.join("sections.csv"), |text| {
                    [&text[..], b"K\xf6ln,1,1,2,,straight,0,0,100\n"].concat()
                })
            },
            &["error[encoding]", "sections.csv:14:2", "`ö` if the file is Windows-1252"],
        ),
        (
            "records above",
            |campaign| {
                replace(
                    &campaign.join("campaign.yaml"),
                    "measurement: measurement",
                    "measurement: ../measurement",
                )
            },
            &[
                "error[path-outside]: `../measurement` leads out of the campaign's folder",
                "campaign.yaml:4:14",
            ],
        ),
        (
            "absolute path",
            |campaign| {
                replace(
                    &campaign.join("campaign.yaml"),
                    "vehicle: vehicle.yaml",
                    "vehicle: /etc/hostname",
                )
            },
            &["error[path-outside]: `/etc/hostname` is an absolute path", "campaign.yaml:2:10"],
        ),
        (
            "section above",
            |campaign| cell(&campaign.join("sections.csv"), 1, "section", "../S01"),
            &["error[path-outside]: `../S01` is used as a file name", "sections.csv:2:1"],
        ),
        (
            "protocol above",
            |campaign| {
                replace(
                    &campaign.join("campaign.yaml"),
                    "name: Tiny",
                    "name: Tiny\nprotocol: ../p.fp",
                )
            },
            &[
                "error[path-outside]: `../p.fp` leads out of the campaign's folder",
                "campaign.yaml:2:11",
            ],
        ),
        (
            "protocol that extends one above",
            |campaign| {
                replace(
                    &campaign.join("campaign.yaml"),
                    "name: Tiny",
                    "name: Tiny\nprotocol: rules/p.fp",
                );
                fs::create_dir(campaign.join("rules")).expect("made");
                fs::write(campaign.join("rules/p.fp"), "protocol p \"P\"\n  extends  ../../q.fp\n")
                    .expect("written");
            },
            &[
                "error[path-outside]: `rules/../../q.fp` leads out of the campaign's folder",
                "rules/p.fp:2:12",
            ],
        ),
        (
            "protocol misspelt",
            |campaign| {
                replace(
                    &campaign.join("campaign.yaml"),
                    "name: Tiny",
                    "name: Tiny\nprotocol: en14363-2016-anex-t",
                )
            },
            &["error[file-missing]", "campaign.yaml:2:11", "did you mean `en14363-2016-annex-t`?"],
        ),
        (
            "unknown parameter",
            |campaign| {
                replace(
                    &campaign.join("campaign.yaml"),
                    "name: Tiny",
                    "name: Tiny\nparameters:\n  lowpass_freqency: 20 Hz",
                )
            },
            &[
                "error[unknown-parameter]: protocol `en14363-2016-annex-t` has no parameter `lowpass_freqency`",
                "campaign.yaml:3:21",
                "did you mean `lowpass_frequency`?",
            ],
        ),
        (
            "parameter of a wrong unit",
            |campaign| {
                replace(
                    &campaign.join("campaign.yaml"),
                    "name: Tiny",
                    "name: Tiny\nparameters:\n  lowpass_frequency: 20 kN",
                )
            },
            &[
                "error[unit-mismatch]: parameter `lowpass_frequency` is a frequency, the given value is a force",
                "campaign.yaml:3:22",
            ],
        ),
        (
            "no folder of records",
            |campaign| fs::remove_dir_all(campaign.join("measurement")).expect("removed"),
            &[
                "error[folder-missing]: there is no folder `measurement`; the same 11 times more",
                "campaign.yaml:4:14",
                "error[no-usable-section]",
            ],
        ),
        (
            "channel missing everywhere",
            |campaign| {
                for path in records(campaign) {
                    replace(&path, "ay_I", "ayy_I");
                }
            },
            &[
                "error[unknown-channel]: `simulation/S01.csv` has no columns `ay_I`, `ay_II`; the same 11 times more",
                " --> simulation/S01.csv:1:1",
                "`measurement/S01.csv` has no columns `ay_I`, `ay_II`; the same 11 times more",
            ],
        ),
        (
            "all in a wrong unit",
            |campaign| {
                for path in records(campaign) {
                    replace(&path, "Y_1R [kN]", "Y_1R [m]");
                }
            },
            &[
                "error[unit-mismatch]: the column `Y_1R` is in m, which is a length; a force is needed; the same 23 times more",
                "--> simulation/S01.csv:1:29",
            ],
        ),
    ];
    for (case, change, parts) in cases {
        let found = with(change);
        assert_eq!(found.ran.code, 2, "{case}: {}{}", found.ran.stdout, found.ran.stderr);
        for part in *parts {
            assert!(
                found.ran.stderr.contains(part),
                "{case}: no `{part}` in\n{}",
                found.ran.stderr
            );
        }
        assert_eq!(found.ran.stdout, "", "{case}");
    }
}

#[test]
#[cfg(unix)]
fn a_link_out_of_the_campaign_is_refused() {
    let outside = tiny();
    let found = with(|campaign| {
        fs::remove_file(campaign.join("measurement/S01.csv")).expect("removed");
        std::os::unix::fs::symlink(
            outside.path().join("measurement/S01.csv"),
            campaign.join("measurement/S01.csv"),
        )
        .expect("linked");
    });
    assert_eq!(found.ran.code, 1);
    let reason = "`measurement/S01.csv` is a symbolic link out of the campaign's folder (sections.csv, row 2): paths must be relative to the campaign's folder and stay inside it";
    assert_eq!(found.reason("S01").as_deref(), Some(reason));
}

/// Records of 20 samples: enough for a median, too few for the ends of a zero-phase band-pass.
#[test]
fn a_record_too_short_for_the_filter() {
    let folder = tiny();
    let protocol = folder.path().join("short.fp");
    let text = "protocol short \"Short\"\n  axis  distance in m\n  time  time in s\n\nchannel ay\n  in  m/s^2\n  column  \"ay_I\"\n\n\
        filter BP\n  step  band-pass 0.4 Hz to 10 Hz, order 4\n\n\
        quantity ay_rms \"Rms\"\n  of  ay\n  filter  BP\n  value  rms\n  difference  signed\n  limit  std 1 m/s^2\n";
    fs::write(&protocol, text).expect("written");
    lines(&folder.path().join("sections.csv"), |lines| lines.truncate(3));
    cell(&folder.path().join("sections.csv"), 1, "start [m]", "2");
    cell(&folder.path().join("sections.csv"), 1, "end [m]", "6");
    lines(&folder.path().join("measurement/S01.csv"), |lines| lines.truncate(21));
    let found = certify(
        folder.path(),
        &["--protocol", protocol.to_str().expect("UTF-8"), "--only", "results"],
    );
    assert_eq!(found.ran.code, 1, "{}", found.ran.stderr);
    let reason = "the signal has 20 samples, the filter needs 28";
    // The section serves other quantities.
    assert_eq!(found.reason("S01"), None);
    let reasons = found.results()["reasons"].to_string();
    assert!(
        reasons.contains("ay_rms: it cannot be evaluated in section S01")
            && reasons.contains(reason),
        "{reasons}"
    );
}

/// A metric whose denominator is zero in one section: its quantity is not assessable, the section
/// serves the others.
#[test]
fn a_metric_without_a_value_affects_its_quantity_only() {
    let folder = tiny();
    let record = folder.path().join("measurement/S01.csv");
    lines(&record, |lines| {
        let at = lines[0]
            .split(',')
            .position(|heading| heading.starts_with("ay_I "))
            .expect("the channel");
        for line in &mut lines[1..] {
            *line = line
                .split(',')
                .enumerate()
                .map(|(column, cell)| if column == at { "0" } else { cell })
                .collect::<Vec<_>>()
                .join(",");
        }
    });
    let protocol = folder.path().join("metrics.fp");
    let quantity = |name: &str, of: &str, metric: &str| {
        format!("quantity {name}\n  of  {of}\n  metric  {metric}\n  limit  mean 10\n\n")
    };
    let text = format!(
        "protocol metrics \"Metrics\"\n  axis  distance in m\n  time  time in s\n\nchannel ay\n  in  m/s^2\n  column  \"ay_I\"\n\n\
        channel Y\n  in  kN\n  column  \"Y_1R\"\n\n{}{}{}",
        quantity("ay_magnitude", "ay", "sprague-geers magnitude"),
        quantity("ay_share", "ay", "rms of (simulated - measured) / measured(rms)"),
        quantity("Y_magnitude", "Y", "sprague-geers magnitude"),
    );
    fs::write(&protocol, text).expect("written");
    let found = certify(
        folder.path(),
        &["--protocol", protocol.to_str().expect("UTF-8"), "--only", "results"],
    );
    assert_eq!(found.reason("S01"), None, "{}", found.ran.stderr);
    let results = found.results();
    let quantity = |name: &str| {
        let all = results["quantities"].as_array().expect("a list");
        all.iter()
            .find(|quantity| quantity["id"] == name)
            .unwrap_or_else(|| panic!("no {name}"))
            .clone()
    };
    for name in ["ay_magnitude", "ay_share"] {
        let reason = quantity(name)["reason"].to_string();
        assert!(reason.contains("it cannot be evaluated in section S01"), "{name}: {reason}");
    }
    assert!(quantity("Y_magnitude")["reason"].is_null());
    let sections = results["sections"].as_array().map_or(0, Vec::len);
    assert_eq!(quantity("Y_magnitude")["values"].as_array().map(Vec::len), Some(sections));
}

/// A quantity that a record is sampled too slowly for is not assessable; its section serves the
/// others.
#[test]
fn a_record_sampled_too_slowly_for_a_filter() {
    let found = with(|campaign| thinned(&campaign.join("measurement/S01.csv"), 4));
    assert_eq!((found.ran.code, found.reason("S01")), (1, None));
    let reason = found.results()["quantities"][0]["reason"].to_string();
    assert!(
        reason.contains("20 Hz does not lie between 0 and half the sampling rate, 12.5 Hz"),
        "{reason}"
    );
}
