//! The protocol: identification, text, parameters, and deviations from its parent.

use crate::report::{document::*, number};
use crate::result::{Deviation, FilterInfo, ParameterInfo, ProtocolFile, ProtocolInfo};

/// The complete protocol.
pub fn chapter(protocol: &ProtocolInfo) -> Chapter {
    let hash = Run::Hash(protocol.sha256.clone());
    let mut blocks = vec![Block::Facts(vec![facts([
        ("Name", (&protocol.name).into()),
        ("Title", (&protocol.title).into()),
        ("Edition", (&protocol.edition).into()),
        ("Source", (&protocol.source).into()),
        ("Scope", (&protocol.scope).into()),
        ("Verdict rule", (&protocol.verdict_rule).into()),
        ("Hash", hash.into()),
    ])])];
    if !protocol.notes.is_empty() {
        blocks.push(Block::list(protocol.notes.iter().map(number::raised)));
    }
    if protocol.files.len() > 1 || !protocol.deviations.is_empty() {
        blocks.push(Block::heading("Deviations from the parent protocol"));
        blocks.push(deviations(&protocol.deviations));
    }
    if !protocol.parameters.is_empty() {
        blocks.push(Block::heading("Parameters"));
        blocks.push(parameters(protocol).into());
    }
    let graph: Vec<Block> = graph(protocol).into_iter().map(Block::from).collect();
    // A page of its own; what follows it on paper is long, so that no page stays nearly empty.
    blocks.push(Block::on_paper(graph.iter().cloned()));
    if !protocol.filters.is_empty() {
        blocks.push(Block::heading("Filters"));
        blocks.push(filters(protocol).into());
    }
    blocks.push(Block::on_screen(graph));
    blocks.extend(protocol.files.iter().flat_map(listing));
    Chapter::new("protocol", "Protocol", blocks)
}

fn deviations(all: &[Deviation]) -> Block {
    if all.is_empty() {
        return Block::text("No rule differs from the parent protocol.");
    }
    let row = |one: &Deviation| {
        let side = |text: &Option<String>, none: &str| Cell::from(text.as_deref().unwrap_or(none));
        cells![one.rule, side(&one.before, "not present"), side(&one.after, "removed")]
    };
    Table::new("Rules that differ in meaning")
        .text("Rule")
        .wide(1.1)
        .text("Parent")
        .wide(1.0)
        .text("This protocol")
        .wide(1.0)
        .rows(all.iter().map(row))
        .class("")
        .into()
}

/// What each parameter is, and whether its number is to be confirmed: against the standard, if the
/// protocol names its source.
fn parameters(protocol: &ProtocolInfo) -> Table {
    let against = if protocol.source.is_some() { " against the standard" } else { "" };
    let row = |parameter: &ParameterInfo| {
        let confirm = |why: &String| {
            Text::from(Run::Emphasis(format!("To be confirmed{against}."))).and(format!(" {why}"))
        };
        let title = Some(Text::from(&parameter.title));
        let used = Cell::from(&parameter.value);
        vec![
            Run::Code(parameter.name.clone()).into(),
            Text::lines(title.into_iter().chain(parameter.unconfirmed.as_ref().map(confirm)))
                .into(),
            if parameter.value == parameter.default { used } else { used.strong() },
            (&parameter.default).into(),
            (&parameter.set_by).into(),
        ]
    };
    let caption = "Parameters of the protocol, values used and defaults";
    Table::new(caption)
        .text("Name")
        .wide(1.0)
        .text("Meaning")
        .wide(2.0)
        .short("Used")
        .short("Default")
        .short("Set by")
        .rows(protocol.parameters.iter().map(row))
}

fn filters(protocol: &ProtocolInfo) -> Table {
    let row = |filter: &FilterInfo| {
        let source = filter.source.as_deref();
        let source = source.map(|one| super::with_work(one, protocol.source.as_deref()));
        cells![Run::Code(filter.name.clone()), filter.title, filter.steps, Cell::or_missing(source)]
    };
    let rows = protocol.filters.iter().map(row);
    Table::new("Filters with the settings used")
        .short("Name")
        .text("Title")
        .wide(1.0)
        .text("Steps")
        .wide(1.2)
        .text("Source")
        .wide(1.7)
        .rows(rows)
        .class("")
}

fn graph(protocol: &ProtocolInfo) -> Option<Figure> {
    let nodes = protocol.graph_nodes;
    let caption = format!(
        "Processing graph, {nodes} operations; those of plausibility rules alone are not drawn"
    );
    let alt = format!(
        "Processing graph of the protocol with {nodes} operations, from the channels to the statistics."
    );
    let figure = Figure::new("graph", caption, alt, 220);
    let drawn = !protocol.graph_svg.trim().is_empty();
    drawn.then_some(Figure { page: Some("Processing graph"), ..figure })
}

/// A file line by line, with tabs as four spaces and no trailing white space.
fn listing(file: &ProtocolFile) -> [Block; 3] {
    let line = |line: &str| line.replace('\t', "    ").trim_end().to_owned();
    [
        Block::heading(format!("Text: {}", file.name)),
        Block::text(Run::Hash(file.sha256.clone())),
        Block::Listing(file.text.lines().map(line).collect()),
    ]
}
