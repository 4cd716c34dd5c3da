//! `diagnose`: locates the gap, identifies the effects that cause it, and computes how far they
//! reduce it.

use indicatif::ProgressBar;

use super::{
    kit::*,
    of_runs::WithFiles,
    simulator::{Chosen, SimulatorChoice},
};
use crate::certify::Compiled;
use crate::data::hash::sha256;
use crate::deliver::{self, Reports};
use crate::diagnose::{
    Cache, Outcome,
    answer::verdict::remark,
    diagnose,
    inputs::{Inputs, Reference},
    preflight::{Preflight, preflight},
    settings::Settings,
    write_improved,
};
use crate::effects::Catalogue;
use crate::prepare::for_diagnosis;
use crate::problem::Severity;
use crate::result::diagnosis::Diagnosis;
use crate::simulate::{Builtin, Section, Simulator, Strict};
use crate::words;

#[derive(Debug, Args)]
pub struct Diagnose {
    /// Folder of the campaign.
    campaign: PathBuf,
    /// Path of a protocol, or name of a shipped one [default: the one in campaign.yaml, else
    /// en14363-2016-annex-t]
    #[arg(long, short)]
    protocol: Option<String>,
    /// Catalogue of effects: a path, or the name of a shipped one.
    #[arg(long = "effects", value_name = "CATALOGUE", default_value = library::CATALOGUES[0].name)]
    catalogue: String,
    /// Output folder; created if missing.
    #[arg(long, short, required_unless_present = "preflight")]
    out: Option<PathBuf>,
    /// Run each effect once on one section, print which features it changes, and stop.
    #[arg(long, conflicts_with_all = ["out", "write_improved"])]
    preflight: bool,
    /// Campaign of the same vehicle in a known state, from which the standing discrepancy of the
    /// simulation is estimated; may be repeated.
    #[arg(long = "reference", value_name = "CAMPAIGN")]
    references: Vec<PathBuf>,
    /// Folder for a copy of the campaign whose simulation includes the named effects.
    #[arg(long, value_name = "DIR")]
    write_improved: Option<PathBuf>,
    /// Format of the simulated records of that copy.
    #[arg(long, value_enum, default_value_t, requires = "write_improved")]
    records: Records,
    #[command(flatten)]
    simulator: SimulatorChoice,
    /// Folder for intermediate results, so that an interrupted diagnosis can be resumed.
    #[arg(long, value_name = "DIR")]
    resume: Option<PathBuf>,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Number of sections processed in parallel [default: one per core]
    #[arg(long, short, value_parser = from_one)]
    jobs: Option<NonZeroUsize>,
}

/// Arguments of a diagnosis.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    pub folder: &'a Path,
    pub protocol: Option<&'a str>,
    pub catalogue: &'a str,
    pub simulator: Option<&'a SimulatorChoice>,
    pub resume: Option<&'a Path>,
    pub references: &'a [PathBuf],
    pub seed: u64,
}

