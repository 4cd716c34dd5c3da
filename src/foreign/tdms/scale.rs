//! Scaling of values that a card wrote as integers: `NI_Scale[0]_Linear_Slope` and the like.

use indexmap::IndexMap;

use super::value::Property;

/// Most scales and coefficients of a channel; a card has one or two scales and a polynomial of the
/// third degree.
const MOST: usize = 16;

/// The source of a scale that takes the raw values.
const RAW: f64 = u32::MAX as f64;

/// Applies the scales of a channel, unless its values are scaled.
///
/// # Errors
/// A kind of scale that is not known: the values would be wrong.
pub fn apply(properties: &IndexMap<String, Property>, values: &mut [f64]) -> Result<(), String> {
    let number = |name: String| properties.get(&name).and_then(Property::number);
    let text = |name: String| match properties.get(&name) {
        Some(Property::Text(text)) => Some(text.as_str()),
        _ => None,
    };
    let count = number("NI_Number_Of_Scales".into()).unwrap_or(0.0) as usize;
    let unscaled = text("NI_Scaling_Status".into()).is_none_or(|status| status == "unscaled");
    if count == 0 || !unscaled {
        return Ok(());
    }
    if count > MOST {
        return Err(format!("it has {count} scales"));
    }
    // The last scale makes the values; each says which one it takes them from.
    let (mut chain, mut next) = (Vec::new(), Some(count - 1));
    while let Some(scale) = next {
        // A scale without a type belongs to the raw values.
        let Some(kind) = text(format!("NI_Scale[{scale}]_Scale_Type")) else { break };
        chain.push((scale, kind));
        let source = number(format!("NI_Scale[{scale}]_{kind}_Input_Source"));
        next = source.filter(|source| *source != RAW).map(|source| source as usize);
        if next.is_some_and(|next| next >= scale) {
            return Err(format!("its scale {scale} takes its values from a later one"));
        }
    }
    for (scale, kind) in chain.into_iter().rev() {
        let name = |rest: &str| format!("NI_Scale[{scale}]_{rest}");
        match kind {
            "Linear" => {
                let slope = number(name("Linear_Slope")).ok_or("its linear scale has no slope")?;
                let intercept = number(name("Linear_Y_Intercept"))
                    .ok_or("its linear scale has no intercept")?;
                values.iter_mut().for_each(|value| *value = slope * *value + intercept);
            }
            "Polynomial" => {
                let size = number(name("Polynomial_Coefficients_Size")).unwrap_or(4.0) as usize;
                if size > MOST {
                    return Err(format!(
                        "its polynomial has {size} coefficients; at most {MOST} are read"
                    ));
                }
                let coefficients: Option<Vec<f64>> = (0..size)
                    .map(|at| number(name(&format!("Polynomial_Coefficients[{at}]"))))
                    .collect();
                let coefficients = coefficients.ok_or("its polynomial lacks a coefficient")?;
                values.iter_mut().for_each(|value| {
                    *value =
                        coefficients.iter().rev().fold(0.0, |sum, factor| sum * *value + factor)
                });
            }
            other => {
                return Err(format!(
                    "its raw values need a scale of the type `{other}`; save them scaled"
                ));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn properties(list: &[(&str, f64)], kind: &str) -> IndexMap<String, Property> {
        let mut all: IndexMap<String, Property> = list
            .iter()
            .map(|(name, value)| ((*name).to_string(), Property::Number(*value)))
            .collect();
        all.insert("NI_Scale[0]_Scale_Type".into(), Property::Text(kind.into()));
        all.insert("NI_Number_Of_Scales".into(), Property::Number(1.0));
        all.insert("NI_Scaling_Status".into(), Property::Text("unscaled".into()));
        all
    }

    #[test]
    fn scales_are_applied_or_refused() {
        let mut values = [1.0, 2.0];
        let linear = properties(
            &[("NI_Scale[0]_Linear_Slope", 2.0), ("NI_Scale[0]_Linear_Y_Intercept", -1.0)],
            "Linear",
        );
        assert_eq!((apply(&linear, &mut values), values), (Ok(()), [1.0, 3.0]));
        let list = [
            ("NI_Scale[0]_Polynomial_Coefficients_Size", 3.0),
            ("NI_Scale[0]_Polynomial_Coefficients[0]", 1.0),
            ("NI_Scale[0]_Polynomial_Coefficients[1]", 0.0),
            ("NI_Scale[0]_Polynomial_Coefficients[2]", 2.0),
        ];
        assert_eq!(
            (apply(&properties(&list, "Polynomial"), &mut values), values),
            (Ok(()), [3.0, 19.0])
        );
        // The last of two scales takes the raw values, the output of the first, or its own.
        for (source, wanted) in [(RAW, Ok(10.0)), (0.0, Ok(30.0)), (1.0, Err(()))] {
            let mut two = properties(
                &[
                    ("NI_Scale[0]_Linear_Slope", 3.0),
                    ("NI_Scale[0]_Linear_Y_Intercept", 0.0),
                    ("NI_Scale[1]_Linear_Slope", 10.0),
                    ("NI_Scale[1]_Linear_Y_Intercept", 0.0),
                    ("NI_Scale[1]_Linear_Input_Source", source),
                ],
                "Linear",
            );
            two.insert("NI_Scale[1]_Scale_Type".into(), Property::Text("Linear".into()));
            two.insert("NI_Number_Of_Scales".into(), Property::Number(2.0));
            let mut one = [1.0];
            assert_eq!(apply(&two, &mut one).map(|()| one[0]).map_err(|_| ()), wanted, "{source}");
        }
        assert!(apply(&properties(&[], "Thermocouple"), &mut values).is_err());
        assert_eq!(apply(&IndexMap::new(), &mut values), Ok(()));
    }
}
