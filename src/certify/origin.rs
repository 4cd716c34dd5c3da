//! Whose protocol it is: shipped with the program, or a text of its own.

use crate::check::{
    diff::{self, Change},
    family::Family,
};
use crate::library;
use crate::problem::Problems;
use crate::result::OwnProtocol;
use crate::syntax::{self, document::Text};

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

/// Whether all texts are or were shipped, from one of them on.
fn is_shipped(family: &Family, from: usize) -> bool {
    (from..family.sources.len()).all(|at| edition(family, at).is_some())
}

/// The edition in which the protocol was shipped with all that it extends and uses.
pub fn shipped_edition(family: &Family) -> Option<usize> {
    edition(family, 0).filter(|_| is_shipped(family, 0))
}

/// How the protocol differs from a shipped one, if it does.
pub fn own(family: &Family) -> Option<OwnProtocol> {
    if shipped_edition(family).is_some() {
        return None;
    }
    let ancestors = &family.ancestors;
    let known = ancestors.iter().find(|one| is_shipped(family, one.from));
    let known = known.or_else(|| ancestors.first());
    let changes = known.map_or_else(Vec::new, |known| diff::changes(&known.merged, &family.merged));
    let relaxed = changes.iter().filter(|change| change.relaxes());
    let name = known.and_then(|known| family.names.get(known.from)?.as_ref());
    Some(OwnProtocol {
        extends: name.map(|name| name.text.clone()),
        changed: changes.len(),
        relaxed: relaxed.map(|Change { deviation, .. }| deviation.rule.clone()).collect(),
        taken: taken_names(family).next().map(|name| name.text.clone()),
    })
}
