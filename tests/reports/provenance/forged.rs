//! Forgeries: what is added behind a PDF, and folders whose files do not belong together. Each is
//! refused by name; a signature inside the PDF is not.

use std::fs;
use std::path::Path;

use sha2::{Digest, Sha256};

use super::campaign::{copy, replace};
use super::program::{Ran, fishplate};
use super::{check, text, written};

/// An object of the file that contains a text: its number, and what stands between `obj` and
/// `endobj`.
fn object(bytes: &[u8], holds: &str) -> (usize, String) {
    let find = |text: &[u8]| bytes.windows(text.len()).position(|part| part == text);
    let at = find(holds.as_bytes()).expect("there");
    let head = bytes[..at].windows(7).rposition(|part| part == b" 0 obj\n").expect("an object");
    let digits = bytes[..head].iter().rev().take_while(|byte| byte.is_ascii_digit()).count();
    let number = std::str::from_utf8(&bytes[head - digits..head]).expect("digits");
    let end = at + bytes[at..].windows(6).position(|part| part == b"endobj").expect("its end");
    let content = String::from_utf8_lossy(&bytes[head + 7..end]).trim_end().to_string();
    (number.parse().expect("a number"), content)
}

/// The number that follows a key.
fn number_after(text: &str, key: &str) -> usize {
    let rest = text.split_once(key).expect("the key").1.trim_start();
    let digits: String = rest.chars().take_while(char::is_ascii_digit).collect();
    digits.parse().expect("a number")
}

/// An update with these objects, and a table of their places that `lines` may change.
fn updated(bytes: &[u8], objects: &[(usize, String)], more: &str) -> Vec<u8> {
    let tail = String::from_utf8_lossy(&bytes[bytes.len() - 300..]).into_owned();
    let (root, info) = (number_after(&tail, "/Root "), number_after(&tail, "/Info "));
    let before = number_after(&tail, "startxref");
    let size = objects.iter().map(|(number, _)| number + 1).max().unwrap_or(0);
    let size = size.max(number_after(&tail, "/Size "));
    let (mut file, mut table) = (bytes.to_vec(), String::new());
    file.push(b'\n');
    for (number, content) in objects {
        table += &format!("{number} 1\n{:010} 00000 n \n", file.len());
        file.extend(format!("{number} 0 obj\n{content}\nendobj\n").into_bytes());
    }
    let at = file.len();
    let trailer = format!("<</Size {size}/Root {root} 0 R/Info {info} 0 R/Prev {before}{more}>>");
    let end = format!("xref\n{table}trailer\n{trailer}\nstartxref\n{at}\n%%EOF\n");
    file.extend(end.into_bytes());
    file
}

/// A number that no object has.
const NEW: usize = 900_000;

/// A signature as another program adds it: its field on the cover, and the form in the catalogue.
/// The signed bytes are all but the signature; the signature itself is zeros.
fn signed(bytes: &[u8], rectangle: &str, more: &[(usize, String)]) -> Vec<u8> {
    const WIDTH: usize = 64;
    const BLANK: &str = "0000000000";
    let (page, of_page) = object(bytes, "/Type/Page/");
    let (root, catalogue) = object(bytes, "/Type/Catalog");
    let dict = |text: &str| text.strip_suffix(">>").expect("a dictionary").to_string();
    let mut objects = vec![
        (page, format!("{}/Annots[{NEW} 0 R]>>", dict(&of_page))),
        (root, format!("{}/AcroForm<</Fields[{NEW} 0 R]/SigFlags 3>>>>", dict(&catalogue))),
        (
            NEW,
            format!(
                "<</Type/Annot/Subtype/Widget/FT/Sig/T(one)/F 132/Rect[{rectangle}]/V {} 0 R>>",
                NEW + 1
            ),
        ),
        (
            NEW + 1,
            format!(
                "<</Type/Sig/Filter/Adobe.PPKLite/ByteRange[0 {BLANK} {BLANK} {BLANK}]/Contents<{}>>>",
                "0".repeat(WIDTH)
            ),
        ),
    ];
    objects.extend_from_slice(more);
    let mut file = updated(bytes, &objects, "");
    let find = |text: &str, file: &[u8]| {
        file.windows(text.len()).rposition(|part| part == text.as_bytes()).expect("there")
    };
    let first = find("/Contents<0", &file) + "/Contents".len();
    let second = first + WIDTH + 2;
    let range = [first, second, file.len() - second];
    let at = find("/ByteRange[0 ", &file) + "/ByteRange[0 ".len();
    let digits = range.map(|number| format!("{number:010}")).join(" ");
    file[at..at + digits.len()].copy_from_slice(digits.as_bytes());
    file
}

fn pdf() -> Vec<u8> {
    fs::read(written().pdf()).expect("readable")
}

