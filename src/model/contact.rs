//! Forces between wheel and rail: linear creep forces with Kalker's coefficients, saturated after
//! Shen, Hedrick and Elkins, on a contact ellipse after Hertz.
//!
//! Z. Y. Shen, J. K. Hedrick, J. A. Elkins: A comparison of alternative creep force models for rail
//! vehicle dynamic analysis, Vehicle System Dynamics 12 (1983) 79-83.
//!
//! Alternatively, as set in the vehicle file: O. Polach, Creep forces in simulations of traction
//! vehicles running on adhesion limit, Wear 258 (2005) 992-1000, with reduction factors for the
//! areas of adhesion and of slip; or Chartet's law, as in J.-P. Pascal and G. Sauvage, Vehicle
//! System Dynamics 22 (1993) 263-282.
//!
//! The eight wheels are computed side by side, for vector instructions.

use super::parameters::Vehicle;

/// Right wheels of wheelsets 1 to 4, then left wheels.
pub const WHEELS: usize = 8;
/// One number per wheel.
pub type Wheels = [f64; WHEELS];

/// Iterations of the fixed point of the normal force.
const PASSES: usize = 3;
/// Smallest normal force in N, so that the ellipse is defined for a wheel off the rail.
const LEAST_NORMAL_FORCE: f64 = 100.0;
/// Least share of the vertical force in the normal force.
const LEAST_SHARE: f64 = 0.2;
/// Least cosine of the contact angle in the lateral creepage.
const LEAST_COSINE: f64 = 0.3;

/// Upper bits of the initial value of an inverse cube root.
const GUESS: u64 = 0x553E_F400;

/// Constants of the contact of one vehicle.
#[derive(Clone, Debug)]
pub struct Contact {
    f11: f64,
    f22: f64,
    f23: f64,
    per_reference_load: f64,
    pub friction: f64,
    /// 1/m
    per_radius: f64,
    stop_displacement: f64,
    stop_stiffness: f64,
    law: Law,
}

/// Saturation of the creep forces.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Law {
    ShenHedrickElkins,
    /// Reduction factors for the areas of adhesion and of slip.
    Polach(f64, f64),
    /// Exponent; a larger value gives a later and sharper saturation.
    Chartet(f64),
}

/// Motion of the wheels on the rails; lateral quantities mirrored, positive towards the own flange.
#[derive(Clone, Copy, Debug, Default)]
pub struct Motion {
    pub vertical_force: Wheels,
    pub contact_angle: Wheels,
    pub longitudinal_creepage: Wheels,
    /// Before the division by the cosine of the contact angle.
    pub lateral_slip: Wheels,
    /// Spin due to the yaw rate, in 1/m; that of the contact angle is added here.
    pub yaw_spin: Wheels,
    /// Displacement towards the flange in m.
    pub towards_flange: Wheels,
}

/// Longitudinal force and mirrored lateral force on the wheels in N.
#[derive(Clone, Copy, Debug, Default)]
pub struct Forces {
    pub longitudinal: Wheels,
    pub lateral: Wheels,
}

impl Contact {
    pub fn new(vehicle: &Vehicle) -> Self {
        let stiffness = vehicle.kalker_scale * vehicle.shear_modulus;
        let ab = vehicle.ellipse_ab;
        Self {
            f11: stiffness * vehicle.kalker_c11 * ab,
            f22: stiffness * vehicle.kalker_c22 * ab,
            f23: stiffness * vehicle.kalker_c23 * ab * ab.sqrt(),
            per_reference_load: 1.0 / vehicle.ellipse_reference_load,
            friction: vehicle.friction,
            per_radius: 1.0 / vehicle.wheel_radius,
            stop_displacement: vehicle.stop_displacement,
            stop_stiffness: vehicle.stop_stiffness,
            law: match () {
                () if vehicle.polach_adhesion > 0.0 => {
                    Law::Polach(vehicle.polach_adhesion, vehicle.polach_slip)
                }
                () if vehicle.chartet_exponent > 0.0 => Law::Chartet(vehicle.chartet_exponent),
                () => Law::ShenHedrickElkins,
            },
        }
    }

