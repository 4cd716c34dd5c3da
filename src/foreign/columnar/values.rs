//! Columns of Arrow arrays as numbers.

use arrow_array::cast::AsArray;
use arrow_array::types::{
    ArrowPrimitiveType, DurationMicrosecondType, DurationMillisecondType, DurationNanosecondType,
    DurationSecondType, Float16Type, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type,
    Int64Type, TimestampMicrosecondType, TimestampMillisecondType, TimestampNanosecondType,
    TimestampSecondType, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, PrimitiveArray};
use arrow_schema::{DataType, TimeUnit};

/// Whether a type is read as numbers, or why not.
pub(super) fn readable(kind: &DataType) -> Result<(), String> {
    use DataType::{
        Boolean, Duration, Float16, Float32, Float64, Int8, Int16, Int32, Int64, Timestamp, UInt8,
        UInt16, UInt32, UInt64,
    };
    match kind {
        Boolean | Float16 | Float32 | Float64 | Timestamp(..) | Duration(_) => Ok(()),
        Int8 | Int16 | Int32 | Int64 | UInt8 | UInt16 | UInt32 | UInt64 => Ok(()),
        DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View => {
            Err("its cells are text".into())
        }
        other => Err(format!("its type {other} is not read")),
    }
}

/// Times and durations are seconds.
pub(super) fn is_time(kind: &DataType) -> bool {
    matches!(kind, DataType::Timestamp(..) | DataType::Duration(_))
}

/// Adds the values of a column; NaN where it has none. Times are counted from the first of the
/// file, which `origin` keeps: as nanoseconds since 1970 they have more digits than a double.
pub(super) fn add(
    to: &mut Vec<f64>,
    column: &dyn Array,
    origin: &mut Option<i64>,
) -> Result<(), String> {
    macro_rules! plain {
        ($type:ty) => {
            primitive::<$type>(to, column, |value| value as f64)
        };
    }
    macro_rules! seconds {
        ($type:ty, $parts:expr) => {
            primitive::<$type>(to, column, |value| value as f64 / $parts)
        };
    }
    macro_rules! times {
        ($type:ty, $parts:expr) => {{
            let stamps: Option<&PrimitiveArray<$type>> = column.as_primitive_opt();
            if let Some(first) = stamps.and_then(|stamps| stamps.iter().flatten().next()) {
                origin.get_or_insert(first);
            }
            let first = origin.unwrap_or(0);
            primitive::<$type>(to, column, |value| value.saturating_sub(first) as f64 / $parts)
        }};
    }
    match column.data_type() {
        DataType::Int8 => plain!(Int8Type),
        DataType::Int16 => plain!(Int16Type),
        DataType::Int32 => plain!(Int32Type),
        DataType::Int64 => plain!(Int64Type),
        DataType::UInt8 => plain!(UInt8Type),
        DataType::UInt16 => plain!(UInt16Type),
        DataType::UInt32 => plain!(UInt32Type),
        DataType::UInt64 => plain!(UInt64Type),
        DataType::Float16 => primitive::<Float16Type>(to, column, |value| value.to_f64()),
        DataType::Float32 => plain!(Float32Type),
        DataType::Float64 => plain!(Float64Type),
        DataType::Duration(TimeUnit::Second) => seconds!(DurationSecondType, 1.0),
        DataType::Duration(TimeUnit::Millisecond) => seconds!(DurationMillisecondType, 1e3),
        DataType::Duration(TimeUnit::Microsecond) => seconds!(DurationMicrosecondType, 1e6),
        DataType::Duration(TimeUnit::Nanosecond) => seconds!(DurationNanosecondType, 1e9),
        DataType::Timestamp(TimeUnit::Second, _) => times!(TimestampSecondType, 1.0),
        DataType::Timestamp(TimeUnit::Millisecond, _) => times!(TimestampMillisecondType, 1e3),
        DataType::Timestamp(TimeUnit::Microsecond, _) => times!(TimestampMicrosecondType, 1e6),
        DataType::Timestamp(TimeUnit::Nanosecond, _) => times!(TimestampNanosecondType, 1e9),
        DataType::Boolean => {
            to.extend(
                column
                    .as_boolean()
                    .iter()
                    .map(|value| value.map_or(f64::NAN, |yes| f64::from(u8::from(yes)))),
            );
            Some(())
        }
        _ => None,
    }
    .ok_or_else(|| format!("values of the type {}", column.data_type()))
}

fn primitive<T: ArrowPrimitiveType>(
    to: &mut Vec<f64>,
    column: &dyn Array,
    number: impl Fn(T::Native) -> f64,
) -> Option<()> {
    let column: &PrimitiveArray<T> = column.as_primitive_opt()?;
    if column.null_count() == 0 {
        to.extend(column.values().iter().map(|value| number(*value)));
    } else {
        to.extend(column.iter().map(|value| value.map_or(f64::NAN, &number)));
    }
    Some(())
}
