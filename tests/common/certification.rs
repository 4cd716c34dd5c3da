//! A made-up certification as rich as a real one: 12 quantities, 33 sections in 4 zones, one
//! failing, one not assessable, names nobody would choose. The numbers come from a fixed recurrence
//! and mean nothing.

use fishplate::result::Reason;
use fishplate::result::*;
use fishplate::result::{
    FORMAT, Figures, Identification, ProtocolFile, Scope, StatisticName, THIS,
};

/// A name that would be markup in Typst, HTML or a template, if it were not treated as data.
pub const HOSTILE: &str = "#panic(\"x\") *bold* $a_1$ <script>alert(1)</script> {{ 7 * 7 }} {% raw %} \\u{41} @ref `code` [x] // y";
/// Unbroken, wider than any cell.
pub const LONG: &str =
    "Versuchstraegerdrehgestellradsatzlagerfuehrungsquerbeschleunigungsaufnehmerkanalbezeichnung";
/// Signs no font of the report has, a change of writing direction, a control character.
pub const STRANGE: &str = "中文 🚆 \u{202e}gnp.exe\u{0007} ᚠ שלום مرحبا e\u{301} \u{e000}\u{feff}";

struct Noise(u64);

impl Noise {
    /// Uniform in -1..1.
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 / (1_u64 << 53) as f64) * 2.0 - 1.0
    }
}

struct Kind {
    id: &'static str,
    title: &'static str,
    symbol: &'static str,
    unit: &'static str,
    filter: &'static str,
    processing: &'static str,
    limit: f64,
    size: f64,
    signals: &'static [&'static str],
}

const WHEELS: &[&str] = &["1R", "1L", "3R", "3L"];
const SETS: &[&str] = &["wheelset 1", "wheelset 3"];
const ENDS: &[&str] = &["I", "II"];
const LOW: &str = "low-pass 20 Hz";
const BAND: &str = "band-pass 0.4 to 10 Hz";
const MOST: &str = "larger of |p0.15|, |p99.85|";
const SLIDING: &str = "sliding mean 2 m, step 0.5 m";

#[rustfmt::skip]
const KINDS: &[Kind] = &[
    Kind { id: "Y_qst", title: "Guiding force, quasi-static", symbol: "Yqst", unit: "kN", filter: LOW, processing: "median", limit: 5.0, size: 20.0, signals: WHEELS },
    Kind { id: "Q_qst", title: "Vertical wheel force, quasi-static", symbol: "Qqst", unit: "kN", filter: LOW, processing: "median", limit: 6.18, size: 60.0, signals: WHEELS },
    Kind { id: "YQ_qst", title: "Ratio of guiding to vertical force, quasi-static", symbol: "(Y/Q)qst", unit: "-", filter: LOW, processing: "median", limit: 0.07, size: 0.3, signals: WHEELS },
    Kind { id: "SigmaY_qst", title: "Sum of guiding forces of a wheelset, quasi-static", symbol: "ΣYqst", unit: "kN", filter: LOW, processing: "median", limit: 6.0, size: 25.0, signals: SETS },
    Kind { id: "Y_max", title: "Guiding force, maximum", symbol: "Ymax", unit: "kN", filter: LOW, processing: MOST, limit: 9.0, size: 35.0, signals: WHEELS },
    Kind { id: "Q_max", title: "Vertical wheel force, maximum", symbol: "Qmax", unit: "kN", filter: LOW, processing: "p99.85", limit: 9.27, size: 80.0, signals: WHEELS },
    Kind { id: "YQ_max", title: "Ratio of guiding to vertical force, maximum", symbol: "(Y/Q)max", unit: "-", filter: SLIDING, processing: MOST, limit: 0.10, size: 0.5, signals: WHEELS },
    Kind { id: "SigmaY_max", title: "Sum of guiding forces of a wheelset, maximum", symbol: "ΣYmax", unit: "kN", filter: SLIDING, processing: MOST, limit: 9.0, size: 30.0, signals: SETS },
    Kind { id: "ay_rms", title: "Lateral acceleration of the car body, rms", symbol: "ÿ*rms", unit: "m/s^2", filter: BAND, processing: "rms", limit: 0.15, size: 0.2, signals: ENDS },
    Kind { id: "az_rms", title: "Vertical acceleration of the car body, rms", symbol: "z̈*rms", unit: "m/s^2", filter: BAND, processing: "rms", limit: 0.15, size: 0.25, signals: ENDS },
    Kind { id: "ay_max", title: "Lateral acceleration of the car body, maximum", symbol: "ÿ*max", unit: "m/s^2", filter: BAND, processing: MOST, limit: 0.40, size: 0.7, signals: ENDS },
    Kind { id: "az_max", title: "Vertical acceleration of the car body, maximum", symbol: "z̈*max", unit: "m/s^2", filter: BAND, processing: MOST, limit: 0.40, size: 0.8, signals: ENDS },
];

