//! PDFs that are cut, damaged or made to harm: a clear error, bounded time and memory, never a
//! panic.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use fishplate::provenance::carried;

use super::program::{fishplate, program, ran};
use super::{text, written};

/// Objects 1, 2, ... put into a file with a table of their places.
fn pdf(objects: &[Vec<u8>], trailer: &str) -> Vec<u8> {
    let mut file = b"%PDF-1.7\n".to_vec();
    let mut places = Vec::new();
    for (at, object) in objects.iter().enumerate() {
        places.push(file.len());
        file.extend(format!("{} 0 obj\n", at + 1).into_bytes());
        file.extend(object);
        file.extend(b"\nendobj\n");
    }
    let table = file.len();
    file.extend(format!("xref\n0 {}\n0000000000 65535 f \n", objects.len() + 1).into_bytes());
    for place in places {
        file.extend(format!("{place:010} 00000 n \n").into_bytes());
    }
    file.extend(
        format!(
            "trailer\n<</Size {} /Root 1 0 R {trailer}>>\nstartxref\n{table}\n%%EOF\n",
            objects.len() + 1
        )
        .into_bytes(),
    );
    file
}

fn stream(dict: &str, data: &[u8]) -> Vec<u8> {
    let mut object = format!("<<{dict} /Length {}>>\nstream\n", data.len()).into_bytes();
    object.extend(data);
    object.extend(b"\nendstream");
    object
}

fn deflated(data: &[u8], times: usize) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    for _ in 0..times {
        encoder.write_all(data).expect("packed");
    }
    encoder.finish().expect("packed")
}

/// A PDF with one attachment.
fn attached(name: &str, dict: &str, data: &[u8]) -> Vec<u8> {
    let catalogue = b"<</Type/Catalog /Names<</EmbeddedFiles 2 0 R>>>>".to_vec();
    let names = b"<</Names[(a) 3 0 R]>>".to_vec();
    let file = format!("<</Type/Filespec /F({name}) /UF({name}) /EF<</F 4 0 R>>>>").into_bytes();
    pdf(&[catalogue, names, file, stream(dict, data)], "")
}

/// The message about a file that cannot be read.
#[track_caller]
fn refused(folder: &Path, bytes: &[u8]) -> String {
    let path = folder.join("hostile.pdf");
    fs::write(&path, bytes).expect("written");
    let problem = carried::open(&path).expect_err("not a report");
    assert!(
        ["pdf-unreadable", "no-results", "results-unreadable"].contains(&problem.code),
        "{}",
        problem.render(false)
    );
    problem.render(false)
}

#[test]
fn a_report_cut_anywhere_is_refused() {
    let whole = fs::read(written().pdf()).expect("readable");
    let folder = tempfile::tempdir().expect("a folder");
    let ends = (0..60)
        .map(|part| whole.len() * part / 60)
        .chain(whole.len() - 60..whole.len() - 7)
        .chain(0..40);
    for end in ends {
        let says = refused(folder.path(), &whole[..end.max(1)]);
        assert!(
            says.contains("is not a PDF")
                || says.contains("cannot be read")
                || says.contains("has no attachment"),
            "{end}: {says}"
        );
    }
}

/// Bytes flipped by a fixed recurrence, most of them where the structure is.
#[test]
fn a_damaged_report_never_panics() {
    let whole = fs::read(written().pdf()).expect("readable");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("damaged.pdf");
    let mut state = 1_u64;
    let mut next = |below: usize| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(state >> 33).expect("small") % below
    };
    let catalogue =
        whole.windows(13).rposition(|window| window == b"/Type/Catalog").expect("a catalogue");
    let filespec =
        whole.windows(14).position(|window| window == b"/Type/Filespec").expect("a file");
    let (mut opened, mut not) = (0, 0);
    for _ in 0..300 {
        let mut bytes = whole.clone();
        for _ in 0..=next(3) {
            let at = match next(4) {
                0 => bytes.len() - 1 - next(400),
                1 => catalogue + next(300),
                2 => filespec + next(600),
                _ => next(bytes.len()),
            };
            bytes[at.min(whole.len() - 1)] ^= 1 << next(8);
        }
        fs::write(&path, &bytes).expect("written");
        if carried::open(&path).is_ok() { opened += 1 } else { not += 1 }
    }
    assert!(opened > 20 && not > 20, "{opened} opened, {not} did not");
}

