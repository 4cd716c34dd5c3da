//! Random selections, where there are too many to evaluate all: the share with an interval, drawn
//! until it is narrow enough. Statistics that can be computed for all selections are exact.

use super::{
    Settings,
    case::{Case, Measure},
    counted::{Counted, LimitCount, Numbers},
    grid::Additive,
    judged::Judge,
    known::{self, known},
    quartiles::estimated,
    random::{Count, draw_until},
};
use crate::metrics::interval::wilson;
use crate::result::{
    Reason, Verdict,
    study::{Share, Spread},
};

/// Number of selections whose values are kept for the quartiles.
const KEPT: usize = 1 << 16;

/// Results of some selections.
struct Drawn<'a> {
    judge: &'a Judge<'a>,
    validated: u64,
    numbers: Numbers,
    limits: Vec<DrawnLimit>,
}

/// Results of one limit.
#[derive(Clone, Default)]
struct DrawnLimit {
    /// Selections that do not meet it.
    failing: u64,
    values: Vec<f64>,
    /// How bad the worst is, and its selection.
    worst: Option<(f64, Vec<usize>)>,
}

impl<'a> Drawn<'a> {
    fn none(judge: &'a Judge<'a>) -> Self {
        let case = judge.case;
        let numbers = Numbers {
            quantities: vec![(0, 0); case.quantities.len()],
            sections: vec![(0, 0); case.sections.len()],
        };
        let limits = vec![DrawnLimit::default(); case.measures().count()];
        Self { judge, validated: 0, numbers, limits }
    }
}

impl Count for Drawn<'_> {
    fn look(&mut self, selection: Vec<usize>) {
        let limits = &mut self.limits;
        let judged = self.judge.over(&selection, |number, measure, value| {
            let Some(value) = value else { return };
            let limit = &mut limits[number];
            limit.failing += u64::from(!measure.holds(value));
            limit.values.push(value);
            let badness = if measure.low_is_worse(value, value) { -value } else { value };
            if limit.worst.as_ref().is_none_or(|(worst, _)| badness > *worst) {
                limit.worst = Some((badness, selection.clone()));
            }
        });
        let good = u64::from(judged.verdict == Verdict::Validated);
        self.validated += good;
        for &at in &selection {
            add(&mut self.numbers.sections[at], (1, good));
        }
        for &at in &judged.failing {
            add(&mut self.numbers.quantities[at], (1, u64::from(judged.failing.len() == 1)));
        }
    }

    fn join(&mut self, other: Self) {
        self.validated += other.validated;
        let pairs = |mine: &mut Vec<(u64, u64)>, others: Vec<(u64, u64)>| {
            mine.iter_mut().zip(others).for_each(|(mine, other)| add(mine, other));
        };
        pairs(&mut self.numbers.sections, other.numbers.sections);
        pairs(&mut self.numbers.quantities, other.numbers.quantities);
        for (mine, other) in self.limits.iter_mut().zip(other.limits) {
            mine.failing += other.failing;
            let room = KEPT.saturating_sub(mine.values.len());
            mine.values.extend(other.values.into_iter().take(room));
            let worse =
                |(new, _): &(f64, Vec<usize>)| mine.worst.as_ref().is_none_or(|(old, _)| new > old);
            if other.worst.as_ref().is_some_and(worse) {
                mine.worst = other.worst;
            }
        }
    }

    fn width(&self, all: u64) -> f64 {
        let (low, high) = wilson(self.validated, all);
        high - low
    }
}

fn add(mine: &mut (u64, u64), other: (u64, u64)) {
    *mine = (mine.0 + other.0, mine.1 + other.1);
}

/// Draws selections until the interval has the required width.
pub fn some(case: &Case, settings: &Settings) -> Counted {
    let judge = Judge::new(case);
    let (drawn, all) = draw_until(case, settings, || Drawn::none(&judge));
    let interval = wilson(drawn.validated, all);
    let share = Share {
        validated_of_all: None,
        reason: Some(Reason::NotAllEvaluated),
        exact: false,
        interval: Some(interval),
        seed: Some(settings.seed),
        ..Share::exact(drawn.validated, all)
    };
    let known = known(case);
    let of_limit =
        |(((_, measure), limit), known): (((usize, &Measure), DrawnLimit), &Option<Spread>)| {
            let drawn = limit.worst.filter(|_| limit.failing > 0).map(|(_, selection)| selection);
            let value = |selection: &[usize]| measure.over(selection.iter().copied());
            LimitCount {
                spread: known.or_else(|| estimated(&limit.values)),
                failing: limit.failing,
                worst: worst_known(case, measure).or(drawn).map(|selection| {
                    let value = value(&selection).unwrap_or(f64::MAX);
                    (selection, value)
                }),
            }
        };
    let limits = case.measures().zip(drawn.limits).zip(&known).map(of_limit).collect();
    let methods = methods(all, interval, &known, settings);
    Counted::new(case, share, limits, &drawn.numbers, methods)
}

/// For a mean, the worst of all selections, if it does not meet the limit.
fn worst_known(case: &Case, measure: &Measure) -> Option<Vec<usize>> {
    let (least, greatest) = Additive::of(case, measure)?.ends();
    let value = |selection: &[usize]| measure.over(selection.iter().copied());
    let (low, high) = (value(&least)?, value(&greatest)?);
    let worst = if measure.low_is_worse(low, high) { (low, least) } else { (high, greatest) };
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
