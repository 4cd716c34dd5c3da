//! `compare`: protocols side by side over campaigns.

use super::{kit::*, study::told, values::numbers};
use crate::compare::{Prepared, SIZES, Settings};
use crate::deliver::{self, Reports};
use crate::prepare::set_by_hand;
use crate::report::comparison as report;
use crate::result::comparison::{Cell, Comparison};

#[derive(Debug, Args)]
pub struct Compare {
    /// Folders of the campaigns; each is evaluated by itself.
    #[arg(required = true, value_name = "CAMPAIGN")]
    campaigns: Vec<PathBuf>,
    /// Path of a protocol, or name of a shipped one; repeated for each. With two related ones, each
    /// changed rule is applied alone too.
    #[arg(long, short, required = true)]
    protocol: Vec<String>,
    /// Output folder; created if missing.
    #[arg(long, short)]
    out: PathBuf,
    /// Set a parameter of every protocol that has it.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// Sizes of the disturbances, in standard deviations of the measured signal; `none` for no
    /// sensitivities [default: 0.1,0.2,0.4]
    #[arg(long, value_name = "SIZES")]
    sizes: Option<String>,
    /// Write comparison.json and the tables only, without the report.
    #[arg(long)]
    no_report: bool,
    /// Number of records processed in parallel [default: one per core]
    #[arg(long, short, value_parser = from_one)]
    jobs: Option<NonZeroUsize>,
}

impl Compare {
    pub fn run(self, console: &Console) -> Done {
        start_jobs(self.jobs)?;
        let prepared = console.read(|problems| self.prepared(problems))?;
        let found = console.with_progress(prepared.steps(), |progress| prepared.compare(progress));
        self.write(&found, console)
    }

    fn prepared(&self, problems: &mut Problems) -> Option<Prepared> {
        let sizes = self.sizes(problems);
        let set = set_by_hand(&self.set, problems);
        let campaigns = opened_all(&self.campaigns, problems);
        let families = all(self.protocol.iter().map(|name| load(name, problems)));
        let (campaigns, families) = (campaigns?, families?);
        check_outputs(&self.out, REPORT, &campaigns, problems);
        Prepared::new(families, campaigns, Settings { sizes: sizes?, set: set? }, problems)
    }

    fn sizes(&self, problems: &mut Problems) -> Option<Vec<f64>> {
        let Some(text) = self.sizes.as_deref() else { return Some(SIZES.to_vec()) };
        if text == "none" {
            return Some(Vec::new());
        }
        let wrong = |says: String| {
            Problem::error("sizes", format!("`--sizes {text}`: {says}"))
                .help("for example `--sizes 0.1,0.2,0.4`")
        };
        let sizes = numbers(text).and_then(|sizes| {
            match sizes.iter().all(|size| *size > 0.0 && *size <= 1.0) {
                true => Ok(sizes),
                false => Err("each size must be above 0 and at most 1".into()),
            }
        });
        sizes.map_err(|says| problems.push(wrong(says))).ok()
    }

    /// Writes all files or none.
    fn write(&self, found: &Comparison, console: &Console) -> Done {
        let reports = if self.no_report { Reports::NONE } else { Reports::ALL };
        let files = deliver::comparison(found, reports);
        let cell = |cell: &Cell| {
            let reason = || Some(cell.reasons.first()?.text().to_string());
            let why = cell.decided_by.clone().or_else(reason).unwrap_or_default();
            format!("  {}, {}: {} ({why})\n", cell.campaign, cell.protocol, cell.verdict)
        };
        let cells = found.verdicts.iter().map(cell);
        let told = told(report::TITLE, &report::opening(found), cells);
        console.report(files, &told, &self.out)
    }
}