#[test]
fn what_leads_in_circles_or_nowhere_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let catalogue = |more: &str| format!("<</Type/Catalog {more}>>").into_bytes();
    let embedded = "/Names<</EmbeddedFiles 2 0 R>>";
    for (name, bytes, says) in [
        ("no attachment", pdf(&[catalogue("")], ""), "has no attachment `results.json`"),
        ("another attachment", attached("study.json", "", b"{}"), "its attachments are study.json"),
        ("no catalogue", pdf(&[b"null".to_vec()], ""), "its catalogue is missing"),
        ("encrypted", pdf(&[catalogue("")], "/Encrypt 1 0 R"), "is encrypted"),
        ("a table before itself", pdf(&[catalogue("")], "/Prev 0"), "cannot be read"),
        (
            "a tree that is its own branch",
            pdf(&[catalogue(embedded), b"<</Kids[2 0 R 2 0 R]>>".to_vec()], ""),
            "too long",
        ),
        (
            "references in a circle",
            pdf(&[catalogue("/Names 2 0 R"), b"3 0 R".to_vec(), b"2 0 R".to_vec()], ""),
            "circle",
        ),
        (
            "a deep array",
            pdf(
                &[catalogue("/AF 2 0 R"), [b"[".repeat(100_000), b"]".repeat(100_000)].concat()],
                "",
            ),
            "nested too deeply",
        ),
        (
            "a wide array",
            pdf(
                &[
                    catalogue("/AF 2 0 R"),
                    [b"[".to_vec(), b"0 ".repeat(3_000_000), b"]".to_vec()].concat(),
                ],
                "",
            ),
            "too large",
        ),
        (
            "a name that is a long text",
            pdf(
                &[
                    catalogue("/AF 2 0 R"),
                    [b"(".to_vec(), vec![b'x'; 20_000_000], b")".to_vec()].concat(),
                ],
                "",
            ),
            "too large",
        ),
        (
            "two filters",
            attached("results.json", "/Filter[/FlateDecode/FlateDecode]", b"x"),
            "uses a compression that is not supported",
        ),
        (
            "not packed",
            attached("results.json", "/Filter/FlateDecode", b"not packed"),
            "cannot be unpacked",
        ),
        (
            "no results",
            attached("results.json", "", b"{\"fishplate\": 1}"),
            "not a results file of `certify`",
        ),
        ("not UTF-8", attached("results.json", "", b"\xff\xfe{}"), "not UTF-8"),
    ] {
        let found = if name == "not UTF-8" {
            let path = folder.path().join("hostile.pdf");
            fs::write(&path, &bytes).expect("written");
            carried::open(&path).expect_err("no text").render(false)
        } else {
            refused(folder.path(), &bytes)
        };
        assert!(found.contains(says), "{name}: {found}");
    }
    // A table that leads back to itself.
    let mut looped = pdf(&[catalogue("")], "/Prev 0000000000");
    let table = looped.windows(5).position(|window| window == b"xref\n").expect("a table");
    let at = looped.windows(10).rposition(|window| window == b"0000000000").expect("a number");
    looped[at..at + 10].copy_from_slice(format!("{table:010}").as_bytes());
    assert!(refused(folder.path(), &looped).contains("circle"));
    // A group of objects whose length stands in itself.
    let group = b"<</Type/ObjStm /N 1 /First 4 /Length 3 0 R>>\nstream\n3 0 1\nendstream".to_vec();
    let mut rows = Vec::new();
    let catalogue_object = catalogue("/AF 3 0 R");
    let mut file = b"%PDF-1.7\n".to_vec();
    for (number, object) in [(1, &catalogue_object), (2, &group)] {
        rows.push([1_u8, 0, u8::try_from(file.len()).expect("small"), 0]);
        file.extend(format!("{number} 0 obj\n").into_bytes());
        file.extend(object);
        file.extend(b"\nendobj\n");
    }
    rows.push([2, 0, 2, 0]);
    let place = file.len();
    let data: Vec<u8> = [0, 0, 0, 0].into_iter().chain(rows.concat()).collect();
    file.extend(b"4 0 obj\n");
    file.extend(stream("/Type/XRef /Size 4 /W[1 2 1] /Root 1 0 R", &data));
    file.extend(format!("\nendobj\nstartxref\n{place}\n%%EOF\n").into_bytes());
    assert!(refused(folder.path(), &file).contains("circle"));
}

