//! What is said of campaigns with too many selections to look at, and of sections given up, against
//! other ways to the same.

use crate::common::pools::{every, limit, quantity, sections, sorted, zones};
use fishplate::result::Verdict;
use fishplate::run::pool::{Pool, Rule};
use fishplate::study::case::Case;
use fishplate::study::grid::Additive;
use fishplate::study::random::Random;
use fishplate::study::{Settings, extremes, greedy, reduced, selections};
use proptest::prelude::*;

/// Sections of each zone, how many are taken, and the values of a section for each quantity, by
/// number of section and quantity.
fn case(
    counts: &[usize],
    takes: &[usize],
    statistics: &[(&str, f64)],
    rule: Rule,
    mut values: impl FnMut(usize, usize) -> Vec<f64>,
) -> Case {
    let all: usize = counts.iter().sum();
    let quantities = statistics.iter().enumerate().map(|(number, (name, bound))| {
        let of_sections = (0..all).map(|section| values(section, number)).collect();
        quantity(&format!("q{number}"), of_sections, vec![limit(name, *bound, 1, all)])
    });
    let pool = Pool {
        quantities: quantities.collect(),
        sections: sections(counts),
        zones: zones(takes),
        minimum: 1,
        rule: Some(rule),
    };
    Case::of(&pool, None).expect("a case")
}

/// Numbers between -1 and 1.
fn even(random: &mut Random) -> f64 {
    random.below(2_000_001) as f64 / 1e6 - 1.0
}

/// Forty sections in each of four zones, three taken: 9.5e15 selections. Values are whole numbers,
/// so that every sum is counted by whole numbers, too: how many triples of a zone have it, then of
/// the zones together.
#[test]
fn quartiles_of_means_of_1e16_selections_are_where_whole_numbers_put_them() {
    let mut random = Random::new(3, 0);
    let whole: Vec<Vec<u64>> =
        (0..4).map(|zone| (0..40).map(|_| random.below(9 + 4 * zone) as u64).collect()).collect();
    let value = |section: usize, _: usize| vec![whole[section / 40][section % 40] as f64 - 5.0];
    let case = case(
        &[40; 4],
        &[3; 4],
        &[("mean", 2.0), ("maximum", 16.0), ("std", 4.6)],
        Rule::EveryLimit,
        value,
    );
    let mut sums: Vec<u128> = vec![1];
    for zone in &whole {
        let mut more = vec![0_u128; sums.len() + 60];
        for a in 0..40 {
            for b in 0..a {
                for c in 0..b {
                    let sum = (zone[a] + zone[b] + zone[c]) as usize;
                    sums.iter().enumerate().for_each(|(at, count)| more[at + sum] += count);
                }
            }
        }
        sums = more;
    }
    let all: u128 = sums.iter().sum();
    assert_eq!(all, 9880_u128.pow(4));
    let mean = |sum: usize| (sum as f64 / 12.0 - 5.0) / 2.0;
    let of_rank = |rank: u128| {
        let mut upto = 0;
        mean(
            sums.iter()
                .position(|count| {
                    upto += count;
                    upto > rank
                })
                .expect("a rank"),
        )
    };
    let found = selections(&case, &Settings { width: 0.005, ..Settings::default() });
    assert_eq!(found.counted.combinations, all as f64);
    let spread = found.quantities[0].statistics[0].spread.expect("values");
    let within = spread.within.expect("bounds");
    assert!(!spread.exact && within < 1e-4, "{within}");
    for (quartile, share) in [(spread.q1, 1), (spread.median, 2), (spread.q3, 3)] {
        let true_one = of_rank(all * share / 4);
        assert!((quartile - true_one).abs() <= within, "{quartile} and {true_one}, {within}");
    }
    let ends: Vec<usize> =
        [sums.iter().position(|count| *count > 0), sums.iter().rposition(|count| *count > 0)]
            .into_iter()
            .flatten()
            .collect();
    assert!(
        (spread.min - mean(ends[0])).abs() < 1e-12 && (spread.max - mean(ends[1])).abs() < 1e-12
    );
    // The largest of twelve values, from the share of choices whose values are all up to a bound.
    let largest = found.quantities[1].statistics[0].spread.expect("values");
    let upto = |bound: f64| -> f64 {
        whole
            .iter()
            .map(|zone| {
                let n = zone.iter().filter(|value| **value as f64 - 5.0 <= bound).count() as f64;
                n * (n - 1.0) * (n - 2.0) / 6.0 / 9880.0
            })
            .product()
    };
    assert!(largest.exact);
    for (quartile, share) in [(largest.q1, 0.25), (largest.median, 0.5), (largest.q3, 0.75)] {
        assert!(
            upto(16.0 * quartile + 0.5) > share && upto(16.0 * quartile - 0.5) <= share,
            "{quartile}"
        );
    }
    // What is left is drawn, until the interval is as narrow as wanted, and the report says which
    // is which.
    assert!(
        !found.counted.share.exact
            && found.quantities[2].statistics[0]
                .spread
                .is_some_and(|spread| !spread.exact && spread.intervals.all()[0].is_some())
    );
    let (low, high) = found.counted.share.interval.expect("an interval");
    assert!(
        high - low <= 0.005 && found.counted.share.looked_at > 32_768,
        "{:?}",
        found.counted.share
    );
    assert!(
        found.methods.iter().any(|says| says.contains("no wider than 0.005")),
        "{:?}",
        found.methods
    );
    assert!(
        found.methods.iter().any(|says| says.starts_with("1 of 3 statistics, which are means")),
        "{:?}",
        found.methods
    );
    assert!(
        found
            .methods
            .iter()
            .any(|says| says.starts_with("1 of 3 statistics are nevertheless exact")),
        "{:?}",
        found.methods
    );
}

