//! What tests, benches and fuzz targets share.

mod language;
mod stream;

pub use language::{Explanation, assert_compiles_soundly, assert_parse_is_stable, assert_tokens_tile, explanation};
pub use stream::Stream;
