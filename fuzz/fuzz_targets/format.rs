//! Does formatting any text lose a comment, change the program, touch an error, or want to be done twice?

#![no_main]

use clisc::testing::assert_formats_soundly;
use libfuzzer_sys::fuzz_target;

fuzz_target!(init: clisc_fuzz::work_on_this_thread(), |bytes: &[u8]| {
    assert_formats_soundly(bytes);
});
