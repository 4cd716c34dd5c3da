//! The state of the vehicle: 31 displacements, their rates, and first-order states.

/// First displacement of the car body: y z phi chi psi.
pub const CAR: usize = 0;
/// First displacement of the leading bogie frame; five later, of the trailing one.
pub const BOGIE: usize = 5;
/// Offsets within the five displacements of a body; y is 0 and chi is 3.
pub const Z: usize = 1;
pub const PHI: usize = 2;
pub const PSI: usize = 4;

/// Indices of the first displacements of the four wheelsets.
#[derive(Debug)]
pub struct WheelsetPlaces {
    pub y: usize,
    pub z: usize,
    pub phi: usize,
    pub psi: usize,
}

pub const WHEELSET: WheelsetPlaces = WheelsetPlaces { y: 15, z: 19, phi: 23, psi: 27 };

/// All states, or their rates, in SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Displacements in m and rad.
    pub x: [f64; State::BODIES],
    /// Their rates.
    pub v: [f64; State::BODIES],
    /// Deviation of the spin of the wheelsets from rolling, rad/s.
    pub spin: [f64; 4],
    /// Force of one yaw damper per bogie, N.
    pub yaw_damper: [f64; 2],
    /// Force of the lateral springs per bogie in addition to that at rest, N.
    pub hysteresis: [f64; 2],
    /// Friction torque per bogie, N m.
    pub centre_friction: [f64; 2],
    /// Dry friction per axle box, vertical: right and left of each wheelset, N.
    pub friction_z: [f64; 8],
    /// Dry friction per axle box, lateral, of each wheelset, N.
    pub friction_y: [f64; 4],
    /// Modal displacement of the bending in m and its rate.
    pub bending: [f64; 2],
}

impl State {
    /// Displacements of the seven bodies.
    pub const BODIES: usize = 31;
    /// All states.
    pub const ALL: usize = 2 * Self::BODIES + 24;

    /// Sets `self` to `start` plus `step` times `rates`.
    #[inline(always)]
    pub fn follow(&mut self, start: &Self, step: f64, rates: &Self) {
        *self = *start;
        self.add(step, rates);
    }

    /// Adds `step` times `rates`.
    #[inline(always)]
    pub fn add(&mut self, step: f64, rates: &Self) {
        fn each<const N: usize>(to: &mut [f64; N], step: f64, rates: &[f64; N]) {
            for i in 0..N {
                to[i] += step * rates[i];
            }
        }
        each(&mut self.x, step, &rates.x);
        each(&mut self.v, step, &rates.v);
        each(&mut self.spin, step, &rates.spin);
        each(&mut self.yaw_damper, step, &rates.yaw_damper);
        each(&mut self.hysteresis, step, &rates.hysteresis);
        each(&mut self.centre_friction, step, &rates.centre_friction);
        each(&mut self.friction_z, step, &rates.friction_z);
        each(&mut self.friction_y, step, &rates.friction_y);
        each(&mut self.bending, step, &rates.bending);
    }

    /// All states, group by group.
    fn parts(&self) -> [&[f64]; 9] {
        [
            &self.x,
            &self.v,
            &self.spin,
            &self.yaw_damper,
            &self.hysteresis,
            &self.centre_friction,
            &self.friction_z,
            &self.friction_y,
            &self.bending,
        ]
    }

    /// The states as a vector of length [`State::ALL`].
    pub fn to_vec(&self) -> Vec<f64> {
        self.parts().concat()
    }

    /// Writes the states to a slice of length [`State::ALL`].
    pub fn write(&self, to: &mut [f64]) {
        let mut rest = to;
        for part in self.parts() {
            let (head, tail) = rest.split_at_mut(part.len());
            head.copy_from_slice(part);
            rest = tail;
        }
    }

    /// The inverse of [`State::to_vec`]; `values` has length [`State::ALL`].
    pub fn from_slice(values: &[f64]) -> Self {
        fn take<const N: usize>(values: &mut &[f64]) -> [f64; N] {
            let (part, rest) = values.split_at(N);
            *values = rest;
            let mut array = [0.0; N];
            array.copy_from_slice(part);
            array
        }
        let values = &mut &values[..];
        Self {
            x: take(values),
            v: take(values),
            spin: take(values),
            yaw_damper: take(values),
            hysteresis: take(values),
            centre_friction: take(values),
            friction_z: take(values),
            friction_y: take(values),
            bending: take(values),
        }
    }

    /// Whether all displacements, rates and spins are finite.
    pub fn is_finite(&self) -> bool {
        // 0 times infinity or NaN is NaN.
        let mut sum = 0.0;
        for i in 0..Self::BODIES {
            sum += 0.0 * self.x[i] + 0.0 * self.v[i];
        }
        for spin in self.spin {
            sum += 0.0 * spin;
        }
        sum == 0.0
    }

    /// The largest magnitude of all states.
    pub fn largest(&self) -> f64 {
        self.to_vec().into_iter().fold(0.0, |most, value| value.abs().max(most))
    }
}
