//! Sections as points with the outline of their hull, and wanted operation inside and outside; two
//! coordinates in each diagram.

use super::kit::*;
use crate::result::{CoordinateRange, DomainResult};

/// Most pairs of coordinates drawn: those of the first four.
const MOST: usize = 6;
/// Height of a diagram and of its axis below, in points.
const TALL: f64 = 165.0;
const FOOT: f64 = 32.0;
const GUTTER: f64 = 20.0;
/// Points of wanted operation have their number in the table beside their marks, up to this number
/// of points.
const NUMBERED: usize = 30;

/// Whether there is a figure: two coordinates or more, and something to show in them.
pub fn has_application(result: &DomainResult) -> bool {
    result.coordinates.len() > 1 && !(result.sections.is_empty() && result.points.is_empty())
}

/// A diagram for each of the first pairs of coordinates.
pub fn application(result: &DomainResult) -> String {
    let count = result.coordinates.len();
    let pairs: Vec<(usize, usize)> =
        (0..count).flat_map(|x| (x + 1..count).map(move |y| (x, y))).take(MOST).collect();
    let mut entries = vec![Entry::mark(SECTION, "section")];
    if result.reason.is_none() {
        entries.push(Entry::line(Pen::solid(INK, 0.8), "outline of the sections"));
    }
    for (inside, look, text) in KINDS {
        if result.points.iter().any(|point| point.inside == inside) {
            entries.push(Entry::mark(look, text));
        }
    }
    let legend = Legend::new(entries, WIDTH);
    let top = legend.height() + 8.0;
    let abreast = pairs.len().clamp(1, 2);
    let wide = (WIDTH - GUTTER * (abreast as f64 - 1.0)) / abreast as f64;
    let rows = pairs.len().div_ceil(abreast);
    let mut canvas = Canvas::new(WIDTH, top + rows as f64 * (TALL + FOOT));
    legend.draw(&mut canvas, (0.0, 0.0));
    for (nth, pair) in pairs.iter().enumerate() {
        let left = (nth % abreast) as f64 * (wide + GUTTER);
        let upper = top + (nth / abreast) as f64 * (TALL + FOOT);
        diagram(&mut canvas, result, *pair, (left, left + wide, upper));
    }
    canvas.finish()
}

const SECTION: (Mark, Color) = (Mark::Circle, MUTED);
type Kind = (Option<bool>, (Mark, Color), &'static str);
const KINDS: [Kind; 3] = [
    (Some(true), (Mark::Square, BLUE), "wanted operation inside the hull"),
    (Some(false), (Mark::Diamond, VERMILION), "wanted operation outside"),
    (None, (Mark::Triangle, INK), "wanted operation, not assessed"),
];

fn diagram(
    canvas: &mut Canvas,
    result: &DomainResult,
    (across, up): (usize, usize),
    (left, right, top): (f64, f64, f64),
) {
    let values = |at: usize| {
        let sections = result.sections.iter().map(move |section| section.values[at]);
        sections.chain(result.points.iter().map(move |point| point.values[at]))
    };
    let (x, y, ticks) = (axis::over(values(across)), axis::over(values(up)), 6);
    let left = left + axis::room(y, ticks);
    let frame = Frame::new(x, y, (left, right - 6.0), (top, top + TALL));
    let title = |at: usize, room: f64| {
        let CoordinateRange { name, unit, .. } = &result.coordinates[at];
        cut(&axis::title(name, unit), TEXT, room)
    };
    frame.x_axis(canvas, 5, &title(across, frame.right() - left));
    frame.y_axis(canvas, ticks, &title(up, TALL));
    frame.spine(canvas);
    let at = |values: &[f64]| frame.at(values[across], values[up]);
    if result.reason.is_none() {
        let mut line = outline(result.sections.iter().map(|section| at(&section.values)).collect());
        line.extend(line.first().copied());
        canvas.path(&line, INK, 0.8);
    }
    let says = |name: &str, values: &[f64]| {
        let one = |(of, value): (&CoordinateRange, &f64)| {
            format!("{} {}", of.name, number::significant(*value, 5))
        };
        let values = result.coordinates.iter().zip(values).map(one);
        format!("{name}: {}", values.collect::<Vec<_>>().join(", "))
    };
    for section in &result.sections {
        let says = says(&section.section, &section.values);
        let group = Group::mark(&says).edge(0.35).at(&section.section, None);
        canvas.group(&group, |canvas| canvas.mark(SECTION, at(&section.values), 2.0));
    }
    for (nth, point) in result.points.iter().enumerate() {
        let Some((_, look, _)) = KINDS.iter().find(|(inside, ..)| *inside == point.inside) else {
            continue;
        };
        let says = says(&point.point, &point.values);
        let (x, y) = at(&point.values);
        canvas.group(&Group::mark(&says).edge(0.35), |canvas| canvas.mark(*look, (x, y), 2.8));
        if result.points.len() <= NUMBERED {
            canvas.text(&(nth + 1).to_string(), (x + 4.0, y - 4.0), &Font::left(SMALL));
        }
    }
}

/// The corners of the convex outline of points in a plane, in order. Source: A. M. Andrew, "Another
/// efficient algorithm for convex hulls in two dimensions", Information Processing Letters 9
/// (1979).
fn outline(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let half = |points: &mut dyn Iterator<Item = Point>| {
        let mut chain: Vec<Point> = Vec::new();
        for point in points {
            while let [.., a, b] = chain.as_slice() {
                if (b.0 - a.0) * (point.1 - a.1) - (b.1 - a.1) * (point.0 - a.0) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut all = half(&mut points.iter().copied());
    all.extend(half(&mut points.iter().rev().copied()));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_outline_has_the_corners_alone() {
        let points = vec![
            (0.0, 0.0),
            (2.0, 0.0),
            (1.0, 0.0),
            (1.0, 1.0),
            (2.0, 2.0),
            (0.0, 2.0),
            (2.0, 2.0),
        ];
        assert_eq!(outline(points), [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]);
        assert_eq!(outline(vec![(1.0, 1.0), (0.0, 0.0)]), [(0.0, 0.0), (1.0, 1.0)]);
        assert_eq!(outline(Vec::new()), []);
    }
}
