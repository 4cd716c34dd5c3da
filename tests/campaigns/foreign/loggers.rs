//! Files as data loggers write them: read to the numbers that an independent library reads, or
//! refused with the reason. The files are in `tests/cases/foreign`.

use std::path::{Path, PathBuf};

use fishplate::foreign::{Channel, File, Options, read};
use fishplate::problem::Problems;

const CASES: &str = "tests/cases/foreign";

pub fn case(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(CASES).join(name)
}

#[track_caller]
pub fn good(name: &str) -> File {
    read(&case(name), name, &Options::default())
        .unwrap_or_else(|problems| panic!("{}", Problems(problems).render(false)))
}

#[track_caller]
pub fn channel<'a>(file: &'a File, name: &str) -> &'a Channel {
    let mut channels = file.tables.iter().flat_map(|table| &table.channels);
    channels.find(|channel| channel.name == name).expect("the channel")
}

/// An object that a kept list of objects has without data (npTDMS 1.13: the numbers).
#[test]
fn an_object_without_data_in_a_segment_takes_none() {
    let file = good("tdms-no-data-in-kept-list.tdms");
    assert_eq!(channel(&file, "ch1").values, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(channel(&file, "ch2").values, [11.0, 12.0, 13.0, 14.0, 15.0, 16.0]);
}

/// The last of two scales takes the raw values, `10 raw - 3` (npTDMS 1.13: the numbers).
#[test]
fn a_scale_takes_the_raw_values_where_it_says_so() {
    let file = good("tdms-scale-of-raw.tdms");
    let values = &channel(&file, "c").values;
    assert_eq!((values.len(), values[0], values[1], values[49]), (50, -7403.0, -7033.0, 10_727.0));
}

/// Floats of 16 bits (asammdf 8.8: the numbers), the same signal as the floats of 32 bits beside
/// them to a half unit of the eleventh bit.
#[test]
fn floats_of_16_bits_are_read() {
    let file = good("mdf4-half-float.mf4");
    let (half, single) = (&channel(&file, "Y").values, &channel(&file, "Z").values);
    assert_eq!(half[..4], [0.0, 0.699_218_75, 1.395_507_812_5, 2.083_984_375]);
    assert_eq!((half.len(), half[59]), (60, -8.351_562_5));
    for (half, single) in half.iter().zip(single) {
        assert!((half - single).abs() <= single.abs() * 2f64.powi(-11), "{half} {single}");
    }
}

/// Whole numbers of 12 bits that begin at the second of 16 (h5py 3.16: the numbers).
#[test]
fn numbers_of_reduced_precision_are_read() {
    let file = good("hdf5-12-bit-integers.mat");
    let wanted: Vec<f64> = (-200..200).map(f64::from).collect();
    assert_eq!(channel(&file, "x").values, wanted);
}

/// Whole numbers of few bits, and floats of 16 bits; floats that are not those of IEEE 754 are left
/// out. Written and read back by h5py 3.16.
#[test]
fn types_of_hdf5_are_read_or_named() {
    let file = good("hdf5-types.mat");
    assert_eq!(channel(&file, "half").values, [1.0, -0.333_251_953_125, 65_504.0, 0.0]);
    assert_eq!(channel(&file, "nine_bits").values, [0.0, 511.0, 256.0, 7.0]);
    assert_eq!(channel(&file, "five_bits").values, [-16.0, 15.0, -1.0, 3.0]);
    let [(name, why)] = &file.tables[0].left_out[..] else { panic!("{file:?}") };
    assert!(name == "bfloat" && why.contains("a type that is not read"), "{name}: {why}");
}

/// A formula that is not read leaves out its channel alone (asammdf 8.8: the numbers of the other).
#[test]
fn an_unknown_formula_leaves_out_its_channel() {
    let file = good("mdf4-one-formula-blocks-all.mf4");
    let values = &channel(&file, "Z").values;
    assert_eq!(values.len(), 60);
    assert!((values[1] - 0.699_428_5).abs() < 1e-7 && (values[3] - 2.084_599).abs() < 1e-6);
    let [(name, why)] = &file.tables[0].left_out[..] else { panic!("{file:?}") };
    assert!(name == "Y" && why.contains("its conversion is not read"), "{name}: {why}");
}

/// The columns of a record: heading and values.
pub type Columns = Vec<(String, Vec<f64>)>;

/// Imports a mapping of files of the folder; the record of the only section.
#[track_caller]
pub fn imported(side: &str) -> Columns {
    let (problems, record) = tried(side);
    record.unwrap_or_else(|| panic!("{}", problems.render(false)))
}

fn tried(side: &str) -> (Problems, Option<Columns>) {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let text = format!("name: x\nsections: [S]\nmeasurement:\n{side}");
    let (problems, done) = crate::import::imported(&text, "m.yaml", Path::new(CASES), &out);
    let columns = || {
        let text = std::fs::read_to_string(out.join("measurement/S.csv")).expect("a record");
        let mut rows = text.lines().map(|line| line.split(','));
        let mut columns: Columns =
            rows.next().expect("names").map(|name| (name.to_string(), Vec::new())).collect();
        for row in rows {
            for ((_, values), cell) in columns.iter_mut().zip(row) {
                values.push(cell.parse().expect("a number"));
            }
        }
        columns
    };
    (problems, done.then(columns))
}

#[track_caller]
pub fn refused(side: &str, code: &str) -> String {
    let (problems, record) = tried(side);
    let text = problems.render(false);
    assert!(record.is_none() && problems.0[0].code == code, "{text}");
    text
}

/// Both channels are 5 m/s times the time since the first sample of the file.
#[track_caller]
fn on_one_clock(side: &str, (from, to): (f64, f64), rows: usize) {
    let columns = imported(side);
    let [(_, time), (_, sa), (_, sb)] = &columns[..] else { panic!("{columns:?}") };
    assert_eq!(time.len(), rows);
    assert!((time[0] - from).abs() < 1e-9 && (time[rows - 1] - to).abs() < 1e-9, "{time:?}");
    for ((time, sa), sb) in time.iter().zip(sa).zip(sb) {
        assert!(
            (sa - 5.0 * time).abs() < 1e-6 && (sb - 5.0 * time).abs() < 1e-6,
            "{time} {sa} {sb}"
        );
    }
}

#[test]
fn channels_that_start_at_different_times_are_on_one_clock() {
    // `wf_start_time`, 0.5 s apart in one group.
    let start = "  files: tdms-start-times.tdms\n  channels: {sa: sa, sb: sb}\n";
    on_one_clock(start, (0.5, 0.99), 50);
    // Channels of stamps in two groups, at 100 Hz and 10 Hz, 0.5 s apart.
    let stamps =
        "  files: tdms-stamps-two-groups.tdms\n  time: [ta, tb]\n  channels: {sa: sa, sb: sb}\n";
    on_one_clock(stamps, (0.5, 0.99), 50);
    // Two sheets with dates, at 100 Hz and 50 Hz, across midnight.
    let sheets = "  files: xlsx-two-starts.xlsx\n  time: [ta, tb]\n  channels: {sa: sa, sb: sb}\n";
    on_one_clock(sheets, (0.5, 1.48), 99);
}

#[test]
fn groups_of_different_rates_need_their_starts() {
    let side =
        |time: &str| format!("  files: tdms-rates.tdms\n{time}  channels: {{sa: sa, sb: sb}}\n");
    let text = refused(&side(""), "start-missing");
    assert!(text.contains("starts: {fast: 0 s, slow: 0 s}"), "{text}");
    refused(&side("  time: {rate: 100 Hz}\n"), "start-missing");
    on_one_clock(&side("  time: {starts: {fast: 0 s, slow: 0.1 s}}\n"), (0.1, 0.99), 90);
    refused(&side("  time: {starts: {fast: 0 s, slo: 0.1 s}}\n"), "unknown-table");
}

/// Two groups with the same start and increment: each by its own, with the rate stated or not.
#[test]
fn groups_with_the_same_start_are_one_record() {
    for time in ["", "  time: {rate: 200 Hz}\n"] {
        let columns = imported(&format!(
            "  files: tdms-groups.tdms\n{time}  distance: s\n  channels: {{Y: Y, ay: ay}}\n"
        ));
        let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["time [s]", "distance [m]", "Y [kN]", "ay [m/s^2]"]);
        // By npTDMS 1.13: the second samples, and the last of the distance.
        let at = |column: usize, row: usize| columns[column].1[row];
        assert_eq!((columns[0].1.len(), at(0, 1), at(1, 399)), (400, 0.005, 179.8));
        assert!((at(2, 1) - 0.031_410_76).abs() < 1e-8 && (at(3, 1) - 0.031_410_76).abs() < 1e-8);
    }
}

