//! Checks of the samples of a record: constant sampling rate without gaps, increasing axis, section
//! inside the record.

use std::ops::Range;

use super::record::{Column, Record};
use crate::data::prelude::*;

/// A step of the clock longer than the median by this factor is a gap.
const GAP: f64 = 1.5;
/// Allowed deviation of a step, as a share of the median step, in addition to the rounding of the
/// time stamps.
const JITTER: f64 = 0.01;
/// A sampling rate within this share of an integer is set to the integer.
const WHOLE: f64 = 1e-3;
/// Maximum number of gaps reported individually.
const TOLD: usize = 5;

/// Sampling of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Samples per SI unit of the clock; Hz for a clock in seconds.
    pub sampling_rate: f64,
    /// Range of the samples with start <= axis <= end; all samples if no section is given.
    pub rows: Range<usize>,
    /// Length recorded before the first of these, in SI units of the clock.
    pub before: f64,
    /// Length recorded after the last of these, in SI units of the clock.
    pub after: f64,
}

/// The evaluated range of the axis, in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    pub start: f64,
    pub end: f64,
    /// Place where start and end are written.
    pub at: Option<Span>,
}

/// Checks the column `clock`, which must have constant steps, and the column `axis`, on which the
/// section is given; both may be the same.
///
/// The rate is (n - 1) / (last - first), rounded to an integer if it is within 0.1 % of one: time
/// stamps are often rounded.
///
/// # Errors
/// `unknown-channel` if the record was read without the column; `too-short`; `time-not-increasing`;
/// `gap`; `uneven-step`; `axis-not-increasing`; `section-reversed`; `outside-record`;
/// `section-empty`.
pub fn check_axis(
    record: &Record,
    clock: &str,
    axis: &str,
    section: Option<&Section>,
) -> Result<Axis, Vec<Problem>> {
    let column = |name: &str| {
        record.column(name).ok_or_else(|| {
            problem!("unknown-channel", "`{}` was read without its column `{name}`", record.shown)
        })
    };
    let (clock, axis) = (column(clock)?, column(axis)?);
    let mut problems = Vec::new();
    let sampling_rate = check_clock(record, clock, &mut problems);
    if axis.position != clock.position
        && let Some(row) = first_fall(&axis.values)
    {
        problems.push(not_increasing("axis-not-increasing", record, axis, row));
    }
    let Some(sampling_rate) = sampling_rate.filter(|_| problems.is_empty()) else {
        return Err(problems);
    };
    let rows = match section {
        Some(section) => check_section(record, axis, section)?,
        None => 0..record.rows,
    };
    let times = &clock.values;
    let (before, after) =
        (times[rows.start] - times[0], times[record.rows - 1] - times[rows.end - 1]);
    Ok(Axis { sampling_rate, rows, before, after })
}

/// The row after which the values do not increase.
fn first_fall(values: &[f64]) -> Option<usize> {
    values.windows(2).position(|pair| pair[1] <= pair[0])
}

fn not_increasing(code: &'static str, record: &Record, column: &Column, row: usize) -> Problem {
    let [from, to] = [row, row + 1].map(|row| number(column, column.values[row]));
    let does = if from == to {
        format!("stays at {from}")
    } else {
        format!("goes back from {from} to {to}")
    };
    let (name, shown, at) = (&column.name, &record.shown, record.row_shown(row + 1));
    let says = format!("`{name}` {does} at row {at} of `{shown}`; it must increase");
    at_row(code, says, record, row + 1, column)
}

/// The sampling rate, if the steps are constant.
fn check_clock(record: &Record, clock: &Column, problems: &mut Vec<Problem>) -> Option<f64> {
    let (times, name, shown) = (&clock.values, &clock.name, &record.shown);
    if times.is_empty() {
        return None;
    }
    if times.len() < 3 {
        let samples = times.len();
        problems.push(problem!(
            "too-short",
            "`{shown}` has {samples} samples; a sampling rate cannot be determined"
        ));
        return None;
    }
    if let Some(row) = first_fall(times) {
        problems.push(not_increasing("time-not-increasing", record, clock, row));
        return None;
    }
    let Steps { usual, rate, gaps, uneven } = steps(times, clock.unit.factor);
    let step = |row: usize| times[row + 1] - times[row];
    for &row in gaps.iter().take(TOLD) {
        let says = format!(
            "`{name}` has a gap of {} between rows {} and {} of `{shown}`, {:.0} sampling steps",
            number(clock, step(row)),
            record.row_shown(row),
            record.row_shown(row + 1),
            step(row) / usual
        );
        problems.push(at_row("gap", says, record, row + 1, clock));
    }
    if gaps.len() > TOLD {
        problems.push(problem!(
            "more-problems",
            "and {} more gaps in `{shown}`",
            gaps.len() - TOLD
        ));
    }
    if !gaps.is_empty() {
        return None;
    }
    if let Some(row) = uneven {
        let says = format!(
            "the step of `{name}` is {} at row {} of `{shown}`, {} on average",
            number(clock, step(row)),
            record.row_shown(row + 1),
            number(clock, 1.0 / rate)
        );
        let problem = at_row("uneven-step", says, record, row + 1, clock);
        problems.push(problem.help("records must have a constant sampling rate"));
        return None;
    }
    Some(whole(rate))
}

