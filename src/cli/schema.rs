//! `schema`: what is valid in a protocol, and what stands in the files of results.

use clap::ValueEnum;
use schemars::{JsonSchema, generate::SchemaSettings};

use super::output::{Console, Done};
use crate::result::{
    self, Certification, blind::Blind, comparison::Comparison, diagnosis::Diagnosis,
    exercise::Exercise, impact::Impact, study::Study,
};
use crate::syntax;

/// What a schema is of.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Of {
    /// Protocols as YAML
    Protocol,
    /// results.json
    Results,
    /// study.json
    Study,
    /// comparison.json
    Comparison,
    /// exercise.json
    Exercise,
    /// impact.json
    Impact,
    /// diagnosis.json
    Diagnosis,
    /// blind.json
    Blind,
}

/// The JSON schema of a form of protocols or of a file of results.
pub fn schema(of: Of) -> serde_json::Value {
    match of {
        Of::Protocol => syntax::schema::json_schema(),
        Of::Results => of_file::<Certification>(),
        Of::Study => of_file::<Study>(),
        Of::Comparison => of_file::<Comparison>(),
        Of::Exercise => of_file::<Exercise>(),
        Of::Impact => of_file::<Impact>(),
        Of::Diagnosis => of_file::<Diagnosis>(),
        Of::Blind => of_file::<Blind>(),
    }
}

fn of_file<T: JsonSchema>() -> serde_json::Value {
    SchemaSettings::draft2020_12()
        .for_serialize()
        .into_generator()
        .into_root_schema_for::<T>()
        .into()
}

/// Prints a schema.
pub fn print(of: Of, console: &Console) -> Done {
    console.print_file(&result::text(&schema(of)))
}
