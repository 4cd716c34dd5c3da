//! Text of the study of selections.

use super::{BOXES, percent, scoped, share};
use crate::report::{document::*, figure, number, sides::capital, view::Opening};
use crate::result::{
    Reason, Verdict, VerdictWords,
    study::{Importance, QuantitySpread, Reduction, Removal, SelectionStudy, Spread},
};

/// Maximum number of rows of a table; the CSV tables contain all.
const MOST_ROWS: usize = 60;

/// A ratio of a value and its limit, with enough decimals to compare with 1.
const RATIO: Format = Format::Beside { limit: 1.0, decimals: 3 };

pub fn opening(found: &SelectionStudy, words: &VerdictWords) -> Opening {
    let all = found.counted.share.share;
    let agrees = match found.verdict {
        Verdict::Validated => all,
        _ => 1.0 - all,
    };
    let same = match agrees {
        share if share >= 1.0 => "does not depend on the sections chosen",
        share if share >= 0.5 => "depends on the sections chosen",
        share if share <= 0.0 => "differs for all selections from that of all sections together",
        _ => "differs for most selections from that of all sections together",
    };
    // The result box states the share: positive if the verdict holds for all, negative if for none.
    let holds = match all {
        share if share >= 1.0 => Some(true),
        share if share <= 0.0 => Some(false),
        _ => None,
    };
    let of = all_of(found);
    let looked = if found.counted.share.exact && found.counted.combinations <= 1.0 {
        "There is one selection.".to_owned()
    } else if found.counted.share.exact {
        format!("All {} selections were evaluated.", number::large(found.counted.combinations))
    } else {
        format!(
            "Of {} selections, {} were drawn at random; the interval is a 95 % confidence interval.",
            number::large(found.counted.combinations),
            number::count(found.counted.share.looked_at)
        )
    };
    let lacking =
        found.lacking.as_ref().map_or_else(String::new, |lacking| format!(" {}", lacking.text()));
    Opening {
        headline: Finding::new(
            holds,
            &share(&found.counted.share),
            &share(&found.counted.share),
            &share(&found.counted.share),
        ),
        sentence: format!(
            "of the selections have the verdict '{}'. The verdict on all {of} together is '{}'. The verdict {same}. {looked}{lacking}",
            words.good,
            words.word(found.verdict)
        ),
        facts: vec![
            Fact::new("Selections", number::large(found.counted.combinations)),
            Fact::new(
                capital(&words.good),
                if found.counted.share.exact {
                    number::count(found.counted.share.validated)
                } else {
                    share(&found.counted.share)
                },
            ),
            Fact::new("All sections", words.word(found.verdict).to_owned()),
            Fact::new(
                "Sections",
                found
                    .strata
                    .iter()
                    .map(|stratum| format!("{} of {}", stratum.take, stratum.sections.len()))
                    .collect::<Vec<_>>()
                    .join(", "),
            ),
        ],
    }
}

pub fn chapters(found: &SelectionStudy, words: &VerdictWords) -> Vec<Chapter> {
    let mut blocks = vec![strata(found).into()];
    blocks.extend(found.methods.iter().map(Block::text));
    let influence = importance(&found.sections, found.removal.as_ref(), words);
    let mut chapters = vec![
        Chapter::new("selections", "Selections", blocks),
        Chapter::new(
            "spread",
            "Scatter over the selections",
            spread(&found.quantities, all_of(found)),
        ),
        Chapter::new("failing", "Criteria not met or not assessed", failing(found)),
        Chapter::new("sections", "Influence of individual sections", influence),
    ];
    chapters.extend(found.reduction.as_ref().map(reduction));
    chapters
}

fn strata(found: &SelectionStudy) -> Table {
    let rows = found.strata.iter().map(|stratum| {
        let not_used = Some(by_reason(&stratum.not_used)).filter(|reasons| !reasons.is_empty());
        vec![
            Cell::from(&stratum.zone),
            (&stratum.title).into(),
            stratum.take.into(),
            stratum.sections.len().into(),
            stratum.sections.join(", ").into(),
            Cell::or_missing(not_used.map(|reasons| reasons.join("; "))),
        ]
    });
    Table::new("Composition of a selection, and the sections it is drawn from")
        .name("Zone")
        .text("Title")
        .number("Taken")
        .number("Usable")
        .text("Sections")
        .text("Not used")
        .rows(rows)
}

/// The box plots, one figure for each kind of statistic.
pub fn boxes(quantities: &[QuantitySpread], name: &str, at: &str) -> Vec<Block> {
    let one = |(of, count): (figure::boxes::Of, usize)| {
        let all = quantities.iter().flat_map(|quantity| &quantity.statistics);
        let beyond =
            all.filter(|statistic| of.has(&statistic.name) && statistic.failing > 0.0).count();
        let caption = format!("{} of all selections divided by their limits{at}", of.in_words());
        let alt = format!(
            "Box plots of {count} normalised statistics; {beyond} exceed their limits in some selections. The numbers are in the table."
        );
        Figure::new(format!("{name}-{}", of.name()), caption, alt, 200).into()
    };
    figure::boxes::drawn(quantities).into_iter().map(one).collect()
}

