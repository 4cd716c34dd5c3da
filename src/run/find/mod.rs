//! Looks for sections in the runs of a campaign, as the protocol says: place by place along each
//! run, in a window that moves with the search. What is in memory does not grow with the length of
//! a run.

mod drift;
mod place;
mod signals;
mod table;
mod window;

use crate::data::{campaign::Run, record::Wanted};
use crate::problem::error;
use crate::result::found::{FoundInRun, FoundSections, Rejected, Stretch};
use crate::run::{prelude::*, reduce::Progress, sections::Facts};
use place::{Chosen, Rules, Tried};
use signals::{Signals, Source};
use window::Window;

pub use place::{Candidate, is_stated};

/// How much of a run is looked at in one piece, in lengths of the longest section with all it needs
/// on both sides: its filters run once for all places of the piece. Longer pieces take more memory,
/// shorter ones filter their margins more often.
const PIECE: f64 = 16.0;

/// A campaign with the sections that were found in its runs.
#[derive(Debug)]
pub struct Searched {
    pub campaign: Campaign,
    pub told: FoundSections,
}

/// Whether the sections of a campaign are those that are found: the protocol looks for sections,
/// and the campaign has runs and no table.
pub fn applies(plan: &Plan, campaign: &Campaign) -> bool {
    plan.sections.find.is_some() && campaign.sections.is_none() && !campaign.runs().is_empty()
}

/// Whether every run has the data that are neither found nor have a default.
///
/// Problems: `missing-run-data`.
pub fn check_facts(plan: &Plan, campaign: &Campaign, problems: &mut Problems) {
    if let Some(rules) = &plan.sections.find {
        table::check_facts(plan, rules, campaign, problems);
    }
}

/// Finds the sections of a campaign.
///
/// # Errors
/// `no-search`: the protocol does not look for sections; `no-runs`; `nothing-found`;
/// `records-apart`; a record of a run cannot be read, or lacks a channel; vehicle data are missing.
pub fn find(
    plan: &Plan,
    graph: &Graph,
    campaign: &Campaign,
    progress: Progress<'_>,
) -> Result<Searched, Problems> {
    let Some(rules) = &plan.sections.find else {
        let problem = Problem::error(
            "no-search",
            format!("the protocol `{}` does not look for sections", plan.name),
        );
        return Err(problem.help("in its block `sections`, write `use found sections`, and what is looked for in blocks `find`").into());
    };
    if campaign.runs().is_empty() {
        let says = "the campaign has no runs to look for sections in";
        let problem = Problem::error("no-runs", says).at(&campaign.tree.span.part(0..0));
        return Err(problem.help("name them in campaign.yaml: `runs: {R1: {measurement: ..., simulation: ..., track: ...}}`").into());
    }
    let mut problems = Problems::default();
    let facts = Facts::read(plan, Campaigns::from(campaign), &mut problems);
    table::check_facts(plan, rules, campaign, &mut problems);
    if problems.any_error() {
        return Err(problems);
    }
    let mut told = FoundSections {
        campaign: None,
        step: plan.axis.unit.from_si(rules.step),
        axis_unit: plan.axis.unit.text.clone(),
        prefer: rules
            .prefer
            .as_ref()
            .map_or_else(|| "first".to_string(), |prefer| format!("highest {}", prefer.words)),
        runs: Vec::new(),
    };
    let mut places = Vec::new();
    for run in campaign.runs() {
        let rules = Rules::new(plan, graph, rules, &facts, campaign, run);
        let (found, in_run) = in_run(plan, graph, campaign, run, &rules)?;
        progress(&run.name.value);
        places.extend(found.into_iter().map(|place| (run, place)));
        told.runs.push(in_run);
    }
    if places.is_empty() {
        let rejected = told.rejected();
        let most = rejected.iter().max_by_key(|rejected| rejected.places);
        let why = most.map_or_else(String::new, |most| {
            format!(
                "; of {} places, {} were rejected first by: {}",
                told.tried(),
                most.places,
                most.reason.text()
            )
        });
        let says = format!("no section was found in the runs of the campaign{why}");
        return Err(Problem::error("nothing-found", says).at(&campaign.runs_span()).into());
    }
    let table = table::table(plan, &places, None)?;
    let found = campaign.with_sections(table);
    let offsets = drifts(plan, graph, &found, &places, &mut told);
    let found = match offsets {
        Some(offsets) => campaign.with_sections(table::table(plan, &places, Some(&offsets))?),
        None => found,
    };
    Ok(Searched { campaign: found, told })
}