/// kN in the name and N beside it, or in two places of a MATLAB file: refused in every format, and
/// read where the mapping says which.
#[test]
fn two_units_of_a_channel_are_a_question() {
    for (file, time, name) in [
        ("two-units.csv", "t", "Y"),
        ("two-units.xlsx", "t", "Y"),
        ("two-units.tdms", "t", "Y [kN]"),
        ("two-units.mf4", "time", "Y (kN)"),
        ("two-units.mat", "t", "Y"),
        ("two-units.arrow", "t", "Y [kN]"),
        ("two-units.parquet", "t", "Y [kN]"),
    ] {
        let side = |more: &str| {
            format!(
                "  files: {file}\n  time: {time}\n  channels: {{Y: {{from: \"{name}\"{more}}}}}\n"
            )
        };
        let text = refused(&side(""), "unit-conflict");
        assert!(text.contains(&format!("two units of `{name}`: N and kN")), "{file}: {text}");
        let columns = imported(&side(", unit: kN"));
        assert_eq!((columns[1].0.as_str(), columns[1].1[3]), ("Y [kN]", 3.0), "{file}");
    }
    refused("  files: two-times.csv\n  time: t\n  channels: {Y: Y}\n", "unit-conflict");
}

/// An index in brackets is a part of the name, as programs for Modelica and FMI write it.
#[test]
fn an_index_is_a_part_of_the_name() {
    let columns = imported(
        "  files: index-in-name.csv\n  time: {from: time, unit: s}\n  channels: {x: {from: \"r[2]\", unit: m}}\n",
    );
    assert_eq!(columns[1].1[..4], [0.0, -0.1, -0.2, -0.3]);
}

