//! Checks what an Arrow file declares, before its reader allocates it: places of the blocks, sizes
//! of buffers and what they unpack to.

use arrow_ipc::{Block, CompressionType, Endianness, RecordBatch};

use super::super::Input;
use super::super::guard::Failure;
use super::super::load::most_unpacked;
use crate::problem::Problem;

/// Bytes before the first block, and of the length and mark at the end.
const MARK: &[u8] = b"ARROW1";
const END: usize = 4 + MARK.len();

/// Checks a file; returns the number of its rows.
pub fn check(input: &Input<'_>) -> Result<usize, Problem> {
    let bytes = &input.bytes[..];
    let footer = footer(bytes).map_err(|why| input.damaged("the footer", why))?;
    let footer =
        arrow_ipc::root_as_footer(footer).map_err(|error| input.damaged("the footer", error))?;
    if footer.schema().is_some_and(|schema| schema.endianness() == Endianness::Big) {
        let says =
            format!("`{}` is an Arrow file of big-endian numbers, which are not read", input.shown);
        let help = "write it on a machine with little-endian numbers, or as Parquet";
        return Err(Problem::error("format-not-read", says).help(help));
    }
    let mut budget = most_unpacked(bytes.len());
    let mut rows = 0usize;
    let lists = [("dictionary", footer.dictionaries()), ("batch", footer.recordBatches())];
    for (word, blocks) in lists {
        for (index, block) in blocks.iter().flatten().enumerate() {
            let added = check_block(bytes, block, &mut budget)
                .map_err(|failure| input.failed(&format!("{word} {}", index + 1), failure))?;
            rows = rows.saturating_add(added);
        }
    }
    Ok(rows)
}

fn footer(bytes: &[u8]) -> Result<&[u8], String> {
    let end = bytes.len().checked_sub(END).filter(|end| bytes[end + 4..] == *MARK);
    let end = end.ok_or("the file does not end as it should")?;
    let length =
        bytes[end..].first_chunk::<4>().map_or(0, |length| u32::from_le_bytes(*length)) as usize;
    let footer = end.checked_sub(length).map(|start| &bytes[start..end]);
    footer.ok_or_else(|| format!("{length} bytes are declared, {end} are there"))
}

/// Some bytes, as far as they are there.
fn part(bytes: &[u8], from: i64, size: i64) -> Option<&[u8]> {
    let (from, size) = (usize::try_from(from).ok()?, usize::try_from(size).ok()?);
    bytes.get(from..from.checked_add(size)?)
}

/// Checks a block; returns the number of its rows, of a dictionary none.
fn check_block(bytes: &[u8], block: &Block, budget: &mut usize) -> Result<usize, Failure> {
    let header = i64::from(block.metaDataLength());
    let head = part(bytes, block.offset(), header).ok_or("its header is beyond the file")?;
    let body = block.offset().checked_add(header);
    let body = body.and_then(|from| part(bytes, from, block.bodyLength())).ok_or_else(|| {
        format!("{} bytes are declared, more than the file has", block.bodyLength())
    })?;
    // Since version 0.15 four bytes of ones come before the length.
    let skip = if head.starts_with(&[0xff; 4]) { 8 } else { 4 };
    let message = head.get(skip..).ok_or("its header is not complete")?;
    let message = arrow_ipc::root_as_message(message).map_err(|error| error.to_string())?;
    let (batch, rows) =
        match (message.header_as_record_batch(), message.header_as_dictionary_batch()) {
            (Some(batch), _) => {
                (batch, usize::try_from(batch.length()).map_err(|_| "a negative number of rows")?)
            }
            (None, Some(dictionary)) => (dictionary.data().ok_or("it has no data")?, 0),
            (None, None) => return Err("it is neither a batch nor a dictionary".into()),
        };
    buffers(&batch, body, budget)?;
    Ok(rows)
}

/// Checks the buffers of a batch.
fn buffers(batch: &RecordBatch<'_>, body: &[u8], budget: &mut usize) -> Result<(), Failure> {
    let compression = batch.compression().map(|compression| compression.codec());
    if compression
        .is_some_and(|codec| !matches!(codec, CompressionType::LZ4_FRAME | CompressionType::ZSTD))
    {
        return Err("its compression is not known".into());
    }
    for (index, buffer) in batch.buffers().iter().flatten().enumerate() {
        let bytes = part(body, buffer.offset(), buffer.length())
            .ok_or_else(|| format!("buffer {} is beyond its body", index + 1))?;
        // A packed buffer begins with its size; -1: it is not packed.
        let size = match (compression, bytes.first_chunk::<8>()) {
            (Some(_), Some(size)) if i64::from_le_bytes(*size) != -1 => i64::from_le_bytes(*size),
            _ => bytes.len() as i64,
        };
        let size = usize::try_from(size)
            .map_err(|_| format!("buffer {} declares a negative size", index + 1))?;
        *budget = budget.checked_sub(size).ok_or(Failure::Unpacked)?;
    }
    Ok(())
}