    /// Creep force at reference load per creepage, longitudinal and lateral, in N.
    pub fn creep_coefficients(&self) -> (f64, f64) {
        (self.f11, self.f22)
    }

    /// Creep forces in N before saturation.
    #[inline(always)]
    fn linear(&self, normal: f64, xi: f64, eta: f64, zeta: f64) -> (f64, f64) {
        // ab is proportional to N^(2/3), ab^1.5 to N.
        let load = normal * self.per_reference_load;
        let area = load * inverse_cube_root(load);
        (-self.f11 * area * xi, -self.f22 * area * eta - self.f23 * load * zeta)
    }

    /// Longitudinal and lateral creep force in N of one wheel at a normal force in N, after Shen,
    /// Hedrick and Elkins.
    #[inline(always)]
    pub fn creep(&self, normal: f64, xi: f64, eta: f64, zeta: f64) -> (f64, f64) {
        let (lx, lt) = self.linear(normal, xi, eta, zeta);
        let linear = (lx * lx + lt * lt).sqrt();
        // F / L = 1 - r/3 + r^2/27 below saturation, mu N / L = 1/r above; at r = 3 both are 1/3.
        let limit = self.friction * normal;
        let r = linear / limit;
        let beyond = limit / linear;
        let below = 1.0 - r * (1.0 / 3.0 - r * (1.0 / 27.0));
        let share = if r < 3.0 { below } else { beyond };
        (share * lx, share * lt)
    }

    /// Forces on all wheels.
    #[inline(always)]
    pub fn forces(&self, motion: &Motion) -> Forces {
        // Separate loops, so that the default law has no branches.
        match self.law {
            Law::ShenHedrickElkins => {
                self.forces_by(motion, |n, xi, eta, zeta| self.creep(n, xi, eta, zeta))
            }
            Law::Polach(adhesion, slip) => {
                self.forces_saturated(motion, |r| polach(r, (adhesion, slip)))
            }
            Law::Chartet(exponent) => {
                self.forces_saturated(motion, |r| (1.0 + r.powf(exponent)).powf(-1.0 / exponent))
            }
        }
    }

    /// With a law that gives the ratio to the linear force as a function of linear force / friction
    /// limit.
    #[inline(never)]
    fn forces_saturated(&self, motion: &Motion, share: impl Fn(f64) -> f64) -> Forces {
        self.forces_by(motion, |n, xi, eta, zeta| {
            let (lx, lt) = self.linear(n, xi, eta, zeta);
            let share = share((lx * lx + lt * lt).sqrt() / (self.friction * n));
            (share * lx, share * lt)
        })
    }

    #[inline(always)]
    fn forces_by(
        &self,
        motion: &Motion,
        creep: impl Fn(f64, f64, f64, f64) -> (f64, f64),
    ) -> Forces {
        let (mut sin, mut cos, mut eta, mut zeta, mut n) =
            ([0.0; WHEELS], [0.0; WHEELS], [0.0; WHEELS], [0.0; WHEELS], [0.0; WHEELS]);
        let (q, xi) = (&motion.vertical_force, &motion.longitudinal_creepage);
        for i in 0..WHEELS {
            (sin[i], cos[i]) = sin_cos(motion.contact_angle[i]);
            eta[i] = motion.lateral_slip[i] / greater(cos[i], LEAST_COSINE);
            zeta[i] = motion.yaw_spin[i] - sin[i] * self.per_radius;
            n[i] = greater(q[i] / cos[i], LEAST_NORMAL_FORCE);
        }
        // N cos(gamma) + T sin(gamma) = Q
        for _ in 0..PASSES {
            for i in 0..WHEELS {
                let (_, t) = creep(n[i], xi[i], eta[i], zeta[i]);
                let vertical = greater(n[i] * cos[i] + t * sin[i], LEAST_SHARE * n[i]);
                n[i] = greater(q[i] * n[i] / vertical, LEAST_NORMAL_FORCE);
            }
        }
        let mut forces = Forces::default();
        for i in 0..WHEELS {
            let (fx, t) = creep(n[i], xi[i], eta[i], zeta[i]);
            let stop = self.stop_stiffness
                * greater(motion.towards_flange[i] - self.stop_displacement, 0.0);
            forces.longitudinal[i] = fx;
            forces.lateral[i] = t * cos[i] - n[i] * sin[i] - stop;
        }
        forces
    }
}

