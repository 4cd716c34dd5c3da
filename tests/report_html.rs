//! The figures and the HTML report.
mod common {
    pub mod coach;
}

use common::coach::certification;
use fishplate::report::{figure, html, view};
use fishplate::result::{Certification, QuantityResult, StatisticResult};

/// Writes figures to the folder named by FISHPLATE_FIGURES, to be looked at.
#[test]
fn figures_can_be_looked_at() {
    let Ok(folder) = std::env::var("FISHPLATE_FIGURES") else { return };
    let found = certification();
    let mut drawn = figure::figures(&found);
    drawn.push(("overview-40".into(), figure::overview(&crowd(40, 2))));
    drawn.push(("overview-many".into(), figure::overview(&crowd(9, 8))));
    let zones = figure::Zones::of(&found);
    drawn.push(("pairs-metric".into(), figure::pairs(&metric(&found), &zones)));
    drawn.push(("pairs-one".into(), figure::pairs(&first(&found, 1), &zones)));
    let page = html::html(&view::view(&found), &figure::figures(&found)).expect("the templates can be filled");
    std::fs::write(std::path::Path::new(&folder).join("report.html"), page).expect("the folder can be written");
    for (name, svg) in &drawn {
        std::fs::write(std::path::Path::new(&folder).join(format!("{name}.svg")), svg).expect("the folder can be written");
    }
}

/// So many quantities with so many statistics, some far beyond their limits, some missing.
fn crowd(quantities: usize, statistics: usize) -> Vec<QuantityResult> {
    let template = certification().quantities[0].clone();
    (0..quantities)
        .map(|n| {
            let mut quantity = template.clone();
            quantity.symbol = format!("quantity with a long name {n}");
            quantity.statistics = (0..statistics)
                .map(|at| {
                    let mut one = template.statistics[at % 2].clone();
                    if at > 1 {
                        one.scope = format!("zone {}", at / 2);
                    }
                    let value = ((n * 7 + at * 3) % 11) as f64 / 8.0
                        * if n == 3 {
                            -40.0
                        } else if n == 5 {
                            900.0
                        } else {
                            1.0
                        };
                    let missing = n == 4 && at == 0;
                    one.value = (!missing).then_some(value);
                    one.normalised = one.value.map(f64::abs);
                    one.holds = one.normalised.map(|value| value <= 1.0);
                    one
                })
                .collect();
            quantity.holds = quantity.statistics.iter().map(|one| one.holds).reduce(|a, b| Some(a? && b?)).flatten();
            quantity
        })
        .collect()
}

/// One number per pair, judged zone by zone.
fn metric(found: &Certification) -> QuantityResult {
    let mut quantity = found.quantities[8].clone();
    quantity.has_sides = false;
    quantity.unit = "-".into();
    for pair in &mut quantity.values {
        (pair.simulated, pair.measured, pair.difference) = (None, None, 0.2 + pair.difference.abs());
    }
    let template = quantity.statistics[0].clone();
    quantity.statistics = (1..=4)
        .map(|zone| StatisticResult {
            name: "p95".into(),
            title: "95 % value".into(),
            scope: format!("zone {zone}"),
            unit: "-".into(),
            value: Some(0.25 + 0.01 * f64::from(zone)),
            limit: Some(0.3),
            ..template.clone()
        })
        .collect();
    quantity
}

fn first(found: &Certification, pairs: usize) -> QuantityResult {
    let mut quantity = found.quantities[0].clone();
    quantity.values.truncate(pairs);
    quantity
}
