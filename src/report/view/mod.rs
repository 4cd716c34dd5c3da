//! The result of a certification as a document: numbers rounded, lists sorted, sentences
//! formulated.

mod application;
mod brief;
mod campaign;
mod cover;
mod domain;
mod groups;
mod identity;
mod notation;
mod protocol;
mod provenance;
mod quantity;
mod reports;
mod search;
mod section;
mod spread;
mod statements;
mod statistic;
mod summary;
mod values;
mod verdicts;
mod wording;

use crate::report::{
    document::*,
    number,
    sides::{self, capital},
};
use crate::result::{CampaignInfo, Certification, ProtocolInfo, QuantityResult, Trace};
use provenance::{Kind, provenance};
use wording::Wording;

/// A certification and what all its chapters need to know of it.
struct View<'a> {
    found: &'a Certification,
    words: Wording,
    /// Symbols of the quantities.
    symbols: Symbols,
    /// The document that the protocol names as its source.
    work: Option<&'a str>,
}

/// The certification as printed in both reports.
pub fn document(found: &Certification) -> Document {
    let shortened: Vec<String> =
        found.quantities.iter().map(|quantity| symbol(&quantity.symbol)).collect();
    let view = &View {
        found,
        words: wording::wording(found),
        symbols: Symbols::new(shortened.iter().map(String::as_str)),
        work: found.protocol.source.as_deref(),
    };
    let mut chapters =
        vec![identity::chapter(view), summary::chapter(view), campaign::chapter(&found.campaign)];
    chapters.push(notation::chapter(view));
    chapters.extend(section::chapter(view));
    chapters.extend(quantity::chapter(view));
    chapters.extend(traces(found));
    chapters.extend(domain::chapter(view));
    chapters.push(protocol::chapter(&found.protocol));
    chapters.push(provenance(&found.campaign, &found.protocol, Kind::Certification));
    chapters.push(statements::chapter(view));
    Document {
        title: title(view),
        program: PROGRAM,
        issued: identity::issued(&found.campaign.report),
        draft: found.draft,
        cover: Some(cover::cover(view)),
        chapters,
    }
}

/// What a study, a comparison or a diagnosis came to, on its cover.
#[derive(Debug)]
pub struct Opening {
    pub headline: Finding,
    pub sentence: String,
    pub facts: Vec<Fact>,
}

/// A document about many evaluations of a campaign by a protocol.
pub fn study(
    (title, over): (String, &str),
    opening: Opening,
    (campaign, protocol): (&CampaignInfo, &ProtocolInfo),
    mut chapters: Vec<Chapter>,
) -> Document {
    let Opening { headline, sentence, facts } = opening;
    let result = ResultBox { label: None, finding: headline, note: None, sentence };
    let cover = cover::margins(campaign, protocol, over, result);
    chapters.push(provenance(campaign, protocol, Kind::Study));
    Document {
        title,
        program: PROGRAM,
        issued: identity::issued(&campaign.report),
        draft: false,
        cover: Some(Cover { blocks: vec![Block::Tiles(facts)], ..cover }),
        chapters,
    }
}

fn title(view: &View<'_>) -> String {
    format!("{}: {}", view.words.report, view.found.campaign.name)
}

/// First words of a place inside a document.
const PLACES: [&str; 10] =
    ["Table", "Section", "Clause", "Annex", "Chapter", "Figure", "Equation", "Page", "p.", "§"];

/// Whether a text is only a place inside a document: `Table 1, footnote`.
fn is_place(text: &str) -> bool {
    PLACES.iter().any(|word| {
        text.strip_prefix(word).is_some_and(|rest| {
            rest.trim_start().starts_with(|c: char| c.is_ascii_digit() || c.is_ascii_uppercase())
        })
    })
}

/// The source of a rule, completed by the document that the protocol names.
fn with_work(source: &str, work: Option<&str>) -> String {
    let Some(work) = work.filter(|_| is_place(source)) else { return source.to_owned() };
    // The protocol may itself name a place of the document.
    let whole =
        work.rsplit_once(", ").filter(|(_, last)| is_place(last)).map_or(work, |(whole, _)| whole);
    format!("{whole}, {source}")
}

