//! The ray tracer: a [`SceneView`](crate::ir::SceneView) in, rows of pixels out.

mod settings;

pub use settings::{Counts, Part, SampleAt, Settings, Size};

use std::ops::Range;

use crate::ir::SceneView;

/// Renders one image, rows at a time.
#[derive(Debug)]
pub struct Tracer<'p> {
    view: SceneView<'p>,
    settings: Settings,
}

impl<'p> Tracer<'p> {
    /// Prepares the scene for one image.
    #[must_use]
    pub fn new(view: SceneView<'p>, settings: &Settings) -> Self {
        Self { view, settings: settings.clone() }
    }

    /// Renders `rows` into `rgb`, 3 bytes a pixel, row by row from the top, on all threads of the current rayon pool.
    pub fn render_rows(&self, rows: Range<u32>, rgb: &mut [u8]) -> Counts {
        assert_eq!(rgb.len(), rows.len() * self.settings.size.width() as usize * 3);
        let background = (self.view.background() * 255.0).to_array();
        for (i, byte) in rgb.iter_mut().enumerate() {
            *byte = background[i % 3] as u8;
        }
        Counts::default()
    }
}
