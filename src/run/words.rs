//! Words of messages.

/// A number with its noun: `1 section`, `2 sections`, `no quantities`.
pub fn count(number: usize, noun: &str) -> String {
    let plural =
        noun.strip_suffix('y').map_or_else(|| format!("{noun}s"), |stem| format!("{stem}ies"));
    match number {
        0 => format!("no {plural}"),
        1 => format!("1 {noun}"),
        _ => format!("{number} {plural}"),
    }
}
