//! `impact`: what the change of a protocol would have decided over an archive of campaigns.

use super::{kit::*, reduce::opened, study::told};
use crate::deliver::{self, Reports};
use crate::impact::{Archive, Prepared};
use crate::prepare::set_by_hand;
use crate::report::impact as report;
use crate::result::impact::{self, Flip};
use crate::values::{self, File, Joined};

#[derive(Debug, Args)]
pub struct Impact {
    /// The protocol before the change: its path, or the name of a shipped one.
    old: String,
    /// The protocol after the change.
    new: String,
    /// Folders of campaigns, and files of values that `reduce` wrote; each campaign is judged by
    /// itself. No record is read of a campaign of which there are values.
    #[arg(long, required = true, num_args = 1.., value_name = "CAMPAIGN|VALUES")]
    over: Vec<PathBuf>,
    /// Output folder; created if missing.
    #[arg(long, short)]
    out: PathBuf,
    /// Set a parameter of both protocols, for campaigns with records. Values have their own.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// Write impact.json and the tables only, without the report.
    #[arg(long)]
    no_report: bool,
    /// Number of campaigns processed in parallel [default: one per core]
    #[arg(long, short, value_parser = from_one)]
    jobs: Option<NonZeroUsize>,
}

impl Impact {
    pub fn run(self, console: &Console) -> Done {
        start_jobs(self.jobs)?;
        let prepared = console.read(|problems| self.prepared(problems))?;
        let found =
            console.with_progress(prepared.steps(), |progress| prepared.impact(progress))?;
        self.write(&found, console)
    }

    fn prepared(&self, problems: &mut Problems) -> Option<Prepared> {
        let set = set_by_hand(&self.set, problems);
        let families = [&self.old, &self.new].map(|name| load(name, problems));
        let (files, folders): (Vec<PathBuf>, Vec<PathBuf>) =
            self.over.iter().cloned().partition(|path| matches!(disk::is_folder(path), Ok(false)));
        check_report(&self.out, &files, problems);
        let values = opened(&files, problems);
        let campaigns = opened_all(&folders, problems)?;
        check_outputs(&self.out, REPORT, &campaigns, problems);
        let archive = Archive { campaigns, values: by_campaign(values?, problems)?, set: set? };
        let [old, new] = families;
        let names = [self.old.clone(), self.new.clone()];
        Prepared::new((names, [old?, new?]), archive, problems)
    }

    /// Writes all files or none.
    fn write(&self, found: &impact::Impact, console: &Console) -> Done {
        let reports = if self.no_report { Reports::NONE } else { Reports::ALL };
        let files = deliver::impact(found, reports);
        let line = |flip: &Flip| {
            let sets: Vec<String> = flip.minimal.iter().map(|set| set.join(" + ")).collect();
            format!(
                "  {}: {} -> {} ({})\n",
                flip.campaign,
                flip.before,
                flip.after,
                sets.join("; or ")
            )
        };
        let flips = found.flips.iter().map(line);
        let told = told(report::TITLE, &report::opening(found), flips);
        console.report(files, &told, &self.out)
    }
}

/// The files of each campaign together.
fn by_campaign(files: Vec<File>, problems: &mut Problems) -> Option<Vec<Joined>> {
    let mut all: Vec<(Vec<String>, Vec<File>)> = Vec::new();
    for file in files {
        let names: Vec<String> = file.head.about.names().map(String::from).collect();
        match all.iter_mut().find(|(known, _)| *known == names) {
            Some((_, files)) => files.push(file),
            None => all.push((names, vec![file])),
        }
    }
    all.into_iter().map(|(_, files)| values::join(files, problems)).collect()
}