/// The box plots and their numbers.
fn spread(quantities: &[QuantitySpread], of: &str) -> Vec<Block> {
    let statistics = || {
        quantities.iter().flat_map(|quantity| {
            quantity.statistics.iter().map(move |statistic| (quantity, statistic))
        })
    };
    // Columns with the same content in every row are omitted.
    let scopes = statistics().any(|(_, statistic)| !statistic.scope.is_all());
    let spreads: Vec<Spread> = statistics().filter_map(|(_, statistic)| statistic.spread).collect();
    let rows = statistics().map(|(quantity, statistic)| {
        let mut row = cells![Cell::symbol(&quantity.symbol, ""), statistic.name];
        row.extend(scopes.then(|| Cell::from(&statistic.scope)));
        row.push(Cell::number(statistic.overall, RATIO));
        row.extend(numbers(statistic.spread.as_ref()));
        row.push(percent(statistic.failing).into());
        row
    });
    let numbers = ["All", "Min", "25 %", "Median", "75 %", "Max", "Outliers", "Not met"];
    let caption = format!(
        "Statistics divided by their limits over the selections; “All” refers to all {of} together{}",
        known(&spreads)
    );
    let table = Table::new(caption)
        .text("Quantity")
        .short("Statistic")
        .when(scopes, |table| table.short("Pairs"))
        .numbers(numbers)
        .rows(rows);
    boxes(quantities, BOXES, "").into_iter().chain([table.into()]).collect()
}

/// Minimum, quartiles, maximum and outliers; for an estimated quartile half the width of its
/// interval.
fn numbers(spread: Option<&Spread>) -> Vec<Cell> {
    let Some(spread) = spread else { return vec![Cell::MISSING; 6] };
    let quartile = |(at, value): (usize, f64)| match spread.intervals.all()[at] {
        None => Cell::number(value, RATIO),
        Some((low, high)) => {
            let half = number::significant(0.5 * (high - low), 1);
            Cell::text(format!("{} ± {half}", RATIO.print(value)))
        }
    };
    let quartiles = [spread.q1, spread.median, spread.q3];
    let mut row = vec![Cell::number(spread.min, RATIO)];
    row.extend(quartiles.into_iter().enumerate().map(quartile));
    row.push(Cell::number(spread.max, RATIO));
    row.push(Cell::number(spread.outliers as f64, Format::Count));
    row
}

/// What "all" selections are taken from.
fn all_of(found: &SelectionStudy) -> &'static str {
    if found.reduction.is_some() { "sections kept by the reduction" } else { "usable sections" }
}

/// Accuracy of the numbers of a table.
fn known(spreads: &[Spread]) -> String {
    let estimated = spreads.iter().any(|spread| !spread.exact && spread.within.is_none());
    let within = spreads.iter().filter_map(|spread| spread.within).fold(0.0, f64::max);
    match (estimated, within > 0.0) {
        (false, false) => "; all numbers are exact".to_owned(),
        (true, false) => "; rows with ± are estimated, all others are exact".to_owned(),
        (true, true) => {
            format!(
                "; rows with ± are estimated, quartiles of all others are exact to within {}",
                number::significant(within, 1)
            )
        }
        (false, true) => {
            format!("; quartiles are exact to within {}", number::significant(within, 1))
        }
    }
}

fn failing(found: &SelectionStudy) -> Vec<Block> {
    let fails = found.quantities.iter().filter(|quantity| quantity.failing > 0.0);
    let rows: Vec<Vec<Cell>> = fails
        .map(|quantity| {
            vec![
                Cell::symbol(&quantity.symbol, ""),
                (&quantity.title).into(),
                percent(quantity.failing).into(),
                Cell::or_missing(quantity.alone.map(percent)),
            ]
        })
        .collect();
    if rows.is_empty() {
        return vec![Block::text("All criteria are met in every selection that was evaluated.")];
    }
    let caption = "Quantities whose criteria are not met or cannot be assessed: share of the selections, and share in which no other \
                   quantity is concerned";
    let mut blocks = vec![
        Table::new(caption)
            .text("Quantity")
            .text("Title")
            .number("Share")
            .number("Share alone")
            .rows(rows)
            .into(),
    ];
    if found.worst.is_empty() {
        return blocks;
    }
    let rows = found.worst.iter().take(MOST_ROWS).map(|worst| {
        cells![
            Cell::symbol(&worst.symbol, ""),
            scoped(&worst.title, &worst.scope),
            Cell::number(worst.normalised, RATIO),
            worst.sections.join(", ")
        ]
    });
    let caption = "Worst selection for each limit that is exceeded in some selection";
    blocks.push(
        Table::new(caption)
            .short("Quantity")
            .short("Statistic")
            .number("Ratio to limit")
            .text("Sections of the selection")
            .rows(rows)
            .into(),
    );
    blocks
}

