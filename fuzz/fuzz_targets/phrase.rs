#![no_main]

use fishplate_fuzz::{prepare, run};

libfuzzer_sys::fuzz_target!(init: prepare("phrase"), |input: &[u8]| run("phrase", input));
