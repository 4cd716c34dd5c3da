//! Campaigns and records: files read, imported, found and examined.

#[path = "../common"]
mod common {
    pub mod campaign;
    pub mod program;
    pub mod texts;
}

// Faults of campaigns, put in by the example.
#[path = "../../examples/plausibility_faults/faults.rs"]
mod faults;
#[path = "../../examples/plausibility_faults/folder.rs"]
mod folder;
#[path = "../../examples/plausibility_faults/score.rs"]
mod score;

mod campaign_faults;
mod campaign_vehicle;
mod confirmed;
mod data;
mod find;
mod foreign;
mod found_sections;
mod import;
mod parquet_records;
mod plausibility;
mod records;
