//! Selections whose verdict changes, and quartiles of drawn selections, against selections judged
//! one by one.

use fishplate::catalog::Statistic;
use fishplate::metrics::random::SplitMix64;
use fishplate::result::{Direction, Scope, Verdict};
use fishplate::run::pool::{
    Bounds, Pool, Pooled, PooledLimit, PooledQuantity, Rule, Section, Zone,
};
use fishplate::study::case::Case;
use fishplate::study::flips::{Marked, flips};
use fishplate::study::random::{Random, draw};
use fishplate::study::{Settings, enumerate, marked, sampling};

const ZONES: [usize; 4] = [5, 4, 5, 6];

/// Four quantities of two signals; some sections are not used.
fn case(seed: u64, rule: Rule, unused: &[usize]) -> Case {
    let all: usize = ZONES.iter().sum();
    let mut common = Random::new(5, 0);
    let mut own = Random::new(seed, 1);
    let mut value = || {
        2.4 * (common.below(1000) as f64 / 1000.0 - 0.5)
            + 1.2 * (own.below(1000) as f64 / 1000.0 - 0.45)
    };
    let limit = |name: &str, bound: f64| PooledLimit {
        estimate: Pooled::Statistic(Statistic::named(name).expect("a statistic"), 1),
        direction: Direction::Magnitude,
        edge: false,
        title: name.into(),
        scope: Scope::default(),
        positions: Vec::new(),
        inside: vec![true; all],
        bounds: Bounds::Common(bound),
    };
    let quantities = (0..4).map(|at| PooledQuantity {
        id: format!("q{at}"),
        title: String::new(),
        symbol: String::new(),
        unit: "-".into(),
        values: (0..all).map(|_| vec![(0, value()), (1, value())]).collect(),
        minimum_signals: 2,
        minimum_pairs: 16,
        minimum_of_groups: Vec::new(),
        limits: vec![limit("std", 0.85), limit("mean", 0.3)],
    });
    let zone_of = ZONES
        .iter()
        .enumerate()
        .flat_map(|(zone, count)| (0..*count).map(move |_| (zone + 1).to_string()));
    let pool = Pool {
        quantities: quantities.collect(),
        sections: zone_of
            .enumerate()
            .map(|(at, zone)| Section {
                name: format!("s{at:02}"),
                zone: Some(zone),
                site: at,
                used: !unused.contains(&at),
                reason: None,
            })
            .collect(),
        zones: (1..=4)
            .map(|zone| Zone { name: zone.to_string(), title: String::new(), needed: 3 })
            .collect(),
        minimum: 12,
        rule: Some(rule),
    };
    Case::of(&pool, None).expect("a case")
}

/// Every selection of the sections that both have, judged by itself in both.
fn one_by_one(one: &Case, two: &Case) -> (f64, f64, f64) {
    let (one, two) =
        (one.with_sections_of(two).expect("enough"), two.with_sections_of(one).expect("enough"));
    let (mut all, mut lost, mut gained) = (0.0, 0.0, 0.0);
    let halves = fishplate::study::halves::Halves::of(&one);
    for row in halves.rows.choices() {
        for column in halves.columns.choices() {
            let selection: Vec<usize> = row.iter().chain(column).map(|at| *at as usize).collect();
            let holds = |case: &Case| case.judge(&selection).0 == Verdict::Validated;
            all += 1.0;
            match (holds(&one), holds(&two)) {
                (true, false) => lost += 1.0,
                (false, true) => gained += 1.0,
                _ => {}
            }
        }
    }
    (all, lost / all, gained / all)
}

#[test]
fn flips_are_those_of_selections_judged_one_by_one() {
    for rule in [Rule::EveryLimit, Rule::AtLeastQuantities(3), Rule::AtLeastLimits(7)] {
        // The second time a section of one is missing in the other, so that marks cannot be taken
        // over.
        for unused in [&[][..], &[1, 17]] {
            let (one, two) = (case(1, rule, &[]), case(2, rule, unused));
            let settings = Settings::default();
            let (before, after) = (marked(&one, &settings).1, marked(&two, &settings).1);
            let found = flips(
                Marked { case: &one, fails: before.as_ref() },
                Marked { case: &two, fails: after.as_ref() },
                &settings,
            )
            .expect("enough sections");
            let (all, lost, gained) = one_by_one(&one, &two);
            assert_eq!(
                (found.compared, found.lost, found.gained, found.exact),
                (all, lost, gained, true)
            );
            assert!(lost > 0.0 && gained > 0.0, "{rule:?}: {lost} {gained}");
            // Drawn at random, the intervals hold what counting says.
            let few = Settings { most: 0.0, width: 0.02, seed: 4 };
            let drawn =
                flips(Marked { case: &one, fails: None }, Marked { case: &two, fails: None }, &few)
                    .expect("enough sections");
            let inside = |interval: Option<(f64, f64)>, share: f64| {
                interval.is_some_and(|(low, high)| low <= share && share <= high)
            };
            assert!(
                !drawn.exact
                    && inside(drawn.lost_interval, lost)
                    && inside(drawn.gained_interval, gained),
                "{drawn:?}"
            );
        }
    }
    let (one, two) = (case(1, Rule::EveryLimit, &[]), case(2, Rule::EveryLimit, &[]));
    let says = one
        .with_sections_of(&Case { strata: two.strata[2..].to_vec(), ..two })
        .expect_err("too few")
        .text()
        .to_string();
    assert!(says.starts_with("zone 1 has 0 sections usable in both"), "{says}");
}

/// Over eighty seeds, each interval of a quartile holds the one over all selections about as often
/// as it says.
#[test]
fn intervals_of_drawn_quartiles_hold_the_counted_ones() {
    let case = case(1, Rule::EveryLimit, &[]);
    let exact = enumerate::all(&case);
    let (mut held, mut all) = (0, 0);
    for seed in 0..80 {
        let drawn = sampling::some(&case, &Settings { most: 0.0, width: 0.5, seed });
        for (drawn, exact) in drawn.quantities.iter().zip(&exact.quantities) {
            let (drawn, exact) = (
                drawn.statistics[0].spread.expect("values"),
                exact.statistics[0].spread.expect("values"),
            );
            let intervals = drawn.intervals.all().map(|interval| interval.expect("a large sample"));
            for ((low, high), value) in intervals.iter().zip([exact.q1, exact.median, exact.q3]) {
                all += 1;
                held += usize::from(*low <= value && value <= *high);
            }
        }
    }
    assert!(all == 960 && held >= 893, "{held} of {all}");
}

/// SplitMix64 from the seed 1234567, as published at
/// rosettacode.org/wiki/Pseudo-random_numbers/Splitmix64.
#[test]
fn random_numbers_are_those_of_the_published_generator() {
    let mut random = SplitMix64::new(1_234_567);
    let drawn: Vec<u64> = (0..5).map(|_| random.number()).collect();
    assert_eq!(
        drawn,
        [
            6457827717110365317,
            3203168211198807973,
            9817491932198370423,
            4593380528125082431,
            16408922859458223821
        ]
    );
}

/// Worked out apart from the program, from the published generator: another version must draw the
/// same.
#[test]
fn what_is_drawn_stays_the_same() {
    let case = case(1, Rule::EveryLimit, &[]);
    assert_eq!(draw(&case, &mut Random::new(7, 3)), DRAWN);
}

const DRAWN: [usize; 12] = [1, 2, 4, 5, 7, 8, 9, 12, 13, 14, 17, 19];