fn verified(folder: &Path, bytes: &[u8]) -> [Ran; 2] {
    let path = folder.join("report.pdf");
    fs::write(&path, bytes).expect("written");
    let (path, campaign) = (text(&path), text(&written().campaign()));
    [fishplate(&["verify", &path, "--report-only"]), fishplate(&["verify", &path, &campaign])]
}

/// What paints over a page, exchanges what is attached or hides behind the structure of the file is
/// refused, with and without the campaign.
#[test]
fn nothing_but_a_signature_may_follow_the_end() {
    let whole = pdf();
    let (page, of_page) = object(&whole, "/Type/Page/");
    let (root, catalogue) = object(&whole, "/Type/Catalog");
    let contents = number_after(&of_page, "/Contents");
    let attached = number_after(&catalogue, "(attached/results.json)");
    let paints = "BT /F1 40 Tf (VALIDATED) Tj ET";
    let painted = format!("<</Length {}>>\nstream\n{paints}\nendstream", paints.len());
    let note = "<</Type/Annot/Subtype/FreeText/Rect[50 50 500 200]/Contents(VALIDATED)>>";
    let dict = |text: &str| text.strip_suffix(">>").expect("a dictionary").to_string();
    let zeros = "0 0 0 0";
    let other_root = format!("<</Type/Catalog/Pages {NEW} 0 R>>");
    let mut packed = updated(&whole, &[], "");
    // A table that is compressed, whose objects are in groups.
    packed.truncate(whole.len());
    let at = packed.len() + 1;
    packed.extend(
        format!(
            "\n{NEW} 0 obj\n<</Type/XRef/W[1 4 1]/Index[{contents} 1]/Size {}/Root {root} 0 R/Length 6/Prev {}>>\nstream\n\u{2}\0\0\0\u{1}\0\nendstream\nendobj\nstartxref\n{at}\n%%EOF\n",
            NEW + 1,
            number_after(&String::from_utf8_lossy(&whole[whole.len() - 60..]), "startxref")
        )
        .into_bytes(),
    );
    let mut hidden = signed(&whole, zeros, &[]);
    hidden.extend(b"\n% a comment that paints nothing yet\n");
    // The same dictionary with other data.
    let place = whole
        .windows(format!("\n{contents} 0 obj\n").len())
        .position(|part| part == format!("\n{contents} 0 obj\n").as_bytes())
        .expect("the contents");
    let end = place + whole[place..].windows(6).position(|part| part == b"stream").expect("data");
    let of_contents =
        String::from_utf8_lossy(&whole[place..end]).split_once("obj\n").expect("it").1.to_string();
    let length = number_after(&of_contents, "/Length");
    let blank = format!("{of_contents}stream\n{}\nendstream", " ".repeat(length));
    let twice = of_page.strip_suffix(">>").expect("a dictionary").to_string()
        + &format!("/Rotate 90/Rotate 0/Annots[{NEW} 0 R]>>");
    // An earlier table that stands in the data of a new object.
    let fake =
        format!("xref\n{contents} 1\n0000000017 00000 n \ntrailer\n<</Size 9/Root {root} 0 R>>");
    let hides = format!("<</Length {}>>\nstream\n{fake}\nendstream", fake.len());
    let elsewhere = {
        let sound = signed(&whole, zeros, &[(NEW + 2, hides)]);
        let at = sound.windows(5).rposition(|part| part == b"/Prev").expect("the last one") + 6;
        let inside = sound.windows(fake.len()).position(|part| part == fake.as_bytes());
        let inside = inside.expect("the table");
        let old = number_after(&String::from_utf8_lossy(&sound[at - 6..]), "/Prev ").to_string();
        let new = format!("{inside:0width$}", width = old.len());
        let mut moved = sound.clone();
        moved[at..at + old.len()].copy_from_slice(new.as_bytes());
        moved
    };
    let forged: [(&str, Vec<u8>, &str); 15] = [
        ("same dictionary", signed(&whole, zeros, &[(contents, blank)]), "an object is changed"),
        ("key twice", updated(&whole, &[(page, twice)], ""), "a key stands twice"),
        ("another earlier table", elsewhere, "do not follow each other"),
        (
            "painted page",
            updated(&whole, &[(contents, painted.clone())], ""),
            "an object is changed",
        ),
        (
            "signature and painted page",
            signed(&whole, zeros, &[(contents, painted.clone())]),
            "an object is changed",
        ),
        (
            "annotation",
            updated(
                &whole,
                &[(NEW, note.into()), (page, format!("{}/Annots[{NEW} 0 R]>>", dict(&of_page)))],
                "",
            ),
            "a page is changed",
        ),
        (
            "page of another size",
            updated(&whole, &[(page, of_page.replace("841.8898", "84.8898"))], ""),
            "a page is changed",
        ),
        ("signature that is shown", signed(&whole, "0 0 500 800", &[]), "is changed"),
        (
            "other results",
            updated(&whole, &[(attached, "<</Type/Filespec/F(results.json)>>".into())], ""),
            "an object is changed",
        ),
        (
            "action of the catalogue",
            updated(&whole, &[(root, format!("{}/OpenAction {NEW} 0 R>>", dict(&catalogue)))], ""),
            "the catalogue is changed",
        ),
        ("other catalogue", updated(&whole, &[(NEW, other_root)], ""), "no signature is added"),
        ("table without objects", updated(&whole, &[], ""), "no signature is added"),
        ("compressed table", packed, "no update"),
        ("second table of both forms", updated(&whole, &[], "/XRefStm 9"), "table"),
        ("bytes behind a signature", hidden, "no update"),
    ];
    let folder = tempfile::tempdir().expect("a folder");
    for (name, bytes, says) in forged {
        for ran in verified(folder.path(), &bytes) {
            // What cannot be opened at all is refused as well.
            if ran.code == 2 {
                let refused = ["pdf-unreadable", "no-results"];
                let told = refused.iter().any(|code| ran.stderr.contains(code));
                assert!(told, "{name}: {}", ran.stderr);
                continue;
            }
            assert_eq!(ran.code, 1, "{name}: {}", ran.stdout);
            let line = check(&ran, "end of the PDF");
            assert!(line.starts_with("DIFFERS"), "{name}: {}", ran.stdout);
            assert!(ran.stdout.contains(says), "{name}: {}", ran.stdout);
        }
    }
}