/// The steps of a clock.
#[derive(Clone, Debug, PartialEq)]
pub struct Steps {
    /// The median.
    pub usual: f64,
    /// (n - 1) / (last - first): the inverse of the mean.
    pub rate: f64,
    /// The rows after which time has a gap.
    pub gaps: Vec<usize>,
    /// The row after which the first step differs from the mean by more than a record may have.
    pub uneven: Option<usize>,
}

/// Looks at the steps of times, two at least, that increase. `factor`: the unit in which they are
/// written, in SI units; times are often rounded in it.
pub fn steps(times: &[f64], factor: f64) -> Steps {
    let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let resolution = resolution(times, factor);
    // The median is the usual step even with gaps. Rounded stamps change many steps by the
    // resolution; if only few steps differ, rounding is not the reason.
    let usual = median(&steps);
    let unusual = steps.iter().filter(|step| (*step - usual).abs() > 1e-6 * usual).count();
    let rounding = if unusual * 100 < steps.len() { 0.0 } else { resolution };
    let longest = (GAP * usual).max(usual + 1.5 * rounding);
    let gaps = (0..steps.len()).filter(|row| steps[*row] > longest).collect();
    let rate = steps.len() as f64 / (times[steps.len()] - times[0]);
    let mean = 1.0 / rate;
    let allowed = (JITTER * mean).max(resolution * (1.0 + 1e-6));
    let uneven = steps.iter().position(|step| (step - mean).abs() > allowed);
    Steps { usual, rate, gaps, uneven }
}

/// A sampling rate, as a whole number if it is close to one: time stamps are often rounded.
pub fn whole(rate: f64) -> f64 {
    if (rate - rate.round()).abs() < WHOLE * rate { rate.round() } else { rate }
}

/// The power of ten of which all time stamps of a file are multiples, in SI units: the resolution
/// of their rounding.
fn resolution(times: &[f64], factor: f64) -> f64 {
    const MOST_DECIMALS: i32 = 9;
    (0..=MOST_DECIMALS)
        .map(|decimals| 10f64.powi(decimals))
        .find(|scale| {
            // A stamp of 1000 s has an error of 1e-13 s, one part in 10^4 of the smallest
            // resolution tested.
            times.iter().all(|time| {
                let scaled = time / factor * scale;
                (scaled - scaled.round()).abs() < 1e-3
            })
        })
        .map_or(0.0, |scale| factor / scale)
}

/// The middle value, or the larger of the two.
pub fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The samples of the section.
///
/// # Errors
/// `section-reversed`, `outside-record`, `section-empty`.
pub fn check_section(
    record: &Record,
    axis: &Column,
    section: &Section,
) -> Result<Range<usize>, Problem> {
    let fault = |code, says: String| match &section.at {
        Some(span) => error(code, says, span),
        None => Problem::error(code, says),
    };
    let (start, end) = (number(axis, section.start), number(axis, section.end));
    if section.start >= section.end {
        let says = format!("the section ends at {end}, not after its start at {start}");
        return Err(fault("section-reversed", says));
    }
    let (values, shown) = (&axis.values, &record.shown);
    let (first, last) = (values[0], values[values.len() - 1]);
    let mut missing = Vec::new();
    if section.start < first {
        missing.push(format!("{} at the start", number(axis, first - section.start)));
    }
    if section.end > last {
        missing.push(format!("{} at the end", number(axis, section.end - last)));
    }
    if !missing.is_empty() {
        let (name, first, last) = (&axis.name, number(axis, first), number(axis, last));
        let missing = missing.join(" and ");
        let says = format!(
            "the section from {start} to {end} is not inside `{shown}`, which has `{name}` from {first} to {last}: {missing} missing"
        );
        return Err(fault("outside-record", says));
    }
    let rows = values.partition_point(|value| *value < section.start)
        ..values.partition_point(|value| *value <= section.end);
    if rows.is_empty() {
        let says = format!("no sample of `{shown}` lies between {start} and {end}");
        return Err(fault("section-empty", says));
    }
    Ok(rows)
}

/// A value in the unit of the file, without insignificant decimals.
fn number(column: &Column, value: f64) -> String {
    let text = format!("{:.6}", column.unit.from_si(value));
    format!("{}{}", text.trim_end_matches('0').trim_end_matches('.'), column.unit.suffix())
}

