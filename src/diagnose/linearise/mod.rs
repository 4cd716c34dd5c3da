//! The response of the features to effects and tolerances at a point, and the difference that noise,
//! tolerances and model errors allow there.

pub mod candidate;
pub mod covariance;
pub mod declared;
pub mod ground;
pub mod mask;
pub mod metric;
pub mod path;
pub mod recorded;
pub mod references;
pub mod response;
pub mod sensitivity;
pub mod standing;
pub mod whiten;
pub mod workshop;
