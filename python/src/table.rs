//! Tables in and out, as Arrow. Buffers are shared with the other library, not copied.

use std::path::PathBuf;
use std::sync::Arc;

use arrow_array::builder::StringBuilder;
use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use arrow_array::{Array, ArrayRef, BooleanArray, Float64Array, RecordBatch, StringArray};
use arrow_schema::{ArrowError, DataType, Field, Schema, SchemaRef};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyList};
use pyo3_arrow::PyArray;
use pyo3_arrow::ffi::{to_schema_pycapsule, to_stream_pycapsule};
use pyo3_arrow::input::AnyRecordBatch;

use crate::error::{one_raised, raised};
use crate::html;
use fishplate::data::hash::sha256;
use fishplate::data::record::{Format, Frame, ReadFrom, read_raw};
use fishplate::data::text::LARGEST_RECORD;
use fishplate::data::write::Values;
use fishplate::disk;
use fishplate::problem::{Problem, Problems};

/// A table, which polars, pandas and pyarrow take without a copy.
#[pyclass(frozen, module = "fishplate")]
#[derive(Clone, Debug)]
pub struct Table {
    pub schema: SchemaRef,
    pub batches: Vec<RecordBatch>,
    /// The file that it was read from, as it is.
    pub file: Option<ReadFrom>,
}

/// Rows of a table that a notebook shows at each end.
const SHOWN: usize = 10;

impl Table {
    pub fn new(columns: Vec<(&str, ArrayRef)>) -> Self {
        // Names pass to other libraries as C strings, which end at a zero byte.
        let field = |(name, array): &(&str, ArrayRef)| {
            Field::new(name.replace('\0', "\u{fffd}"), array.data_type().clone(), true)
        };
        let fields: Vec<Field> = columns.iter().map(field).collect();
        let schema = Arc::new(Schema::new(fields));
        let arrays = columns.into_iter().map(|(_, array)| array).collect();
        let batches = RecordBatch::try_new(Arc::clone(&schema), arrays).into_iter().collect();
        Self { schema, batches, file: None }
    }

    /// The table as a record with a path inside a campaign.
    pub fn frame(&self, name: &str) -> Result<Frame, Problem> {
        let frame = Frame::new(name, &self.schema, self.batches.clone())?;
        Ok(match &self.file {
            Some(file) => frame.read_from(file.clone()),
            None => frame,
        })
    }

    /// A table of any library that speaks Arrow.
    pub fn of(given: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(table) = given.cast::<Self>() {
            return Ok(table.get().clone());
        }
        let wrong = |error: &dyn std::fmt::Display| {
            let problem =
                Problem::error("not-a-table", format!("the table cannot be read: {error}"));
            one_raised(
                given.py(),
                problem.help("give a data frame, an Arrow table, or a dict of names and arrays"),
            )
        };
        let reader = given
            .extract::<AnyRecordBatch>()
            .and_then(AnyRecordBatch::into_reader)
            .map_err(|error| wrong(&error))?;
        let schema = reader.schema();
        let batches =
            reader.collect::<Result<Vec<_>, ArrowError>>().map_err(|error| wrong(&error))?;
        Ok(Self { schema, batches, file: None })
    }

    pub fn rows(&self) -> usize {
        self.batches.iter().map(RecordBatch::num_rows).sum()
    }

    fn cell(&self, row: usize, column: usize) -> String {
        let mut first = 0;
        for batch in &self.batches {
            if row < first + batch.num_rows() {
                return text_of(batch.column(column), row - first).unwrap_or_default();
            }
            first += batch.num_rows();
        }
        String::new()
    }
}

