//! Does any text break a law of what `clisc check` finds out?

#![no_main]

use clisc::testing::assert_compiles_soundly;
use libfuzzer_sys::fuzz_target;

fuzz_target!(init: clisc_fuzz::work_on_this_thread(), |bytes: &[u8]| assert_compiles_soundly(bytes));
