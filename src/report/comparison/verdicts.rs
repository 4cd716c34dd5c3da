//! Verdicts, applicability, ratios and differences of protocols.

use super::{table, three};
use crate::report::number;
use crate::report::study::{Chapter, Head, Item};
use crate::result::comparison::{Applicability, Cell, Comparison, Difference, Tried};

pub fn verdicts(found: &Comparison) -> Chapter {
    let row = |cell: &Cell| {
        vec![
            cell.campaign.clone(),
            cell.protocol.clone(),
            cell.verdict.clone(),
            cell.decided_by.clone().unwrap_or_else(|| number::NONE.to_owned()),
            three(cell.ratio),
            cell.sections_used.to_string(),
        ]
    };
    let mut items = vec![
        Item::text(
            "A verdict is decided by the requirement with the largest ratio of value and limit.",
        ),
        table(
            "Verdicts of the protocols",
            vec![
                Head::text("Campaign"),
                Head::text("Protocol"),
                Head::short("Verdict"),
                Head::text("Decided by"),
                Head::number("Ratio"),
                Head::number("Sections used"),
            ],
            found.verdicts.iter().map(row).collect(),
        ),
    ];
    let open: Vec<String> = found
        .verdicts
        .iter()
        .filter(|cell| cell.holds.is_none())
        .filter_map(|cell| {
            Some(format!("{}, {}: {}", cell.campaign, cell.protocol, cell.reasons.first()?))
        })
        .collect();
    if !open.is_empty() {
        items.push(Item::text("Not assessable or open:"));
        items.push(Item::List { entries: open });
    }
    Chapter { id: "verdicts".into(), title: "Verdicts".into(), items }
}

fn tried(tried: Tried) -> String {
    match (tried.gave, tried.of) {
        (_, 0) => number::NONE.to_owned(),
        (gave, of) if gave == of => "yes".into(),
        (0, _) => "no".into(),
        (gave, of) => format!("{gave} of {of}"),
    }
}

pub fn applicability(found: &Comparison) -> Chapter {
    let row = |one: &Applicability| {
        vec![
            one.protocol.clone(),
            one.metric.clone(),
            one.quantities.to_string(),
            tried(one.number_of_one_quantity),
            tried(one.number_of_one_section),
            tried(one.verdict_of_one_quantity),
            tried(one.verdict_of_one_section),
            one.scale.clone().unwrap_or_else(|| number::NONE.to_owned()),
            one.symmetric.map_or_else(
                || number::NONE.to_owned(),
                |it| if it { "yes" } else { "no" }.to_owned(),
            ),
        ]
    };
    Chapter {
        id: "applicability".into(),
        title: "Applicability".into(),
        items: vec![
            Item::text(
                "Each entry was found by trying. All but one quantity, or all but one section, are withheld: does the metric have a number, and the protocol a verdict? Scale: with both records doubled, a relative metric keeps its values and an absolute one doubles them. Symmetric: with simulation and measurement exchanged, the magnitude stays.",
            ),
            table(
                "Applicability of the metrics",
                vec![
                    Head::text("Protocol"),
                    Head::text("Metric"),
                    Head::number("Quantities"),
                    Head::short("Number, one quantity"),
                    Head::short("Number, one section"),
                    Head::short("Verdict, one quantity"),
                    Head::short("Verdict, one section"),
                    Head::short("Scale"),
                    Head::short("Symmetric"),
                ],
                found.applicability.iter().map(row).collect(),
            ),
        ],
    }
}

