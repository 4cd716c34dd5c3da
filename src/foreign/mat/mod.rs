//! MATLAB files: variables of v5 to v7 and of v7.3, and tables of them.
//!
//! | file | content |
//! |---|---|
//! | `mod` | the types |
//! | `v5` | the format of MATLAB 5 to 7, with compressed variables |
//! | `v73` | MATLAB 7.3, which is HDF5 |
//! | `tables` | structs and vectors as tables of channels |

mod tables;
mod v5;
mod v73;

use super::{Input, Read};
use crate::problem::Problem;

/// A variable or field.
#[derive(Clone, Debug, PartialEq)]
enum Value {
    /// Column by column, as MATLAB stores it.
    Numbers {
        rows: usize,
        columns: usize,
        values: Vec<f64>,
    },
    Text(String),
    Cells(Vec<Value>),
    /// The elements of a struct array, each with its fields; a plain struct has one.
    Structs(Vec<Fields>),
    /// What is not read, in words.
    Other(&'static str),
}

/// The fields of a struct, or the variables of a file.
type Fields = Vec<(String, Value)>;

/// Depth to which structs and cells are read; records have three or four levels.
const DEEPEST: usize = 16;

const OBJECT: &str = "an object of MATLAB (table, timeseries, string); save it as a struct, for example with `table2struct(T, 'ToScalar', true)`";

/// The structs and vectors of a file as tables.
pub fn read(input: &Input<'_>) -> Result<Read, Vec<Problem>> {
    let mut budget = input.budget();
    let old = input.bytes.get(..8) != Some(b"\x89HDF\r\n\x1a\n")
        && matches!(input.bytes.get(124..128), Some([_, 1, b'I', b'M'] | [1, _, b'M', b'I']));
    let (variables, version) = if old {
        (v5::variables(input, &mut budget)?, "MATLAB 5 to 7")
    } else {
        (v73::variables(input, &mut budget)?, "MATLAB 7.3 (HDF5)")
    };
    let mut read = tables::tables_of(variables, input.shown)?;
    read.facts.push(("version".into(), version.into()));
    Ok(read)
}
