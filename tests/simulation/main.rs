//! The vehicle model, simulators and the diagnosis.

#[path = "../common"]
mod common {
    pub mod program;
}

mod diagnose;
mod machines;
mod model;
mod pendulum;
mod simulate;