/// The made-up certification.
pub fn certification() -> Certification {
    let mut noise = Noise(7);
    let sections = sections(&mut noise);
    let mut quantities: Vec<QuantityResult> =
        KINDS.iter().map(|kind| quantity(kind, &sections, &mut noise)).collect();
    make_unassessable(&mut quantities[9]);
    quantities.push(metric(&sections, &mut noise));
    let mut reasons: Vec<Reason> =
        quantities
            .iter()
            .flat_map(|quantity| {
                let symbol = quantity.symbol.clone();
                quantity.statistics.iter().filter(|one| one.holds == Some(false)).map(move |one| {
                    Reason::said(format!("{symbol}: {} beyond its limit", one.title))
                })
            })
            .collect();
    reasons.push(Reason::said(format!(
        "z̈*rms is not assessable: channel {LONG} has samples that are no numbers"
    )));
    let traces = (0..6).map(|at| trace(at, &quantities[at], &mut noise)).collect();
    Certification {
        outcome: None,
        fishplate: THIS.into(),
        format: FORMAT,
        language: "en".into(),
        template: None,
        verdict_text: "not validated".into(),
        protocol: protocol(),
        campaign: campaign(&sections),
        verdict: Verdict::NotValidated,
        own_word: None,
        verdict_note: None,
        provisional: Vec::new(),
        confirmed: Vec::new(),
        draft: false,
        removed: Removed::default(),
        deviations: Vec::new(),
        reasons,
        verdicts: Vec::new(),
        drawn: Vec::new(),
        quantities,
        found: Vec::new(),
        reduction: None,
        zones: zones(&sections),
        reported: Vec::new(),
        domain: domain(),
        application: application(),
        sections,
        traces,
        findings: Vec::new(),
        notes: vec![
            Remark::Said { says: "Section S07: 3.1 s of record before the section; the band-pass needs 5 s to settle.".into() },
            Remark::Said { says: format!("Column `{HOSTILE}` of sections.csv is not used.") },
        ],
    }
}

/// Some of what a report is known by: stated, not stated, and text that nobody would state.
fn report() -> Vec<ReportItem> {
    let item = |path: &[&str], title: &str, clause: Option<&str>, value: Option<&str>| ReportItem {
        path: path.iter().map(ToString::to_string).collect(),
        title: title.into(),
        clause: clause.map(Into::into),
        value: value.map(Into::into),
    };
    vec![
        item(&["number"], "Report number", Some("7.8.2.1 d)"), Some("R-2023-17")),
        item(&["revision"], "Revision", Some("7.8.8"), Some("B")),
        item(&["customer"], "Customer", Some("7.8.2.1 e)"), Some(HOSTILE)),
        item(&["laboratory"], "Laboratory", Some("7.8.2.1 b)"), None),
        item(
            &["test item", "vehicle number"],
            "Test item: vehicle number",
            Some("7.8.2.1 g)"),
            Some(LONG),
        ),
        item(&["dates", "issue"], "Date of issue", Some("7.8.2.1 j)"), Some("2023-06-30")),
        item(&["model version"], "Model version", None, None),
    ]
}

