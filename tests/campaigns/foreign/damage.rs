//! Files that are cut off, mislabelled, empty, changed at random, or that declare or unpack to more
//! than any memory: an error that says where, in bounded time and memory, never a panic.

use std::io::Write;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::time::{Duration, Instant};

use fishplate::foreign::{Format, Options, read};
use fishplate::problem::{Problem, Problems};
use fishplate::yaml::Words;

use super::{FILES, data, text};

/// Longest time for a damaged file; an undamaged one takes some milliseconds.
const LONGEST: Duration = Duration::from_secs(10);

/// Files of three channels and eight rows: a change at random more often meets what is not a
/// sample.
const SMALL: [&str; 11] = [
    "dz.mf4",
    "plain.mf4",
    "v5.mat",
    "v5_plain.mat",
    "v73.mat",
    "book.xlsx",
    "zstd.parquet",
    "snappy.parquet",
    "lz4.feather",
    "plain.arrow",
    "group.tdms",
];

fn small() -> impl Iterator<Item = (&'static str, Vec<u8>)> {
    SMALL
        .into_iter()
        .map(|name| (name, std::fs::read(data(&format!("small/{name}"))).expect("a file")))
}

fn binary() -> impl Iterator<Item = (&'static str, Vec<u8>)> {
    let names = FILES
        .into_iter()
        .map(|(name, _)| name)
        .filter(|name| !name.ends_with("csv") && !name.ends_with("dat"));
    names.map(|name| (name, std::fs::read(data(name)).expect("a file")))
}

/// Reads a content under a name; what is refused says why.
#[track_caller]
fn tried(path: &Path, name: &str, content: &[u8], what: &str) -> Option<&'static str> {
    std::fs::write(path, content).expect("written");
    let start = Instant::now();
    let result = read(path, name, &Options::default());
    assert!(start.elapsed() < LONGEST, "{name}, {what}: {:?}", start.elapsed());
    match result {
        Ok(file) => {
            for channel in file.tables.iter().flat_map(|table| &table.channels) {
                assert!(channel.values.len() <= content.len() * 100 + (8 << 20), "{name}, {what}");
            }
            None
        }
        Err(problems) => {
            assert!(!problems.is_empty(), "{name}, {what}: refused without a word");
            let printed = Problems(problems.clone()).render(false);
            assert!(
                problems[0].says.contains(name) || problems[0].at.is_some(),
                "{name}, {what}: {printed}"
            );
            assert!(
                !printed.contains(|c: char| c.is_control() && c != '\n'),
                "{name}, {what}: {printed:?}"
            );
            Some(problems[0].code)
        }
    }
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    fn file(&self, name: &str) -> std::path::PathBuf {
        self.0.path().join(name)
    }
}

#[test]
fn a_file_that_is_cut_off_is_refused() {
    let folder = Folder::new();
    for (name, content) in binary().chain(small()) {
        for part in 0..64 {
            let cut = &content[..content.len() * part / 64];
            let code = tried(&folder.file(name), name, cut, &format!("{part}/64"));
            let expected =
                ["file-empty", "format-damaged", "format-mislabelled", "format-not-read"];
            assert!(
                code.is_some_and(|code| expected.contains(&code)),
                "{name}, {part}/64: {code:?}"
            );
        }
    }
    for name in ["windows.csv", "simpack.dat"] {
        let content = std::fs::read(data(name)).expect("a file");
        for part in 0..64 {
            tried(
                &folder.file(name),
                name,
                &content[..content.len() * part / 64],
                &format!("{part}/64"),
            );
        }
    }
}

#[test]
fn a_wrong_label_is_told() {
    let folder = Folder::new();
    for (name, content) in binary() {
        for (word, form) in Format::WORDS.iter().copied() {
            let path = folder.file("x");
            std::fs::write(&path, &content).expect("written");
            let said = Options { form: Some(form), ..Options::default() };
            match read(&path, "x", &said) {
                Ok(file) => assert_eq!(file.format, form, "{name}"),
                Err(problems) => {
                    assert_eq!(problems[0].code, "format-mislabelled", "{name} as {word}")
                }
            }
        }
        assert_eq!(tried(&folder.file(name), name, b"", "empty"), Some("file-empty"));
        assert_eq!(
            tried(&folder.file(name), name, b"t;y\n0;1\n1;2\n", "text"),
            Some("format-mislabelled")
        );
        assert!(tried(&folder.file(name), name, &[0; 4096], "zeros").is_some());
    }
}

