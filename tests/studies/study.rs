//! Studies of selections against independent sources: a reference program, every selection one by
//! one, closed forms.

use std::fs;
use std::path::PathBuf;

use crate::common::pools::{every, limit, quantity, sections, sorted, zones};
use fishplate::result::study::Spread;
use fishplate::result::{Direction, StatisticName, Verdict};
use fishplate::run::pool::{Pool, Rule, Section};
use fishplate::study::case::Case;
use fishplate::study::random::{Random, draw};
use fishplate::study::{Settings, enumerate, reduced, sampling, selections};
use proptest::prelude::*;

#[track_caller]
fn close(found: Option<Spread>, expected: Option<Spread>, what: &str) {
    match (found, expected) {
        (None, None) => {}
        (Some(a), Some(b)) => {
            let pairs =
                [(a.min, b.min), (a.q1, b.q1), (a.median, b.median), (a.q3, b.q3), (a.max, b.max)];
            // Where the values of a selection are all the same, sums leave a variance of some 1e-16
            // of their squares in place of 0, and its root is 1e-8 of the values, which are up to
            // 2.3 limits here; a quartile between such a value and the next takes part in it. Only
            // there is so much room.
            let room = if b.min.abs() < 1e-7 { 1e-7 } else { 1e-12 };
            let near = |(a, b): (f64, f64)| (a - b).abs() <= room * (1.0 + b.abs());
            assert!(pairs.into_iter().all(near), "{what}: {a:?} and {b:?}");
            assert_eq!(a.count, b.count, "{what}");
        }
        (a, b) => panic!("{what}: {a:?} and {b:?}"),
    }
}

/// Enumeration against every selection judged by itself.
fn agree(case: &Case) {
    let found = enumerate::all(case);
    let all = every(case);
    let judged: Vec<_> = all.iter().map(|selection| case.judge(selection)).collect();
    assert_eq!(found.share.looked_at as usize, all.len());
    let validated = judged.iter().filter(|(verdict, _)| *verdict == Verdict::Validated).count();
    assert_eq!(found.share.validated as usize, validated);
    let mut at = 0;
    for quantity in &found.quantities {
        for statistic in &quantity.statistics {
            let values: Vec<f64> =
                judged.iter().filter_map(|(_, all)| all[at].normalised).collect();
            close(statistic.spread, sorted(values), &format!("{} {}", quantity.id, statistic.name));
            let failing = judged
                .iter()
                .filter(|(_, all)| all[at].normalised.is_some() && !all[at].holds)
                .count();
            assert_eq!(
                (statistic.failing * all.len() as f64).round() as usize,
                failing,
                "{} {}",
                quantity.id,
                statistic.name
            );
            at += 1;
        }
    }
    for one in &found.sections {
        let section =
            case.sections.iter().position(|name| *name == one.section).expect("a section");
        let of = |wanted: bool| {
            let some: Vec<_> = all
                .iter()
                .zip(&judged)
                .filter(|(selection, _)| selection.contains(&section) == wanted)
                .collect();
            let good =
                some.iter().filter(|(_, (verdict, _))| *verdict == Verdict::Validated).count();
            (!some.is_empty()).then(|| good as f64 / some.len() as f64)
        };
        assert_eq!((one.with, one.without), (of(true), of(false)), "{}", one.section);
    }
}

fn peer(name: &str) -> (Case, serde_json::Value) {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/cases/combinations");
    let text = fs::read_to_string(folder.join(format!("{name}.csv"))).expect("differences");
    let expected = serde_json::from_str(
        &fs::read_to_string(folder.join(format!("{name}.json"))).expect("a result"),
    )
    .expect("JSON");
    let rows: Vec<Vec<&str>> = text.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let mut names: Vec<&str> = rows.iter().map(|row| row[0]).collect();
    names.dedup();
    names.sort_unstable();
    names.dedup();
    let zone =
        |section: &str| rows.iter().find(|row| row[0] == section).map(|row| row[1].to_string());
    let mut ids: Vec<&str> = Vec::new();
    rows.iter().for_each(|row| {
        if !ids.contains(&row[2]) {
            ids.push(row[2])
        }
    });
    let quantities = ids.iter().map(|id| {
        let of = |section: &str| {
            rows.iter()
                .filter(|row| row[0] == section && row[2] == *id)
                .map(|row| row[4].parse().expect("a number"))
                .collect()
        };
        let bound: f64 =
            rows.iter().find(|row| row[2] == *id).expect("a row")[5].parse().expect("a limit");
        let limits = vec![
            limit("std", bound, 1, names.len()),
            limit("mean", bound * 2.0 / 3.0, 1, names.len()),
        ];
        quantity(id, names.iter().map(|section| of(section)).collect(), limits)
    });
    let pool = Pool {
        sections: names
            .iter()
            .enumerate()
            .map(|(site, name)| Section {
                name: (*name).into(),
                zone: zone(name),
                site,
                used: true,
                reason: None,
            })
            .collect(),
        zones: zones(&[3, 3, 3, 3]),
        minimum: 12,
        quantities: quantities.collect(),
        rule: Some(Rule::EveryLimit),
    };
    (Case::of(&pool, None).expect("a case"), expected)
}