/// 990, 997, 1.004: decimal marks or marks of thousands. A mark that is stated decides.
#[test]
fn marks_of_thousands_are_a_question() {
    let whole = |format: &str| {
        format!(
            "  files: thousands-whole-numbers.csv\n{format}  time: {{from: t, unit: ms}}\n  channels: {{Q: {{from: Q, unit: N}}}}\n"
        )
    };
    let text = refused(&whole(""), "thousands");
    assert!(text.contains("`Q`: `1.004` may have a decimal mark"), "{text}");
    assert_eq!(
        imported(&whole("  format: {decimal: comma}\n"))[1].1[..4],
        [990.0, 997.0, 1004.0, 1011.0]
    );
    assert_eq!(
        imported(&whole("  format: {decimal: point}\n"))[1].1[..4],
        [990.0, 997.0, 1.004, 1.011]
    );
    // Another column has decimal commas.
    let beside =
        |format: &str| whole(format).replace("thousands-whole-numbers", "thousands-beside-comma");
    let text = refused(&beside(""), "thousands");
    assert!(text.contains("`1.990` has marks between its thousands"), "{text}");
    let columns = imported(
        &beside("  format: {decimal: comma}\n").replace("{Q: ", "{v: {from: v, unit: m/s}, Q: "),
    );
    assert_eq!((columns[1].1[1], columns[2].1[1]), (30.01, 1997.0));
    let forces = |format: &str| {
        format!(
            "  files: thousands-of-forces.csv\n{format}  time: {{rate: 200 Hz}}\n  distance: Weg\n  channels: {{Y: Y_1R, Q: Q_1R}}\n"
        )
    };
    refused(&forces(""), "thousands");
    let columns = imported(&forces("  format: {decimal: comma}\n"));
    assert_eq!((columns[1].1[0], columns[2].1[13], columns[3].1[0]), (100.0, 1047.0, 54_000.0));
}

