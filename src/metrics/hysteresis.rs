//! Comparison of two hysteresis loops, output over an input that rises and falls.
//!
//! Each record is split at the turning points of its input into rising and falling branches.
//! Branches of the same direction are compared at the inputs of the measurement. A record can
//! contain several cycles: at each input, the outputs of the long branches of one direction are
//! averaged. Short branches, such as a first loading or an incomplete last cycle, are used only
//! where there is no long branch. The part of a record after its last turning point is not used if
//! its range is below the threshold.

use super::pair::{Undefined, undefined};

/// A branch is long if it covers at least this share of the longest branch of its direction.
const LONG: f64 = 0.9;

/// A record of output `y` over input `x`, in the order of time; both have the same length.
#[derive(Clone, Copy, Debug)]
pub struct Loop<'a> {
    pub x: &'a [f64],
    pub y: &'a [f64],
}

/// Difference between the simulated and the measured loop, in the unit of the output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matching {
    /// Largest magnitude of the difference.
    pub maximum: f64,
    /// Mean magnitude of the difference over the input, for both directions together. Samples at a
    /// constant input have no weight.
    pub mean: f64,
    /// Largest minus smallest measured output at the inputs compared.
    pub range: f64,
}

/// Compares two loops.
///
/// `threshold` is the share of the input's range by which it must reverse for a turning point. It
/// must be larger than the noise and smaller than the amplitude; 0.05 suits most records.
///
/// # Errors
/// A record without samples, with unequal lengths, with a value that is not finite, or with an
/// input that does not rise and fall; a threshold not between 0 and 1; loops without common inputs
/// in a direction.
pub fn matching(simulated: Loop, measured: Loop, threshold: f64) -> Result<Matching, Undefined> {
    let simulated = sides(simulated, threshold, "simulated")?;
    let measured = sides(measured, threshold, "measured")?;
    let mut maximum = 0.0_f64;
    let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
    let (mut integral, mut length) = (0.0, 0.0);
    for (direction, (ours, theirs)) in DIRECTIONS.into_iter().zip(simulated.iter().zip(&measured)) {
        let mut errors = Vec::new();
        for x in theirs.inputs() {
            let both = ours.at(x).zip(theirs.at(x));
            if let Some((s, m)) = both {
                maximum = maximum.max((s - m).abs());
                (lowest, highest) = (lowest.min(m), highest.max(m));
            }
            errors.push((x, both.map(|(s, m)| (s - m).abs())));
        }
        let (part, along) = trapezia(&errors);
        if along <= 0.0 {
            let word = direction.word();
            let reason = format!("the loops have no common input while it is {word}");
            return undefined(reason);
        }
        integral += part;
        length += along;
    }
    Ok(Matching { maximum, mean: integral / length, range: highest - lowest })
}

/// Integral over points in order and its length, without intervals that have a point without a
/// value.
fn trapezia(points: &[(f64, Option<f64>)]) -> (f64, f64) {
    let (mut integral, mut length) = (0.0, 0.0);
    for [(x, left), (x_next, right)] in points.array_windows() {
        if let (Some(left), Some(right)) = (left, right) {
            integral += 0.5 * (left + right) * (x_next - x);
            length += x_next - x;
        }
    }
    (integral, length)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Direction {
    Rising,
    Falling,
}

const DIRECTIONS: [Direction; 2] = [Direction::Rising, Direction::Falling];

impl Direction {
    fn word(self) -> &'static str {
        match self {
            Self::Rising => "rising",
            Self::Falling => "falling",
        }
    }
}

/// Consecutive samples between two turning points.
#[derive(Clone, Copy, Debug)]
struct Branch {
    direction: Direction,
    first: usize,
    last: usize,
    low: f64,
    high: f64,
}

impl Branch {
    fn span(&self) -> f64 {
        self.high - self.low
    }

    fn samples(&self) -> std::ops::RangeInclusive<usize> {
        self.first..=self.last
    }
}

/// The two directions of a loop, rising and falling.
fn sides(of: Loop, threshold: f64, which: &str) -> Result<[Side; 2], Undefined> {
    let unfit = |what: &str| Undefined::because(format!("the {which} loop {what}"));
    if !(threshold > 0.0 && threshold < 1.0) {
        return undefined(format!(
            "the turning threshold must be between 0 and 1 of the range, this is {threshold}"
        ));
    }
    let (inputs, outputs) = (of.x.len(), of.y.len());
    if inputs != outputs {
        return Err(unfit(&format!("has {inputs} inputs and {outputs} outputs")));
    }
    if of.x.iter().chain(of.y).any(|value| !value.is_finite()) {
        return Err(unfit("has a value that is not finite"));
    }
    let (low, high) =
        of.x.iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)));
    let branches = branches(of.x, threshold * (high - low));
    let side = |direction: Direction| {
        Side::of(of, &branches, direction)
            .ok_or_else(|| unfit(&format!("has no {} branch", direction.word())))
    };
    Ok([side(Direction::Rising)?, side(Direction::Falling)?])
}

/// All branches of one direction as one function of the input.
struct Side {
    long: Vec<Curve>,
    short: Vec<Curve>,
}

