//! Fishplate: a validation-protocol language and certification-report generator for rail vehicle
//! simulation models.
//!
//! Data flows one way. Each stage is a folder:
//!
//! | stage | from | to | folder |
//! |---|---|---|---|
//! | syntax | protocol text, YAML or `.fp` | [`syntax::document::Document`] | `syntax` |
//! | check | document | `check::plan::Plan`: resolved, SI units, complete | `check` |
//! | graph | plan | `graph::Graph`: typed operations in the order of execution | `graph` |
//! | run | graph and campaign | [`result::Certification`] | `run` |
//! | report | certification | PDF, HTML, JSON, CSV | `report` |
//!
//! [`source`], [`problem`], [`units`], [`yaml`] and `metrics` are used by all stages; `data` reads
//! campaigns.

pub mod catalog;
pub mod certify;
pub mod check;
pub mod cli;
pub mod compare;
pub mod data;
pub mod deliver;
pub mod diagnose;
pub mod disk;
pub mod effects;
pub mod exercise;
pub mod foreign;
pub mod graph;
pub mod hash;
pub mod impact;
pub mod import;
pub mod init;
pub mod library;
pub mod metrics;
pub mod model;
pub mod new;
pub mod prepare;
pub mod problem;
pub mod provenance;
pub mod report;
pub mod result;
pub mod robustness;
pub mod run;
pub mod simulate;
pub mod source;
pub mod store;
pub mod study;
pub mod syntax;
pub mod terminal;
pub mod units;
pub mod values;
pub mod words;
pub mod yaml;
