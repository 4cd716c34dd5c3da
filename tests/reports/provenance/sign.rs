//! Signatures: made, checked, refused; and that minisign itself reads and writes the same.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use fishplate::provenance::signature::{check as checked, public_key, secret_key};
use fishplate::provenance::verify::Outcome;

use super::campaign::copy;
use super::program::{Ran, fishplate, program, ran};
use super::{check, example, text, written};

const PASSWORD: &str = "FISHPLATE_KEY_PASSWORD";

#[track_caller]
fn with_password(arguments: &[&str], password: &str) -> Ran {
    ran(program().args(arguments).env(PASSWORD, password).stdin(std::process::Stdio::null()))
}

/// A pair of keys without a password; the path without its ending.
fn keys(folder: &Path) -> String {
    let name = text(&folder.join("laboratory"));
    let made = fishplate(&["keygen", &name, "--no-password"]);
    assert_eq!(made.code, 0, "{}", made.stderr);
    name
}

#[test]
fn a_signed_report_verifies_and_a_changed_one_does_not() {
    let (folder, of_keys) = (copy(&written().out()), tempfile::tempdir().expect("a folder"));
    let name = keys(of_keys.path());
    let (secret, public) = (format!("{name}.key"), format!("{name}.pub"));
    let report = text(&folder.path().join("report.pdf"));
    let ran = fishplate(&["verify", &report, "--public-key", &public]);
    assert!(
        ran.code == 1 && check(&ran, "signature").starts_with("DIFFERS"),
        "a signature was asked for: {}",
        ran.stdout
    );
    let ran = fishplate(&["sign", &report, "--key", &secret]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let ran = fishplate(&["verify", &report, "--report-only"]);
    assert!(ran.code == 0 && check(&ran, "signature").contains("--public-key"), "{}", ran.stdout);
    // By file, by the key's own word, and for the folder.
    let word =
        fs::read_to_string(&public).expect("readable").lines().nth(1).expect("a key").to_string();
    let folder_name = text(folder.path());
    let statement = text(&folder.path().join("statement.json"));
    assert_eq!(fishplate(&["sign", &statement, "--key", &secret]).code, 0);
    for (of, key) in [(&report, &public), (&report, &word), (&folder_name, &public)] {
        let ran = fishplate(&["verify", of, "--public-key", key, "--report-only"]);
        assert_eq!(ran.code, 0, "{}{}", ran.stdout, ran.stderr);
        let line = check(&ran, "signature");
        assert!(line.starts_with("agrees"), "{line}");
        assert!(ran.stdout.contains("file:report.pdf sha256:"), "{}", ran.stdout);
        let of_folder = ran.stdout.contains("file:statement.json sha256:");
        assert_eq!(of_folder, of == &folder_name, "{}", ran.stdout);
    }
    // Another key.
    let other = keys(&tempfile::tempdir().expect("a folder").keep());
    let ran = fishplate(&["verify", &report, "--public-key", &format!("{other}.pub")]);
    assert!(ran.code == 1 && check(&ran, "signature").starts_with("DIFFERS"), "{}", ran.stdout);
    // Another file: one byte behind its end.
    let mut bytes = fs::read(&report).expect("readable");
    bytes.push(b'\n');
    fs::write(&report, &bytes).expect("written");
    let ran = fishplate(&["verify", &report, "--public-key", &public]);
    assert!(ran.code == 1 && check(&ran, "signature").starts_with("DIFFERS"), "{}", ran.stdout);
    // Its comment is signed as well.
    bytes.pop();
    fs::write(&report, &bytes).expect("written");
    let signature = format!("{report}.minisig");
    let before = fs::read_to_string(&signature).expect("readable");
    for (from, to) in [
        ("file:report", "file:another"),
        ("trusted comment: ", "trusted: "),
        ("RU", "RX"),
        ("=\n", "\n"),
    ] {
        fs::write(&signature, before.replace(from, to)).expect("written");
        let ran = fishplate(&["verify", &report, "--public-key", &public]);
        assert!(
            ran.code == 1 && check(&ran, "signature").starts_with("DIFFERS"),
            "{from}: {}",
            ran.stdout
        );
    }
    // Cut anywhere: never a panic, never valid.
    let key = public_key(&public).expect("a key");
    for end in 0..before.trim_end().len() {
        fs::write(&signature, &before[..end]).expect("written");
        let found = checked(Path::new(&report), Some(Path::new(&signature)), Some(&key));
        let agrees = found.is_ok_and(|check| check.outcome == Outcome::Agrees);
        assert!(!agrees, "cut at {end}");
    }
}

#[test]
fn certify_signs_what_it_writes() {
    let folder = tempfile::tempdir().expect("a folder");
    let name = keys(folder.path());
    let out = text(&folder.path().join("out"));
    let ran = fishplate(&[
        "certify",
        &text(&example("coach-good")),
        "--out",
        &out,
        "--only",
        "results",
        "--sign",
        &format!("{name}.key"),
        "-q",
    ]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let statement = folder.path().join("out/statement.json");
    assert!(statement.with_file_name("statement.json.minisig").is_file());
    assert!(
        !folder.path().join("out/results.json.minisig").exists(),
        "the statement names it with its hash"
    );
    let wrong = fishplate(&[
        "certify",
        &text(&example("coach-good")),
        "--out",
        &out,
        "--sign",
        &format!("{name}.pub"),
    ]);
    assert!(wrong.code == 2 && wrong.stderr.contains("key-unreadable"), "{}", wrong.stderr);
}

/// A signature that was made after a report goes with it, and stays where the report is written
/// again as it was.
#[test]
fn a_signature_of_an_earlier_report_goes_with_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let name = keys(folder.path());
    let out = text(&folder.path().join("out"));
    let statement = folder.path().join("out/statement.json");
    let certified = |further: &[&str]| {
        let ran = fishplate(
            &[
                &[
                    "certify",
                    &text(&example("coach-good")),
                    "--out",
                    &out,
                    "--only",
                    "results",
                    "-q",
                ],
                further,
            ]
            .concat(),
        );
        assert!(ran.code < 2, "{}", ran.stderr);
    };
    certified(&[]);
    assert_eq!(fishplate(&["sign", &text(&statement), "--key", &format!("{name}.key")]).code, 0);
    let signature = folder.path().join("out/statement.json.minisig");
    let signed = fs::read(&signature).expect("signed");
    certified(&[]);
    assert_eq!(fs::read(&signature).expect("still of this file"), signed);
    certified(&["--set", "lowpass_order=2"]);
    assert!(statement.is_file() && !signature.exists());
    // Put back by hand, it is told for what it is.
    fs::write(&signature, &signed).expect("written");
    let key = public_key(&format!("{name}.pub")).expect("a key");
    let found = checked(&statement, None, Some(&key)).expect("read");
    assert_eq!(
        (found.outcome, found.says.as_str()),
        (
            Outcome::Differs,
            "the signature is not one of this file, but of an earlier report or another file"
        )
    );
    assert!(
        found.details.len() == 1 && found.details[0].starts_with("signed: SHA-256 "),
        "{:?}",
        found.details
    );
}

#[test]
fn keys_are_protected_and_never_overwritten() {
    let folder = tempfile::tempdir().expect("a folder");
    let name = text(&folder.path().join("mine"));
    let made = with_password(&["keygen", &name], "correct horse");
    assert_eq!(made.code, 0, "{}", made.stderr);
    let secret = format!("{name}.key");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        assert_eq!(fs::metadata(&secret).expect("there").permissions().mode() & 0o777, 0o600);
    }
    let before = fs::read(&secret).expect("readable");
    let again = with_password(&["keygen", &name], "correct horse");
    assert!(again.code == 2 && again.stderr.contains("key-exists"), "{}", again.stderr);
    assert_eq!(fs::read(&secret).expect("readable"), before);
    let file = text(&folder.path().join("file"));
    fs::write(&file, "text").expect("written");
    let wrong = with_password(&["sign", &file, "--key", &secret], "battery staple");
    assert!(wrong.code == 2 && wrong.stderr.contains("Wrong password"), "{}", wrong.stderr);
    assert!(!folder.path().join("file.minisig").exists());
    let right = with_password(&["sign", &file, "--key", &secret], "correct horse");
    assert_eq!(right.code, 0, "{}", right.stderr);
    let missing =
        with_password(&["sign", &file, &format!("{file}2"), "--key", &secret], "correct horse");
    assert!(missing.code == 2 && missing.stderr.contains("file-missing"), "{}", missing.stderr);
}

