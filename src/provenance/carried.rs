//! Reads a report: its results, and the attached protocol.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use serde::Deserialize;
use serde_json::Value;

use super::{before, pdf::Attachments, signature, statement};
use crate::certify::{Compiled, Setting, again, confirmations};
use crate::check::family::Family;
use crate::data::{
    hash::sha256,
    text::{decode, read_bytes},
};
use crate::disk;
use crate::library;
use crate::problem::{Problem, Problems};
use crate::report::attached;
use crate::result::{Certification, ProtocolFile};
use crate::source::Source;

/// Maximum size of a report in bytes; a report with 13 sections has two million.
pub const REPORT: u64 = 512 << 20;
/// Maximum size of the results in bytes; those of 13 sections have 180 000.
const RESULTS: usize = 128 << 20;
/// Maximum number of values in results. Those of 13 sections have 7000. A value takes up to 100
/// bytes of memory, as itself and as what is read from it.
const VALUES: usize = 2_000_000;
/// A map takes as much memory as so many values: it has tables of its own.
const OF_A_MAP: usize = 8;
/// Maximum size of a file of a protocol in bytes.
const PROTOCOL: usize = 16 << 20;

/// The numbers of other reports, and the commands that write them.
const BY: [(&str, &str); 3] =
    [("comparison.json", "compare"), ("diagnosis.json", "diagnose"), ("study.json", "study")];

/// File name of the report in an output folder.
pub const REPORT_PDF: &str = "report.pdf";
/// File name of the same as HTML.
pub const REPORT_HTML: &str = "report.html";

#[derive(Debug)]
pub struct Carried {
    /// Name as given by the user.
    pub shown: String,
    /// The file that was opened, to which a signature refers.
    pub path: PathBuf,
    /// The output folder, if given.
    pub folder: Option<PathBuf>,
    /// The bytes of the PDF, if there is one.
    pub pdf: Option<Vec<u8>>,
    /// The text of the results.
    pub text: String,
    pub value: Value,
    pub results: Certification,
    /// Whether results.json in the folder differs from that attached to the PDF.
    pub other_results: bool,
    /// The files of the protocol that are attached to the PDF, in the order of the results.
    pub protocol: Vec<Option<Vec<u8>>>,
}

/// Opens a report: a PDF, an output folder, or `results.json`.
///
/// # Errors
/// `file-missing` and its kin, `pdf-unreadable`, `no-results`, `results-unreadable`.
pub fn open(path: &Path) -> Result<Carried, Problem> {
    let shown = path.display().to_string();
    if disk::is_folder(path).unwrap_or(false) {
        let pdf = path.join(REPORT_PDF);
        let results = path.join(attached::RESULTS);
        if !disk::may_be_file(&pdf) && !disk::may_be_file(&results) {
            let says =
                format!("there is neither `{REPORT_PDF}` nor `{}` in `{shown}`", attached::RESULTS);
            let by = BY.iter().find(|(file, _)| disk::may_be_file(&path.join(file)));
            let by = by.map_or_else(String::new, |(_, command)| {
                format!("it was written by `{command}`; ")
            });
            return Err(Problem::error("no-results", says).help(format!(
                "{by}give the output folder of `certify`, a report, or results.json"
            )));
        }
        if !disk::may_be_file(&pdf) {
            return beside(&results, &shown, Some(path));
        }
        let mut carried = of_pdf(&pdf, &pdf.display().to_string())?;
        carried.folder = Some(path.to_path_buf());
        carried.other_results = disk::may_be_file(&results)
            && file(&results, RESULTS as u64)? != carried.text.as_bytes();
        return Ok(carried);
    }
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) {
        return beside(path, &shown, None);
    }
    of_pdf(path, &shown)
}

fn file(path: &Path, most: u64) -> Result<Vec<u8>, Problem> {
    read_bytes(path, &path.display().to_string(), most)
}

/// Opens results.json. A report in the same folder with the same results provides the protocol.
fn beside(path: &Path, shown: &str, folder: Option<&Path>) -> Result<Carried, Problem> {
    let bytes = file(path, RESULTS as u64)?;
    let (text, value, results) = read(&bytes, shown)?;
    let pdf = path.parent().unwrap_or(Path::new("")).join(REPORT_PDF);
    let carried = if disk::may_be_file(&pdf) {
        of_pdf(&pdf, shown).ok().filter(|carried| carried.text == text)
    } else {
        None
    };
    let protocol = carried.map_or_else(
        || results.protocol.files.iter().map(|_| None).collect(),
        |carried| carried.protocol,
    );
    Ok(Carried {
        shown: shown.into(),
        path: path.to_path_buf(),
        folder: folder.map(Path::to_path_buf),
        pdf: None,
        text,
        value,
        results,
        other_results: false,
        protocol,
    })
}

