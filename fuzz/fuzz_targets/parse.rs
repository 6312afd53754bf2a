//! Does any text break a law of the lexer or the parser?

#![no_main]

use clisc::testing::{assert_parses_soundly, assert_tokens_tile};
use libfuzzer_sys::fuzz_target;

fuzz_target!(init: clisc_fuzz::work_on_this_thread(), |bytes: &[u8]| {
    assert_tokens_tile(bytes);
    assert_parses_soundly(bytes);
});