#[test]
fn formats_that_are_not_read_name_an_export() {
    for (name, content) in [
        ("x.xls", &b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"[..]),
        ("x.mdf", b"MDF     3.30    TGT 15.0"),
        ("x.nc", b"CDF\x01\0\0\0\0"),
        ("x.nc", b"\x89HDF\r\n\x1a\n\0\0"),
        ("x.ods", b"PK\x03\x04\0\0\0mimetypeapplication/vnd.oasis.opendocument.spreadsheet"),
        ("x.xlsb", b"PK\x03\x04\0\0\0xl/workbook.bin"),
        ("x.npz", b"PK\x03\x04\0\0\0arr_0.npy"),
        ("x.dat", b"DIAEXTENDED  {@:ENGLISH\n"),
        (
            "x.tdm",
            b"<?xml version=\"1.0\"?>\n<usi:tdm xmlns:usi=\"http://www.ni.com/Schemas/USI/1_0\">",
        ),
        ("x.mat", b"\0\0\0\0\x03\0\0\0\x02\0\0\0\0\0\0\0\x02\0\0\0t\0"),
        ("x.feather", b"FEA1\0\0\0\0"),
        ("x.sbr", b"\x01\x02\x03\x04"),
        ("x.gz", b"\x1f\x8b\x08\0"),
        ("x.tdms_index", b"TDSh\x0e\0\0\0"),
    ] {
        let problem: Problem =
            text(name, content, &Options::default()).expect_err("refused").remove(0);
        assert_eq!(problem.code, "format-not-read", "{name}: {}", problem.says);
        assert!(problem.help.is_some(), "{name}");
    }
}

/// Numbers that headers declare when they are damaged: every word of four bytes at both ends of
/// each file is set to them.
const WORDS: [u32; 3] = [0x7fff_ffff, 0xffff_ffff, 0x0001_0000];
/// Bytes at each end of a file that are tried: headers and footers.
const ENDS: usize = 512;
/// Changes at random that are tried with each file.
const CHANGES: usize = 100;

/// Run by the next test in a process of its own with bounded memory.
#[test]
#[ignore = "run by `damaged_files_are_read_in_bounded_memory`"]
fn damaged() {
    let folder = Folder::new();
    for (name, content) in small().chain(binary()) {
        let path = folder.file(name);
        let places = (0..content.len() / 4)
            .map(|word| word * 4)
            .filter(|at| *at < ENDS || at + ENDS >= content.len());
        for at in places {
            for word in WORDS {
                let mut changed = content.clone();
                changed[at..at + 4].copy_from_slice(&word.to_le_bytes());
                tried(&path, name, &changed, &format!("{word:#x} at byte {at}"));
            }
        }
        let mut random = fastrand::Rng::with_seed(7);
        for change in 0..CHANGES {
            let mut changed = content.clone();
            for _ in 0..random.usize(1..12) {
                let at = random.usize(..changed.len());
                changed[at] = if random.bool() {
                    random.u8(..)
                } else {
                    [0, 1, 0x7f, 0x80, 0xff][random.usize(..5)]
                };
            }
            if random.u8(..8) == 0 {
                let from = random.usize(..changed.len());
                let part = random.usize(from..changed.len());
                changed.drain(from..part);
            }
            tried(&path, name, &changed, &format!("change {change}"));
        }
    }
}

/// Address space of the process that reads damaged files: the program, and what a file of this size
/// may unpack to.
#[cfg(target_os = "linux")]
const MOST_MEMORY_KB: usize = 1 << 20;

/// An allocation of what a header declares would end the process.
#[cfg(target_os = "linux")]
#[test]
fn damaged_files_are_read_in_bounded_memory() {
    let program = std::env::current_exe().expect("this program");
    let limited = format!(
        "ulimit -v {MOST_MEMORY_KB}; exec \"$0\" --exact damage::damaged --ignored --nocapture --test-threads 1"
    );
    let output = Command::new("sh")
        .arg("-c")
        .arg(limited)
        .arg(program)
        .env("RAYON_NUM_THREADS", "1")
        .output()
        .expect("run");
    let told = String::from_utf8_lossy(&output.stderr);
    let last: Vec<&str> = told.lines().rev().take(20).collect();
    assert!(
        output.status.success(),
        "{:?}\n{}\n{}",
        output.status,
        last.join("\n"),
        String::from_utf8_lossy(&output.stdout)
    );
}

/// Megabytes that a bomb unpacks to: more than what is accepted from a file of its size.
const BOMB: usize = 160;

#[test]
fn bombs_are_refused() {
    let folder = Folder::new();
    let block = vec![0u8; 1 << 20];
    // MATLAB 5: one compressed variable.
    let mut packed = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    (0..BOMB).for_each(|_| packed.write_all(&block).expect("written"));
    let packed = packed.finish().expect("packed");
    let mut mat = b"MATLAB 5.0 MAT-file".to_vec();
    mat.resize(124, b' ');
    mat.extend(b"\x00\x01IM\x0f\0\0\0");
    mat.extend((packed.len() as u32).to_le_bytes());
    mat.extend(packed);
    assert_eq!(tried(&folder.file("x.mat"), "x.mat", &mat, "bomb"), Some("too-many-values"));

    let mut book = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default()
        .compression_method(zip::CompressionMethod::Deflated);
    book.start_file("xl/workbook.xml", options).expect("started");
    (0..BOMB).for_each(|_| book.write_all(&block).expect("written"));
    let book = book.finish().expect("finished").into_inner();
    assert_eq!(tried(&folder.file("x.xlsx"), "x.xlsx", &book, "bomb"), Some("too-many-values"));

    // A text takes more memory for each line than for its letters.
    let lines = b"1.5,2\n".repeat((16 << 20) + 1);
    assert_eq!(tried(&folder.file("x.csv"), "x.csv", &lines, "bomb"), Some("too-many-values"));

    // Parquet: one value, repeated.
    let schema = Arc::new(arrow_schema::Schema::new(vec![arrow_schema::Field::new(
        "y",
        arrow_schema::DataType::Float64,
        false,
    )]));
    let column: arrow_array::ArrayRef =
        Arc::new(arrow_array::Float64Array::from(vec![1.0; 1 << 20]));
    let batch =
        arrow_array::RecordBatch::try_new(Arc::clone(&schema), vec![column]).expect("a batch");
    let mut writer =
        parquet::arrow::ArrowWriter::try_new(Vec::new(), schema, None).expect("a writer");
    (0..BOMB / 8).for_each(|_| writer.write(&batch).expect("written"));
    let table = writer.into_inner().expect("finished");
    assert!(table.len() < 1 << 20);
    assert_eq!(
        tried(&folder.file("x.parquet"), "x.parquet", &table, "bomb"),
        Some("too-many-values")
    );
}
