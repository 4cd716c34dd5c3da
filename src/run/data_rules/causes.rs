//! Probable cause of a value that differs from the expected one by a factor.

use crate::result::{Reason, SuspectedFactor};
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
