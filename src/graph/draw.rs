//! The graph as an SVG picture. Each stage is a column; nodes of the same kind at different
//! positions are one box; crossings are few.

use std::fmt::Write;

use super::{Graph, NodeId, Operation, Stage};

const COLUMN: f64 = 148.0;
const BOX_WIDTH: f64 = 128.0;
const LINE: f64 = 13.0;
const GAP: f64 = 8.0;
const TOP: f64 = 34.0;
/// Number of characters on a line of a box in the font size used.
const CHARACTERS: usize = 19;
/// Height of the line with the number of nodes of a box, below its text.
const COUNT_LINE: f64 = 11.0;
const MOST_LINES: usize = 6;
const SWEEPS: usize = 12;

/// A box of the picture.
struct Card {
    /// Column. Values of reduced signals are placed right of their inputs, although both belong to
    /// one stage.
    column: (Stage, bool),
    lines: Vec<String>,
    count: usize,
    inputs: Vec<usize>,
    y: f64,
}

/// A self-contained SVG; texts are escaped.
pub fn svg(graph: &Graph) -> String {
    let mut cards = cards(graph);
    let mut stages: Vec<(Stage, bool)> = cards.iter().map(|card| card.column).collect();
    stages.sort_unstable();
    stages.dedup();
    let columns: Vec<Vec<usize>> = stages
        .iter()
        .map(|stage| (0..cards.len()).filter(|&index| cards[index].column == *stage).collect())
        .collect();
    let height = place(&mut cards, columns);
    let width = COLUMN * stages.len() as f64;
    draw(&cards, &stages, width, height)
}

/// The nodes that verdicts and section checks need. Plausibility rules are left out: they use every
/// channel and would make the picture unreadable.
fn drawn(graph: &Graph) -> Vec<bool> {
    let mut drawn = vec![false; graph.nodes.len()];
    let mut open: Vec<NodeId> = graph
        .checks
        .iter()
        .flatten()
        .map(|input| input.node)
        .chain(graph.verdicts.iter().copied())
        .collect();
    while let Some(id) = open.pop() {
        if !std::mem::replace(&mut drawn[id], true) {
            open.extend(&graph.nodes[id].inputs);
        }
    }
    drawn
}

/// Nodes of one class become one box, and so do all statistics or limits of one quantity.
fn cards(graph: &Graph) -> Vec<Card> {
    let mut card_of_class: Vec<Option<usize>> =
        vec![None; graph.nodes.iter().map(|node| node.class + 1).max().unwrap_or(0)];
    let mut members: Vec<Vec<NodeId>> = Vec::new();
    let drawn = drawn(graph);
    for (id, node) in graph.nodes.iter().enumerate().filter(|(id, _)| drawn[*id]) {
        match card_of_class[node.class] {
            Some(card) => members[card].push(id),
            None => {
                card_of_class[node.class] = Some(members.len());
                members.push(vec![id]);
            }
        }
    }
    let card_of: Vec<usize> =
        graph.nodes.iter().map(|node| card_of_class[node.class].unwrap_or(0)).collect();
    members
        .iter()
        .enumerate()
        .map(|(index, members)| {
            let first = &graph.nodes[members[0]];
            let mut inputs: Vec<usize> = members
                .iter()
                .flat_map(|&id| graph.nodes[id].inputs.iter().map(|&input| card_of[input]))
                .filter(|&input| input != index)
                .collect();
            inputs.sort_unstable();
            inputs.dedup();
            let count = if matches!(
                first.operation,
                Operation::Estimate(_) | Operation::Report(_) | Operation::Limit(_)
            ) {
                1
            } else {
                members.len()
            };
            let stage = first.operation.stage();
            let column = (stage, matches!(first.operation, Operation::Value(_)));
            Card { column, lines: wrapped(&label(graph, members)), count, inputs, y: 0.0 }
        })
        .collect()
}

fn label(graph: &Graph, members: &[NodeId]) -> String {
    let labels = || members.iter().map(|&id| &graph.nodes[id].label);
    let first = &graph.nodes[members[0]];
    match (&first.operation, &first.label.subject) {
        (Operation::Read { .. } | Operation::Arithmetic(_), _) => {
            shortened(&labels().map(|label| label.text.as_str()).collect::<Vec<_>>().join(", "))
        }
        (_, Some(quantity)) => {
            let mut all: Vec<&str> = labels().map(|label| label.what.as_str()).collect();
            // A limit `for each zone` is one line.
            all.dedup();
            format!("{quantity}: {}", all.join("; "))
        }
        (_, None) => first.label.what.clone(),
    }
}

fn shortened(text: &str) -> String {
    let most = CHARACTERS * MOST_LINES - 2;
    if text.chars().count() <= most {
        text.to_string()
    } else {
        text.chars().take(most).collect::<String>() + " …"
    }
}

fn wrapped(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let last = lines.len() - 1;
        if !lines[last].is_empty()
            && lines[last].chars().count() + 1 + word.chars().count() > CHARACTERS
        {
            lines.push(word.chars().take(CHARACTERS).collect());
        } else {
            if !lines[last].is_empty() {
                lines[last].push(' ');
            }
            lines[last].extend(word.chars().take(CHARACTERS));
        }
    }
    if lines.len() > MOST_LINES {
        lines.truncate(MOST_LINES);
        lines[MOST_LINES - 1].push_str(" …");
    }
    lines
}

fn card_height(card: &Card) -> f64 {
    card.lines.len() as f64 * LINE + 8.0 + if card.count > 1 { COUNT_LINE } else { 0.0 }
}

