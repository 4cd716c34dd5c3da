//! Wanted operation inside and outside what the sections cover.

use crate::report::{document::*, figure, number};
use crate::result::{CoordinateRange, DomainResult, WantedPoint};

/// Digits of a distance, which is a share of ranges.
const DISTANCE: usize = 3;
/// Digits of a value in its unit.
const VALUE: usize = 4;

/// One domain and group of sections.
pub fn blocks((at, result): (usize, &DomainResult)) -> Vec<Block> {
    let title = if result.scope == "all" {
        result.title.clone()
    } else {
        format!("{}: {}", result.title, result.scope)
    };
    let mut says = says(result);
    for (name, text) in [("Clause", &result.clause), ("Source", &result.source)] {
        if let Some(text) = text {
            says.push_str(&format!(" {name}: {text}."));
        }
    }
    let mut blocks = vec![Block::heading(&title), Block::text(says)];
    blocks.extend(result.notes.iter().map(|note| Block::text(number::raised(note))));
    if figure::has_application(result) {
        let caption = format!(
            "{title}: sections and wanted operation, two coordinates at a time, numbered as in the table. The line is the outline of the sections seen from this \
             side; a point inside every outline may still lie outside the hull, and is then marked so."
        );
        let alt = "Sections and points of wanted operation; the numbers are in the table below.";
        blocks.push(Figure::new(format!("application-{at}"), caption, alt, 200).into());
    }
    if !result.points.is_empty() {
        blocks.push(table(result).into());
    }
    blocks
}

/// What the hull is of, or why there is none.
fn says(result: &DomainResult) -> String {
    let outside = result.points.iter().filter(|point| point.inside == Some(false)).count();
    let corners = result.sections.iter().filter(|section| section.corner).count();
    let counted = match (&result.reason, result.points.len()) {
        (Some(reason), _) => {
            format!("Nothing can be said of wanted operation here: {}.", reason.text())
        }
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
    number::formula(format!("{counted}{left_out}"))
}

fn table(result: &DomainResult) -> Table {
    let rows = result.points.iter().enumerate().map(|(at, point)| row(result, at + 1, point));
    let caption = "Wanted operation: values, and how far each lies from the nearest point that the sections cover. The distance is in ranges of the sections.";
    Table::new(caption)
        .number("No.")
        .names_row(false)
        .text("Point")
        .wide(1.5)
        .names_row(true)
        .short("Result")
        .each(&result.coordinates, |table, one| {
            table.number(&one.name).wide(1.0).unit(&one.unit).number("away").wide(1.0)
        })
        .number("Distance")
        .short("Nearest section")
        .rows(rows)
        .size(8.0)
}

fn row(result: &DomainResult, nth: usize, point: &WantedPoint) -> Vec<Cell> {
    let by = |by: f64, coordinate: &CoordinateRange| {
        let range = coordinate.high.zip(coordinate.low).map_or(0.0, |(high, low)| high - low);
        // Rounding of the nearest point.
        let known = Some(by).filter(|by| by.abs() > 1e-9 * range);
        Cell::number(known, Format::Change(DISTANCE))
    };
    let finding = Finding::new(point.inside, "inside", "outside", "not assessed");
    let mut cells = cells![nth, Cell::from(&point.point).strong(), finding];
    for (at, coordinate) in result.coordinates.iter().enumerate() {
        let value = point.values.get(at).copied();
        let away = point.outside_by.as_ref().and_then(|all| all.get(at));
        cells.push(Cell::number(value, Format::Significant(VALUE)));
        cells.push(away.map_or(Cell::MISSING, |away| by(*away, coordinate)));
    }
    cells.push(Cell::number(point.distance, Format::Significant(DISTANCE)));
    cells.push(Cell::or_missing(point.nearest_section.as_ref()));
    cells
}
