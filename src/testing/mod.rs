//! What tests, benches and fuzz targets share.

mod format;
mod language;
mod render;
mod stream;

pub use format::assert_formats_soundly;
pub use language::{Explanation, assert_compiles_soundly, assert_parse_is_stable, assert_tokens_tile, explanation};
pub use render::assert_renders_soundly;
pub use stream::Stream;