/// Wanted operation with a hull, and of a group without sections.
fn application() -> Vec<DomainResult> {
    let coordinates = |ends: Option<(f64, f64)>| {
        let of = |name: &str, unit: &str| CoordinateRange {
            name: name.into(),
            unit: unit.into(),
            low: ends.map(|(low, _)| low),
            high: ends.map(|(_, high)| high),
        };
        vec![of("Speed", "km/h"), of(HOSTILE, "mm"), of("Curvature", "1/km")]
    };
    let section = |section: &str, values: [f64; 3]| DomainSection {
        section: section.into(),
        values: values.to_vec(),
        corner: true,
    };
    let point = |point: &str, inside: Option<bool>, by: f64| WantedPoint {
        point: point.into(),
        values: vec![50.0 + by, 50.0, 20.0],
        inside,
        distance: inside.map(|_| by.abs() / 100.0),
        nearest: inside.map(|_| vec![50.0, 50.0, 20.0]),
        outside_by: inside.map(|_| vec![by, 0.0, 0.0]),
        beyond_range: Some(vec![0.0; 3]),
        nearest_section: inside.map(|_| "S01".into()),
        section_distance: inside.map(|_| 0.1),
    };
    let one = |scope: &str,
               sections: Vec<DomainSection>,
               reason: Option<&str>,
               points: Vec<WantedPoint>| DomainResult {
        domain: "application".into(),
        title: "Application domain".into(),
        group: [("state".to_string(), scope.to_string())].into_iter().collect(),
        scope: format!("State {scope}"),
        coordinates: coordinates((!sections.is_empty()).then_some((0.0, 100.0))),
        sections,
        left_out: vec![LONG.into()],
        reason: reason.map(Reason::said),
        points,
        otherwise: Consequence::Note,
        clause: Some("T.3".into()),
        source: None,
        notes: vec![HOSTILE.into()],
        rule: RulePlace { file: "protocol.fp".into(), line: 7 },
    };
    let corners = [
        [0.0, 0.0, 0.0],
        [100.0, 0.0, 0.0],
        [0.0, 100.0, 0.0],
        [0.0, 0.0, 100.0],
        [100.0, 100.0, 100.0],
    ];
    let sections = corners
        .into_iter()
        .enumerate()
        .map(|(at, values)| section(&format!("S{at:02}"), values))
        .collect();
    let points = vec![
        point("inside", Some(true), 0.0),
        point(HOSTILE, Some(false), 30.0),
        point(LONG, Some(false), -1e-7),
    ];
    vec![
        one("tare", sections, None, points),
        one(HOSTILE, Vec::new(), Some("no section is used"), vec![point("none", None, 0.0)]),
    ]
}

/// A certification without anything in it.
pub fn empty() -> Certification {
    Certification {
        outcome: None,
        fishplate: THIS.into(),
        format: FORMAT,
        language: "en".into(),
        template: None,
        verdict_text: "not assessable".into(),
        protocol: ProtocolInfo {
            name: "empty".into(),
            title: String::new(),
            own: None,
            shipped_edition: None,
            parameters_off_default: Vec::new(),
            edition: None,
            source: None,
            scope: None,
            notes: Vec::new(),
            sha256: String::new(),
            files: Vec::new(),
            deviations: Vec::new(),
            parameters: Vec::new(),
            filters: Vec::new(),
            channels: Vec::new(),
            graph_nodes: 0,
            graph_svg: String::new(),
            verdict_rule: String::new(),
            verdict_words: fishplate::result::VerdictWords::of(fishplate::result::Kind::Validation),
        },
        campaign: CampaignInfo {
            members: Vec::new(),
            name: String::new(),
            files: Vec::new(),
            vehicle: Vec::new(),
            facts: Vec::new(),
            outside_table: Vec::new(),
            report: Identification::default(),
            origin: None,
        },
        verdict: Verdict::NotAssessable,
        own_word: None,
        verdict_note: None,
        provisional: Vec::new(),
        confirmed: Vec::new(),
        draft: false,
        removed: Removed::default(),
        deviations: Vec::new(),
        reasons: Vec::new(),
        verdicts: Vec::new(),
        drawn: Vec::new(),
        quantities: Vec::new(),
        sections: Vec::new(),
        reported: Vec::new(),
        found: Vec::new(),
        reduction: None,
        zones: Vec::new(),
        domain: Vec::new(),
        application: Vec::new(),
        traces: Vec::new(),
        findings: Vec::new(),
        notes: Vec::new(),
    }
}

