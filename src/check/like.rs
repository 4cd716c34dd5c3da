//! A quantity that is like another: its fields are those of the other, with its own over them.

use super::{overlay::overlay, prelude::*};

const LIKE: &str = "like";

/// Writes out every quantity with `like`, after all variants were merged: so it follows a variant
/// that changes the other. Names are told to be unknown only where all blocks are at hand
/// (`whole`). A quantity that could not be written out keeps its `like`.
pub fn write_out(document: &mut Document, whole: bool, problems: &mut Problems) {
    if !document.blocks.iter().any(is_like) {
        return;
    }
    let written = document.blocks.clone();
    for (at, block) in document.blocks.iter_mut().enumerate().filter(|(_, block)| is_like(block)) {
        if let Some(filled) = filled(&written, at, &mut Vec::new(), whole, problems) {
            *block = filled;
            block.fields.retain(|field| field.key.text != LIKE);
        }
    }
}

fn is_like(block: &Block) -> bool {
    block.kind.text == "quantity" && block.field(LIKE).is_some()
}

/// The block with the fields of the one that it is like, which may itself be like a third.
fn filled(
    blocks: &[Block],
    at: usize,
    passed: &mut Vec<usize>,
    whole: bool,
    problems: &mut Problems,
) -> Option<Block> {
    let own = &blocks[at];
    let Some(field) = own.field(LIKE).filter(|_| is_like(own)) else { return Some(own.clone()) };
    passed.push(at);
    let name = field.value.text.trim();
    let quantities =
        || blocks.iter().enumerate().filter(|(_, block)| block.kind.text == "quantity");
    let Some((other, _)) = quantities().find(|(_, block)| block.name_text() == name) else {
        if whole && passed.len() == 1 {
            let known = quantities()
                .map(|(_, block)| block.name_text())
                .filter(|known| *known != own.name_text());
            problems.push(
                problem!("no-such-quantity", field, "no quantity is called `{name}`")
                    .suggest(name, known),
            );
        }
        return None;
    };
    if passed.contains(&other) {
        // One problem for each of a round, where its own `like` stands.
        if passed[0] == other {
            problems.push(
                problem!("like-loop", field, "`{}` is like itself in the end", own.name_text())
                    .help("let one of them state its own `of`, `value` and limits"),
            );
        }
        return None;
    }
    let mut block = filled(blocks, other, passed, whole, problems)?;
    overlay(&mut block, own);
    Some(block)
}
