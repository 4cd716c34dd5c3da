//! The equations of motion: forces of suspension, contact and gravity on seven bodies.
//!
//! Symbols as in `docs/model.md`: y lateral (right), z vertical (down), phi roll, chi pitch, psi
//! yaw; c car body, b bogie frame, w wheelset. Every body is described in its own track frame; E,
//! Phi, Theta are the lateral offset, the roll and the yaw of one frame relative to another.

pub use super::input::{Hints, Input};
use super::{
    G,
    contact::{Contact, Forces, Motion, WHEELS, Wheels},
    input::Offset,
    masses::mobility,
    parameters::Vehicle,
    profile::Profile,
    state::{BOGIE, CAR, PHI, PSI, State, WHEELSET, Z},
    track::{Line, Track},
};

/// Exponent of the elastic slip element.
const SHARPNESS: i32 = 8;

/// A vehicle at a constant speed.
#[derive(Debug)]
pub struct Equations<'a> {
    pub vehicle: &'a Vehicle,
    profile: &'a Profile,
    contact: Contact,
    /// m/s
    pub speed: f64,
    q0: f64,
    car_mass: f64,
    /// Reciprocal mass or inertia of each displacement.
    mobility: [f64; State::BODIES],
    bending_omega: f64,
}

/// Wheel-rail forces and accelerations, for the outputs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outputs {
    /// Lateral force on the rail in N, positive to the right.
    pub y: Wheels,
    /// Vertical force on the rail in N.
    pub q: Wheels,
    /// m/s^2: car body above bogies I, II.
    pub ay: [f64; 2],
    pub az: [f64; 2],
    /// m/s^2: bogie frames above the outer wheelsets.
    pub ayb: [f64; 2],
    /// Largest displacement of a wheelset relative to its wheels' rails, in m, with its wheelset.
    pub widest: (f64, usize),
}

/// Results of the wheel-rail contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct OnRails {
    forces: Forces,
    /// In N.
    vertical: Wheels,
    /// Relative to the rail, positive to the right, in m.
    displacement: Wheels,
}

impl<'a> Equations<'a> {
    pub fn new(vehicle: &'a Vehicle, profile: &'a Profile, speed: f64) -> Self {
        let v = vehicle;
        let car_mass = v.car_mass + v.payload_mass;
        Self {
            vehicle,
            profile,
            contact: Contact::new(v),
            speed,
            q0: v.static_wheel_load(),
            car_mass,
            mobility: mobility(v, car_mass),
            bending_omega: std::f64::consts::TAU * v.bending_frequency,
        }
    }

    /// Position of wheelset `j` (0 to 3) when the car body's centre is at `s`.
    pub fn wheelset_position(&self, s: f64, j: usize) -> f64 {
        s + [1.0, 1.0, -1.0, -1.0][j] * self.vehicle.half_bogie_spacing
            + lever(j) * self.vehicle.half_wheelbase
    }

    /// Range of displacements of the contact table, in m.
    pub fn table(&self) -> (f64, f64) {
        self.profile.range()
    }

    /// Fastest rate in 1/s, which limits the step of an explicit integrator: the spin of a wheelset
    /// against creep.
    pub fn fastest_rate(&self) -> f64 {
        let v = self.vehicle;
        let (f11, f22) = self.contact.creep_coefficients();
        let load = (self.q0 / v.ellipse_reference_load).powf(2.0 / 3.0) / self.speed;
        let spin = 2.0 * f11 * v.wheel_radius.powi(2) / v.wheelset_inertia_spin;
        let yaw = 2.0 * f11 * v.half_contact_spacing.powi(2) / v.wheelset_inertia_yaw;
        let lateral = 2.0 * f22 / v.wheelset_mass;
        load * spin.max(yaw).max(lateral)
    }

    /// The track under the bodies when the car body's centre is at `s`.
    #[inline(always)]
    pub fn input(&self, track: &Track, s: f64, hints: &mut Hints) -> Input {
        let mut input = Input::default();
        self.look(track, s, hints, &mut input);
        input
    }

