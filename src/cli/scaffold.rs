//! What `init` and `new` have in common: a new folder with files, and what is told of it.

use super::kit::*;
use crate::init::File;

/// The files of a new folder.
pub struct Scaffold {
    pub files: Vec<File>,
    /// What is told before and after the folder that was written.
    pub before: Vec<String>,
    pub after: Vec<String>,
}

/// Makes a folder with the files of `make`, which is given the name of the folder. A folder that
/// has files is refused, and nothing is written if there is a problem.
pub fn scaffold(
    folder: &Path,
    console: &Console,
    make: impl FnOnce(&str, &mut Problems) -> Option<Scaffold>,
) -> Done {
    let mut problems = Problems::default();
    problems.add(check_folder(folder).err());
    let name = folder.file_name().map(|name| name.to_string_lossy().into_owned());
    let name = name.filter(|name| !name.is_empty()).unwrap_or_else(|| "campaign".into());
    let made = make(&name, &mut problems);
    let made = console.sound(made, &problems)?;
    write(folder, &made.files).map_err(Ended::unfinished)?;
    let written = [format!("written: {}", folder.display())];
    for line in made.before.iter().chain(&written).chain(&made.after) {
        console.say(line);
    }
    Ok(Exit::Done)
}

/// Nothing that is there is changed.
fn check_folder(folder: &Path) -> Result<(), Problem> {
    let shown = folder.display();
    if !disk::may_exist(folder) {
        return Ok(());
    }
    let names = disk::names(folder).map_err(|error| {
        Problem::error(
            "folder-not-empty",
            format!("`{shown}` is there and is no folder that can be read: {error}"),
        )
        .help("give another folder")
    })?;
    match names.iter().map(|name| name.to_string_lossy().into_owned()).min() {
        None => Ok(()),
        Some(first) => Err(Problem::error(
            "folder-not-empty",
            format!("the folder `{shown}` is not empty: it has `{first}`"),
        )
        .help("give a folder that does not exist; nothing is overwritten")),
    }
}

/// Writes all files, or none.
fn write(folder: &Path, files: &[File]) -> Result<(), Problem> {
    let failed = |path: &Path, error: &std::io::Error| {
        Problem::error("write-failed", format!("`{}` cannot be written: {error}", path.display()))
    };
    let mut written: Vec<PathBuf> = Vec::new();
    let mut one = |(inside, text): &File| {
        let path = folder.join(inside);
        let parent = path.parent().unwrap_or(folder);
        disk::make_folder(parent).map_err(|error| failed(parent, &error))?;
        disk::create_new(&path, text.as_bytes(), false).map_err(|error| failed(&path, &error))?;
        written.push(path);
        Ok(())
    };
    let result = files.iter().try_for_each(&mut one);
    if result.is_err() {
        for path in &written {
            let _ = disk::remove(path);
        }
    }
    result
}
