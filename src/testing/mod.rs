//! What tests, benches and fuzz targets share.

mod stream;

pub use stream::Stream;
