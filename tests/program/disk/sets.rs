//! The commit of a set by itself, at every operation.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use fishplate::disk::{Set, SetKind};

use crate::disk::alone;
use crate::disk::injector::{MODES, Mode, files, leftovers, with_fault};

type Files = BTreeMap<String, Vec<u8>>;

const OLD: [(&str, &str); 4] = [
    ("results.json", "old"),
    ("report.pdf", "old verdict"),
    ("tables/a.csv", "1"),
    ("only-old/x", "2"),
];
const NEW: [(&str, &str); 3] =
    [("results.json", "new"), ("tables/a.csv", "3"), ("tables/b.csv", "4")];

fn commit(folder: &Path, set: &[(&str, &str)]) -> std::io::Result<bool> {
    let mut outputs = Set::new(folder, SetKind::Report);
    for (name, text) in set {
        outputs.add(name, text.as_bytes())?;
    }
    let mended = outputs.mended();
    outputs.commit().map(|()| mended)
}

/// A folder with the old set and a file of someone else.
fn with_old(there: bool) -> (tempfile::TempDir, Files) {
    let temp = tempfile::tempdir().expect("a temporary folder");
    let folder = temp.path().join("out");
    if there {
        commit(&folder, &OLD).expect("committed");
        fs::write(folder.join("tables/mine.csv"), "mine").expect("written");
    }
    let before = files(&folder);
    (temp, before)
}

fn after(there: bool) -> Files {
    let (temp, _) = with_old(there);
    commit(&temp.path().join("out"), &NEW).expect("committed");
    files(&temp.path().join("out"))
}

#[test]
fn the_new_set_takes_the_place_of_the_old_one() {
    let new = after(true);
    let names: Vec<&str> = new.keys().map(String::as_str).collect();
    assert_eq!(
        names,
        [
            ".fishplate-report.sha256",
            "results.json",
            "tables/a.csv",
            "tables/b.csv",
            "tables/mine.csv"
        ]
    );
    let list = String::from_utf8_lossy(&new[".fishplate-report.sha256"]).into_owned();
    // SHA-256 of "new", as `sha256sum` prints it.
    assert!(
        list.starts_with(
            "11507a0e2f5e69d5dfa40a62a1bd7b6ee57e6bcd85c67c9b8431b36fff21c437  results.json\n"
        ),
        "{list}"
    );
}

#[test]
fn a_set_of_another_kind_stays() {
    let temp = tempfile::tempdir().expect("a temporary folder");
    let mut campaign = Set::new(temp.path(), SetKind::Campaign);
    campaign.add("campaign.yaml", b"name: x").expect("added");
    campaign.commit().expect("committed");
    commit(temp.path(), &OLD).expect("committed");
    commit(temp.path(), &NEW).expect("committed");
    assert!(
        temp.path().join("campaign.yaml").is_file() && !temp.path().join("report.pdf").exists()
    );
}

/// The list lies where anybody may write.
#[cfg(unix)]
#[test]
fn a_list_cannot_remove_what_lies_elsewhere() {
    let temp = tempfile::tempdir().expect("a temporary folder");
    let folder = temp.path().join("out");
    commit(&folder, &OLD).expect("committed");
    fs::write(temp.path().join("precious"), "1").expect("written");
    fs::create_dir(temp.path().join("elsewhere")).expect("made");
    fs::write(temp.path().join("elsewhere/x"), "1").expect("written");
    std::os::unix::fs::symlink(temp.path().join("elsewhere"), folder.join("link")).expect("linked");
    let list = format!(
        "x  ../precious\nx  link/x\nx  {}\nx  only-old/x\n",
        temp.path().join("precious").display()
    );
    fs::write(folder.join(".fishplate-report.sha256"), list).expect("written");
    commit(&folder, &NEW).expect("committed");
    assert!(temp.path().join("precious").is_file() && temp.path().join("elsewhere/x").is_file());
    assert!(!folder.join("only-old").exists());
}

