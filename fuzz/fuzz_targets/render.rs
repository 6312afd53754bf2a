//! Does any scene break a law of the renderer?

#![no_main]

use clisc::testing::assert_renders_soundly;
use libfuzzer_sys::fuzz_target;

fuzz_target!(init: clisc_fuzz::work_on_this_thread(), |bytes: &[u8]| assert_renders_soundly(bytes));
