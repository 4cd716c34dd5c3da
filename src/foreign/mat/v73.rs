//! MATLAB 7.3: an HDF5 file in which groups are structs, and cells and struct arrays are
//! references.

use std::collections::HashMap;

use hdf5_reader::error::Error;
use hdf5_reader::group::Group;
use hdf5_reader::{Dataset, Datatype, Hdf5File, OpenOptions};

use super::super::binary::Number;
use super::super::guard::damaged;
use super::super::load::{Budget, most_unpacked};
use super::super::{Format, Input};
use super::{DEEPEST, OBJECT, Value};
use crate::problem::Problem;

/// The group in which MATLAB keeps what cells refer to.
const REFERENCES: &str = "#refs#";

/// Largest chunk of a data set in bytes; MATLAB and h5py write some hundred kB.
const LARGEST_CHUNK: usize = 64 << 20;

/// Most objects that references may lead to; a campaign in one file has some thousands.
const MOST_OBJECTS: usize = 1 << 20;

struct Reader<'a, 'b> {
    shown: &'a str,
    budget: &'a mut Budget<'b>,
    /// Data sets that cells refer to, by their address.
    targets: HashMap<u64, Dataset>,
    objects: usize,
}

type Fields = Vec<(String, Value)>;

/// The variables of a file.
pub(super) fn variables(input: &Input<'_>, budget: &mut Budget<'_>) -> Result<Fields, Problem> {
    let shown = input.shown;
    let most = most_unpacked(input.bytes.len());
    let options = OpenOptions::default()
        .with_max_chunk_bytes(LARGEST_CHUNK.min(most))
        .with_max_read_bytes(most)
        .with_max_object_header_bytes(1 << 20);
    let bad = |place: &str, error: Error| damaged(Format::Mat, shown, place, error);
    let file = Hdf5File::from_bytes_with_options(input.bytes, options)
        .map_err(|error| bad("the header", error))?;
    // The library of the HDF Group refuses such a file; this reader would read what is there.
    let end = file.superblock().eof_address;
    if end > input.bytes.len() as u64 {
        let why = format!("{end} bytes are declared, {} are there", input.bytes.len());
        return Err(damaged(Format::Mat, shown, "the header", why));
    }
    let root = file.root_group().map_err(|error| bad("the root group", error))?;
    let (groups, sets) = root.members().map_err(|error| bad("the root group", error))?;
    let mut targets = HashMap::new();
    for group in groups.iter().filter(|group| group.name() == REFERENCES) {
        for set in group.datasets().map_err(|error| bad("the group of references", error))? {
            targets.insert(set.address(), set);
        }
    }
    let mut reader = Reader { shown, budget, targets, objects: 0 };
    let mut found = Vec::new();
    for set in &sets {
        let value = reader.value(set, set.name(), 0)?;
        found.push((set.name().to_string(), value));
    }
    for group in groups.iter().filter(|group| !group.name().starts_with('#')) {
        let value = reader.fields(group, group.name(), 0)?;
        found.push((group.name().to_string(), value));
    }
    Ok(found)
}

impl Reader<'_, '_> {
    fn bad(&self, path: &str, why: impl std::fmt::Display) -> Problem {
        damaged(Format::Mat, self.shown, &format!("`{path}`"), why)
    }

    fn count(&mut self, path: &str) -> Result<(), Problem> {
        self.objects += 1;
        if self.objects > MOST_OBJECTS {
            Err(self.bad(path, "it has too many objects"))
        } else {
            Ok(())
        }
    }

    /// A group is a struct.
    fn fields(&mut self, group: &Group, path: &str, depth: usize) -> Result<Value, Problem> {
        self.count(path)?;
        if depth > DEEPEST {
            return Err(self.bad(path, format!("structs nested more than {DEEPEST} deep")));
        }
        let (groups, sets) = group.members().map_err(|error| self.bad(path, error))?;
        let mut found = Vec::new();
        for set in &sets {
            let value = self.value(set, &format!("{path}.{}", set.name()), depth + 1)?;
            found.push((set.name().to_string(), value));
        }
        for inner in &groups {
            let value = self.fields(inner, &format!("{path}.{}", inner.name()), depth + 1)?;
            found.push((inner.name().to_string(), value));
        }
        // Fields that are all cells of references are a struct array.
        Ok(match transposed(&found) {
            Some(elements) => Value::Structs(elements),
            None => Value::Structs(vec![found]),
        })
    }