impl Diagnose {
    fn asked(&self) -> Asked<'_> {
        Asked {
            folder: &self.campaign,
            protocol: self.protocol.as_deref(),
            catalogue: &self.catalogue,
            simulator: Some(&self.simulator),
            resume: self.resume.as_deref(),
            references: &self.references,
            seed: self.seed,
        }
    }

    pub fn run(self, console: &Console) -> Done {
        start_jobs(self.jobs)?;
        let bar = console.bar(ProgressBar::new_spinner(), "{spinner} {elapsed} {msg}");
        let trying = |what: &str| {
            bar.set_message(what.to_string());
            bar.tick();
        };
        let mut problems = Problems::default();
        let places = |campaign: &Campaign| {
            self.out.as_deref().map_or(Ok(()), |out| self.check_folders(out, campaign))
        };
        let asked = self.asked();
        let Some(out) = self.out.clone() else {
            let found = preflighted(&asked, &trying, &mut problems);
            bar.finish_and_clear();
            console.problems(&problems);
            return found
                .map_or_else(|| Ok(stopped(&problems)), |found| console.print(&found.in_words()));
        };
        let outcome = diagnosed(&asked, &places, &trying, &mut problems);
        bar.finish_and_clear();
        console.problems(&problems);
        let Some((files, outcome)) = outcome else { return Ok(stopped(&problems)) };
        self.write(&out, &files.campaign, &outcome, console).map_err(Ended::unfinished)?;
        console.written(&summary(&outcome.diagnosis), &out)?;
        Ok(exit(&outcome.diagnosis))
    }

    fn write(
        &self,
        out: &Path,
        campaign: &Campaign,
        outcome: &Outcome,
        console: &Console,
    ) -> Result<(), Problem> {
        let files = deliver::diagnosis(outcome, Reports::ALL).map_err(|problems| {
            problems.0.into_iter().next().unwrap_or_else(|| Problem::error("report", "no report"))
        })?;
        let mut outputs = Outputs::new(out);
        files.iter().try_for_each(|(name, bytes)| outputs.add(name, bytes))?;
        // Both are written to disk before either is moved to its place.
        let mut all = vec![outputs];
        if let Some(folder) = &self.write_improved {
            let mut outputs = Outputs::of(SetKind::Campaign, folder);
            write_improved(&mut outputs, campaign, outcome, self.records.into())?;
            all.push(outputs);
        }
        console.problems(&Problems(all.iter().filter_map(Outputs::mended).collect()));
        all.into_iter().try_for_each(Outputs::commit)
    }

    /// Refuses output folders that are inputs, or that are the same.
    fn check_folders(&self, out: &Path, campaign: &Campaign) -> Result<(), Problem> {
        check_folder(out, REPORT, campaign)?;
        self.resume.as_ref().map_or(Ok(()), |folder| check_folder(folder, &[], campaign))?;
        let Some(improved) = &self.write_improved else { return Ok(()) };
        if same(improved, out) {
            let improved = improved.display();
            let says =
                format!("the report and the improved simulation cannot both go to `{improved}`");
            return Err(Problem::error("output-is-input", says).help("give different folders"));
        }
        check_folder(improved, CAMPAIGN, campaign)
    }
}

/// 0 if the gap is explained, or if there is no significant gap.
pub fn exit(diagnosis: &Diagnosis) -> Exit {
    match &*diagnosis.verdict {
        "explained" | "no significant gap" => Exit::Done,
        _ => Exit::DoesNotHold,
    }
}

/// Problems of a number that is present in the vehicle file.
const WRONG: [&str; 2] = ["wrong-kind", "range"];

/// The exit code of a diagnosis that was not finished: a simulator that fails is no fault of the
/// inputs.
fn stopped(problems: &Problems) -> Exit {
    const OF_SIMULATORS: [&str; 3] = ["simulator-failed", "simulator-timeout", "simulator-output"];
    let failed = problems.0.iter().any(|problem| OF_SIMULATORS.contains(&problem.code));
    if failed { Exit::Unfinished } else { Exit::Wrong }
}

/// What is read before anything is simulated.
struct Opened {
    compiled: Compiled,
    files: WithFiles,
    catalogue: Catalogue,
    settings: Settings,
    sections: Vec<Section>,
}

fn opened(
    asked: &Asked<'_>,
    places: &dyn Fn(&Campaign) -> Result<(), Problem>,
    problems: &mut Problems,
) -> Option<Opened> {
    let (compiled, campaign) = prepare(asked.folder, asked.protocol, &[], problems)?;
    problems.value(places(&campaign))?;
    let files = WithFiles::of(campaign, problems)?;
    let (catalogue, settings, sections) =
        for_diagnosis(&files.campaign, asked.catalogue, problems)?;
    Some(Opened { compiled, files, catalogue, settings, sections })
}

