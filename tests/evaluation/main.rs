//! Numbers and verdicts, compared with independent sources.

#[path = "../common"]
mod common {
    pub mod campaign;
    pub mod pools;
    pub mod program;
    pub mod straight;
    pub mod texts;
}

mod comfort;
mod computed;
mod domain;
mod draws;
mod estimates;
mod limits;
mod metrics;
mod parts;
mod peer;
mod pooled;
mod procedures;
mod rule_sets;
mod shipped_numbers;
mod slurm;
mod values;
mod verdicts;
mod written_rule_sets;