    fn value(&mut self, set: &Dataset, path: &str, depth: usize) -> Result<Value, Problem> {
        self.count(path)?;
        if depth > DEEPEST {
            return Err(self.bad(path, format!("cells nested more than {DEEPEST} deep")));
        }
        let attribute =
            |name: &str| set.attributes().into_iter().find(|attribute| attribute.name == name);
        let class = attribute("MATLAB_class")
            .and_then(|class| class.read_string().ok())
            .unwrap_or_default();
        let empty = attribute("MATLAB_empty").is_some();
        let shape = set.shape().to_vec();
        let count = shape
            .iter()
            .try_fold(1u64, |product, size| product.checked_mul(*size))
            .and_then(|count| usize::try_from(count).ok());
        let count =
            count.ok_or_else(|| self.bad(path, "the declared size is beyond any memory"))?;
        if empty || count == 0 {
            return Ok(if class == "char" {
                Value::Text(String::new())
            } else {
                Value::Numbers { rows: 0, columns: 0, values: Vec::new() }
            });
        }
        self.budget.take(1, count, &format!("`{path}`"))?;
        match set.dtype() {
            Datatype::Reference { .. } => {
                let bytes = set.read_raw_bytes().map_err(|error| self.bad(path, error))?;
                let addresses =
                    bytes.as_chunks::<8>().0.iter().map(|bytes| u64::from_le_bytes(*bytes));
                let mut cells = Vec::new();
                for (index, address) in addresses.enumerate() {
                    let Some(target) = self.targets.get(&address).cloned() else {
                        cells.push(Value::Other(OBJECT));
                        continue;
                    };
                    cells.push(self.value(
                        &target,
                        &format!("{path}{{{}}}", index + 1),
                        depth + 1,
                    )?);
                }
                Ok(Value::Cells(cells))
            }
            Datatype::FixedPoint { .. } | Datatype::FloatingPoint { .. } => {
                let values = self.numbers(set, path)?;
                if class == "char" {
                    let units: Vec<u16> = values.iter().map(|unit| *unit as u16).collect();
                    return Ok(Value::Text(
                        char::decode_utf16(units)
                            .map(|letter| letter.unwrap_or('\u{fffd}'))
                            .collect(),
                    ));
                }
                // HDF5 stores the last dimension without gaps, MATLAB the first: the sizes are in
                // reverse order.
                let rows = usize::try_from(shape.last().copied().unwrap_or(1)).unwrap_or(count);
                Ok(Value::Numbers { rows, columns: count / rows.max(1), values })
            }
            Datatype::String { .. } | Datatype::VarLen { .. } => match set.read_strings() {
                Ok(texts) if texts.len() == 1 => {
                    Ok(Value::Text(texts.into_iter().next().unwrap_or_default()))
                }
                Ok(texts) => Ok(Value::Cells(texts.into_iter().map(Value::Text).collect())),
                Err(error) => Err(self.bad(path, error)),
            },
            Datatype::Compound { .. } => Ok(Value::Other(
                "complex numbers or a compound; save its parts as arrays of their own",
            )),
            _ => Ok(Value::Other(OBJECT)),
        }
    }

    fn numbers(&self, set: &Dataset, path: &str) -> Result<Vec<f64>, Problem> {
        let bytes = set.read_native_bytes().map_err(|error| self.bad(path, error))?;
        let number = match set.dtype() {
            Datatype::FloatingPoint { size, .. } => Some(Number::Float(usize::from(*size))),
            Datatype::FixedPoint { size, signed: true, .. } => {
                Some(Number::Signed(usize::from(*size)))
            }
            Datatype::FixedPoint { size, .. } => Some(Number::Unsigned(usize::from(*size))),
            _ => None,
        };
        number.and_then(|number| number.read(&bytes, cfg!(target_endian = "big"))).ok_or_else(
            || self.bad(path, format!("numbers of the type {:?} are not read", set.dtype())),
        )
    }
}

/// A struct array is stored as one data set of references for each field.
fn transposed(fields: &Fields) -> Option<Vec<Fields>> {
    let lists: Option<Vec<&Vec<Value>>> = fields
        .iter()
        .map(|(_, value)| match value {
            Value::Cells(cells) => Some(cells),
            _ => None,
        })
        .collect();
    let lists = lists.filter(|lists| lists.len() > 1)?;
    let count = lists.first()?.len();
    // Cells of texts alone are names and units.
    let only_texts = |list: &&Vec<Value>| list.iter().all(|value| matches!(value, Value::Text(_)));
    if !lists.iter().all(|list| list.len() == count) || lists.iter().all(only_texts) {
        return None;
    }
    let element = |index: usize| {
        fields
            .iter()
            .zip(&lists)
            .map(|((name, _), list)| (name.clone(), list[index].clone()))
            .collect()
    };
    Some((0..count).map(element).collect())
}
