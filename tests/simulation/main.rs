//! The vehicle model, simulators and the diagnosis.

#[path = "../common"]
mod common {
    pub mod program;
    pub mod tools;
}

// The generator of withheld truths.
#[path = "../../examples/blind_campaigns/cases.rs"]
#[allow(dead_code)]
mod cases;
#[path = "../../examples/blind_campaigns/hidden.rs"]
mod hidden;
#[path = "../../examples/blind_campaigns/line.rs"]
mod line;
#[path = "../../examples/blind_campaigns/truth.rs"]
mod truth;
#[path = "../../examples/blind_campaigns/vehicles.rs"]
mod vehicles;
#[path = "../../examples/blind_campaigns/write.rs"]
mod write;

mod diagnose;
mod machines;
mod model;
mod pendulum;
mod simulate;
mod unlike_the_model;
