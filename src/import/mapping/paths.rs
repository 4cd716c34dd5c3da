//! Where the files of a mapping may be: inside its folder, unless the user allows other places.

use std::path::Path;
use std::sync::Arc;

use crate::data::text::read_text;
use crate::data::{CampaignPath, Folder};
use crate::problem::{Problem, Problems, error};
use crate::source::{Source, Span, Spanned};

/// The folder that the paths of a mapping are relative to.
///
/// A mapping may come from elsewhere: what it names is copied into the campaign and shown in
/// messages. Paths must therefore stay inside the folder, also after symbolic links are resolved.
#[derive(Clone, Debug)]
pub struct Paths {
    folder: Folder,
    outside: bool,
}

impl Paths {
    /// Only files inside the folder may be named.
    ///
    /// # Errors
    /// `folder-missing`, `folder-unreadable`.
    pub fn inside(folder: &Path) -> Result<Self, Problem> {
        let named = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        Ok(Self { folder: Folder::open(named)?.shown_as(folder), outside: false })
    }

    /// The same, or any file where the user allows it.
    ///
    /// # Errors
    /// As [`Self::inside`].
    pub fn allowed(folder: &Path, outside: bool) -> Result<Self, Problem> {
        Ok(Self { outside, ..Self::inside(folder)? })
    }

    /// The file of a path in the mapping. It need not exist.
    ///
    /// # Errors
    /// `path-outside`, `path-invalid`, `file-unreadable`.
    pub fn place(&self, written: &str, at: &Span) -> Result<CampaignPath, Problem> {
        let found = self.folder.place(written, at).map_err(|problem| match problem.code {
            "path-outside" => Problem {
                says: problem.says.replace("the campaign's folder", "the folder of the mapping"),
                ..problem
            }
            .help("put the file beside the mapping; if you know where the mapping is from, `--allow-outside` lets it name any file"),
            _ => problem,
        });
        match found {
            Err(problem) if self.outside && problem.code == "path-outside" => {
                let path = self.folder.shown().join(written);
                let shown = path.display().to_string();
                Ok(CampaignPath { path, inside: shown.clone(), shown })
            }
            found => found,
        }
    }

    /// A small text that the mapping names, and the SHA-256 of its bytes. Problems of the file are
    /// shown where it is named.
    ///
    /// # Errors
    /// As [`Self::place`] and [`read_text`].
    pub fn read_text(&self, named: &Spanned<String>) -> Result<(Arc<Source>, String), Problem> {
        let place = self.place(&named.value, &named.span)?;
        let read = read_text(&place.path, &place.shown);
        read.map_err(|problem| problem.or_at(&named.span))
    }

    /// A protocol that another one of the mapping extends, relative to its folder.
    ///
    /// # Errors
    /// As [`Self::read_text`].
    pub fn parent(&self, name: &str, from: &Source, at: &Span) -> Result<Arc<Source>, Problem> {
        let beside = Path::new(self.folder.inside(&from.name)).parent().unwrap_or(Path::new(""));
        let written = beside.join(name).display().to_string();
        Ok(self.read_text(&Spanned::new(written, at.clone()))?.0)
    }

    /// Problems without the lines of files outside the folder, which may be of any kind: they may
    /// hold what is not to be printed. Code, file and line stay.
    pub fn withheld(&self, problems: Problems) -> Problems {
        let is_outside = |span: &Span| {
            let path = Path::new(&span.source.name);
            let real = crate::disk::real(path).ok().flatten();
            real.is_some_and(|real| !real.starts_with(self.folder.real()))
        };
        let withhold = |problem: Problem| {
            let Some(at) = problem.at.as_ref().filter(|at| is_outside(at)) else { return problem };
            let line = Source::excerpt(at.source.name.as_str(), "", at.line()).whole();
            let says = "this file outside the folder of the mapping has a fault";
            Problem { severity: problem.severity, ..error(problem.code, says, &line) }
                .help("its lines are not printed, since it may be any file; put it beside the mapping to see the fault")
        };
        Problems(problems.0.into_iter().map(withhold).collect())
    }
}
