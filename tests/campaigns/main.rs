//! Campaigns and records: files read, imported, found and examined.

#[path = "../common"]
mod common {
    pub mod campaign;
    pub mod program;
}

mod campaign_faults;
mod campaign_vehicle;
mod data;
mod find;
mod foreign;
mod found_sections;
mod import;
mod parquet_records;
mod plausibility;
mod records;
