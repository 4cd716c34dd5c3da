//! A certification with everything a report must print: twelve quantities of which one fails and
//! one cannot be assessed, 33 sections in four zones, and names that try to be markup. The numbers
//! are made up.

use fishplate::result::{
    CampaignInfo, Certification, CheckResult, Curve, DataItem, Deviation, DomainRange, FORMAT,
    Figures, FileHash, FilterInfo, Identification, PairValue, ParameterInfo, ProtocolFile,
    ProtocolInfo, QuantityResult, Reason, Remark, RulePlace, Sample, Scope, SectionResult,
    StatisticResult, THIS, Trace, Verdict, ZoneResult,
};

/// A vehicle's name that would run if it were taken for markup.
pub const SCRIPT: &str = "<script>alert(1)</script>";
/// A name that would be evaluated by a template engine.
pub const EXPRESSION: &str = "{{ 7*7 }}{% raw %}#{7*7}";
/// A section name that would close an attribute, an element and a script.
pub const BREAKOUT: &str = "S\"><img src=x onerror=alert(2)></script><!--";

/// Numbers in -1..1 from a linear congruential generator (Knuth's MMIX constants): the same on
/// every machine.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn bell(&mut self) -> f64 {
        (0..6).map(|_| self.next()).sum::<f64>() / 2.0_f64.sqrt()
    }
}

/// id, title, symbol, unit, signals, typical value, limit of the standard deviation, bias and
/// scatter in parts of the limits
type Made = (
    &'static str,
    &'static str,
    &'static str,
    &'static str,
    &'static [&'static str],
    f64,
    f64,
    f64,
    f64,
);

const WHEELS_Y: &[&str] = &["Y_1R", "Y_1L", "Y_3R", "Y_3L"];
const WHEELS_Q: &[&str] = &["Q_1R", "Q_1L", "Q_3R", "Q_3L"];
const RATIOS: &[&str] = &["Y/Q_1R", "Y/Q_1L", "Y/Q_3R", "Y/Q_3L"];
const SETS: &[&str] = &["ΣY_1", "ΣY_3"];
const LATERAL: &[&str] = &["ay_I", "ay_II"];
const VERTICAL: &[&str] = &["az_I", "az_II"];

const MADE: [Made; 12] = [
    ("Y_qst", "Quasi-static guiding force", "Y_qst", "kN", WHEELS_Y, 18.0, 5.0, 0.21, 0.43),
    ("Q_qst", "Quasi-static vertical wheel force", "Q_qst", "kN", WHEELS_Q, 55.0, 6.2, -0.35, 0.38),
    ("YQ_qst", "Quasi-static ratio Y/Q", "(Y/Q)_qst", "-", RATIOS, 0.25, 0.07, 0.12, 0.5),
    (
        "SigmaY_qst",
        "Quasi-static sum of guiding forces",
        "ΣY_qst",
        "kN",
        SETS,
        14.0,
        6.0,
        -0.08,
        0.35,
    ),
    ("Y_max", "Guiding force, maximum", "Y_max", "kN", WHEELS_Y, 34.0, 9.0, 0.4, 0.62),
    ("Q_max", "Vertical wheel force, maximum", "Q_max", "kN", WHEELS_Q, 82.0, 9.3, 0.33, 0.71),
    ("YQ_max", "Ratio Y/Q, maximum", "(Y/Q)_max", "-", RATIOS, 0.44, 0.1, 0.27, 0.58),
    ("SigmaY_max", "Sum of guiding forces, maximum", "ΣY_max", "kN", SETS, 28.0, 9.0, -0.41, 0.66),
    (
        "ay_rms",
        "Car body lateral acceleration, rms",
        "ÿ*_rms",
        "m/s^2",
        LATERAL,
        0.32,
        0.15,
        -0.18,
        0.29,
    ),
    (
        "az_rms",
        "Car body vertical acceleration, rms",
        "z̈*_rms",
        "m/s^2",
        VERTICAL,
        0.28,
        0.15,
        0.64,
        0.52,
    ),
    (
        "ay_max",
        "Car body lateral acceleration, maximum",
        "ÿ*_max",
        "m/s^2",
        LATERAL,
        1.1,
        0.4,
        -0.52,
        1.24,
    ),
    (
        "az_max",
        "Car body vertical acceleration, maximum",
        "z̈*_max",
        "m/s^2",
        VERTICAL,
        1.3,
        0.4,
        0.0,
        0.0,
    ),
];