/// A width that cannot be had is told.
#[test]
fn drawing_ends_somewhere() {
    let mut random = Random::new(5, 0);
    let case =
        case(&[30; 2], &[3; 2], &[("std", 0.6)], Rule::EveryLimit, |_, _| vec![even(&mut random)]);
    let found = selections(&case, &Settings { most: 0.0, width: 1e-6, seed: 1 });
    assert_eq!(found.counted.share.looked_at, 1 << 22);
    assert!(found.methods[0].contains("more than the required 0.000001"), "{:?}", found.methods);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Means, root mean squares and largest values without forming selections, against all
    /// selections.
    #[test]
    fn what_is_known_without_selections_is_so(
        shape in prop::collection::vec((1_usize..4, 0_usize..5), 1..4),
        seed in any::<u64>(),
        coarse in any::<bool>(),
    ) {
        let counts: Vec<usize> = shape.iter().map(|(take, more)| take + more).collect();
        let takes: Vec<usize> = shape.iter().map(|(take, _)| *take).collect();
        let mut random = Random::new(seed, 0);
        let statistics = [("mean", 0.5), ("rms", 0.8), ("maximum", 0.9), ("minimum", 0.9), ("peak", 0.9), ("each", 0.7)];
        let case = case(&counts, &takes, &statistics, Rule::EveryLimit, |section, number| {
            // Means need as many values in every section of a zone; the others do not.
            let values = if number < 2 { 2 } else { (section + number) % 3 };
            (0..values).map(|_| if coarse { even(&mut random).round() } else { even(&mut random) }).collect()
        });
        let all = every(&case);
        for (_, measure) in case.measures() {
            let values: Vec<f64> = all.iter().filter_map(|selection| measure.over(selection.iter().copied())).collect();
            let wanted = sorted(values.clone());
            let Some(additive) = Additive::of(&case, measure) else {
                let found = extremes::over_all(&case, measure).map(fishplate::result::study::Spread::from);
                prop_assert_eq!(found.map(|spread| spread.outliers), wanted.map(|spread| spread.outliers));
                if let (Some(found), Some(wanted)) = (found, wanted) {
                    for (a, b) in [(found.min, wanted.min), (found.q1, wanted.q1), (found.median, wanted.median), (found.q3, wanted.q3), (found.max, wanted.max)] {
                        prop_assert!((a - b).abs() < 1e-12, "{}: {found:?} {wanted:?}", measure.name);
                    }
                }
                continue;
            };
            let (found, wanted) = (additive.spread(all.len() as f64).expect("bounds"), wanted.expect("values"));
            prop_assert!((found.min - wanted.min).abs() < 1e-12 && (found.max - wanted.max).abs() < 1e-12);
            let within = found.within.expect("bounds");
            // Few selections leave quartiles between two of them.
            let mut sorted_values = values;
            sorted_values.sort_by(f64::total_cmp);
            let last = sorted_values.len() - 1;
            for (quartile, share) in [(found.q1, 0.25), (found.median, 0.5), (found.q3, 0.75)] {
                let rank = share * last as f64;
                let low = sorted_values[(rank.floor() as usize).saturating_sub(1)];
                let high = sorted_values[(rank.ceil() as usize + 1).min(last)];
                prop_assert!(low - within - 1e-9 <= quartile && quartile <= high + within + 1e-9, "{quartile}: {low} {high} {within}");
            }
            let (least, greatest) = additive.ends();
            let value = |selection: &[usize]| measure.over(selection.iter().copied()).expect("a value");
            prop_assert!((value(&least) - wanted.min).abs() < 1e-12 && (value(&greatest) - wanted.max).abs() < 1e-12);
        }
    }

    /// The smallest sets, against every set that may be removed.
    #[test]
    fn smallest_removal_is_that_of_all_sets(seed in any::<u64>(), rule in 0_usize..3, bound in 0.3_f64..0.9) {
        let mut random = Random::new(seed, 0);
        let rule = [Rule::EveryLimit, Rule::AtLeastQuantities(3), Rule::AtLeastLimits(2)][rule];
        let statistics = [("mean", 0.4 * bound), ("std", bound), ("rms", bound), ("maximum", 1.2 * bound)];
        let case = case(&[5, 4, 3], &[3, 2, 2], &statistics, rule, |section, number| {
            (0..1 + (section + number) % 2).map(|_| even(&mut random)).collect()
        });
        let (verdict, _) = case.judge(&case.usable());
        let found = selections(&case, &Settings::default()).removal.expect("looked for");
        let mut sets: Vec<Vec<usize>> = (1_u32..1 << 12).map(|mask| (0..12).filter(|at| mask >> at & 1 == 1).collect()).collect();
        sets.retain(|set: &Vec<usize>| case.strata.iter().all(|stratum| {
            stratum.members.iter().filter(|at| !set.contains(at)).count() >= stratum.take
        }));
        sets.retain(|set| {
            let kept: Vec<usize> = (0..12).filter(|at| !set.contains(at)).collect();
            case.judge(&kept).0 != verdict
        });
        let size = sets.iter().map(Vec::len).min();
        sets.retain(|set| Some(set.len()) == size);
        let mut wanted: Vec<Vec<String>> = sets.iter().map(|set| set.iter().map(|at| case.sections[*at].clone()).collect()).collect();
        wanted.sort();
        prop_assert_eq!(found.count, wanted.len());
        let mut kept = found.sets;
        kept.sort();
        if wanted.len() <= 20 {
            prop_assert_eq!(kept, wanted);
        }
        prop_assert_eq!(found.verdict, verdict);
        // Some set, without trying all: it changes the verdict, leaves enough, and is no smaller.
        if let Some(set) = greedy::set(&case, verdict) {
            prop_assert!(case.strata.iter().all(|of| of.members.iter().filter(|at| !set.contains(at)).count() >= of.take));
            let kept: Vec<usize> = (0..12).filter(|at| !set.contains(at)).collect();
            prop_assert!(case.judge(&kept).0 != verdict && Some(set.len()) >= size, "{set:?}");
        }
    }
}

