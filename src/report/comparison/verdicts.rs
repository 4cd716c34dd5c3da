//! Verdicts, applicability, ratios and differences of protocols.

use super::three;
use crate::report::document::*;
use crate::result::comparison::{
    Applicability, Cell as OnProtocol, Compared, Comparison, Difference, OnCampaign, Tried,
};

/// With the column of the campaign. The cover names a single one: on paper, it is not told again in
/// every row.
fn campaign(table: Table, found: &Comparison) -> Table {
    let single = found.campaigns.len() == 1;
    table.text("Campaign").breaks(NAME).when(single, |table| table.only(Medium::Screen))
}

/// Letters of a name that is not broken.
const NAME: usize = 12;

pub fn verdicts(found: &Comparison) -> Chapter {
    let row = |cell: &OnProtocol| {
        vec![
            Cell::from(&cell.campaign),
            (&cell.protocol).into(),
            (&cell.verdict).into(),
            Cell::or_missing(cell.decided_by.as_deref().map(Cell::sentence)),
            three(cell.ratio),
            cell.sections_used.into(),
        ]
    };
    let table = campaign(Table::new("Verdicts of the protocols"), found)
        .text("Protocol")
        .breaks(NAME)
        .short("Verdict")
        .text("Decided by")
        .numbers(["Ratio", "Sections used"])
        .rows(found.verdicts.iter().map(row));
    let about =
        "A verdict is decided by the requirement with the largest ratio of value and limit.";
    let mut blocks = vec![Block::text(about), table.into()];
    let open: Vec<String> = found
        .verdicts
        .iter()
        .filter(|cell| cell.holds.is_none())
        .filter_map(|cell| {
            Some(format!("{}, {}: {}", cell.campaign, cell.protocol, cell.reasons.first()?.text()))
        })
        .collect();
    if !open.is_empty() {
        blocks.push(Block::text("Not assessable or open:"));
        blocks.push(Block::list(open));
    }
    Chapter::new("verdicts", "Verdicts", blocks)
}

fn tried(tried: Tried) -> Cell {
    match (tried.gave, tried.of) {
        (_, 0) => Cell::MISSING,
        (gave, of) if gave == of => "yes".into(),
        (0, _) => "no".into(),
        (gave, of) => format!("{gave} of {of}").into(),
    }
}

pub fn applicability(found: &Comparison) -> Chapter {
    let row = |one: &Applicability| {
        cells![
            one.protocol,
            Cell::sentence(&one.metric),
            one.quantities,
            tried(one.number_of_one_quantity),
            tried(one.number_of_one_section),
            tried(one.verdict_of_one_quantity),
            tried(one.verdict_of_one_section),
            Cell::or_missing(one.scale.as_ref()),
            Cell::or_missing(one.symmetric.map(|is| if is { "yes" } else { "no" }))
        ]
    };
    let about = "Each entry was found by trying. All but one quantity, or all but one section, are withheld: does the metric have a number, and the protocol a verdict? Scale: with both records doubled, a relative metric keeps its values and an absolute one doubles them. Symmetric: with simulation and measurement exchanged, the magnitude stays.";
    let table = Table::new("Applicability of the metrics")
        .text("Protocol")
        .breaks(24)
        .text("Metric")
        .breaks(24)
        .number("Quantities")
        .short("Number, one quantity")
        .short("Number, one section")
        .short("Verdict, one quantity")
        .short("Verdict, one section")
        .short("Scale")
        .short("Symmetric")
        .rows(found.applicability.iter().map(row));
    Chapter::new("applicability", "Applicability", vec![Block::text(about), table.into()])
}

/// With two protocols, what each difference does.
pub fn differences(found: &Comparison) -> Option<Chapter> {
    let [before, after] = found.protocols.as_slice() else { return None };
    let blocks = if let Some(count) = found.unrelated {
        vec![Block::text(format!(
            "{} and {} are unrelated: neither extends the other and they extend no common protocol. They differ in {}, none of which is \
             applied alone.",
            before.name,
            after.name,
            if count == 1 { "one rule".into() } else { format!("{count} rules") }
        ))]
    } else if found.differences.is_empty() {
        vec![Block::text("The protocols do not differ in any rule.")]
    } else {
        let about = format!(
            "Each rule in which {} differs from {} is applied alone to {}, then all rules together. The largest ratio of value and limit is printed before and after.",
            after.name, before.name, before.name
        );
        vec![Block::text(about), rules(found).into()]
    };
    Some(Chapter::new("differences", "Differences, rule by rule", blocks))
}

fn rules(found: &Comparison) -> Table {
    let row = |one: &Difference| {
        let ratio = |ratio: Option<f64>| three(ratio).printed().letters();
        let reason = || one.reason.as_ref().map(|reason| reason.text().to_string());
        let after = one.verdict_after.clone().or_else(reason);
        vec![
            Cell::sentence(&one.rule),
            Cell::sentence(&one.words),
            (&one.campaign).into(),
            (&one.verdict_before).into(),
            Cell::or_missing(after.map(Cell::sentence)),
            format!("{} / {}", ratio(one.ratio_before), ratio(one.ratio_after)).into(),
            Cell::or_missing(one.limits_changed),
        ]
    };
    let table = Table::new("Rules that differ, and the verdict with each of them");
    campaign(table.text("Rule").text("Difference"), found)
        .short("Verdict before")
        .text("Verdict after")
        .numbers(["Largest ratio", "Limits changed"])
        .rows(found.differences.iter().map(row))
}

/// Most protocols side by side in a table.
const ABREAST: usize = 6;

/// The largest ratio of each quantity, the protocols side by side.
pub fn ratios(found: &Comparison) -> Chapter {
    let mut blocks = Vec::new();
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
            // A value that has no ratio does not reach its limit.
            let ratio = one.ratio.or((one.holds == Some(false)).then_some(f64::INFINITY));
            if ratio > *largest {
                *largest = ratio;
            }
        }
        let row = |([campaign, symbol, estimate], ratios): ([&str; 3], Vec<Option<f64>>)| {
            let mut row = cells![campaign, Cell::symbol(symbol, ""), Cell::sentence(estimate)];
            row.extend(ratios.into_iter().map(|ratio| match ratio {
                Some(ratio) if ratio.is_infinite() => "not met".into(),
                ratio => three(ratio),
            }));
            row
        };
        let caption = "Largest ratio of value and limit over the groups of each requirement";
        let table = campaign(Table::new(caption), found)
            .short("Quantity")
            .text("Estimate")
            .each(names, |table, name| table.number(name).wide(1.0).breaks(NAME))
            .rows(rows.into_iter().map(row));
        blocks.push(table.into());
    }
    Chapter::new("ratios", "Ratios by quantity", blocks)
}

pub fn compared(found: &Comparison) -> Chapter {
    let protocol =
        |one: &Compared| cells![one.name, one.title, Cell::sentence(&one.criterion), one.sha256];
    let campaign = |one: &OnCampaign| cells![one.name, one.sections];
    let caption = "Protocols, with the SHA-256 of their text";
    let protocols = Table::new(caption)
        .text("Name")
        .text("Title")
        .text("Criterion")
        .text("SHA-256")
        .rows(found.protocols.iter().map(protocol));
    let campaigns = Table::new("Campaigns")
        .text("Name")
        .number("Sections")
        .rows(found.campaigns.iter().map(campaign));
    Chapter::new("compared", "Protocols and campaigns", vec![protocols.into(), campaigns.into()])
}
