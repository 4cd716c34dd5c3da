//! How far several records of one side are from each other, for each zone and for all sections.

use indexmap::{IndexMap, IndexSet};

use crate::check::plan::Center;
use crate::metrics::statistics::{self, Divisor};
use crate::result::{ClassSpread, Furthest, OfRecord, PairValue, RecordName, Spread};

/// Ratio of two root mean squares up to which they count as equal, less 1: far above the rounding
/// of doubles, far below any difference that a table shows.
const EQUAL: f64 = 1e-9;

/// Section, signal, and which of the quantity's values.
type SpreadKey<'a> = (&'a str, &'a str, Option<&'a str>);

/// The spread of the records; `None` where no place has two of them.
pub fn spread(center: Center, values: &[PairValue]) -> Option<Spread> {
    let zones: IndexSet<&str> = values.iter().filter_map(|value| value.zone.as_deref()).collect();
    let mut classes: Vec<ClassSpread> =
        zones.into_iter().filter_map(|zone| class(Some(zone), values)).collect();
    classes.extend(class(None, values));
    (!classes.is_empty()).then(|| Spread { center: center.in_words().to_string(), classes })
}

/// Sections of one zone, or all.
fn class(zone: Option<&str>, values: &[PairValue]) -> Option<ClassSpread> {
    let values: Vec<&PairValue> =
        values.iter().filter(|value| zone.is_none() || value.zone.as_deref() == zone).collect();
    let mut records: IndexMap<Option<&RecordName>, Vec<&PairValue>> = IndexMap::new();
    let mut places: IndexMap<SpreadKey<'_>, Vec<f64>> = IndexMap::new();
    for value in values {
        records.entry(value.record.as_ref()).or_default().push(value);
        places
            .entry((&value.section, &value.signal, value.taken.as_deref()))
            .or_default()
            .push(value.difference);
    }
    let records =
        ranked(records.into_iter().filter_map(|(name, values)| of_record(name, &values)).collect());
    let means: Vec<f64> = records.iter().map(|record| record.mean).collect();
    let apart: Vec<(SpreadKey<'_>, f64, f64)> = places
        .into_iter()
        .filter_map(|(place, values)| Some((place, statistics::range(&values)?, std(&values)?)))
        .collect();
    let mean_of = |of: fn(&(SpreadKey<'_>, f64, f64)) -> f64| {
        statistics::mean(&apart.iter().map(of).collect::<Vec<_>>())
    };
    // The first of equal ones.
    let widest = apart.iter().rev().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(ClassSpread {
        zone: zone.map(str::to_string),
        places: apart.len(),
        range_of_means: statistics::range(&means)?,
        std_of_means: std(&means)?,
        mean_range: mean_of(|(_, range, _)| *range)?,
        mean_std: mean_of(|(_, _, std)| *std)?,
        widest: at(widest.0, widest.1),
        std_at_widest: widest.2,
        records,
    })
}

fn std(values: &[f64]) -> Option<f64> {
    statistics::standard_deviation(values, Divisor::Sample)
}

fn at((section, signal, taken): SpreadKey<'_>, value: f64) -> Furthest {
    let signal = taken.map_or_else(|| signal.to_string(), |taken| format!("{signal}, {taken}"));
    Furthest { value, section: section.to_string(), signal }
}

fn of_record(name: Option<&RecordName>, values: &[&PairValue]) -> Option<OfRecord> {
    let deviations: Vec<f64> = values.iter().map(|value| value.difference).collect();
    let largest =
        values.iter().rev().max_by(|a, b| a.difference.abs().total_cmp(&b.difference.abs()))?;
    Some(OfRecord {
        record: name.map(ToString::to_string).unwrap_or_default(),
        values: values.len(),
        mean: statistics::mean(&deviations)?,
        std: std(&deviations),
        rms: statistics::rms(&deviations)?,
        largest: at(
            (&largest.section, &largest.signal, largest.taken.as_deref()),
            largest.difference,
        ),
        rank: 1,
    })
}

/// With their ranks: one more than the number of records that are better.
fn ranked(mut records: Vec<OfRecord>) -> Vec<OfRecord> {
    let all: Vec<f64> = records.iter().map(|record| record.rms).collect();
    for record in &mut records {
        record.rank = 1 + all.iter().filter(|rms| **rms * (1.0 + EQUAL) < record.rms).count();
    }
    records
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(section: &str, zone: Option<&str>, record: &str, difference: f64) -> PairValue {
        PairValue {
            campaign: None,
            section: section.into(),
            zone: zone.map(str::to_string),
            signal: "Y_1R".into(),
            taken: None,
            record: Some(RecordName::Single(record.into())),
            simulated: Some(difference),
            measured: Some(0.0),
            difference,
            samples: 1,
            limit: None,
            ratio: None,
        }
    }

    /// Three codes in two sections; numbers by hand.
    fn three(zone: impl Fn(&str) -> Option<&'static str>) -> Vec<PairValue> {
        let all = [("S1", [1.0, -3.0, 2.0]), ("S2", [3.0, -5.0, 2.0])];
        let of = |(section, deviations): (&'static str, [f64; 3])| {
            let zone = zone(section);
            ["a", "b", "c"]
                .into_iter()
                .zip(deviations)
                .map(move |(record, deviation)| value(section, zone, record, deviation))
        };
        all.into_iter().flat_map(of).collect()
    }

    #[test]
    fn records_are_ranked_and_their_spread_is_that_of_one_place() {
        let found = spread(Center::Mean, &three(|_| None)).expect("a spread");
        assert_eq!((found.center.as_str(), found.classes.len()), ("mean", 1));
        let class = &found.classes[0];
        let of = |at: usize| {
            let one = &class.records[at];
            (
                one.record.as_str(),
                one.mean,
                one.largest.value,
                one.largest.section.as_str(),
                one.rank,
            )
        };
        // Root mean squares: 5^0.5, 17^0.5, 2.
        assert_eq!(
            [of(0), of(1), of(2)],
            [("a", 2.0, 3.0, "S2", 2), ("b", -4.0, -5.0, "S2", 3), ("c", 2.0, 2.0, "S1", 1)]
        );
        assert!((class.records[0].std.expect("two values") - 2_f64.sqrt()).abs() < 1e-12);
        assert_eq!((class.places, class.range_of_means, class.mean_range), (2, 6.0, 6.5));
        assert_eq!((class.widest.value, class.widest.section.as_str()), (8.0, "S2"));
        assert!(
            (class.std_of_means - 12_f64.sqrt()).abs() < 1e-12
                && (class.std_at_widest - 19_f64.sqrt()).abs() < 1e-12
        );
        assert!((class.mean_std - f64::midpoint(7_f64.sqrt(), 19_f64.sqrt())).abs() < 1e-12);
    }

    #[test]
    fn each_zone_has_its_own_and_all_sections_come_last() {
        let found =
            spread(Center::Median, &three(|section| Some(if section == "S1" { "2" } else { "3" })))
                .expect("a spread");
        let zones: Vec<Option<&str>> =
            found.classes.iter().map(|class| class.zone.as_deref()).collect();
        assert_eq!(zones, [Some("2"), Some("3"), None]);
        assert_eq!((found.classes[0].records[0].std, found.classes[0].mean_range), (None, 5.0));
    }

    /// Two codes are equally far from their mean, up to rounding.
    #[test]
    fn equal_records_have_the_same_rank() {
        let mean = f64::midpoint(0.1, 0.3);
        let both = [value("S1", None, "a", 0.1 - mean), value("S1", None, "b", 0.3 - mean)];
        let found = spread(Center::Mean, &both).expect("a spread");
        assert_eq!(found.classes[0].records.iter().map(|one| one.rank).collect::<Vec<_>>(), [1, 1]);
        assert_eq!(spread(Center::Mean, &both[..1]), None);
    }
}
