//! Estimates from the rows of a group.

use std::collections::{BTreeSet, HashSet};

use indexmap::IndexMap;

use super::groups::Group;
use super::table::{Member, independent};
use crate::catalog::Statistic;
use crate::check::evaluate::{flag, number, words};
use crate::check::plan::{
    DataReducer, DatumKind, Estimate, EstimateKind, Expr, Fit, Key, Kind, OfGroup, Operator,
    Taking, Type,
};
use crate::metrics::cluster::{self, Bounds, Draws, Mean, StandardDeviation};
use crate::metrics::percentile::{Method, percentile};
use crate::metrics::regression::{self, Regression, Tails};
use crate::metrics::weighted;
use crate::result::{
    Reason, RegressionAt, RegressionFigure, RegressionPoint, Subject, VehicleValue,
};
use crate::run::sections::{Known, Unit, Vehicle};
use crate::units;

impl Group<'_> {
    pub fn values(&self) -> Vec<f64> {
        self.members.iter().map(|member| member.row.value).collect()
    }

    /// The index of the independent unit of each row.
    pub fn units(&self) -> Vec<usize> {
        independent(self.plan, self.members)
    }

    fn sections(&self) -> Vec<&Unit> {
        let mut seen = HashSet::new();
        self.members
            .iter()
            .map(|member| member.unit)
            .filter(|unit| seen.insert(unit.name.as_str()))
            .collect()
    }

    /// The value of an expression over the group, SI.
    ///
    /// # Errors
    /// What cannot be estimated from these rows, and why.
    pub fn number(&self, of: &OfGroup) -> Result<f64, Reason> {
        let values = self.values();
        self.over(of, &values)
    }

    /// The numbers that an expression takes from the group, in order.
    pub fn taken(&self, of: &OfGroup) -> Vec<Result<f64, Reason>> {
        let values = self.values();
        of.taken.iter().map(|taking| self.take(taking, &values)).collect()
    }

    /// As [`Self::number`], with other values in place of those of the rows.
    fn over(&self, of: &OfGroup, values: &[f64]) -> Result<f64, Reason> {
        let taken: Vec<Result<f64, Reason>> =
            of.taken.iter().map(|taking| self.take(taking, values)).collect();
        let of_vehicle = |vehicle: &Vehicle| {
            number(&of.expr, &Known { inputs: &taken, ..Known::vehicle(vehicle) })
        };
        self.facts.agreed(self.members, of_vehicle, |value| VehicleValue::Si { value })
    }

    fn take(&self, taking: &Taking, values: &[f64]) -> Result<f64, Reason> {
        match taking {
            Taking::Statistic(statistic, ddof) => statistic_of(*statistic, *ddof, values),
            Taking::Count => Ok(self.units().into_iter().collect::<BTreeSet<_>>().len() as f64),
            Taking::Weighted { statistic, ddof, by } => weighted_statistic(
                *statistic,
                *ddof,
                values,
                &self.weights(by, self.units_of_rows())?,
            ),
            Taking::EachGroup { reducer, keys, of } => {
                self.of_each_group(*reducer, keys, of, values)
            }
            Taking::Where { share: false, condition, of_sections, others, .. } => {
                let holds = self.holding(condition, *of_sections, others, values)?;
                Ok(holds.into_iter().filter(|holds| *holds).count() as f64)
            }
            Taking::Where { share: true, condition, of_sections, others, by } => {
                let holds = self.holding(condition, *of_sections, others, values)?;
                let weights = by.as_ref().map(|by| match of_sections {
                    true => self.weights(by, self.sections().into_iter()),
                    false => self.weights(by, self.units_of_rows()),
                });
                share(holds.into_iter().map(Ok), weights)
            }
            Taking::Other { quantity, id, statistic, ddof } => {
                let rows = self.table.get(*quantity);
                let rows = rows.ok_or_else(|| Reason::NoRowsOf { quantity: id.clone() })?;
                let found = rows.clone().and_then(|rows| {
                    let values: Vec<f64> = rows.iter().map(|member| member.row.value).collect();
                    statistic_of(*statistic, *ddof, &values)
                });
                found.map_err(|reason| {
                    reason.about(Subject::Statistic, format!("{} of {id}", statistic.name()))
                })
            }
            Taking::Data { reducer, of, of_rows: true, by } => {
                let data = self.data_of_rows(of, values)?;
                let weights = by.as_ref().map(|by| self.weights(by, self.units_of_rows()));
                of_weighted(*reducer, &data, weights.transpose()?)
            }
            Taking::Data { reducer, of, of_rows: false, by } => {
                let sections = || self.sections().into_iter();
                let data = self.data(of, sections())?;
                let weights = by.as_ref().map(|by| self.weights(by, sections()));
                of_weighted(*reducer, &data, weights.transpose()?)
            }
            Taking::Bound { of, upper, confidence, bootstrap } => {
                self.bound(of, *upper, *confidence, *bootstrap, values)
            }
            Taking::Fit(fit) => self.fit(fit, values),
        }
    }

    /// Whether a condition holds, for each section or for each row.
    fn holding(
        &self,
        condition: &Expr,
        of_sections: bool,
        others: &[Taking],
        values: &[f64],
    ) -> Result<Vec<bool>, Reason> {
        if of_sections {
            let sections = self.sections();
            return sections.iter().map(|unit| flag(condition, &unit.known(self.facts))).collect();
        }
        let others: Vec<Result<f64, Reason>> =
            others.iter().map(|other| self.take(other, values)).collect();
        let of_row = |(member, value): (&Member<'_>, &f64)| {
            let inputs: Vec<Result<f64, Reason>> =
                [Ok(*value)].into_iter().chain(others.iter().cloned()).collect();
            flag(condition, &self.known_of_row(member, &inputs))
        };
        self.members.iter().zip(values).map(of_row).collect()
    }

    /// What names stand for in one row, whose value is the first input.
    fn known_of_row<'k>(
        &'k self,
        member: &'k Member<'_>,
        inputs: &'k [Result<f64, Reason>],
    ) -> Known<'k> {
        let sides = member.row.simulated.zip(member.row.measured);
        Known { inputs, sides, ..member.unit.known(self.facts) }
    }

    /// A number of each row.
    fn data_of_rows(&self, of: &Expr, values: &[f64]) -> Result<Vec<f64>, Reason> {
        let of_row = |(member, value): (&Member<'_>, &f64)| {
            number(of, &self.known_of_row(member, &[Ok(*value)]))
                .map_err(|reason| reason.about(Subject::Section, &member.unit.name))
        };
        self.members.iter().zip(values).map(of_row).collect()
    }

    fn units_of_rows(&self) -> impl Iterator<Item = &Unit> + Clone {
        self.members.iter().map(|member| member.unit)
    }

    /// A number of each section.
    fn data<'u>(
        &self,
        of: &Expr,
        units: impl Iterator<Item = &'u Unit>,
    ) -> Result<Vec<f64>, Reason> {
        units
            .map(|unit| {
                number(of, &unit.known(self.facts))
                    .map_err(|reason| reason.about(Subject::Section, &unit.name))
            })
            .collect()
    }

    /// Weights are not negative.
    fn weights<'u>(
        &self,
        by: &Expr,
        units: impl Iterator<Item = &'u Unit> + Clone,
    ) -> Result<Vec<f64>, Reason> {
        let weights = self.data(by, units.clone())?;
        match units.zip(&weights).find(|(_, weight)| **weight < 0.0) {
            Some((unit, _)) => {
                Err(Reason::NegativeWeight { weight: words(by) }
                    .about(Subject::Section, &unit.name))
            }
            None => Ok(weights),
        }
    }

    /// The groups that the rows form by some keys: what each is called, and the numbers of its
    /// rows.
    pub fn groups(&self, keys: &[Key]) -> IndexMap<String, Vec<usize>> {
        let mut groups: IndexMap<String, Vec<usize>> = IndexMap::new();
        for (row, member) in self.members.iter().enumerate() {
            let named = |key: &Key| {
                let (key, member) = self.of_key(key, member);
                format!("{key} {member}")
            };
            let name: Vec<String> = keys.iter().map(named).collect();
            groups.entry(name.join(", ")).or_default().push(row);
        }
        groups
    }

    fn of_each_group(
        &self,
        reducer: DataReducer,
        keys: &[Key],
        of: &OfGroup,
        values: &[f64],
    ) -> Result<f64, Reason> {
        let one = |(name, rows): (String, Vec<usize>)| {
            self.over_rows(of, &rows, values).map_err(|reason| reason.about(Subject::Group, name))
        };
        let numbers =
            self.groups(keys).into_iter().map(one).collect::<Result<Vec<f64>, Reason>>()?;
        reduced(reducer, &numbers).map_err(|reason| match reason {
            Reason::Undefined { count, .. } => Reason::Undefined { count, groups: true },
            other => other,
        })
    }

    /// An end of the one-sided confidence interval of an estimate: in closed form for a mean or a
    /// standard deviation with divisor n-1, else by a bootstrap of the independent units.
    fn bound(
        &self,
        of: &Estimate,
        upper: bool,
        confidence: f64,
        bootstrap: bool,
        values: &[f64],
    ) -> Result<f64, Reason> {
        let EstimateKind::Of(of_group) = &of.kind else {
            return Err(Reason::NoInterval);
        };
        some_scatter(values)?;
        let units = self.units();
        let probability = if upper { confidence } else { 1.0 - confidence };
        let named = |statistic: Statistic, name: &str| match statistic {
            Statistic::Named(entry) => !bootstrap && entry.name == name,
            _ => false,
        };
        if let Some((statistic, _, by)) = of.weighted()
            && named(statistic, "mean")
        {
            let weights = self.weights(by, self.units_of_rows())?;
            let rows: Vec<(f64, f64)> = values.iter().copied().zip(weights).collect();
            let found = cluster::by_site(&rows, &units)
                .and_then(|sites| cluster::weighted_mean(&sites)?.bound(probability));
            return found.map_err(Reason::method);
        }
        let sites = || cluster::by_site(values, &units);
        let found = match (of.statistic(), of_group.alone()) {
            (Some((statistic, _)), _) if named(statistic, "mean") => {
                sites().and_then(|sites| Mean::of(&sites)?.bound(probability))
            }
            (Some((statistic, 1)), _) if named(statistic, "std") => {
                sites().and_then(|sites| StandardDeviation::of(&sites)?.bound(probability))
            }
            // A statistic alone depends on the values only, and the draws are many.
            (_, Some(Taking::Statistic(statistic, ddof))) => sites().and_then(|sites| {
                let estimate = |values: &[f64]| statistic_of(*statistic, *ddof, values).ok();
                cluster::bootstrap(&sites, &*Draws::usual(sites.len())?, estimate)?
                    .bound(probability)
            }),
            _ => {
                let rows: Vec<usize> = (0..values.len()).collect();
                cluster::by_site(&rows, &units).and_then(|sites| {
                    let estimate = |rows: &[usize]| self.over_rows(of_group, rows, values).ok();
                    cluster::bootstrap(&sites, &*Draws::usual(sites.len())?, estimate)?
                        .bound(probability)
                })
            }
        };
        found.map_err(Reason::method)
    }

    /// As [`Self::over`], for some of the rows and of their values.
    fn over_rows(&self, of: &OfGroup, rows: &[usize], values: &[f64]) -> Result<f64, Reason> {
        let members: Vec<Member<'_>> = rows.iter().map(|&row| self.members[row]).collect();
        let values: Vec<f64> = rows.iter().map(|&row| values[row]).collect();
        self.with(&members).over(of, &values)
    }

    fn fit(&self, fit: &Fit, values: &[f64]) -> Result<f64, Reason> {
        let Fitted { regression, at, .. } = self.fitted(fit, values)?;
        match fit.confidence {
            None => regression.at(&at).map_err(Reason::method),
            Some(confidence) => {
                some_scatter(values)?;
                bound_at(&regression, fit, confidence, &at)
            }
        }
    }

    pub fn fitted(&self, fit: &Fit, values: &[f64]) -> Result<Fitted, Reason> {
        let regressors = fit
            .over
            .iter()
            .map(|regressor| self.data(regressor, self.units_of_rows()))
            .collect::<Result<Vec<_>, _>>()?;
        let at =
            fit.at.iter().map(|target| self.over(target, values)).collect::<Result<Vec<_>, _>>()?;
        let regression = Regression::fit(values, &regressors).map_err(Reason::method)?;
        Ok(Fitted { regression, regressors, at })
    }

    /// The bound of a share of the values: X of `share where value <= X`, in SI. `None` of other
    /// estimates, and of a bound that differs from section to section.
    pub fn divided_at(&self, of: &OfGroup) -> Option<f64> {
        let Taking::Where { share: true, condition, of_sections: false, others, by: None } =
            of.alone()?
        else {
            return None;
        };
        let Kind::Binary(operator, left, right) = &condition.kind else { return None };
        let compares = matches!(
            operator,
            Operator::Less | Operator::LessEqual | Operator::Greater | Operator::GreaterEqual
        );
        if !compares || !matches!(left.kind, Kind::Input(0)) {
            return None;
        }
        let values = self.values();
        // The bound of a share is the same for all values.
        let value = Err(Reason::Internal);
        let inputs: Vec<Result<f64, Reason>> = [value]
            .into_iter()
            .chain(others.iter().map(|other| self.take(other, &values)))
            .collect();
        let of_vehicle = |vehicle: &Vehicle| {
            number(right, &Known { inputs: &inputs, ..Known::vehicle(vehicle) })
        };
        self.facts.agreed(self.members, of_vehicle, |value| VehicleValue::Si { value }).ok()
    }

    /// The diagram of a regression with one regressor, in the unit of the quantity; `None` for
    /// other estimates and where there is no value.
    pub fn figure(&self, of: &OfGroup, unit: &units::Unit) -> Option<RegressionFigure> {
        let Taking::Fit(fit) = of.alone()? else { return None };
        let [over] = fit.over.as_slice() else { return None };
        let values = self.values();
        let Fitted { regression, regressors, at } = self.fitted(fit, &values).ok()?;
        let (xs, target) = (regressors.first()?, *at.first()?);
        let x_unit = self.unit_of(over);
        let (low, high) =
            xs.iter().fold((target, target), |(low, high), x| (low.min(*x), high.max(*x)));
        let at_place = |step: usize| {
            let x = low + (high - low) * step as f64 / STEPS as f64;
            let bound = fit
                .confidence
                .and_then(|confidence| bound_at(&regression, fit, confidence, &[x]).ok());
            Some(RegressionAt {
                x: x_unit.from_si(x),
                fitted: unit.from_si(regression.at(&[x]).ok()?),
                bound: bound.map(|y| unit.from_si(y)),
            })
        };
        let point = |(member, x): (&Member<'_>, &f64)| RegressionPoint {
            section: member.unit.name.clone(),
            zone: member.unit.zone.clone(),
            signal: member.signal.to_string(),
            x: x_unit.from_si(*x),
            y: unit.from_si(member.row.value),
        };
        let [intercept, slope] = regression.coefficients()[..] else { return None };
        let kind = if fit.prediction { "prediction bound" } else { "confidence bound of the mean" };
        Some(RegressionFigure {
            regressor: over.span.words.to_string(),
            points: self.members.iter().zip(xs).map(point).collect(),
            intercept: unit.from_si(intercept),
            slope: unit.from_si(x_unit.to_si(slope)),
            curve: (0..=STEPS).map(at_place).collect::<Option<_>>()?,
            bound: fit
                .confidence
                .map(|confidence| format!("{} % {kind}", rounded(100.0 * confidence))),
            target: x_unit.from_si(target),
            value: unit.from_si(self.fit(fit, &values).ok()?),
            regressor_unit: x_unit.text,
        })
    }
}

