//! Checks how many pairs quantities need: in all, and in each group.

use super::{groups::Grouped, prelude::*};
use crate::syntax::phrase::Scope;

/// The fields `minimum pairs` of a block.
#[derive(Debug, Default)]
pub struct Minima {
    /// The number in all; `None` inside where it was not understood.
    pub all: Option<Option<usize>>,
    /// Fields that say of which groups.
    pub of_groups: Vec<Field>,
}

impl Checker<'_> {
    /// The fields `minimum pairs` of a block: the number in all, and those of groups.
    pub fn minima(&mut self, block: &Block) -> Minima {
        let mut found = Minima::default();
        let mut seen: Vec<(Scope, &Field)> = Vec::new();
        for field in block.fields_named("minimum pairs") {
            let Some(written) = from_pest::minimum(&field.value, self.problems) else {
                found.all.get_or_insert(None);
                continue;
            };
            let groups = written.scope.clone();
            if let Some((_, first)) = seen.iter().find(|(known, _)| *known == groups) {
                self.tell(
                    error(
                        "duplicate-field",
                        "there are two `minimum pairs` for the same values",
                        field,
                    )
                    .also(first, "the first"),
                );
                continue;
            }
            seen.push((groups, field));
            if written.scope.is_all() {
                found.all = Some(self.whole_number(&written.count, field));
            } else {
                found.of_groups.push(field.clone());
            }
        }
        found
    }

    /// The minimum counts of groups of a quantity.
    pub fn minimum_of_groups(
        &mut self,
        fields: &[Field],
        block: &Block,
        places: &[String],
    ) -> Option<Vec<MinimumOfGroups>> {
        self.grouped = Grouped::values(block, places, None);
        let mut all = Vec::new();
        let mut ok = true;
        for field in fields {
            let Some(written) = from_pest::minimum(&field.value, &mut Problems::default()) else {
                continue;
            };
            let before = self.problems.0.len();
            let needed = self.whole_number(&written.count, field);
            let scope = self.scope_of(&written.scope);
            let (Some(needed), true) = (needed, scope.is_some()) else {
                ok = false;
                self.once(before);
                continue;
            };
            let scopes = self.zone_by_zone(scope).into_iter().filter_map(|(scope, _)| scope);
            all.extend(scopes.map(|scope| MinimumOfGroups { needed, scope }));
        }
        ok.then_some(all)
    }

    /// Drops a problem that another quantity has already met in the same field, that of the
    /// verdict.
    fn once(&mut self, before: usize) {
        let (known, new) = self.problems.0.split_at(before);
        if new
            .iter()
            .all(|new| known.iter().any(|known| known.at == new.at && known.code == new.code))
        {
            self.problems.0.truncate(before);
        }
    }
}