/// 00:01 is a minute or a second.
#[test]
fn times_of_two_numbers_are_a_question() {
    let side = |format: &str| {
        format!(
            "  files: minutes-and-seconds.csv\n{format}  time: t\n  channels: {{Q: {{from: Q, unit: N}}}}\n"
        )
    };
    let text = refused(&side(""), "clock-form");
    assert!(text.contains("hours and minutes, or minutes and seconds"), "{text}");
    for (clock, times) in [("mm:ss", [0.0, 1.0, 2.0]), ("hh:mm", [0.0, 60.0, 120.0])] {
        assert_eq!(imported(&side(&format!("  format: {{clock: {clock}}}\n")))[0].1[..3], times);
    }
    // The same as texts in cells of Excel.
    let sheet = |format: &str| side(format).replace(".csv", ".xlsx");
    assert!(refused(&sheet(""), "no-channel").contains("minutes and seconds"));
    assert_eq!(imported(&sheet("  format: {clock: mm:ss}\n"))[0].1[..3], [0.0, 1.0, 2.0]);
}

/// Seconds since 1970 in steps of 5 ms keep their steps.
#[test]
fn seconds_since_1970_keep_their_digits() {
    let columns = imported(
        "  files: epoch-seconds.csv\n  time: {from: t, unit: s}\n  channels: {Q: {from: Q, unit: N}}\n",
    );
    let times = &columns[0].1;
    assert_eq!(times.len(), 400);
    for (row, time) in times.iter().enumerate() {
        let wanted = 1_893_456_000.0 + 0.005 * row as f64;
        assert!((time - wanted).abs() < 1e-6, "{row}: {time}");
    }
}

/// Five channels over two lines; the values are those of the file.
#[test]
fn rows_over_two_lines_are_told_and_read() {
    let side = |format: &str, q: &str| {
        format!(
            "  files: wrapped-rows.dat\n{format}  time: {{rate: 200 Hz}}\n  channels: {{Y: {{from: Y11, unit: kN}}, Q: {{from: {q}, unit: kN}}}}\n"
        )
    };
    let text = refused(&side("", "Q11"), "wrapped-rows");
    assert!(text.contains("wrapped-rows.dat:3:1") && text.contains("{lines per row: 2}"), "{text}");
    let columns = imported(&side("  format: {lines per row: 2}\n", "Q11"));
    assert_eq!((columns[1].1.len(), columns[2].1.len()), (20, 20));
    assert_eq!(
        (columns[1].1[..2].to_vec(), columns[2].1[..2].to_vec()),
        (vec![3.0, 3.079_98], vec![54.0, 54.034_99])
    );
    refused(&side("  format: {lines per row: 1}\n", "Q11"), "ragged-row");
}

#[test]
fn columns_of_fixed_width_may_touch() {
    let columns = imported(
        "  files: touching-columns.dat\n  time: {from: t, unit: s}\n  channels: {F: {from: F, unit: N}, G: {from: G, unit: N}}\n",
    );
    let at = |row: usize| [columns[0].1[row], columns[1].1[row], columns[2].1[row]];
    assert_eq!((at(0), at(3)), ([0.0, -1000.0, -2000.0], [0.03, -1003.0, -2003.0]));
}

/// Kilometre posts that jump by -119.8 m and by +386 m.
#[test]
fn jumps_of_the_distance_are_told() {
    for (file, after, step) in [("post-back", 12_020.2, -119.8), ("post-forward", 12_526.2, 386.2)]
    {
        let side = |distance: &str| {
            format!(
                "  files: {file}.csv\n  time: Zeit\n  distance: {distance}\n  channels: {{Y: Y11}}\n"
            )
        };
        let text = refused(&side("km"), "distance-jumps");
        assert!(text.contains(&format!("jumps at 1.005 s, from 12140 m to {after} m")), "{text}");
        let columns = imported(&side("{from: km, jumps: run on}"));
        let distance = &columns[1].1;
        assert!((distance[99] - 12_149.8).abs() < 1e-6, "{step}: {distance:?}");
        assert!(distance.windows(2).all(|pair| (pair[1] - pair[0] - 0.2).abs() < 1e-6));
    }
}
