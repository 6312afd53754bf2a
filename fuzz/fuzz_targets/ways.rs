//! Does any text become something else in chunks, stage by stage, or without the parser's short way?

#![no_main]

use clisc::testing::assert_ways_agree;
use libfuzzer_sys::fuzz_target;

fuzz_target!(init: clisc_fuzz::work_on_this_thread(), |bytes: &[u8]| assert_ways_agree(bytes));