/// The whole certification.
pub fn certification() -> Certification {
    let mut noise = Noise(20_160_301);
    let sections = sections(&mut noise);
    let quantities: Vec<QuantityResult> =
        MADE.iter().map(|made| quantity(made, &sections, &mut noise)).collect();
    Certification {
        outcome: None,
        fishplate: THIS.into(),
        format: FORMAT,
        language: "en".into(),
        template: None,
        verdict_text: "not validated".into(),
        protocol: protocol(),
        campaign: campaign(),
        verdict: Verdict::NotValidated,
        own_word: None,
        verdict_note: None,
        provisional: Vec::new(),
        confirmed: Vec::new(),
        draft: false,
        removed: fishplate::result::Removed::default(),
        deviations: Vec::new(),
        verdicts: Vec::new(),
        drawn: Vec::new(),
        reasons: vec![
            Reason::said("ÿ*_max: standard deviation above its limit"),
            Reason::said("z̈*_max: not assessable, channel `az_I` is missing in 33 records"),
        ],
        found: Vec::new(),
        reduction: None,
        reported: Vec::new(),
        zones: zones(&sections),
        domain: domain(&sections),
        application: Vec::new(),
        traces: traces(&mut noise),
        findings: Vec::new(),
        notes: vec![Remark::Said {
            says: format!(
                "Section {BREAKOUT}: margin of 4.2 s before the section is short for a filter that reaches to 0.4 Hz"
            ),
        }],
        quantities,
        sections,
    }
}

/// A certification that found nothing: no quantity, section, zone, trace.
pub fn empty() -> Certification {
    let mut found = certification();
    found.verdict = Verdict::NotAssessable;
    found.reasons = vec![Reason::said("no section")];
    (found.quantities, found.sections, found.zones) = (Vec::new(), Vec::new(), Vec::new());
    (found.domain, found.traces, found.notes) = (Vec::new(), Vec::new(), Vec::new());
    (found.campaign.vehicle, found.campaign.facts, found.campaign.files) =
        (Vec::new(), Vec::new(), Vec::new());
    (found.protocol.files, found.protocol.deviations, found.protocol.parameters) =
        (Vec::new(), Vec::new(), Vec::new());
    (found.protocol.filters, found.protocol.graph_svg) = (Vec::new(), String::new());
    found
}

/// Quantities whose statistics and sides are all missing.
pub fn unassessed() -> Certification {
    let mut found = certification();
    for quantity in &mut found.quantities {
        (quantity.holds, quantity.reason) = (None, Some(Reason::said("no channel")));
        for pair in &mut quantity.values {
            (pair.simulated, pair.measured, pair.zone) = (None, None, None);
        }
        for statistic in &mut quantity.statistics {
            (statistic.value, statistic.limit, statistic.normalised) = (None, None, None);
            (statistic.holds, statistic.interval) = (None, None);
        }
    }
    found
}

fn sections(noise: &mut Noise) -> Vec<SectionResult> {
    let counts = [(1_u32, 9), (2, 9), (3, 8), (4, 7)];
    let mut sections = Vec::new();
    for (zone, count) in counts {
        for nth in 0..count {
            let number = sections.len() + 1;
            let length = [500.0, 250.0, 100.0, 70.0][zone as usize - 1]
                + (20.0 * (noise.next() + 1.0)).round();
            let start = 1000.0 * number as f64;
            let radius = [0.0, 900.0, 480.0, 320.0][zone as usize - 1]
                + 60.0 * noise.next().round()
                + 10.0 * f64::from(nth as u32);
            let speed =
                [160.0, 130.0, 100.0, 80.0][zone as usize - 1] + (8.0 * noise.next()).round();
            let deficiency =
                [10.0, 110.0, 130.0, 140.0][zone as usize - 1] + (10.0 * noise.next()).round();
            let used = number != 20;
            let name = if number == 12 { BREAKOUT.to_owned() } else { format!("S{number:02}") };
            sections.push(SectionResult {
                campaign: None,
                vehicle: None,
                section: name,
                site: String::new(),
                zone: Some(zone.to_string()),
                used,
                reason: (!used).then(|| {
                    Reason::said("record of the measurement has a gap of 0.31 s at 20041.5 m")
                }),
                length,
                start,
                end: start + length,
                axis_unit: "m".into(),
                columns: vec![
                    item("speed", &speed.to_string(), Some("km/h")),
                    item("cant deficiency", &deficiency.to_string(), Some("mm")),
                    item(
                        "radius",
                        &if zone == 1 { String::new() } else { radius.to_string() },
                        Some("m"),
                    ),
                    item(
                        "direction",
                        ["straight", "right", "left"][if zone == 1 { 0 } else { 1 + nth % 2 }],
                        None,
                    ),
                ],
                checks: vec![
                    check(
                        "length",
                        "Length",
                        Some(true),
                        &format!(
                            "length {length} m, at least {} m",
                            [500, 250, 100, 70][zone as usize - 1]
                        ),
                    ),
                    check(
                        "complete",
                        "Complete record",
                        Some(used),
                        if used { "no gap" } else { "gap of 0.31 s" },
                    ),
                    check(
                        "speed",
                        "Constant speed",
                        (number != 7).then_some(true),
                        if number == 7 { "no channel `speed`" } else { "within 2 %" },
                    ),
                ],
            });
        }
    }
    sections
}

