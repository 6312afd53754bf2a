//! Can what is wrong with any text be drawn?

#![no_main]

use clisc::testing::assert_draws_soundly;
use libfuzzer_sys::fuzz_target;

fuzz_target!(init: clisc_fuzz::work_on_this_thread(), |bytes: &[u8]| assert_draws_soundly(bytes));