/// Tells the shift of the measurement along each run, and gives what is added to the axis of each
/// section where runs ask for it.
fn drifts(
    plan: &Plan,
    graph: &Graph,
    found: &Campaign,
    places: &[(&Run, Candidate)],
    told: &mut FoundSections,
) -> Option<Vec<f64>> {
    let shifts = drift::shifts(plan, graph, found, places);
    let shortest =
        places.iter().map(|(_, place)| place.end - place.start).fold(f64::INFINITY, f64::min);
    let mut offsets = vec![0.0; places.len()];
    let mut corrected = false;
    for in_run in &mut told.runs {
        let own: Vec<usize> =
            (0..places.len()).filter(|&at| places[at].0.name.value == in_run.run).collect();
        let Some(&(run, _)) = own.first().map(|&at| &places[at]) else { continue };
        let starts: Vec<f64> = own.iter().map(|&at| places[at].1.start).collect();
        let names: Vec<&str> = own
            .iter()
            .filter_map(|&at| found.names.get(at))
            .map(|name| name.value.as_str())
            .collect();
        let of_run: Vec<_> = own.iter().map(|&at| shifts[at].clone()).collect();
        let of_places: Vec<&Candidate> = own.iter().map(|&at| &places[at].1).collect();
        let extent = (plan.axis.unit.to_si(in_run.start), plan.axis.unit.to_si(in_run.end));
        let course =
            drift::course(plan, graph, found, run, &of_places, extent, drift::FARTHEST * shortest);
        in_run.drift = drift::told(plan, run, (&names, &starts), &of_run, &course);
        let shift: Vec<Option<f64>> =
            of_run.iter().map(|shift| shift.as_ref().map(|shift| shift.shift)).collect();
        if let Some(along) =
            drift::along(&starts, &shift, &course.knots()).filter(|_| run.correct_drift)
        {
            own.iter().zip(along).for_each(|(&at, shift)| offsets[at] = shift);
            corrected = true;
        }
    }
    corrected.then_some(offsets)
}

/// Replaces each campaign whose sections are found by one that has them.
///
/// # Errors
/// As [`find`].
pub fn in_all(
    plan: &Plan,
    graph: &Graph,
    campaigns: &mut [Campaign],
) -> Result<Vec<FoundSections>, Problems> {
    let mut told = Vec::new();
    let several = campaigns.len() > 1;
    for campaign in campaigns.iter_mut().filter(|campaign| applies(plan, campaign)) {
        let found = find(plan, graph, campaign, &|_| {})?;
        told.push(FoundSections {
            campaign: several.then(|| campaign.short_name.value.clone()),
            ..found.told
        });
        *campaign = found.campaign;
    }
    Ok(told)
}

/// The records of a run that are looked at, each in a window.
struct Windows {
    all: Vec<(Source, Window)>,
}

impl Windows {
    fn open(plan: &Plan, graph: &Graph, campaign: &Campaign, run: &Run) -> Result<Self, Problems> {
        let mut all = Vec::new();
        let columns = |source: Source| signals::columns(graph, source, own_side(plan));
        for source in [Source::Side(Side::Measured), Source::Side(Side::Simulated), Source::Track] {
            let columns = columns(source);
            // Every side that the protocol evaluates must cover a section.
            let read = matches!(source, Source::Side(side) if plan.reads(side));
            let kind = source.kind();
            if columns.is_empty() && !read {
                continue;
            }
            let mut wanted = vec![Wanted::new(plan.axis.column.as_str(), plan.axis.unit.dimension)];
            let time = plan.time.as_ref().filter(|time| {
                source != Source::Track && !columns.is_empty() && time.column != plan.axis.column
            });
            wanted.extend(time.map(|time| Wanted::new(time.column.as_str(), time.unit.dimension)));
            for id in columns {
                let node = &graph.nodes[id];
                if let Operation::Read { column } = &node.operation
                    && !wanted.iter().any(|known| known.name == *column)
                {
                    wanted.push(Wanted::new(column.as_str(), node.dimension));
                }
            }
            let record = campaign.run_source(run, kind)?;
            all.push((source, Window::open(record, wanted, run.known(kind).clone())));
        }
        Ok(Self { all })
    }

    fn fill(&mut self, to: f64) -> Result<(), Problems> {
        self.all.iter_mut().try_for_each(|(_, window)| window.fill(to)).map_err(Problems)
    }

    fn forget(&mut self, before: f64) {
        self.all.iter_mut().for_each(|(_, window)| window.forget(before));
    }

