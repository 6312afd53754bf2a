//! What tests, benches and fuzz targets share.

mod format;
mod language;
mod render;
mod stream;

pub use format::assert_formats_soundly;
pub use language::{
    Explanation, assert_compiles_soundly, assert_draws_soundly, assert_parses_soundly, assert_tokens_tile,
    assert_ways_agree, explanation,
};
pub use render::assert_renders_soundly;
pub use stream::Stream;
