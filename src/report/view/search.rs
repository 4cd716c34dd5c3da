//! How the sections were found in runs, and which were kept.

use super::name;
use crate::report::{
    document::*,
    found::{drift_in_words, in_words},
    number,
    sides::capital,
};
use crate::result::{
    found::{FoundInRun, FoundSections, Rejected},
    study::Reduction,
};

/// The search in the runs of a campaign.
pub fn search(found: &FoundSections) -> Vec<Block> {
    let title = "search for sections in runs";
    let title = match &found.campaign {
        Some(campaign) => format!("{campaign}: {title}"),
        None => capital(title),
    };
    let mut blocks = vec![Block::heading(title), Block::text(format!("{}.", in_words(found)))];
    blocks.push(runs(found).into());
    let rejected = found.rejected();
    if !rejected.is_empty() {
        blocks.push(self::rejected(&rejected, found.tried()).into());
    }
    let drifts = found.runs.iter().filter_map(|run| drift_in_words(run, &found.axis_unit));
    blocks.extend(drifts.map(|says| Block::text(format!("{}.", capital(&says)))));
    blocks
}

fn runs(found: &FoundSections) -> Table {
    let length = |x: f64| Cell::text(format!("{} {}", number::significant(x, 7), found.axis_unit));
    let row = |run: &FoundInRun| {
        cells![
            Cell::from(name(&run.run)).strong(),
            length(run.start),
            length(run.end),
            run.tried as u64,
            run.found
        ]
    };
    Table::new("Runs, and sections found in them")
        .name("Run")
        .wide(2.0)
        .numbers(["From", "To", "Places tried", "Sections found"])
        .rows(found.runs.iter().map(row))
}

fn rejected(all: &[Rejected], tried: usize) -> Table {
    let row = |rejected: &Rejected| {
        let share = 100.0 * rejected.places as f64 / tried.max(1) as f64;
        cells![
            capital(&rejected.reason.text().to_string()),
            (rejected.places as u64),
            Cell::text(format!("{share:.1} %"))
        ]
    };
    let caption = "Places where no section begins, by the first reason; the stretches are in tables/rejected.csv";
    Table::new(caption)
        .text("Reason")
        .wide(2.0)
        .number("Places")
        .number("Share of those tried")
        .rows(all.iter().map(row))
}

/// The sections that were kept, and the scatter of all and of these.
pub fn reduction(reduction: &Reduction) -> Vec<Block> {
    let highest =
        |of: fn(&(String, f64, f64)) -> f64| reduction.scatter.iter().map(of).fold(0.0, f64::max);
    let used: usize = reduction.kept.iter().map(|(_, kept)| kept.len()).sum();
    let sentence = format!(
        "{used} of {} sections were kept, at most {} of each group, so that the highest standard deviation divided by its limit stays \
         almost the same: {} of all sections, {} of those kept.",
        used + reduction.left_out.len(),
        reduction.most,
        number::fixed(highest(|row| row.1), 3),
        number::fixed(highest(|row| row.2), 3)
    );
    let kept = reduction
        .kept
        .iter()
        .map(|(group, kept)| cells![Cell::from(name(group)).strong(), kept.len(), kept.join(", ")]);
    let groups = Table::new("Sections kept of each group")
        .name("Group")
        .number("Kept")
        .text("Sections")
        .wide(1.0)
        .rows(kept);
    let scatter = reduction.scatter.iter().map(|(symbol, all, kept)| {
        let ratio = |value: f64| Cell::number(value, Format::Fixed(3));
        cells![Cell::symbol(symbol, "").strong(), ratio(*all), ratio(*kept)]
    });
    let scatter = Table::new("Standard deviations divided by their limits")
        .text("Quantity")
        .wide(1.0)
        .number("All sections")
        .number("Sections kept")
        .rows(scatter);
    vec![Block::heading("Sections kept"), Block::text(sentence), groups.into(), scatter.into()]
}