fn drawing(name: &str, width: u32, height: u32) -> String {
    let mut noise = Noise(name.len() as u64);
    let points: Vec<String> = (0..800)
        .map(|x| {
            format!(
                "{:.2},{:.2}",
                40.0 + f64::from(x) * f64::from(width - 60) / 800.0,
                f64::from(height) / 2.0 + 60.0 * noise.next()
            )
        })
        .collect();
    format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" font-family="IBM Plex Sans" font-size="12"><rect x="40" y="10" width="{}" height="{}" fill="none" stroke="#888"/><polyline fill="none" stroke="#1f3a5f" stroke-width="0.7" points="{}"/><text x="50" y="30">{name}: 中 simulated [kN]</text></svg>"##,
        width - 60,
        height - 50,
        points.join(" ")
    )
}

fn sections(noise: &mut Noise) -> Vec<SectionResult> {
    (0..33)
        .map(|at| {
            let zone = at % 4 + 1;
            let length = [250.0, 100.0, 100.0, 70.0][at % 4] + 20.0 + 15.0 * noise.next();
            let start = 1200.0 + 431.7 * at as f64;
            let used = at != 5 && at != 18;
            let radius = ["", "3200", "512.5", "287"][at % 4];
            let column = |name: &str, value: String, unit: &str| DataItem {
                name: name.into(),
                value,
                unit: Some(unit.into()),
                used: true,
                unit_assumed: false,
                of: None,
            };
            SectionResult {
                campaign: None,
                vehicle: None,
                section: if at == 12 {
                    "S13_Brescia-Verona_up_line_2023-05-04_run07".into()
                } else {
                    format!("S{:02}", at + 1)
                },
                site: String::new(),
                zone: Some(zone.to_string()),
                used,
                reason: match at {
                    5 => Some(Reason::said("measured Q_1R has 12 samples that are no numbers")),
                    18 => Some(Reason::said(HOSTILE)),
                    _ => None,
                },
                length,
                start,
                end: start + length,
                axis_unit: "m".into(),
                columns: vec![
                    column("radius", radius.into(), "m"),
                    column("direction", ["straight", "right", "left", "right"][at % 4].into(), "-"),
                    column("cant", format!("{:.0}", 70.0 + 40.0 * noise.next()), "mm"),
                    column("cant deficiency", format!("{:.1}", 80.0 + 60.0 * noise.next()), "mm"),
                    column("speed", format!("{:.1}", 110.0 + 30.0 * noise.next()), "km/h"),
                ],
                checks: vec![
                    CheckResult {
                        name: "length".into(),
                        title: "Length".into(),
                        holds: Some(true),
                        says: Reason::said(format!("{length:.0} m, at least 70 m")),
                    },
                    CheckResult {
                        name: "deficiency".into(),
                        title: "Cant deficiency within the zone's range".into(),
                        holds: if at == 7 { None } else { Some(at != 18) },
                        says: Reason::said("cant deficiency 112.4 mm, 75 mm to 165 mm"),
                    },
                    CheckResult {
                        name: "margin".into(),
                        title: "Record around the section".into(),
                        holds: Some(true),
                        says: Reason::said("31 m before, 38 m after"),
                    },
                ],
            }
        })
        .collect()
}