fn importance(
    sections: &[Importance],
    removal: Option<&Removal>,
    words: &VerdictWords,
) -> Vec<Block> {
    let mut sorted: Vec<&Importance> = sections.iter().collect();
    let effect = |one: &Importance| one.with.zip(one.without).map(|(with, without)| with - without);
    let size = |one: &Importance| effect(one).unwrap_or(0.0).abs();
    sorted.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let rows = sorted.iter().take(MOST_ROWS).map(|one| {
        vec![
            Cell::from(&one.section),
            (&one.zone).into(),
            Cell::or_missing(one.with.map(percent)),
            Cell::or_missing(one.without.map(percent)),
            Cell::number(effect(one).map(|share| 100.0 * share), Format::Fixed(2)),
        ]
    });
    let caption = format!(
        "Share of selections with the verdict '{}', with and without each section, sorted by the difference",
        words.good
    );
    let removal = removal.map(|removal| Block::text(worded(removal, words)));
    removal
        .into_iter()
        .chain([Table::new(caption)
            .text("Section")
            .breaks(12)
            .name("Zone")
            .numbers(["With", "Without", "Difference, percentage points"])
            .rows(rows)
            .into()])
        .collect()
}

/// A sentence on the sets whose removal changes the verdict.
fn worded(removal: &Removal, words: &VerdictWords) -> String {
    let verdict = words.word(removal.verdict);
    match removal.sets.as_slice() {
        [] if removal.complete => {
            format!(
                "The verdict on all sections together ({verdict}) does not change when sections are removed. All sets were tested that leave enough sections for a selection."
            )
        }
        [] => {
            let larger = match &removal.larger {
                None => "not all larger sets were tested".to_owned(),
                Some(set) => format!(
                    "it changes when {} sections are removed, chosen one at a time by largest influence, so a smaller set cannot be excluded: {}",
                    set.len(),
                    set.join(", ")
                ),
            };
            format!(
                "Removing up to {} sections does not change the verdict on all sections together ({verdict}); {larger}.",
                removal.tried
            )
        }
        [first, rest @ ..] => {
            let size = first.len();
            let plural = if size == 1 { "section is" } else { "sections are" };
            let others = match removal.count - 1 {
                0 => "it is the only set of this size".to_owned(),
                1 => "there is one other set of this size".to_owned(),
                more => format!("there are {more} other sets of this size"),
            };
            let more: Vec<String> = rest.iter().take(5).map(|set| set.join(" and ")).collect();
            let more =
                if more.is_empty() { String::new() } else { format!(": {}", more.join("; ")) };
            format!(
                "The verdict on all sections together ({verdict}) changes when {} {plural} removed: {}; {others}{more}. No smaller set changes it.",
                size,
                first.join(", ")
            )
        }
    }
}

fn reduction(reduction: &Reduction) -> Chapter {
    let about = format!(
        "Before the selection, the sections were reduced to at most {} per zone so that the largest standard deviation of all sections is retained.",
        reduction.most
    );
    let kept = reduction
        .kept
        .iter()
        .map(|(zone, sections)| cells![zone, sections.len(), sections.join(", ")]);
    let kept = Table::new("Sections kept").name("Zone").number("Kept").text("Sections").rows(kept);
    let scatter = reduction.scatter.iter().map(|(symbol, all, kept)| {
        cells![
            Cell::symbol(symbol, ""),
            Cell::number(*all, RATIO),
            Cell::number(*kept, RATIO),
            Cell::number(kept - all, Format::Fixed(4))
        ]
    });
    let scatter = Table::new("Standard deviations divided by their limits")
        .text("Quantity")
        .numbers(["All sections", "Sections kept", "Change"])
        .rows(scatter);
    let blocks = vec![Block::text(about), kept.into(), scatter.into()];
    Chapter::new("reduction", "Representative sections", blocks)
}

/// Sections that are not used for the same reason, with the reason once: `S01, S02: left out by the
/// reduction`.
fn by_reason(sections: &[(String, Reason)]) -> Vec<String> {
    let mut reasons: Vec<(&Reason, Vec<&str>)> = Vec::new();
    for (section, reason) in sections {
        match reasons.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, names)) => names.push(section),
            None => reasons.push((reason, vec![section])),
        }
    }
    let row =
        |(reason, names): (&Reason, Vec<&str>)| format!("{}: {}", names.join(", "), reason.text());
    reasons.into_iter().map(row).collect()
}