#[pymethods]
impl Table {
    /// The Arrow PyCapsule interface.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyCapsule>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        let batches: Vec<Result<ArrayRef, ArrowError>> = self
            .batches
            .iter()
            .map(|batch| Ok(Arc::new(arrow_array::StructArray::from(batch.clone())) as ArrayRef))
            .collect();
        let field = Arc::new(
            Field::new_struct("", self.schema.fields().clone(), false)
                .with_metadata(self.schema.metadata().clone()),
        );
        let reader = Box::new(pyo3_arrow::ffi::ArrayIterator::new(batches, field));
        Ok(to_stream_pycapsule(py, reader, requested_schema)?)
    }

    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        Ok(to_schema_pycapsule(py, self.schema.as_ref())?)
    }

    #[getter]
    fn column_names(&self) -> Vec<String> {
        self.schema.fields().iter().map(|field| field.name().clone()).collect()
    }

    /// Ending, SHA-256 and size of the file that it was read from.
    #[getter]
    fn _file(&self) -> Option<(&'static str, &str, usize)> {
        self.file.as_ref().map(|file| (file.ending, file.sha256.as_str(), file.bytes))
    }

    #[getter]
    fn num_rows(&self) -> usize {
        self.rows()
    }

    fn __len__(&self) -> usize {
        self.rows()
    }

    fn __repr__(&self) -> String {
        format!("<fishplate.Table of {} rows: {}>", self.rows(), self.column_names().join(", "))
    }

    fn _repr_html_(&self) -> String {
        let names: Vec<String> = self.column_names();
        let rows = self.rows();
        let shown = (0..rows).filter(|row| *row < SHOWN || *row + SHOWN >= rows);
        let cells = shown
            .map(|row| (0..names.len()).map(|column| self.cell(row, column)).collect())
            .collect::<Vec<Vec<String>>>();
        let left_out = rows.saturating_sub(2 * SHOWN);
        html::table(
            &names,
            &cells,
            (left_out > 0).then(|| format!("{rows} rows, {left_out} of which are left out here")),
        )
    }

    fn to_polars<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("polars")?.getattr("DataFrame")?.call1((slf,))
    }

    fn to_pyarrow<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("pyarrow")?.getattr("table")?.call1((slf,))
    }

    fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        Self::to_pyarrow(slf)?.call_method0("to_pandas")
    }
}

/// Columns of equal length, each an array of numpy or of any library that speaks Arrow, or a list
/// of numbers or of texts.
#[pyfunction]
pub fn from_arrays(
    py: Python<'_>,
    names: Vec<String>,
    arrays: Vec<Bound<'_, PyAny>>,
) -> PyResult<Table> {
    let mut columns: Vec<ArrayRef> = Vec::new();
    for (name, array) in names.iter().zip(&arrays) {
        let list = array.is_exact_instance_of::<PyList>();
        let made: ArrayRef = if let Some(numbers) =
            list.then(|| array.extract::<Vec<Option<f64>>>().ok()).flatten()
        {
            Arc::new(Float64Array::from(numbers))
        } else if let Some(texts) =
            list.then(|| array.extract::<Vec<Option<String>>>().ok()).flatten()
        {
            Arc::new(StringArray::from(texts))
        } else if let Some(numbers) =
            array.cast::<PyArray1<f64>>().ok().and_then(|array| array.try_readonly().ok())
        {
            // The one copy: numpy may change its numbers later.
            Arc::new(numbers.as_array().iter().copied().collect::<Float64Array>())
        } else {
            let found = array.extract::<PyArray>().map_err(|error| {
                let says = format!("the column `{name}` is no array of numbers: {error}");
                one_raised(
                    py,
                    Problem::error("not-a-number", says).help("convert the column to float64"),
                )
            })?;
            Arc::clone(found.array())
        };
        if let Some(first) = columns.first().filter(|first| first.len() != made.len()) {
            let says = format!(
                "the column `{name}` has {} values and `{}` has {}",
                made.len(),
                names[0],
                first.len()
            );
            return Err(one_raised(
                py,
                Problem::error("unequal-lengths", says)
                    .help("all columns of a record have the same length"),
            ));
        }
        columns.push(made);
    }
    Ok(Table::new(names.iter().map(String::as_str).zip(columns).collect()))
}

/// A record file as it is. A campaign that uses the table states the file in its results.
#[pyfunction]
pub fn read_record(py: Python<'_>, path: PathBuf) -> PyResult<Table> {
    let made = py.detach(|| {
        let shown = path.display().to_string();
        let columns = read_raw(&path, &shown)?;
        let unreadable = |error: std::io::Error| {
            Problem::error("file-unreadable", format!("`{shown}` cannot be read: {error}"))
        };
        let bytes = disk::read(&path, LARGEST_RECORD).map_err(unreadable)?;
        let file = ReadFrom {
            ending: Format::of(&path).ending(),
            sha256: sha256(&bytes),
            bytes: bytes.len(),
        };
        let arrays = columns.into_iter().map(|column| {
            let array: ArrayRef = match column.values {
                Values::Numbers(values) => Arc::new(Float64Array::from(values)),
                Values::Texts(texts) => Arc::new(StringArray::from(texts)),
            };
            (column.heading, array)
        });
        let arrays: Vec<(String, ArrayRef)> = arrays.collect();
        let columns =
            arrays.iter().map(|(name, array)| (name.as_str(), Arc::clone(array))).collect();
        Ok(Table { file: Some(file), ..Table::new(columns) })
    });
    made.map_err(|problems: Vec<Problem>| raised(py, &Problems(problems)))
}

