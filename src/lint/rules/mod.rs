//! The rules, a file each, and what several of them share.

mod cylinders;
mod settings;

pub(super) mod behind_eye;
pub(super) mod below_pixel;
pub(super) mod coincident_caps;
pub(super) mod dark_light;
pub(super) mod eye_inside;
pub(super) mod fills_view;
pub(super) mod hidden_copy;
pub(super) mod hidden_inside;
pub(super) mod light_inside;
pub(super) mod name_unlike_file;
pub(super) mod no_light;
pub(super) mod outside_view;
pub(super) mod overlapping_walls;
pub(super) mod overridden_setting;
pub(super) mod repeated_setting;
pub(super) mod too_bright;
pub(super) mod unused_allow;
pub(super) mod unused_surface;
