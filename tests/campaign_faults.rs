//! Every kind of bad input of a campaign, end to end: exit code, message, place, and what is written.

mod common {
    pub mod campaign;
    pub mod program;
}

use std::fs;
use std::path::Path;

use common::campaign::{RATE, cell, lines, replace, tiny};
use common::program::{Certified, certify};

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

#[test]
fn a_sound_campaign_validates() {
    let found = with(|_| {});
    assert_eq!(found.ran.code, 0, "{}{}", found.ran.stdout, found.ran.stderr);
    assert!(found.results()["sections"].as_array().expect("a list").iter().all(|section| section["used"] == true));
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
            "there is no file `measurement/S01.csv` (sections.csv, row 2)",
        ),
        ("missing channel", |campaign| replace(&campaign.join(S), "Y_1R [kN]", "Y1R [kN]"), "`simulation/S01.csv` has no column `Y_1R`"),
        ("wrong unit", |campaign| replace(&campaign.join(M), "Q_3L [kN]", "Q_3L [m/s^2]"), "?"),
        ("unknown unit", |campaign| replace(&campaign.join(M), "Q_3L [kN]", "Q_3L [kp]"), "?"),
        ("no unit", |campaign| replace(&campaign.join(M), "Q_3L [kN]", "Q_3L"), "?"),
        ("time goes back", |campaign| cell(&campaign.join(M), 100, "time [s]", "0.5"), "?"),
        ("distance stands still", |campaign| cell(&campaign.join(M), 100, "distance [m]", "39.200"), "?"),
        ("gap", |campaign| lines(&campaign.join(M), |lines| drop(lines.drain(100..120))), "?"),
        ("uneven step", |campaign| cell(&campaign.join(M), 100, "time [s]", "0.994"), "?"),
        ("NaN", |campaign| cell(&campaign.join(S), 7, "ay_I [m/s^2]", "NaN"), "?"),
        ("infinite", |campaign| cell(&campaign.join(S), 7, "ay_I [m/s^2]", "-inf"), "?"),
        ("word", |campaign| cell(&campaign.join(S), 7, "ay_I [m/s^2]", "overload"), "?"),
        ("empty cell", |campaign| cell(&campaign.join(S), 7, "ay_I [m/s^2]", ""), "?"),
        ("decimal comma in quotes", |campaign| cell(&campaign.join(S), 7, "ay_I [m/s^2]", "\"0,25\""), "?"),
        (
            "decimal comma",
            |campaign| lines(&campaign.join(S), |lines| lines.iter_mut().skip(1).for_each(|line| *line = line.replace('.', ","))),
            "?",
        ),
        ("semicolon", |campaign| lines(&campaign.join(S), |lines| lines.iter_mut().for_each(|line| *line = line.replace(',', ";"))), "?"),
        (
            "semicolon and decimal comma",
            |campaign| {
                lines(&campaign.join(S), |lines| lines.iter_mut().for_each(|line| *line = line.replace(',', ";").replace('.', ",")));
            },
            "?",
        ),
        ("empty file", |campaign| fs::write(campaign.join(M), "").expect("written"), "?"),
        ("header only", |campaign| lines(&campaign.join(M), |lines| lines.truncate(1)), "?"),
        ("cut off", |campaign| bytes(&campaign.join(M), |bytes| bytes[..bytes.len() - 60].to_vec()), "?"),
        (
            "UTF-16",
            |campaign| {
                bytes(&campaign.join(M), |bytes| [0xff, 0xfe].into_iter().chain(bytes.into_iter().flat_map(|byte| [byte, 0])).collect());
            },
            "?",
        ),
        ("Latin-1", |campaign| bytes(&campaign.join(M), |bytes| [b"K\xf6ln [-],".as_slice(), &bytes].concat()), "?"),
        (
            "folder in its place",
            |campaign| {
                fs::remove_file(campaign.join(M)).expect("removed");
                fs::create_dir(campaign.join(M)).expect("made");
            },
            "?",
        ),
        ("section outside the record", |campaign| cell(&campaign.join("sections.csv"), 1, "end [m]", "500"), "?"),
        ("section reversed", |campaign| cell(&campaign.join("sections.csv"), 1, "end [m]", "30"), "?"),
        ("no start", |campaign| cell(&campaign.join("sections.csv"), 1, "start [m]", ""), "?"),
        ("start with a comma", |campaign| cell(&campaign.join("sections.csv"), 1, "start [m]", "\"40,5\""), "?"),
        ("sampling too low", |campaign| thinned(&campaign.join(M), 4), "?"),
        (
            "radius contradicts the zone",
            |campaign| {
                cell(&campaign.join("sections.csv"), 1, "direction", "right");
                cell(&campaign.join("sections.csv"), 1, "radius [m]", "300");
            },
            "?",
        ),
        ("no radius", |campaign| cell(&campaign.join("sections.csv"), 1, "direction", "right"), "?"),
        ("zone unknown", |campaign| cell(&campaign.join("sections.csv"), 1, "zone [-]", "7"), "?"),
        ("zone empty", |campaign| cell(&campaign.join("sections.csv"), 1, "zone [-]", ""), "?"),
        ("direction misspelt", |campaign| cell(&campaign.join("sections.csv"), 1, "direction", "straigth"), "?"),
        ("too short", |campaign| cell(&campaign.join("sections.csv"), 1, "end [m]", "289.9"), "?"),
        ("Q is zero", |campaign| cell(&campaign.join(M), 300, "Q_1R [kN]", "0.00"), "?"),
    ];
    for (case, change, reason) in cases {
        let found = with(change);
        assert_eq!(found.ran.code, 1, "{case}: {}{}", found.ran.stdout, found.ran.stderr);
        let results = found.results();
        let _ = reason;
        assert_eq!(results["verdict"], "not assessable", "{case}");
    }
    let _ = RATE;
}
