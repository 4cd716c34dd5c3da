//! Several protocols over one campaign, with every record read and filtered once; and what each
//! protocol makes of disturbed records.

use rayon::prelude::*;

use crate::graph;
use crate::run::{
    campaign::Reduced,
    prelude::*,
    record::{Columns, Counts, Keys, Numbers, SectionRecords, Sharing, Trial, Work},
    reduce::{Prepared, Progress, section},
    values::{SectionValues, Shifts},
    verdict::Evaluated,
};

/// A protocol to evaluate with others.
#[derive(Clone, Copy, Debug)]
pub struct Rules<'a> {
    pub plan: &'a Plan,
    pub graph: &'a Graph,
    /// Whether it is evaluated on trials too.
    pub tried: bool,
}

/// What several protocols made of one campaign.
#[derive(Debug)]
pub struct Several {
    /// One for each protocol; where the campaign does not meet its needs, why.
    pub as_recorded: Vec<Result<Evaluated, Problems>>,
    /// For each trial, one for each protocol that is tried and whose needs are met.
    pub trials: Vec<Vec<Option<Evaluated>>>,
    /// Of the records as they are.
    pub counts: Counts,
}

/// The rules of a protocol that make numbers: what is asked of data has been asked of the records
/// as they were.
fn bare(plan: &Plan) -> (Plan, Graph) {
    let plan = Plan { plausibility: Vec::new(), checks: Vec::new(), ..plan.clone() };
    let graph = graph::from_plan(&plan);
    (plan, graph)
}

/// Protocols that are evaluated; `None` where the campaign does not meet the needs of one.
type Protocols<'a> = [Option<&'a Prepared<'a>>];

/// Values of one section by protocol, as recorded and then in each trial.
type Rounds = Vec<Vec<Option<SectionValues>>>;

/// Evaluates every section of a campaign by several protocols, as recorded and in trials.
pub fn several(
    rules: &[Rules<'_>],
    campaign: &Campaign,
    trials: &[Trial],
    progress: Progress<'_>,
) -> Several {
    let prepared: Vec<Result<Prepared<'_>, Problems>> = rules
        .par_iter()
        .map(|rules| Prepared::new(rules.plan, rules.graph, campaign.into()))
        .collect();
    let is_tried = |(rules, prepared): (&Rules<'_>, &Result<Prepared<'_>, Problems>)| {
        rules.tried && !trials.is_empty() && prepared.is_ok()
    };
    let bare: Vec<Option<(Plan, Graph)>> =
        rules.iter().zip(&prepared).map(|of| is_tried(of).then(|| bare(of.0.plan))).collect();
    let tried: Vec<Option<Prepared<'_>>> = bare
        .par_iter()
        .map(|bare| {
            let (plan, graph) = bare.as_ref()?;
            Prepared::new(plan, graph, campaign.into()).ok()
        })
        .collect();
    let mut columns = Columns::default();
    for prepared in prepared.iter().flatten() {
        columns.add(prepared.plan, prepared.graph);
    }
    let as_recorded: Vec<_> = prepared.iter().map(|prepared| prepared.as_ref().ok()).collect();
    let in_trials: Vec<_> = tried.iter().map(Option::as_ref).collect();
    let together = Together {
        campaign,
        columns: &columns,
        trials,
        as_recorded: &as_recorded,
        in_trials: &in_trials,
    };
    let (by_round, counts) = together.all_sections(progress);
    let mut by_round = by_round.into_iter();
    let as_recorded: Vec<Result<Evaluated, Problems>> = prepared
        .into_iter()
        .zip(by_round.next().unwrap_or_default())
        .map(|(prepared, values)| {
            let Prepared { basis, plan, .. } = prepared?;
            basis.evaluated(plan, values.into_iter().map(Some).collect())
        })
        .collect();
    let in_trial = |(at, values): (usize, Vec<SectionValues>)| {
        let (prepared, base) = (tried[at].as_ref()?, as_recorded[at].as_ref().ok()?);
        Some(base.in_trial(prepared.plan, values))
    };
    let trials =
        by_round.map(|values| values.into_iter().enumerate().map(in_trial).collect()).collect();
    Several { as_recorded, trials, counts }
}

/// The values of every section of a campaign by several protocols.
pub fn reduced(
    rules: &[(&Plan, &Graph)],
    campaign: &Campaign,
    progress: Progress<'_>,
) -> Vec<Result<Reduced, Problems>> {
    let prepared =
        rules.par_iter().map(|(plan, graph)| Prepared::new(plan, graph, campaign.into()));
    let prepared: Vec<Result<Prepared<'_>, Problems>> = prepared.collect();
    let mut columns = Columns::default();
    prepared.iter().flatten().for_each(|prepared| columns.add(prepared.plan, prepared.graph));
    let as_recorded: Vec<_> = prepared.iter().map(|prepared| prepared.as_ref().ok()).collect();
    let together = Together {
        campaign,
        columns: &columns,
        trials: &[],
        as_recorded: &as_recorded,
        in_trials: &vec![None; rules.len()],
    };
    let values = together.all_sections(progress).0.swap_remove(0);
    let of = |(prepared, values): (Result<Prepared<'_>, Problems>, Vec<SectionValues>)| {
        let sections = values.into_iter().enumerate().collect();
        Ok(Reduced { basis: prepared?.basis, sections, traces: Vec::new() })
    };
    prepared.into_iter().zip(values).map(of).collect()
}

struct Together<'a> {
    campaign: &'a Campaign,
    columns: &'a Columns,
    trials: &'a [Trial],
    as_recorded: &'a Protocols<'a>,
    in_trials: &'a Protocols<'a>,
}

