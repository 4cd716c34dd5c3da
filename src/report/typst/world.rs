//! The files that Typst can read: embedded fonts, embedded templates, and the files of one report.

use std::sync::LazyLock;

use indexmap::IndexMap;
use typst::{
    Library, LibraryExt, World, WorldExt,
    diag::{FileError, FileResult},
    foundations::{Bytes, Datetime, Duration},
    syntax::{DiagSpan, FileId, RootedPath, Source, VirtualPath, VirtualRoot},
    text::{Font, FontBook},
    utils::LazyHash,
};

use crate::problem::{Problems, problem};

/// The template of all documents.
const REPORT: &str = include_str!("../../../templates/report.typ");

/// What it imports.
const TEMPLATES: &[(&str, &str)] = &[("/theme.typ", include_str!("../../../templates/theme.typ"))];

const FONTS: &[&[u8]] = &[
    include_bytes!("../../../templates/fonts/IBMPlexSans-Regular.ttf"),
    include_bytes!("../../../templates/fonts/IBMPlexSans-Italic.ttf"),
    include_bytes!("../../../templates/fonts/IBMPlexSans-SemiBold.ttf"),
    include_bytes!("../../../templates/fonts/IBMPlexMono-Regular.ttf"),
    include_bytes!("../../../templates/fonts/DejaVuSans.ttf"),
];

static EMBEDDED_FONTS: LazyLock<Vec<Font>> =
    LazyLock::new(|| FONTS.iter().flat_map(|data| Font::iter(Bytes::new(*data))).collect());

/// The embedded fonts.
pub fn fonts() -> &'static [Font] {
    &EMBEDDED_FONTS
}

/// The files of one report.
pub struct Files {
    standard: LazyHash<Library>,
    book: LazyHash<FontBook>,
    main: Source,
    templates: IndexMap<FileId, Source>,
    files: IndexMap<FileId, Bytes>,
}

impl Files {
    pub fn new() -> Self {
        let source = |(path, text): &(&str, &str)| Some(Source::new(id(path)?, (*text).to_owned()));
        let templates =
            TEMPLATES.iter().filter_map(source).map(|source| (source.id(), source)).collect();
        Self {
            standard: LazyHash::new(Library::default()),
            book: LazyHash::new(FontBook::from_fonts(fonts())),
            main: id("/report.typ")
                .map_or_else(|| Source::detached(REPORT), |main| Source::new(main, REPORT.into())),
            templates,
            files: IndexMap::new(),
        }
    }

    /// Adds a file that templates can read under `path`.
    pub fn add(&mut self, path: &str, bytes: Vec<u8>) -> Result<(), Problems> {
        let id = id(path).ok_or_else(|| problem!("report-attachment", "`{path}` is not a path"))?;
        self.files.insert(id, Bytes::new(bytes));
        Ok(())
    }

    /// `templates/theme.typ:12`, if the span is in a template.
    pub fn place(&self, span: DiagSpan) -> Option<String> {
        let id = span.id()?;
        let source = self.source(id).ok()?;
        let line = source.lines().byte_to_line(self.range(span)?.start)?;
        Some(format!("templates/{}:{}", id.get().vpath().get_without_slash(), line + 1))
    }
}

/// Ids are kept for the life of the process; the paths are the same for every report.
fn id(path: &str) -> Option<FileId> {
    Some(RootedPath::new(VirtualRoot::Project, VirtualPath::new(path).ok()?).intern())
}

impl World for Files {
    fn library(&self) -> &LazyHash<Library> {
        &self.standard
    }

    fn book(&self) -> &LazyHash<FontBook> {
        &self.book
    }

    fn main(&self) -> FileId {
        self.main.id()
    }

    fn source(&self, id: FileId) -> FileResult<Source> {
        if id == self.main.id() {
            return Ok(self.main.clone());
        }
        self.templates.get(&id).cloned().ok_or_else(|| missing(id))
    }

    fn file(&self, id: FileId) -> FileResult<Bytes> {
        self.files.get(&id).cloned().ok_or_else(|| missing(id))
    }

    fn font(&self, index: usize) -> Option<Font> {
        fonts().get(index).cloned()
    }

    /// No clock: a template that requests the date fails.
    fn today(&self, _: Option<Duration>) -> Option<Datetime> {
        None
    }
}

fn missing(id: FileId) -> FileError {
    FileError::NotFound(id.get().vpath().get_without_slash().into())
}
