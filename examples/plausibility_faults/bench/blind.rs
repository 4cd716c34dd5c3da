//! The making of campaigns, shared with the example of the diagnosis.

#[path = "../../blind_campaigns/cases.rs"]
pub mod cases;
#[path = "../../blind_campaigns/hidden.rs"]
pub mod hidden;
#[path = "../../blind_campaigns/line.rs"]
pub mod line;
#[path = "../../blind_campaigns/truth.rs"]
pub mod truth;
#[path = "../../blind_campaigns/vehicles.rs"]
pub mod vehicles;
#[path = "../../blind_campaigns/write.rs"]
pub mod write;