/// The name of a section, signal or zone, shortened for a table.
fn name(text: &str) -> String {
    cut(text, NAME)
}

/// The symbol of a quantity, shortened for a table.
fn symbol(text: &str) -> String {
    cut(text, SYMBOL)
}

/// A caption with the symbol of a quantity, after some words.
fn caption(before: &str, quantity: &QuantityResult) -> Text {
    Text::from(before).with(Text::symbol(&symbol(&quantity.symbol)))
}

/// `, in kN`; nothing for a dimensionless quantity.
fn in_unit(quantity: &QuantityResult) -> String {
    let unit = number::unit(&quantity.unit);
    if unit == number::NONE { String::new() } else { format!(", in {unit}") }
}

/// Removes the middle of a long text, since names usually differ at their ends.
fn cut(name: &str, most: usize) -> String {
    let letters: Vec<char> = name.chars().collect();
    if letters.len() <= most {
        return name.to_owned();
    }
    let half = most / 2;
    letters[..half].iter().chain(&['…']).chain(&letters[letters.len() - half..]).collect()
}

/// Maximum length of a printed name of a section or signal.
const NAME: usize = 80;
/// Maximum length of a printed symbol.
const SYMBOL: usize = 32;

/// The curves of a trace in words.
fn curves(trace: &Trace, found: &Certification) -> String {
    if !trace.others.is_empty() {
        let names: Vec<&str> = trace
            .record
            .iter()
            .chain(trace.others.iter().map(|(name, _)| name))
            .map(String::as_str)
            .collect();
        return format!("Records {}:", names.join(", "));
    }
    let (simulated, measured) = sides::of_trace(trace, found);
    match (trace.simulated.y.is_empty(), trace.measured.y.is_empty()) {
        (true, false) => capital(measured),
        (false, true) => capital(simulated),
        _ => format!("{} and {measured}", capital(simulated)),
    }
}

fn traces(found: &Certification) -> Option<Chapter> {
    let about = "Signals are filtered as specified; the evaluated section is shaded.";
    let mut blocks = vec![Block::text(about)];
    for (at, trace) in found.traces.iter().enumerate() {
        let quantity = found.quantities.iter().find(|quantity| quantity.id == trace.quantity);
        let title = quantity.map_or(&trace.quantity, |quantity| &quantity.title);
        blocks.push(Block::on_screen([Block::heading(title)]));
        blocks.push(drawing(at, trace, found).into());
    }
    let chapter = Chapter::new("traces", "Signals of the decisive sections", blocks);
    (!found.traces.is_empty()).then(|| chapter.called("Signals"))
}

fn drawing(at: usize, trace: &Trace, found: &Certification) -> Figure {
    let zone = trace.zone.as_ref().map(|zone| format!(", zone {zone}")).unwrap_or_default();
    let (signal, section) = (name(&trace.signal), name(&trace.section));
    let alt = format!(
        "{} {} [{}] over {} [{}], section {} from {} to {}.",
        curves(trace, found),
        trace.signal,
        number::unit(&trace.unit),
        trace.axis,
        number::unit(&trace.axis_unit),
        trace.section,
        number::significant(trace.start, 6),
        number::significant(trace.end, 6)
    );
    let caption = format!("{signal} in section {section}{zone}: {}", trace.why);
    Figure::new(format!("trace-{at}"), caption, alt, 90)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_told_with_its_work() {
        let work = Some("A & B, A title, with a comma, Table 1");
        assert_eq!(with_work("Table 1", work), "A & B, A title, with a comma, Table 1");
        assert_eq!(with_work("Section 3.2", work), "A & B, A title, with a comma, Section 3.2");
        assert_eq!(with_work("Common practice", work), "Common practice");
        assert_eq!(
            (with_work("Table 1", None), with_work("Tableau", work)),
            ("Table 1".into(), "Tableau".into())
        );
        assert_eq!(with_work("Table 2", Some("ISO 1")), "ISO 1, Table 2");
    }

    #[test]
    fn long_names_keep_their_ends() {
        assert_eq!(name("S01"), "S01");
        assert_eq!(cut("abcdefghij", 4), "ab…ij");
        assert_eq!(cut("äöüß", 4), "äöüß");
    }
}
