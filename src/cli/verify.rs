//! `fishplate verify` and `fishplate trace`.

use super::{kit::*, sources::imported_again};
use crate::check::family::Family;
use crate::deliver::{self, Reports};
use crate::provenance::{
    carried::{self, Carried},
    signature,
    trace::{Asked, trace},
    verify::{Again, Check, Outcome, against, alone, of_as_many},
};
use crate::report::visible::visible;
use crate::result::Certification;

#[derive(Debug, Args)]
pub struct Verify {
    /// A report of `certify`: report.pdf, its folder, or results.json.
    report: PathBuf,
    /// Folder of the campaign, or of each campaign of a pool: the files are compared with the
    /// report, and the protocol in the report is evaluated again.
    #[arg(value_name = "CAMPAIGN")]
    campaigns: Vec<PathBuf>,
    /// Public key for the signature: a file, or the key itself.
    #[arg(long, value_name = "KEY")]
    public_key: Option<String>,
    /// Signature of the report [default: the file next to it that ends in .minisig]
    #[arg(long, value_name = "FILE")]
    signature: Option<PathBuf>,
    /// The protocol, if the report does not contain it; its SHA-256 must be the one in the results.
    #[arg(long, short)]
    protocol: Option<String>,
    /// Only the report is to be checked: what needs the campaign, and was not checked, is no failure.
    #[arg(long)]
    report_only: bool,
    /// Folder of the mapping by which the campaign was imported: the records are imported again from
    /// their sources, and compared.
    #[arg(long, value_name = "DIR", requires = "campaigns")]
    sources: Option<PathBuf>,
    /// Print every difference, not only the first of each kind.
    #[arg(long)]
    all: bool,
    /// Number of distance plots of the report.
    #[arg(long, default_value_t = super::report::PLOTS)]
    plots: usize,
    /// Number of records processed in parallel [default: one per core]
    #[arg(long, short, value_parser = from_one)]
    jobs: Option<NonZeroUsize>,
}

/// Number of differences of one kind that are printed without `--all`.
const MOST: usize = 20;

impl Verify {
    pub fn run(self, console: &Console) -> Done {
        start_jobs(self.jobs)?;
        if let Some(folder) = self.campaigns.iter().find(|folder| !disk::may_exist(folder)) {
            let says = format!("there is no campaign `{}`", folder.display());
            return Err(Problem::error("folder-missing", says).into());
        }
        let (carried, given) = open(&self.report, self.protocol.as_deref())?;
        if !self.campaigns.is_empty() {
            of_as_many(&carried, &self.campaigns)?;
        }
        let key = self.public_key.as_deref().map(signature::public_key).transpose()?;
        let signed = carried
            .signed()
            .iter()
            .map(|path| signature::check(path, self.signature.as_deref(), key.as_ref()))
            .collect::<Result<Vec<_>, _>>()?;
        let (mut checks, compiled) = alone(&carried, given.as_ref());
        checks.extend(signed);
        if self.campaigns.is_empty() {
            checks.push(Check::not_checked(
                "pages, findings, names",
                "give the campaign to compare them with it",
            ));
        } else {
            let make = |found: &Certification, [pdf, html]: [bool; 2]| {
                deliver::certification(found, Reports { pdf, html })
            };
            let found = console.with_progress(carried.results.sections.len(), |progress| {
                let (campaigns, plots) = (&self.campaigns, self.plots);
                let again = Again { campaigns, plots, make: &make, progress };
                against(&carried, compiled.as_ref(), again)
            });
            checks.extend(found);
        }
        if let Some(sources) = &self.sources {
            for folder in &self.campaigns {
                checks.push(imported_again(folder, sources)?);
            }
        }
        let any = |outcome: Outcome| checks.iter().any(|check| check.outcome == outcome);
        let exit = match (any(Outcome::Differs), any(Outcome::NotPossible)) {
            (true, _) => Exit::DoesNotHold,
            (false, true) => Exit::Unfinished,
            (false, false) if any(Outcome::NotChecked) && !self.report_only => Exit::DoesNotHold,
            (false, false) => Exit::Done,
        };
        if !console.quiet || exit != Exit::Done {
            let most = if self.all { usize::MAX } else { MOST };
            console.print(&told(&carried, &checks, most, console))?;
        }
        Ok(exit)
    }
}