impl Group<'_> {
    /// In which a regressor is printed.
    pub fn unit_of(&self, regressor: &Expr) -> units::Unit {
        match (&regressor.kind, &regressor.ty) {
            (Kind::Column(index), _)
                if let DatumKind::Number(unit) = &self.plan.columns[*index].kind =>
            {
                unit.clone()
            }
            (_, Type::Number(dimension)) => units::Unit::si(*dimension),
            _ => units::Unit::one(),
        }
    }
}

/// Number of pieces of a regression curve in a diagram. A hyperbola then looks smooth at a few
/// centimetres.
const STEPS: usize = 32;

/// A regression with the numbers it was fitted to and the point at which it is evaluated.
pub struct Fitted {
    regression: Regression,
    pub regressors: Vec<Vec<f64>>,
    pub at: Vec<f64>,
}

fn bound_at(
    regression: &Regression,
    fit: &Fit,
    confidence: f64,
    at: &[f64],
) -> Result<f64, Reason> {
    let kind = if fit.prediction { regression::Kind::Prediction } else { regression::Kind::Mean };
    let side = if fit.lower { regression::Side::Lower } else { regression::Side::Upper };
    let tails = if fit.one_sided { Tails::One } else { Tails::Two };
    regression.bound(at, kind, side, tails, confidence).map_err(Reason::method)
}

