//! Regressions that are read outside the data that they were fitted to, and estimates from them far
//! beyond the values.

use super::groups::Group;
use super::table::Member;
use crate::check::plan::{EstimateKind, Expr, Fit, OfGroup, Taking};
use crate::metrics::statistics::ends;
use crate::result::{Finding, FindingData, Occurrence, Outside, QuantityResult, Scope};

/// Code of the finding about regressions that are read outside their data.
const EXTRAPOLATED: &str = "extrapolated";

/// Beyond the data by less than this share of their range is rounding: a target such as `mean of
/// speed` is computed from them.
const ROUNDING: f64 = 1e-9;

/// Code of the finding about estimates far beyond the values.
const BEYOND: &str = "beyond-measured";

/// Beyond the values by more than this multiple of their range an estimate is far. A bound for a
/// further value lies above all of them, with 25 values by less than half of their range; with three,
/// of which one is free, 99 % are 64 standard errors, and no value says anything so far away.
const FAR: f64 = 1.0;

impl Group<'_> {
    /// The regressors of an estimate that are read outside the data of this group.
    pub fn outside(&self, of: &OfGroup) -> Vec<Outside> {
        let one = |taking: &Taking| match taking {
            Taking::Fit(fit) => self.outside_of(fit),
            Taking::Bound { of, .. } => match &of.kind {
                EstimateKind::Of(of) => self.outside(of),
                EstimateKind::Each => Vec::new(),
            },
            Taking::EachGroup { keys, of, .. } => {
                let group = |rows: Vec<usize>| {
                    let members: Vec<Member<'_>> =
                        rows.iter().map(|&row| self.members[row]).collect();
                    Group { members: &members, ..*self }.outside(of)
                };
                self.groups(keys).into_values().flat_map(group).collect()
            }
            Taking::Statistic(..)
            | Taking::Weighted { .. }
            | Taking::Count
            | Taking::Where { .. }
            | Taking::Other { .. }
            | Taking::Data { .. } => Vec::new(),
        };
        of.taken.iter().flat_map(one).collect()
    }

    /// The least and the largest value of this group, if an estimate with regressions lies far beyond
    /// them.
    pub fn beyond(&self, of: &OfGroup, estimate: f64) -> Option<(f64, f64)> {
        let (low, high) = ends(self.values());
        let beyond = (low - estimate).max(estimate - high) > FAR * (high - low);
        let fitted = of.taken.iter().any(|taking| matches!(taking, Taking::Fit(_)));
        (fitted && beyond).then_some((low, high))
    }

    fn outside_of(&self, fit: &Fit) -> Vec<Outside> {
        let Ok(fitted) = self.fitted(fit, &self.values()) else { return Vec::new() };
        let one = |(over, (data, target)): (&Expr, (&Vec<f64>, &f64))| {
            let (low, high) = ends(data.iter().copied());
            let room = ROUNDING * (high - low);
            if (low - room..=high + room).contains(target) {
                return None;
            }
            let unit = self.unit_of(over);
            Some(Outside {
                regressor: over.span.words.to_string(),
                target: unit.from_si(*target),
                low: unit.from_si(low),
                high: unit.from_si(high),
                unit: unit.text,
            })
        };
        fit.over.iter().zip(fitted.regressors.iter().zip(&fitted.at)).filter_map(one).collect()
    }
}

/// An estimate of a quantity, and the groups in which it is read outside its data.
struct Read<'a> {
    quantity: &'a str,
    estimate: &'a str,
    groups: Vec<&'a Scope>,
}

/// One finding for each target and range of data, with the estimates that are read there.
pub fn findings(quantities: &[QuantityResult]) -> Vec<Finding> {
    let mut all: Vec<(&Outside, Vec<Read<'_>>)> = Vec::new();
    for quantity in quantities {
        for statistic in &quantity.statistics {
            for outside in &statistic.outside {
                let (id, title, group) =
                    (quantity.id.as_str(), statistic.title.as_str(), &statistic.scope);
                let new = || Read { quantity: id, estimate: title, groups: vec![group] };
                let Some((_, reads)) = all.iter_mut().find(|(known, _)| *known == outside) else {
                    all.push((outside, vec![new()]));
                    continue;
                };
                match reads.iter_mut().find(|read| read.quantity == id && read.estimate == title) {
                    Some(read) if read.groups.last() == Some(&group) => {}
                    Some(read) => read.groups.push(group),
                    None => reads.push(new()),
                }
            }
        }
    }
    let beyond = quantities.iter().filter_map(beyond);
    all.iter().map(|(outside, reads)| finding(outside, reads)).chain(beyond).collect()
}

/// The estimates of a quantity that lie far beyond their values.
fn beyond(quantity: &QuantityResult) -> Option<Finding> {
    let statistics = quantity.statistics.iter();
    let all: Vec<_> = statistics.filter_map(|one| Some((one, one.value?, one.beyond?))).collect();
    let far = |value: f64, (low, high): (f64, f64)| {
        (low - value).max(value - high) / (high - low).max(f64::MIN_POSITIVE)
    };
    let farthest = all.iter().max_by(|a, b| far(a.1, a.2).total_cmp(&far(b.1, b.2)));
    let (one, value, (low, high)) = *farthest?;
    let data = FindingData::BeyondMeasured {
        quantity: quantity.id.clone(),
        estimates: all.len(),
        estimate: one.title.clone(),
        group: one.scope.told(),
        value,
        count: one.count,
        low,
        high,
        unit: one.unit.clone(),
    };
    Some(Finding::note(BEYOND, Occurrence::from(data)))
}

fn finding(outside: &Outside, reads: &[Read<'_>]) -> Finding {
    let Outside { regressor, unit, target, low, high } = outside.clone();
    let (beyond, edge) = if target < low { (low - target, low) } else { (target - high, high) };
    let mut quantities: Vec<String> = reads.iter().map(|read| read.quantity.into()).collect();
    quantities.dedup();
    let (estimate, groups) = match reads {
        [one] => {
            let groups = one.groups.iter().filter_map(|group| group.told()).collect();
            (Some(one.estimate.into()), groups)
        }
        _ => (None, Vec::new()),
    };
    let data = FindingData::ReadOutside {
        quantities,
        estimates: reads.len(),
        estimate,
        groups,
        regressor,
        target,
        beyond,
        low,
        high,
        unit: unit.clone(),
    };
    let first =
        Occurrence { value: Some(target), expected: Some(edge), unit: Some(unit), ..data.into() };
    Finding::note(EXTRAPOLATED, first)
}
