//! Probable cause of a value that differs from the expected one by a factor; and which finding
//! explains which others.

use std::collections::{BTreeSet, HashMap};

use indexmap::IndexMap;

use crate::result::SuspectedFactor;
use crate::run::prelude::*;
use crate::units::Dimension;

/// A factor between the value found and the expected value, with its most probable cause. Only
/// units of measure are listed. Causes that belong to a quantity, such as an axle load in place of
/// a wheel load, are stated in the protocol.
struct Factor {
    /// What is measured; `None` is anything.
    of: Option<Dimension>,
    factor: f64,
    /// It is that of units whatever they are called.
    of_unit: bool,
    /// The unit found, and the one expected.
    units: Option<[&'static str; 2]>,
}

const fn unit(of: Dimension, factor: f64, units: [&'static str; 2]) -> Factor {
    Factor { of: Some(of), factor, of_unit: false, units: Some(units) }
}

const fn plain(of: Dimension, factor: f64) -> Factor {
    Factor { of: Some(of), factor, of_unit: false, units: None }
}

const FACTORS: &[Factor] = &[
    Factor { of_unit: true, ..unit(Dimension::FORCE, 1000.0, ["N", "kN"]) },
    Factor { of_unit: true, ..unit(Dimension::FORCE, 9.806_65, ["kgf or daN", "N"]) },
    plain(Dimension::FORCE, 8.0),
    plain(Dimension::FORCE, 4.0),
    plain(Dimension::FORCE, 2.0),
    unit(Dimension::ACCELERATION, 9.806_65, ["m/s^2", "g"]),
    unit(Dimension::LENGTH, 1000.0, ["mm", "m"]),
    unit(Dimension::LENGTH, 100.0, ["cm", "m"]),
    unit(Dimension::SPEED, 3.6, ["km/h", "m/s"]),
    Factor { of: None, factor: 1000.0, of_unit: true, units: None },
];

/// Tolerance for a ratio to agree with a factor (as a factor, in both directions). Expected values
/// are rough (payload, roll angle), and the factors lie far apart; 9.81 and 10 are one entry.
const NEARNESS: f64 = 1.25;

/// The cause, by what is measured; `None` where the ratio agrees with no factor.
pub fn likely(found: f64, expected: f64, of: Dimension) -> Option<Reason> {
    let ratio = found / expected;
    if !ratio.is_finite() {
        return None;
    }
    if found == 0.0 {
        return Some(Reason::WithoutSignal);
    }
    let near = |of: f64| (1.0 / NEARNESS..=NEARNESS).contains(&(ratio.abs() / of));
    let suspected = |inverse: bool| {
        let possible = FACTORS.iter().filter(|factor| factor.of.is_none_or(|own| own == of));
        let mut alike =
            possible.filter(|row| near(if inverse { 1.0 / row.factor } else { row.factor }));
        alike.next().map(|row| SuspectedFactor {
            by: row.factor,
            of_unit: row.of_unit,
            units: row.units.map(|units| units.map(Into::into)),
            inverse,
        })
    };
    let factor = if near(1.0) { None } else { suspected(false).or_else(|| suspected(true)) };
    let reversed = ratio < 0.0;
    (reversed || factor.is_some()).then_some(Reason::WrongSize { reversed, factor })
}

/// A finding explains another one if it stands at this share of the places of the other one.
const EXPLAINED: f64 = 0.5;
/// A rule that concerns records found one where it finds this share of its positions.
const OF_RECORD: f64 = 0.5;
/// What stands in this share of the sections explains what is found over all sections.
const OF_SECTIONS: f64 = 0.5;

/// The findings of a campaign, each cause once, the likeliest first: those that another one
/// explains stand with it. One explains what stands behind it in the order of the rules, at the
/// same channels of the same sections; one of a record explains what is found in its sections.
pub fn by_cause(plan: &Plan, sections: usize, findings: Vec<Finding>) -> Vec<Finding> {
    let mut order: HashMap<&str, (u8, usize)> = HashMap::new();
    for (at, rule) in plan.plausibility.iter().enumerate() {
        order.entry(&rule.name).or_insert((rule.rank(), at));
    }
    let mut joined = Finding::joined(findings);
    joined.sort_by_key(|finding| match finding.first.data {
        // A channel that is late agrees with that of a wheelset behind.
        FindingData::Exchanged { .. } => (0, usize::MAX),
        // Any fault of a channel makes it agree less.
        FindingData::Matched { section: None, .. } => (u8::MAX, 0),
        _ => order.get(finding.code.as_str()).copied().unwrap_or((u8::MAX, 1)),
    });
    let mut kept: Vec<(Finding, Reach)> = Vec::new();
    for finding in joined {
        let own = Reach::of(plan, sections, &finding);
        let by =
            |(of, reach): &&mut (Finding, Reach)| reach.explains(&own, of.code == finding.code);
        match kept.iter_mut().find(by) {
            Some((first, _)) => first.explains.push(finding),
            None => kept.push((finding, own)),
        }
    }
    kept.into_iter().map(|(finding, _)| finding).collect()
}

/// What a finding is about.
struct Reach {
    /// Whether it comes from a rule, and whether that found a fault of the record.
    of_rule: bool,
    of_record: bool,
    /// Whether it stands in most sections.
    in_most: bool,
    /// By campaign and section, the record, if it is one of them, and the columns.
    places: IndexMap<SectionOf, Vec<RecordAndColumns>>,
}

/// A record, if it is one of them, and columns.
type RecordAndColumns = (Option<String>, BTreeSet<String>);

/// The campaign and the section, if any.
type SectionOf = (Option<String>, Option<String>);

impl Reach {
    fn of(plan: &Plan, sections: usize, finding: &Finding) -> Self {
        let rules: Vec<&Plausibility> =
            plan.plausibility.iter().filter(|rule| rule.name == finding.code).collect();
        let mut places: IndexMap<SectionOf, Vec<_>> = IndexMap::new();
        for at in finding.places() {
            let own = places.entry((at.campaign.clone(), at.section.clone())).or_default();
            own.push((at.record.clone(), columns_of(&rules, at)));
        }
        let positions: usize = rules.iter().map(|rule| rule.signals.len()).sum();
        let found: BTreeSet<Option<&String>> =
            finding.places().iter().map(|at| at.channel.as_ref()).collect();
        let most = found.contains(&None) || found.len() as f64 >= OF_RECORD * positions as f64;
        Self {
            of_rule: !rules.is_empty(),
            of_record: most && rules.iter().any(|rule| rule.concerns_record),
            in_most: places.len() as f64 >= OF_SECTIONS * sections as f64,
            places,
        }
    }

    fn explains(&self, other: &Self, same_rule: bool) -> bool {
        let (mut all, mut explained) = (0_usize, 0_usize);
        for (section, places) in &other.places {
            // What is found over all sections stands in each of them.
            let over_all = || self.places.get(&(section.0.clone(), None));
            let own: Vec<_> = match self.places.get(section).or_else(over_all) {
                Some(own) => own.iter().collect(),
                None if section.1.is_none() && self.in_most => {
                    self.places.values().flatten().collect()
                }
                None => Vec::new(),
            };
            let covered = |(record, columns): &&(Option<String>, BTreeSet<String>)| {
                own.iter().any(|(of, own)| {
                    let sides = of.is_none() || record.is_none() || of == record;
                    self.of_record || sides && (same_rule || !own.is_disjoint(columns))
                })
            };
            all += places.len();
            explained += places.iter().filter(covered).count();
        }
        self.of_rule && other.of_rule && explained as f64 >= EXPLAINED * all as f64
    }
}

/// The columns that were looked at; of a rule without channels those of the signals that it names.
fn columns_of(rules: &[&Plausibility], at: &Occurrence) -> BTreeSet<String> {
    let names: Vec<&str> = match &at.data {
        FindingData::Copies { channels, .. } => channels.names.iter().map(String::as_str).collect(),
        _ => at.channel.as_deref().into_iter().collect(),
    };
    let own = rules.iter().flat_map(|rule| &rule.signals);
    let own = own.filter(|(name, _)| names.contains(&name.as_str())).map(|(_, signal)| signal);
    let named = rules.iter().flat_map(|rule| match &rule.test {
        Test::Require(requirement) => requirement.inputs.as_slice(),
        _ => &[],
    });
    let named = named.filter_map(|input| input.signal.as_ref());
    own.chain(named).flat_map(columns).map(Into::into).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::words::or_nothing;

    #[test]
    fn factors_and_signs() {
        let of = |found: f64| or_nothing(likely(found, 50.0, Dimension::FORCE).as_ref());
        assert_eq!(of(-52.0), "a reversed sign");
        assert!(of(51_000.0).contains("factor of 1000, such as N in place of kN"));
        assert!(of(0.052).ends_with("the other way round"));
        assert_eq!(
            of(505.0),
            "a unit that is off by a factor of about 10, such as kgf or daN in place of N"
        );
        assert!(of(5.3).contains("kgf or daN"));
        assert_eq!(of(97.0), "a factor of 2");
        assert_eq!(of(-97.0), "a reversed sign, and a factor of 2");
        assert_eq!(of(0.0), "a channel without a signal");
        assert_eq!(likely(70.0, 50.0, Dimension::FORCE), None);
        assert_eq!(likely(1.0, 0.0, Dimension::FORCE), None);
    }

    /// A unit is named only for what is measured in it.
    #[test]
    fn units_are_those_of_the_dimension() {
        let of = |found: f64, of: Dimension| or_nothing(likely(found, 1.0, of).as_ref());
        assert_eq!(of(9.81, Dimension::ACCELERATION), "m/s^2 in place of g");
        assert_eq!(of(3.6, Dimension::SPEED), "km/h in place of m/s");
        assert_eq!(of(3.6, Dimension::LENGTH), "");
        assert_eq!(of(1000.0, Dimension::LENGTH), "mm in place of m");
        assert_eq!(of(1000.0, Dimension::ACCELERATION), "a unit that is off by a factor of 1000");
        assert_eq!([9.81, 2.0, 17.0].map(|found| of(found, Dimension::LENGTH)), ["", "", ""]);
    }
}