    /// As [`Self::input`], into an existing input of this vehicle, or the default.
    #[inline(always)]
    pub(super) fn look(&self, track: &Track, s: f64, hints: &mut Hints, input: &mut Input) {
        let v = self.vehicle;
        input.car = track.line(s, &mut hints.0[0]);
        for i in 0..2 {
            let sb = s + [1.0, -1.0][i] * v.half_bogie_spacing;
            input.bogie[i] = track.line(sb, &mut hints.0[1 + i]);
            input.bogie_offset[i] = Offset::new(&input.bogie[i], sb, &input.car, s);
            for j in [2 * i, 2 * i + 1] {
                let sw = sb + lever(j) * v.half_wheelbase;
                let hint = &mut hints.0[3 + j];
                input.wheelset[j] = track.line(sw, hint);
                input.irregularity[j] = track.irregularity(sw, hint);
                input.wheelset_offset[j] = Offset::new(&input.wheelset[j], sw, &input.bogie[i], sb);
            }
        }
        if v.roundness_amplitude > 0.0 {
            let j = v.roundness_wheelset as usize - 1;
            let wave = v.roundness_harmonic / v.wheel_radius;
            let (sin, cos) = (wave * self.wheelset_position(s, j)).sin_cos();
            for (side, k) in [(0, 1.0), (1, -1.0)] {
                if v.roundness_side == 0.0 || v.roundness_side == k {
                    input.roundness[0][4 * side + j] = v.roundness_amplitude * sin;
                    input.roundness[1][4 * side + j] =
                        v.roundness_amplitude * wave * self.speed * cos;
                }
            }
        }
    }

    /// At rest under the payload, on straight level track; all in m.
    pub fn at_rest(&self) -> State {
        let v = self.vehicle;
        let weight = v.payload_mass * G;
        let zw = weight / (8.0 * v.contact_kc);
        let zb = zw + weight / (8.0 * v.primary_kz);
        let mut state = State::default();
        state.x[CAR + Z] = zb + weight / (4.0 * v.secondary_kz);
        state.x[BOGIE + Z] = zb;
        state.x[BOGIE + 5 + Z] = zb;
        for j in 0..4 {
            state.x[WHEELSET.z + j] = zw;
        }
        state
    }

    /// Rates of all states, and the outputs.
    #[inline(always)]
    pub fn rates(&self, state: &State, input: &Input, rates: &mut State) -> Outputs {
        *rates = State::default();
        let wheels = self.motion(state, input, rates);
        self.outputs(state, input, rates, &wheels)
    }

    /// Rates of all states in use, and the further results for the outputs.
    #[inline(always)]
    pub(super) fn motion(&self, state: &State, input: &Input, rates: &mut State) -> OnRails {
        let mut load = [0.0; State::BODIES];
        rates.x = state.v;
        self.inertial(input, &mut load);
        self.secondary(state, input, &mut load, rates);
        self.primary(state, input, &mut load, rates);
        let wheels = self.wheel_rail(state, input, &mut load, rates);
        self.accelerations(&load, &mut rates.v);
        wheels
    }

    /// Gravity and centrifugal forces, wind and payload.
    #[inline(always)]
    fn inertial(&self, input: &Input, load: &mut [f64; State::BODIES]) {
        let v = self.vehicle;
        let vv = self.speed * self.speed;
        let lateral = |line: &Line| G * line.cant - vv * line.kappa;
        let vertical = |line: &Line| vv * line.kappa * line.cant;
        let m = self.car_mass;
        load[CAR] += m * lateral(&input.car) + v.crosswind_force;
        load[CAR + Z] += m * vertical(&input.car) + v.payload_mass * G;
        load[CAR + PHI] += (v.crosswind_height - v.car_cog_height) * v.crosswind_force
            + m * (G + vertical(&input.car)) * v.payload_offset;
        for i in 0..2 {
            let b = BOGIE + 5 * i;
            load[b] += v.bogie_mass * lateral(&input.bogie[i]);
            load[b + Z] += v.bogie_mass * vertical(&input.bogie[i]);
        }
        for j in 0..4 {
            load[WHEELSET.y + j] += v.wheelset_mass * lateral(&input.wheelset[j]);
            load[WHEELSET.z + j] += v.wheelset_mass * vertical(&input.wheelset[j]);
        }
    }