#[test]
fn a_signature_that_is_not_shown_is_accepted() {
    let folder = tempfile::tempdir().expect("a folder");
    let bytes = signed(&pdf(), "0 0 0 0", &[]);
    for ran in verified(folder.path(), &bytes) {
        assert_eq!(ran.code, 0, "{}{}", ran.stdout, ran.stderr);
        let line = check(&ran, "end of the PDF");
        assert!(line.contains("nothing but a signature"), "{line}");
    }
    // Its range must be all of the file.
    let short = String::from_utf8_lossy(&bytes[bytes.len() - 2000..]).into_owned();
    let range = short.split_once("/ByteRange[0 ").expect("a range").1[..10].to_string();
    let at = bytes.windows(10).rposition(|part| part == range.as_bytes()).expect("there");
    let mut other = bytes.clone();
    other[at + 9] ^= 1;
    for ran in verified(folder.path(), &other) {
        assert!(ran.code == 1 && ran.stdout.contains("no signature is added"), "{}", ran.stdout);
    }
}

/// A report alone is not compared with anything, which is no success unless it is asked for.
#[test]
fn a_report_alone_is_not_enough() {
    let report = text(&written().pdf());
    let ran = fishplate(&["verify", &report]);
    assert_eq!(ran.code, 1, "{}", ran.stdout);
    assert!(
        ran.stdout.contains("not checked: pages, findings, names")
            && !ran.stdout.to_lowercase().contains("differs"),
        "{}",
        ran.stdout
    );
    assert_eq!(fishplate(&["verify", &report, "--report-only"]).code, 0);
    // Results that claim another version of the program leave the pages unchecked.
    let folder = copy(&written().out());
    let results = folder.path().join("results.json");
    fs::remove_file(folder.path().join("report.pdf")).expect("removed");
    let version = format!("\"fishplate\": \"{}\"", env!("CARGO_PKG_VERSION"));
    replace(&results, &version, "\"fishplate\": \"0.0.1\"");
    let protocol = text(&written().campaign().join("rules/p.fp"));
    let (folder, campaign) = (text(folder.path()), text(&written().campaign()));
    let ran = fishplate(&["verify", &folder, &campaign, "--protocol", &protocol]);
    assert!(ran.code == 1 && check(&ran, "pages").starts_with("not checked"), "{}", ran.stdout);
}

/// Puts the present hashes of the files into the statement, as a forger would.
fn restated(folder: &Path, keep: &dyn Fn(&str) -> bool) {
    let path = folder.join("statement.json");
    let statement = fs::read_to_string(&path).expect("readable");
    let mut value: serde_json::Value = serde_json::from_str(&statement).expect("JSON");
    let subjects = value["subject"].as_array_mut().expect("a list");
    subjects.retain(|subject| keep(subject["name"].as_str().expect("a name")));
    for subject in subjects {
        let bytes = fs::read(folder.join(subject["name"].as_str().expect("a name")));
        let digest = Sha256::digest(bytes.expect("readable"));
        let hash: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
        subject["digest"]["sha256"] = hash.into();
    }
    fs::write(&path, serde_json::to_string_pretty(&value).expect("JSON") + "\n").expect("written");
}

