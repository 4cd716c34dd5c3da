//! Properties of the sections over which differences and sizes may vary.

use crate::diagnose::observe::observations::Observations;
use crate::diagnose::settings::{INVERSE, Settings};

/// The covariate whose values are words.
pub const DIRECTION: &str = "the direction of the curve";

/// A property that varies between sections.
#[derive(Debug)]
pub struct Covariate {
    pub name: String,
    /// By section, scaled to 0 at its minimum and 1 at its maximum.
    pub values: Vec<f64>,
    /// The table's text for the minimum and the maximum.
    pub ends: [String; 2],
    /// That for the minimum without its unit, where the maximum has one.
    pub from: String,
}

/// Covariates: the order of the sections, the direction of the curve, and the columns that the
/// catalogue lists.
pub fn covariates(settings: &Settings, seen: &Observations) -> Vec<Covariate> {
    let sections = || seen.sections.iter().map(|observed| &observed.section);
    let order = (0..seen.sections.len()).map(|at| at as f64).collect();
    let mut all = vec![scaled("the order of the sections", order, &|at, _| {
        Some(seen.sections[at].section.name().to_string())
    })];
    if let Some((column, _)) = &settings.mirror {
        let text = |at: usize, _| seen.sections[at].section.fact(column).map(str::to_owned);
        all.push(scaled(
            DIRECTION,
            sections().map(|section| settings.side(section)).collect(),
            &text,
        ));
    }
    for name in &settings.covariates {
        let column = name.strip_prefix(INVERSE).unwrap_or(name);
        let inverse = column.len() < name.len();
        // A section without a radius is straight: 1 / radius = 0.
        let number = |number: Option<f64>| {
            if inverse { Some(number.map_or(0.0, |number| 1.0 / number)) } else { number }
        };
        let text = |at: usize, with_unit: bool| {
            let section = &seen.sections[at].section;
            let says = if with_unit {
                section.says(column).unwrap_or_else(|| format!("no {column}"))
            } else {
                section.says_without_unit(column)?
            };
            // A number includes its column name; for a reciprocal the original value is given.
            Some(says.strip_prefix(&format!("{name} ")).unwrap_or(&says).to_string())
        };
        if let Some(values) =
            sections().map(|section| number(section.number(column))).collect::<Option<Vec<f64>>>()
        {
            all.push(scaled(name, values, &text));
        }
    }
    all.into_iter().flatten().collect()
}

/// A covariate scaled to its range; nothing if it is constant.
fn scaled(
    name: &str,
    values: Vec<f64>,
    text: &dyn Fn(usize, bool) -> Option<String>,
) -> Option<Covariate> {
    let by_value = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]);
    let (least, most) = ((0..values.len()).min_by(by_value)?, (0..values.len()).max_by(by_value)?);
    let range = values[most] - values[least];
    let scale = |value: &f64| (value - values[least]) / range;
    let ends = [least, most].map(|at| text(at, true).unwrap_or_default());
    let numbers = text(least, false).filter(|_| text(most, false).is_some());
    (range > 0.0 && range.is_finite()).then(|| Covariate {
        name: name.into(),
        values: values.iter().map(scale).collect(),
        from: numbers.unwrap_or_else(|| ends[0].clone()),
        ends,
    })
}
