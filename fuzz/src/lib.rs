//! What is fuzzed, and what must hold of every input. Each target takes any bytes and panics where
//! a promise is broken.
//!
//! The fuzzer's programs (`fuzz_targets`) call these functions; `tests/project/fuzz` of the main package
//! calls them with every seed and every input that once failed, so that they are tried wherever the
//! tests run.

mod campaign;
mod escape;
mod foreign;
mod language;
mod promise;
mod records;
pub mod seeds;
mod simulators;

/// What a target does with an input.
type Try = fn(&[u8]);

/// Every target: its name and what it is given.
pub const TARGETS: [(&str, Try); 21] = [
    ("protocol_text", language::protocol_text),
    ("protocol_yaml", language::protocol_yaml),
    ("check", language::check),
    ("phrase", language::phrase),
    ("record", records::record),
    ("parquet", records::parquet),
    ("foreign", foreign::foreign),
    ("mdf4", foreign::mdf4),
    ("mat", foreign::mat),
    ("xlsx", foreign::xlsx),
    ("tdms", foreign::tdms),
    ("columnar", foreign::columnar),
    ("mapping", foreign::mapping),
    ("table", records::table),
    ("campaign", campaign::campaign),
    ("vehicle", campaign::vehicle),
    ("sections", campaign::sections),
    ("catalogue", simulators::catalogue),
    ("simulator", simulators::simulator),
    ("escape", escape::escape),
    ("report", escape::report),
];

/// Runs a target by its name.
///
/// # Panics
/// A promise is broken, or there is no such target.
pub fn run(name: &str, input: &[u8]) {
    let found = TARGETS.iter().find(|(target, _)| *target == name);
    let (_, target) = found.unwrap_or_else(|| panic!("no target `{name}`"));
    target(input);
}

/// Puts the seeds of a target into its corpus: what a fuzzer's program does first.
///
/// # Panics
/// They cannot be written.
pub fn prepare(name: &str) {
    let here = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let root = here.parent().unwrap_or(here);
    if let Err(error) = seeds::write(root, &here.join("corpus"), name) {
        panic!("the seeds of `{name}` cannot be written: {error}");
    }
}
