//! The cover: verdict, reasons, key facts.

use std::collections::BTreeSet;

use super::{View, campaign, identity, statistic, verdicts, wording};
use crate::report::{
    document::*,
    number::{self, raised},
    rules,
};
use crate::result::{
    CampaignInfo, Certification, Kind, ProtocolInfo, QuantityResult, Reason, Removed, Verdict,
};

/// Reasons on the cover, and where a table of verdicts takes their room; the summary lists all.
const REASONS: usize = 8;
const REASONS_BESIDE_VERDICTS: usize = 3;
/// Limitations on the cover; the summary lists all.
const LIMITATIONS: usize = 3;
/// Verdicts with a name that the cover has room for.
pub const VERDICTS: usize = 6;
/// Letters of a hash in the margin of each page.
const HASH: usize = 16;

/// What the covers of all documents have in common; `over` is the kind of document, `result` what
/// it came to.
pub fn margins(
    campaign: &CampaignInfo,
    protocol: &ProtocolInfo,
    over: &str,
    result: ResultBox,
) -> Cover {
    let subject = if protocol.title.is_empty() { &protocol.name } else { &protocol.title };
    Cover {
        short: "Result",
        over: over.to_owned(),
        name: campaign.name.clone(),
        subject: subject.clone(),
        edition: protocol.edition.clone(),
        line: identity::line(&campaign.report),
        sha256: protocol.sha256.chars().take(HASH).collect(),
        result,
        blocks: Vec::new(),
        parts_in_contents: false,
    }
}

pub fn cover(view: &View<'_>) -> Cover {
    let found = view.found;
    let title = found.verdicts.iter().find(|verdict| verdict.overall).map(|one| &one.title);
    let origin = found.campaign.origin.as_ref().map(|origin| format!(" {}.", origin.says));
    let result = ResultBox {
        label: Some(title.map_or("Verdict".into(), |title| format!("Verdict: {title}"))),
        finding: finding(view),
        note: found.beside_the_verdict(),
        sentence: [wording::sentence(found).to_owned(), origin.unwrap_or_default(), decides(found)]
            .concat(),
    };
    let mut blocks = Vec::from_iter(beside(view));
    blocks.extend(reasons(view));
    blocks.extend(limitations(view, LIMITATIONS));
    blocks.extend(verdicts_with_a_name(view));
    blocks.push(Block::Tiles(key_facts(view)));
    blocks.extend(identification(view));
    Cover {
        short: "Verdict",
        blocks,
        parts_in_contents: true,
        ..margins(&found.campaign, &found.protocol, &view.words.over, result)
    }
}

/// What the reader must know of the rules to read the verdict.
fn beside(view: &View<'_>) -> Option<Block> {
    let says = rules::beside_verdict(view.found);
    let says: Vec<_> = says.into_iter().map(|says| view.symbols.text(&raised(says))).collect();
    (!says.is_empty()).then_some(Block::Boxed { tone: None, title: "Rules", entries: says })
}

/// What the overall verdict came to.
pub fn finding(view: &View<'_>) -> Finding {
    let (found, word) = (view.found, view.found.verdict_word());
    let holds = match found.verdict {
        Verdict::Validated => Some(true),
        Verdict::NotValidated => Some(false),
        Verdict::NotAssessable => None,
    };
    match verdicts::overall(found) {
        Some(outcome) => verdicts::finding(outcome, word),
        None => Finding::new(holds, word, word, word),
    }
}

