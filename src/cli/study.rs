//! `study`: dependence of the verdict on sections, synchronisation and parameters, and how far it
//! is from another one.

use clap::Subcommand;

use super::{
    kit::*,
    reduce::joined,
    values::{numbers, values},
};
use crate::deliver::{self, Reports};
use crate::report::{document::Fact, study as report, view::Opening};
use crate::result::study as found;
use crate::robustness::{self, Asked, Margins, Settings, Synchronisation, Vary};
use crate::study;
use crate::values::Joined;

#[derive(Debug, Subcommand)]
pub enum Study {
    /// Evaluate all selections of sections: the share validated, the scatter, and the influence of
    /// each section.
    #[command(
        after_help = "Example:\n  fishplate study sections examples/coach --out target/coach-sections"
    )]
    Sections {
        #[command(flatten)]
        common: Common,
    },
    /// Shift the measurement against the simulation by given offsets, and evaluate each.
    #[command(
        after_help = "Example:\n  fishplate study sync examples/coach --offsets=-5,-1,1,5 --out target/coach-sync"
    )]
    Sync {
        #[command(flatten)]
        common: Common,
        /// Offsets in the unit of the axis: a list, or `FROM..TO step STEP`; 0 is always included.
        #[arg(long, default_value = "-40,-20,-10,-5,-1,1,5,10,20,40", allow_hyphen_values = true)]
        offsets: String,
        /// Correct the offset estimated from each section's signals before the study.
        #[arg(long)]
        correct: bool,
        /// Largest offset searched in the signals, in the unit of the axis.
        #[arg(long, default_value_t = 25.0)]
        farthest: f64,
    },
    /// Vary each parameter of the protocol by itself, to find the ones that decide the verdict.
    #[command(
        after_help = "Examples:\n  fishplate study parameters examples/coach --vary \"lowpass_frequency=15..25 step 5 Hz\" --out target/coach-choices\n  fishplate study parameters examples/coach --vary \"zone 4 minimum length=50 m, 70 m, 100 m\" --out target/coach-lengths"
    )]
    Parameters {
        #[command(flatten)]
        common: Common,
        /// Parameter or rule, and its values. A rule is addressed by its words (`quantity NAME
        /// limit std`, `zone 4 minimum length`), all limits of a statistic by `every limit std`,
        /// with factors as values. Values are a list, separated by `;` if they contain commas, or
        /// `FROM..TO step STEP`; may be repeated [default: all parameters with a choice of words,
        /// over all words]
        #[arg(long, value_name = "NAME=VALUES")]
        vary: Vec<String>,
    },
    /// Find the smallest changes that flip the verdict: of gain, offset and place of the
    /// measurement, of parameters, sections and limits; with declared uncertainties, the
    /// probability that the verdict is the right one.
    #[command(
        after_help = "Example:\n  fishplate study margin examples/coach-good --out target/coach-margin"
    )]
    Margin {
        #[command(flatten)]
        common: Common,
        /// Number of draws from the uncertainties that campaign.yaml declares; 0 for none.
        #[arg(long, default_value_t = robustness::DRAWS)]
        draws: usize,
    },
}

#[derive(Debug, Args)]
pub struct Common {
    /// Folder of the campaign; several are evaluated as one. `study sections` also takes files of
    /// values, of all parts.
    #[arg(required = true, value_name = "CAMPAIGN")]
    campaigns: Vec<PathBuf>,
    /// Path of a protocol, or name of a shipped one [default: the one in campaign.yaml, else
    /// en14363-2016-annex-t]
    #[arg(long, short)]
    protocol: Option<String>,
    /// Output folder; created if missing.
    #[arg(long, short)]
    out: PathBuf,
    /// Set a parameter of the protocol.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// Number of sections per zone in a selection [default: the number required by the protocol]
    #[arg(long, value_parser = from_one)]
    take: Option<NonZeroUsize>,
    /// Keep at most this number of sections per zone before selecting, so that the highest standard
    /// deviation is kept.
    #[arg(long, value_name = "SECTIONS", value_parser = from_one)]
    reduce: Option<NonZeroUsize>,
    /// Number of selections up to which all are evaluated; beyond it, random ones are drawn.
    #[arg(long, value_name = "SELECTIONS", default_value_t = study::MOST)]
    enumerate: f64,
    /// Width of the 95 % interval of the share at which drawing stops.
    #[arg(long, default_value_t = 0.01)]
    width: f64,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Number of records processed in parallel [default: one per core]
    #[arg(long, short, value_parser = from_one)]
    jobs: Option<NonZeroUsize>,
}

impl Study {
    pub fn run(self, console: &Console) -> Done {
        let common = match &self {
            Self::Sections { common }
            | Self::Sync { common, .. }
            | Self::Parameters { common, .. }
            | Self::Margin { common, .. } => common,
        };
        start_jobs(common.jobs)?;
        let mut problems = common.wrong();
        if common
            .campaigns
            .iter()
            .all(|path| path.extension().is_some_and(|ending| ending == "parquet"))
        {
            return self.of_values(common, problems, console);
        }
        let asked = self.asked(&mut problems);
        let opened =
            prepare_all(&common.campaigns, common.protocol.as_deref(), &common.set, &mut problems);
        let campaigns = opened.as_ref().map_or(&[][..], |opened| &opened.campaigns);
        check_outputs(&common.out, REPORT, campaigns, &mut problems);
        let (asked, opened) = console.sound(asked.zip(opened), &problems)?;
        let steps = asked.ready(&opened)?;
        let study = console
            .with_progress(steps, |progress| asked.run(&opened, &common.settings(), progress))?;
        write(common, &study, console)
    }

