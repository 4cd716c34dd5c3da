//! Both sides of a campaign beside each other: which channels are alike, and what that says of the
//! order of digits in names, of signs, of the running direction and of shifts.

use std::collections::BTreeMap;

use super::Group;
use super::guess::axis;
use super::look::short;
use super::names::Names;
use crate::import::mapping::Convention;
use crate::metrics::resample::{interpolate, uniform_grid};
use crate::metrics::statistics::correlation;
use crate::units::Dimension;

/// Points at which both sides are compared.
const POINTS: f64 = 2000.0;

/// Mean correlation of the channels above which both sides are the same run, and by how much
/// another reading of it must be less alike. Set after a look at 138 sections of nine campaigns: with
/// the right names it is 0.64 to 0.96, with right and left exchanged at most 0.44 and at least 0.39
/// less. By these bounds 97 % of the sections decide, and all of them rightly.
const ALIKE: f64 = 0.7;
const APART: f64 = 0.2;

/// Largest shift that is looked for: metres along the track.
const MOST_SHIFT: f64 = 20.0;

/// By how much a shift must raise the mean correlation to be told.
const RAISED: f64 = 0.05;

/// Whether a name of a section is another one, or ends in it: `Messung_S06` and `S06`.
fn is_same(name: &str, other: &str) -> bool {
    let before = name.strip_suffix(other).filter(|_| !other.is_empty());
    before.is_some_and(|before| !before.ends_with(char::is_alphanumeric))
}

/// The channels of one section of both sides on a common axis.
#[derive(Debug)]
pub struct Both<'a> {
    names: [&'a Names; 2],
    /// Of each side, a channel after the other; none that cannot be had on the axis.
    values: [Vec<Option<Vec<f64>>>; 2],
    /// Distance of the points of the axis in m.
    step: f64,
    convention: &'a Convention,
}