#[test]
fn the_reference_program_says_the_same() {
    for name in ["small", "medium"] {
        let (case, expected) = peer(name);
        let found = enumerate::all(&case);
        assert_eq!(Some(found.share.looked_at), expected["combinations"].as_u64());
        assert_eq!(Some(found.share.validated), expected["validated"].as_u64());
        for quantity in &found.quantities {
            for statistic in &quantity.statistics {
                let expected = &expected["quantities"][&quantity.id][statistic.name.to_string()];
                let spread = statistic.spread.expect("values");
                for (key, value) in [
                    ("min", spread.min),
                    ("q25", spread.q1),
                    ("q50", spread.median),
                    ("q75", spread.q3),
                    ("max", spread.max),
                ] {
                    let wanted = expected[key].as_f64().expect("a number");
                    assert!(
                        (value - wanted).abs() <= 1e-12,
                        "{name} {} {} {key}: {value} and {wanted}",
                        quantity.id,
                        statistic.name
                    );
                }
            }
        }
    }
}

const STATISTICS: [&str; 10] =
    ["mean", "std", "rms", "maximum", "minimum", "peak", "each", "p90", "median", "range"];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Unequal signals, missing values, ties, any number of zones, other statistics, both divisors.
    #[test]
    fn enumeration_is_every_selection_judged(
        shape in prop::collection::vec((1_usize..5, 0_usize..4), 1..5),
        seed in any::<u64>(),
        coarse in any::<bool>(),
        ddof in 0_usize..2,
        rule in 0_usize..3,
        minimum_pairs in 1_usize..9,
    ) {
        let counts: Vec<usize> = shape.iter().map(|(take, more)| take + more).collect();
        let takes: Vec<usize> = shape.iter().map(|(take, _)| *take).collect();
        let all: usize = counts.iter().sum();
        let mut random = Random::new(seed, 0);
        let mut value = || {
            let value = random.below(2001) as f64 / 1000.0 - 0.9;
            if coarse { (value * 2.0).round() } else { value }
        };
        let mut quantities = Vec::new();
        for (at, name) in STATISTICS.iter().enumerate() {
            let signals = 1 + at % 3;
            let values = (0..all).map(|section| (0..signals).filter(|signal| (section + signal + at) % 5 > 0).map(|_| value()).collect());
            let mut with_limits = quantity(name, values.collect(), vec![limit(name, 0.9, ddof, all)]);
            if at == 1 {
                with_limits.limits.push(limit("mean", 0.5, ddof, all));
                with_limits.limits[1].inside = (0..all).map(|section| section % 3 > 0).collect();
            }
            with_limits.minimum_pairs = minimum_pairs;
            quantities.push(with_limits);
        }
        quantities[2].limits[0].direction = Direction::AtLeast;
        quantities[4].limits[0].direction = Direction::AtLeast;
        quantities[6].limits[0].direction =
            if seed % 2 == 0 { Direction::AtLeast } else { Direction::AtMost };
        let rule = [Rule::EveryLimit, Rule::AtLeastQuantities(6), Rule::AtLeastLimits(7)][rule];
        let pool = Pool { sections: sections(&counts), zones: zones(&takes), minimum: 1, quantities, rule: Some(rule) };
        let case = Case::of(&pool, None).expect("a case");
        prop_assume!(case.combinations() <= 3000.0);
        agree(&case);
    }
}

#[test]
fn all_values_equal_are_one_value() {
    let values = vec![vec![0.3, 0.3]; 16];
    let pool = Pool {
        sections: sections(&[4, 4, 4, 4]),
        zones: zones(&[3, 3, 3, 3]),
        minimum: 12,
        quantities: vec![quantity(
            "q",
            values,
            vec![limit("mean", 0.3, 1, 16), limit("std", 1.0, 1, 16)],
        )],
        rule: Some(Rule::EveryLimit),
    };
    let found = enumerate::all(&Case::of(&pool, None).expect("a case"));
    // A value equal to its limit passes.
    assert_eq!((found.share.validated, found.share.looked_at), (256, 256));
    let mean = found.quantities[0].statistics[0].spread.expect("values");
    assert!(
        (mean.min - 1.0).abs() < 1e-12 && (mean.max - 1.0).abs() < 1e-12 && mean.outliers == 0,
        "{mean:?}"
    );
}