/// The highest standard deviation that the kept sections keep, against every choice of as many. The
/// choice weighs the other deviations, too, and is improved one section at a time, so that it need
/// not be the best: nine in ten are within 0.01 of it, and none of three hundred is further off
/// than 0.05.
#[test]
fn reduction_keeps_the_highest_deviation_nearly_as_well_as_any_choice() {
    let mut worse: Vec<f64> = (0..300)
        .map(|seed| {
            let mut random = Random::new(seed, 0);
            let statistics = [("std", 0.6), ("std", 0.5), ("std", 0.8)];
            let case = case(&[6, 7], &[2, 2], &statistics, Rule::EveryLimit, |_, _| {
                vec![even(&mut random), even(&mut random)]
            });
            let highest = |sections: &[usize]| {
                case.measures()
                    .filter_map(|(_, measure)| measure.over(sections.iter().copied()))
                    .fold(0.0, f64::max)
            };
            let all = highest(&case.usable());
            let (smaller, reduction) = reduced(&case, 4);
            assert!(smaller.strata.iter().all(|stratum| stratum.members.len() == 4), "seed {seed}");
            let listed = reduction.scatter.iter().map(|(_, _, kept)| *kept).fold(0.0, f64::max);
            assert!((listed - highest(&smaller.usable())).abs() < 1e-12, "seed {seed}");
            let mut four = case.clone();
            four.strata.iter_mut().for_each(|stratum| stratum.take = 4);
            let best = every(&four)
                .iter()
                .map(|selection| (highest(selection) - all).abs())
                .fold(f64::INFINITY, f64::min);
            (highest(&smaller.usable()) - all).abs() - best
        })
        .collect();
    worse.sort_by(f64::total_cmp);
    assert!(worse[269] <= 0.01 && worse[299] <= 0.05, "{} and {}", worse[269], worse[299]);
}

