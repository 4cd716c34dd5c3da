//! One place of a run: the length of a section there, its data, its zone, and the conditions; which of
//! several places that would overlap are taken.

use super::signals::Signals;
use crate::check::{
    evaluate::evaluate,
    possible::{Possible, possible},
};
use crate::data::campaign::Run;
use crate::run::{
    prelude::*,
    sections::{Extent, Facts, Known, Vehicle, of_run},
};

/// How often a length that depends on data of the section is computed again from those of the new
/// length.
const MOST_LENGTHS: usize = 8;

/// Share of a bound by which a value may miss it: that of 2 km/h by a range of speeds recorded with
/// two decimals, which is subtracted in m/s, is 1e-14.
const ROUNDING: f64 = 1e-12;

/// Significant digits of found section data in their unit: a radius of 10 km to the tenth of a
/// millimetre.
const DIGITS: usize = 8;

/// A place where a section was found.
#[derive(Clone, Debug)]
pub struct Candidate {
    pub start: f64,
    pub end: f64,
    pub zone: Option<String>,
    /// One for each [`Plan::columns`].
    pub columns: Vec<Result<Scalar, Reason>>,
    /// By which it is preferred.
    pub value: f64,
}

#[derive(Debug)]
pub enum Tried {
    Fits(Candidate),
    /// Index into [`Rules::reasons`].
    Rejected(usize),
}

/// The record ends too close to the place.
const RECORD: usize = 0;
/// The data of the section satisfy no zone.
const NO_ZONE: usize = 1;
/// The length has no value.
const LENGTH: usize = 2;
/// The first condition.
const CONDITIONS: usize = 3;

/// How far a run is looked at around a place.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    pub before: f64,
    /// Of the longest section, with what is behind it.
    pub after: f64,
}

/// What is looked for in one run.
pub struct Rules<'a> {
    plan: &'a Plan,
    graph: &'a Graph,
    pub find: &'a Find,
    pub vehicle: &'a Vehicle,
    /// What the campaign says of the run, one for each column; an error where it must be found.
    stated: Vec<Result<Scalar, Reason>>,
}

type Columns = Vec<Result<Scalar, Reason>>;

impl<'a> Rules<'a> {
    pub fn new(
        plan: &'a Plan,
        graph: &'a Graph,
        find: &'a Find,
        facts: &'a Facts,
        campaign: &Campaign,
        run: &Run,
    ) -> Self {
        let stated = plan
            .columns
            .iter()
            .map(|datum| of_run(datum, run, &campaign.short_name.value))
            .collect();
        let state = run.fact("state").map(|fact| fact.value.value.as_str());
        let vehicle = campaign
            .vehicles
            .iter()
            .position(|vehicle| state.is_some() && vehicle.state.as_deref() == state)
            .unwrap_or(0);
        Self { plan, graph, find, vehicle: &facts.vehicles[vehicle], stated }
    }

    /// Why a place may be rejected, in the order in which it is looked at.
    pub fn reasons(&self) -> Vec<Reason> {
        let condition = |condition: &FindCondition| Reason::ConditionOfSearch {
            condition: condition.title.clone(),
        };
        [Reason::RecordEnds, Reason::InNoZone, self.no_length()]
            .into_iter()
            .chain(self.find.conditions.iter().map(condition))
            .collect()
    }

    /// Why a length has no value: the vehicle data that are not stated, with the zones that need
    /// them.
    fn no_length(&self) -> Reason {
        let (mut zones, mut keys): (Vec<String>, Vec<String>) = (Vec::new(), Vec::new());
        for zone in self.zones() {
            let mut lacking = Vec::new();
            self.length_of(zone).into_iter().for_each(|length| {
                length.visit(&mut |part| match part.kind {
                    Kind::Vehicle(index) if self.vehicle.data[index].is_err() => {
                        lacking.push(self.plan.vehicle[index].key.clone())
                    }
                    _ => {}
                });
            });
            if !lacking.is_empty() {
                zones.extend(zone.map(|zone| zone.name.clone()));
            }
            let new: Vec<String> = lacking.into_iter().filter(|key| !keys.contains(key)).collect();
            keys.extend(new);
        }
        Reason::LengthWithoutValue { zones, keys }
    }

