//! Campaigns and records: files read, imported, found and examined.

#[path = "../common"]
mod common {
    pub mod campaign;
    pub mod program;
    pub mod texts;
}

// Faults of campaigns, put in by the example.
#[allow(
    dead_code,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "as in the example, of which a part is used"
)]
#[path = "../../examples/plausibility_faults/bench/mod.rs"]
mod bench;

mod campaign_faults;
mod campaign_vehicle;
mod confirmed;
mod data;
mod find;
mod foreign;
mod found_sections;
mod import;
mod optional;
mod parquet_records;
mod plausibility;
mod records;
