//! Random selections, where there are too many to evaluate all: the share with an interval, drawn
//! until it is narrow enough. Statistics that can be computed for all selections are exact.

use rayon::prelude::*;

use super::Settings;
use super::case::{Case, Measure};
use super::enumerate::Counted;
use super::grid::Additive;
use super::judged::{Sums, Tally};
use super::known::{self, known};
use super::quartiles::estimated;
use super::random::{Random, draw};
use crate::metrics::interval::wilson;
use crate::result::Verdict;
use crate::result::study::{
    Importance, QuantitySpread, Share, Spread, StatisticSpread, WorstSelection,
};

/// Selections of a batch, and batches drawn between checks of the width.
pub(super) const BATCH: usize = 4096;
pub(super) const ROUND: usize = 8;
/// Largest number of selections drawn.
pub(super) const MOST_DRAWN: usize = 1 << 22;
/// Number of selections whose values are kept for the quartiles.
const KEPT: usize = 1 << 16;
/// Results of some selections.
struct Drawn {
    validated: u64,
    /// Per section: selections with it, and validated ones.
    with: Vec<(u64, u64)>,
    /// Per quantity and per limit: selections that do not meet it; per quantity: those in which it
    /// alone fails.
    quantities: Vec<(u64, u64)>,
    limits: Vec<u64>,
    /// Values of each limit, and the worst with its selection.
    values: Vec<Vec<f64>>,
    worst: Vec<Option<(f64, Vec<usize>)>>,
}

impl Drawn {
    fn none(case: &Case) -> Self {
        let limits = case.measures().count();
        Self {
            validated: 0,
            with: vec![(0, 0); case.sections.len()],
            quantities: vec![(0, 0); case.quantities.len()],
            limits: vec![0; limits],
            values: vec![Vec::new(); limits],
            worst: vec![None; limits],
        }
    }

