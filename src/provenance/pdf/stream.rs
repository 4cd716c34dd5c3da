//! Unpacking of streams with a maximum size.

use std::io::Read;

use flate2::read::ZlibDecoder;

use super::{
    Broken,
    object::{Dict, Object},
};

/// Unpacks a stream, and stops if it exceeds `most` bytes.
///
/// # Errors
/// A filter other than Deflate, damaged data, or data that are too large.
pub fn unpacked(data: &[u8], dict: &Dict, most: usize) -> Result<Vec<u8>, Broken> {
    let filters: Vec<&Object> = match dict.get("Filter") {
        None | Some(Object::Null) => Vec::new(),
        Some(Object::Array(all)) => all.iter().collect(),
        Some(one) => vec![one],
    };
    match filters.as_slice() {
        [] if data.len() > most => Err(TOO_LARGE),
        [] => Ok(data.to_vec()),
        [filter] if filter.is_name("FlateDecode") => {
            let mut found = Vec::new();
            let read = ZlibDecoder::new(data).take(most as u64 + 1).read_to_end(&mut found);
            if found.len() > most {
                return Err(TOO_LARGE);
            }
            read.map_err(|_| Broken("a part of it cannot be unpacked"))?;
            predicted(found, dict)
        }
        _ => Err(Broken("a part of it uses a compression that is not supported")),
    }
}

const TOO_LARGE: Broken = Broken("a part of it is too large after unpacking");

/// Reverses the PNG prediction of rows (RFC 2083, clause 6), which is used for cross-reference
/// streams.
fn predicted(data: Vec<u8>, dict: &Dict) -> Result<Vec<u8>, Broken> {
    let parameters = match dict.get("DecodeParms") {
        Some(Object::Dict(parameters)) => parameters,
        Some(Object::Array(all)) => match all.first() {
            Some(Object::Dict(parameters)) => parameters,
            _ => return Ok(data),
        },
        _ => return Ok(data),
    };
    let number = |key: &str, default: usize| {
        parameters.get(key).and_then(Object::integer).unwrap_or(default)
    };
    if number("Predictor", 1) == 1 {
        return Ok(data);
    }
    let width = number("Columns", 1);
    if number("Predictor", 1) < 10
        || number("Colors", 1) != 1
        || number("BitsPerComponent", 8) != 8
        || width == 0
    {
        return Err(Broken("a part of it uses a compression that is not supported"));
    }
    let mut rows: Vec<u8> = Vec::with_capacity(data.len());
    let mut above = vec![0_u8; width.min(data.len())];
    for line in data.chunks_exact(width.saturating_add(1)) {
        let mut row = vec![0_u8; width];
        for at in 0..width {
            let left = if at == 0 { 0 } else { row[at - 1] };
            let corner = if at == 0 { 0 } else { above[at - 1] };
            let guess = match line[0] {
                0 => 0,
                1 => left,
                2 => above[at],
                3 => u8::midpoint(left, above[at]),
                4 => paeth(left, above[at], corner),
                _ => return Err(Broken("a part of it cannot be unpacked")),
            };
            row[at] = line[at + 1].wrapping_add(guess);
        }
        rows.extend_from_slice(&row);
        above = row;
    }
    Ok(rows)
}

/// The neighbour closest to left + above - corner.
fn paeth(left: u8, above: u8, corner: u8) -> u8 {
    let guess = i16::from(left) + i16::from(above) - i16::from(corner);
    let far = |value: u8| (guess - i16::from(value)).abs();
    if far(left) <= far(above) && far(left) <= far(corner) {
        left
    } else if far(above) <= far(corner) {
        above
    } else {
        corner
    }
}