fn of_pdf(path: &Path, shown: &str) -> Result<Carried, Problem> {
    let pdf = file(path, REPORT)?;
    let attachments = Attachments::of(&pdf, shown)?;
    let Some(bytes) = attachments.read(attached::RESULTS, RESULTS)? else {
        let names: Vec<&str> = attachments.names().collect();
        let problem = Problem::error(
            "no-results",
            format!("`{shown}` has no attachment `{}`", attached::RESULTS),
        );
        return Err(match names.as_slice() {
            [] => problem.help("only a report written by `certify` can be checked; printing or saving it again may remove its attachments"),
            names => {
                let by = BY.iter().find(|(file, _)| names.contains(file)).map(|(_, command)| format!("it was written by `{command}`; "));
                let by = by.unwrap_or_default();
                problem.help(format!("{by}its attachments are {}; only reports of `certify` can be checked", names.join(", ")))
            }
        });
    };
    let (text, value, results) = read(&bytes, &format!("{shown}: {}", attached::RESULTS))?;
    let mut protocol = Vec::new();
    for (at, named) in results.protocol.files.iter().enumerate() {
        protocol.push(attachments.read(&ProtocolFile::attachment(at, &named.name), PROTOCOL)?);
    }
    Ok(Carried {
        shown: shown.into(),
        path: path.to_path_buf(),
        folder: None,
        text,
        value,
        results,
        other_results: false,
        protocol,
        pdf: Some(pdf),
    })
}

fn read(bytes: &[u8], shown: &str) -> Result<(String, Value, Certification), Problem> {
    let unreadable = |says: String| {
        Problem::error(
            "results-unreadable",
            format!("`{shown}` is not a results file of `certify`: {says}"),
        )
    };
    let text = decode(bytes, shown)?;
    let maps = memchr::memchr_iter(b'{', bytes).count();
    let many = memchr::memchr2_iter(b',', b'[', bytes).count();
    if maps.saturating_mul(OF_A_MAP).saturating_add(many) > VALUES {
        let says = format!("more than {VALUES} values, where a map counts as {OF_A_MAP}");
        return Err(unreadable(says));
    }
    let mut value: Value =
        serde_json::from_str(text).map_err(|error| unreadable(error.to_string()))?;
    if value.get("fishplate").is_none() {
        return Err(unreadable("missing field `fishplate`".into()));
    }
    let mut current = value.clone();
    before::without_replaced(&mut current);
    if before::states_no_format(&value) {
        before::upgrade(&mut current);
        before::sort_findings(&mut value);
    }
    let results =
        Certification::deserialize(current).map_err(|error| unreadable(error.to_string()))?;
    Ok((text.to_string(), value, results))
}

impl Carried {
    /// The files of the protocol as text: those attached to the report; else those with the hash in
    /// the results that are shipped with the program or given.
    ///
    /// # Errors
    /// `protocol-missing`, `encoding`.
    pub fn sources(&self, given: Option<&Family>) -> Result<Vec<Arc<Source>>, Problem> {
        let mut sources = Vec::new();
        for (at, named) in self.results.protocol.files.iter().enumerate() {
            // The number distinguishes files of the same name.
            let name = format!("{}/{}", at + 1, named.name);
            let text = match self.protocol.get(at).and_then(Option::as_ref) {
                Some(bytes) => decode(bytes, &named.name)?.to_string(),
                None => self.known(at, given)?,
            };
            sources.push(Source::new(name, text));
        }
        if sources.is_empty() {
            return Err(Problem::error(
                "protocol-missing",
                format!("`{}` lists no file of its protocol", self.shown),
            ));
        }
        Ok(sources)
    }

    fn known(&self, at: usize, given: Option<&Family>) -> Result<String, Problem> {
        let named = &self.results.protocol.files[at];
        let shipped = library::texts().map(|shipped| shipped.text);
        let given =
            given.into_iter().flat_map(|family| &family.sources).map(|source| source.text.as_str());
        let found = given.chain(shipped).find(|text| sha256(text.as_bytes()) == named.sha256);
        found.map(str::to_string).ok_or_else(|| {
            let says = format!(
                "the protocol file `{}` with SHA-256 {} is not available",
                named.name, named.sha256
            );
            Problem::error("protocol-missing", says)
                .help("give report.pdf, which contains it, or name the protocol with `--protocol`")
        })
    }

    /// Results of now, in the form of those that are carried.
    pub fn comparable(&self, now: &Certification) -> Value {
        // Serialisation of plain values cannot fail.
        let mut now = serde_json::to_value(now).unwrap_or_default();
        if before::states_no_format(&self.value) {
            before::downgrade(&mut now);
        }
        before::without_later(&mut now, &self.value);
        now
    }

    /// The files whose signatures are checked: of a folder its statement, which names all others.
    pub fn signed(&self) -> Vec<PathBuf> {
        let Some(folder) = &self.folder else { return vec![self.path.clone()] };
        let pdf = folder.join(REPORT_PDF);
        let signature = disk::may_be_file(&signature::beside(&pdf));
        std::iter::once(folder.join(statement::FILE)).chain(signature.then_some(pdf)).collect()
    }

    /// Compiles the protocol with the parameters in the results.
    pub fn compiled(&self, sources: &[Arc<Source>], problems: &mut Problems) -> Option<Compiled> {
        let settings: Vec<Setting> =
            self.results.protocol.parameters.iter().cloned().map(Setting::of).collect();
        let protocol = &self.results.protocol;
        let confirmed = confirmations(&self.results.confirmed, &protocol.edition);
        again(sources, (&settings, &confirmed), problems)
    }
}
