//! The PDF report: it compiles, says what it should, and is the same every time.

// Each test file uses a part of what they share.

use std::io::Write;
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use crate::common::certification::{HOSTILE, LONG};
use crate::common::{assessment, certification};
use fishplate::report::pdf::{Attachment, Pdf};
use fishplate::report::typst::typeset;
use fishplate::report::view::document;
use fishplate::result::{Certification, Reason, Verdict};

const RESULTS: &[u8] = b"{\"verdict\": \"not validated\"}\n";

fn attached() -> Attachment<'static> {
    Attachment {
        name: "results.json",
        mime: "application/json",
        bytes: RESULTS,
        description: "Results in full precision",
    }
}

/// A report that compiled without a remark.
#[track_caller]
fn rendered(found: &Certification) -> Pdf {
    match typeset(&document(found), &fishplate::report::figure::figures(found), &[attached()]) {
        Ok(pdf) => {
            assert!(pdf.warnings.0.is_empty(), "{}", pdf.warnings.render(false));
            pdf
        }
        Err(problems) => panic!("{}", problems.render(false)),
    }
}

/// The full report, typeset once for all tests that only look at it.
fn full() -> &'static Pdf {
    static FULL: OnceLock<Pdf> = OnceLock::new();
    FULL.get_or_init(|| rendered(&certification::certification()))
}

/// What a tool of poppler prints about a PDF; `None` where the tool is not installed.
fn poppler(tool: &str, arguments: &[&str], pdf: &Pdf) -> Option<Vec<u8>> {
    let mut file = tempfile::NamedTempFile::new().expect("a temporary file");
    file.write_all(&pdf.bytes).expect("the temporary file can be written");
    let (before, after): (Vec<&str>, Vec<&str>) =
        arguments.iter().partition(|argument| **argument != "-");
    match Command::new(tool)
        .args(before)
        .arg(file.path())
        .args(after)
        .stderr(Stdio::null())
        .output()
    {
        Ok(output) => Some(output.stdout),
        Err(_) => {
            crate::common::tools::skip(tool);
            None
        }
    }
}

fn text(pdf: &Pdf) -> Option<String> {
    let text = poppler("pdftotext", &["-layout", "-"], pdf)?;
    Some(String::from_utf8(text).expect("pdftotext writes UTF-8").replace('\u{200b}', ""))
}

/// The first attached file. Written to a folder: a program may not open `/dev/stdout` where that is
/// a socket.
fn detached(pdf: &Pdf) -> Option<Vec<u8>> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("attached");
    poppler("pdfdetach", &["-save", "1", "-o", file.to_str().expect("a path in UTF-8")], pdf)?;
    Some(std::fs::read(file).expect("pdfdetach has written the attached file"))
}

/// Without white space, for texts that wrap.
fn dense(text: &str) -> String {
    text.split_whitespace().collect()
}

fn holds(bytes: &[u8], word: &str) -> bool {
    bytes.windows(word.len()).any(|window| window == word.as_bytes())
}

#[test]
fn a_full_report_compiles_and_has_its_parts() {
    let found = certification::certification();
    let pdf = full();
    if let Ok(path) = std::env::var("REPORT_PDF") {
        std::fs::write(path, &pdf.bytes).expect("REPORT_PDF can be written");
    }
    assert!((30..=60).contains(&pdf.pages), "{} pages", pdf.pages);
    let Some(text) = text(pdf) else { return };
    for word in [
        "NOT VALIDATED",
        "Contents",
        "Summary",
        "Sections",
        "Validity domain",
        "Processing graph",
        "Provenance",
        "Signature",
        "not assessed",
    ] {
        assert!(text.contains(word), "{word} is missing");
    }
    for quantity in &found.quantities[..12] {
        assert!(text.contains(&quantity.title), "{} is missing", quantity.title);
    }
    assert!(text.contains(&format!("page {0} of {0}", pdf.pages)), "the last page has its number");
    assert!(!text.contains("NaN") && !text.contains("-0.0"), "numbers are worded");
}

#[test]
fn an_assessment_compiles_and_speaks_of_no_simulation() {
    let pdf = rendered(&assessment::certification());
    let Some(text) = text(&pdf) else { return };
    for word in [
        "Assessment of a vehicle by measured records",
        "REQUIREMENTS NOT MET",
        "Assessed values",
        "Test conditions",
        "15 of 16; 1 not",
    ] {
        assert!(text.contains(word), "{word} is missing");
    }
    let before = text.split("Verdict rule").next().unwrap_or_default();
    assert!(
        !before.contains("alidat")
            && !text.contains("Pairs")
            && !text.contains("simulated against"),
        "{before}"
    );
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let found = certification::certification();
    assert!(rendered(&found).bytes == full().bytes);
    let mut other = found;
    other.campaign.name.push('!');
    assert!(rendered(&other).bytes != full().bytes);
}

