//! Text of the study of selections.

use super::document::{Chapter, Head, Item, Table};
use super::{BOXES, Opening, percent, share};
use crate::report::figure;
use crate::report::number;
use crate::report::sides::capital;
use crate::report::view::{Fact, Finding};
use crate::result::study::{
    Importance, QuantitySpread, Reduction, Removal, SelectionStudy, Spread,
};
use crate::result::{Verdict, VerdictWords};

/// Maximum number of rows of a table; the CSV tables contain all.
const MOST_ROWS: usize = 60;

fn fact(name: &str, value: String) -> Fact {
    Fact { name: name.to_owned(), value }
}

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
    let lacking = found.lacking.as_ref().map_or_else(String::new, |lacking| format!(" {lacking}"));
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
            fact("Selections", number::large(found.counted.combinations)),
            fact(
                &capital(&words.good),
                if found.counted.share.exact {
                    number::count(found.counted.share.validated)
                } else {
                    share(&found.counted.share)
                },
            ),
            fact("All sections", words.word(found.verdict).to_owned()),
            fact(
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
    let mut items = vec![strata(found)];
    items.extend(found.methods.iter().map(Item::text));
    let mut chapters = vec![
        Chapter { id: "selections".into(), title: "Selections".into(), items },
        Chapter {
            id: "spread".into(),
            title: "Scatter over the selections".into(),
            items: spread(&found.quantities, all_of(found)),
        },
        Chapter {
            id: "failing".into(),
            title: "Criteria not met or not assessed".into(),
            items: failing(found),
        },
        Chapter {
            id: "sections".into(),
            title: "Influence of individual sections".into(),
            items: importance(&found.sections, found.removal.as_ref(), words),
        },
    ];
    chapters.extend(found.reduction.as_ref().map(reduction));
    chapters
}

fn strata(found: &SelectionStudy) -> Item {
    let rows = found.strata.iter().map(|stratum| {
        let not_used = by_reason(&stratum.not_used);
        vec![
            stratum.zone.clone(),
            stratum.title.clone(),
            stratum.take.to_string(),
            stratum.sections.len().to_string(),
            stratum.sections.join(", "),
            if not_used.is_empty() { number::NONE.into() } else { not_used.join("; ") },
        ]
    });
    Item::Table {
        table: Table {
            caption: "Composition of a selection, and the sections it is drawn from".into(),
            head: vec![
                Head::short("Zone"),
                Head::text("Title"),
                Head::number("Taken"),
                Head::number("Usable"),
                Head::text("Sections"),
                Head::text("Not used"),
            ],
            rows: rows.collect(),
        },
    }
}

/// The box plots, one figure for each kind of statistic.
pub fn boxes(quantities: &[QuantitySpread], name: &str, at: &str) -> Vec<Item> {
    let one = |(of, count): (figure::boxes::Of, usize)| {
        let all = || {
            quantities
                .iter()
                .flat_map(|quantity| &quantity.statistics)
                .filter(|statistic| of.has(&statistic.name))
        };
        let beyond = all().filter(|statistic| statistic.failing > 0.0).count();
        Item::figure(
            format!("{name}-{}", of.name()),
            format!("{} of all selections divided by their limits{at}", of.in_words()),
            format!(
                "Box plots of {count} normalised statistics; {beyond} exceed their limits in some selections. The numbers are in the table."
            ),
        )
    };
    figure::boxes::drawn(quantities).into_iter().map(one).collect()
}

/// The box plots and their numbers.
fn spread(quantities: &[QuantitySpread], of: &str) -> Vec<Item> {
    let statistics = || {
        quantities.iter().flat_map(|quantity| {
            quantity.statistics.iter().map(move |statistic| (quantity, statistic))
        })
    };
    // Columns with the same content in every row are omitted.
    let scopes = statistics().any(|(_, statistic)| !statistic.scope.is_all());
    let spreads: Vec<Spread> = statistics().filter_map(|(_, statistic)| statistic.spread).collect();
    let rows: Vec<Vec<String>> = statistics()
        .map(|(quantity, statistic)| {
            let mut row = vec![quantity.symbol.clone(), statistic.name.to_string()];
            row.extend(scopes.then(|| statistic.scope.to_string()));
            row.push(statistic.overall.map_or_else(|| number::NONE.into(), shown));
            match &statistic.spread {
                Some(spread) => row.extend(numbers(spread)),
                None => row.extend((0..6).map(|_| number::NONE.to_owned())),
            }
            row.push(percent(statistic.failing));
            row
        })
        .collect();
    let mut head = vec![Head::text("Quantity"), Head::short("Statistic")];
    head.extend(scopes.then(|| Head::short("Pairs")));
    head.extend(["All", "Min", "25 %", "Median", "75 %", "Max", "Outliers"].map(Head::number));
    head.push(Head::number("Not met"));
    let table = Table {
        caption: format!(
            "Statistics divided by their limits over the selections; “All” refers to all {} together{}",
            of,
            known(&spreads)
        ),
        head,
        rows,
    };
    boxes(quantities, BOXES, "").into_iter().chain([Item::Table { table }]).collect()
}

fn shown(value: f64) -> String {
    number::beside(value, 1.0, 3)
}