/// The statistic that is closest to its limit, or furthest beyond, with its interval.
fn decides(found: &Certification) -> String {
    let met = found.verdict == Verdict::Validated;
    let all = found.quantities.iter().flat_map(|quantity| {
        quantity.statistics.iter().map(move |statistic| (quantity, statistic))
    });
    let deciding = all.filter(|(_, one)| one.holds == Some(met) && one.normalised.is_some());
    let (Some((quantity, one)), true) = (
        deciding.max_by(|(_, a), (_, b)| {
            a.normalised.unwrap_or(0.0).total_cmp(&b.normalised.unwrap_or(0.0))
        }),
        found.verdict != Verdict::NotAssessable,
    ) else {
        return String::new();
    };
    let printed = |cell: Cell| cell.printed().letters();
    let [value, limit] = [statistic::value(Some(one)), statistic::limit(Some(one))].map(printed);
    let [interval, ..] = statistic::interval(one).map(printed);
    let interval = match one.interval {
        Some(_) => format!(" (95 % interval {interval})"),
        None => String::new(),
    };
    let how = if met { "Closest to its limit" } else { "Furthest beyond its limit" };
    let unit = number::unit(&one.unit);
    let unit = if unit == number::NONE { String::new() } else { format!(" {unit}") };
    format!(
        " {how}: {} of {}, {value}{unit}{interval}, limit {limit}{unit}.",
        number::formula(&one.title),
        super::symbol(&quantity.symbol)
    )
}

/// What limits the verdict, of which the first are printed where there is little room.
pub fn limitations(view: &View<'_>, most: usize) -> Option<Block> {
    let notes = &view.found.notes;
    let mut entries: Vec<Text> = notes
        .iter()
        .take(most)
        .map(|note| view.symbols.text(&number::raised(note.text())))
        .collect();
    if notes.len() > most {
        entries.push(format!("All {} limitations are listed in the summary.", notes.len()).into());
    }
    let title = "Limitations";
    (!entries.is_empty()).then_some(Block::Boxed { tone: None, title, entries })
}

fn on_cover(view: &View<'_>) -> bool {
    (1..=VERDICTS).contains(&view.found.verdicts.len())
}

fn reasons(view: &View<'_>) -> Vec<Block> {
    let all = verdicts::reasons(view);
    if all.is_empty() {
        return Vec::new();
    }
    let most = if on_cover(view) { REASONS_BESIDE_VERDICTS } else { REASONS };
    let more = if all.len() > REASONS {
        format!("All {} reasons are listed in the summary.", all.len())
    } else {
        "All reasons are listed in the summary.".to_owned()
    };
    let mut first = vec![
        Block::text(Run::Strong("Reasons".into())),
        Block::List(all.iter().take(most).cloned().collect()),
    ];
    if all.len() > most {
        first.push(Block::text(more));
    }
    let screen = [Block::heading("Reasons"), Block::List(all)];
    vec![Block::on_paper(first), Block::on_screen(screen)]
}

fn verdicts_with_a_name(view: &View<'_>) -> Vec<Block> {
    let count = view.found.verdicts.len();
    let paper = if on_cover(view) {
        vec![verdicts::table(view, true).into()]
    } else if count > 0 {
        vec![Block::text(format!(
            "The results of the {count} verdicts with a name stand in the summary."
        ))]
    } else {
        return Vec::new();
    };
    let screen = [verdicts::table(view, false).into()];
    vec![Block::on_paper(paper), Block::on_screen(screen)]
}

/// What is known of campaign and protocol, in two columns, so that the cover stays one page with as
/// many reasons as it lists.
fn identification(view: &View<'_>) -> Vec<Block> {
    let (campaign, protocol) = (&view.found.campaign, &view.found.protocol);
    let stated = identity::on_cover(&campaign.report);
    // Of a rule that does not hold, a reason tells it.
    let drawn = view.found.drawn.iter();
    let drawn = drawn.filter(|one| one.verdict.is_none() && one.holds() == Some(true));
    let rules = facts([
        ("Protocol", (&protocol.name).into()),
        ("Verdict rule", (&protocol.verdict_rule).into()),
        (
            "Draws",
            Text::lines(drawn.map(|one| Reason::InDraws(one.clone()).text().to_string().into())),
        ),
        ("Source", (&protocol.source).into()),
    ]);
    let hash = Fact::new("Protocol hash", Run::Hash(protocol.sha256.clone()));
    let all = [&stated[..], &rules, std::slice::from_ref(&hash)].concat();
    let plain = CampaignInfo {
        facts: campaign.facts.iter().filter(|one| !one.name.contains(": ")).cloned().collect(),
        ..campaign.clone()
    };
    let own = campaign::on_cover(&campaign::facts(&plain));
    let mut paper = vec![Block::Facts(vec![stated, [rules, own].concat()])];
    // With a table of verdicts there is no room; the data stand in the chapter of the vehicle.
    let mut used = campaign::on_cover(&campaign::vehicle(campaign, true));
    if !used.is_empty() && !on_cover(view) {
        let other = used.split_off(used.len().div_ceil(2));
        paper.push(Block::text(Run::Strong("Vehicle data used by the protocol".into())));
        paper.push(Block::Facts(vec![used, other]));
    }
    paper.push(Block::Facts(vec![vec![hash]]));
    vec![Block::on_paper(paper), Block::on_screen([Block::Facts(vec![all])])]
}

