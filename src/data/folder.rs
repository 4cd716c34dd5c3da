//! The folder of a campaign; no path in the campaign may lead out of it.

use std::{
    collections::BTreeMap,
    path::{Component, Path, PathBuf},
    sync::Arc,
};

use super::{
    place::CampaignPath,
    record::Frame,
    text::{read_any, read_small, text_of, unreadable},
};
use crate::data::prelude::*;
use crate::problem::nearest;

/// Small files and records of a campaign that are in memory, by their paths inside it. A record has
/// no ending: `measurement/S01`.
#[derive(Clone, Debug, Default)]
pub struct Memory {
    pub texts: BTreeMap<String, Vec<u8>>,
    pub records: BTreeMap<String, Arc<Frame>>,
}

/// The folder of a campaign that is wholly in memory: a path that no system accepts, so that no
/// file is found by accident.
const NOWHERE: &str = "\0";

#[derive(Clone, Debug)]
pub struct Folder {
    /// As given by the user; the prefix of file names in messages.
    shown: PathBuf,
    /// Without symbolic links, for comparison.
    real: PathBuf,
    /// What is not on the disk, or used in place of it.
    memory: Arc<Memory>,
}

impl Folder {
    pub fn open(folder: &Path) -> Result<Self, Problem> {
        let shown = folder.display();
        let unreadable = |error: std::io::Error| {
            problem!("folder-unreadable", "`{shown}` cannot be read: {error}")
        };
        let there = disk::is_folder(folder).map_err(unreadable)?;
        let real = disk::real(folder)
            .map_err(unreadable)?
            .filter(|_| there)
            .ok_or_else(|| problem!("folder-missing", "there is no folder `{shown}`"))?;
        Ok(Self { shown: folder.to_path_buf(), real, memory: Arc::default() })
    }

    /// The same folder with another name in messages.
    pub fn shown_as(self, shown: &Path) -> Self {
        Self { shown: shown.to_path_buf(), ..self }
    }

    /// A folder without a place on the disk.
    pub fn nowhere() -> Self {
        Self { shown: PathBuf::new(), real: PathBuf::from(NOWHERE), memory: Arc::default() }
    }

    /// The same folder with files and records that are in memory.
    pub fn with(self, memory: Memory) -> Self {
        Self { memory: Arc::new(memory), ..self }
    }

    pub fn on_disk(&self) -> bool {
        self.real != Path::new(NOWHERE)
    }

    /// As given by the user.
    pub fn shown(&self) -> &Path {
        &self.shown
    }

    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// A small text file without its byte order mark, the SHA-256 of its bytes, and their number.
    ///
    /// # Errors
    /// As [`read_text`](super::text::read_text); `file-missing` with the nearest name in that
    /// folder.
    pub fn read_text(&self, place: &CampaignPath) -> Result<(Arc<Source>, String, u64), Problem> {
        let bytes = self.bytes(place, read_small)?;
        let (source, hash) = text_of(&bytes, &place.shown)?;
        Ok((source, hash, bytes.len() as u64))
    }

    /// All bytes of a file.
    ///
    /// # Errors
    /// As [`read_any`]; `file-missing` with the nearest name in that folder.
    pub fn read_any(&self, place: &CampaignPath) -> Result<Vec<u8>, Problem> {
        self.bytes(place, read_any)
    }

    fn bytes(
        &self,
        place: &CampaignPath,
        read: fn(&Path, &str) -> Result<Vec<u8>, Problem>,
    ) -> Result<Vec<u8>, Problem> {
        let texts = &self.memory.texts;
        if let Some(bytes) = texts.get(&place.inside) {
            return Ok(bytes.clone());
        }
        if !self.on_disk() {
            return Err(problem!("file-missing", "there is no `{}` in memory", place.inside)
                .suggest(&place.inside, texts.keys()));
        }
        read(&place.path, &place.shown).map_err(|problem| near_file(problem, place))
    }

    /// The folder itself, without symbolic links.
    pub fn real(&self) -> &Path {
        &self.real
    }

    /// The part of [`CampaignPath::shown`] after the folder; other names unchanged.
    pub fn inside<'a>(&self, shown: &'a str) -> &'a str {
        Path::new(shown).strip_prefix(&self.shown).ok().and_then(Path::to_str).unwrap_or(shown)
    }

    /// A path in the campaign, which must stay in the folder, also after symbolic links are
    /// resolved. It need not exist.
    pub fn place(&self, written: &str, at: &Span) -> Result<CampaignPath, Problem> {
        let outside = |how: &str| {
            problem!("path-outside", at, "`{written}` {how}")
                .help("paths must be relative to the campaign's folder and stay inside it")
        };
        // `\` and drive letters are checked explicitly, so that the result is the same on all
        // systems.
        let drive = written.as_bytes().get(1) == Some(&b':')
            && written.starts_with(|letter: char| letter.is_ascii_alphabetic());
        if written.starts_with(['/', '\\']) || drive {
            return Err(outside("is an absolute path"));
        }
        if written.trim().is_empty() || written.contains('\0') {
            return Err(error("path-invalid", "this is not a path", at));
        }
        let mut inside = Vec::new();
        for part in written.split(['/', '\\']) {
            match Path::new(part).components().next() {
                None | Some(Component::CurDir) => {}
                Some(Component::Normal(_)) => inside.push(part),
                Some(_) => return Err(outside("leads out of the campaign's folder")),
            }
        }
        let inside = inside.join("/");
        let path = self.real.join(&inside);
        // A path that does not exist is accepted; the error is reported when it is opened.
        if !self.on_disk() {
            return Ok(CampaignPath { path, shown: inside.clone(), inside });
        }
        // Of a file that does not exist, the nearest folder that does.
        for above in path.ancestors() {
            match disk::real(above).map_err(|why| unreadable(written)(why).at(at))? {
                Some(real) if real.starts_with(&self.real) => break,
                Some(_) => return Err(outside("is a symbolic link out of the campaign's folder")),
                None => {}
            }
        }
        let shown = if self.shown.as_os_str().is_empty() {
            inside.clone()
        } else {
            self.shown.join(&inside).display().to_string()
        };
        Ok(CampaignPath { path, shown, inside })
    }
}

