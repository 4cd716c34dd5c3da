//! ASAM MDF 4: each channel group is a table with a time base of its own.

use falcon_mdf::blocks::DataType;
use falcon_mdf::model::{Channel as Source, ChannelGroup, ValueKind};
use falcon_mdf::{Conversion, Mf4File, OpenOptions};

use super::binary::half;
use super::guard::Failure;
use super::load::most_unpacked;
use super::{Channel, Input, Read, Table, Want, filled};
use crate::problem::Problem;

/// Bytes of a block before its links, and of its data before the number of samples of a group (ASAM
/// MDF 4.1, block CG).
const LINKS_AT: usize = 24;
const SAMPLES_AT: usize = 8;

/// The channel groups of a file as tables.
pub fn read(input: &Input<'_>) -> Result<Read, Vec<Problem>> {
    let most = most_unpacked(input.bytes.len()) as u64;
    // One more than is accepted: what reaches the limit would be cut without a word.
    let options = OpenOptions {
        max_decompressed: most + 1,
        parallel_parsing: false,
        ..OpenOptions::default()
    };
    let file = Mf4File::from_bytes_with_options(input.bytes.to_vec(), options)
        .map_err(|error| input.damaged("the headers", error))?;
    if let Some(flags) = file.unfinalized() {
        let why = format!(
            "it was not finalised ({flags:?}); open and save it in the program that recorded it"
        );
        return Err(input.damaged("the header", why).into());
    }
    let mut budget = input.budget();
    let comment = |text: &str| filled(text).map(|text| ("comment".to_string(), plain(&text)));
    let mut read = Read::default();
    read.facts.push(("version".into(), file.version().to_string()));
    read.facts.extend(comment(file.comment()));
    let groups: usize = file.data_groups().iter().map(|data| data.channel_groups.len()).sum();
    let mut number = 0;
    for data in file.data_groups() {
        if data.block_index().total_size() > most {
            return Err(input.failed(&format!("group {}", number + 1), Failure::Unpacked).into());
        }
        for group in &data.channel_groups {
            number += 1;
            if group.is_vlsd() || group.channels.is_empty() {
                continue;
            }
            let numbered = format!("group {number}");
            let (name, place) = match group.acquisition_name.trim() {
                // The only group needs no name.
                "" if groups == 1 => (String::new(), numbered),
                "" => (numbered.clone(), numbered),
                name => (name.to_string(), format!("{numbered} (`{name}`)")),
            };
            let rows = usize::try_from(group.sample_count).unwrap_or(usize::MAX);
            budget.take(group.channels.len(), rows, &place)?;
            complete(input.bytes, group).map_err(|why| input.damaged(&place, why))?;
            let mut table = Table { name, rows, first_row: 1, ..Table::default() };
            table.facts.extend(comment(&group.comment));
            for source in &group.channels {
                if let Some(why) = unreadable(source) {
                    table.left_out.push((source.name.clone(), why));
                    continue;
                }
                let values = match input.want {
                    Want::Outline if !source.is_master() => Vec::new(),
                    _ => values(&file, source, rows).map_err(|why| {
                        input.damaged(&format!("{place}, channel `{}`", source.name), why)
                    })?,
                };
                // A master without a unit is in the SI unit of its kind.
                let unit = filled(&source.unit)
                    .or_else(|| source.is_time_channel().then(|| "s".to_string()));
                let comment = Some(plain(&source.comment)).filter(|comment| !comment.is_empty());
                let name = source.name.clone();
                table.channels.push(Channel { name, unit, comment, values, ..Channel::default() });
            }
            if !table.channels.is_empty() {
                read.tables.push(table);
            }
        }
    }
    input.with_channels(read, "channels of numbers")
}

/// The reader corrects the number of samples to what is there; a difference is a file that was cut
/// off.
fn complete(bytes: &[u8], group: &ChannelGroup) -> Result<(), String> {
    let number =
        |at: usize| bytes.get(at..)?.first_chunk::<8>().map(|bytes| u64::from_le_bytes(*bytes));
    let start = usize::try_from(group.block_offset()).unwrap_or(usize::MAX);
    let declared = number(start.saturating_add(16))
        .and_then(|links| usize::try_from(links).ok())
        .and_then(|links| links.checked_mul(8))
        .and_then(|links| start.checked_add(LINKS_AT + SAMPLES_AT)?.checked_add(links))
        .and_then(number);
    match declared {
        Some(declared) if declared == group.sample_count => Ok(()),
        Some(declared) => {
            Err(format!("{declared} samples are declared, {} are there", group.sample_count))
        }
        None => Err("its block ends beyond the file".into()),
    }
}

fn unreadable(source: &Source) -> Option<String> {
    if let Some(why) = source.unreadable() {
        return Some(why.to_string());
    }
    if source.is_array() {
        return Some("an array".into());
    }
    if let Conversion::Unsupported { reason, .. } = &source.conversion {
        return Some(format!("its conversion is not read ({reason})"));
    }
    if source.is_float() && !matches!(source.bit_count, HALF | 32 | 64) {
        return Some(format!("floats of {} bits", source.bit_count));
    }
    match source.value_kind() {
        ValueKind::Str => Some("text".into()),
        ValueKind::Bytes => Some("bytes".into()),
        ValueKind::U8 | ValueKind::U16 | ValueKind::U32 | ValueKind::U64 => None,
        ValueKind::I8 | ValueKind::I16 | ValueKind::I32 | ValueKind::I64 => None,
        ValueKind::F32 | ValueKind::F64 => None,
        _ => Some("neither numbers nor text".into()),
    }
}

/// Bits of the floats that the other reader does not know.
const HALF: u32 = 16;

fn values(file: &Mf4File, source: &Source, rows: usize) -> Result<Vec<f64>, String> {
    let halves = source.is_float() && source.bit_count == HALF;
    let mut read = source.clone();
    if halves {
        // The bits of such floats are read as whole numbers.
        read.data_type = match source.data_type {
            DataType::FloatBe => DataType::UIntBe,
            _ => DataType::UIntLe,
        };
        read.conversion = Conversion::None;
    }
    let signal = file.signal(&read).map_err(|error| error.to_string())?;
    if signal.len() > rows {
        return Err(format!("it has {} samples, its group {rows}", signal.len()));
    }
    let mut values = signal.values_f64().map_err(|error| error.to_string())?;
    if values.len() != rows {
        return Err(format!("{rows} samples are declared, {} are there", values.len()));
    }
    if halves {
        values.iter_mut().for_each(|value| *value = source.convert(half(*value as u16)));
    }
    for (value, valid) in values.iter_mut().zip(signal.validity().unwrap_or_default()) {
        if !valid {
            *value = f64::NAN;
        }
    }
    Ok(values)
}

/// Longest comment that is kept.
const LONGEST_COMMENT: usize = 200;

/// The text of a comment without its XML tags.
fn plain(comment: &str) -> String {
    let mut inside = false;
    let mut text = String::new();
    for c in comment.chars() {
        match c {
            '<' => inside = true,
            '>' if inside => {
                inside = false;
                text.push(' ');
            }
            c if !inside => text.push(c),
            _ => {}
        }
    }
    text.split_whitespace().collect::<Vec<_>>().join(" ").chars().take(LONGEST_COMMENT).collect()
}
