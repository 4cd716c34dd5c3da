//! Regressions that are read outside the data that they were fitted to.

use super::estimates::Group;
use super::table::Member;
use crate::check::plan::{EstimateKind, Expr, Fit, OfGroup, Taking};
use crate::metrics::rounded;
use crate::result::{Finding, Outside, QuantityResult};

/// Code of the finding about regressions that are read outside their data.
const EXTRAPOLATED: &str = "extrapolated";

/// Beyond the data by less than this share of their range is rounding: a target such as `mean of speed` is computed from them.
const ROUNDING: f64 = 1e-9;

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
                    let members: Vec<Member<'_>> = rows.iter().map(|&row| self.members[row]).collect();
                    Group { members: &members, ..*self }.outside(of)
                };
                self.groups(keys).into_values().flat_map(group).collect()
            }
            Taking::Statistic(..)
            | Taking::Weighted { .. }
            | Taking::Count
            | Taking::Share { .. }
            | Taking::Other { .. }
            | Taking::Data { .. } => Vec::new(),
        };
        of.taken.iter().flat_map(one).collect()
    }

    fn outside_of(&self, fit: &Fit) -> Vec<Outside> {
        let Ok(fitted) = self.fitted(fit, &self.values()) else { return Vec::new() };
        let one = |(over, (data, target)): (&Expr, (&Vec<f64>, &f64))| {
            let (low, high) = data.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
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

/// One finding for each quantity, estimate, target and range of data, with the groups in which it is so.
pub fn findings(quantities: &[QuantityResult]) -> Vec<Finding> {
    let mut all = Vec::new();
    for quantity in quantities {
        let mut found: Vec<(&str, &Outside, Vec<&str>)> = Vec::new();
        for statistic in &quantity.statistics {
            for outside in &statistic.outside {
                let title = statistic.title.as_str();
                match found.iter_mut().find(|(known, of, _)| *known == title && *of == outside) {
                    Some((.., groups)) if groups.last() == Some(&statistic.scope.as_str()) => {}
                    Some((.., groups)) => groups.push(&statistic.scope),
                    None => found.push((title, outside, vec![&statistic.scope])),
                }
            }
        }
        all.extend(found.into_iter().map(|(title, outside, groups)| finding(&quantity.id, title, outside, &groups)));
    }
    all
}

fn finding(quantity: &str, title: &str, outside: &Outside, groups: &[&str]) -> Finding {
    let Outside { regressor, unit, target, low, high } = outside;
    let suffix = if unit == "-" { String::new() } else { format!(" {unit}") };
    let (beyond, side, edge) = if target < low { (low - target, "below", *low) } else { (target - high, "above", *high) };
    let share = 100.0 * beyond / (high - low);
    let of_groups = if groups == ["all"] { String::new() } else { format!(" ({})", groups.join("; ")) };
    let says = format!(
        "{quantity}: {title} is read at {regressor} = {}{suffix}, {}{suffix} {side} the data, which reach from {} to {}{suffix}; that is {share:.0} % of their range{of_groups}",
        rounded(*target),
        rounded(beyond),
        rounded(*low),
        rounded(*high)
    );
    Finding { value: Some(*target), expected: Some(edge), unit: Some(unit.clone()), ..Finding::note(EXTRAPOLATED, says) }
}
