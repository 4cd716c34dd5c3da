//! What a campaign can show: drawn campaigns, detectable sizes, effects closest to being named.

use crate::report::{document::*, number};
use crate::result::diagnosis::{Detectable, Diagnosis, Share};

/// What the search names in drawn campaigns.
fn drawn(found: &Diagnosis) -> Table {
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
    let row = |(hidden, result, share): (&str, &str, Share)| -> Vec<Cell> {
        cells![hidden, result, share.count, share.of]
    };
    let caption = "What the search names in campaigns drawn from the allowed difference of this one, with known effects of random size; the consistency checks are left out";
    Table::new(caption)
        .text("Hidden")
        .text("Result")
        .number("Number")
        .number("Of")
        .rows(rows.map(row))
}

/// Number of tolerances that are told.
const TOLERANCES: usize = 5;

/// Digits of a size.
const SIZE: Format = Format::Significant(3);

/// The sizes that a campaign can show, and the effects closest to being named.
pub fn detectable(found: &Diagnosis) -> Vec<Block> {
    let row = |one: &Detectable| {
        let size = |change: Option<f64>| Cell::number(change.map(|by| one.neutral + by), SIZE);
        cells![
            one.effect,
            one.parameter,
            Cell::number(one.neutral, SIZE),
            size(one.below),
            size(one.above),
            one.unit
        ]
    };
    let length = found.calibration.length.map_or_else(
        || "in the drawn campaigns, no length of the change suffices".into(),
        |length| {
            format!(
                "their change is {} standard deviations of the allowed difference",
                number::significant(length, 3)
            )
        },
    );
    let caption = format!(
        "Values from which this campaign can show each effect, if it is the only one: nine of ten are named ({length}; a dash where the range of the parameter ends before)"
    );
    let sizes = Table::new(caption)
        .text("Effect")
        .text("Parameter")
        .breaks(12)
        .numbers(["Neutral", "Detectable below", "Detectable above"])
        .short("Unit")
        .rows(found.detectable.iter().map(row));
    let mut blocks = vec![drawn(found).into(), sizes.into()];
    let used: Vec<String> = found
        .tolerances
        .iter()
        .take(TOLERANCES)
        .map(|one| {
            let deviations = number::fixed(one.deviations, 1);
            format!("{} ({}): {deviations}", one.tolerance, one.parameter)
        })
        .collect();
    if !used.is_empty() {
        let says = format!(
            "Tolerances that the fit used most, in declared standard deviations: {}.",
            used.join("; ")
        );
        blocks.push(Block::text(says));
    }
    if !found.nearest.is_empty() {
        let rows = found
            .nearest
            .iter()
            .map(|one| cells![one.says, Cell::number(one.evidence, Format::Fixed(1)), one.wants]);
        let caption = "Effects closest to being named, each alone, for the remaining gap";
        blocks.push(
            Table::new(caption)
                .text("Effect")
                .number("Evidence")
                .text("Criterion not met")
                .rows(rows)
                .into(),
        );
    }
    blocks
}
