//! Allowed difference of measurement and simulation without any effect: noise, tolerances, model
//! discrepancy.

pub mod covariance;
pub mod declared;
pub mod metric;
pub mod recorded;
pub mod references;
pub mod response;
pub mod sensitivity;
pub mod standing;
pub mod whiten;
