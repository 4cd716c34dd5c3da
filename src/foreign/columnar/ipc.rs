//! Checks what an Arrow file declares, before its reader allocates it: places of the blocks, sizes
//! of buffers and what they unpack to.

use arrow_ipc::{CompressionType, RecordBatch};

use super::super::Format;
use super::super::guard::damaged;
use super::super::load::{most_unpacked, unpacks_to_more};
use crate::problem::Problem;

/// Bytes before the first block, and of the length and mark at the end.
const MARK: &[u8] = b"ARROW1";
const END: usize = 4 + MARK.len();

/// Checks a file; returns the number of its rows.
pub(super) fn check(bytes: &[u8], shown: &str) -> Result<usize, Problem> {
    let bad = |place: &str, why: String| damaged(Format::Arrow, shown, place, why);
    let end = bytes.len().checked_sub(END).filter(|end| bytes[end + 4..] == *MARK);
    let end = end.ok_or_else(|| bad("the footer", "the file does not end as it should".into()))?;
    let length =
        bytes[end..].first_chunk::<4>().map_or(0, |length| u32::from_le_bytes(*length)) as usize;
    let footer = end.checked_sub(length).map(|start| &bytes[start..end]);
    let footer = footer.ok_or_else(|| {
        bad("the footer", format!("{length} bytes are declared, {end} are there"))
    })?;
    let footer =
        arrow_ipc::root_as_footer(footer).map_err(|error| bad("the footer", error.to_string()))?;
    let mut budget = most_unpacked(bytes.len());
    let mut rows = 0usize;
    let lists = [("dictionary", footer.dictionaries()), ("batch", footer.recordBatches())];
    for (word, blocks) in lists {
        for (index, block) in blocks.iter().flatten().enumerate() {
            let place = format!("{word} {}", index + 1);
            let part = |from: i64, size: i64| {
                let (from, size) = (usize::try_from(from).ok()?, usize::try_from(size).ok()?);
                bytes.get(from..from.checked_add(size)?)
            };
            let header = i64::from(block.metaDataLength());
            let head = part(block.offset(), header)
                .ok_or_else(|| bad(&place, "its header is beyond the file".into()))?;
            let body =
                block.offset().checked_add(header).and_then(|from| part(from, block.bodyLength()));
            let body = body.ok_or_else(|| {
                bad(
                    &place,
                    format!("{} bytes are declared, more than the file has", block.bodyLength()),
                )
            })?;
            // Since version 0.15 four bytes of ones come before the length.
            let skip = if head.starts_with(&[0xff; 4]) { 8 } else { 4 };
            let message =
                head.get(skip..).ok_or_else(|| bad(&place, "its header is not complete".into()))?;
            let message = arrow_ipc::root_as_message(message)
                .map_err(|error| bad(&place, error.to_string()))?;
            let batch =
                match (message.header_as_record_batch(), message.header_as_dictionary_batch()) {
                    (Some(batch), _) => {
                        rows = rows.saturating_add(
                            usize::try_from(batch.length())
                                .map_err(|_| bad(&place, "a negative number of rows".into()))?,
                        );
                        batch
                    }
                    (None, Some(dictionary)) => {
                        dictionary.data().ok_or_else(|| bad(&place, "it has no data".into()))?
                    }
                    (None, None) => {
                        return Err(bad(&place, "it is neither a batch nor a dictionary".into()));
                    }
                };
            buffers(&batch, body, &mut budget).map_err(|why| match why {
                Some(why) => bad(&place, why),
                None => unpacks_to_more(shown, &place, bytes.len()),
            })?;
        }
    }
    Ok(rows)
}

/// Checks the buffers of a batch. The error is `None` if they unpack to more than the budget.
fn buffers(batch: &RecordBatch<'_>, body: &[u8], budget: &mut usize) -> Result<(), Option<String>> {
    let compression = batch.compression().map(|compression| compression.codec());
    if compression
        .is_some_and(|codec| !matches!(codec, CompressionType::LZ4_FRAME | CompressionType::ZSTD))
    {
        return Err(Some("its compression is not known".into()));
    }
    for (index, buffer) in batch.buffers().iter().flatten().enumerate() {
        let place =
            usize::try_from(buffer.offset()).ok().zip(usize::try_from(buffer.length()).ok());
        let bytes = place.and_then(|(from, size)| body.get(from..from.checked_add(size)?));
        let bytes =
            bytes.ok_or_else(|| Some(format!("buffer {} is beyond its body", index + 1)))?;
        // A packed buffer begins with its size; -1: it is not packed.
        let size = match (compression, bytes.first_chunk::<8>()) {
            (Some(_), Some(size)) if i64::from_le_bytes(*size) != -1 => i64::from_le_bytes(*size),
            _ => bytes.len() as i64,
        };
        let size = usize::try_from(size)
            .map_err(|_| Some(format!("buffer {} declares a negative size", index + 1)))?;
        *budget = budget.checked_sub(size).ok_or(None)?;
    }
    Ok(())
}
