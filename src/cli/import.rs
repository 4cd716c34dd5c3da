//! `import`: records of other systems to a campaign, by a mapping; `--draft` proposes one.

use super::kit::*;
use crate::certify::{Compiled, certify, compile};
use crate::check::{
    Overrides,
    plan::{Plan, Side},
};
use crate::import::{
    draft::{With, draft, groups, relative_to},
    mapping::{self, Mapping, Paths},
};
use crate::prepare::for_import;
use crate::report::findings;
use crate::result::Finding;
use crate::run::{Settings, consequence, find, needs::needs};
use crate::source::{Source, Spanned};
use crate::words;

#[derive(Debug, Args)]
pub struct Import {
    /// The mapping: what the channels of the files are in the campaign; with `--draft` the files.
    #[arg(required = true, value_name = "MAPPING")]
    inputs: Vec<PathBuf>,
    /// Output folder for the campaign; with `--draft` the file of the draft [default: standard
    /// output]
    #[arg(long, required_unless_present = "draft")]
    out: Option<PathBuf>,
    /// Propose a mapping from the files themselves, to be completed by hand.
    #[arg(long)]
    draft: bool,
    /// Protocol whose channels the draft looks for: a path, or the name of a shipped one.
    #[arg(long, requires = "draft", default_value = library::SHIPPED[0].name)]
    protocol: String,
    /// Names of channels for the draft: a path, or the name of a shipped convention.
    #[arg(long, requires = "draft", default_value = library::CONVENTIONS[0].name)]
    convention: String,
    /// Let the mapping name files outside its folder. It may then copy any file that you can read
    /// into the campaign: allow it only if you know the mapping.
    #[arg(long, conflicts_with = "draft")]
    allow_outside: bool,
    /// Format of the records of the campaign.
    #[arg(long, value_enum, default_value_t, conflicts_with = "draft")]
    records: Records,
    /// Number of files processed in parallel [default: one per core]
    #[arg(long, short, value_parser = from_one)]
    jobs: Option<NonZeroUsize>,
}

impl Import {
    pub fn run(self, console: &Console) -> Done {
        start_jobs(self.jobs)?;
        if self.draft {
            return self.propose(console);
        }
        let ([path], Some(out)) = (&self.inputs[..], &self.out) else {
            let problem = Problem::error("several-mappings", "an import takes one mapping");
            return Err(problem.help("to propose a mapping from files, add `--draft`").into());
        };
        let mut problems = Problems::default();
        let paths = Paths::allowed(path.parent().unwrap_or(Path::new("")), self.allow_outside)?;
        let checked = checked((path, &paths), out, &mut problems);
        let (mapping, compiled) = console.sound(checked, &paths.withheld(problems))?;
        let needs = compiled.as_ref().map(|compiled| needs(&compiled.plan, &compiled.graph));
        let (count, word) = (mapping.sections.names.len(), mapping.sections.word);
        let records = count * mapping.sides.len();
        let mut outputs = Outputs::of(SetKind::Campaign, out);
        let done = console.with_progress(records, |progress| {
            let format = Format::from(self.records);
            crate::import::import(&mapping, needs.as_ref(), format, &mut outputs, progress)
        });
        let told = done.map_err(|found| Ended::wrong_or_unwritten(paths.withheld(found)))?;
        console.problems(&paths.withheld(told));
        console.commit(Ok(outputs))?;
        let ending = if word == "run" && count == 1 { "" } else { "s" };
        console.say(&format!(
            "written: {records} records of {count} {word}{ending} to {}",
            out.display()
        ));
        if !console.quiet {
            look(compiled.as_ref(), out, console);
        }
        Ok(Exit::Done)
    }