/// Values that are all equal have no scatter from which an interval could follow: one of width zero
/// would claim certainty.
fn some_scatter(values: &[f64]) -> Result<(), Reason> {
    match values {
        [first, rest @ ..] if !rest.is_empty() && rest.iter().all(|value| value == first) => {
            Err(Reason::AllEqual { count: values.len() })
        }
        _ => Ok(()),
    }
}

/// A percentage without rounding errors of its conversion from a share: 99.9, not
/// 99.90000000000001.
fn rounded(percent: f64) -> f64 {
    (percent * 1e9).round() / 1e9
}

/// The statistic of the values, with divisor n - `ddof`.
///
/// # Errors
/// It is not defined for so few values.
pub fn statistic_of(statistic: Statistic, ddof: usize, values: &[f64]) -> Result<f64, Reason> {
    let found = match statistic {
        Statistic::Percentile(percent) => percentile(values, percent, Method::Linear).ok(),
        Statistic::Named(entry) => (entry.run)(values, ddof),
        Statistic::Each => None,
    };
    found
        .filter(|value| value.is_finite())
        .ok_or(Reason::Undefined { count: values.len(), groups: false })
}

/// Of numbers of sections or of groups.
fn reduced(reducer: DataReducer, numbers: &[f64]) -> Result<f64, Reason> {
    match reducer {
        DataReducer::Total => Ok(numbers.iter().sum()),
        DataReducer::Statistic(statistic, ddof) => statistic_of(statistic, ddof, numbers),
    }
}