fn check(name: &str, title: &str, holds: Option<bool>, says: &str) -> CheckResult {
    CheckResult { name: name.into(), title: title.into(), holds, says: Reason::said(says) }
}

fn item(name: &str, value: &str, unit: Option<&str>) -> DataItem {
    DataItem {
        name: name.into(),
        value: value.into(),
        unit: unit.map(str::to_owned),
        used: true,
        unit_assumed: false,
        of: None,
    }
}

fn quantity(made: &Made, sections: &[SectionResult], noise: &mut Noise) -> QuantityResult {
    let &(id, title, symbol, unit, signals, typical, limit, bias, scatter) = made;
    let missing = scatter == 0.0;
    let mut values = Vec::new();
    for section in sections.iter().filter(|section| section.used && !missing) {
        let zone: f64 = section.zone.as_deref().and_then(|zone| zone.parse().ok()).unwrap_or(1.0);
        for (nth, signal) in signals.iter().enumerate() {
            let measured = typical * (0.35 + 0.2 * zone + 0.12 * nth as f64 + 0.12 * noise.next());
            let difference = limit * (2.0 / 3.0 * bias + scatter * noise.bell());
            values.push(PairValue {
                campaign: None,
                taken: None,
                record: None,
                section: section.section.clone(),
                zone: section.zone.clone(),
                signal: (*signal).to_owned(),
                simulated: Some(measured + difference),
                measured: Some(measured),
                difference,
                samples: 4000 + 17 * nth,
                limit: None,
                ratio: None,
            });
        }
    }
    let statistics = if missing { Vec::new() } else { statistics(&values, unit, limit) };
    let holds =
        (!missing).then(|| statistics.iter().all(|statistic| statistic.holds == Some(true)));
    QuantityResult {
        outcome: None,
        from: None,
        among: None,
        repeats: false,
        reported: Vec::new(),
        spread: None,
        against: None,
        id: id.into(),
        title: title.into(),
        symbol: symbol.into(),
        unit: unit.into(),
        of: signals.join(", "),
        filter: if id.contains("ay") || id.contains("az") {
            "band-pass 0.4 to 10 Hz"
        } else {
            "low-pass 20 Hz"
        }
        .into(),
        processing: "larger of |p0.15|, |p99.85|".into(),
        comparison: "simulated − measured".into(),
        clause: Some("T.3.2".into()),
        source: Some("Polach et al. 2014, Table 1".into()),
        notes: if id == "Y_max" { vec![format!("Assumed: {EXPRESSION}")] } else { Vec::new() },
        has_sides: true,
        pairs: 0,
        figures: Figures::default(),
        groups: None,
        statistics,
        n: values.len() / 2,
        values,
        holds,
        reason: missing.then(|| Reason::said("channel `az_I` is missing in 33 records")),
        rule: RulePlace { file: "annex-t.fp".into(), line: 345 },
    }
}