impl Side {
    /// `None` if there is no branch of the direction.
    fn of(of: Loop, branches: &[Branch], direction: Direction) -> Option<Self> {
        let ours = branches.iter().filter(|branch| branch.direction == direction);
        let longest = ours.clone().map(Branch::span).max_by(f64::total_cmp)?;
        let (long, short): (Vec<&Branch>, Vec<&Branch>) =
            ours.partition(|branch| branch.span() >= LONG * longest);
        let curves = |branches: Vec<&Branch>| {
            branches.into_iter().map(|branch| Curve::of(of, branch)).collect()
        };
        Some(Self { long: curves(long), short: curves(short) })
    }

    /// Mean output of the long branches at an input, or of the short branches where there is no
    /// long one.
    fn at(&self, x: f64) -> Option<f64> {
        average(&self.long, x).or_else(|| average(&self.short, x))
    }

    /// All inputs in order, without duplicates.
    fn inputs(&self) -> Vec<f64> {
        let mut inputs: Vec<f64> =
            self.long.iter().chain(&self.short).flat_map(|curve| curve.x.iter().copied()).collect();
        inputs.sort_unstable_by(f64::total_cmp);
        inputs.dedup();
        inputs
    }
}

/// Splits an input into branches, at points where it reverses by more than `turn_back`.
///
/// A rising branch ends at the first sample of the highest input, and the falling branch begins at
/// the last one. Changes of the output at constant input belong to neither.
fn branches(x: &[f64], turn_back: f64) -> Vec<Branch> {
    let mut found = Vec::new();
    let Some(&start) = x.first() else { return found };
    let mut highest = Extreme::at(0, start);
    let mut lowest = highest;
    let mut direction = None;
    let mut began = 0;
    // The branch up to an extreme that ends it.
    let branch = |direction: Direction, began: usize, end: Extreme| {
        let (low, high) = match direction {
            Direction::Rising => (x[began], end.value),
            Direction::Falling => (end.value, x[began]),
        };
        Branch { direction, first: began, last: end.first, low, high }
    };
    for (index, &value) in x.iter().enumerate() {
        let rising = direction != Some(Direction::Falling);
        let falling = direction != Some(Direction::Rising);
        if rising && value >= highest.value {
            highest.reach(index, value);
        }
        if falling && value <= lowest.value {
            lowest.reach(index, value);
        }
        let (end, next) = if rising && highest.value - value > turn_back {
            (highest, Direction::Falling)
        } else if falling && value - lowest.value > turn_back {
            (lowest, Direction::Rising)
        } else {
            continue;
        };
        found.extend(direction.map(|direction| branch(direction, began, end)));
        (direction, began) = (Some(next), end.last);
        match next {
            Direction::Falling => lowest = Extreme::at(index, value),
            Direction::Rising => highest = Extreme::at(index, value),
        }
    }
    let end = if direction == Some(Direction::Rising) { highest } else { lowest };
    found.extend(direction.map(|direction| branch(direction, began, end)));
    found
}

/// The highest or lowest input, with its first and last sample.
#[derive(Clone, Copy)]
struct Extreme {
    value: f64,
    first: usize,
    last: usize,
}

impl Extreme {
    fn at(index: usize, value: f64) -> Self {
        Self { value, first: index, last: index }
    }

    fn reach(&mut self, index: usize, value: f64) {
        if value != self.value {
            *self = Self::at(index, value);
        }
        self.last = index;
    }
}

/// The output of one branch as a function of the input, sorted by input; outputs at equal inputs
/// are averaged.
struct Curve {
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Curve {
    fn of(of: Loop, branch: &Branch) -> Self {
        let mut points: Vec<(f64, f64)> =
            branch.samples().map(|index| (of.x[index], of.y[index])).collect();
        points.sort_by(|left, right| left.0.total_cmp(&right.0));
        let mut curve =
            Self { x: Vec::with_capacity(points.len()), y: Vec::with_capacity(points.len()) };
        for equal in points.chunk_by(|left, right| left.0 == right.0) {
            curve.x.push(equal[0].0);
            curve.y.push(equal.iter().map(|point| point.1).sum::<f64>() / equal.len() as f64);
        }
        curve
    }

    /// The output at an input, by linear interpolation; `None` outside.
    fn at(&self, x: f64) -> Option<f64> {
        let after = self.x.partition_point(|&at| at < x);
        let (&x_after, &y_after) = (self.x.get(after)?, self.y.get(after)?);
        if x_after == x {
            return Some(y_after);
        }
        let before = after.checked_sub(1)?;
        let along = (x - self.x[before]) / (x_after - self.x[before]);
        Some(self.y[before] + along * (y_after - self.y[before]))
    }
}

/// Mean output of the curves that contain this input.
fn average(curves: &[Curve], x: f64) -> Option<f64> {
    let (total, count) = curves
        .iter()
        .filter_map(|curve| curve.at(x))
        .fold((0.0, 0), |(total, count), y| (total + y, count + 1));
    (count > 0).then(|| total / f64::from(count))
}