    fn zones(&self) -> Vec<Option<&'a Zone>> {
        match self.plan.sections.zone {
            Some(_) if !self.plan.zones.is_empty() => self.plan.zones.iter().map(Some).collect(),
            _ => vec![None],
        }
    }

    fn length_of<'z>(&'z self, zone: Option<&'z Zone>) -> Option<&'z Expr> {
        self.find.length.as_ref().or_else(|| zone.and_then(|zone| zone.minimum_length.as_ref()))
    }

    /// The margin of a section of some length.
    fn margin(&self, length: f64) -> f64 {
        self.plan.sections.margin.unwrap_or(length)
    }

    /// # Errors
    /// A length without an upper bound.
    pub fn reach(&self) -> Result<Reach, Reason> {
        let known = Known::vehicle(self.vehicle);
        let mut longest = 0.0_f64;
        for zone in self.zones() {
            let Some(length) = self.length_of(zone) else { continue };
            longest = match (number(length, &known), possible(length, &known)) {
                (Ok(length), _) => longest.max(length),
                (Err(_), Possible::Number(_, most)) if most.is_finite() => longest.max(most),
                (Err(reason), _) => {
                    return Err(Reason::LengthWithoutBound { reason: Box::new(reason) });
                }
            };
        }
        let margin = self.margin(longest);
        let lead =
            self.find.conditions.iter().map(|condition| condition.lead).fold(margin, f64::max);
        let tail =
            self.find.conditions.iter().map(|condition| condition.tail).fold(margin, f64::max);
        Ok(Reach { before: lead, after: longest + tail })
    }

    fn known<'k>(
        &'k self,
        columns: &'k Columns,
        extent: Extent,
        inputs: &'k [Result<f64, Reason>],
    ) -> Known<'k> {
        Known {
            columns: Some(columns),
            extent: Some(extent),
            inputs,
            ..Known::vehicle(self.vehicle)
        }
    }

    /// A section that begins at a place; the records go from `first` to `last`.
    pub fn tried(&self, signals: &Signals<'_>, start: f64, first: f64, last: f64) -> Tried {
        let mut reason = None;
        // Zones of the same length share their data.
        let mut seen: Vec<(f64, Columns)> = Vec::new();
        for zone in self.zones() {
            let Some(length) = self.length(signals, zone, start, &mut seen) else {
                reason.get_or_insert(LENGTH);
                continue;
            };
            let (extent, margin) = ((start, start + length), self.margin(length));
            if start - margin < first || start + length + margin > last {
                reason.get_or_insert(RECORD);
                continue;
            }
            let mut columns = self.data(signals, extent, &mut seen);
            if let (Some(zone), Some(index)) = (zone, self.plan.sections.zone) {
                columns[index] = Ok(Scalar::Word(zone.name.clone()));
                let inside = zone.condition.as_ref().is_none_or(|condition| {
                    flag(condition, &self.known(&columns, extent, &[])) == Ok(true)
                });
                if !inside {
                    continue;
                }
            }
            match self.failing(signals, &columns, extent) {
                Some(condition) => {
                    // What the place lacks as a section of its zone, and not that the record is too
                    // short for a longer zone.
                    if reason.is_none_or(|reason| reason < CONDITIONS) {
                        reason = Some(condition);
                    }
                }
                None => {
                    let value = self.value(signals, &columns, extent);
                    let zone = zone.map(|zone| zone.name.clone());
                    return Tried::Fits(Candidate {
                        start: extent.0,
                        end: extent.1,
                        zone,
                        columns,
                        value,
                    });
                }
            }
        }
        Tried::Rejected(reason.unwrap_or(NO_ZONE))
    }

    /// The length of a section of a zone. Where it depends on data of the section, those of a
    /// section of just this length.
    fn length(
        &self,
        signals: &Signals<'_>,
        zone: Option<&Zone>,
        start: f64,
        seen: &mut Vec<(f64, Columns)>,
    ) -> Option<f64> {
        let length = self.length_of(zone)?;
        if let Ok(length) = number(length, &Known::vehicle(self.vehicle)) {
            return (length > 0.0).then_some(length);
        }
        let mut tried = self.find.step;
        for _ in 0..MOST_LENGTHS {
            let extent = (start, start + tried);
            let mut columns = self.data(signals, extent, seen);
            if let (Some(zone), Some(index)) = (zone, self.plan.sections.zone) {
                columns[index] = Ok(Scalar::Word(zone.name.clone()));
            }
            let found = number(length, &self.known(&columns, extent, &[]))
                .ok()
                .filter(|found| *found > 0.0)?;
            if found == tried {
                return Some(found);
            }
            tried = found;
        }
        None
    }

    /// The section data of a part of the run, all but the zone.
    fn data(
        &self,
        signals: &Signals<'_>,
        extent: Extent,
        seen: &mut Vec<(f64, Columns)>,
    ) -> Columns {
        if let Some((_, columns)) = seen.iter().find(|(end, _)| *end == extent.1) {
            return columns.clone();
        }
        let mut columns = self.stated.clone();
        for (datum, nodes) in self.find.data.iter().zip(&self.graph.find.data) {
            let inputs = signals.values(nodes, extent);
            let value = evaluate(&datum.of.expr, &self.known(&columns, extent, &inputs));
            columns[datum.column] =
                value.map(|value| written(&self.plan.columns[datum.column], value));
        }
        seen.push((extent.1, columns.clone()));
        columns
    }

    /// The first condition that the section does not satisfy.
    fn failing(
        &self,
        signals: &Signals<'_>,
        columns: &Columns,
        (start, end): Extent,
    ) -> Option<usize> {
        let fails = |(condition, nodes): (&FindCondition, &Vec<InputNode>)| {
            let around = (start - condition.lead, end + condition.tail);
            if !signals.cover(nodes, around) {
                return true;
            }
            let inputs = signals.values(nodes, around);
            // Bounds are met up to rounding.
            let known = self.known(columns, (start, end), &inputs);
            flag(&condition.require.expr, &Known { rounding: ROUNDING, ..known }) != Ok(true)
        };
        let at = self.find.conditions.iter().zip(&self.graph.find.conditions).position(fails)?;
        Some(CONDITIONS + at)
    }

    fn value(&self, signals: &Signals<'_>, columns: &Columns, extent: Extent) -> f64 {
        let Some(prefer) = &self.find.prefer else { return 0.0 };
        let inputs = signals.values(&self.graph.find.prefer, extent);
        number(&prefer.expr, &self.known(columns, extent, &inputs)).unwrap_or(f64::NEG_INFINITY)
    }
}

