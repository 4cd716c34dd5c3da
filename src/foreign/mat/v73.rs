//! MATLAB 7.3: an HDF5 file in which groups are structs, and cells and struct arrays are
//! references.

use std::collections::HashMap;

use hdf5_reader::error::Error;
use hdf5_reader::group::Group;
use hdf5_reader::{Dataset, Datatype, Hdf5File, OpenOptions};

use super::super::Input;
use super::super::binary::Number;
use super::super::load::{Budget, most_unpacked};
use super::{DEEPEST, Fields, OBJECT, Value};
use crate::problem::Problem;

/// The group in which MATLAB keeps what cells refer to.
const REFERENCES: &str = "#refs#";

/// Largest chunk of a data set in bytes; MATLAB and h5py write some hundred kB.
const LARGEST_CHUNK: usize = 64 << 20;

/// Most objects that references may lead to; a campaign in one file has some thousands.
const MOST_OBJECTS: usize = 1 << 20;

const TYPE: &str = "numbers of a type that is not read; write them as 64-bit floats";

struct Reader<'a, 'b> {
    input: &'a Input<'a>,
    budget: &'a mut Budget<'b>,
    /// Data sets that cells refer to, by their address.
    targets: HashMap<u64, Dataset>,
    objects: usize,
    /// Bytes before the HDF5 file in this one.
    base: u64,
}

/// The variables of a file.
pub fn variables(input: &Input<'_>, budget: &mut Budget<'_>) -> Result<Fields, Problem> {
    let most = most_unpacked(input.bytes.len());
    let options = OpenOptions::default()
        .with_max_chunk_bytes(LARGEST_CHUNK.min(most))
        .with_max_read_bytes(most)
        .with_max_object_header_bytes(1 << 20);
    let bad = |place: &str, error: Error| input.damaged(place, error);
    let file = Hdf5File::from_bytes_with_options(input.bytes, options)
        .map_err(|error| bad("the header", error))?;
    // The library of the HDF Group refuses such a file; this reader would read what is there.
    let end = file.superblock().eof_address;
    if end > input.bytes.len() as u64 {
        let why = format!("{end} bytes are declared, {} are there", input.bytes.len());
        return Err(input.damaged("the header", why));
    }
    let root = file.root_group().map_err(|error| bad("the root group", error))?;
    let (groups, sets) = root.members().map_err(|error| bad("the root group", error))?;
    let mut targets = HashMap::new();
    for group in groups.iter().filter(|group| group.name() == REFERENCES) {
        for set in group.datasets().map_err(|error| bad("the group of references", error))? {
            targets.insert(set.address(), set);
        }
    }
    let base = file.superblock().base_address;
    let mut reader = Reader { input, budget, targets, objects: 0, base };
    let groups = groups.iter().filter(|group| !group.name().starts_with('#'));
    reader.members(&sets, groups, "", 0)
}

impl Reader<'_, '_> {
    fn bad(&self, path: &str, why: impl std::fmt::Display) -> Problem {
        self.input.damaged(&format!("`{path}`"), why)
    }

    fn count(&mut self, path: &str) -> Result<(), Problem> {
        self.objects += 1;
        if self.objects > MOST_OBJECTS {
            Err(self.bad(path, "it has too many objects"))
        } else {
            Ok(())
        }
    }