/// A table that another process read from a file, with what `_file` said there.
#[pyfunction]
pub fn read_elsewhere(table: &Bound<'_, PyAny>, file: (String, String, usize)) -> PyResult<Table> {
    let (ending, sha256, bytes) = file;
    let ending = Format::ALL.into_iter().map(Format::ending).find(|known| *known == ending);
    let file = ending.map(|ending| ReadFrom { ending, sha256, bytes });
    Ok(Table { file, ..Table::of(table)? })
}

/// A small table as the text of a CSV file. Missing values and NaN are empty cells.
#[pyfunction]
pub fn csv(table: &Bound<'_, PyAny>) -> PyResult<Vec<u8>> {
    let table = Table::of(table)?;
    let heading = |field: &Arc<Field>| match field.metadata().get("unit") {
        Some(unit) if !field.name().ends_with(']') => format!("{} [{unit}]", field.name()),
        _ => field.name().clone(),
    };
    let mut text = table
        .schema
        .fields()
        .iter()
        .map(|field| quoted(&heading(field)))
        .collect::<Vec<_>>()
        .join(",")
        + "\n";
    for row in 0..table.rows() {
        let cells: Vec<String> = (0..table.schema.fields().len())
            .map(|column| quoted(&table.cell(row, column)))
            .collect();
        text += &cells.join(",");
        text.push('\n');
    }
    Ok(text.into_bytes())
}

/// Line breaks inside a cell become blanks: the reader has none there.
fn quoted(cell: &str) -> String {
    let cell = cell.replace(['\n', '\r'], " ");
    let plain = !cell.contains([',', '"']) && cell.trim() == cell;
    if plain { cell } else { format!("\"{}\"", cell.replace('"', "\"\"")) }
}

/// A cell as text; `None` if it is missing.
fn text_of(array: &ArrayRef, row: usize) -> Option<String> {
    if array.is_null(row) {
        return None;
    }
    match array.data_type() {
        DataType::Float64 => Some(array.as_primitive::<Float64Type>().value(row))
            .filter(|value| !value.is_nan())
            .map(|value| value.to_string()),
        DataType::Utf8 => Some(array.as_string::<i32>().value(row).to_string()),
        DataType::LargeUtf8 => Some(array.as_string::<i64>().value(row).to_string()),
        DataType::Utf8View => Some(array.as_string_view().value(row).to_string()),
        _ => {
            let one = arrow_cast::display::array_value_to_string(array, row).ok()?;
            Some(one).filter(|text| text != "NaN")
        }
    }
}

/// The tables of a result, from the text of its CSV files: a column whose cells are all numbers or
/// empty holds numbers.
pub fn of_csv(bytes: &[u8]) -> Table {
    let mut reader = ::csv::Reader::from_reader(bytes);
    let names: Vec<String> = reader
        .headers()
        .map(|header| header.iter().map(str::to_string).collect())
        .unwrap_or_default();
    let rows: Vec<::csv::StringRecord> =
        reader.records().filter_map(std::result::Result::ok).collect();
    let array = |column: usize| -> ArrayRef {
        let cells = || rows.iter().map(|row| row.get(column).filter(|cell| !cell.is_empty()));
        if cells().flatten().next().is_some()
            && cells().flatten().all(|cell| cell.parse::<f64>().is_ok())
        {
            return Arc::new(
                cells()
                    .map(|cell| cell.and_then(|cell| cell.parse().ok()))
                    .collect::<Float64Array>(),
            );
        }
        if cells().flatten().next().is_some()
            && cells().flatten().all(|cell| cell == "true" || cell == "false")
        {
            return Arc::new(
                cells().map(|cell| cell.map(|cell| cell == "true")).collect::<BooleanArray>(),
            );
        }
        let mut texts = StringBuilder::new();
        cells().for_each(|cell| texts.append_option(cell));
        Arc::new(texts.finish())
    };
    Table::new(names.iter().map(String::as_str).zip((0..names.len()).map(array)).collect())
}
