#![no_main]

use fishplate_fuzz::{prepare, run};

libfuzzer_sys::fuzz_target!(init: prepare("mdf4"), |input: &[u8]| run("mdf4", input));