fn at_row(
    code: &'static str,
    says: String,
    record: &Record,
    row: usize,
    column: &Column,
) -> Problem {
    Problem { at: record.place(row, Some(column)), ..Problem::error(code, says) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::record::{Wanted, read_record};
    use crate::units::Dimension;

    fn record(rows: impl IntoIterator<Item = (String, f64)>) -> (Record, std::path::PathBuf) {
        let file = tempfile::NamedTempFile::new().expect("a temporary file");
        let text: String =
            rows.into_iter().map(|(time, distance)| format!("{time},{distance}\n")).collect();
        std::fs::write(file.path(), format!("time [s],distance [m]\n{text}")).expect("writable");
        let wanted =
            [Wanted::new("time", Dimension::TIME), Wanted::new("distance", Dimension::LENGTH)];
        let record = read_record(file.path(), "r.csv", &wanted).expect("well formed");
        // The file is kept, since messages read the line again.
        let (_, path) = file.keep().expect("kept");
        (record, path)
    }

    fn even(n: u32, rate: f64, decimals: usize) -> Vec<(String, f64)> {
        (0..n)
            .map(|k| (format!("{:.decimals$}", f64::from(k) / rate), 10.0 + f64::from(k) * 0.2))
            .collect()
    }

    fn check(
        rows: Vec<(String, f64)>,
        section: Option<(f64, f64)>,
    ) -> Result<Axis, Vec<(&'static str, String)>> {
        let (record, path) = record(rows);
        let section = section.map(|(start, end)| Section { start, end, at: None });
        let checked = check_axis(&record, "time", "distance", section.as_ref());
        std::fs::remove_file(path).expect("removable");
        checked.map_err(|problems| {
            problems.into_iter().map(|problem| (problem.code, problem.says)).collect()
        })
    }

    #[test]
    fn rates_survive_rounded_time_stamps() {
        // n samples at a known rate, printed with few decimals.
        for (rate, decimals) in
            [(200.0, 3), (300.0, 3), (400.0, 3), (256.0, 3), (1000.0, 3), (333.0, 4), (2048.0, 6)]
        {
            let axis = check(even(2000, rate, decimals), None)
                .unwrap_or_else(|faults| panic!("{rate}: {faults:?}"));
            assert_eq!((axis.sampling_rate, axis.rows), (rate, 0..2000), "{rate}");
        }
        let axis = check(even(2000, 33.4, 6), None).expect("even");
        assert!((axis.sampling_rate - 33.4).abs() < 1e-4);
    }

    #[test]
    fn margins_and_rows_of_a_section() {
        // Samples 0.2 m and 5 ms apart from 10 m: 30 m is sample 100, 50 m sample 200.
        let axis = check(even(401, 200.0, 3), Some((30.0 - 1e-9, 50.0 + 1e-9))).expect("inside");
        assert_eq!(axis.rows, 100..201);
        assert!((axis.before - 0.5).abs() < 1e-9 && (axis.after - 1.0).abs() < 1e-9);
    }

    #[test]
    fn faults_of_the_clock_name_their_row() {
        let mut gap = even(400, 200.0, 3);
        gap.drain(100..120);
        let faults = check(gap, None).expect_err("a gap");
        assert_eq!(faults, [("gap", "`time` has a gap of 0.105 s between rows 101 and 102 of `r.csv`, 21 sampling steps".to_string())]);

        let mut one = even(400, 1000.0, 3);
        one.remove(100);
        assert_eq!(check(one, None).expect_err("one sample")[0].0, "gap");

        let mut back = even(100, 200.0, 3);
        back[50].0 = back[48].0.clone();
        assert_eq!(
            check(back, None).expect_err("goes back")[0],
            (
                "time-not-increasing",
                "`time` goes back from 0.245 s to 0.24 s at row 52 of `r.csv`; it must increase"
                    .to_string()
            )
        );

        let mut twice = even(100, 200.0, 3);
        twice[50].1 = twice[49].1;
        assert_eq!(check(twice, None).expect_err("stands")[0].0, "axis-not-increasing");

        let mut uneven = even(100, 200.0, 6);
        uneven[50].0 = "0.251300".into();
        assert_eq!(check(uneven, None).expect_err("uneven")[0].0, "uneven-step");
        assert_eq!(check(even(2, 200.0, 3), None).expect_err("short")[0].0, "too-short");
    }

    #[test]
    fn faults_of_the_section_say_by_how_much() {
        let faults =
            |start, end| check(even(401, 200.0, 3), Some((start, end))).expect_err("outside");
        assert_eq!(
            faults(5.0, 95.5),
            [("outside-record", "the section from 5 m to 95.5 m is not inside `r.csv`, which has `distance` from 10 m to 90 m: 5 m at the start and 5.5 m at the end missing".to_string())]
        );
        assert_eq!(faults(30.0, 30.0)[0].0, "section-reversed");
        assert_eq!(faults(30.05, 30.15)[0].0, "section-empty");
    }
}
