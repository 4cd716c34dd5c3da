//! What a campaign can show: drawn campaigns, detectable sizes, effects closest to being named.

use crate::report::number;
use crate::report::study::{Head, Item, Table};
use crate::result::diagnosis::{Detectable, Diagnosis, Share};

/// What the search names in drawn campaigns.
fn drawn(found: &Diagnosis) -> Item {
    let of = &found.calibration;
    let rows = [
        ("One effect", "it is named, and nothing else", of.single),
        ("Two effects", "both are named, and nothing else", of.pair),
        ("One effect, which the search does not know", "another effect is named", of.outside),
        (
            "One or two effects, at least one named",
            "an effect is named that is not hidden",
            of.further,
        ),
        ("The named effects", "the 90 % interval contains the hidden size", of.intervals),
    ];
    let row = |(hidden, result, share): (&str, &str, Share)| {
        vec![hidden.to_string(), result.to_string(), share.count.to_string(), share.of.to_string()]
    };
    let head = vec![
        Head::text("Hidden"),
        Head::text("Result"),
        Head::number("Number"),
        Head::number("Of"),
    ];
    let caption = "What the search names in campaigns drawn from the allowed difference of this one, with known effects of random size; the consistency checks are left out";
    Item::Table {
        table: Table { caption: caption.into(), head, rows: rows.into_iter().map(row).collect() },
    }
}

/// The sizes that a campaign can show, and the effects closest to being named.
pub fn detectable(found: &Diagnosis) -> Vec<Item> {
    let significant = |size: f64| number::significant(size, 3);
    let row = |one: &Detectable| {
        let size = |change: Option<f64>| {
            change
                .map_or_else(|| number::NONE.to_owned(), |change| significant(one.neutral + change))
        };
        vec![
            one.effect.clone(),
            one.parameter.clone(),
            significant(one.neutral),
            size(one.below),
            size(one.above),
            one.unit.clone(),
        ]
    };
    let rows = found.detectable.iter().map(row);
    let head = vec![
        Head::text("Effect"),
        Head::text("Parameter"),
        Head::number("Neutral"),
        Head::number("Detectable below"),
        Head::number("Detectable above"),
        Head::short("Unit"),
    ];
    let length = found.calibration.length.map_or_else(
        || "in the drawn campaigns, no length of the change suffices".into(),
        |length| {
            format!(
                "their change is {} standard deviations of the allowed difference",
                significant(length)
            )
        },
    );
    let caption = format!(
        "Values from which this campaign can show each effect, if it is the only one: nine of ten are named ({length}; a dash where the range of the parameter ends before)"
    );
    let mut items =
        vec![drawn(found), Item::Table { table: Table { caption, head, rows: rows.collect() } }];
    if !found.nearest.is_empty() {
        let rows = found
            .nearest
            .iter()
            .map(|one| vec![one.says.clone(), number::fixed(one.evidence, 1), one.wants.clone()]);
        let head =
            vec![Head::text("Effect"), Head::number("Evidence"), Head::text("Criterion not met")];
        let caption = "Effects closest to being named, each alone, for the remaining gap";
        items.push(Item::Table {
            table: Table { caption: caption.into(), head, rows: rows.collect() },
        });
    }
    items
}
