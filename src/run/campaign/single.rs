//! One value of a result computed again, with all intermediate values, to trace where it comes
//! from.

use std::collections::BTreeSet;

use crate::check::plan;
use crate::run::{
    prelude::*,
    record::{Fault, NodeValue, SectionWork, Work},
    reduce::{
        Prepared,
        section::{original, records},
        wanted_of,
    },
    values::{Meetings, RecordOfSide, Row, SectionValues, Sides},
};

/// The value of one section and signal of a quantity.
#[derive(Debug)]
pub struct Single {
    /// The records read, the simulation first.
    pub records: Vec<Side>,
    /// Difference, metric, or the value of an assessed record, in the unit of the quantity.
    pub difference: f64,
    /// Number of samples or windows of the measured value.
    pub samples: usize,
}

/// The values of one record.
#[derive(Debug)]
pub struct Side {
    /// The column of the value in a result; a repeat takes the place of the simulation. `None` for
    /// an assessment.
    pub column: Option<plan::Side>,
    pub file: FileHash,
    /// First and last row of the file inside the section; the header is row 1.
    pub inside: (usize, usize),
    /// First and last row that was read and is filtered: of a run the part around the section.
    pub filtered: (usize, usize),
    /// Values of signals: the index of the graph node, the value in SI, and the number of samples
    /// or windows.
    pub reduced: Vec<(usize, f64, usize)>,
    /// The value of this side, in the unit of the quantity; `None` where a metric gives one number
    /// for both.
    pub value: Option<f64>,
}

/// Reads both records of a section and computes one value of one quantity.
///
/// # Errors
/// Reasons why the campaign cannot be used; `no-such-section`; `not-evaluated` with the reason.
pub fn single<'a>(
    plan: &Plan,
    graph: &Graph,
    campaigns: impl Into<Campaigns<'a>>,
    (quantity, signal): (usize, usize),
    (section, record): (&str, Option<&RecordName>),
) -> Result<Single, Problems> {
    let prepared = Prepared::new(plan, graph, campaigns.into())?;
    let unit = prepared.basis.units.iter().find(|unit| unit.name == section).ok_or_else(|| {
        let problem =
            Problem::error("no-such-section", format!("the campaign has no section `{section}`"));
        problem.suggest(section, prepared.basis.units.iter().map(|unit| unit.name.as_str()))
    })?;
    if let Some(fault) = &unit.fault {
        let says = format!("section {section} is not used: {}", fault.text());
        return Err(Problem::error("not-evaluated", says).into());
    }
    let work = prepared.work();
    let found = computed(&SectionWork::new(&work, unit), quantity, signal).map_err(|fault| {
        let mut problems = Problems(fault.problems);
        problems.push(Problem::error(
            "not-evaluated",
            format!("section {section} cannot be evaluated: {}", fault.reason.text()),
        ));
        problems
    })?;
    let (rows, records) = found;
    let row = rows.iter().find(|row| row.record.as_ref() == record).ok_or_else(|| {
        Problem::error("not-evaluated", format!("section {section} has no such value"))
    })?;
    let of = &plan.quantities[quantity].unit;
    let evaluation = plan.quantities[quantity].evaluation.as_ref();
    let assessed = matches!(evaluation, Evaluation::Values { records: Records::Of(_), .. });
    // The mean or median of several records needs all of them.
    let of_all = matches!(evaluation, Evaluation::Values { records: Records::Spread { .. }, .. });
    // Of two records of one side, the first stands in the place of the simulation.
    let within = evaluation.pairing().and_then(Pairing::within);
    let both = match record {
        Some(RecordName::Pair(first, second)) if within.is_some() => Some([first, second]),
        _ => None,
    };
    let place = |(place, one): &(plan::Side, RecordOfSide)| match both {
        Some([first, _]) if one.name.as_ref() == Some(first) => plan::Side::Simulated,
        Some(_) => plan::Side::Measured,
        None => *place,
    };
    let own = |(place, one): &(plan::Side, RecordOfSide)| match both {
        Some(both) => one.name.as_ref().is_some_and(|name| both.contains(&name)),
        None => {
            let simulated = *place == plan::Side::Simulated;
            of_all || RecordName::took_part(record, simulated, one.name.as_deref())
        }
    };
    let side = |of_side: (plan::Side, RecordOfSide)| {
        let place = place(&of_side);
        let (_, one) = of_side;
        let reduced = one.found.iter().filter_map(|(node, found)| match found {
            NodeValue::Number(value, samples) => Some((*node, *value, *samples)),
            NodeValue::Samples(_) | NodeValue::Failed(_) => None,
        });
        let value = match place {
            _ if assessed => Some(row.value),
            _ if of_all => {
                row.simulated.filter(|_| one.name == record.map(RecordName::first).cloned())
            }
            plan::Side::Simulated => row.simulated,
            plan::Side::Measured => row.measured,
        };
        let column = if of_all { plan::Side::Simulated } else { place };
        let [inside, filtered] = one.rows;
        Side {
            column: (!assessed).then_some(column),
            reduced: reduced.collect(),
            inside,
            filtered,
            value: value.map(|value| of.from_si(value)),
            file: one.file,
        }
    };
    let (difference, samples) = (of.from_si(row.value), row.samples);
    Ok(Single { records: records.into_iter().filter(own).map(side).collect(), difference, samples })
}

/// Records with the column of their values in a row; a repeat takes the place of the simulation.
type Placed = Vec<(plan::Side, RecordOfSide)>;

/// One position of one quantity in one section: its rows, and the values of each record.
fn computed(
    section: &SectionWork<'_>,
    index: usize,
    position: usize,
) -> Result<(Vec<Row>, Placed), Fault> {
    let Work { plan, graph, .. } = *section.work;
    let quantity = &plan.quantities[index];
    let mut wanted = BTreeSet::new();
    wanted_of(quantity, &graph.quantities[index].signals[position], &mut wanted);
    let of = |side: plan::Side| match quantity.evaluation.reads(side) {
        true => records(section, side, &wanted, &mut SectionValues::default()),
        false => Ok(Vec::new()),
    };
    let (simulated, measured) = (of(plan::Side::Simulated)?, of(plan::Side::Measured)?);
    let repeats = quantity.evaluation.of_repeats();
    let original = if repeats { original(section, &wanted).transpose()? } else { None };
    let sides = Sides {
        section,
        simulated: &simulated,
        measured: &measured,
        original: original.as_ref(),
        meetings: Meetings::default(),
    };
    let rows = sides.rows(index, position).map_err(Fault::new)?;
    let measured_as = if repeats { plan::Side::Simulated } else { plan::Side::Measured };
    let first = original.into_iter().flat_map(|original| original.records);
    let placed = simulated
        .into_iter()
        .map(|record| (plan::Side::Simulated, record))
        .chain(measured.into_iter().map(|record| (measured_as, record)))
        .chain(first.map(|record| (plan::Side::Measured, record)));
    Ok((rows, placed.collect()))
}