/// The names in a folder that are texts; none if it cannot be read.
pub fn names_in(folder: &Path) -> Vec<String> {
    let names = disk::names(folder).unwrap_or_default().into_iter();
    names.filter_map(|name| name.into_string().ok()).collect()
}

/// Names a file beside one that is missing, if its name is similar.
fn near_file(problem: Problem, place: &CampaignPath) -> Problem {
    let path = &place.path;
    let named = path.parent().zip(path.file_name().and_then(|name| name.to_str()));
    let Some((folder, name)) = named.filter(|_| problem.code == "file-missing") else {
        return problem;
    };
    let beside = names_in(folder);
    let Some(near) = nearest(name, beside.iter().map(String::as_str)) else { return problem };
    let above = place.inside.rfind('/').map_or("", |at| &place.inside[..=at]);
    problem.meant(&format!("{above}{near}"))
}

/// Checks a name that becomes part of a file name.
///
/// # Errors
/// `path-outside` if it is not a single file name on every system.
pub fn check_file_name(name: &str, at: &Span) -> Result<(), Problem> {
    let says = if name.contains(['/', '\\', ':']) || name.starts_with('.') {
        format!(
            "`{name}` is used as a file name and must not contain `/`, `\\` or `:` or begin with a point"
        )
    } else if name.chars().any(char::is_control) {
        "a file name must not contain control characters".to_string()
    } else if name.is_empty() || name.len() > 200 {
        "a file name must have 1 to 200 bytes".to_string()
    } else {
        return Ok(());
    };
    Err(error("path-outside", says, at))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_file_is_told_with_the_nearest_name_beside_it() {
        let temp = tempfile::tempdir().expect("a temporary folder");
        std::fs::create_dir(temp.path().join("data")).expect("made");
        std::fs::write(temp.path().join("data/vehicle.yaml"), "mass: 1 t").expect("written");
        let folder = Folder::open(temp.path()).expect("there");
        let place = |written: &str| {
            folder.place(written, &Source::new("t", "x").whole()).expect("a place inside")
        };
        let near = |written: &str| folder.read_text(&place(written)).expect_err("missing").near;
        assert_eq!(near("data/vehicel.yaml").as_deref(), Some("data/vehicle.yaml"));
        assert_eq!(near("data/something.yaml"), None);
        assert_eq!(near("vehicel.yaml"), None, "it is in another folder");
    }

    #[test]
    fn only_paths_inside_are_taken() {
        let temp = tempfile::tempdir().expect("a temporary folder");
        std::fs::create_dir(temp.path().join("in")).expect("made");
        let folder = Folder::open(temp.path()).expect("there");
        let span = Source::new("t", "x").whole();
        let place = |written: &str| {
            folder.place(written, &span).map(|place| place.inside).map_err(|problem| problem.code)
        };
        assert_eq!(place("in"), Ok("in".into()));
        assert_eq!(place("./in//S01.csv"), Ok("in/S01.csv".into()));
        assert_eq!(place("in\\S01.csv"), Ok("in/S01.csv".into()));
        for bad in ["/etc/passwd", "..", "in/../../x", "C:\\x", "c:x", "\\\\server\\x", "in\\..\\x"]
        {
            assert_eq!(place(bad), Err("path-outside"), "{bad}");
        }
        for bad in ["", " ", "a\0b"] {
            assert_eq!(place(bad), Err("path-invalid"), "{bad:?}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("/", temp.path().join("out")).expect("linked");
            std::os::unix::fs::symlink("in", temp.path().join("ok")).expect("linked");
            assert_eq!(place("out"), Err("path-outside"));
            assert_eq!(place("ok"), Ok("ok".into()));
        }
    }

    #[test]
    fn names_of_files() {
        let span = Source::new("t", "x").whole();
        for good in ["S01", "Süd 3", "a.b", "7"] {
            assert!(check_file_name(good, &span).is_ok(), "{good}");
        }
        for bad in ["", "..", ".", ".hidden", "a/b", "a\\b", "a\0", "a\nb", "C:x"] {
            assert!(check_file_name(bad, &span).is_err(), "{bad:?}");
        }
    }
}