fn statistics(values: &[PairValue], unit: &str, limit: f64) -> Vec<StatisticResult> {
    let n = values.len() as f64;
    let mean = values.iter().map(|pair| pair.difference).sum::<f64>() / n;
    let std = (values.iter().map(|pair| (pair.difference - mean).powi(2)).sum::<f64>() / (n - 1.0))
        .sqrt();
    let one =
        |name: &str, title: &str, value: f64, limit: f64, half: f64, text: &str| StatisticResult {
            name: name.to_string().into(),
            title: title.into(),
            scope: Scope::default(),
            group: Vec::new(),
            count: values.len(),
            n: values.len() / 2,
            unit: unit.into(),
            value: Some(value),
            interval: Some((value - half, value + half)),
            marginal: false,
            limit: Some(limit),
            normalised: Some(value.abs() / limit),
            sample: Sample::default(),
            regression: None,
            divided_at: None,
            outside: Vec::new(),
            beyond: None,
            direction: fishplate::result::Direction::Magnitude,
            edges: Vec::new(),
            holds: Some(value.abs() <= limit),
            factors: Vec::new(),
            limit_text: text.into(),
            limit_printed: text.replace("of std", "of the limit of std"),
            reason: None,
            rule: RulePlace { file: "annex-t.fp".into(), line: 345 },
        };
    vec![
        one("mean", "mean", mean, 2.0 / 3.0 * limit, 2.0 * std / n.sqrt(), "2/3 of std"),
        one(
            "std",
            "standard deviation",
            std,
            limit,
            1.4 * std / n.sqrt(),
            &format!("{limit} {unit}"),
        ),
    ]
}

fn zones(sections: &[SectionResult]) -> Vec<ZoneResult> {
    [
        ("1", "Straight track and very large radius curves", "radius > 3000 m or straight"),
        ("2", "Large radius curves", "600 m <= radius"),
        ("3", "Small radius curves", "400 m <= radius < 600 m"),
        ("4", "Very small radius curves", "250 m <= radius < 400 m"),
    ]
    .into_iter()
    .map(|(zone, title, condition)| {
        let given: Vec<&SectionResult> =
            sections.iter().filter(|section| section.zone.as_deref() == Some(zone)).collect();
        let used = given.iter().filter(|section| section.used).count();
        ZoneResult {
            zone: zone.into(),
            title: title.into(),
            condition: condition.into(),
            used,
            sites: used,
            given: given.len(),
            minimum: 3,
            holds: used >= 3,
        }
    })
    .collect()
}

fn domain(sections: &[SectionResult]) -> Vec<DomainRange> {
    let mut ranges = Vec::new();
    for (name, unit) in [("speed", "km/h"), ("cant deficiency", "mm"), ("radius", "m")] {
        for scope in ["all", "1", "2", "3", "4"] {
            let values: Vec<f64> = sections
                .iter()
                .filter(|section| {
                    section.used && (scope == "all" || section.zone.as_deref() == Some(scope))
                })
                .filter_map(|section| {
                    section.columns.iter().find(|column| column.name == name)?.value.parse().ok()
                })
                .collect();
            if values.is_empty() {
                continue;
            }
            ranges.push(DomainRange {
                name: name.into(),
                unit: unit.into(),
                scope: if scope == "all" { Scope::default() } else { Scope::zone(scope) },
                low: values.iter().copied().fold(f64::INFINITY, f64::min),
                high: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
                count: values.len(),
            });
        }
    }
    ranges
}

fn traces(noise: &mut Noise) -> Vec<Trace> {
    [
        ("ay_max", "S31", "4", "ay_I", "largest difference of ÿ*_max", "m/s^2"),
        ("Y_max", BREAKOUT, "2", "Y_1L", "largest difference of Y_max", "kN"),
    ]
    .into_iter()
    .map(|(quantity, section, zone, signal, why, unit)| {
        let (start, end) = (31_000.0, 31_085.0);
        let x: Vec<f64> = (0..700).map(|n| start - 30.0 + 145.0 * f64::from(n) / 699.0).collect();
        let wave = |x: f64| {
            (x / 4.0).sin() * 0.5 + (x / 11.0).cos() * 0.7 + if x > 31_020.0 { 0.9 } else { 0.2 }
        };
        let measured = x.iter().map(|x| wave(*x) + 0.12 * noise.bell()).collect();
        let simulated = x.iter().map(|x| 0.9 * wave(*x - 0.8)).collect();
        Trace {
            quantity: quantity.into(),
            section: section.into(),
            zone: Some(zone.into()),
            signal: signal.into(),
            why: why.into(),
            unit: unit.into(),
            axis: "distance".into(),
            axis_unit: "m".into(),
            start,
            end,
            measured: Curve { x: x.clone(), y: measured },
            simulated: Curve { x, y: simulated },
            record: None,
            others: Vec::new(),
        }
    })
    .collect()
}