    /// The data sets and groups of a group; their paths begin with `above`.
    fn members<'g>(
        &mut self,
        sets: &[Dataset],
        groups: impl Iterator<Item = &'g Group>,
        above: &str,
        depth: usize,
    ) -> Result<Fields, Problem> {
        let mut found = Fields::new();
        for set in sets {
            let value = self.value(set, &format!("{above}{}", set.name()), depth)?;
            found.push((set.name().to_string(), value));
        }
        for group in groups {
            let value = self.fields(group, &format!("{above}{}", group.name()), depth)?;
            found.push((group.name().to_string(), value));
        }
        Ok(found)
    }

    /// A group is a struct.
    fn fields(&mut self, group: &Group, path: &str, depth: usize) -> Result<Value, Problem> {
        self.count(path)?;
        if depth > DEEPEST {
            return Err(self.bad(path, format!("structs nested more than {DEEPEST} deep")));
        }
        let (groups, sets) = group.members().map_err(|error| self.bad(path, error))?;
        let found = self.members(&sets, groups.iter(), &format!("{path}."), depth + 1)?;
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
        let count = shape.iter().try_fold(1u64, |product, size| product.checked_mul(*size));
        let count = count
            .and_then(|count| usize::try_from(count).ok())
            .ok_or_else(|| self.bad(path, "the declared size is beyond any memory"))?;
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
                    cells.push(match self.targets.get(&address).cloned() {
                        None => Value::Other(OBJECT),
                        Some(target) => {
                            let path = format!("{path}{{{}}}", index + 1);
                            self.value(&target, &path, depth + 1)?
                        }
                    });
                }
                Ok(Value::Cells(cells))
            }
            Datatype::FixedPoint { .. } | Datatype::FloatingPoint { .. } => {
                let Some(values) = self.numbers(set, path)? else { return Ok(Value::Other(TYPE)) };
                if class == "char" {
                    let letters = char::decode_utf16(values.iter().map(|unit| *unit as u16));
                    let letters = letters.map(|letter| letter.unwrap_or('\u{fffd}'));
                    return Ok(Value::Text(letters.collect()));
                }
                // HDF5 stores the last dimension without gaps, MATLAB the first: the sizes are in
                // reverse order.
                let rows = usize::try_from(shape.last().copied().unwrap_or(1)).unwrap_or(count);
                Ok(Value::Numbers { rows, columns: count / rows.max(1), values })
            }
            Datatype::String { .. } | Datatype::VarLen { .. } => {
                let mut texts = set.read_strings().map_err(|error| self.bad(path, error))?;
                Ok(match texts.len() {
                    1 => Value::Text(texts.remove(0)),
                    _ => Value::Cells(texts.into_iter().map(Value::Text).collect()),
                })
            }
            Datatype::Compound { .. } => Ok(Value::Other(
                "complex numbers or a compound; save its parts as arrays of their own",
            )),
            _ => Ok(Value::Other(OBJECT)),
        }
    }

    /// Whether a data set has a layout of version 2, which the reader takes for another (HDF5 File
    /// Format Specification, IV.A.1.a: headers of version 1; IV.A.2.i: their messages of type 8).
    fn has_old_layout(&self, set: &Dataset) -> bool {
        const LAYOUT: u16 = 8;
        const PREFIX: usize = 16;
        let start = |base: u64| usize::try_from(base.saturating_add(set.address())).ok();
        let header = |base: u64| self.input.bytes.get(start(base)?..)?.get(PREFIX..);
        let found = |mut rest: &[u8]| -> Option<bool> {
            loop {
                let kind = u16::from_le_bytes(*rest.first_chunk()?);
                let size = usize::from(u16::from_le_bytes(*rest.get(2..)?.first_chunk()?));
                if kind == LAYOUT {
                    return Some(*rest.get(8)? == 2);
                }
                rest = rest.get(8 + size..)?;
            }
        };
        [0, self.base].into_iter().any(|base| header(base).and_then(found) == Some(true))
    }

    /// The numbers of a data set; `None` if they are of a type that is not read.
    fn numbers(&self, set: &Dataset, path: &str) -> Result<Option<Vec<f64>>, Problem> {
        let number = match set.dtype() {
            Datatype::FloatingPoint { size, .. } => Number::Float(usize::from(*size)),
            Datatype::FixedPoint { size, signed: true, .. } => Number::Signed(usize::from(*size)),
            Datatype::FixedPoint { size, .. } => Number::Unsigned(usize::from(*size)),
            // Only these are asked for.
            _ => return Ok(None),
        };
        let bytes = set.read_native_bytes().map_err(|error| {
            if self.has_old_layout(set) {
                self.bad(path, "a data layout of version 2 (HDF5 before 1.6.3) is not supported")
            } else {
                self.bad(path, error)
            }
        })?;
        let described = set.raw_datatype().map_err(|error| self.bad(path, error))?;
        let values = number.read(&bytes, cfg!(target_endian = "big"));
        Ok(values.and_then(|values| reduced(values, number, &described)))
    }
}

/// Numbers of which a part of the bits counts: those of a converter of 12 bits, for example. `None`
/// for floats that are not those of IEEE 754.
///
/// `described`: the message of the data type (HDF5 File Format Specification, IV.A.2.d): in the
/// bytes 8 to 11 the place of the first bit and their number, of floats then the place and number
/// of the bits of exponent and fraction, and the bias of the exponent.
fn reduced(mut values: Vec<f64>, number: Number, described: &[u8]) -> Option<Vec<f64>> {
    let part = |at: usize| Some(u16::from_le_bytes(*described.get(at..)?.first_chunk()?));
    let (first, count) = (i32::from(part(8)?), i32::from(part(10)?));
    let bits = 8 * i32::try_from(number.size()).ok()?;
    if let Number::Float(size) = number {
        // Place and number of the bits of the exponent, and its bias.
        let (place, exponent, bias) = match size {
            2 => (10, 5, 15),
            4 => (23, 8, 127),
            _ => (52, 11, 1023),
        };
        let whole = (first, count) == (0, bits);
        let layout = [place, exponent, 0, place];
        let is_plain = whole && described.get(12..16)? == layout && part(16)? == bias;
        return is_plain.then_some(values);
    }
    if count == 0 || first + count > bits {
        return None;
    }
    if count == bits {
        return Some(values);
    }
    // Numbers of less than 64 bits, which a double holds.
    let (step, range) = (2f64.powi(first), 2f64.powi(count));
    for value in &mut values {
        let part = (*value / step).floor().rem_euclid(range);
        let negative = matches!(number, Number::Signed(_)) && part >= range / 2.0;
        *value = if negative { part - range } else { part };
    }
    Some(values)
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