/// 12 MB that unpack to 12 GB, as an attachment and as a table of places, and a protocol of 1 GB,
/// within 1.5 GB of address space.
#[test]
fn bombs_stay_packed() {
    let folder = tempfile::tempdir().expect("a folder");
    let zeros = vec![b' '; 1 << 20];
    let bomb = deflated(&zeros, 3_000);
    assert!(bomb.len() < 32 << 20);
    let check = |name: &str, bytes: &[u8], says: &str| {
        let path: PathBuf = folder.path().join(name);
        fs::write(&path, bytes).expect("written");
        let arguments = ["verify", &text(&path)];
        let found = if cfg!(unix) {
            let mut limited = std::process::Command::new("sh");
            limited
                .args([
                    "-c",
                    "ulimit -v 1500000 && exec \"$0\" \"$@\"",
                    env!("CARGO_BIN_EXE_fishplate"),
                ])
                .args(arguments);
            ran(&mut limited)
        } else {
            ran(program().args(arguments))
        };
        assert!(
            found.code == 2 && found.stderr.contains(says),
            "{name}: {} {}{}",
            found.code,
            found.stdout,
            found.stderr
        );
    };
    check(
        "results.pdf",
        &attached("results.json", "/Filter/FlateDecode", &bomb),
        "too large after unpacking",
    );
    let mut table = b"%PDF-1.7\n".to_vec();
    let place = table.len();
    table.extend(b"1 0 obj\n");
    table.extend(stream("/Type/XRef /Size 4 /W[1 2 1] /Root 1 0 R /Filter/FlateDecode", &bomb));
    table.extend(format!("\nendobj\nstartxref\n{place}\n%%EOF\n").into_bytes());
    check("table.pdf", &table, "too large after unpacking");
    // Results that are small and a protocol that is not.
    let results = fs::read(written().results()).expect("readable");
    let file = |name: &str, data: usize| {
        format!("<</Type/Filespec /F({name}) /UF({name}) /EF<</F {data} 0 R>>>>").into_bytes()
    };
    let objects = [
        b"<</Type/Catalog /AF[2 0 R 3 0 R]>>".to_vec(),
        file("results.json", 4),
        file("protocol-1-p.fp", 5),
        stream("/Filter/FlateDecode", &deflated(&results, 1)),
        stream("/Filter/FlateDecode", &bomb),
    ];
    check("protocol.pdf", &pdf(&objects, ""), "too large after unpacking");
}

/// What users write stays text: signs that move the cursor are spelled out on the terminal.
#[test]
fn names_in_a_report_cannot_act_on_the_terminal() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("results.json");
    let before = fs::read_to_string(written().results()).expect("readable");
    let name =
        serde_json::from_str::<serde_json::Value>(&before).expect("JSON")["campaign"]["name"]
            .clone();
    let name = name.as_str().expect("a name").to_string();
    fs::write(&path, before.replace(&name, "\\u001b[2J\\u202eevil").replace("S05", "\\u001b[31mS"))
        .expect("written");
    for arguments in [["verify", &text(&path), ""], ["trace", &text(&path), "Y_max"]] {
        let mut words: Vec<&str> =
            arguments.iter().copied().filter(|word| !word.is_empty()).collect();
        if words[0] == "trace" {
            words.extend(["S06", "Y_1R"]);
        }
        let found = fishplate(&words);
        assert!(found.code <= 1, "{}", found.stderr);
        assert!(
            !found.stdout.contains('\u{1b}') && !found.stdout.contains('\u{202e}'),
            "{}",
            found.stdout
        );
    }
}
