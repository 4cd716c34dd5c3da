//! Masses and moments of inertia of the displacements.

use super::{
    parameters::Vehicle,
    state::{BOGIE, CAR, State, WHEELSET},
};

/// Reciprocal masses in 1/kg and moments of inertia in 1/(kg m^2). The payload increases the
/// inertias of the car body in proportion to its mass.
pub fn mobility(v: &Vehicle, car_mass: f64) -> [f64; State::BODIES] {
    let scale = car_mass / v.car_mass;
    let car = [
        car_mass,
        car_mass,
        v.car_inertia_roll * scale,
        v.car_inertia_pitch * scale,
        v.car_inertia_yaw * scale,
    ];
    let bogie = [
        v.bogie_mass,
        v.bogie_mass,
        v.bogie_inertia_roll,
        v.bogie_inertia_pitch,
        v.bogie_inertia_yaw,
    ];
    let wheelset =
        [v.wheelset_mass, v.wheelset_mass, v.wheelset_inertia_roll, v.wheelset_inertia_yaw];
    let mut mass = [0.0; State::BODIES];
    mass[CAR..CAR + 5].copy_from_slice(&car);
    mass[BOGIE..BOGIE + 5].copy_from_slice(&bogie);
    mass[BOGIE + 5..BOGIE + 10].copy_from_slice(&bogie);
    for (first, mass_of_all) in
        [WHEELSET.y, WHEELSET.z, WHEELSET.phi, WHEELSET.psi].into_iter().zip(wheelset)
    {
        mass[first..first + 4].fill(mass_of_all);
    }
    mass.map(|mass| 1.0 / mass)
}
