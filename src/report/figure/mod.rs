//! Figures of a report as SVG texts: 17 cm wide, in one style, reproducible byte by byte.
//!
//! Names of sections, signals and quantities are user text and are escaped. Marks
//! have a `<title>` as tooltip, and `data-section` and `data-zone` for the scripts of the HTML
//! report.

mod application;
pub mod axis;
pub mod boxes;
pub mod canvas;
mod choices;
mod differences;
mod domain;
pub mod frame;
mod frequency;
mod kit;
pub mod legend;
mod levels;
mod map;
mod margins;
mod multiples;
mod offsets;
mod overview;
mod pair_mark;
mod pairs;
mod ratios;
mod regression;
mod sensitivity;
mod states;
pub mod style;
mod symbol;
mod trace;
mod zones;

pub use application::{application, has_application};
pub use choices::choices;
pub use domain::domain;
pub use frequency::{frequency, has_frequency};
pub use map::map;
pub use margins::margins;
pub use multiples::LINES;
pub use offsets::{selection, shares};
pub use overview::overview;
pub use pairs::pairs;
pub use regression::{drawn, regression};
pub use sensitivity::sensitivity;
pub use states::{before_after, signals};
pub use trace::trace;
pub use zones::Zones;

use crate::report::{brief, estimates, sides};
use crate::result::Certification;

/// All figures of a report by their names in the document ([`super::document::Figure::name`]).
///
/// Empty figures are omitted: a quantity without values, a domain without conditions, a missing
/// graph.
pub fn figures(found: &Certification) -> Vec<(String, String)> {
    let zones = Zones::of(found);
    let mut drawn = Vec::new();
    if !found.quantities.is_empty() {
        drawn.push(("overview".to_owned(), overview(&found.quantities)));
    }
    if brief::is_brief(&found.quantities) {
        for (at, matrix) in brief::matrices(&found.quantities).iter().enumerate() {
            let pages = matrix.lines.chunks(LINES).enumerate();
            drawn.extend(pages.map(|(page, lines)| {
                (multiples_name(at, page), multiples::multiples(matrix, lines, &zones))
            }));
        }
    }
    let with_chapter =
        brief::in_full(&found.quantities).into_iter().map(|at| (at, &found.quantities[at]));
    for (at, quantity) in with_chapter.filter(|(_, quantity)| !quantity.values.is_empty()) {
        drawn.push((format!("pairs-{at}"), pairs(quantity, &zones)));
        if has_frequency(quantity) {
            drawn.push((format!("frequency-{at}"), frequency(quantity, &zones)));
        }
        for (nth, limit) in estimates::limits(quantity).iter().enumerate() {
            let groups = regression::drawn(limit);
            if !groups.is_empty() {
                drawn.push((
                    format!("regression-{at}-{nth}"),
                    regression(quantity, &groups, &zones),
                ));
            }
        }
    }
    for (at, one) in found.traces.iter().enumerate() {
        drawn.push((format!("trace-{at}"), trace(one, sides::of_trace(one, found))));
    }
    if !found.domain.is_empty() {
        drawn.push(("domain".to_owned(), domain(&found.domain, &found.sections, &zones)));
    }
    for (at, result) in
        found.application.iter().enumerate().filter(|(_, result)| has_application(result))
    {
        drawn.push((format!("application-{at}"), application(result)));
    }
    if !found.protocol.graph_svg.trim().is_empty() {
        drawn.push(("graph".to_owned(), found.protocol.graph_svg.clone()));
    }
    drawn
}

/// Name of a page of small diagrams.
pub fn multiples_name(matrix: usize, page: usize) -> String {
    format!("multiples-{matrix}-{page}")
}