#[test]
fn text_of_users_is_printed_as_it_is() {
    let mut found = certification::certification();
    found.campaign.name = HOSTILE.into();
    found.protocol.title = format!("{HOSTILE} {HOSTILE}");
    // The same reason is printed once.
    found.reasons = (0..40).map(|number| Reason::said(format!("{HOSTILE} {number}"))).collect();
    let Some(text) = text(&rendered(&found)) else { return };
    let text = dense(&text);
    // In a sentence of the program, a name between backticks is set in another font instead.
    let times = text.matches(&dense(HOSTILE)).count()
        + text.matches(&dense(&HOSTILE.replace("`code`", "code"))).count();
    assert!(times >= 40, "printed {times} times");
    assert!(text.contains(&dense(LONG)), "a long name is wrapped, not lost");
    assert!(text.contains("⟨U+4E2DU+6587⟩"), "a sign without glyph is spelled out");
    assert!(text.contains("⟨U+202E⟩gnp.exe⟨U+0007⟩"), "a change of direction is shown");
}

#[test]
fn an_archive_can_keep_it() {
    let pdf = full();
    assert!(pdf.bytes.starts_with(b"%PDF-1.7"));
    for word in [
        "pdfaid:part",
        "pdfaid:conformance",
        "pdfuaid:part",
        "/StructTreeRoot",
        "/Lang",
        "/Outlines",
    ] {
        assert!(holds(&pdf.bytes, word), "{word} is missing");
    }
    assert!(holds(&pdf.bytes, "2023-06-30T00:00:00"), "the date is that of issue");
}

#[test]
fn a_report_without_a_date_of_issue_bears_none() {
    let mut found = certification::certification();
    found.campaign.report.0.clear();
    let pdf = rendered(&found);
    for word in
        ["ModDate", "CreationDate", "xmp:CreateDate", "xmp:ModifyDate", "stEvt:when", "0001-01-01"]
    {
        assert!(!holds(&pdf.bytes, word), "{word}");
    }
    assert!(pdf.pages > 30 && holds(&pdf.bytes, "AFRelationship"));
    let Some(info) = poppler("pdfinfo", &[], &pdf) else { return };
    let info = String::from_utf8_lossy(&info);
    assert!(info.contains("Tagged") && !info.contains("CreationDate"), "{info}");
    let Some(attached) = detached(&pdf) else { return };
    assert_eq!(attached, RESULTS, "the file is whole");
}

#[test]
fn what_a_report_is_known_by_stands_in_it() {
    let Some(text) = text(full()) else { return };
    for word in [
        "Identification of the report",
        "ISO/IEC 17025:2017",
        "Report R-2023-17, revision B",
        "not stated",
        "Notation",
        "page 2 of",
    ] {
        assert!(text.contains(word), "`{word}` is missing");
    }
    assert!(text.contains("continued"), "tables that reach over pages say so");
}

#[test]
fn results_are_attached() {
    let pdf = full();
    assert!(holds(&pdf.bytes, "results.json") && holds(&pdf.bytes, "AFRelationship"));
    let Some(found) = detached(pdf) else { return };
    assert_eq!(found, RESULTS);
}

#[test]
fn a_report_about_nothing_compiles() {
    let pdf = rendered(&certification::empty());
    assert!((3..=10).contains(&pdf.pages), "{} pages", pdf.pages);
}

#[test]
fn missing_parts_leave_no_trace() {
    let full = certification::certification;
    let without_quantities = Certification { quantities: Vec::new(), ..full() };
    let without_sections = Certification { sections: Vec::new(), zones: Vec::new(), ..full() };
    let mut without_zones = Certification { zones: Vec::new(), ..full() };
    without_zones.sections.iter_mut().for_each(|section| section.zone = None);
    let mut without_values = full();
    for quantity in &mut without_values.quantities {
        quantity.values.clear();
        quantity.holds = None;
        for statistic in &mut quantity.statistics {
            (
                statistic.value,
                statistic.limit,
                statistic.normalised,
                statistic.interval,
                statistic.holds,
            ) = (None, None, None, None, None);
        }
    }
    let mut bare = full();
    bare.protocol.graph_svg.clear();
    bare.quantities.iter_mut().for_each(|quantity| quantity.statistics.clear());
    for found in [without_quantities, without_sections, without_zones, without_values, bare] {
        rendered(&found);
    }
}

#[test]
fn numbers_that_are_none_do_not_stop_it() {
    let mut found = certification::certification();
    for (at, pair) in
        found.quantities.iter_mut().flat_map(|quantity| &mut quantity.values).enumerate()
    {
        pair.difference = [f64::NAN, f64::INFINITY, -0.0, 1e300, 1e-300][at % 5];
        pair.simulated = None;
    }
    found.sections.iter_mut().for_each(|section| section.length = f64::NAN);
    let Some(text) = text(&rendered(&found)) else { return };
    assert!(!text.contains("NaN") && !text.contains("inf"));
}

#[test]
fn a_figure_that_is_none_is_refused_with_a_reason() {
    let found = Certification { verdict: Verdict::Validated, ..certification::certification() };
    let figures = [("overview".to_owned(), "no drawing".to_owned())];
    let problems = typeset(&document(&found), &figures, &[]).expect_err("this is no SVG");
    assert_eq!(problems.0.first().map(|problem| problem.code), Some("report-template"));
    let attachment = Attachment { name: "../results.json", ..attached() };
    let problems =
        typeset(&document(&found), &[], &[attachment]).expect_err("this is not a file name");
    assert_eq!(problems.0.first().map(|problem| problem.code), Some("report-attachment"));
}