/// A value as the table of sections states it, so that a zone follows from the table as it does
/// from the run. What is computed is not in the table.
fn written(datum: &Datum, value: Scalar) -> Scalar {
    match (value, &datum.kind) {
        (Scalar::Number(value), DatumKind::Number(unit)) if !datum.computed => {
            let rounded = format!("{:.*e}", DIGITS - 1, unit.from_si(value)).parse();
            Scalar::Number(rounded.map_or(value, |number: f64| unit.to_si(number)))
        }
        (value, _) => value,
    }
}

/// Whether a column can only come from the campaign.
pub fn is_stated(plan: &Plan, find: &Find, column: usize) -> bool {
    plan.sections.zone != Some(column)
        && plan.columns[column].is_stated()
        && find.data.iter().all(|datum| datum.column != column)
}

/// The places that are taken so far, and those that may still overlap with one that comes.
#[derive(Debug)]
pub struct Chosen {
    by_value: bool,
    taken: Vec<Candidate>,
    /// Places that overlap, directly or through others.
    open: Vec<Candidate>,
    open_end: f64,
}

impl Chosen {
    pub fn new(by_value: bool) -> Self {
        Self { by_value, taken: Vec::new(), open: Vec::new(), open_end: f64::NEG_INFINITY }
    }

    /// Whether a place is taken as soon as it is found.
    pub fn takes_first(&self) -> bool {
        !self.by_value
    }

    /// Places come in the order of their starts.
    pub fn add(&mut self, place: Candidate) {
        if !self.by_value {
            self.taken.push(place);
            return;
        }
        if place.start >= self.open_end {
            self.close();
        }
        self.open_end = self.open_end.max(place.end);
        self.open.push(place);
    }

    pub fn finish(mut self) -> Vec<Candidate> {
        self.close();
        self.taken
    }

    /// Takes the place with the highest value, then the highest of those that do not overlap with
    /// it, and so on; of equal values the first.
    fn close(&mut self) {
        let mut open = std::mem::take(&mut self.open);
        open.sort_by(|a, b| b.value.total_cmp(&a.value).then(a.start.total_cmp(&b.start)));
        let mut taken: Vec<Candidate> = Vec::new();
        for place in open {
            if taken.iter().all(|other| place.end <= other.start || place.start >= other.end) {
                taken.push(place);
            }
        }
        taken.sort_by(|a, b| a.start.total_cmp(&b.start));
        self.taken.append(&mut taken);
        self.open_end = f64::NEG_INFINITY;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(by_value: bool, places: &[(f64, f64, f64)]) -> Vec<(f64, f64)> {
        let mut chosen = Chosen::new(by_value);
        for &(start, end, value) in places {
            chosen.add(Candidate { start, end, zone: None, columns: Vec::new(), value });
        }
        chosen.finish().iter().map(|place| (place.start, place.end)).collect()
    }

    #[test]
    fn of_places_that_overlap_the_highest_is_taken() {
        let places = [
            (0.0, 10.0, 1.0),
            (5.0, 15.0, 3.0),
            (14.0, 24.0, 2.0),
            (15.0, 25.0, 2.0),
            (30.0, 40.0, 0.0),
        ];
        assert_eq!(taken(true, &places), [(5.0, 15.0), (15.0, 25.0), (30.0, 40.0)]);
    }

    #[test]
    fn of_equal_values_the_first_is_taken() {
        assert_eq!(
            taken(true, &[(0.0, 10.0, 1.0), (1.0, 11.0, 1.0), (10.0, 20.0, 1.0)]),
            [(0.0, 10.0), (10.0, 20.0)]
        );
        assert_eq!(
            taken(false, &[(0.0, 10.0, 1.0), (10.0, 20.0, 5.0)]),
            [(0.0, 10.0), (10.0, 20.0)]
        );
    }
}