fn campaign() -> CampaignInfo {
    let hash = |seed: u8| format!("{seed:02x}").repeat(32);
    let mut files = vec![
        FileHash {
            path: "campaign.yaml".into(),
            sha256: hash(1),
            bytes: 412,
            record: None,
            changed: None,
        },
        FileHash {
            path: "vehicle.yaml".into(),
            sha256: hash(2),
            bytes: 268,
            record: None,
            changed: None,
        },
        FileHash {
            path: "sections.csv".into(),
            sha256: hash(3),
            bytes: 2311,
            record: None,
            changed: None,
        },
    ];
    for number in 1..=33_u8 {
        files.push(FileHash {
            path: format!("measurement/S{number:02}.csv"),
            sha256: hash(100 + number),
            bytes: 812_331 + u64::from(number),
            record: None,
            changed: None,
        });
        files.push(FileHash {
            path: format!("simulation/S{number:02}.csv"),
            sha256: hash(150 + number),
            bytes: 903_120 + u64::from(number),
            record: None,
            changed: None,
        });
    }
    CampaignInfo {
        outside_table: Vec::new(),
        members: Vec::new(),
        origin: None,
        name: "Coach, line tests".into(),
        files,
        vehicle: vec![
            item("name", SCRIPT, None),
            item("static_wheel_load", "55", Some("kN")),
            item("running_gear", "bogies", None),
            DataItem { used: false, ..item("owner", EXPRESSION, None) },
        ],
        facts: vec![
            item("sampling_rate", "300", Some("Hz")),
            item("assumed_friction", "0.4", Some("-")),
        ],
        report: Identification::default(),
    }
}

fn protocol() -> ProtocolInfo {
    ProtocolInfo {
        name: "annex_t_variant".into(),
        title: "Model validation, Method 1 with a stricter limit".into(),
        own: None,
        shipped_edition: None,
        parameters_off_default: Vec::new(),
        edition: Some("EN 14363:2016".into()),
        source: Some("EN 14363:2016, Annex T".into()),
        scope: Some("On-track tests of vehicles with bogies".into()),
        notes: vec!["The sum of guiding forces is not filtered before the sliding mean.".into()],
        sha256: "ab".repeat(32),
        files: vec![
            ProtocolFile {
                name: "annex_t_variant.fp".into(),
                attached: "protocol-1-annex_t_variant.fp".into(),
                sha256: "ab".repeat(32),
                text: format!("variant of annex_t\n\nquantity ay_max {{\n\tlimit std 0.40 m/s^2  # {SCRIPT}\n}}\n"),
            },
            ProtocolFile { name: "annex_t.fp".into(), sha256: "cd".repeat(32), attached: "protocol-2-annex_t.fp".into(), text: "protocol annex_t\n".repeat(60) },
        ],
        deviations: vec![
            Deviation { rule: "quantity ay_max, limit std".into(), before: Some("0.8 m/s^2".into()), after: Some("0.4 m/s^2".into()) },
            Deviation { rule: "parameter strict".into(), before: None, after: Some(EXPRESSION.into()) },
        ],
        parameters: vec![ParameterInfo {
            name: "window".into(),
            title: "Length of the sliding mean".into(),
            value: "2 m".into(),
            default: "3 m".into(),
            set_by: "command line".into(),
            unconfirmed: None,
        }],
        filters: vec![FilterInfo {
            name: "low".into(),
            title: "Low-pass".into(),
            steps: "low-pass 20 Hz, Butterworth order 4, zero-phase".into(),
            source: Some("EN 14363:2016".into()),
        }],
        channels: Vec::new(),
        graph_nodes: 42,
        graph_svg: "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"200\" height=\"40\" viewBox=\"0 0 200 40\"><rect x=\"2\" y=\"8\" width=\"80\" height=\"24\" fill=\"none\" stroke=\"#1f242b\"/><text x=\"12\" y=\"24\" font-size=\"11\">channel</text><path d=\"M82 20H118\" stroke=\"#1f242b\"/><rect x=\"118\" y=\"8\" width=\"80\" height=\"24\" fill=\"none\" stroke=\"#1f242b\"/><text x=\"128\" y=\"24\" font-size=\"11\">low-pass</text></svg>".into(),
        verdict_rule: "Every mean and every standard deviation is within its limit, and every zone has at least 3 sections.".into(),
        verdict_words: fishplate::result::VerdictWords::of(fishplate::result::Kind::Validation),
    }
}