    /// Between car body and bogie frames.
    #[inline(always)]
    fn secondary(
        &self,
        state: &State,
        input: &Input,
        load: &mut [f64; State::BODIES],
        rates: &mut State,
    ) {
        let v = self.vehicle;
        let (x, u) = (&state.x, &state.v);
        let hcs = v.car_cog_height - v.secondary_height;
        let hbs = v.secondary_height - v.bogie_cog_height;
        let cz = v.secondary_cz * v.secondary_cz_scale;
        let cy = v.secondary_cy * v.secondary_cy_scale;
        let (yaw_ks, yaw_c) = (
            v.yaw_damper_stiffness * v.yaw_damper_remaining,
            v.yaw_damper_damping * v.yaw_damper_remaining,
        );
        // Components that the vehicle does not have are skipped.
        let has_yaw_dampers =
            v.yaw_damper_stiffness * v.yaw_damper_damping * v.yaw_damper_remaining > 0.0;
        let p = self.car_mass * G / 2.0;
        let mut bending = 0.0;
        for i in 0..2 {
            let b = BOGIE + 5 * i;
            let lever = [1.0, -1.0][i] * v.half_bogie_spacing;
            let offset = &input.bogie_offset[i];
            let d = (x[CAR] + lever * x[CAR + PSI] - hcs * x[CAR + PHI])
                - (x[b] + offset.e + v.secondary_height * offset.phi + hbs * x[b + PHI]);
            let d_rate =
                (u[CAR] + lever * u[CAR + PSI] - hcs * u[CAR + PHI]) - (u[b] + hbs * u[b + PHI]);
            let stop = v.bumpstop_stiffness * d.signum() * (d.abs() - v.bumpstop_gap).max(0.0);
            let mut fy = -2.0 * v.secondary_ky * d - cy * d_rate - stop;
            if v.secondary_hysteresis > 0.0 {
                // A spring and a dashpot in series, beside the spring.
                let f = state.hysteresis[i];
                rates.hysteresis[i] = 2.0 * v.secondary_hysteresis * v.secondary_ky * d_rate
                    - f / v.secondary_hysteresis_time;
                fy -= f;
            }
            let dz =
                (x[CAR + Z] - lever * x[CAR + 3] + v.bending_shape * state.bending[0]) - x[b + Z];
            let dz_rate =
                (u[CAR + Z] - lever * u[CAR + 3] + v.bending_shape * state.bending[1]) - u[b + Z];
            let fz = -2.0 * v.secondary_kz * dz - 2.0 * cz * dz_rate;
            let dr = x[CAR + PHI] - x[b + PHI] - offset.phi;
            let dr_rate = u[CAR + PHI] - u[b + PHI];
            let roll_lever = 2.0 * v.secondary_half_spacing * v.secondary_half_spacing;
            let mr = -roll_lever * (v.secondary_kz * dr + cz * dr_rate)
                - v.anti_roll_stiffness * v.anti_roll_scale * dr;
            let dpsi = x[CAR + PSI] - x[b + PSI] - offset.theta;
            let dpsi_rate =
                u[CAR + PSI] - u[b + PSI] + self.speed * (input.car.kappa - input.bogie[i].kappa);
            let mut mz = -roll_lever * v.secondary_kx * dpsi;
            if has_yaw_dampers {
                let f = state.yaw_damper[i];
                rates.yaw_damper[i] = yaw_ks * (v.yaw_damper_half_spacing * dpsi_rate - f / yaw_c);
                mz -= 2.0 * v.yaw_damper_half_spacing * f;
            }
            if v.centre_friction_torque > 0.0 {
                let t = state.centre_friction[i];
                rates.centre_friction[i] =
                    slip_element(t, dpsi_rate, v.centre_friction_torque, v.centre_friction_angle);
                mz -= t;
            }
            bending += fz;
            load[CAR] += fy;
            load[CAR + Z] += fz;
            load[CAR + PHI] += mr - hcs * fy + p * (hcs * x[CAR + PHI] + 0.5 * d);
            load[CAR + 3] -= lever * fz;
            load[CAR + PSI] += lever * fy + mz;
            load[b] -= fy;
            load[b + Z] -= fz;
            load[b + PHI] += p * (hbs * x[b + PHI] + 0.5 * d) - hbs * fy - mr;
            load[b + PSI] -= mz;
        }
        if v.bending_frequency > 0.0 {
            rates.bending = self.bending(state, bending);
        }
    }

    /// Rates of the bending mode of the car body, under the forces of both bogies.
    #[inline(always)]
    fn bending(&self, state: &State, force: f64) -> [f64; 2] {
        let v = self.vehicle;
        let ([q, q_rate], omega) = (state.bending, self.bending_omega);
        let bent = omega * (2.0 * v.bending_damping * q_rate + omega * q);
        [q_rate, v.bending_shape * force / v.bending_mass - bent]
    }