    fn batch(case: &Case, sums: &[Vec<Sums<'_>>], seed: u64, number: usize) -> Self {
        let mut drawn = Self::none(case);
        let mut random = Random::new(seed, number as u64);
        for _ in 0..BATCH {
            drawn.look(case, sums, draw(case, &mut random));
        }
        drawn
    }

    fn look(&mut self, case: &Case, sums: &[Vec<Sums<'_>>], selection: Vec<usize>) {
        let mut tally = Tally::default();
        let mut limit = 0;
        let mut failing = Vec::new();
        for (at, (quantity, sums)) in case.quantities.iter().zip(sums).enumerate() {
            let before = tally;
            let mut fails = !sums.is_empty() && !quantity.enough(selection.iter().copied());
            tally.missing |= fails;
            for sums in sums {
                let value = sums.over(selection.iter().copied());
                let holds = value.map(|value| sums.measure().holds(value));
                tally.limit(holds);
                fails |= holds != Some(true);
                self.limits[limit] += u64::from(holds == Some(false));
                if let Some(value) = value {
                    self.values[limit].push(value);
                    let badness = if sums.measure().at_least { -value } else { value.abs() };
                    if self.worst[limit].as_ref().is_none_or(|(worst, _)| badness > *worst) {
                        self.worst[limit] = Some((badness, selection.clone()));
                    }
                }
                limit += 1;
            }
            tally.quantity(&before, sums.is_empty());
            if fails {
                failing.push(at);
            }
        }
        let good = u64::from(tally.verdict(case.rule) == Verdict::Validated);
        self.validated += good;
        for &at in &selection {
            self.with[at].0 += 1;
            self.with[at].1 += good;
        }
        failing.iter().for_each(|&at| self.quantities[at].0 += 1);
        if let [only] = failing[..] {
            self.quantities[only].1 += 1;
        }
    }

    /// Batches are joined in order, so that the result does not depend on the number of threads.
    fn join(&mut self, other: Self) {
        self.validated += other.validated;
        let pairs = |mine: &mut Vec<(u64, u64)>, others: Vec<(u64, u64)>| {
            mine.iter_mut()
                .zip(others)
                .for_each(|(mine, other)| *mine = (mine.0 + other.0, mine.1 + other.1));
        };
        pairs(&mut self.with, other.with);
        pairs(&mut self.quantities, other.quantities);
        self.limits.iter_mut().zip(other.limits).for_each(|(mine, other)| *mine += other);
        for (mine, other) in self.values.iter_mut().zip(other.values) {
            let room = KEPT.saturating_sub(mine.len());
            mine.extend(other.into_iter().take(room));
        }
        for (mine, other) in self.worst.iter_mut().zip(other.worst) {
            if other.as_ref().is_some_and(|(new, _)| mine.as_ref().is_none_or(|(old, _)| new > old))
            {
                *mine = other;
            }
        }
    }
}

/// Draws selections until the interval has the required width.
pub fn some(case: &Case, settings: &Settings) -> Counted {
    let sums_of: Vec<Vec<Sums<'_>>> = case
        .quantities
        .iter()
        .map(|quantity| quantity.measures.iter().map(Sums::of).collect())
        .collect();
    let mut drawn = Drawn::none(case);
    let mut batches = 0;
    let interval = loop {
        let round: Vec<Drawn> = (batches..batches + ROUND)
            .into_par_iter()
            .map(|number| Drawn::batch(case, &sums_of, settings.seed, number))
            .collect();
        round.into_iter().for_each(|batch| drawn.join(batch));
        batches += ROUND;
        let interval = wilson(drawn.validated, (batches * BATCH) as u64);
        if interval.1 - interval.0 <= settings.width || batches * BATCH >= MOST_DRAWN {
            break interval;
        }
    };
    let all = (batches * BATCH) as u64;
    let share_of = |count: u64| count as f64 / all as f64;
    let known = known(case);
    let usable = case.usable();
    let mut limit = 0;
    let mut worst = Vec::new();
    let mut quantities = Vec::new();
    for (at, quantity) in case.quantities.iter().enumerate() {
        let mut statistics = Vec::new();
        for measure in &quantity.measures {
            let spread = known[limit].or_else(|| estimated(&drawn.values[limit]));
            statistics.push(StatisticSpread {
                name: measure.name.clone(),
                title: measure.title.clone(),
                scope: measure.scope.clone(),
                limit: measure.limit,
                at_least: measure.at_least,
                spread,
                failing: share_of(drawn.limits[limit]),
                overall: measure.over(usable.iter().copied()),
            });
            let drawn_worst = drawn.worst[limit]
                .as_ref()
                .filter(|_| drawn.limits[limit] > 0)
                .map(|(_, selection)| selection.clone());
            if let Some(selection) = worst_known(case, measure).or(drawn_worst) {
                worst.push(WorstSelection {
                    quantity: quantity.id.clone(),
                    symbol: quantity.symbol.clone(),
                    title: measure.title.clone(),
                    scope: measure.scope.clone(),
                    normalised: measure.over(selection.iter().copied()).unwrap_or(f64::MAX),
                    sections: selection.iter().map(|&at| case.sections[at].clone()).collect(),
                });
            }
            limit += 1;
        }
        quantities.push(QuantitySpread {
            id: quantity.id.clone(),
            title: quantity.title.clone(),
            symbol: quantity.symbol.clone(),
            unit: quantity.unit.clone(),
            failing: share_of(drawn.quantities[at].0),
            alone: Some(share_of(drawn.quantities[at].1)),
            statistics,
        });
    }
    let share =
        |(selections, good): (u64, u64)| (selections > 0).then(|| good as f64 / selections as f64);
    let of = |zone: &str, at: usize| Importance {
        section: case.sections[at].clone(),
        zone: zone.to_owned(),
        with: share(drawn.with[at]),
        without: share((all - drawn.with[at].0, drawn.validated - drawn.with[at].1)),
    };
    Counted {
        share: Share {
            validated: drawn.validated,
            looked_at: all,
            share: share_of(drawn.validated),
            exact: false,
            interval: Some(interval),
            seed: Some(settings.seed),
        },
        quantities,
        sections: case
            .strata
            .iter()
            .flat_map(|stratum| stratum.members.iter().map(|&at| of(&stratum.zone, at)))
            .collect(),
        worst,
        methods: methods(all, interval, &known, settings),
    }
}

/// For a mean, the worst of all selections, if it does not meet the limit.
fn worst_known(case: &Case, measure: &Measure) -> Option<Vec<usize>> {
    let (least, greatest) = Additive::of(case, measure)?.ends();
    let value = |selection: &[usize]| measure.over(selection.iter().copied());
    let (low, high) = (value(&least)?, value(&greatest)?);
    let worst = if measure.at_least || -low > high { (low, least) } else { (high, greatest) };
    (!measure.holds(worst.0)).then_some(worst.1)
}

fn methods(
    all: u64,
    interval: (f64, f64),
    known: &[Option<Spread>],
    settings: &Settings,
) -> Vec<String> {
    let (width, wanted) = (interval.1 - interval.0, settings.width);
    let ended = if width <= wanted {
        format!(
            "until the 95 % interval of the share (Wilson) was no wider than {wanted}: it is {width:.5} wide"
        )
    } else {
        format!(
            "which is the maximum; the 95 % interval of the share (Wilson) is {width:.5} wide, more than the required {wanted}"
        )
    };
    let mut methods = vec![format!(
        "There are too many selections to evaluate all: {all} were drawn at random with equal probability (seed {}), {ended}.",
        settings.seed
    )];
    methods.extend(known::methods(known));
    if known.iter().any(Option::is_none) {
        methods.push(format!(
            "Quartiles of the others are estimated from the first {} drawn selections, with distribution-free 95 % intervals between order statistics; their minima and maxima are those of the drawn selections.",
            KEPT.min(all as usize)
        ));
    }
    methods.push(
        "Shares of selections in which a criterion is not met refer to the drawn selections."
            .into(),
    );
    methods
}