/// What sums cannot tell from zero is some 1e-8 of the values, here no more than 2e-8 of the limit.
#[test]
fn scatter_of_equal_values_is_zero_but_for_rounding() {
    let values = vec![vec![0.7], vec![-1.3], vec![0.1, 0.1], vec![2.9]];
    let pool = Pool {
        sections: sections(&[4]),
        zones: zones(&[1]),
        minimum: 1,
        quantities: vec![quantity("q", values, vec![limit("std", 0.9, 0, 4)])],
        rule: Some(Rule::EveryLimit),
    };
    let case = Case::of(&pool, None).expect("a case");
    let spread = enumerate::all(&case).quantities[0].statistics[0].spread.expect("values");
    assert!((0.0..2e-8).contains(&spread.min) && (0.0..2e-8).contains(&spread.max), "{spread:?}");
    agree(&case);
}

#[test]
fn what_is_drawn_agrees_with_what_is_counted() {
    let (case, _) = peer("medium");
    let exact = enumerate::all(&case);
    let drawn = sampling::some(&case, &Settings { most: 0.0, width: 0.01, seed: 3 });
    let (low, high) = drawn.share.interval.expect("an interval");
    assert!(
        high - low <= 0.01 && low <= exact.share.share && exact.share.share <= high,
        "{:?} {:?}",
        drawn.share,
        exact.share
    );
    for (drawn, exact) in drawn.quantities.iter().zip(&exact.quantities) {
        for (drawn, exact) in drawn.statistics.iter().zip(&exact.statistics) {
            let (a, b) = (drawn.spread.expect("values"), exact.spread.expect("values"));
            if drawn.name == StatisticName::Mean {
                // Exact, whatever was drawn.
                close(Some(a), Some(b), "mean");
                assert!(a.exact && a.outliers == b.outliers);
            } else {
                assert!(
                    !a.exact
                        && (a.median - b.median).abs() < 0.02
                        && a.min >= b.min - 1e-12
                        && a.max <= b.max + 1e-12
                );
            }
        }
    }
    let again = sampling::some(&case, &Settings { most: 0.0, width: 0.01, seed: 3 });
    assert_eq!(drawn.share, again.share);
}

#[test]
fn drawn_selections_take_what_they_should() {
    let (case, _) = peer("small");
    let mut random = Random::new(1, 1);
    for _ in 0..200 {
        let selection = draw(&case, &mut random);
        for stratum in &case.strata {
            assert_eq!(selection.iter().filter(|at| stratum.members.contains(at)).count(), 3);
        }
    }
}

#[test]
fn one_bad_section_is_the_one_to_remove() {
    let mut values = vec![vec![0.1, -0.1]; 16];
    values[5] = vec![9.0, -9.0];
    let pool = Pool {
        sections: sections(&[4, 4, 4, 4]),
        zones: zones(&[3, 3, 3, 3]),
        minimum: 12,
        quantities: vec![quantity("q", values, vec![limit("std", 1.0, 1, 16)])],
        rule: Some(Rule::EveryLimit),
    };
    let case = Case::of(&pool, None).expect("a case");
    let found = selections(&case, &Settings::default());
    assert_eq!(found.verdict, Verdict::NotValidated);
    assert_eq!(found.removal.map(|removal| removal.sets), Some(vec![vec!["S06".to_owned()]]));
    // One of four selections of its zone is without it.
    assert_eq!(found.counted.share.share, 0.25);
    let bad = found.sections.iter().find(|one| one.section == "S06").expect("a section");
    assert_eq!((bad.with, bad.without), (Some(0.0), Some(1.0)));
    assert!(found.worst[0].sections.contains(&"S06".to_string()));
    assert_eq!((found.quantities[0].failing, found.quantities[0].alone), (0.75, Some(0.75)));
    let (smaller, reduction) = reduced(&case, 3);
    assert!(smaller.strata.iter().all(|stratum| stratum.members.len() == 3));
    // The scatter is that section's: it stays.
    assert!(!reduction.left_out.contains(&"S06".to_string()), "{reduction:?}");
}

#[test]
fn too_few_sections_are_told() {
    let pool = Pool {
        sections: sections(&[2]),
        zones: zones(&[3]),
        minimum: 3,
        quantities: Vec::new(),
        rule: Some(Rule::EveryLimit),
    };
    let says = Case::of(&pool, None).expect_err("too few");
    assert_eq!(says.text().to_string(), "zone 1 has 2 usable sections, and a selection takes 3");
    assert!(Case::of(&pool, Some(2)).is_ok());
}