impl<'a> Both<'a> {
    /// `None` if the sides do not begin with the same section, or have no common distance.
    pub fn new(
        groups: [&Group; 2],
        names: [&'a Names; 2],
        convention: &'a Convention,
    ) -> Option<Self> {
        let [one, other] = groups.map(|group| group.sections.first());
        let (one, other) = (one?, other?);
        if !is_same(one, other) && !is_same(other, one) {
            return None;
        }
        let axes = groups.map(|group| {
            let (found, _) = axis(&group.looks, convention, "distance", Dimension::LENGTH);
            let at = group
                .looks
                .iter()
                .position(|look| found.is_some_and(|of| std::ptr::eq(look, of)))?;
            let unit = group.looks[at].unit.as_ref()?;
            let values = &group.channels().nth(at)?.values;
            Some(values.iter().map(|value| unit.to_si(*value)).collect::<Vec<f64>>())
        });
        let [Some(one), Some(other)] = axes else { return None };
        let start = one.first()?.max(*other.first()?);
        let end = one.last()?.min(*other.last()?);
        let step = (end - start) / POINTS;
        let grid = uniform_grid(start, end, step).ok()?;
        let on_grid = |group: &Group, axis: &[f64]| {
            group.channels().map(|channel| interpolate(axis, &channel.values, &grid).ok()).collect()
        };
        let values = [on_grid(groups[0], &one), on_grid(groups[1], &other)];
        Some(Self { names, values, step, convention })
    }

    /// The correlation of a channel of the first side with one of the second, which lies so many
    /// points further on.
    fn correlation(&self, one: usize, other: usize, lag: isize) -> Option<f64> {
        let (one, other) =
            (self.values[0].get(one)?.as_ref()?, self.values[1].get(other)?.as_ref()?);
        let (skip, ahead) = (lag.min(0).unsigned_abs(), lag.max(0).unsigned_abs());
        let count = one.len().min(other.len()).checked_sub(skip + ahead)?;
        correlation(&one[skip..skip + count], &other[ahead..ahead + count])
    }

    /// The channel of the second side that certainly stands for a channel of the protocol.
    fn other(&self, channel: &str) -> Option<usize> {
        match self.names[1].of(channel)[..] {
            [(at, true)] => Some(at),
            _ => None,
        }
    }

    /// Mean of correlations; without a sign for channels whose sign is a matter of convention.
    fn mean<'n>(&self, pairs: impl Iterator<Item = (usize, &'n str)>) -> Option<f64> {
        let signed = |channel: &str| {
            let groups = self.convention.opposite.iter();
            let mut pairs = groups.flat_map(|group| &group.pairs.0);
            !pairs.any(|(right, left)| right.text == channel || left == channel)
        };
        let one = |(at, channel): (usize, &str)| {
            let found = self.correlation(at, self.other(channel)?, 0)?;
            Some(if signed(channel) { found } else { found.abs() })
        };
        let all: Vec<f64> = pairs.filter_map(one).collect();
        (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
    }

    /// The order of digits by which both sides are alike, and why; `None` if that is not clear.
    pub fn order(&self) -> Option<(usize, String)> {
        let of = |&order: &usize| Some((self.mean(self.names[0].by_order(order))?, order));
        let mut all: Vec<(f64, usize)> = self.names[0].orders.iter().filter_map(of).collect();
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let [(best, order), (second, _), ..] = all[..] else { return None };
        let clear = best >= ALIKE && best - second >= APART;
        let why = format!(
            "mean correlation with the other side {}, by another order {}",
            short(best),
            short(second)
        );
        clear.then_some((order, why))
    }

    /// What the correlation of both sides says of signs: for channels of the protocol.
    pub fn signs(&self) -> BTreeMap<String, String> {
        let of = |(at, channel): (usize, &str)| {
            let found = self.correlation(at, self.other(channel)?, 0)?;
            let says = format!("correlation with the other side {}", short(found));
            Some((
                channel.to_owned(),
                match found <= -ALIKE {
                    true => format!("{says}: one of both has the other sign"),
                    false => says,
                },
            ))
        };
        self.names[0].sure().filter_map(of).collect()
    }

    /// What it says of the running direction and of shifts, as lines.
    pub fn lines(&self, section: &str) -> Vec<String> {
        let sure: Vec<(usize, &str)> = self.names[0].sure().collect();
        let at = |turned: bool, lag: isize| {
            let one = |(at, channel): &(usize, &str)| {
                let turning = self.convention.turning.as_ref().filter(|_| turned);
                let partner = turning.map_or(*channel, |turning| turning.partner(channel));
                let found = self.correlation(*at, self.other(partner)?, lag)?;
                Some(if turning.is_some_and(|of| of.reverses(channel)) { -found } else { found })
            };
            let all: Vec<f64> = sure.iter().filter_map(one).collect();
            all.iter().sum::<f64>() / all.len().max(1) as f64
        };
        let mut lines = Vec::new();
        let (as_it_is, turned) = (at(false, 0), at(true, 0));
        if self.convention.turning.is_some() && turned >= ALIKE && turned - as_it_is >= APART {
            lines.push(format!(
                "{section}: the other end of the vehicle seems to lead (mean correlation with the other side {}, {} if turned): `turned: [{section}]`",
                short(as_it_is),
                short(turned)
            ));
        }
        // Most of both sides must remain.
        let most = (MOST_SHIFT / self.step).min(POINTS / 4.0) as isize;
        let shifted = (-most..=most).map(|lag| (at(false, lag), lag));
        if let Some((best, lag)) = shifted.max_by(|a, b| a.0.total_cmp(&b.0))
            && best >= ALIKE
            && best - as_it_is >= RAISED
        {
            lines.push(format!(
                "{section}: the other side seems to lie {} m further on (mean correlation {}, {} if shifted)",
                short(lag as f64 * self.step),
                short(as_it_is),
                short(best)
            ));
        }
        lines
    }
}