    fn propose(&self, console: &Console) -> Done {
        let named = Spanned::new(
            self.convention.clone(),
            Source::new("--convention", self.convention.clone()).whole(),
        );
        let anywhere = Paths::allowed(Path::new(""), true)?;
        let (compiled, convention) = console.read(|problems| {
            let compiled = load(&self.protocol, problems)
                .and_then(|family| compile(family, &Overrides::new(), problems));
            compiled.zip(mapping::find_convention(&named, &anywhere, problems))
        })?;
        let paths: Vec<&Path> = self.inputs.iter().map(PathBuf::as_path).collect();
        self.out.as_ref().map_or(Ok(()), |out| check_file(out, &paths))?;
        let mut groups = groups(&paths).map_err(Problems)?;
        let folder = self.out.as_deref().and_then(Path::parent).unwrap_or(Path::new(""));
        relative_to(&mut groups, folder);
        let needs = needs(&compiled.plan, &compiled.graph);
        let with = With { needs: &needs, protocol: &self.protocol, convention: &convention };
        let (text, open) = draft(&groups, &with);
        let exit = match &self.out {
            Some(out) => console.write(out, text.as_bytes()),
            None => console.print_file(&text),
        };
        console.say(&format!("{open} open places; each is marked by `?`"));
        exit
    }
}

/// The mapping and its protocol, checked against each other before any record is read.
fn checked(
    (path, paths): (&Path, &Paths),
    out: &Path,
    problems: &mut Problems,
) -> Option<(Mapping, Option<Compiled>)> {
    let (source, _) = problems.value(read_text(path, &path.display().to_string()))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mapping = mapping::read(&source, paths.clone(), problems);
    if same(out, if folder.as_os_str().is_empty() { Path::new(".") } else { folder }) {
        let says =
            format!("the campaign cannot go to `{}`, the folder of the mapping", out.display());
        let problem = Problem::error("output-is-input", says);
        problems.push(problem.help("give another folder; it is created if it does not exist"));
    }
    let mapping = mapping?;
    for side in &mapping.sides {
        let pattern = &side.files;
        let inside = mapping.sections.names.iter().any(|name| {
            let Ok(place) = mapping.place_of(pattern, &name.value) else { return false };
            let parent = place.path.parent();
            parent
                .is_some_and(|parent| same(parent, &out.join(side.kind.key())) || same(parent, out))
        });
        if inside {
            let (out, kind) = (out.display(), side.kind.key());
            let says =
                format!("the campaign cannot go to `{out}`: it contains files of the {kind}");
            let problem = Problem::error("output-is-input", says).at(&pattern.span);
            problems.push(problem.help("give another folder"));
        }
    }
    let compiled = for_import(&mapping, problems)?;
    Some((mapping, compiled))
}

/// What is told about the campaign that was made: the findings of the protocol.
fn look(compiled: Option<&Compiled>, out: &Path, console: &Console) {
    let mut problems = Problems::default();
    let Some(mut campaign) = Campaign::open(out, &mut problems) else {
        return console.problems(&problems);
    };
    let Some(compiled) = compiled else { return };
    match find::in_all(&compiled.plan, &compiled.graph, std::slice::from_mut(&mut campaign)) {
        Ok(found) => {
            found.iter().for_each(|found| console.say(&crate::report::found::in_words(found)))
        }
        Err(problems) => return console.problems(&problems),
    }
    let lacks = |side: Side, kind| compiled.plan.reads(side) && !campaign.has(kind);
    if lacks(Side::Simulated, RecordKind::Simulation)
        || lacks(Side::Measured, RecordKind::Measurement)
    {
        return console.say("the plausibility of the records is not examined: the campaign lacks a side that the protocol reads");
    }
    match certify(&compiled.only_telling(), &campaign, Settings { traces: 0 }, &|_| {}) {
        Ok(found) => {
            for section in found.sections.iter().filter(|section| !section.used) {
                let reason = words::or_nothing(section.reason.as_ref());
                console.say(&format!("section {} is not used: {reason}", section.section));
            }
            let found = as_stated(&compiled.plan, found.findings);
            for finding in &found {
                console.say(&format!("finding: {}", findings::line(finding)));
            }
            if found.is_empty() {
                console.say("no findings about the plausibility of the records");
            }
        }
        Err(problems) => {
            console.say("the plausibility of the records could not be examined:");
            console.problems(&problems);
        }
    }
}

/// Findings with the consequence that `certify` gives them. They were sought with rules that only
/// tell, so that none hides another.
fn as_stated(plan: &Plan, findings: Vec<Finding>) -> Vec<Finding> {
    let stated = |mut finding: Finding| {
        let rule = plan.plausibility.iter().find(|rule| rule.name == finding.code);
        finding.consequence = rule.map_or(finding.consequence, |rule| consequence(rule.otherwise));
        finding.explains = as_stated(plan, finding.explains);
        finding
    };
    findings.into_iter().map(stated).collect()
}
