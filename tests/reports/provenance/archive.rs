//! The PDF as an archive asks for it: PDF/A-3a and PDF/UA-1. veraPDF says so where it is installed;
//! elsewhere poppler and qpdf, which are independent of the program that wrote it, look at what of
//! these standards they can show (ISO 19005-3, ISO 14289-1).

use std::process::Command;

use serde_json::Value;

use super::{text, written};

/// What a tool prints about the report; `None` where it is not installed.
fn told(tool: &str, arguments: &[&str]) -> Option<String> {
    let pdf = text(&written().pdf());
    let arguments: Vec<&str> =
        arguments.iter().map(|word| if *word == "PDF" { pdf.as_str() } else { word }).collect();
    match Command::new(tool).args(arguments).output() {
        Ok(output) => Some(
            String::from_utf8_lossy(&output.stdout).into_owned()
                + &String::from_utf8_lossy(&output.stderr),
        ),
        Err(_) => {
            crate::common::tools::skip(tool);
            None
        }
    }
}

#[test]
fn verapdf_finds_no_violation() {
    for flavour in ["3a", "ua1"] {
        let Some(said) = told("verapdf", &["--flavour", flavour, "--format", "text", "PDF"]) else {
            return;
        };
        assert!(said.starts_with("PASS"), "{flavour}: {said}");
    }
}

/// All objects of the PDF as qpdf reads them.
struct Objects(Value);

impl Objects {
    fn read() -> Option<Self> {
        let json = told("qpdf", &["--json=2", "--json-key=qpdf", "PDF", "-"])?;
        let value: Value = serde_json::from_str(&json)
            .unwrap_or_else(|error| panic!("{error}: {}", &json[..json.len().min(300)]));
        Some(Self(value["qpdf"][1].clone()))
    }

    /// What a reference leads to.
    fn get<'a>(&'a self, value: &'a Value) -> &'a Value {
        match value.as_str().filter(|text| text.ends_with(" R")) {
            Some(reference) => {
                let object = &self.0[format!("obj:{reference}")];
                object
                    .get("value")
                    .or(object.get("stream").and_then(|stream| stream.get("dict")))
                    .unwrap_or(&Value::Null)
            }
            None => value,
        }
    }

    fn catalogue(&self) -> &Value {
        self.get(&self.0["trailer"]["value"]["/Root"])
    }

    fn all(&self) -> impl Iterator<Item = &Value> {
        let objects = self.0.as_object().into_iter().flatten().map(|(_, object)| object);
        objects.filter_map(|object| {
            object.get("value").or(object.get("stream").and_then(|stream| stream.get("dict")))
        })
    }
}

/// ISO 19005-3: 6.1.3 no encryption; 6.2.3 output intent; 6.6.4 identification; 6.7.3 marked, 6.7.2
/// structure; 6.8 embedded files; 6.5.1 and 6.6.1 no actions, no scripts. ISO 14289-1: 7.1 title
/// shown, 7.2 language.
#[test]
fn qpdf_shows_the_parts_of_the_standards() {
    let Some(checked) = told("qpdf", &["--check", "PDF"]) else { return };
    assert!(
        checked.contains("No syntax or stream encoding errors found")
            && checked.contains("File is not encrypted"),
        "{checked}"
    );
    let Some(objects) = Objects::read() else { return };
    let trailer = &objects.0["trailer"]["value"];
    assert!(
        trailer.get("/Encrypt").is_none()
            && trailer["/ID"].as_array().is_some_and(|id| id.len() == 2),
        "{trailer}"
    );
    let root = objects.catalogue();
    let text_of = |value: &Value| {
        objects.get(value).as_str().unwrap_or_default().trim_start_matches("u:").to_string()
    };
    assert_eq!(text_of(&root["/Lang"]), "en");
    assert_eq!(objects.get(&root["/MarkInfo"])["/Marked"], true);
    assert_eq!(objects.get(&root["/ViewerPreferences"])["/DisplayDocTitle"], true);
    assert_eq!(objects.get(&root["/StructTreeRoot"])["/Type"], "/StructTreeRoot");
    assert!(
        objects.get(&objects.get(&root["/StructTreeRoot"])["/ParentTree"]).is_object(),
        "content leads to its structure"
    );
    let intents = objects.get(&root["/OutputIntents"]).as_array().expect("output intents");
    let intent = objects.get(&intents[0]);
    assert_eq!(intent["/S"], "/GTS_PDFA1");
    assert!(
        objects.get(&intent["/DestOutputProfile"]).get("/N").is_some(),
        "a profile is embedded"
    );
    for forbidden in ["/OpenAction", "/AA", "/AcroForm"] {
        assert!(root.get(forbidden).is_none(), "{forbidden}");
    }
    let mut seen = std::collections::BTreeMap::new();
    for object in objects.all() {
        for action in ["/JavaScript", "/Launch", "/Sound", "/Movie", "/ResetForm", "/ImportData"] {
            assert!(object["/S"] != action, "{action}");
        }
        for kind in ["/Filespec", "/Font", "/FontDescriptor", "/Annot"] {
            if object["/Type"] == kind {
                *seen.entry(kind).or_insert(0) += 1;
            }
        }
        match object["/Type"].as_str() {
            // 6.2.11.4: every font program is embedded.
            Some("/FontDescriptor") => {
                assert!(
                    ["/FontFile", "/FontFile2", "/FontFile3"]
                        .iter()
                        .any(|key| object.get(*key).is_some()),
                    "{object}"
                );
            }
            // 6.2.11.7, level A: every font maps to Unicode.
            Some("/Font") if object["/Subtype"] == "/Type0" => {
                assert!(object.get("/ToUnicode").is_some(), "{object}")
            }
            // 6.3.2: annotations are printed, and not hidden.
            Some("/Annot") => assert_eq!(
                object["/F"].as_u64().map(|flags| flags & 0b10_0110),
                Some(0b100),
                "{object}"
            ),
            _ => {}
        }
    }
    assert!(seen["/Font"] > 0 && seen["/FontDescriptor"] > 0 && seen["/Filespec"] == 5, "{seen:?}");
    // 6.8: each embedded file has a name in both forms, a kind, a relationship, and is listed as
    // associated.
    let associated = objects.get(&root["/AF"]).as_array().expect("associated files");
    assert_eq!(associated.len(), 5, "results.json and four files of the protocol");
    for file in associated {
        let file = objects.get(file);
        assert!(
            file["/F"].is_string() && file["/UF"].is_string() && file["/Desc"].is_string(),
            "{file}"
        );
        assert_eq!(file["/AFRelationship"], "/Data");
        let data = objects.get(&objects.get(&file["/EF"])["/F"]);
        assert_eq!(data["/Type"], "/EmbeddedFile");
        assert!(data["/Subtype"].as_str().is_some_and(|kind| kind.contains('/')), "{data}");
        assert!(objects.get(&data["/Params"]).get("/ModDate").is_some(), "{data}");
    }
}

