//! Wanted operation inside and outside what the sections cover.

use serde::Serialize;

use super::{FigureView, Finding};
use crate::report::number;
use crate::result::{Certification, DomainResult, WantedPoint};

/// Digits of a distance, which is a share of ranges.
const DISTANCE: usize = 3;
/// Digits of a value in its unit.
const VALUE: usize = 4;

/// One domain and group of sections.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ApplicationView {
    /// `Application domain: State laden`.
    pub title: String,
    /// What the hull is of, or why there is none.
    pub says: String,
    pub clause: Option<String>,
    pub source: Option<String>,
    pub notes: Vec<String>,
    pub coordinates: Vec<CoordinateHead>,
    pub figure: Option<FigureView>,
    pub rows: Vec<PointRow>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CoordinateHead {
    pub name: String,
    pub unit: String,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PointRow {
    /// As in the figure, from 1.
    pub number: usize,
    pub point: String,
    pub finding: Finding,
    /// One text for each coordinate.
    pub values: Vec<String>,
    /// From the nearest point covered, one for each coordinate; a dash where it is 0.
    pub away: Vec<String>,
    pub distance: String,
    pub section: String,
}

pub(super) fn views(found: &Certification) -> Vec<ApplicationView> {
    found.application.iter().enumerate().map(view).collect()
}

fn view((at, result): (usize, &DomainResult)) -> ApplicationView {
    let title = if result.group.is_empty() {
        result.title.clone()
    } else {
        format!("{}: {}", result.title, result.scope)
    };
    let outside = result.points.iter().filter(|point| point.inside == Some(false)).count();
    let corners = result.sections.iter().filter(|section| section.corner).count();
    let counted = match (&result.reason, result.points.len()) {
        (Some(reason), _) => format!("Nothing can be said of wanted operation here: {reason}."),
        (None, 0) => {
            format!(
                "{} sections span the domain, {corners} of them as corners; no operation is wanted here.",
                result.sections.len()
            )
        }
        (None, all) => format!(
            "{} sections span the domain, {corners} of them as corners. {outside} of {all} points of wanted operation lie outside.",
            result.sections.len()
        ),
    };
    let left_out = match result.left_out.as_slice() {
        [] => String::new(),
        names => format!(" Sections without a value: {}.", names.join(", ")),
    };
    ApplicationView {
        says: number::formula(&format!("{counted}{left_out}")),
        clause: result.clause.clone(),
        source: result.source.clone(),
        notes: result.notes.iter().map(|note| number::raised(note)).collect(),
        coordinates: result.coordinates.iter().map(|of| CoordinateHead { name: of.name.clone(), unit: number::unit(&of.unit) }).collect(),
        figure: drawn(result).then(|| FigureView {
            name: format!("application-{at}"),
            caption: format!(
                "{title}: sections and wanted operation, two coordinates at a time, numbered as in the table. The line is the outline of the sections seen from this \
                 side; a point inside every outline may still lie outside the hull, and is then marked so."
            ),
            alt: "Sections and points of wanted operation; the numbers are in the table below.".into(),
        }),
        rows: result.points.iter().enumerate().map(|(at, point)| row(result, at + 1, point)).collect(),
        title,
    }
}

/// Whether there is a figure: two coordinates or more, and something to show in them.
pub fn drawn(result: &DomainResult) -> bool {
    result.coordinates.len() > 1 && !(result.sections.is_empty() && result.points.is_empty())
}

fn row(result: &DomainResult, nth: usize, point: &WantedPoint) -> PointRow {
    let none = || vec![number::NONE.to_owned(); result.coordinates.len()];
    let by = |(by, of): (&f64, &crate::result::CoordinateRange)| {
        let range = of.high.zip(of.low).map_or(0.0, |(high, low)| high - low);
        // Rounding of the nearest point.
        if by.abs() <= 1e-9 * range {
            return number::NONE.to_owned();
        }
        format!("{}{}", if *by > 0.0 { "+" } else { "" }, number::significant(*by, DISTANCE))
    };
    PointRow {
        number: nth,
        point: point.point.clone(),
        finding: Finding::new(point.inside, "inside", "outside", "not assessed"),
        values: point.values.iter().map(|value| number::significant(*value, VALUE)).collect(),
        away: point
            .outside_by
            .as_ref()
            .map_or_else(none, |all| all.iter().zip(&result.coordinates).map(by).collect()),
        distance: point.distance.map_or_else(
            || number::NONE.to_owned(),
            |distance| number::significant(distance, DISTANCE),
        ),
        section: point.nearest_section.clone().unwrap_or_else(|| number::NONE.to_owned()),
    }
}
