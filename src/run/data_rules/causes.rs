//! Probable cause of a value that differs from the expected one by a factor.

use crate::units::Dimension;

/// A factor between the value found and the expected value, with its most probable cause. Only
/// units of measure are listed. Causes that belong to a quantity, such as an axle load in place of
/// a wheel load, are stated in the protocol.
struct Factor {
    /// What is measured; `None` is anything.
    of: Option<Dimension>,
    factor: f64,
    says: &'static str,
}

const fn factor(of: Dimension, factor: f64, says: &'static str) -> Factor {
    Factor { of: Some(of), factor, says }
}

const FACTORS: &[Factor] = &[
    factor(
        Dimension::FORCE,
        1000.0,
        "a unit that is off by a factor of 1000, such as N in place of kN",
    ),
    factor(
        Dimension::FORCE,
        9.806_65,
        "a unit that is off by a factor of about 10, such as kgf or daN in place of N",
    ),
    factor(Dimension::FORCE, 8.0, "a factor of 8"),
    factor(Dimension::FORCE, 4.0, "a factor of 4"),
    factor(Dimension::FORCE, 2.0, "a factor of 2"),
    factor(Dimension::ACCELERATION, 9.806_65, "m/s^2 in place of g"),
    factor(Dimension::LENGTH, 1000.0, "mm in place of m"),
    factor(Dimension::LENGTH, 100.0, "cm in place of m"),
    factor(Dimension::SPEED, 3.6, "km/h in place of m/s"),
    Factor { of: None, factor: 1000.0, says: "a unit that is off by a factor of 1000" },
];

/// Tolerance for a ratio to agree with a factor (as a factor, in both directions). Expected values
/// are rough (payload, roll angle), and the factors lie far apart; 9.81 and 10 are one entry.
const NEARNESS: f64 = 1.25;

/// The cause, by what is measured; `None` where the ratio agrees with no factor.
pub fn likely(found: f64, expected: f64, of: Dimension) -> Option<String> {
    let ratio = found / expected;
    if !ratio.is_finite() {
        return None;
    }
    if found == 0.0 {
        return Some("a channel without a signal".into());
    }
    let near = |of: f64| (1.0 / NEARNESS..=NEARNESS).contains(&(ratio.abs() / of));
    let size = if near(1.0) {
        None
    } else {
        let possible = || FACTORS.iter().filter(|factor| factor.of.is_none_or(|own| own == of));
        let direct =
            possible().find(|factor| near(factor.factor)).map(|factor| factor.says.to_string());
        direct.or_else(|| {
            possible()
                .find(|factor| near(1.0 / factor.factor))
                .map(|factor| format!("{}, the other way round", factor.says))
        })
    };
    match (ratio < 0.0, size) {
        (true, None) => Some("a reversed sign".into()),
        (true, Some(size)) => Some(format!("a reversed sign, and {size}")),
        (false, size) => size,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_and_signs() {
        let of = |found: f64| likely(found, 50.0, Dimension::FORCE).unwrap_or_default();
        assert_eq!(of(-52.0), "a reversed sign");
        assert!(of(51_000.0).contains("factor of 1000, such as N in place of kN"));
        assert!(of(0.052).ends_with("the other way round"));
        assert!(of(5.3).contains("kgf or daN") && of(505.0).contains("kgf or daN"));
        assert_eq!(of(97.0), "a factor of 2");
        assert_eq!(of(0.0), "a channel without a signal");
        assert_eq!(likely(70.0, 50.0, Dimension::FORCE), None);
        assert_eq!(likely(1.0, 0.0, Dimension::FORCE), None);
    }

    /// A unit is named only for what is measured in it.
    #[test]
    fn units_are_those_of_the_dimension() {
        let of = |found: f64, of: Dimension| likely(found, 1.0, of).unwrap_or_default();
        assert_eq!(of(9.81, Dimension::ACCELERATION), "m/s^2 in place of g");
        assert_eq!(of(3.6, Dimension::SPEED), "km/h in place of m/s");
        assert_eq!(of(3.6, Dimension::LENGTH), "");
        assert_eq!(of(1000.0, Dimension::LENGTH), "mm in place of m");
        assert_eq!(of(1000.0, Dimension::ACCELERATION), "a unit that is off by a factor of 1000");
        assert_eq!([9.81, 2.0, 17.0].map(|found| of(found, Dimension::LENGTH)), ["", "", ""]);
    }
}