/// Where one section alone makes the highest deviation it is kept, and the verdict with it.
#[test]
fn nine_of_forty_keep_the_highest_deviation() {
    let mut random = Random::new(11, 0);
    let statistics = [("std", 0.55), ("std", 0.7), ("mean", 0.5)];
    let case = case(&[40; 4], &[3; 4], &statistics, Rule::EveryLimit, |_, _| {
        vec![even(&mut random), even(&mut random)]
    });
    let (smaller, reduction) = reduced(&case, 9);
    assert!(smaller.strata.iter().all(|stratum| stratum.members.len() == 9));
    let highest =
        |of: fn(&(String, f64, f64)) -> f64| reduction.scatter.iter().map(of).fold(0.0, f64::max);
    let (all, kept) = (highest(|one| one.1), highest(|one| one.2));
    assert!((all - kept).abs() < 0.005, "{all} and {kept}");
    assert_eq!(
        (case.judge(&case.usable()).0, smaller.judge(&smaller.usable()).0),
        (Verdict::NotValidated, Verdict::NotValidated)
    );
}

/// Five bad sections among 160 are more than can be tried, and are found all the same.
#[test]
fn a_set_too_large_to_be_tried_is_found() {
    let bad = [3, 50, 51, 90, 155];
    let mut random = Random::new(17, 0);
    let case =
        case(&[40; 4], &[3; 4], &[("std", 0.6), ("mean", 0.5)], Rule::EveryLimit, |section, _| {
            let size = if bad.contains(&section) { 9.0 } else { 0.3 };
            vec![size * even(&mut random).signum(), size * even(&mut random)]
        });
    let found = selections(&case, &Settings { width: 0.5, ..Settings::default() })
        .removal
        .expect("looked for");
    assert_eq!((found.verdict, found.count, found.complete), (Verdict::NotValidated, 0, false));
    let larger = found.larger.expect("a set");
    let kept: Vec<usize> = (0..160).filter(|at| !larger.contains(&case.sections[*at])).collect();
    assert_eq!(case.judge(&kept).0, Verdict::Validated);
    assert!(
        larger.len() <= 12
            && bad.iter().filter(|at| larger.contains(&case.sections[**at])).count() >= 4,
        "{larger:?}"
    );
}
