#![no_main]

use fishplate_fuzz::{prepare, run};

libfuzzer_sys::fuzz_target!(init: prepare("catalogue"), |input: &[u8]| run("catalogue", input));