impl Together<'_> {
    /// The values of every section: as recorded and then in each trial, by protocol.
    fn all_sections(&self, progress: Progress<'_>) -> (Vec<Vec<Vec<SectionValues>>>, Counts) {
        let of_sections: Vec<(Rounds, Counts)> = (0..self.campaign.names.len())
            .into_par_iter()
            .with_max_len(1)
            .map(|at| self.section(at, progress))
            .collect();
        let (rounds, counts): (Vec<Rounds>, Vec<Counts>) = of_sections.into_iter().unzip();
        let none = vec![Vec::new(); self.as_recorded.len()];
        let mut by_round: Vec<Vec<Vec<SectionValues>>> = vec![none; 1 + self.trials.len()];
        for rounds in rounds {
            for (all, values) in by_round.iter_mut().zip(rounds) {
                all.iter_mut().zip(values).for_each(|(all, values)| all.extend(values));
            }
        }
        (by_round, counts.into_iter().sum())
    }

    fn section(&self, at: usize, progress: Progress<'_>) -> (Rounds, Counts) {
        let cell = &self.campaign.names[at];
        let place = self.as_recorded.iter().flatten().find_map(|prepared| {
            let unit = prepared.basis.units.get(at)?;
            let part = unit
                .stretch
                .map(|stretch| stretch.part(prepared.plan))
                .or_else(|| unit.part(prepared.plan));
            Some((prepared.plan.axis.column.clone(), unit.extent?, part))
        });
        let records = SectionRecords::new(self.campaign, cell, self.columns, place);
        let mut numbers = Numbers::default();
        let mut keys = |protocols: &Protocols<'_>| -> Vec<Option<Keys>> {
            let of = |prepared: &Option<&Prepared<'_>>| {
                let Prepared { plan, graph, basis, .. } = (*prepared)?;
                Some(numbers.keys(plan, graph, &basis.units[at].known(&basis.facts)))
            };
            protocols.iter().map(of).collect()
        };
        let (as_recorded, in_trials) = (keys(self.as_recorded), keys(self.in_trials));
        let round = |records: &SectionRecords<'_>,
                     protocols: &Protocols<'_>,
                     keys: &[Option<Keys>]| {
            let one = |((of, prepared), keys): ((usize, &Option<&Prepared<'_>>), &Option<Keys>)| {
                let (prepared, keys) = prepared.zip(keys.as_ref())?;
                // In a trial, a section is evaluated on the stretch on which it is as recorded.
                let soundness = &self.as_recorded[of]?.soundness;
                let unit = &prepared.basis.units[at];
                if unit.fault.is_some() {
                    return Some(SectionValues::default());
                }
                let work =
                    Work { shared: Some(Sharing { records, keys }), soundness, ..prepared.work() };
                section::of_section(&work, unit, &Shifts::NONE).pop()
            };
            let values = protocols.iter().enumerate().zip(keys).map(one).collect();
            progress(&cell.value);
            values
        };
        let mut rounds: Rounds = vec![round(&records, self.as_recorded, &as_recorded)];
        let counts = records.counts();
        for trial in self.trials {
            rounds.push(round(&records.with(*trial), self.in_trials, &in_trials));
        }
        (rounds, counts)
    }
}
