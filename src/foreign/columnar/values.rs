//! Columns of Arrow arrays as numbers.

use arrow_array::cast::AsArray;
use arrow_array::{Array, Int64Array};
use arrow_schema::{ArrowError, DataType, TimeUnit};

use crate::data::record::numbers;

/// Whether a type is read as numbers, or why not.
pub fn readable(kind: &DataType) -> Result<(), String> {
    match kind {
        DataType::Boolean | DataType::Timestamp(..) | DataType::Duration(_) => Ok(()),
        kind if kind.is_integer() || kind.is_floating() => Ok(()),
        DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View => {
            Err("its cells are text".into())
        }
        other => Err(format!("its type {other} is not read")),
    }
}

/// Times and durations are seconds.
pub fn is_time(kind: &DataType) -> bool {
    matches!(kind, DataType::Timestamp(..) | DataType::Duration(_))
}

/// Adds the values of a column; NaN where it has none. Times are counted from the first of the
/// file, which `origin` keeps: as nanoseconds since 1970 they have more digits than a double.
pub fn add(to: &mut Vec<f64>, column: &dyn Array, origin: &mut Option<i64>) -> Result<(), String> {
    let kind = column.data_type();
    let first = |counts: &Int64Array, origin: &mut Option<i64>| {
        *origin = origin.or_else(|| counts.iter().flatten().next());
        origin.unwrap_or(0)
    };
    match kind {
        DataType::Boolean => {
            let number = |yes: bool| f64::from(u8::from(yes));
            to.extend(column.as_boolean().iter().map(|value| value.map_or(f64::NAN, number)));
        }
        DataType::Duration(unit) | DataType::Timestamp(unit, _) => {
            let counts = counts(column).map_err(|error| error.to_string())?;
            let from =
                if matches!(kind, DataType::Duration(_)) { 0 } else { first(&counts, origin) };
            let seconds = |count: i64| count.saturating_sub(from) as f64 / parts(*unit);
            to.extend(counts.iter().map(|count| count.map_or(f64::NAN, seconds)));
        }
        _ => numbers(column, 1.0, to).ok_or_else(|| format!("values of the type {kind}"))?,
    }
    Ok(())
}

/// Times or durations as whole numbers of their unit, which is how they are stored.
fn counts(column: &dyn Array) -> Result<Int64Array, ArrowError> {
    let data = column.to_data().into_builder().data_type(DataType::Int64).build()?;
    Ok(Int64Array::from(data))
}

/// Parts of a second.
fn parts(unit: TimeUnit) -> f64 {
    match unit {
        TimeUnit::Second => 1.0,
        TimeUnit::Millisecond => 1e3,
        TimeUnit::Microsecond => 1e6,
        TimeUnit::Nanosecond => 1e9,
    }
}