    /// Where all records have begun.
    fn start(&self) -> f64 {
        self.all.iter().filter_map(|(_, window)| window.first).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Where the first of them ends; not known as long as all go on.
    fn end(&self) -> f64 {
        self.all.iter().filter_map(|(_, window)| window.end()).fold(f64::INFINITY, f64::min)
    }

    /// Up to where each of them goes at least, as far as it is known.
    fn furthest(&self) -> f64 {
        self.all.iter().map(|(_, window)| window.last).fold(f64::INFINITY, f64::min)
    }

    /// Up to where all of them are read.
    fn read_to(&self) -> f64 {
        self.all
            .iter()
            .map(|(_, window)| window.end().map_or_else(|| window.last, |_| f64::INFINITY))
            .fold(f64::INFINITY, f64::min)
    }
}

/// The side that values are taken from: the measurement, where the protocol evaluates it.
pub fn own_side(plan: &Plan) -> Side {
    if plan.reads(Side::Measured) { Side::Measured } else { Side::Simulated }
}

fn in_run(
    plan: &Plan,
    graph: &Graph,
    campaign: &Campaign,
    run: &Run,
    rules: &Rules<'_>,
) -> Result<(Vec<Candidate>, FoundInRun), Problems> {
    let mut windows = Windows::open(plan, graph, campaign, run)?;
    let reach =
        rules.reach().map_err(|reason| error("find-length", reason.text(), &run.name.span))?;
    let piece = PIECE * (reach.before + reach.after);
    windows.fill(f64::NEG_INFINITY)?;
    let start = windows.start();
    let step = rules.find.step;
    // Counted in steps from zero, so that rounding does not add up along a run.
    let mut at = (start / step).ceil();
    let mut rejections = Rejections::new(rules.reasons(), step);
    let mut chosen = Chosen::new(rules.find.prefer.is_some());
    'run: loop {
        let from = at * step;
        windows.fill(from + piece + reach.after)?;
        if (windows.furthest() - start) / step > MOST_PLACES {
            return Err(too_many(plan, run, (start, windows.furthest()), step).into());
        }
        windows.forget(from - reach.before);
        let signals = Signals::of(plan, graph, &windows, own_side(plan), rules.vehicle)?;
        let (last, read_to) = (windows.end(), windows.read_to());
        loop {
            let place = at * step;
            if place > last {
                break 'run;
            }
            if place + reach.after > read_to {
                break;
            }
            match rules.tried(&signals, place, start, last) {
                Tried::Fits(place) => {
                    rejections.fits();
                    let end = place.end;
                    chosen.add(place);
                    // A section that is taken as the first is not looked into again.
                    at = if chosen.takes_first() {
                        (end / step - WHOLE).ceil().max(at + 1.0)
                    } else {
                        at + 1.0
                    };
                }
                Tried::Rejected(reason) => {
                    rejections.add(place, reason);
                    at += 1.0;
                }
            }
        }
    }
    let unit = &plan.axis.unit;
    if windows.end() < start {
        let (from, to) = (unit.from_si(start), unit.from_si(windows.end()));
        let says = format!(
            "the records of run `{}` have no stretch in common: one begins at {from} {unit}, another ends at {to} {unit}",
            run.name.value
        );
        let problem = Problem::error("records-apart", says).at(&run.name.span);
        let help = "check the files of the run, and whether all count the same distance";
        return Err(problem.help(help).into());
    }
    let found = chosen.finish();
    let (tried, rejected, stretches) = rejections.told(|x| unit.from_si(x));
    let told = FoundInRun {
        run: run.name.value.clone(),
        start: unit.from_si(start),
        end: unit.from_si(windows.end()),
        found: found.len(),
        tried,
        rejected,
        stretches,
        drift: None,
    };
    Ok((found, told))
}

/// Most places that are tried in a run: 10 000 km, one every metre. An axis that jumps, and a step
/// that is too small, would else be looked through for hours.
const MOST_PLACES: f64 = 1e7;

fn too_many(plan: &Plan, run: &Run, (start, end): (f64, f64), step: f64) -> Problem {
    let unit = &plan.axis.unit;
    let [start, end, step] = [start, end, step].map(|x| unit.from_si(x));
    let says = format!(
        "the records of run `{}` go from {start} to {end} {unit}: with one place every {step} {unit} there are more than {MOST_PLACES:.0} to try",
        run.name.value
    );
    let help = format!(
        "write a longer `step`, and check `{}` of the records for a jump",
        plan.axis.column
    );
    Problem::error("too-many-places", says).at(&run.name.span).help(help)
}

/// An end this close to a multiple of the step, in steps, is one: it differs by rounding only.
const WHOLE: f64 = 1e-9;

/// Which places were rejected, by the first reason.
struct Rejections {
    reasons: Vec<Reason>,
    step: f64,
    tried: usize,
    counts: Vec<usize>,
    stretches: Vec<(f64, f64, usize, usize)>,
}

impl Rejections {
    fn new(reasons: Vec<Reason>, step: f64) -> Self {
        Self { counts: vec![0; reasons.len()], reasons, step, tried: 0, stretches: Vec::new() }
    }

    fn fits(&mut self) {
        self.tried += 1;
    }

    fn add(&mut self, place: f64, reason: usize) {
        self.tried += 1;
        self.counts[reason] += 1;
        match self.stretches.last_mut() {
            Some((_, to, of, places)) if *of == reason && place - *to < 1.5 * self.step => {
                (*to, *places) = (place, *places + 1)
            }
            _ => self.stretches.push((place, place, reason, 1)),
        }
    }

    fn told(self, shown: impl Fn(f64) -> f64) -> (usize, Vec<Rejected>, Vec<Stretch>) {
        let rejected = self.reasons.iter().zip(&self.counts).filter(|(_, places)| **places > 0);
        let rejected = rejected
            .map(|(reason, places)| Rejected { reason: reason.clone(), places: *places })
            .collect();
        let of = |(from, to, reason, places): &(f64, f64, usize, usize)| Stretch {
            from: shown(*from),
            to: shown(*to),
            reason: self.reasons[*reason].clone(),
            places: *places,
        };
        (self.tried, rejected, self.stretches.iter().map(of).collect())
    }
}
