//! `reduce`: evaluates a part of the sections of a campaign to a file of values; `judge`: the
//! report from such files.

use super::{kit::*, report::Report};
use crate::run::{SectionValues, Shard};
use crate::values::{self, Joined, ReduceJob, Values};

#[derive(Debug, Args)]
pub struct Reduce {
    /// Folder of the campaign; several are evaluated as one.
    #[arg(required = true, value_name = "CAMPAIGN")]
    campaigns: Vec<PathBuf>,
    /// Path of a protocol, or name of a shipped one [default: the one in campaign.yaml, else
    /// en14363-2016-annex-t]
    #[arg(long, short)]
    protocol: Option<String>,
    /// File of values, such as values.parquet.
    #[arg(long, short)]
    out: PathBuf,
    /// Part of the sections, as `NUMBER/ALL`, counted from 0 [default: all sections]
    #[arg(long, value_name = "NUMBER/ALL", value_parser = Shard::parse)]
    shard: Option<Shard>,
    /// Set a parameter of the protocol.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// Keep no signals for the plots of the report. The records of the worst sections are then not
    /// read again.
    #[arg(long)]
    no_plots: bool,
    /// Number of records processed in parallel [default: one per core]
    #[arg(long, short, value_parser = from_one)]
    jobs: Option<NonZeroUsize>,
}

impl Reduce {
    pub fn run(self, console: &Console) -> Done {
        start_jobs(self.jobs)?;
        let mut problems = Problems::default();
        let opened =
            prepare_all(&self.campaigns, self.protocol.as_deref(), &self.set, &mut problems);
        let name = self.out.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        let folder = self
            .out
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty())
            .unwrap_or(Path::new("."));
        for campaign in opened.iter().flat_map(|opened| &opened.campaigns) {
            let checked =
                check_file(&self.out, &[]).and_then(|()| check_folder(folder, &[name], campaign));
            problems.add(checked.err());
        }
        if !problems.any_error()
            && self.out.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("parquet"))
        {
            let says = format!(
                "`{}` will be a Parquet table, whatever its name ends in",
                self.out.display()
            );
            problems.push(Problem::warning("values-name", says).help("name it `values.parquet`"));
        }
        let opened = console.sound(opened, &problems)?;
        let part = ReduceJob { shard: self.shard.unwrap_or(Shard::WHOLE), plots: !self.no_plots };
        let steps = part.shard.range(opened.campaigns().sections()).len();
        let values =
            console.with_progress(steps, |progress| values::reduce(&opened, part, progress))?;
        let bytes = values::write(&opened.compiled.plan, &values).map_err(Ended::unfinished)?;
        console.write(&self.out, &bytes)?;
        console.written(&told(&values), &self.out)?;
        Ok(Exit::Done)
    }
}

/// How many values of how many sections there are, and the sections that cannot be evaluated.
fn told(values: &Values) -> Lines {
    let rows: usize =
        values.sections.iter().flat_map(|(_, values)| &values.rows).map(Vec::len).sum();
    let units = values.head.basis.units();
    let fault = |(number, of_section): &(usize, SectionValues)| {
        let unit = units.get(*number)?;
        let fault = unit.fault.as_ref().or(of_section.fault.as_ref())?;
        Some(format!("  {} not used: {}\n", unit.name, fault.text()))
    };
    let faults: Vec<String> = values.sections.iter().filter_map(fault).collect();
    let used = values.sections.len() - faults.len();
    let first = format!("{rows} values of {used} of {} sections", units.len());
    std::iter::once(first).chain(faults).collect()
}

#[derive(Debug, Args)]
pub struct Judge {
    /// Files of values of all parts of a campaign, in any order.
    #[arg(required = true, value_name = "VALUES")]
    values: Vec<PathBuf>,
    #[command(flatten)]
    report: Report,
}

impl Judge {
    pub fn run(self, console: &Console) -> Done {
        start_jobs(None)?;
        let joined = console.read(|problems| {
            check_report(&self.report.out, &self.values, problems);
            joined(&self.values, problems)
        })?;
        let key = self.report.key()?;
        let found = joined.certification(self.report.settings())?;
        self.report.write(found, key.as_ref(), console)
    }
}

/// Opens files of values and puts them together.
pub fn joined(paths: &[PathBuf], problems: &mut Problems) -> Option<Joined> {
    let files = opened(paths, problems)?;
    values::join(files, problems)
}

/// Opens files of values.
pub fn opened(paths: &[PathBuf], problems: &mut Problems) -> Option<Vec<values::File>> {
    let in_folder = |path: &PathBuf, problem: Problem| match disk::is_folder(path) {
        Ok(true) => {
            problem.help(format!("name the files in it: `{}`", path.join("*.parquet").display()))
        }
        _ => problem,
    };
    let opened =
        paths.iter().map(|path| values::open(path).map_err(|problem| in_folder(path, problem)));
    let files = opened.filter_map(|file| problems.value(file)).collect();
    (!problems.any_error()).then_some(files)
}