/// Ratio to the linear force as a function of `r` = linear force / friction limit. The gradient of
/// the stress is eps = pi r / 4, so that without reduction small creepages give the linear force.
#[inline(never)]
fn polach(r: f64, (adhesion, slip): (f64, f64)) -> f64 {
    let eps = std::f64::consts::FRAC_PI_4 * r;
    if eps < 1e-9 {
        return 0.5 * (adhesion + slip);
    }
    let reduced = adhesion * eps;
    std::f64::consts::FRAC_2_PI * (reduced / (1.0 + reduced * reduced) + (slip * eps).atan()) / r
}

/// The larger of two numbers, without the additional instructions for NaN.
#[inline(always)]
fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// `x^(-1/3)` of a positive number to full precision, by a division-free fourth-order iteration
/// from an estimate by the exponent. Without branches, and the same on every machine.
#[inline(always)]
fn inverse_cube_root(x: f64) -> f64 {
    // A third of the upper bits is a third of the exponent, with corrected bias; error at most 3.4
    // %.
    let third = ((x.to_bits() >> 32) * 0x5555_5556) >> 32;
    let mut root = f64::from_bits((GUESS - third) << 32);
    // 0.034^4 * 12 = 2e-5, and again: 1e-18.
    for _ in 0..2 {
        // The order reduces dependencies between instructions.
        let rest = 1.0 - (x * root) * (root * root);
        let series = (1.0 / 3.0 + rest * (2.0 / 9.0)) + (rest * rest) * (14.0 / 81.0);
        root += (root * rest) * series;
    }
    root
}

/// Sine and cosine for contact angles (magnitude below 1.6 rad) by series; error below 1e-12.
#[inline(always)]
fn sin_cos(x: f64) -> (f64, f64) {
    // The half angle shortens the series; the double-angle formulas restore it.
    let h = 0.5 * x;
    let z = h * h;
    let series = |terms: [f64; 7]| terms.iter().rev().fold(0.0, |sum, term| term + z * sum);
    let sin = h * series([
        1.0,
        -1.0 / 6.0,
        1.0 / 120.0,
        -1.0 / 5040.0,
        1.0 / 362_880.0,
        -1.0 / 39_916_800.0,
        1.0 / 6_227_020_800.0,
    ]);
    let cos = series([
        1.0,
        -0.5,
        1.0 / 24.0,
        -1.0 / 720.0,
        1.0 / 40_320.0,
        -1.0 / 3_628_800.0,
        1.0 / 479_001_600.0,
    ]);
    (2.0 * sin * cos, cos * cos - sin * sin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_cube_root_is_that_of_the_library() {
        for i in 0..4000 {
            let x = 10f64.powf(f64::from(i) * 0.004 - 8.0);
            assert!((inverse_cube_root(x) * x.cbrt() - 1.0).abs() < 1e-15, "{x}");
        }
    }

    /// Without reduction the initial slope is Kalker's; at large creepage the friction limit is
    /// reached: 2/pi (1/x + pi/2 - 1/x) -> 1.
    #[test]
    fn polach_is_linear_at_first_and_saturates() {
        assert!((polach(1e-6, (1.0, 1.0)) - 1.0).abs() < 1e-9);
        assert!((polach(1e-6, (0.8, 0.4)) - 0.6).abs() < 1e-9);
        assert!((1e4 * polach(1e4, (1.0, 1.0)) - 1.0).abs() < 1e-6);
        // eps = 1: 2/pi (1/2 + pi/4).
        let r = 4.0 / std::f64::consts::PI;
        assert!((r * polach(r, (1.0, 1.0)) - (1.0 / std::f64::consts::PI + 0.5)).abs() < 1e-12);
    }

    #[test]
    fn sine_and_cosine_are_those_of_the_library() {
        for i in -160..=160 {
            let x = f64::from(i) * 0.01;
            let (sin, cos) = sin_cos(x);
            assert!((sin - x.sin()).abs() < 1e-12 && (cos - x.cos()).abs() < 1e-12, "{x}");
        }
    }
}
