//! Time stamps: dates, clock times, both.

use super::super::{NANOSECONDS, Options};
use crate::yaml::Words;

/// Order of day, month and year in a date of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DateOrder {
    DayMonthYear,
    MonthDayYear,
    YearMonthDay,
}

impl Words for DateOrder {
    const WORDS: &'static [(&'static str, Self)] =
        &[("dmy", Self::DayMonthYear), ("mdy", Self::MonthDayYear), ("ymd", Self::YearMonthDay)];
}

/// What a time of two numbers is, such as 12:01.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClockForm {
    HoursMinutes,
    MinutesSeconds,
}

impl Words for ClockForm {
    const WORDS: &'static [(&'static str, Self)] =
        &[("hh:mm", Self::HoursMinutes), ("mm:ss", Self::MinutesSeconds)];
}

/// Why stamps cannot be read with certainty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unclear {
    /// Day or month may be first.
    Order,
    /// Two numbers are hours and minutes, or minutes and seconds.
    Clock,
}

/// A stamp as written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamp {
    pub date: Option<Date>,
    /// Time of the day in nanoseconds, less the offset from UTC if one is written.
    pub clock: Option<i64>,
    /// The clock has two numbers, of which nothing says that they are hours and minutes.
    pub two: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Date {
    parts: [i64; 3],
    mark: char,
    /// The year is written first.
    year_first: bool,
}

/// Longest text that is read as a stamp.
const LONGEST: usize = 40;
/// Years of measurements; also a bound for nanoseconds in 64 bits.
const YEARS: std::ops::RangeInclusive<i64> = 1900..=2200;
pub const DAY: i64 = 86_400 * NANOSECONDS;

/// Reads a trimmed cell.
pub fn read(text: &str) -> Option<Stamp> {
    if text.len() > LONGEST || !text.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    if let Some(date) = date(text) {
        return Some(Stamp { date: Some(date), clock: None, two: false });
    }
    if let Some((first, rest)) = text.split_once(['T', ' ', '_'])
        && let (Some(date), Some(clock)) = (date(first), clock(rest.trim_start()))
        && clock <= DAY
    {
        return Some(Stamp { date: Some(date), clock: Some(clock), two: false });
    }
    let two = text.bytes().filter(|byte| *byte == b':').count() == 1
        && text.bytes().all(|byte| byte.is_ascii_digit() || byte == b':');
    let clock = clock(text).filter(|clock| two || *clock <= DAY);
    clock.map(|clock| Stamp { date: None, clock: Some(clock), two })
}

fn date(text: &str) -> Option<Date> {
    let mark =
        text.chars().find(|c| !c.is_ascii_digit()).filter(|c| matches!(c, '-' | '/' | '.'))?;
    let mut parts = [0; 3];
    let mut words = text.split(mark);
    let mut year_first = false;
    for (at, part) in parts.iter_mut().enumerate() {
        let word = words.next()?;
        let is_year = word.len() == 4 && (at == 0 || at == 2 && !year_first);
        if !are_digits(word) || !(is_year || matches!(word.len(), 1 | 2)) {
            return None;
        }
        year_first |= at == 0 && is_year;
        // 13.05.24 could be a version or a channel; a year has four digits.
        if at == 2 && !year_first && !is_year {
            return None;
        }
        *part = word.parse().ok()?;
    }
    words.next().is_none().then_some(Date { parts, mark, year_first })
}

/// `12:01`, `12:01:02`, `12:01:02.345`, `12:01:02,345`, `1:01:02 PM`, `12:01:02Z`,
/// `12:01:02+02:00`.
fn clock(text: &str) -> Option<i64> {
    let lower = text.to_ascii_lowercase();
    let (text, half) = match (lower.strip_suffix("am"), lower.strip_suffix("pm")) {
        (Some(rest), _) => (rest.trim_end(), Some(0)),
        (_, Some(rest)) => (rest.trim_end(), Some(12)),
        _ => (lower.as_str(), None),
    };
    let (text, offset) = zone(text)?;
    let mut parts = text.split(':');
    let two = |word: &str| -> Option<i64> {
        if are_digits(word) && word.len() <= 2 { word.parse().ok() } else { None }
    };
    let hour = two(parts.next()?)?;
    let minute = two(parts.next()?)?;
    let third = parts.next();
    let two_numbers = third.is_none();
    let (second, fraction) = match third {
        None => (0, 0),
        Some(text) => match text.split_once(['.', ',']) {
            None => (two(text)?, 0),
            Some((whole, fraction)) => (two(whole)?, nanoseconds(fraction)?),
        },
    };
    // Of two numbers, the first may be minutes.
    let most = if two_numbers && half.is_none() { 59 } else { 24 };
    if parts.next().is_some() || hour > most || minute > 59 || second > 60 {
        return None;
    }
    let hour = match half {
        Some(half) if (1..=12).contains(&hour) => hour % 12 + half,
        Some(_) => return None,
        None => hour,
    };
    Some(((hour * 60 + minute) * 60 + second) * NANOSECONDS + fraction - offset)
}