/// With two protocols, what each difference does.
pub fn differences(found: &Comparison) -> Option<Chapter> {
    let [before, after] = found.protocols.as_slice() else { return None };
    let row = |one: &Difference| {
        let ratio = |ratio: Option<f64>| three(ratio);
        vec![
            one.rule.clone(),
            one.words.clone(),
            one.campaign.clone(),
            one.verdict_before.clone(),
            one.verdict_after
                .clone()
                .or_else(|| one.reason.clone())
                .unwrap_or_else(|| number::NONE.to_owned()),
            format!("{} / {}", ratio(one.ratio_before), ratio(one.ratio_after)),
            one.limits_changed.map_or_else(|| number::NONE.to_owned(), |count| count.to_string()),
        ]
    };
    let items = if let Some(count) = found.unrelated {
        vec![Item::text(format!(
            "{} and {} are unrelated: neither extends the other and they extend no common protocol. They differ in {}, none of which is \
             applied alone.",
            before.name,
            after.name,
            if count == 1 { "one rule".into() } else { format!("{count} rules") }
        ))]
    } else if found.differences.is_empty() {
        vec![Item::text("The protocols do not differ in any rule.")]
    } else {
        vec![
            Item::text(format!(
                "Each rule in which {} differs from {} is applied alone to {}, then all rules together. The largest ratio of value and limit is printed before and after.",
                after.name, before.name, before.name
            )),
            table(
                "Rules that differ, and the verdict with each of them",
                vec![
                    Head::text("Rule"),
                    Head::text("Difference"),
                    Head::text("Campaign"),
                    Head::short("Verdict before"),
                    Head::text("Verdict after"),
                    Head::number("Largest ratio"),
                    Head::number("Limits changed"),
                ],
                found.differences.iter().map(row).collect(),
            ),
        ]
    };
    Some(Chapter { id: "differences".into(), title: "Differences, rule by rule".into(), items })
}

/// Most protocols side by side in a table.
const ABREAST: usize = 6;

/// The largest ratio of each quantity, the protocols side by side.
pub fn ratios(found: &Comparison) -> Chapter {
    let mut items = Vec::new();
    for some in found.protocols.chunks(ABREAST) {
        let names: Vec<&str> = some.iter().map(|one| one.name.as_str()).collect();
        let mut rows: Vec<([&str; 3], Vec<Option<f64>>)> = Vec::new();
        for one in &found.ratios {
            let Some(column) = names.iter().position(|name| *name == one.protocol) else {
                continue;
            };
            let key = [one.campaign.as_str(), one.symbol.as_str(), one.estimate.as_str()];
            let at = rows.iter().position(|(known, _)| *known == key).unwrap_or_else(|| {
                rows.push((key, vec![None; names.len()]));
                rows.len() - 1
            });
            let largest = &mut rows[at].1[column];
            if one.ratio > *largest {
                *largest = one.ratio;
            }
        }
        let mut head =
            vec![Head::text("Campaign"), Head::short("Quantity"), Head::text("Estimate")];
        head.extend(names.iter().map(|name| Head { numeric: true, ..Head::text(name) }));
        let row = |(key, ratios): ([&str; 3], Vec<Option<f64>>)| {
            key.iter()
                .map(|part| (*part).to_owned())
                .chain(ratios.into_iter().map(three))
                .collect::<Vec<_>>()
        };
        let caption = "Largest ratio of value and limit over the groups of each requirement";
        items.push(table(caption, head, rows.into_iter().map(row).collect()));
    }
    Chapter { id: "ratios".into(), title: "Ratios by quantity".into(), items }
}

pub fn compared(found: &Comparison) -> Chapter {
    let protocol = |one: &crate::result::comparison::Compared| {
        vec![one.name.clone(), one.title.clone(), one.criterion.clone(), one.sha256.clone()]
    };
    let campaign = |one: &crate::result::comparison::OnCampaign| {
        vec![one.name.clone(), one.sections.to_string()]
    };
    Chapter {
        id: "compared".into(),
        title: "Protocols and campaigns".into(),
        items: vec![
            table(
                "Protocols, with the SHA-256 of their text",
                vec![
                    Head::text("Name"),
                    Head::text("Title"),
                    Head::text("Criterion"),
                    Head::text("SHA-256"),
                ],
                found.protocols.iter().map(protocol).collect(),
            ),
            table(
                "Campaigns",
                vec![Head::text("Name"), Head::number("Sections")],
                found.campaigns.iter().map(campaign).collect(),
            ),
        ],
    }
}
