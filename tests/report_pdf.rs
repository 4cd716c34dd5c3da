//! The PDF report: it compiles, says what it should, and is the same every time.

#[path = "common/certification.rs"]
mod certification;

use fishplate::report::typst::{Attachment, Pdf, typeset};
use fishplate::report::view::view;
use fishplate::result::Certification;

const RESULTS: &[u8] = b"{\"verdict\": \"not validated\"}\n";

fn rendered(found: &Certification) -> Pdf {
    let attachment =
        Attachment { name: "results.json", mime: "application/json", bytes: RESULTS, description: "Results in full precision" };
    match typeset(&view(found), &certification::placeholders(found), &[attachment]) {
        Ok(pdf) => pdf,
        Err(problems) => panic!("{}", problems.render(false)),
    }
}

#[test]
fn a_full_report() {
    let pdf = rendered(&certification::certification());
    if let Ok(path) = std::env::var("REPORT_PDF") {
        std::fs::write(path, &pdf.bytes).expect("REPORT_PDF can be written");
    }
    assert!(pdf.warnings.0.is_empty(), "{}", pdf.warnings.render(false));
    assert!((30..=70).contains(&pdf.pages), "{} pages", pdf.pages);
}