/// Opens a report, and the protocol given for it.
fn open(
    report: &std::path::Path,
    protocol: Option<&str>,
) -> Result<(Carried, Option<Family>), Problems> {
    let mut problems = Problems::default();
    let given = protocol.map(|name| load(name, &mut problems));
    if problems.any_error() {
        return Err(problems);
    }
    let carried = carried::open(report)?;
    Ok((carried, given.flatten()))
}

/// The result for the terminal. Control characters in names of a report are made visible.
fn told(carried: &Carried, checks: &[Check], most: usize, console: &Console) -> Lines {
    let results = &carried.results;
    let (protocol, word) = (&results.protocol, results.own_word.as_ref());
    let word = word.unwrap_or(&results.verdict_text);
    let mut out = Lines::default();
    out += &visible(&carried.shown);
    for line in [
        format!("  campaign   {}", results.campaign.name),
        format!("  protocol   {}, SHA-256 {}", protocol.name, protocol.sha256),
        format!("  verdict    {word}, by fishplate {}", results.fishplate),
    ] {
        out += &visible(&line);
    }
    out += "\n";
    for check in checks {
        let (word, good) = match check.outcome {
            Outcome::Agrees => ("agrees", Some(true)),
            Outcome::Differs => ("DIFFERS", Some(false)),
            Outcome::NotChecked | Outcome::NotAsked => ("not checked", None),
            Outcome::NotPossible => ("NOT POSSIBLE", Some(false)),
        };
        let word = console.paint(format!("{word:<13}"), good);
        out += &format!("{word}{:<15} {}\n", check.name, visible(&check.says));
        for detail in check.details.iter().take(most) {
            out += &format!("{:28} {}\n", "", visible(detail));
        }
        if check.details.len() > most {
            out +=
                &format!("{:28} and {} more, shown with `--all`\n", "", check.details.len() - most);
        }
    }
    let named = |outcome: Outcome| {
        let found: Vec<&str> = checks
            .iter()
            .filter(|check| check.outcome == outcome)
            .map(|check| check.name)
            .collect();
        found.join(", ")
    };
    let [differ, open, left] =
        [Outcome::Differs, Outcome::NotPossible, Outcome::NotChecked].map(named);
    let result = match (differ.as_str(), open.as_str(), left.as_str()) {
        ("", "", "") => "everything checked agrees".to_string(),
        ("", "", left) => format!("what was checked agrees; not checked: {left}"),
        ("", open, _) => format!("the check could not be completed ({open})"),
        (differ, ..) => format!("differs ({differ})"),
    };
    out += "\n";
    out += &format!("Result: {result}\n");
    out
}

#[derive(Debug, Args)]
pub struct Trace {
    /// A report of `certify`: report.pdf, its folder, or results.json.
    results: PathBuf,
    /// Id of the quantity.
    quantity: String,
    /// Name of the section.
    section: String,
    /// Name of the signal.
    signal: String,
    /// Which record, where the campaign has several: `simpack`, or `simpack, run1` where it has
    /// several of both.
    #[arg(long)]
    record: Option<String>,
    /// Folder of the campaign: rows and values are read and computed again. Repeated for each
    /// campaign of a pool.
    #[arg(long = "campaign", value_name = "DIR")]
    campaigns: Vec<PathBuf>,
    /// The protocol, if the report does not contain it; its SHA-256 must be the one in the results.
    #[arg(long, short)]
    protocol: Option<String>,
}

impl Trace {
    pub fn run(self, console: &Console) -> Done {
        start_jobs(None)?;
        let (carried, given) = open(&self.results, self.protocol.as_deref())?;
        if !self.campaigns.is_empty() {
            of_as_many(&carried, &self.campaigns)?;
        }
        let mut problems = Problems::default();
        let compiled = match carried.sources(given.as_ref()) {
            Ok(sources) => carried.compiled(&sources, &mut problems),
            // Without its protocol, the contents of a report can be shown, but not computed again.
            Err(problem) if !self.campaigns.is_empty() => return Err(problem.into()),
            Err(_) => None,
        };
        if problems.any_error() {
            return Err(problems.into());
        }
        let asked = Asked {
            quantity: &self.quantity,
            section: &self.section,
            signal: &self.signal,
            record: self.record.as_deref(),
        };
        let found = trace(&carried, compiled.as_ref(), asked, &self.campaigns)?;
        console.print(&found.text)?;
        Ok(if found.agrees { Exit::Done } else { Exit::DoesNotHold })
    }
}
