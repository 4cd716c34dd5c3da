//! Small motions about a state: linearisation by central differences, eigenvalues and mode shapes.
//!
//! The track is straight, level and even, so that the equations do not depend on time: x' = A x
//! near a state of rest. The eigenvalues of A give frequency and damping of each mode. The speed at
//! which the first real part becomes positive is the linear critical speed (A. H. Wickens,
//! Fundamentals of Rail Vehicle Dynamics, 2003, chapter 5).

use nalgebra::linalg::{Schur, balancing};
use nalgebra::{Complex, DMatrix, DVector};

use fishplate::model::equations::{Equations, Input};
use fishplate::model::state::State;

/// Iterations of the inverse iteration for a mode shape; each reduces all other modes by many
/// orders of magnitude.
const PASSES: usize = 4;
/// Maximum number of iterations of the QR method.
const ITERATIONS: usize = 5_000;
/// Relative tolerances of the QR method; the next is tried if it does not converge, as with
/// multiple eigenvalues of equal wheelsets.
const PRECISIONS: [f64; 4] = [f64::EPSILON, 1e-15, 1e-14, 1e-13];
/// Relative shift from the eigenvalue in the inverse iteration.
const BESIDE: f64 = 1e-7;

/// Indices of forces and torques in [`State::to_vec`].
const FORCES: std::ops::Range<usize> = 2 * State::BODIES + 4..State::ALL - 2;

/// Entries of [`State::to_vec`] that a vehicle uses; the others stay 0.
fn states(equations: &Equations<'_>) -> Vec<usize> {
    let v = equations.vehicle;
    let first_order = 2 * State::BODIES;
    let yaw_damper = v.yaw_damper_stiffness * v.yaw_damper_damping * v.yaw_damper_remaining;
    let groups = [
        (4, true),
        (2, yaw_damper > 0.0),
        (2, v.secondary_hysteresis > 0.0),
        (2, v.centre_friction_torque > 0.0),
        (8, v.primary_friction_z > 0.0),
        (4, v.primary_friction_y > 0.0),
        (2, v.bending_frequency > 0.0),
    ];
    let mut places: Vec<usize> = (0..first_order).collect();
    let mut next = first_order;
    for (count, has) in groups {
        if has {
            places.extend(next..next + count);
        }
        next += count;
    }
    places
}

/// The equations of motion linearised about a state.
#[derive(Clone, Debug)]
pub struct Linear {
    /// Square, one row and column per entry of `places`, SI units.
    pub matrix: DMatrix<f64>,
    /// Entries of [`State::to_vec`] of the rows and columns: those in use.
    pub places: Vec<usize>,
}

/// An eigenmode: exp(`eigenvalue` t).
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// In 1/s; of a conjugate pair the one with the positive imaginary part.
    pub eigenvalue: Complex<f64>,
}

impl Mode {
    /// Frequency of the damped motion in Hz; 0 if it does not oscillate.
    pub fn frequency(&self) -> f64 {
        self.eigenvalue.im / std::f64::consts::TAU
    }
}

impl Linear {
    /// The matrix about `state` by central differences of `step` (m, rad, m/s, rad/s); first-order
    /// forces and torques are changed by `step` times 1e6. A step well below the point distance of
    /// the contact table (e.g. a micrometre) gives the slopes of the table at the state.
    pub fn about(equations: &Equations<'_>, state: &State, step: f64) -> Self {
        let at = state.to_vec();
        let places = states(equations);
        let rates = |place: usize, by: f64| {
            let mut moved = at.clone();
            moved[place] += by;
            let mut rates = State::default();
            equations.rates(&State::from_slice(&moved), &Input::default(), &mut rates);
            rates.to_vec()
        };
        let mut matrix = DMatrix::zeros(places.len(), places.len());
        for (column, place) in places.iter().enumerate() {
            let step = if FORCES.contains(place) { step * 1e6 } else { step };
            let (above, below) = (rates(*place, step), rates(*place, -step));
            for (row, of) in places.iter().enumerate() {
                matrix[(row, column)] = (above[*of] - below[*of]) / (2.0 * step);
            }
        }
        Self { matrix, places }
    }

    /// All modes in decreasing order of growth; a conjugate pair is one mode. QR method on the
    /// balanced matrix; `None` if it does not converge.
    pub fn modes(&self) -> Option<Vec<Mode>> {
        let mut balanced = self.matrix.clone();
        // Forces and displacements differ by ten orders of magnitude: rows and columns are scaled.
        balancing::balance_parlett_reinsch(&mut balanced);
        let schur = PRECISIONS
            .iter()
            .find_map(|precision| Schur::try_new(balanced.clone(), *precision, ITERATIONS));
        let eigenvalues = schur?.complex_eigenvalues();
        let mut modes: Vec<Mode> = eigenvalues
            .iter()
            .filter(|value| value.im >= 0.0)
            .map(|value| Mode { eigenvalue: *value })
            .collect();
        modes.sort_by(|a, b| {
            b.eigenvalue
                .re
                .total_cmp(&a.eigenvalue.re)
                .then(a.eigenvalue.im.total_cmp(&b.eigenvalue.im))
        });
        Some(modes)
    }

    /// The fastest growing mode; `None` as in [`Self::modes`].
    pub fn least_damped(&self) -> Option<Mode> {
        self.modes()?.into_iter().next()
    }

    /// The shape of a mode over [`State::to_vec`], normalised to a largest displacement of 1;
    /// entries not in use are 0. Inverse iteration (Wilkinson); `None` if the system near the
    /// eigenvalue has no solution.
    pub fn shape(&self, mode: &Mode) -> Option<Vec<Complex<f64>>> {
        let n = self.places.len();
        let beside = mode.eigenvalue * (1.0 + BESIDE) + Complex::from(1e-9);
        let shifted = self.matrix.map(Complex::from) - DMatrix::identity(n, n) * beside;
        let solver = shifted.lu();
        let mut shape = DVector::from_fn(n, |i, _| Complex::new(1.0 + 0.1 * i as f64, 0.3));
        for _ in 0..PASSES {
            shape = solver.solve(&shape)?;
            let length = shape.norm();
            shape /= Complex::from(length);
        }
        let displacements =
            shape.iter().zip(&self.places).filter(|(_, place)| **place < State::BODIES);
        let largest =
            displacements.map(|(value, _)| *value).max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
        let mut all = vec![Complex::from(0.0); State::ALL];
        for (value, place) in shape.iter().zip(&self.places) {
            all[*place] = value / largest;
        }
        Some(all)
    }
}

/// The speed in m/s, to 0.01 m/s, at which small motions about rest begin to grow, between two
/// speeds.
///
/// `equations` gives the vehicle at a speed; one change of sign between the speeds is assumed.
/// `None` if the motion is not damped at the lower speed, does not grow at the higher speed, or the
/// eigenvalues are not found.
pub fn critical_speed<'a>(
    equations: impl Fn(f64) -> Equations<'a>,
    mut stable: f64,
    mut unstable: f64,
) -> Option<f64> {
    let grows = |speed: f64| {
        let equations = equations(speed);
        let rest = equations.at_rest();
        Linear::about(&equations, &rest, 1e-6).least_damped().map(|mode| mode.eigenvalue.re > 0.0)
    };
    if grows(stable)? || !grows(unstable)? {
        return None;
    }
    while unstable - stable > 0.01 {
        let middle = f64::midpoint(stable, unstable);
        if grows(middle)? { unstable = middle } else { stable = middle }
    }
    Some(f64::midpoint(stable, unstable))
}
