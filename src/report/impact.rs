//! What the change of a protocol would have decided, as a document for those who decide on it.

use super::{
    comparison::{campaigns, rules},
    document::*,
    number,
    view::{self, Opening},
};
use crate::hash::sha256;
use crate::result::{
    CampaignInfo, FileHash, ProtocolInfo,
    impact::{ChangedRule, Flip, Impact, Judged, Margin, Near, NotReplayed, Share},
};

/// Title of every such report.
pub const TITLE: &str = "Impact of a change of rules";
/// Letters of a name that is not broken.
const NAME: usize = 12;

pub fn document(found: &Impact) -> Document {
    let mut chapters = vec![flips(found), margins(found), shares(found)];
    chapters.extend(not_replayed(found));
    chapters.extend([changes(found), archive(found)]);
    let rules = ProtocolInfo {
        sha256: found.new.sha256.clone(),
        graph_nodes: found.work.operations,
        ..rules(&[&found.old, &found.new])
    };
    let title = (TITLE.into(), "Impact of a change");
    view::study(title, opening(found), (&inputs(found), &rules), chapters)
}

/// The archive with one hash for each campaign: that of the hashes of its files, each on a line.
fn inputs(found: &Impact) -> CampaignInfo {
    let file = |judged: &Judged| {
        let files = &judged.of.files;
        let hashes: String = files.iter().map(|file| format!("{}\n", file.sha256)).collect();
        FileHash {
            path: format!("{} ({})", judged.of.name, count(files.len(), "file")),
            bytes: files.iter().map(|file| file.bytes).sum(),
            sha256: sha256(hashes.as_bytes()),
            record: None,
            changed: None,
        }
    };
    let name = count(found.archive.len(), "campaign");
    campaigns(name, found.archive.iter().map(file).collect())
}

/// `3 campaigns`
fn count(number: usize, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}

/// What it came to.
pub fn opening(found: &Impact) -> Opening {
    let (all, changed) = (found.campaigns, found.flips.len());
    let headline = match changed {
        0 => Finding::neutral("No verdict changes"),
        _ => Finding::new(None, "", "", "Verdicts change"),
    };
    let missing = match found.not_replayed.len() {
        0 => String::new(),
        number => format!(" {} not replayed.", count(number, "campaign")),
    };
    let facts = [
        ("Verdicts that change", changed.to_string()),
        ("Campaigns", all.to_string()),
        ("Rules changed", found.rules.len().to_string()),
        ("Not replayed", found.not_replayed.len().to_string()),
    ];
    Opening {
        headline,
        sentence: format!(
            "Under {} in place of {}, the verdict of {changed} of {} is another one.{missing}",
            found.new.name,
            found.old.name,
            count(all, "campaign"),
        ),
        facts: facts.map(|(name, value)| Fact::new(name, value)).to_vec(),
    }
}

fn flips(found: &Impact) -> Chapter {
    let title = "Verdicts that change";
    if found.flips.is_empty() {
        let blocks = vec![Block::text("No campaign has another verdict under the new protocol.")];
        return Chapter::new("flips", title, blocks);
    }
    let about = "Each set of changed rules, made to the old protocol alone, gives the new verdict, and no part of it does. Sets are separated by a semicolon.";
    let row = |flip: &Flip| {
        let set = |set: &Vec<String>| set.join(" + ");
        let sets = flip.minimal.iter().map(set).collect::<Vec<_>>().join("; ");
        vec![
            Cell::from(&flip.campaign),
            (&flip.before).into(),
            (&flip.after).into(),
            Cell::sentence(sets),
        ]
    };
    let table = Table::new("Verdicts that change, and why")
        .text("Campaign")
        .breaks(NAME)
        .short("Before")
        .short("After")
        .text("Rules that suffice")
        .rows(found.flips.iter().map(row));
    let mut blocks = vec![Block::text(about), table.into()];
    let short: Vec<String> = found
        .flips
        .iter()
        .filter(|flip| !flip.exact)
        .map(|flip| format!("{}: sets of up to {}", flip.campaign, count(flip.looked_at, "rule")))
        .collect();
    if !short.is_empty() {
        blocks.push(Block::text("Too many rules touch these verdicts for all sets to be looked at. Those above are such sets; there may be others."));
        blocks.push(Block::list(short));
    }
    Chapter::new("flips", title, blocks)
}

fn limits(margin: &Margin) -> [Cell; 4] {
    let digits = |value| Cell::number(value, Format::Significant(4));
    let rule = Cell::sentence(&margin.rule);
    [rule, digits(margin.value), digits(margin.flips_at), number::unit(&margin.unit).into()]
}

fn limit_columns(table: Table) -> Table {
    table.text("Limit").numbers(["In the new protocol", "Another verdict beyond"]).short("Unit")
}