/// Links in the output folder, which anybody may have put there, lead to no other folder.
#[cfg(unix)]
#[test]
fn links_in_the_folder_are_not_followed() {
    let temp = tempfile::tempdir().expect("a temporary folder");
    let (folder, elsewhere) = (temp.path().join("out"), temp.path().join("elsewhere"));
    fs::create_dir_all(elsewhere.join("empty")).expect("made");
    fs::create_dir(&folder).expect("made");
    fs::write(elsewhere.join("x"), "1").expect("written");
    let link = |to: &Path, name: &str| {
        std::os::unix::fs::symlink(to, folder.join(name)).expect("linked");
    };
    let untouched = || {
        let names = fs::read_dir(&elsewhere).expect("there").count();
        let x = fs::read_to_string(elsewhere.join("x")).expect("there");
        assert_eq!((names, x.as_str()), (2, "1"));
        assert!(elsewhere.join("empty").is_dir());
    };
    // A folder of the set.
    link(&elsewhere, "tables");
    let refused = commit(&folder, &[("tables/a.csv", "new")]).expect_err("a link");
    assert!(refused.to_string().contains("symbolic link"), "{refused}");
    untouched();
    // A file of the set, and its signature: the links go, what they name stays.
    fs::remove_file(folder.join("tables")).expect("removed");
    link(&elsewhere.join("x"), "report.pdf");
    link(&elsewhere.join("x"), "report.pdf.minisig");
    commit(&folder, &[("report.pdf", "new")]).expect("committed");
    assert_eq!(fs::read(folder.join("report.pdf")).expect("there"), b"new");
    assert!(fs::symlink_metadata(folder.join("report.pdf.minisig")).is_err());
    untouched();
    // Folders that the list names.
    link(&elsewhere, "link");
    fs::write(folder.join(".fishplate-report.sha256"), "x  link/empty/y\n").expect("written");
    commit(&folder, &NEW).expect("committed");
    untouched();
    // Journals of a run that was not interrupted.
    let unfinished = folder.join(".fishplate-unfinished");
    for journal in ["put link/new\n", "remove link/x\nput link/x\n"] {
        fs::create_dir(&unfinished).expect("made");
        let text = format!("fishplate set 1\n{journal}end\n");
        fs::write(unfinished.join("journal"), text).expect("written");
        fs::write(unfinished.join("0"), "forged").expect("written");
        let refused = commit(&folder, &NEW).expect_err("a link");
        assert!(refused.to_string().contains("symbolic link"), "{refused}");
        untouched();
        fs::remove_dir_all(&unfinished).expect("removed");
    }
    fs::write(elsewhere.join("journal"), "fishplate set 1\nput a\nend\n").expect("written");
    link(&elsewhere, ".fishplate-unfinished");
    let refused = commit(&folder, &NEW).expect_err("a link");
    assert!(refused.to_string().contains("symbolic link"), "{refused}");
}

#[cfg(unix)]
#[test]
fn two_runs_do_not_write_to_one_folder() {
    let temp = tempfile::tempdir().expect("a temporary folder");
    let mut first = Set::new(temp.path(), SetKind::Report);
    first.add("a", b"1").expect("added");
    let refused = commit(temp.path(), &NEW).expect_err("held");
    assert!(refused.to_string().contains("another run"), "{refused}");
    first.commit().expect("committed");
    assert_eq!(fs::read(temp.path().join("a")).expect("there"), b"1");
    commit(temp.path(), &NEW).expect("committed");
}

#[test]
fn old_or_new_whole_at_every_operation() {
    if !alone("sets::old_or_new_whole_at_every_operation") {
        return;
    }
    let mut points = 0;
    for there in [true, false] {
        let new = after(there);
        for mode in MODES {
            for at in 1.. {
                let (temp, old) = with_old(there);
                let folder = temp.path().join("out");
                let run = with_fault(at, mode, || commit(&folder, &NEW));
                if !run.hit {
                    assert!(run.gave.is_ok());
                    break;
                }
                points += 1;
                let found = files(&folder);
                let what = format!("{mode:?} at {at}: {:?}, then {:?}", run.gave, found.keys());
                match (mode, &run.gave) {
                    (Mode::Killed, _) => mended(&folder, &found, &old, &new, &what),
                    (_, Ok(_)) => assert_eq!(found, new, "{what}"),
                    (_, Err(_)) => assert_eq!(found, old, "{what}"),
                }
                // Whatever is left, the next run is not hindered by it.
                commit(&folder, &NEW).unwrap_or_else(|error| panic!("{what}: {error}"));
                let mut next = new.clone();
                next.extend(
                    old.iter()
                        .filter(|(name, _)| name.ends_with("mine.csv"))
                        .map(|(name, bytes)| (name.clone(), bytes.clone())),
                );
                assert_eq!(files(&folder), next, "{what}");
                assert!(leftovers(&folder).is_empty(), "{what}");
            }
        }
    }
    eprintln!("{points} points of the commit of a set");
    assert!(points > 300);
}

/// After the program ended: all of one set, or a part of one set and none of the other, which the
/// next run finishes.
fn mended(folder: &Path, found: &Files, old: &Files, new: &Files, what: &str) {
    if found == old || found == new {
        return;
    }
    let within = |set: &Files| found.iter().all(|(name, bytes)| set.get(name) == Some(bytes));
    assert!(within(old) || within(new), "mixed: {what}");
    if folder.join(".fishplate-unfinished").is_dir() {
        // Another set, so that it is seen which one the mending put there before.
        let again =
            commit(folder, &[("other", "5")]).unwrap_or_else(|error| panic!("{what}: {error}"));
        assert!(again, "it is told: {what}");
        assert!(!folder.join("results.json").exists(), "{what}");
    } else {
        panic!("neither is whole, and nothing tells it: {what}");
    }
}

/// While the set before is moved back, operations fail again.
#[test]
fn a_second_fault_is_told_and_mended() {
    if !alone("sets::a_second_fault_is_told_and_mended") {
        return;
    }
    let new = after(true);
    let mut points = 0;
    for at in 1.. {
        let (temp, old) = with_old(true);
        let folder = temp.path().join("out");
        // All operations fail from here on, those that would move the files back as well.
        let run = with_fault(at, Mode::Killed, || commit(&folder, &NEW));
        if !run.hit {
            break;
        }
        points += 1;
        let found = files(&folder);
        if run.gave.is_err() && found != old && found != new {
            let says = run.gave.expect_err("an error").to_string();
            assert!(says.contains("the folder is incomplete"), "{at}: {says}");
            commit(&folder, &NEW).expect("mended");
            assert_eq!(files(&folder), new);
        }
    }
    eprintln!("{points} points with all operations after them");
}
