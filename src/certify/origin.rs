//! Whose protocol it is: shipped with the program, or a text of its own.

use crate::check::diff::{self, Change};
use crate::check::family::Family;
use crate::library;
use crate::problem::Problems;
use crate::result::ProtocolOrigin;
use crate::syntax;
use crate::syntax::document::Text;

/// The shipped names that texts of a protocol give themselves although their content is not the
/// shipped one.
pub fn taken_names(family: &Family) -> impl Iterator<Item = &Text> {
    (0..family.sources.len())
        .filter(|&at| edition(family, at).is_none())
        .filter_map(|at| family.names.get(at)?.as_ref())
        .filter(|name| library::shipped(&name.text).is_some())
}

/// The edition in which a text of the protocol was shipped, in whatever form it is written.
fn edition(family: &Family, at: usize) -> Option<usize> {
    let (source, name) = (family.sources.get(at)?, family.names.get(at)?.as_ref()?);
    library::edition(&name.text, &source.text).or_else(|| {
        // A shipped text has the canonical form.
        let document = syntax::read(source, &mut Problems::default());
        library::edition(&name.text, &syntax::print_text(&document))
    })
}

pub fn origin(family: &Family) -> ProtocolOrigin {
    let shipped =
        |from: usize| (from..family.sources.len()).all(|at| edition(family, at).is_some());
    if let Some(edition) = edition(family, 0).filter(|_| shipped(0)) {
        return ProtocolOrigin::ShippedProtocol { edition };
    }
    let ancestors = &family.ancestors;
    let known = ancestors.iter().find(|one| shipped(one.from)).or_else(|| ancestors.first());
    let changes = known.map_or_else(Vec::new, |known| diff::changes(&known.merged, &family.merged));
    let relaxed = changes.iter().filter(|change| change.relaxes());
    let name = known.and_then(|known| family.names.get(known.from)?.as_ref());
    ProtocolOrigin::OwnProtocol {
        extends: name.map(|name| name.text.clone()),
        changed: changes.len(),
        relaxed: relaxed.map(|Change { deviation, .. }| deviation.rule.clone()).collect(),
        taken: taken_names(family).next().map(|name| name.text.clone()),
    }
}
