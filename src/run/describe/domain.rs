//! The validity domain: the range of each section column over the sections used, and wanted
//! operation against their hull.

use indexmap::IndexMap;

use crate::metrics::{
    hull::{self, Nearest},
    statistics::ends,
};
use crate::result::{
    Beyond, Consequence, CoordinateRange, DomainRange, DomainResult, DomainSection, Scope,
    WantedPoint,
};
use crate::run::{
    limit::rule_place,
    prelude::*,
    sections::{
        Facts, Unit,
        wanted::{Point, value, word},
    },
};

/// Code of the finding about wanted operation outside what the sections cover.
const OUTSIDE: &str = "outside-domain";
/// Code of the finding about sections that span no domain.
const WITHOUT_HULL: &str = "no-domain";

pub fn domain(plan: &Plan, units: &[Unit]) -> Vec<DomainRange> {
    let mut scopes = vec![Scope::default()];
    scopes.extend(plan.zones.iter().map(|zone| Scope::zone(&zone.name)));
    let mut found = Vec::new();
    for (index, datum) in plan.columns.iter().enumerate() {
        let DatumKind::Number(unit) = &datum.kind else { continue };
        for scope in &scopes {
            let inside = |section: &&Unit| {
                section.fault.is_none() && scope.has_zone(section.zone.as_deref())
            };
            let number = |section: &Unit| match section.columns[index] {
                Ok(Scalar::Number(value)) => Some(unit.from_si(value)),
                _ => None,
            };
            let values: Vec<f64> = units.iter().filter(inside).filter_map(number).collect();
            let (low, high) = ends(values.iter().copied());
            if !values.is_empty() {
                found.push(DomainRange {
                    name: datum.title.clone(),
                    unit: unit.text.clone(),
                    scope: scope.clone(),
                    low,
                    high,
                    count: values.len(),
                });
            }
        }
    }
    found
}

/// One result for each domain and group of sections, in the order of the sections, then of wanted
/// operation.
pub fn compared(
    plan: &Plan,
    facts: &Facts,
    units: &[Unit],
    wanted: &[Vec<Point>],
) -> Vec<DomainResult> {
    plan.domains
        .iter()
        .zip(wanted)
        .flat_map(|(domain, points)| groups(plan, domain, facts, units, points))
        .collect()
}

/// Sections of a group, with their values in SI, and those without.
#[derive(Default)]
struct Covered<'a> {
    sections: Vec<(&'a str, Vec<f64>)>,
    left_out: Vec<String>,
    points: Vec<&'a Point>,
}

fn groups(
    plan: &Plan,
    domain: &Domain,
    facts: &Facts,
    units: &[Unit],
    points: &[Point],
) -> Vec<DomainResult> {
    let mut groups: IndexMap<Vec<String>, Covered<'_>> = IndexMap::new();
    for unit in units.iter().filter(|unit| unit.fault.is_none()) {
        // A section without the word belongs to no group.
        let Ok(group) = domain
            .each
            .iter()
            .map(|index| word(&unit.columns[*index]))
            .collect::<Result<Vec<_>, _>>()
        else {
            continue;
        };
        let covered = groups.entry(group).or_default();
        let known = unit.known(facts);
        match domain
            .over
            .iter()
            .map(|coordinate| value(&coordinate.expr, &coordinate.name, &known))
            .collect::<Result<_, _>>()
        {
            Ok(values) => covered.sections.push((&unit.name, values)),
            Err(_) => covered.left_out.push(unit.name.clone()),
        }
    }
    for point in points {
        groups.entry(point.group.clone()).or_default().points.push(point);
    }
    groups.into_iter().map(|(group, covered)| of_group(plan, domain, &group, &covered)).collect()
}

/// `State laden`; `all` where sections are not told apart.
fn in_words(plan: &Plan, domain: &Domain, group: &[String]) -> String {
    let one = |(index, word): (&usize, &String)| format!("{} {word}", plan.columns[*index].title);
    let words: Vec<String> = domain.each.iter().zip(group).map(one).collect();
    if words.is_empty() { "all".into() } else { words.join(", ") }
}