/// A signature that minisign made: the example of its public documentation (key, prehashed
/// signature of the four bytes `test`).
/// A link in the place of a signature is neither written through nor read through.
#[cfg(unix)]
#[test]
fn a_signature_that_is_a_link_is_not_followed() {
    let folder = copy(&written().out());
    let name = keys(folder.path());
    let (secret, public) = (format!("{name}.key"), format!("{name}.pub"));
    let report = text(&folder.path().join("report.pdf"));
    let (link, other) = (folder.path().join("report.pdf.minisig"), folder.path().join("other"));
    fs::write(&other, "precious").expect("written");
    std::os::unix::fs::symlink(&other, &link).expect("linked");
    let ran = fishplate(&["sign", &report, "--key", &secret]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert_eq!(fs::read_to_string(&other).expect("there"), "precious");
    assert!(!link.is_symlink());
    fs::rename(&link, &other).expect("moved");
    std::os::unix::fs::symlink(&other, &link).expect("linked");
    let ran = fishplate(&["verify", &report, "--public-key", &public]);
    assert!(ran.code == 1 && check(&ran, "signature").contains("symbolic link"), "{}", ran.stdout);
}

#[test]
fn the_published_example_of_minisign_verifies() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("test");
    fs::write(&file, "test").expect("written");
    let signature = folder.path().join("test.minisig");
    let published = "untrusted comment: signature from minisign secret key\n\
        RUQf6LRCGA9i559r3g7V1qNyJDApGip8MfqcadIgT9CuhV3EMhHoN1mGTkUidF/z7SrlQgXdy8ofjb7bNJJylDOocrCo8KLzZwo=\n\
        trusted comment: timestamp:1556193335\tfile:test\n\
        y/rUw2y8/hOUYjZU71eHp/Wo1KZ40fGy2VJEDl34XMJM+TX48Ss/17u3IvIfbVR1FkZZSNCisQbuQY+bHwhEBg==\n";
    fs::write(&signature, published).expect("written");
    let key =
        public_key("RWQf6LRCGA9i53mlYecO4IzT51TGPpvWucNSCh1CBM0QTaLn73Y7GFO3").expect("a key");
    let found = checked(&file, None, Some(&key)).expect("readable");
    assert_eq!(found.outcome, Outcome::Agrees, "{found:?}");
    assert!(
        found.says.contains("E7620F1842B4E81F"),
        "the number that minisign prints: {}",
        found.says
    );
    fs::write(&file, "Test").expect("written");
    assert_eq!(checked(&file, None, Some(&key)).expect("readable").outcome, Outcome::Differs);
}