    /// Between bogie frames and wheelsets; two axle boxes per wheelset.
    #[inline(always)]
    fn primary(
        &self,
        state: &State,
        input: &Input,
        load: &mut [f64; State::BODIES],
        rates: &mut State,
    ) {
        let v = self.vehicle;
        let (x, u) = (&state.x, &state.v);
        let hbw = v.bogie_cog_height - v.wheel_radius;
        let b1 = v.primary_half_spacing;
        let kx = v.primary_kx * v.primary_kx_scale;
        for j in 0..4 {
            let b = BOGIE + 5 * (j / 2);
            let lever = lever(j) * v.half_wheelbase;
            let offset = &input.wheelset_offset[j];
            let (y, z, phi, psi) =
                (WHEELSET.y + j, WHEELSET.z + j, WHEELSET.phi + j, WHEELSET.psi + j);
            let l = (x[y] + offset.e + v.wheel_radius * offset.phi)
                - (x[b] + lever * x[b + PSI] - hbw * x[b + PHI]);
            let l_rate = u[y] - (u[b] + lever * u[b + PSI] - hbw * u[b + PHI]);
            let mut fl = -2.0 * (v.primary_ky * l + v.primary_cy * l_rate);
            if v.primary_friction_y > 0.0 {
                let f = state.friction_y[j];
                rates.friction_y[j] =
                    slip_element(f, l_rate, v.primary_friction_y, v.primary_friction_displacement);
                fl -= 2.0 * f;
            }
            let tz = -2.0
                * b1
                * b1
                * (kx * (x[psi] + offset.theta - x[b + PSI])
                    + v.primary_cx * (u[psi] - u[b + PSI]));
            let (mut sum, mut moment) = (0.0, 0.0);
            for (side, k) in [(0, 1.0), (1, -1.0)] {
                let n = (x[z] + k * b1 * (x[phi] + offset.phi))
                    - (x[b + Z] - lever * x[b + 3] + k * b1 * x[b + PHI]);
                let n_rate =
                    (u[z] + k * b1 * u[phi]) - (u[b + Z] - lever * u[b + 3] + k * b1 * u[b + PHI]);
                let mut f = -v.primary_kz * n - v.primary_cz * n_rate;
                if v.primary_friction_z > 0.0 {
                    let dry = state.friction_z[2 * j + side];
                    rates.friction_z[2 * j + side] = slip_element(
                        dry,
                        n_rate,
                        v.primary_friction_z,
                        v.primary_friction_displacement,
                    );
                    f -= dry;
                }
                sum += f;
                moment += k * b1 * f;
            }
            load[y] += fl;
            load[z] += sum;
            load[phi] += moment;
            load[psi] += tz;
            load[b] -= fl;
            load[b + Z] -= sum;
            load[b + PHI] += hbw * fl - moment;
            load[b + 3] += lever * sum;
            load[b + PSI] -= lever * fl + tz;
        }
    }

