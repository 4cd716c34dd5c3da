//! Statements for signature.

use super::{View, cover, wording};
use crate::report::document::*;
use crate::result::VerdictResult;

/// A statement for each judgement that a person gives, and for those who answer for simulation,
/// measurement and assessment. They stay together, so that none is signed on a page of its own.
pub fn chapter(view: &View<'_>) -> Chapter {
    let statement = |title: &str, text: Text| Block::Statement {
        title: title.to_owned(),
        text,
        fields: ["Name", "Place and date", "Signature"],
    };
    let mut blocks: Vec<Block> = view.found.verdicts.iter().filter_map(judgement).collect();
    let simulation = wording::simulation_statement(view.found);
    blocks.extend(simulation.map(|says| statement("Simulation", says.into())));
    let measurement = wording::measurement_statement(view.found);
    blocks.extend(measurement.map(|says| statement("Measurement", says.into())));
    let finding = cover::finding(view);
    let text = Text::from(format!("The verdict of this report, {} ", finding.sign))
        .then(Run::Strong(finding.word))
        .and(format!(
            ", was obtained with the protocol printed in it. The sections, the remarks and the {} were reviewed.",
            view.words.domain.to_lowercase()
        ));
    blocks.push(statement("Assessment", text));
    Chapter { together: true, ..Chapter::new("statements", "Statements", blocks) }
}

fn judgement(verdict: &VerdictResult) -> Option<Block> {
    let (person, [good, bad]) = (verdict.judged_by.as_ref()?, &verdict.words);
    let notes: String = verdict.notes.iter().map(|note| format!(" {note}")).collect();
    Some(Block::Statement {
        title: verdict.title.clone(),
        text: format!("To be judged by {person}: {good}, or {bad}.{notes}").into(),
        fields: ["Judgement", "Name", "Date"],
    })
}