    /// The study of sections that `reduce` evaluated.
    fn of_values(&self, common: &Common, mut problems: Problems, console: &Console) -> Done {
        if !matches!(self, Self::Sections { .. }) {
            let says = "this study evaluates records again, and files of values contain none";
            let problem = Problem::error("values-unsuitable", says);
            problems.push(problem.help("give the campaign, or use `study sections`"));
        }
        if common.protocol.is_some() || !common.set.is_empty() {
            let says = "values are of a protocol and its parameters already: `--protocol` and `--set` have no effect on them";
            let problem = Problem::error("values-unsuitable", says);
            problems.push(problem.help("give them to `fishplate reduce`"));
        }
        let joined =
            if problems.any_error() { None } else { joined(&common.campaigns, &mut problems) };
        // A row names its record where there are several of a side.
        let several = |joined: &Joined| {
            let mut rows =
                joined.sections().iter().flat_map(|(_, values)| values.rows.iter().flatten());
            rows.any(|row| row.record.is_some())
        };
        if joined.as_ref().is_some_and(several) {
            let says = "a selection takes one value of each section and signal, and the values are of several records";
            problems.push(Problem::error("several-records", says));
        }
        let joined = console.sound(joined, &problems)?;
        robustness::countable(&joined.compiled)?;
        let evaluated = joined.evaluated()?;
        if let Some(missing) = &evaluated.missing {
            let problem = Problem::error("values-missing", missing.text());
            return Err(problem.help("give the files of all parts").into());
        }
        let campaign = joined.head.about.info(evaluated.files.clone());
        let settings = common.settings();
        let study = robustness::sections_of(&joined.compiled, &evaluated, campaign, &settings)?;
        write(common, &study, console)
    }

    /// The study that the arguments describe.
    fn asked(&self, problems: &mut Problems) -> Option<Asked> {
        match self {
            Self::Sections { .. } => Some(Asked::Sections),
            Self::Margin { draws, .. } => Some(Asked::Margin(Margins { draws: *draws })),
            Self::Sync { offsets, correct, farthest, .. } => {
                let (farthest, correct) = (*farthest, *correct);
                if !(farthest > 0.0 && farthest.is_finite()) {
                    let says = format!("`--farthest {farthest}` must be above zero");
                    problems.push(Problem::error("farthest", says));
                    return None;
                }
                let help = "offsets are in the unit of the protocol's axis: `--offsets=-5,5`, or `--offsets=-5..5 step 1`";
                let found = numbers(offsets).map_err(|says| {
                    Problem::error("offsets", format!("`--offsets {offsets}`: {says}")).help(help)
                });
                let offsets = problems.value(found)?;
                Some(Asked::Sync(Synchronisation { offsets, farthest, correct }))
            }
            Self::Parameters { vary, .. } => {
                let one = |vary: &String| {
                    let wrong =
                        |says: &str| Problem::error("vary", format!("`--vary {vary}`{says}"));
                    let (name, text) = vary
                        .split_once('=')
                        .ok_or_else(|| wrong(" has no `=`").help("write `--vary name=values`"))?;
                    let values = values(text).map_err(|says| wrong(&format!(": {says}")))?;
                    Ok(Vary { name: name.trim().to_owned(), values })
                };
                let all: Result<_, Problem> = vary.iter().map(one).collect();
                problems.value(all).map(Asked::Parameters)
            }
        }
    }
}

impl Common {
    fn settings(&self) -> Settings {
        Settings {
            selections: study::Settings {
                most: self.enumerate.min(study::MOST),
                width: self.width,
                seed: self.seed,
            },
            take: self.take.map(NonZeroUsize::get),
            reduce: self.reduce.map(NonZeroUsize::get),
        }
    }

    fn wrong(&self) -> Problems {
        let Self { width, enumerate, .. } = self;
        let mut problems = Problems::default();
        if !(*width > 0.0 && *width < 1.0) {
            let says = format!("`--width {width}` must be between 0 and 1");
            problems.push(Problem::error("width", says));
        }
        if enumerate.is_nan() || *enumerate < 0.0 {
            let says = format!("`--enumerate {enumerate}` is not a valid number of selections");
            problems.push(Problem::error("enumerate", says));
        }
        problems
    }
}

/// Writes all files or none.
fn write(common: &Common, study: &found::Study, console: &Console) -> Done {
    let files = deliver::study(study, Reports::ALL);
    let opening = report::opening(study);
    let fact = |fact: &Fact| format!("  {}: {}\n", fact.name, fact.value.letters());
    let facts = opening.facts.iter().map(fact);
    console.report(files, &told(&report::title(study), &opening, facts), &common.out)
}

/// What a document says at its beginning, and some facts.
pub fn told(title: &str, opening: &Opening, facts: impl Iterator<Item = String>) -> Lines {
    let Opening { headline, sentence, .. } = opening;
    let first = [title, "", &headline.word, sentence].map(str::to_string);
    first.into_iter().chain(facts).collect()
}
