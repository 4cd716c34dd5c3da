//! The clauses that rules name, and those that a protocol lists because no rule computes them.

use indexmap::IndexMap;

use super::{plan::Clause, prelude::*};

/// The block of a clause, which is also the field of a rule.
const CLAUSE: &str = "clause";
const PARAPHRASE: &str = "paraphrase";

impl Checker<'_> {
    /// All clauses in the order of the text. Blocks that name the same one are joined.
    pub fn clauses(&mut self) -> Option<Vec<Clause>> {
        let mut clauses: IndexMap<String, Clause> = IndexMap::new();
        let mut sound = true;
        for block in self.blocks.clone() {
            let listed = block.kind.text == CLAUSE;
            let wanted = listed || block.field(PARAPHRASE).is_some();
            let field = if wanted { self.required(&block, CLAUSE) } else { block.field(CLAUSE) };
            let Some(field) = field else {
                sound &= !wanted;
                continue;
            };
            let name = normalised(&field.value.text);
            let of = clauses.entry(name.clone()).or_insert_with(|| Clause {
                clause: name,
                says: Vec::new(),
                rules: Vec::new(),
                judged_by: None,
            });
            if let Some(says) = block.text(PARAPHRASE).or_else(|| block.title_text())
                && !of.says.contains(&says)
            {
                of.says.push(says);
            }
            if listed {
                of.judged_by = block.text("judged by").or(of.judged_by.take());
            } else {
                of.rules.push(format!("{} {}", block.kind.text, block.name_text()).trim().into());
            }
        }
        sound.then(|| clauses.into_values().collect())
    }
}