fn of_group(plan: &Plan, domain: &Domain, group: &[String], covered: &Covered<'_>) -> DomainResult {
    let scope = in_words(plan, domain, group);
    let scale = Scale::of(&covered.sections, domain.over.len());
    let scaled: Vec<Vec<f64>> =
        covered.sections.iter().map(|(_, values)| scale.scaled(values)).collect();
    let reason = without_hull(domain, &scope, &scaled, &scale);
    let corners = if reason.is_none() { hull::corners(&scaled) } else { vec![false; scaled.len()] };
    let shown = |values: &[f64]| -> Vec<f64> {
        values.iter().zip(&domain.over).map(|(value, of)| of.unit.from_si(*value)).collect()
    };
    let section = |((name, values), corner): (&(&str, Vec<f64>), bool)| DomainSection {
        section: (*name).into(),
        values: shown(values),
        corner,
    };
    let wanted = |point: &&Point| {
        let at = scale.scaled(&point.values);
        let found = if reason.is_none() { hull::nearest(&scaled, &at) } else { None };
        let inside = found.as_ref().map(Nearest::is_inside);
        let nearest = found.as_ref().map(|found| {
            if inside == Some(true) { point.values.clone() } else { scale.physical(&found.point) }
        });
        let away = |nearest: &Vec<f64>| {
            shown(
                &point
                    .values
                    .iter()
                    .zip(nearest)
                    .map(|(value, nearest)| value - nearest)
                    .collect::<Vec<_>>(),
            )
        };
        let to = |section: &Vec<f64>| {
            section.iter().zip(&at).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        let by_section = (0..scaled.len())
            .map(|index| (index, to(&scaled[index])))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        WantedPoint {
            point: point.name.clone(),
            values: shown(&point.values),
            inside,
            distance: found.map(|found| if inside == Some(true) { 0.0 } else { found.distance }),
            outside_by: nearest.as_ref().map(away),
            nearest: nearest.as_deref().map(shown),
            beyond_range: (!scaled.is_empty()).then(|| shown(&scale.beyond(&point.values))),
            nearest_section: by_section.map(|(index, _)| covered.sections[index].0.into()),
            section_distance: by_section.map(|(_, distance)| distance),
        }
    };
    let range = |(index, of): (usize, &Coordinate)| {
        let end = |values: &[f64]| (!scaled.is_empty()).then(|| of.unit.from_si(values[index]));
        CoordinateRange {
            name: of.name.clone(),
            unit: of.unit.text.clone(),
            low: end(&scale.low),
            high: end(&scale.high),
        }
    };
    DomainResult {
        domain: domain.name.clone(),
        title: domain.title.clone(),
        group: domain
            .each
            .iter()
            .zip(group)
            .map(|(index, word)| (plan.columns[*index].name.clone(), word.clone()))
            .collect(),
        scope,
        coordinates: domain.over.iter().enumerate().map(range).collect(),
        sections: covered.sections.iter().zip(corners).map(section).collect(),
        left_out: covered.left_out.clone(),
        points: covered.points.iter().map(wanted).collect(),
        reason,
        otherwise: if domain.otherwise == OnFault::NotAssessable {
            Consequence::NotAssessable
        } else {
            Consequence::Note
        },
        clause: domain.clause.clone(),
        source: domain.source.clone(),
        notes: domain.notes.clone(),
        rule: rule_place(&domain.span),
    }
}

/// Wanted operation as results have it.
///
/// # Errors
/// It does not fit the protocol, in words.
pub fn recorded(plan: &Plan, results: &[DomainResult]) -> Result<Vec<Vec<Point>>, String> {
    let of = |domain: &Domain| {
        let mut points = Vec::new();
        for result in results.iter().filter(|result| result.domain == domain.name) {
            let word = |index: &usize| result.group.get(&plan.columns[*index].name).cloned();
            let group = domain.each.iter().map(word).collect::<Option<Vec<_>>>();
            for point in &result.points {
                let values: Vec<f64> = point
                    .values
                    .iter()
                    .zip(&domain.over)
                    .map(|(value, of)| of.unit.to_si(*value))
                    .collect();
                match &group {
                    Some(group) if point.values.len() == domain.over.len() => {
                        points.push(Point {
                            name: point.point.clone(),
                            values,
                            group: group.clone(),
                        });
                    }
                    _ => {
                        return Err(format!(
                            "domain `{}`: `{}` does not fit the protocol",
                            domain.name, point.point
                        ));
                    }
                }
            }
        }
        Ok(points)
    };
    plan.domains.iter().map(of).collect()
}

/// Ranges of the coordinates over sections, SI.
struct Scale {
    low: Vec<f64>,
    high: Vec<f64>,
}

impl Scale {
    fn of(sections: &[(&str, Vec<f64>)], coordinates: usize) -> Self {
        let end = |start: f64, other: fn(f64, f64) -> f64| -> Vec<f64> {
            (0..coordinates)
                .map(|at| sections.iter().map(|(_, values)| values[at]).fold(start, other))
                .collect()
        };
        Self { low: end(f64::INFINITY, f64::min), high: end(f64::NEG_INFINITY, f64::max) }
    }

    /// A coordinate that does not vary keeps its size: nothing is divided by 0.
    fn range(&self, at: usize) -> f64 {
        let range = self.high[at] - self.low[at];
        if range > 0.0 && range.is_finite() { range } else { 1.0 }
    }

    fn scaled(&self, values: &[f64]) -> Vec<f64> {
        values
            .iter()
            .enumerate()
            .map(|(at, value)| (value - self.low[at]) / self.range(at))
            .collect()
    }

    fn physical(&self, scaled: &[f64]) -> Vec<f64> {
        scaled.iter().enumerate().map(|(at, value)| self.low[at] + value * self.range(at)).collect()
    }

    /// By how much values lie outside the ranges.
    fn beyond(&self, values: &[f64]) -> Vec<f64> {
        values
            .iter()
            .enumerate()
            .map(|(at, value)| (self.low[at] - value).max(value - self.high[at]).max(0.0))
            .collect()
    }
}

/// Why sections have no hull of as many dimensions as there are coordinates.
fn without_hull(
    domain: &Domain,
    group: &str,
    scaled: &[Vec<f64>],
    scale: &Scale,
) -> Option<Reason> {
    let coordinates = domain.over.len();
    if scaled.is_empty() {
        let group = (!domain.each.is_empty()).then(|| group.to_owned());
        return Some(Reason::NoSectionUsed { group });
    }
    if scaled.len() <= coordinates {
        return Some(Reason::TooFewForHull { sections: scaled.len(), coordinates });
    }
    let extends = hull::dimensions(scaled);
    if extends == coordinates {
        return None;
    }
    let same = domain
        .over
        .iter()
        .enumerate()
        .filter(|(at, _)| scale.low[*at] == scale.high[*at])
        .map(|(_, of)| of.name.clone())
        .collect();
    Some(Reason::FlatHull { extends, coordinates, same })
}

/// A finding for each point of wanted operation outside, and for each group with such points and
/// without a hull.
pub fn findings(results: &[DomainResult]) -> Vec<Finding> {
    results
        .iter()
        .flat_map(|result| {
            result.reason.as_ref().map_or_else(|| outside(result), |reason| no_hull(result, reason))
        })
        .collect()
}

fn no_hull(result: &DomainResult, reason: &Reason) -> Vec<Finding> {
    if result.points.is_empty() {
        return Vec::new();
    }
    let (title, scope, reason) = (result.title.clone(), scope(result), reason.clone());
    let data = FindingData::NoDomain { title, scope, reason, points: result.points.len() };
    vec![Finding { consequence: result.otherwise, ..Finding::note(WITHOUT_HULL, data) }]
}

fn outside(result: &DomainResult) -> Vec<Finding> {
    let finding = |point: &WantedPoint| {
        let by = point
            .outside_by
            .iter()
            .flatten()
            .zip(&result.coordinates)
            .filter(|(by, _)| by.abs() > 0.0);
        let far = |(by, of): (&f64, &CoordinateRange)| {
            // What is left of a coordinate in which the nearest point is the same is rounding.
            let range = of.high.zip(of.low).map_or(0.0, |(high, low)| high - low);
            (by.abs() > hull::INSIDE * range).then(|| Beyond {
                name: of.name.to_lowercase(),
                by: *by,
                unit: of.unit.clone(),
            })
        };
        let data = FindingData::OutsideDomain {
            title: result.title.clone(),
            scope: scope(result),
            point: point.point.clone(),
            distance: point.distance,
            by: by.filter_map(far).collect(),
            nearest: point.nearest_section.clone(),
        };
        let first =
            Occurrence { value: point.distance, expected: Some(0.0), ..Occurrence::from(data) };
        Finding { consequence: result.otherwise, ..Finding::note(OUTSIDE, first) }
    };
    result.points.iter().filter(|point| point.inside == Some(false)).map(finding).collect()
}

/// Why the campaign is not assessable: for each group, as far as the protocol says so.
pub fn barred(results: &[DomainResult]) -> Vec<Reason> {
    let reason = |result: &DomainResult| {
        let outside = result.points.iter().filter(|point| point.inside == Some(false)).count();
        let reason = match &result.reason {
            _ if result.otherwise != Consequence::NotAssessable || result.points.is_empty() => {
                return None;
            }
            Some(reason) => reason.clone(),
            None if outside == 0 => return None,
            None => Reason::PointsOutside { outside, points: result.points.len() },
        };
        let (title, scope, reason) = (result.title.clone(), scope(result), Box::new(reason));
        Some(Reason::OfEstimate { title, scope, reason })
    };
    results.iter().filter_map(reason).collect()
}

/// The group, where sections are told apart.
fn scope(result: &DomainResult) -> Option<String> {
    (!result.group.is_empty()).then(|| result.scope.clone())
}