fn quantity(kind: &Kind, sections: &[SectionResult], noise: &mut Noise) -> QuantityResult {
    let wide = if kind.id == "Y_max" { 2.4 } else { 0.9 };
    let mut values = Vec::new();
    for section in sections.iter().filter(|section| section.used) {
        for signal in kind.signals {
            let measured = kind.size
                * (0.6 + 0.4 * noise.next())
                * if kind.processing == "median" && section.section.len() % 2 == 1 {
                    -1.0
                } else {
                    1.0
                };
            let difference = kind.limit * wide * noise.next();
            values.push(PairValue {
                campaign: None,
                taken: None,
                record: None,
                section: section.section.clone(),
                zone: section.zone.clone(),
                signal: if kind.signals == WHEELS {
                    format!("{}_{signal}", kind.id.split('_').next().unwrap_or(""))
                } else {
                    (*signal).to_owned()
                },
                simulated: Some(measured + difference),
                measured: Some(measured),
                difference,
                samples: 1840,
                limit: None,
                ratio: None,
            });
        }
    }
    let n = values.len() as f64;
    let mean = values.iter().map(|pair| pair.difference).sum::<f64>() / n;
    let std = (values.iter().map(|pair| (pair.difference - mean).powi(2)).sum::<f64>() / (n - 1.0))
        .sqrt();
    let statistic = |name: &str, title: &str, value: f64, limit: f64, text: &str| StatisticResult {
        name: name.to_string().into(),
        title: title.into(),
        scope: Scope::default(),
        group: Vec::new(),
        count: values.len(),
        n: values.len() / 2,
        unit: kind.unit.into(),
        value: Some(value),
        interval: Some((value - 0.1 * limit, value + 0.1 * limit)),
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
    let statistics = vec![
        statistic("std", "standard deviation (n-1)", std, kind.limit, "see Table 1, footnote **"),
        statistic("mean", "mean", mean, kind.limit * 2.0 / 3.0, "2/3 of std"),
    ];
    QuantityResult {
        outcome: None,
        from: None,
        among: None,
        repeats: false,
        spread: None,
        against: None,
        id: kind.id.into(),
        title: kind.title.into(),
        symbol: kind.symbol.into(),
        unit: kind.unit.into(),
        of: "wheels of wheelsets 1 and 3".into(),
        filter: kind.filter.into(),
        processing: kind.processing.into(),
        comparison: "simulated - measured, sign of measured".into(),
        clause: Some("Table 1, row 5".into()),
        source: Some("Götz and Polach, Verification and validation of simulations in a rail vehicle certification context, 2018".into()),
        notes: if kind.id == "Y_qst" { vec!["Signs: positive differences mean a larger simulated magnitude.".into()] } else { Vec::new() },
        pairs: 0,
        figures: Figures::default(),
        groups: None,
        has_sides: true,
        holds: Some(statistics.iter().all(|one| one.holds == Some(true))),
        statistics,
        reported: Vec::new(),
        n: values.len() / 2,
        values,
        reason: None,
        rule: RulePlace { file: "annex-t.fp".into(), line: 345 },
    }
}

fn make_unassessable(quantity: &mut QuantityResult) {
    quantity.values.clear();
    quantity.holds = None;
    quantity.reason = Some(Reason::said(format!("channel {LONG} has samples that are no numbers")));
    for statistic in &mut quantity.statistics {
        *statistic = StatisticResult {
            count: 0,
            n: 0,
            value: None,
            interval: None,
            normalised: None,
            holds: None,
            reason: Some(Reason::said("no pairs")),
            ..statistic.clone()
        };
    }
}

/// A quantity of another kind: one number for two signals, judged zone by zone.
fn metric(sections: &[SectionResult], noise: &mut Noise) -> QuantityResult {
    let values: Vec<PairValue> = sections
        .iter()
        .filter(|section| section.used)
        .flat_map(|section| {
            let value = 0.15 + 0.1 * noise.next();
            [LONG, "ay_II"].map(|signal| PairValue {
                campaign: None,
                taken: None,
                record: None,
                section: section.section.clone(),
                zone: section.zone.clone(),
                signal: signal.into(),
                simulated: None,
                measured: None,
                difference: value,
                samples: 12_840,
                limit: None,
                ratio: None,
            })
        })
        .collect();
    let statistics = (1..=4)
        .map(|zone| StatisticResult {
            name: StatisticName::Percentile(95.0),
            title: "95 % value".into(),
            scope: Scope::zone(&zone.to_string()),
            group: Vec::new(),
            count: 16,
            n: 8,
            unit: "-".into(),
            value: Some(0.2 + 0.01 * f64::from(zone)),
            interval: None,
            marginal: false,
            limit: Some(0.3),
            normalised: Some((0.2 + 0.01 * f64::from(zone)) / 0.3),
            sample: Sample::default(),
            regression: None,
            divided_at: None,
            outside: Vec::new(),
            beyond: None,
            direction: fishplate::result::Direction::Magnitude,
            edges: Vec::new(),
            holds: Some(true),
            factors: Vec::new(),
            limit_text: "0.3".into(),
            limit_printed: "0.3".into(),
            reason: None,
            rule: RulePlace { file: "annex-t.fp".into(), line: 345 },
        })
        .collect();
    QuantityResult {
        outcome: None,
        from: None,
        among: None,
        repeats: false,
        reported: Vec::new(),
        spread: None,
        against: None,
        id: "sprague_geers_ay".into(),
        title: format!("Sprague-Geers metric {HOSTILE}"),
        symbol: STRANGE.into(),
        unit: "-".into(),
        of: "lateral accelerations I and II".into(),
        filter: "none".into(),
        processing: "none".into(),
        comparison: "Sprague-Geers combined error".into(),
        clause: None,
        source: None,
        notes: Vec::new(),
        has_sides: false,
        pairs: 0,
        figures: Figures::default(),
        groups: None,
        statistics,
        n: values.len() / 2,
        values,
        holds: Some(true),
        reason: None,
        rule: RulePlace { file: "annex-t.fp".into(), line: 345 },
    }
}

fn zones(sections: &[SectionResult]) -> Vec<ZoneResult> {
    [
        ("Straight track and very large radius", "radius at least 2500 m or straight"),
        ("Large radius curves", "600 m < radius, full curve"),
        ("Small radius curves", "400 m <= radius <= 600 m"),
        ("Very small radius curves", "250 m <= radius < 400 m"),
    ]
    .iter()
    .enumerate()
    .map(|(at, (title, condition))| {
        let own: Vec<&SectionResult> = sections
            .iter()
            .filter(|section| section.zone.as_deref() == Some(&(at + 1).to_string()))
            .collect();
        let used = own.iter().filter(|section| section.used).count();
        ZoneResult {
            zone: (at + 1).to_string(),
            title: (*title).into(),
            condition: (*condition).into(),
            used,
            sites: used,
            given: own.len(),
            minimum: 3,
            holds: used >= 3,
        }
    })
    .collect()
}

fn domain() -> Vec<DomainRange> {
    let range = |name: &str, unit: &str, scope: &str, low: f64, high: f64| DomainRange {
        name: name.into(),
        unit: unit.into(),
        scope: if scope == "all" { Scope::default() } else { Scope::zone(scope) },
        low,
        high,
        count: 31,
    };
    let mut all = Vec::new();
    for (name, unit, low, high) in [
        ("radius", "m", 287.0, 3200.0),
        ("cant", "mm", 31.0, 109.0),
        ("cant deficiency", "mm", 21.4, 138.9),
        ("speed", "km/h", 80.2, 139.6),
    ] {
        for scope in ["all", "1", "2", "3", "4"] {
            all.push(range(name, unit, scope, low, high));
        }
    }
    all
}

fn trace(at: usize, quantity: &QuantityResult, noise: &mut Noise) -> Trace {
    let pair = quantity.values.get(at);
    let curve = |noise: &mut Noise| Curve {
        x: (0..500).map(|i| f64::from(i) * 0.5).collect(),
        y: (0..500).map(|_| noise.next()).collect(),
    };
    Trace {
        quantity: quantity.id.clone(),
        section: pair.map_or_else(String::new, |pair| pair.section.clone()),
        zone: pair.and_then(|pair| pair.zone.clone()),
        signal: pair.map_or_else(String::new, |pair| pair.signal.clone()),
        why: format!("largest difference of {}", quantity.symbol),
        unit: quantity.unit.clone(),
        axis: "distance".into(),
        axis_unit: "m".into(),
        start: 30.0,
        end: 220.0,
        measured: curve(noise),
        simulated: curve(noise),
        record: None,
        others: Vec::new(),
    }
}

fn campaign(sections: &[SectionResult]) -> CampaignInfo {
    let item = |name: &str, value: &str, unit: Option<&str>, used: bool| DataItem {
        name: name.into(),
        value: value.into(),
        unit: unit.map(Into::into),
        used,
        unit_assumed: false,
        of: None,
    };
    let hash = |at: usize| {
        format!("{:064x}", (at as u128 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15_f39c_c060_5ced_c835))
    };
    let mut files: Vec<FileHash> = ["campaign.yaml", "vehicle.yaml", "sections.csv"]
        .iter()
        .enumerate()
        .map(|(at, path)| FileHash {
            path: (*path).into(),
            sha256: hash(at),
            bytes: 2_311 + at as u64,
            record: None,
            changed: None,
        })
        .collect();
    for (at, section) in sections.iter().enumerate() {
        for (side, folder) in ["simulation", "measurement"].iter().enumerate() {
            files.push(FileHash {
                path: format!("{folder}/{}.csv", section.section),
                sha256: hash(10 + 2 * at + side),
                bytes: 1_204_511 + at as u64,
                record: None,
                changed: None,
            });
        }
    }
    CampaignInfo {
        outside_table: Vec::new(),
        members: Vec::new(),
        origin: None,
        name: "On-track tests of the coach, spring 2023".into(),
        files,
        vehicle: vec![
            item("name", HOSTILE, None, true),
            item("category", "passenger", None, true),
            item("running_gear", "bogies", None, true),
            item("secondary_suspension", "true", None, true),
            item("static_wheel_load", "54.5", Some("kN"), true),
            item("car body mass", "32000", Some("kg"), false),
            item("bogie spacing", "-19.0", Some("m"), false),
            item(LONG, STRANGE, Some("kN/m"), false),
        ],
        facts: vec![
            item("sampling_rate", "200", Some("Hz"), false),
            item("assumed_friction", "0.4", Some("-"), false),
            item("simulation_ran_on", "nominal track, measured irregularities", None, false),
        ],
        report: Identification(report()),
    }
}

fn protocol() -> ProtocolInfo {
    let text: String = (1..=170)
        .map(|line| match line % 8 {
            1 => format!("quantity q{line} \"Guiding force\" {{\n"),
            0 => "}\n".to_owned(),
            5 => "\tnote \"#panic(1) *not bold* a line that is much longer than the others, so long that it cannot stand on one line of the page and wraps\"\n".to_owned(),
            _ => format!("    limit std {line} kN    # comment {line}\n"),
        })
        .collect();
    let file = |name: &str, text: String| ProtocolFile {
        name: name.into(),
        sha256: "ab".repeat(32),
        attached: ProtocolFile::attachment(0, name),
        text,
    };
    ProtocolInfo {
        name: "en14363-2016-annex-t-coach".into(),
        title: "EN 14363:2016, Annex T, with a tighter limit".into(),
        own: None,
        shipped_edition: None,
        parameters_off_default: Vec::new(),
        edition: Some("EN 14363:2016".into()),
        source: Some("Götz and Polach 2018, Table 1".into()),
        scope: Some(
            "Passenger coaches with bogies.\nForces measured by instrumented wheelsets.".into(),
        ),
        notes: vec!["Standard deviation with n-1.".into()],
        sha256: "ab".repeat(32),
        files: vec![
            file("coach.fp", text),
            file("protocols/en14363-2016-annex-t.fp", "protocol \"parent\"\n".into()),
        ],
        deviations: vec![
            Deviation {
                rule: "quantity ay_max, limit std".into(),
                before: Some("0.40 m/s^2".into()),
                after: Some("0.35 m/s^2".into()),
            },
            Deviation { rule: "quantity bogie".into(), before: None, after: Some(HOSTILE.into()) },
            Deviation {
                rule: "zone 4, minimum length".into(),
                before: Some("70 m".into()),
                after: None,
            },
        ],
        parameters: vec![
            ParameterInfo {
                name: "cutoff".into(),
                title: "cut-off of the low-pass".into(),
                value: "20 Hz".into(),
                default: "20 Hz".into(),
                set_by: "default".into(),
                unconfirmed: Some(HOSTILE.into()),
            },
            ParameterInfo {
                name: LONG.into(),
                title: HOSTILE.into(),
                value: "2.5 m".into(),
                default: "2 m".into(),
                set_by: "command line".into(),
                unconfirmed: None,
            },
        ],
        filters: vec![
            FilterInfo {
                name: "low".into(),
                title: "low-pass".into(),
                steps: "low-pass 20 Hz, Butterworth order 4, zero-phase".into(),
                source: None,
            },
            FilterInfo {
                name: "ride".into(),
                title: "band-pass".into(),
                steps: "band-pass 0.4 Hz to 10 Hz, Butterworth 4 poles per edge, zero-phase".into(),
                source: Some("EN 14363, 7.4".into()),
            },
        ],
        channels: vec![ChannelInfo {
            name: "Y".into(),
            title: "Guiding force".into(),
            unit: "kN".into(),
            note: HOSTILE.into(),
        }],
        graph_nodes: 96,
        graph_svg: drawing("graph", 1400, 600),
        verdict_rule:
            "every statistic of every quantity holds, and every zone has at least 3 sections".into(),
        verdict_words: fishplate::result::VerdictWords::of(fishplate::result::Kind::Validation),
    }
}