/// Each effect once on one section.
fn preflighted(
    asked: &Asked<'_>,
    trying: &(dyn Fn(&str) + Sync),
    problems: &mut Problems,
) -> Option<Preflight> {
    let Opened { files, catalogue, settings, sections, .. } = opened(asked, &|_| Ok(()), problems)?;
    let campaign = &files.campaign;
    let chosen = simulating(asked.simulator, campaign, &catalogue, problems)?;
    trying("each effect once");
    let simulator = chosen.as_ref().map(Chosen::simulator);
    preflight(campaign, &sections, &catalogue, &settings, simulator)
        .map_err(|found| problems.0.extend(found.0))
        .ok()
}

/// Reads all inputs and diagnoses; `places` checks the output folders before the computation.
pub fn diagnosed(
    asked: &Asked<'_>,
    places: &dyn Fn(&Campaign) -> Result<(), Problem>,
    trying: &(dyn Fn(&str) + Sync),
    problems: &mut Problems,
) -> Option<(WithFiles, Outcome)> {
    let Opened { compiled, files, catalogue, settings, sections } =
        opened(asked, places, problems)?;
    let campaign = &files.campaign;
    let mut open = |folder| WithFiles::open(folder, asked.protocol, &|_| Ok(()), problems);
    let references = asked.references.iter().map(|folder| open(folder));
    let references: Vec<WithFiles> = references.collect::<Option<_>>()?;
    let references: Vec<&Campaign> =
        references.iter().map(|reference| &reference.campaign).collect();
    for reference in &references {
        problems.value(reference.one_of_each().and_then(|()| reference.one_vehicle()))?;
    }
    // A campaign as its own reference would remove the gap itself.
    if let Some(same) = asked.references.iter().find(|folder| same(folder, asked.folder)) {
        let says = format!(
            "`{}` is the campaign itself: its gap would be treated as a standing discrepancy",
            same.display()
        );
        let problem = Problem::error("reference", says);
        problems.push(problem.help("give a campaign of the same vehicle in a known state"));
        return None;
    }
    // A campaign, its simulator, and the cache of its simulations.
    let mut with_all = |campaign| {
        let chosen = simulating(asked.simulator, campaign, &catalogue, problems)?;
        // Another simulator keeps its records itself, by the content of its program.
        let own = chosen.as_ref().is_none_or(|chosen| !chosen.is_external());
        let cache = asked.resume.filter(|_| own).map(|folder| kept(folder, campaign)).transpose();
        Some((chosen, problems.value(cache)?))
    };
    let (chosen, cache) = with_all(campaign)?;
    let of_references: Vec<_> =
        references.iter().copied().map(&mut with_all).collect::<Option<_>>()?;
    // Another simulator runs each effect once on one section first: what is misspelt is told within
    // seconds.
    let strict = chosen
        .as_ref()
        .filter(|chosen| chosen.is_external())
        .map(|chosen| Strict::new(chosen.simulator()));
    if let Some(strict) = &strict {
        trying("each effect once");
        let found = preflight(campaign, &sections, &catalogue, &settings, Some(strict));
        found.map_err(|found| problems.0.extend(found.0)).ok()?;
    }
    let own = || Some(strict.as_ref()? as &dyn Simulator);
    let references: Vec<Reference<'_>> = std::iter::zip(&references, &of_references)
        .map(|(&campaign, (chosen, cache))| Reference {
            campaign,
            simulator: chosen.as_ref().map(Chosen::simulator),
            cache: cache.clone(),
        })
        .collect();
    let inputs = Inputs {
        references: &references,
        campaign,
        catalogue: &catalogue,
        settings: &settings,
        simulator: own().or_else(|| chosen.as_ref().map(Chosen::simulator)),
        cache,
        seed: asked.seed,
        trying,
    };
    let found = diagnose(&inputs, &compiled, sections);
    let simulators = of_references.iter().map(|(chosen, _)| chosen).chain([&chosen]).flatten();
    problems.add(simulators.filter_map(Chosen::warning));
    let caches = inputs.references.iter().map(|of| &of.cache).chain([&inputs.cache]).flatten();
    problems.add(caches.filter_map(Cache::warning));
    if let Some(problem) = strict.as_ref().and_then(Strict::failed) {
        problems.push(problem);
        return None;
    }
    let outcome = problems.value(found.map_err(|found| found.0))?;
    problems.0.extend(outcome.warnings.0.iter().cloned());
    Some((files, outcome))
}