fn are_digits(word: &str) -> bool {
    !word.is_empty() && word.bytes().all(|byte| byte.is_ascii_digit())
}

/// Splits off `Z` or an offset from UTC.
fn zone(text: &str) -> Option<(&str, i64)> {
    if let Some(rest) = text.strip_suffix('z') {
        return Some((rest, 0));
    }
    let Some(at) = text.rfind(['+', '-']) else { return Some((text, 0)) };
    let digits: String = text[at + 1..].chars().filter(|c| *c != ':').collect();
    let (hours, minutes) = match digits.len() {
        2 => (digits.as_str(), "0"),
        4 => digits.split_at_checked(2)?,
        _ => return None,
    };
    let offset =
        (hours.parse::<i64>().ok()? * 60 + minutes.parse::<i64>().ok()?) * 60 * NANOSECONDS;
    Some((text[..at].trim_end(), if text[at..].starts_with('-') { -offset } else { offset }))
}

fn nanoseconds(digits: &str) -> Option<i64> {
    let nine: String = digits.chars().chain(std::iter::repeat('0')).take(9).collect();
    if are_digits(digits) { nine.parse().ok() } else { None }
}

/// Makes the clocks of two numbers what is said of them.
///
/// # Errors
/// Nothing is said, and no other stamp of the column has a date or seconds.
pub fn settle(stamps: &mut [Option<Stamp>], options: &Options) -> Result<(), Unclear> {
    let all = || stamps.iter().flatten().filter(|stamp| stamp.date.is_none());
    // No day has more hours.
    let beyond = |stamp: &Stamp| stamp.two && stamp.clock.is_some_and(|clock| clock > DAY);
    let minutes = all().any(beyond).then_some(ClockForm::MinutesSeconds);
    match options.clock.or(minutes) {
        _ if !all().any(|stamp| stamp.two) => {}
        Some(ClockForm::MinutesSeconds) => {
            for stamp in stamps.iter_mut().flatten().filter(|stamp| stamp.two) {
                stamp.clock = stamp.clock.map(|clock| clock / 60);
            }
        }
        None if all().all(|stamp| stamp.two) => return Err(Unclear::Clock),
        _ => {}
    }
    Ok(())
}

/// The order of the dates of a column: said, or the only one that its dates allow.
///
/// # Errors
/// Both day and month could be first, and the dates differ.
pub fn order(dates: &[Date], options: &Options) -> Result<DateOrder, ()> {
    let Some(first) = dates.first() else { return Ok(DateOrder::YearMonthDay) };
    if dates.iter().all(|date| date.year_first) {
        return Ok(DateOrder::YearMonthDay);
    }
    if let Some(said) = options.dates {
        return Ok(said);
    }
    let may = |order: DateOrder| dates.iter().all(|date| days(date, order).is_some());
    // Points are German and French usage, with the day first.
    let day = may(DateOrder::DayMonthYear);
    match (day, may(DateOrder::MonthDayYear)) {
        (true, _) if first.mark == '.' => Ok(DateOrder::DayMonthYear),
        (true, true) if dates.iter().any(|date| date != first) => Err(()),
        (true, _) => Ok(DateOrder::DayMonthYear),
        (false, true) => Ok(DateOrder::MonthDayYear),
        (false, false) => Ok(DateOrder::DayMonthYear),
    }
}