fn margins(found: &Impact) -> Chapter {
    let about = "The limit at which the verdict under the new protocol becomes another one, all other rules unchanged. Limits that are shares of it change with it.";
    let mut blocks = vec![Block::text(about)];
    let of_flip = |flip: &Flip| {
        let row = |margin: &Margin| {
            let changed = if margin.changed { "yes" } else { "no" };
            let first = [Cell::from(&flip.campaign)].into_iter();
            first.chain(limits(margin)).chain([changed.into()]).collect::<Vec<_>>()
        };
        flip.margin.iter().map(row).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<Cell>> = found.flips.iter().flat_map(of_flip).collect();
    let campaign = |caption: &str| Table::new(caption).text("Campaign").breaks(NAME);
    if rows.is_empty() && !found.flips.is_empty() {
        blocks.push(Block::text("No limit by itself changes the verdict of a campaign above."));
    } else if !rows.is_empty() {
        let table = limit_columns(campaign("Limits that change a verdict back"));
        blocks.push(table.short("Changed").rows(rows).into());
    }
    if !found.near.is_empty() {
        let row = |near: &Near| {
            let first = [Cell::from(&near.campaign), (&near.verdict).into()].into_iter();
            first.chain(limits(&near.margin)).collect::<Vec<_>>()
        };
        let caption =
            "How close the others came: of each campaign the nearest of the changed limits";
        let table = limit_columns(campaign(caption).short("Verdict"));
        blocks.push(table.rows(found.near.iter().map(row)).into());
    }
    Chapter::new("margins", "How close it is", blocks)
}

fn shares(found: &Impact) -> Chapter {
    let percent = |share: f64| Cell::number(100.0 * share, Format::Fixed(1));
    let row =
        |of: &Share| cells![of.by, of.group, of.campaigns, percent(of.before), percent(of.after)];
    let about = "Campaigns whose verdict holds. Groups are the words that the protocol declares for vehicles and sections, where a campaign has one word for all of them.";
    let table = Table::new("Verdicts that hold")
        .text("By")
        .text("Group")
        .number("Campaigns")
        .number("Before")
        .unit("%")
        .number("After")
        .unit("%")
        .rows(found.shares.iter().map(row));
    Chapter::new("shares", "Shares", vec![Block::text(about), table.into()])
}

fn not_replayed(found: &Impact) -> Option<Chapter> {
    if found.not_replayed.is_empty() {
        return None;
    }
    let row = |of: &NotReplayed| {
        let sections = if of.sections { "yes" } else { "no" };
        cells![of.campaign, of.quantities.join(", "), sections]
    };
    let about = "Of these campaigns there are values and no records, and one of the protocols makes the values of these quantities in another way, or selects and checks sections in another way. Nothing is assumed of them.";
    let rows = found.not_replayed.iter().map(row);
    let table = Table::new("Campaigns that were not replayed")
        .text("Campaign")
        .breaks(NAME)
        .text("Quantities")
        .short("Sections too")
        .rows(rows);
    Some(Chapter::new("not-replayed", "Not replayed", vec![Block::text(about), table.into()]))
}

fn changes(found: &Impact) -> Chapter {
    let row = |of: &ChangedRule| {
        let words = |text: &Option<String>| Cell::or_missing(text.as_ref().map(Cell::sentence));
        let reason = of.reason.as_ref().map(|reason| Cell::sentence(reason.text().to_string()));
        let alone = reason.unwrap_or_else(|| "yes".into());
        vec![Cell::sentence(&of.rule), words(&of.before), words(&of.after), alone]
    };
    let about = format!(
        "The rules in which {} differs from {}, as far as they can touch a verdict. Besides, {} in titles, notes, sources and rules that nothing uses.",
        found.new.name,
        found.old.name,
        count(found.only_words, "difference")
    );
    let table = Table::new("Changed rules")
        .text("Rule")
        .text("Before")
        .text("After")
        .text("Can be applied alone")
        .rows(found.rules.iter().map(row));
    Chapter::new("rules", "Changed rules", vec![Block::text(about), table.into()])
}

fn archive(found: &Impact) -> Chapter {
    let row = |of: &Judged| {
        vec![
            Cell::from(&of.of.name),
            of.of.sections.into(),
            (&of.from).into(),
            Cell::or_missing(of.before.as_ref()),
            Cell::or_missing(of.after.as_ref()),
        ]
    };
    let table = Table::new("The archive")
        .text("Campaign")
        .breaks(NAME)
        .number("Sections")
        .short("From")
        .short("Before")
        .short("After")
        .rows(found.archive.iter().map(row));
    let about = "The hash of a campaign under Provenance is that of the hashes of its files, each on a line; impact.json has them all.";
    Chapter::new("archive", "Archive", vec![Block::text(about), table.into()])
}
