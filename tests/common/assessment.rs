//! A made-up assessment: one quantity of measured records, its values in two records by section and
//! wheelset, an estimate and a prediction for each zone and wheelset, and a limit of every value.

use fishplate::result::{
    Certification, Curve, Figures, PairValue, QuantityResult, Reason, RecordName, RegressionAt,
    RegressionFigure, RegressionPoint, RulePlace, Sample, Scope, StatisticName, StatisticResult,
    Verdict,
};

use super::coach;

pub const WHEELSETS: [&str; 4] = ["1", "2", "3", "4"];
/// The group that fails.
pub const FAILS: &str = "zone 3, wheelset 1";
/// The group of which there is no prediction.
pub const OPEN: &str = "zone 1, wheelset 4";

pub fn certification() -> Certification {
    let mut found = coach::certification();
    let quantity = quantity(&found);
    found.traces.truncate(1);
    found.traces[0].simulated = Curve::default();
    found.traces[0].quantity = quantity.id.clone();
    found.traces[0].why = format!("largest value of {}", quantity.id);
    found.quantities = vec![quantity];
    found.verdict = Verdict::NotValidated;
    found.campaign.origin = None;
    found.protocol.title = "On-track assessment".into();
    found.protocol.source = None;
    found.protocol.verdict_rule = "requirements met when every limit holds".into();
    found.reasons = vec![Reason::said(format!("SigmaY: estimate ({FAILS}) exceeds the limit"))];
    found
}

fn quantity(found: &Certification) -> QuantityResult {
    let mut values = Vec::new();
    for (at, section) in found.sections.iter().filter(|section| section.used).enumerate() {
        for (record, shift) in [("first run", 0.0), ("second run", 0.5)] {
            for wheelset in WHEELSETS {
                values.push(PairValue {
                    campaign: None,
                    taken: None,
                    section: section.section.clone(),
                    zone: section.zone.clone(),
                    signal: format!("SigmaY_{wheelset}"),
                    record: Some(RecordName::Single(record.into())),
                    simulated: None,
                    measured: None,
                    difference: 20.0 + (at % 7) as f64 + shift,
                    samples: 400,
                    limit: None,
                    ratio: None,
                });
            }
        }
    }
    let mut statistics = Vec::new();
    for name in ["safety", "prediction"] {
        for zone in WHEELSETS {
            for wheelset in WHEELSETS {
                statistics.push(estimate(name, zone, wheelset, &values));
            }
        }
    }
    statistics.push(StatisticResult {
        name: StatisticName::Each,
        title: "each value".into(),
        scope: Scope::default(),
        group: Vec::new(),
        count: values.len(),
        value: Some(26.5),
        limit: Some(46.0),
        normalised: Some(26.5 / 46.0),
        holds: Some(true),
        regression: None,
        divided_at: None,
        reason: None,
        rule: RulePlace { file: "on-track.fp".into(), line: 30 },
        ..statistics[0].clone()
    });
    QuantityResult {
        outcome: None,
        id: "SigmaY".into(),
        title: "Sum of guiding forces".into(),
        symbol: "ΣY_max".into(),
        unit: "kN".into(),
        of: "SigmaY at wheelsets 1, 2, 3, 4".into(),
        filter: "LP20".into(),
        processing: "p99.85".into(),
        comparison: "measured values".into(),
        clause: None,
        source: None,
        notes: Vec::new(),
        has_sides: false,
        from: Some("measured".into()),
        among: None,
        repeats: false,
        reported: Vec::new(),
        spread: None,
        against: None,
        pairs: 0,
        figures: Figures::default(),
        groups: None,
        statistics,
        n: 30,
        values,
        holds: None,
        reason: Some(Reason::said(format!("prediction, {OPEN}: `cant` does not vary"))),
        rule: RulePlace { file: "on-track.fp".into(), line: 20 },
    }
}

fn estimate(name: &str, zone: &str, wheelset: &str, values: &[PairValue]) -> StatisticResult {
    let scope = format!("zone {zone}, wheelset {wheelset}");
    let open = name == "prediction" && scope == OPEN;
    let value = if name == "safety" && scope == FAILS { 50.0 } else { 30.0 };
    let own = format!("SigmaY_{wheelset}");
    let points = values
        .iter()
        .filter(|pair| pair.signal == own && pair.zone.as_deref() == Some(zone))
        .enumerate();
    let point = |(at, pair): (usize, &PairValue)| RegressionPoint {
        section: pair.section.clone(),
        zone: pair.zone.clone(),
        signal: own.clone(),
        x: 100.0 + at as f64,
        y: pair.difference,
    };
    let at = |step: u32| RegressionAt {
        x: 100.0 + f64::from(step),
        fitted: 20.0 + 0.2 * f64::from(step),
        bound: Some(26.0 + 0.2 * f64::from(step)),
    };
    let regression = (name == "prediction" && !open).then(|| {
        Box::new(RegressionFigure {
            regressor: "cant deficiency".into(),
            regressor_unit: "mm".into(),
            points: points.map(point).collect(),
            intercept: 0.0,
            slope: 0.2,
            curve: (0..=20).map(at).collect(),
            bound: Some("99 % prediction bound".into()),
            target: 120.0,
            value,
        })
    });
    StatisticResult {
        name: name.to_string().into(),
        title: format!("{name} of a further section"),
        scope: Scope {
            zones: vec![zone.into()],
            keys: vec![("wheelset".into(), wheelset.into())],
            condition: None,
        },
        group: vec![("zone".into(), zone.into()), ("wheelset".into(), wheelset.into())],
        count: 16,
        n: 8,
        unit: "kN".into(),
        value: (!open).then_some(value),
        interval: None,
        marginal: false,
        limit: Some(46.0),
        normalised: (!open).then_some(value / 46.0),
        sample: Sample { mean: Some(23.25), std: Some(2.0) },
        regression,
        outside: Vec::new(),
        beyond: None,
        direction: fishplate::result::Direction::Magnitude,
        edges: Vec::new(),
        divided_at: None,
        holds: (!open).then_some(value <= 46.0),
        factors: Vec::new(),
        limit_text: "10 kN + 2/3 * Q0".into(),
        limit_printed: "10 kN + 2/3 * Q0".into(),
        reason: open.then(|| Reason::said("`cant` does not vary")),
        rule: RulePlace {
            file: "on-track.fp".into(),
            line: if name == "safety" { 27 } else { 28 },
        },
    }
}