/// The simulator of a campaign. `Some(None)` if there is no model that can run: only effects of the
/// measuring chain are then tested. `None` if the inputs are wrong.
fn simulating<'a>(
    choice: Option<&SimulatorChoice>,
    campaign: &'a Campaign,
    catalogue: &Catalogue,
    problems: &mut Problems,
) -> Option<Option<Chosen<'a>>> {
    let mut lacking = Problems::default();
    let chosen = match choice {
        Some(choice) if choice.external() => {
            let chosen = choice.open(campaign, problems)?;
            chosen.check(catalogue).map_err(|found| problems.0.extend(found)).ok()?;
            Some(chosen)
        }
        _ if !Builtin::is_for(campaign) => {
            let says = "no simulator is given, and the vehicle file has no parameter of the built-in model of a rail vehicle";
            let says = format!("{says}: only effects of the measuring chain are tested");
            let problem = Problem::warning("no-simulator", says);
            problems.push(problem.help("name the simulator of the machine with `--simulator`"));
            None
        }
        _ => Builtin::new(campaign, &mut lacking).map(|model| Chosen::Builtin(Box::new(model))),
    };
    for problem in lacking.0 {
        let severity =
            if WRONG.contains(&problem.code) { Severity::Error } else { Severity::Warning };
        problems.push(Problem { severity, ..problem });
    }
    (problems.errors() == 0).then_some(chosen)
}

/// The cache in a folder, keyed by everything the simulations depend on.
fn kept(folder: &Path, campaign: &Campaign) -> Result<Cache, Problem> {
    let files: Vec<String> = campaign
        .other_files(&[RecordKind::Measurement])?
        .iter()
        .map(|(path, bytes)| format!("{path} {}", sha256(bytes)))
        .collect();
    let of = format!("{} {}", env!("CARGO_PKG_VERSION"), files.join(" "));
    Ok(Cache::new(folder, of))
}

fn summary(diagnosis: &Diagnosis) -> Lines {
    let mut out = Lines::default();
    out += &diagnosis.campaign;
    out += "\n";
    out += &format!("Verdict: {}\n", diagnosis.verdict);
    out.extend(diagnosis.says.iter().map(|line| format!("  {}\n", words::text(line))));
    out.extend(remark(&diagnosis.fit).map(|remark| format!("  Remark: {}\n", remark.text())));
    out += "\n";
    out += "Location of the gap:\n";
    out.extend(diagnosis.r#where.iter().take(6).map(|place| {
        let mark = if place.significant { "" } else { "  (not significant)" };
        format!("  {:4.0} %  {}{mark}\n", 100.0 * place.share_of_gap, place.says)
    }));
    if diagnosis.causes.len() > 1 {
        out += "\n";
        out += "Other candidates:\n";
    }
    out.extend(diagnosis.causes.iter().skip(1).map(|cause| {
        let mark = if cause.in_ambiguity_set { "  not distinguishable" } else { "" };
        format!("  {:5.1} %  {}{mark}\n", 100.0 * cause.probability, cause.says)
    }));
    let vetoed = diagnosis.vetoed.iter().map(|vetoed| format!("Rejected: {}\n", vetoed.says));
    let measure = diagnosis.discriminating_measurement.iter();
    let measure = measure.map(|it| format!("The causes can be distinguished by: {it}\n"));
    for line in vetoed.chain(measure) {
        out += "\n";
        out += &line;
    }
    out
}
