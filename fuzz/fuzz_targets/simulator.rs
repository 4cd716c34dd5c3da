#![no_main]

use fishplate_fuzz::{prepare, run};

libfuzzer_sys::fuzz_target!(init: prepare("simulator"), |input: &[u8]| run("simulator", input));
