//! Texts of users in the report: they stay texts. A page is compared with the one of a harmless
//! text: the same tags with the same attributes in the same order, whatever the text. Only italics
//! and subscripts may differ: symbols of quantities are set with them.
//!
//! The PDF has no escape that could fail: Typst reads texts as data of a JSON file, and no template
//! evaluates text (`tests/language/templates.rs`).

use std::sync::LazyLock;

use fishplate::report::document::{Block, Cell, Chapter, Document, Fact, Run, Table, Text};
use fishplate::report::figure::canvas::{Canvas, Font, Group};
use fishplate::report::figure::figures;
use fishplate::report::html::html;
use fishplate::report::view::document;
use fishplate::result::{Reason, Remark};

use super::campaign::certified;

/// A chapter and a drawing.
pub fn escape(input: &[u8]) {
    static HARMLESS: LazyLock<Vec<String>> = LazyLock::new(|| tags(&small("x")));
    let Ok(text) = std::str::from_utf8(input) else { return };
    let found = compare(text, &HARMLESS, small);
    assert_eq!(found, *HARMLESS, "{text:?}");
}

/// A whole report with its figures.
pub fn report(input: &[u8]) {
    static HARMLESS: LazyLock<Vec<String>> = LazyLock::new(|| tags(&whole("x")));
    let Ok(text) = std::str::from_utf8(input) else { return };
    // How many labels a figure has room for depends on their length, so only the kinds of tags are
    // compared.
    compare(text, &HARMLESS, whole);
}

/// The tags of a page, none of which is unknown to the harmless page.
#[track_caller]
fn compare(text: &str, harmless: &[String], page: fn(&str) -> String) -> Vec<String> {
    // A text of nothing is left out of a page together with what would hold it.
    if text.trim().is_empty() {
        return harmless.to_vec();
    }
    let page = page(text);
    let found = tags(&page);
    let other = found.iter().find(|tag| !harmless.contains(tag));
    assert!(other.is_none(), "{text:?} becomes {other:?}");
    let raw = page.chars().find(|c| c.is_control() && !matches!(c, '\n' | '\t'));
    assert!(raw.is_none(), "{text:?} leaves {raw:?}");
    found
}

fn small(text: &str) -> String {
    let styled = [Run::Strong, Run::Emphasis, Run::Code, Run::Quiet, Run::Hash]
        .into_iter()
        .fold(Text::symbol(text), |all, style| all.then(style(text.into())));
    let row = vec![Cell::text(styled), Cell::symbol(text, text), Cell::from(text).strong()];
    let blocks = vec![
        Block::text(text),
        Block::heading(text),
        Block::list([text]),
        Block::Facts(vec![vec![Fact::new(text, text)]]),
        Block::Listing(vec![text.into()]),
        Table::new(text).text(text).short(text).number(text).rows([row]).into(),
    ];
    let document = Document {
        title: text.into(),
        program: "",
        issued: None,
        draft: false,
        cover: None,
        chapters: vec![Chapter::new("chapter", text, blocks)],
    };
    let page = html(&document, &[]).unwrap_or_else(|problems| panic!("{}", problems.render(false)));
    let mut canvas = Canvas::new(100.0, 50.0);
    let group =
        Group { title: Some(text), section: Some(text), zone: Some(text), ..Group::default() };
    canvas.group(&group, |layer| layer.text(text, (1.0, 2.0), &Font::left(8.0)));
    page + &canvas.finish()
}

fn whole(text: &str) -> String {
    let mut found = certified();
    for place in [
        &mut found.campaign.name,
        &mut found.protocol.name,
        &mut found.protocol.title,
        &mut found.protocol.verdict_rule,
    ] {
        text.clone_into(place);
    }
    found.notes = vec![Remark::Said { says: text.into() }];
    found.reasons = vec![Reason::said(text)];
    found.protocol.notes = vec![text.into()];
    found.protocol.edition = Some(text.into());
    for item in found.campaign.facts.iter_mut().chain(&mut found.campaign.vehicle) {
        item.value = text.into();
        item.name = text.into();
    }
    for item in &mut found.campaign.report.0 {
        item.value = item.value.as_ref().map(|_| text.into());
    }
    for channel in &mut found.protocol.channels {
        channel.title = text.into();
        channel.note = text.into();
    }
    for file in &mut found.campaign.files {
        file.path = text.into();
    }
    for parameter in &mut found.protocol.parameters {
        parameter.title = text.into();
        parameter.value = text.into();
    }
    for quantity in &mut found.quantities {
        quantity.title = text.into();
        quantity.symbol = text.into();
        quantity.notes = vec![text.into()];
        quantity.of = text.into();
        for value in &mut quantity.values {
            value.signal = text.into();
        }
    }
    for section in &mut found.sections {
        section.section = text.into();
        for item in &mut section.columns {
            item.value = text.into();
        }
    }
    for zone in &mut found.zones {
        zone.title = text.into();
    }
    for trace in &mut found.traces {
        trace.signal = text.into();
        trace.why = text.into();
    }
    let drawn = figures(&found);
    html(&document(&found), &drawn).unwrap_or_else(|problems| panic!("{}", problems.render(false)))
}

/// The tags of a page with the names of their attributes; what stands inside scripts and styles is
/// none.
#[track_caller]
fn tags(page: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut rest = page;
    while let Some(start) = rest.find('<') {
        rest = &rest[start + 1..];
        let end = end_of_tag(rest).unwrap_or_else(|| panic!("a tag without an end: {rest:.60}"));
        let tag = shape(&rest[..end]);
        rest = &rest[end + 1..];
        for raw in ["script", "style"] {
            if tag.split(' ').next() == Some(raw) {
                rest = rest.find(&format!("</{raw}")).map_or("", |at| &rest[at..]);
            }
        }
        if !["i", "/i", "sub", "/sub"].contains(&tag.as_str()) {
            found.push(tag);
        }
    }
    found
}

/// Where the `>` of a tag is, quotes passed over.
fn end_of_tag(text: &str) -> Option<usize> {
    let mut quote = None;
    text.char_indices().find_map(|(at, c)| {
        match quote {
            Some(open) if c == open => quote = None,
            None if matches!(c, '"' | '\'') => quote = Some(c),
            None if c == '>' => return Some(at),
            _ => {}
        }
        None
    })
}

/// The tag with its attributes' values left out.
fn shape(tag: &str) -> String {
    let mut text = String::new();
    let mut quote = None;
    for c in tag.chars() {
        match quote {
            Some(open) if c == open => quote = None,
            Some(_) => {}
            None if matches!(c, '"' | '\'') => quote = Some(c),
            None => text.push(c),
        }
    }
    text
}