/// Minimum, quartiles, maximum and outliers; for an estimated quartile half the width of its
/// interval.
fn numbers(spread: &Spread) -> Vec<String> {
    let within = |at: usize| {
        let half = spread.intervals.all()[at].map(|(low, high)| 0.5 * (high - low));
        half.map_or_else(String::new, |half| format!(" ± {}", number::significant(half, 1)))
    };
    let mut row = vec![shown(spread.min)];
    row.extend(
        [spread.q1, spread.median, spread.q3]
            .iter()
            .enumerate()
            .map(|(at, value)| shown(*value) + &within(at)),
    );
    row.push(shown(spread.max));
    row.push(number::large(spread.outliers as f64));
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

fn failing(found: &SelectionStudy) -> Vec<Item> {
    let fails: Vec<&QuantitySpread> =
        found.quantities.iter().filter(|quantity| quantity.failing > 0.0).collect();
    if fails.is_empty() {
        return vec![Item::text("All criteria are met in every selection that was evaluated.")];
    }
    let mut items = vec![Item::Table {
        table: Table {
            caption: "Quantities whose criteria are not met or cannot be assessed: share of the selections, and share in which no other \
                      quantity is concerned"
                .into(),
            head: vec![Head::text("Quantity"), Head::text("Title"), Head::number("Share"), Head::number("Share alone")],
            rows: fails
                .iter()
                .map(|quantity| {
                    vec![
                        quantity.symbol.clone(),
                        quantity.title.clone(),
                        percent(quantity.failing),
                        quantity.alone.map_or_else(|| number::NONE.to_owned(), percent),
                    ]
                })
                .collect(),
        },
    }];
    if found.worst.is_empty() {
        return items;
    }
    items.push(Item::Table {
        table: Table {
            caption: "Worst selection for each limit that is exceeded in some selection".into(),
            head: vec![
                Head::short("Quantity"),
                Head::short("Statistic"),
                Head::number("Ratio to limit"),
                Head::text("Sections of the selection"),
            ],
            rows: found
                .worst
                .iter()
                .take(MOST_ROWS)
                .map(|worst| {
                    vec![
                        worst.symbol.clone(),
                        format!("{}{}", worst.title, worst.scope.suffix()),
                        number::beside(worst.normalised, 1.0, 3),
                        worst.sections.join(", "),
                    ]
                })
                .collect(),
        },
    });
    items
}

fn importance(
    sections: &[Importance],
    removal: Option<&Removal>,
    words: &VerdictWords,
) -> Vec<Item> {
    let mut sorted: Vec<&Importance> = sections.iter().collect();
    let effect =
        |one: &Importance| one.with.zip(one.without).map_or(0.0, |(with, without)| with - without);
    sorted.sort_by(|a, b| effect(b).abs().total_cmp(&effect(a).abs()));
    let shown = |share: Option<f64>| share.map_or_else(|| number::NONE.to_owned(), percent);
    let removal = removal.map(|removal| Item::text(worded(removal, words)));
    let table = [Item::Table {
        table: Table {
            caption: format!(
                "Share of selections with the verdict '{}', with and without each section, sorted by the difference",
                words.good
            ),
            head: vec![
                Head::text("Section"),
                Head::short("Zone"),
                Head::number("With"),
                Head::number("Without"),
                Head::number("Difference, percentage points"),
            ],
            rows: sorted
                .iter()
                .take(MOST_ROWS)
                .map(|one| {
                    let difference =
                        one.with.zip(one.without).map(|(with, without)| 100.0 * (with - without));
                    vec![
                        one.section.clone(),
                        one.zone.clone(),
                        shown(one.with),
                        shown(one.without),
                        number::optional(difference, 2),
                    ]
                })
                .collect(),
        },
    }];
    removal.into_iter().chain(table).collect()
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
    let kept = reduction.kept.iter().map(|(zone, sections)| {
        vec![zone.clone(), sections.len().to_string(), sections.join(", ")]
    });
    let scatter = reduction.scatter.iter().map(|(symbol, all, kept)| {
        vec![
            symbol.clone(),
            number::beside(*all, 1.0, 3),
            number::beside(*kept, 1.0, 3),
            number::fixed(kept - all, 4),
        ]
    });
    Chapter {
        id: "reduction".into(),
        title: "Representative sections".into(),
        items: vec![
            Item::text(format!(
                "Before the selection, the sections were reduced to at most {} per zone so that the largest standard deviation of all sections is retained.",
                reduction.most
            )),
            Item::Table {
                table: Table {
                    caption: "Sections kept".into(),
                    head: vec![Head::short("Zone"), Head::number("Kept"), Head::text("Sections")],
                    rows: kept.collect(),
                },
            },
            Item::Table {
                table: Table {
                    caption: "Standard deviations divided by their limits".into(),
                    head: vec![
                        Head::text("Quantity"),
                        Head::number("All sections"),
                        Head::number("Sections kept"),
                        Head::number("Change"),
                    ],
                    rows: scatter.collect(),
                },
            },
        ],
    }
}

/// Sections that are not used for the same reason, with the reason once: `S01, S02: left out by the
/// reduction`.
fn by_reason(sections: &[(String, String)]) -> Vec<String> {
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for (section, why) in sections {
        match reasons.iter_mut().find(|(reason, _)| *reason == why.as_str()) {
            Some((_, names)) => names.push(section),
            None => reasons.push((why, vec![section])),
        }
    }
    reasons.into_iter().map(|(reason, names)| format!("{}: {reason}", names.join(", "))).collect()
}
