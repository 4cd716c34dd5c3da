//! By what measurement and simulation may differ without any effect: noise, tolerances, what no model has.

pub mod covariance;
pub mod declared;
pub mod recorded;
pub mod sensitivity;
pub mod standing;
pub mod whiten;