/// One number of many, which count by weights where there are any.
fn of_weighted(
    reducer: DataReducer,
    data: &[f64],
    weights: Option<Vec<f64>>,
) -> Result<f64, Reason> {
    match (reducer, weights) {
        (DataReducer::Statistic(statistic, ddof), Some(weights)) => {
            weighted_statistic(statistic, ddof, data, &weights)
        }
        _ => reduced(reducer, data),
    }
}

/// # Errors
/// No weight is above zero, or too few are.
fn weighted_statistic(
    statistic: Statistic,
    ddof: usize,
    values: &[f64],
    weights: &[f64],
) -> Result<f64, Reason> {
    let counting = weights.iter().filter(|weight| **weight > 0.0).count();
    if counting == 0 {
        return Err(Reason::NoPositiveWeight);
    }
    let found = match statistic {
        Statistic::Percentile(percent) => weighted::percentile(values, weights, percent),
        Statistic::Named(entry) => match entry.name {
            "mean" => weighted::mean(values, weights),
            "std" => weighted::standard_deviation(values, weights, ddof),
            "rms" => weighted::rms(values, weights),
            "median" => weighted::percentile(values, weights, 50.0),
            _ => None,
        },
        Statistic::Each => None,
    };
    found.ok_or(Reason::UndefinedWeighted { count: counting })
}

fn share(
    found: impl Iterator<Item = Result<bool, Reason>>,
    weights: Option<Result<Vec<f64>, Reason>>,
) -> Result<f64, Reason> {
    let found = found.collect::<Result<Vec<bool>, _>>()?;
    if found.is_empty() {
        return Err(Reason::EmptyShare);
    }
    if let Some(weights) = weights {
        let holds: Vec<f64> = found.iter().map(|holds| if *holds { 1.0 } else { 0.0 }).collect();
        return weighted::mean(&holds, &weights?).ok_or(Reason::NoPositiveWeight);
    }
    Ok(found.iter().filter(|holds| **holds).count() as f64 / found.len() as f64)
}