#[test]
fn poppler_shows_the_parts_of_the_standards() {
    let Some(info) = told("pdfinfo", &["PDF"]) else { return };
    let value = |key: &str| {
        info.lines().find_map(|line| line.strip_prefix(key)).unwrap_or_default().trim().to_string()
    };
    assert!(value("Title:").starts_with("Validation report"), "{info}");
    assert_eq!(
        (value("Tagged:"), value("Encrypted:"), value("JavaScript:")),
        ("yes".into(), "no".into(), "no".into()),
        "{info}"
    );
    let Some(fonts) = told("pdffonts", &["PDF"]) else { return };
    let mut count = 0;
    for font in fonts.lines().skip_while(|line| !line.starts_with("---")).skip(1) {
        let columns: Vec<&str> = font.split_whitespace().rev().take(5).collect();
        // From the end: generation, object, unicode, subset, embedded.
        assert_eq!(&columns[2..5], ["yes", "yes", "yes"], "{font}");
        count += 1;
    }
    assert!(count >= 3, "{fonts}");
    let Some(metadata) = told("pdfinfo", &["-meta", "PDF"]) else { return };
    for (name, value) in [("pdfaid:part", "3"), ("pdfaid:conformance", "A"), ("pdfuaid:part", "1")]
    {
        assert!(
            metadata.contains(&format!("<{name}>{value}</{name}>"))
                || metadata.contains(&format!("{name}=\"{value}\"")),
            "{metadata}"
        );
    }
    assert!(metadata.contains("dc:title") && metadata.contains("dc:language"), "{metadata}");
    let Some(structure) = told("pdfinfo", &["-struct", "PDF"]) else { return };
    for element in ["Document", "H1", "Table", "TH", "TD", "Figure", "TOC"] {
        assert!(
            structure
                .lines()
                .any(|line| line.trim_start().split([' ', '(', ':']).next() == Some(element)),
            "no {element}"
        );
    }
    let Some(files) = told("pdfdetach", &["-list", "PDF"]) else { return };
    assert!(
        files.contains("5 embedded files")
            && files.contains("results.json")
            && files.contains("protocol-2-p.fp"),
        "{files}"
    );
}

/// Rewritten by qpdf with streams of cross-references and groups of objects: what is attached is
/// still found.
#[test]
fn a_rewritten_report_still_carries_its_results() {
    let folder = tempfile::tempdir().expect("a folder");
    let packed = folder.path().join("packed.pdf");
    for options in
        [&["--object-streams=generate"][..], &["--object-streams=disable", "--linearize"]]
    {
        let mut arguments = options.to_vec();
        let to = text(&packed);
        arguments.extend(["PDF", to.as_str()]);
        if told("qpdf", &arguments).is_none() {
            return;
        }
        let ran = super::fishplate(&["verify", &to, "--report-only"]);
        // A linearized file has two ends, so that it is not known what was added to it.
        let linearized = options.len() == 2;
        assert_eq!(ran.code, i32::from(linearized), "{options:?}: {}{}", ran.stdout, ran.stderr);
        let end = super::check(&ran, "end of the PDF");
        assert_eq!(end.starts_with("DIFFERS"), linearized, "{end}");
        assert!(super::check(&ran, "statistics").starts_with("agrees"), "{}", ran.stdout);
    }
    // Encrypted.
    if told("qpdf", &["--encrypt", "", "owner", "256", "--", "PDF", &text(&packed)]).is_some() {
        let ran = super::fishplate(&["verify", &text(&packed)]);
        assert!(
            ran.code == 2 && ran.stderr.contains("is encrypted"),
            "{}{}",
            ran.stdout,
            ran.stderr
        );
    }
}
