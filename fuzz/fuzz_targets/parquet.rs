#![no_main]

use fishplate_fuzz::{prepare, run};

libfuzzer_sys::fuzz_target!(init: prepare("parquet"), |input: &[u8]| run("parquet", input));
