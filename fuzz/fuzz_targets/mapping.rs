#![no_main]

use fishplate_fuzz::{prepare, run};

libfuzzer_sys::fuzz_target!(init: prepare("mapping"), |input: &[u8]| run("mapping", input));