    /// Between wheels and rails.
    #[inline(always)]
    fn wheel_rail(
        &self,
        state: &State,
        input: &Input,
        load: &mut [f64; State::BODIES],
        rates: &mut State,
    ) -> OnRails {
        let v = self.vehicle;
        let (x, u) = (&state.x, &state.v);
        let (b0, r0) = (v.half_contact_spacing, v.wheel_radius);
        let (per_speed, per_radius) = (1.0 / self.speed, 1.0 / r0);
        let mut motion = Motion::default();
        let mut rho = [0.0; WHEELS];
        let mut displacement = [0.0; WHEELS];
        for j in 0..4 {
            let track = &input.irregularity[j];
            let centre = x[WHEELSET.y + j] - r0 * x[WHEELSET.phi + j] - track.alignment;
            for (side, k) in [(0, 1.0), (1, -1.0)] {
                let i = 4 * side + j;
                displacement[i] = centre - k * 0.5 * track.gauge;
            }
        }
        for side in 0..2 {
            for j in 0..4 {
                let i = 4 * side + j;
                let geometry = self.profile.at(side, displacement[i]);
                rho[i] = geometry.rho;
                motion.contact_angle[i] = geometry.gamma;
            }
        }
        for side in 0..2 {
            let k = [1.0, -1.0][side];
            for j in 0..4 {
                let i = 4 * side + j;
                let (y, z, phi, psi) =
                    (WHEELSET.y + j, WHEELSET.z + j, WHEELSET.phi + j, WHEELSET.psi + j);
                let track = &input.irregularity[j];
                let delta = x[z] + k * b0 * x[phi] - track.height[side] + input.roundness[0][i];
                let delta_rate =
                    u[z] + k * b0 * u[phi] - self.speed * track.slope[side] + input.roundness[1][i];
                motion.vertical_force[i] =
                    (self.q0 + v.contact_kc * delta + v.contact_cc * delta_rate).max(0.0);
                let yaw_rate = u[psi] * per_speed;
                motion.longitudinal_creepage[i] = -k * b0 * (input.wheelset[j].kappa + yaw_rate)
                    - (rho[i] + state.spin[j] * r0 * r0 * per_speed) * per_radius;
                motion.lateral_slip[i] = k * ((u[y] - r0 * u[phi]) * per_speed - x[psi]);
                motion.yaw_spin[i] = k * yaw_rate;
                motion.towards_flange[i] = k * displacement[i];
            }
        }
        let forces = self.contact.forces(&motion);
        for j in 0..4 {
            let (right, left) = (j, 4 + j);
            let q = &motion.vertical_force;
            let sideways = forces.lateral[right] - forces.lateral[left];
            let shifted = x[WHEELSET.y + j] - input.irregularity[j].alignment;
            load[WHEELSET.y + j] += sideways;
            load[WHEELSET.z + j] -= q[right] + q[left] - 2.0 * self.q0;
            load[WHEELSET.phi + j] +=
                shifted * (q[right] + q[left]) - b0 * (q[right] - q[left]) - r0 * sideways;
            load[WHEELSET.psi + j] -= b0 * (forces.longitudinal[right] - forces.longitudinal[left]);
            rates.spin[j] = -r0 * (forces.longitudinal[right] + forces.longitudinal[left])
                / v.wheelset_inertia_spin;
        }
        OnRails { forces, vertical: motion.vertical_force, displacement }
    }

    #[inline(always)]
    fn accelerations(&self, load: &[f64; State::BODIES], rates: &mut [f64; State::BODIES]) {
        for i in 0..State::BODIES {
            rates[i] = load[i] * self.mobility[i];
        }
    }

    #[inline(always)]
    pub(super) fn outputs(
        &self,
        state: &State,
        input: &Input,
        rates: &State,
        wheels: &OnRails,
    ) -> Outputs {
        let v = self.vehicle;
        let (x, a) = (&state.x, &rates.v);
        let vv = self.speed * self.speed;
        let mut outputs = Outputs { q: wheels.vertical, ..Outputs::default() };
        for j in 0..4 {
            outputs.y[j] = -wheels.forces.lateral[j];
            outputs.y[4 + j] = wheels.forces.lateral[4 + j];
        }
        for (i, displacement) in wheels.displacement.iter().enumerate() {
            if displacement.abs() > outputs.widest.0 {
                outputs.widest = (displacement.abs(), i % 4);
            }
        }
        let height = v.car_cog_height - v.floor_height;
        let field = vv * input.car.kappa - G * (input.car.cant + x[CAR + PHI]);
        for i in 0..2 {
            let sign = [1.0, -1.0][i];
            let lever = sign * v.half_bogie_spacing;
            let b = BOGIE + 5 * i;
            let line = &input.bogie[i];
            outputs.ay[i] = a[CAR] + lever * a[CAR + PSI] - height * a[CAR + PHI] + field;
            outputs.az[i] = a[CAR + Z] - lever * a[CAR + 3] + v.bending_shape * rates.bending[1];
            outputs.ayb[i] = a[b] + sign * v.half_wheelbase * a[b + PSI] + vv * line.kappa
                - G * (line.cant + x[b + PHI]);
        }
        outputs
    }
}

/// Sign of the lever of wheelset `j` in its bogie: 1 leading, -1 trailing.
#[inline(always)]
fn lever(j: usize) -> f64 {
    [1.0, -1.0, 1.0, -1.0][j]
}

/// Rate of the force in an elastic slip element: a spring of `bound / elastic` that yields smoothly
/// at `bound`.
#[inline(always)]
fn slip_element(force: f64, rate: f64, bound: f64, elastic: f64) -> f64 {
    let loading = if force * rate > 0.0 { (force / bound).powi(SHARPNESS) } else { 0.0 };
    bound / elastic * rate * (1.0 - loading)
}
