#![no_main]

use fishplate_fuzz::{prepare, run};

libfuzzer_sys::fuzz_target!(init: prepare("foreign"), |input: &[u8]| run("foreign", input));
