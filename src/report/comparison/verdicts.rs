//! Verdicts, applicability, ratios and differences of protocols.

use super::three;
use crate::report::document::*;
use crate::result::comparison::{
    Applicability, Cell as OnProtocol, Compared, Comparison, Difference, OnCampaign, Tried,
};

/// The column of the campaign. The cover names a single one: on paper, it is not told again in every
/// row.
fn campaign(found: &Comparison) -> Column {
    let column = Column::text("Campaign").breaks(NAME);
    if found.campaigns.len() == 1 { column.only(Medium::Screen) } else { column }
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
    let columns = vec![
        campaign(found),
        Column::text("Protocol").breaks(NAME),
        Column::short("Verdict"),
        Column::text("Decided by"),
        Column::number("Ratio"),
        Column::number("Sections used"),
    ];
    let table =
        Table::new("Verdicts of the protocols", columns, found.verdicts.iter().map(row)).into();
    let about =
        "A verdict is decided by the requirement with the largest ratio of value and limit.";
    let mut blocks = vec![Block::text(about), table];
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
    let mut columns = vec![
        Column::text("Protocol").breaks(24),
        Column::text("Metric").breaks(24),
        Column::number("Quantities"),
    ];
    columns.extend(
        [
            "Number, one quantity",
            "Number, one section",
            "Verdict, one quantity",
            "Verdict, one section",
            "Scale",
            "Symmetric",
        ]
        .map(Column::short),
    );
    let about = "Each entry was found by trying. All but one quantity, or all but one section, are withheld: does the metric have a number, and the protocol a verdict? Scale: with both records doubled, a relative metric keeps its values and an absolute one doubles them. Symmetric: with simulation and measurement exchanged, the magnitude stays.";
    let rows = found.applicability.iter().map(row);
    let table = Table::new("Applicability of the metrics", columns, rows);
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
    let columns = vec![
        Column::text("Rule"),
        Column::text("Difference"),
        campaign(found),
        Column::short("Verdict before"),
        Column::text("Verdict after"),
        Column::number("Largest ratio"),
        Column::number("Limits changed"),
    ];
    let caption = "Rules that differ, and the verdict with each of them";
    Table::new(caption, columns, found.differences.iter().map(row))
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
        let mut columns =
            vec![campaign(found), Column::short("Quantity"), Column::text("Estimate")];
        columns.extend(names.iter().map(|name| Column::number(*name).wide(1.0).breaks(NAME)));
        let row = |([campaign, symbol, estimate], ratios): ([&str; 3], Vec<Option<f64>>)| {
            let mut row = cells![campaign, Cell::symbol(symbol, ""), Cell::sentence(estimate)];
            row.extend(ratios.into_iter().map(|ratio| match ratio {
                Some(ratio) if ratio.is_infinite() => "not met".into(),
                ratio => three(ratio),
            }));
            row
        };
        let caption = "Largest ratio of value and limit over the groups of each requirement";
        blocks.push(Table::new(caption, columns, rows.into_iter().map(row)).into());
    }
    Chapter::new("ratios", "Ratios by quantity", blocks)
}

pub fn compared(found: &Comparison) -> Chapter {
    let protocol =
        |one: &Compared| cells![one.name, one.title, Cell::sentence(&one.criterion), one.sha256];
    let campaign = |one: &OnCampaign| cells![one.name, one.sections];
    let columns = ["Name", "Title", "Criterion", "SHA-256"].map(Column::text).to_vec();
    let caption = "Protocols, with the SHA-256 of their text";
    let protocols = Table::new(caption, columns, found.protocols.iter().map(protocol));
    let columns = vec![Column::text("Name"), Column::number("Sections")];
    let campaigns = Table::new("Campaigns", columns, found.campaigns.iter().map(campaign));
    Chapter::new("compared", "Protocols and campaigns", vec![protocols.into(), campaigns.into()])
}