/// Both ways, where minisign is installed.
#[test]
fn minisign_and_fishplate_read_each_other() {
    let folder = tempfile::tempdir().expect("a folder");
    let name = keys(folder.path());
    let file = text(&folder.path().join("file"));
    fs::write(&file, "text\n").expect("written");
    let signed = fishplate(&["sign", &file, "--key", &format!("{name}.key")]);
    assert_eq!(signed.code, 0, "{}", signed.stderr);
    let Ok(output) =
        Command::new("minisign").args(["-Vm", &file, "-p", &format!("{name}.pub")]).output()
    else {
        crate::common::tools::skip("minisign");
        return;
    };
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success() && said.contains("Trusted comment: file:file sha256:"),
        "{said}"
    );
    // A key of minisign's own, with a password, which it reads from its input where that is no
    // terminal.
    let theirs = text(&folder.path().join("theirs"));
    let mut made = Command::new("minisign");
    made.args(["-G", "-p", &format!("{theirs}.pub"), "-s", &format!("{theirs}.key")])
        .stdin(Stdio::piped())
        .stdout(Stdio::null());
    let mut made = made.spawn().expect("minisign runs");
    made.stdin.take().expect("an input").write_all(b"secret\nsecret\n").expect("written");
    assert!(made.wait().expect("it ends").success());
    let signed = with_password(&["sign", &file, "--key", &format!("{theirs}.key")], "secret");
    assert_eq!(signed.code, 0, "{}", signed.stderr);
    let output = Command::new("minisign")
        .args(["-Vm", &file, "-p", &format!("{theirs}.pub")])
        .output()
        .expect("minisign runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let key = public_key(&format!("{theirs}.pub")).expect("a key");
    assert_eq!(
        checked(Path::new(&file), None, Some(&key)).expect("readable").outcome,
        Outcome::Agrees
    );
    // A signature that minisign made with it.
    std::fs::remove_file(format!("{file}.minisig")).expect("removed");
    let mut made = Command::new("minisign");
    made.args(["-Sm", &file, "-s", &format!("{theirs}.key")])
        .stdin(Stdio::piped())
        .stdout(Stdio::null());
    let mut made = made.spawn().expect("minisign runs");
    made.stdin.take().expect("an input").write_all(b"secret\n").expect("written");
    assert!(made.wait().expect("it ends").success());
    assert_eq!(
        checked(Path::new(&file), None, Some(&key)).expect("readable").outcome,
        Outcome::Agrees
    );
}

/// Keys cut anywhere: an error, never a panic.
#[test]
fn damaged_keys_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let name = keys(folder.path());
    let damaged = folder.path().join("damaged");
    for ending in ["key", "pub"] {
        let whole = fs::read_to_string(format!("{name}.{ending}")).expect("readable");
        for end in 1..whole.trim_end().len() {
            fs::write(&damaged, &whole[..end]).expect("written");
            let found = if ending == "key" {
                secret_key(&damaged, Some(String::new())).err()
            } else {
                public_key(&text(&damaged)).err()
            };
            let found = found.unwrap_or_else(|| panic!("{ending} cut at {end}"));
            assert_eq!(found.code, "key-unreadable", "{ending} cut at {end}");
        }
    }
    assert_eq!(public_key("RWQ").expect_err("too short").code, "key-unreadable");
    assert_eq!(public_key("").expect_err("empty").code, "key-unreadable");
}