/// `12 used, 2 removed, 3 left out of the table`.
fn sections(found: &Certification) -> String {
    let Removed { used, removed, left_out } =
        Removed::of(&found.sections, &found.campaign.outside_table);
    let deselected = found.sections.len().saturating_sub(used + removed);
    let others =
        [(removed, "removed"), (deselected, "not selected"), (left_out, "left out of the table")];
    let others = others.iter().filter(|(count, _)| *count > 0);
    let others = others.map(|(count, what)| format!(", {count} {what}"));
    format!("{used} of {} used{}", found.sections.len(), others.collect::<String>())
}

fn key_facts(view: &View<'_>) -> Vec<Fact> {
    let found = view.found;
    let deciding: Vec<&QuantityResult> =
        found.quantities.iter().filter(|quantity| !quantity.decides_nothing()).collect();
    let holding = deciding.iter().filter(|quantity| quantity.holds == Some(true)).count();
    let failing = deciding.iter().filter(|quantity| quantity.holds == Some(false)).count();
    let open = deciding.len() - holding - failing;
    let mut quantities = format!("{holding} of {} met", deciding.len());
    if failing > 0 {
        quantities.push_str(&format!(", {failing} not met"));
    }
    if open > 0 {
        quantities.push_str(&format!(", {open} not assessed"));
    }
    let rows = |assessed: bool| {
        let kind = found.quantities.iter().filter(|quantity| quantity.from.is_some() == assessed);
        number::count(kind.map(|quantity| quantity.values.len() as u64).sum())
    };
    if found.verdict == Verdict::NotAssessable {
        quantities.push_str(" (preliminary)");
    }
    let mut facts = vec![Fact::new("Criteria by quantity", quantities)];
    if !found.campaign.members.is_empty() {
        facts.push(Fact::new("Campaigns", found.campaign.members.len().to_string()));
    }
    facts.push(Fact::new("Sections", sections(found)));
    let compared = |name: &str| Fact::new(name, rows(false));
    let pairs = || {
        let compared = found.quantities.iter().filter(|quantity| quantity.from.is_none());
        let counts = compared.map(|quantity| quantity.values.len() as u64);
        let counts: BTreeSet<u64> = counts.filter(|count| *count > 0).collect();
        let ends = [counts.first(), counts.last()].map(|end| number::count(*end.unwrap_or(&0)));
        let pairs = if counts.len() > 1 { ends.join(" to ") } else { ends[0].clone() };
        Fact::new("Pairs per quantity", pairs)
    };
    let assessed = Fact::new("Assessed values", rows(true));
    match found.kind() {
        Kind::Validation => facts.push(pairs()),
        Kind::Comparison => facts.push(compared("Compared values")),
        Kind::Assessment => facts.push(assessed),
        Kind::Mixed => facts.extend([pairs(), assessed]),
    }
    // Of wanted operation, which the verdict does not speak of.
    let wanted = || found.application.iter().flat_map(|domain| &domain.points);
    if wanted().next().is_some() {
        let inside = wanted().filter(|point| point.inside == Some(true)).count();
        let says = format!("{inside} of {} points inside", wanted().count());
        facts.push(Fact::new("Wanted operation", says));
    }
    if !found.zones.is_empty() {
        let filled = found.zones.iter().filter(|zone| zone.holds).count();
        let says = format!("{filled} of {} with enough sections", found.zones.len());
        facts.push(Fact::new("Test zones", says));
    }
    facts
}