/// Days since 1970-01-01; `None` if there is no such day.
pub fn days(date: &Date, order: DateOrder) -> Option<i64> {
    let [a, b, c] = date.parts;
    let (year, month, day) = match order {
        _ if date.year_first => (a, b, c),
        DateOrder::MonthDayYear => (c, a, b),
        DateOrder::DayMonthYear => (c, b, a),
        DateOrder::YearMonthDay => return None,
    };
    let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let length = match month {
        2 if leap => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        1..=12 => 31,
        _ => return None,
    };
    if !YEARS.contains(&year) || !(1..=length).contains(&day) {
        return None;
    }
    // Days before a month of a year that begins in March (Fliegel and Van Flandern 1968 use the
    // same device).
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let before = 365 * year + year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400);
    Some(before + (153 * month + 2) / 5 + day - 1 - 719_468)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(text: &str) -> Option<f64> {
        let stamp = read(text)?;
        let order = order(stamp.date.as_slice(), &Options::default()).ok()?;
        let days = stamp.date.map_or(Some(0), |date| days(&date, order))?;
        Some((days * DAY + stamp.clock.unwrap_or(0)) as f64 / NANOSECONDS as f64)
    }

    /// More than a day of hours can only be minutes; with a date they are no time.
    #[test]
    fn two_numbers_beyond_a_day_are_minutes() {
        let seconds = |texts: &[&str]| {
            let mut stamps: Vec<Option<Stamp>> = texts.iter().map(|text| read(text)).collect();
            settle(&mut stamps, &Options::default()).ok()?;
            let clock = |stamp: &Option<Stamp>| Some(stamp.as_ref()?.clock? / NANOSECONDS);
            stamps.iter().map(clock).collect::<Option<Vec<i64>>>()
        };
        assert_eq!(seconds(&["24:59", "25:00", "59:59"]), Some(vec![1499, 1500, 3599]));
        assert_eq!(seconds(&["00:01", "24:00"]), None);
        assert!(read("2026-01-01 25:00").is_none() && read("60:00").is_none());
        assert!(read("25:00:00").is_none());
    }

    #[test]
    fn stamps_of_all_kinds() {
        // Seconds since 1970 by `date -u -d ... +%s`.
        for (text, value) in [
            ("1970-01-01", 0.0),
            ("2024-05-13T12:01:02", 1_715_601_662.0),
            ("2024-05-13 12:01:02.25", 1_715_601_662.25),
            ("13.05.2024 12:01:02,25", 1_715_601_662.25),
            ("05/13/2024 12:01:02", 1_715_601_662.0),
            ("13/05/2024 12:01:02 PM", 1_715_601_662.0),
            ("2024-05-13T14:01:02+02:00", 1_715_601_662.0),
            ("2024-05-13T12:01:02Z", 1_715_601_662.0),
            ("2000-02-29", 951_782_400.0),
            ("12:01:02.005", 43_262.005),
            ("1:00", 3600.0),
        ] {
            // Nanoseconds since 1970 have more digits than a double; the reader subtracts before it
            // converts.
            assert!(seconds(text).is_some_and(|found| (found - value).abs() < 1e-6), "{text}");
        }
        for text in [
            "1.5",
            "13.05.24",
            "2024-02-30",
            "60:00",
            "12:60",
            "12:1:2:3",
            "a12:00",
            "1-2",
            "2024-05-13T",
            "12:00:00.x",
        ] {
            assert_eq!(seconds(text), None, "{text}");
        }
    }

    #[test]
    fn an_ambiguous_order_is_not_guessed() {
        let dates = |texts: &[&str]| -> Vec<Date> {
            texts.iter().filter_map(|text| read(text)?.date).collect()
        };
        let none = Options::default();
        assert_eq!(order(&dates(&["03/04/2024", "04/04/2024"]), &none), Err(()));
        assert_eq!(
            order(&dates(&["03/04/2024", "03/04/2024"]), &none),
            Ok(DateOrder::DayMonthYear)
        );
        assert_eq!(
            order(&dates(&["03/13/2024", "03/04/2024"]), &none),
            Ok(DateOrder::MonthDayYear)
        );
        let said = Options { dates: Some(DateOrder::MonthDayYear), ..Options::default() };
        assert_eq!(
            order(&dates(&["03/04/2024", "04/04/2024"]), &said),
            Ok(DateOrder::MonthDayYear)
        );
    }
}