/// Orders each column by the mean height of neighbours, in sweeps to the right and to the left;
/// returns the height of the picture.
fn place(cards: &mut [Card], mut columns: Vec<Vec<usize>>) -> f64 {
    let tallest = columns
        .iter()
        .map(|column| column.iter().map(|&index| card_height(&cards[index]) + GAP).sum::<f64>())
        .fold(0.0, f64::max);
    let mut outputs: Vec<Vec<usize>> = vec![Vec::new(); cards.len()];
    for (index, card) in cards.iter().enumerate() {
        for &input in &card.inputs {
            outputs[input].push(index);
        }
    }
    stack(cards, &columns, tallest);
    for sweep in 0..SWEEPS {
        let forward = sweep % 2 == 0;
        let order: Vec<usize> =
            if forward { (0..columns.len()).collect() } else { (0..columns.len()).rev().collect() };
        for column in order {
            let wish = |index: usize| {
                let near: &[usize] = if forward { &cards[index].inputs } else { &outputs[index] };
                if near.is_empty() {
                    cards[index].y
                } else {
                    near.iter().map(|&other| cards[other].y).sum::<f64>() / near.len() as f64
                }
            };
            let mut wished: Vec<(f64, usize)> =
                columns[column].iter().map(|&index| (wish(index), index)).collect();
            wished.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            columns[column] = wished.iter().map(|(_, index)| *index).collect();
            stack(cards, &columns, tallest);
        }
    }
    TOP + tallest + GAP
}

/// Spreads the boxes of each column evenly over the height.
fn stack(cards: &mut [Card], columns: &[Vec<usize>], tallest: f64) {
    for column in columns {
        let own: f64 = column.iter().map(|&index| card_height(&cards[index])).sum();
        let gap = (tallest - own) / (column.len() as f64 + 1.0);
        let mut y = TOP + gap;
        for &index in column {
            cards[index].y = y;
            y += card_height(&cards[index]) + gap;
        }
    }
}

fn draw(cards: &[Card], stages: &[(Stage, bool)], width: f64, height: f64) -> String {
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" height=\"{height:.0}\" \
         font-family=\"IBM Plex Sans\" font-size=\"11\">\n<rect width=\"{width:.0}\" height=\"{height:.0}\" fill=\"#ffffff\"/>\n"
    );
    let x_of = |stage: (Stage, bool)| {
        stages.iter().position(|known| *known == stage).unwrap_or(0) as f64 * COLUMN
            + (COLUMN - BOX_WIDTH) / 2.0
    };
    for stage in stages {
        let x = x_of(*stage) + BOX_WIDTH / 2.0;
        let _ = writeln!(
            out,
            "<text x=\"{x:.1}\" y=\"20\" text-anchor=\"middle\" font-size=\"13\" font-weight=\"600\" fill=\"#1f3a5f\">{}</text>",
            stage.0.in_words()
        );
    }
    for card in cards {
        for &input in &card.inputs {
            let from = &cards[input];
            let (x1, y1) = (x_of(from.column) + BOX_WIDTH, from.y + card_height(from) / 2.0);
            let (x2, y2) = (x_of(card.column), card.y + card_height(card) / 2.0);
            if x2 > x1 {
                let middle = (x1 + x2) / 2.0;
                let _ = writeln!(
                    out,
                    "<path d=\"M{x1:.1} {y1:.1} C{middle:.1} {y1:.1} {middle:.1} {y2:.1} {x2:.1} {y2:.1}\" fill=\"none\" stroke=\"#8a97a8\" stroke-width=\"0.7\"/>"
                );
            } else {
                // Both boxes are in one column: a loop on the right side.
                let (x, bend) = (x1, x1 + 16.0);
                let y2 = card.y + card_height(card) / 2.0;
                let _ = writeln!(
                    out,
                    "<path d=\"M{x:.1} {y1:.1} C{bend:.1} {y1:.1} {bend:.1} {y2:.1} {x:.1} {y2:.1}\" fill=\"none\" stroke=\"#8a97a8\" stroke-width=\"0.7\"/>"
                );
            }
        }
    }
    for card in cards {
        let (x, h) = (x_of(card.column), card_height(card));
        if card.count > 1 {
            let _ = writeln!(
                out,
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{BOX_WIDTH}\" height=\"{h:.1}\" rx=\"2\" fill=\"#dfe6ee\" stroke=\"#5b6b7f\" stroke-width=\"0.6\"/>",
                x + 3.0,
                card.y + 3.0
            );
        }
        let _ = writeln!(
            out,
            "<rect x=\"{x:.1}\" y=\"{:.1}\" width=\"{BOX_WIDTH}\" height=\"{h:.1}\" rx=\"2\" fill=\"#f6f8fa\" stroke=\"#5b6b7f\" stroke-width=\"0.6\"/>",
            card.y
        );
        for (number, line) in card.lines.iter().enumerate() {
            let y = card.y + 13.0 + number as f64 * LINE;
            let _ = writeln!(
                out,
                "<text x=\"{:.1}\" y=\"{y:.1}\" fill=\"#1b1f24\">{}</text>",
                x + 5.0,
                escaped(line)
            );
        }
        if card.count > 1 {
            let _ = writeln!(
                out,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" font-size=\"10\" fill=\"#1f3a5f\">×{}</text>",
                x + BOX_WIDTH - 4.0,
                card.y + h - 3.0,
                card.count
            );
        }
    }
    out.push_str("</svg>\n");
    out
}

fn escaped(text: &str) -> String {
    text.chars()
        .filter(|c| !c.is_control())
        .map(|c| match c {
            '&' => "&amp;".to_string(),
            '<' => "&lt;".to_string(),
            '>' => "&gt;".to_string(),
            '"' => "&quot;".to_string(),
            c => c.to_string(),
        })
        .collect()
}