/// Every file of a folder is made again; the statement names all of them.
#[test]
fn files_of_a_folder_belong_together() {
    type Change<'a> = (&'a str, &'a dyn Fn(&Path), &'a str, &'a str);
    let all = |_: &str| true;
    let changes: [Change<'_>; 9] = [
        (
            "edited page",
            &|out| {
                replace(&out.join("report.html"), "not validated", "validated");
                restated(out, &all);
            },
            "pages",
            "report.html: from byte",
        ),
        (
            "edited table",
            &|out| {
                replace(&out.join("tables/summary.csv"), "false", "true");
                restated(out, &all);
            },
            "pages",
            "tables/summary.csv: from byte",
        ),
        (
            "fewer files named",
            &|out| restated(out, &|name| name != "report.html"),
            "statement",
            "not in the statement: report.html",
        ),
        (
            "table left out",
            &|out| {
                fs::remove_file(out.join("tables/findings.csv")).expect("removed");
                restated(out, &|name| name != "tables/findings.csv");
            },
            "pages",
            "tables/findings.csv: missing",
        ),
        (
            "no statement",
            &|out| fs::remove_file(out.join("statement.json")).expect("removed"),
            "statement",
            "statement.json",
        ),
        (
            "renamed file",
            &|out| {
                fs::rename(out.join("tables/zones.csv"), out.join("tables/zone.csv"))
                    .expect("renamed");
            },
            "statement",
            "not in the statement: tables/zone.csv",
        ),
        (
            "another report beside it",
            &|out| drop(fs::copy(out.join("report.pdf"), out.join("report 2.pdf"))),
            "statement",
            "not in the statement: report 2.pdf",
        ),
        (
            "results of another run",
            &|out| {
                replace(&out.join("results.json"), "\"zone\": 2", "\"zone\": 3");
                restated(out, &all);
            },
            "results.json",
            "results.json differs from the one inside report.pdf",
        ),
        (
            "inputs of another campaign",
            &|out| replace(&out.join("statement.json"), "campaign/vehicle.yaml", "campaign/v.yaml"),
            "pages",
            "statement.json: from byte",
        ),
    ];
    let campaign = text(&written().campaign());
    for (name, change, of, says) in changes {
        let out = copy(&written().out());
        change(out.path());
        let ran = fishplate(&["verify", &text(out.path()), &campaign]);
        assert_eq!(ran.code, 1, "{name}: {}{}", ran.stdout, ran.stderr);
        assert!(check(&ran, of).starts_with("DIFFERS"), "{name}: {}", ran.stdout);
        assert!(ran.stdout.contains(says), "{name}: {}", ran.stdout);
    }
    let ran = fishplate(&["verify", &text(&written().out()), &campaign]);
    let pages = check(&ran, "pages");
    assert!(ran.code == 0 && pages.contains("files are, byte for byte"), "{}", ran.stdout);
}

/// The signature of the statement is asked for with a key; without one, a signature of another file is
/// told by the hash in its comment.
#[test]
fn a_signature_of_another_file_is_told() {
    let out = copy(&written().out());
    let keys = tempfile::tempdir().expect("a folder");
    let name = text(&keys.path().join("laboratory"));
    assert_eq!(fishplate(&["keygen", &name, "--no-password"]).code, 0);
    let (secret, public) = (format!("{name}.key"), format!("{name}.pub"));
    let folder = text(out.path());
    let ran = fishplate(&["verify", &folder, "--public-key", &public, "--report-only"]);
    assert!(ran.code == 1 && ran.stdout.contains("no signature `statement.json"), "{}", ran.stdout);
    let [report, statement] = ["report.pdf", "statement.json"].map(|name| out.path().join(name));
    assert_eq!(fishplate(&["sign", &text(&report), "--key", &secret]).code, 0);
    let signature = |path: &Path| {
        path.with_extension(format!(
            "{}.minisig",
            path.extension().expect("an ending").to_string_lossy()
        ))
    };
    fs::rename(signature(&report), signature(&statement)).expect("moved");
    for more in [&["--public-key", &public][..], &[]] {
        let ran = fishplate(&[&["verify", &folder, "--report-only"], more].concat());
        assert_eq!(ran.code, 1, "{}", ran.stdout);
        let line = check(&ran, "signature");
        assert!(line.starts_with("DIFFERS") && line.contains("another file"), "{line}");
    }
    assert_eq!(fishplate(&["sign", &text(&statement), "--key", &secret]).code, 0);
    let ran = fishplate(&["verify", &folder, "--public-key", &public, "--report-only"]);
    assert_eq!(ran.code, 0, "{}", ran.stdout);
}
