//! What tests, benches and fuzz targets share.

mod language;
mod render;
mod stream;

pub use language::{Explanation, assert_compiles_soundly, assert_parse_is_stable, assert_tokens_tile, explanation};
pub use render::assert_renders_soundly;
pub use stream::Stream;
