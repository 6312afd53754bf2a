//! The scene as the graphics wing knows it: arenas, a command list, and the proof that both are sound.
//!
//! Lowering builds a [`Program`]; [`validate()`] turns it into a [`Valid`], the only thing a renderer takes. A `write` sees
//! the arenas through a [`SceneView`], a set of lengths, so that nothing is copied.
//!
//! Never here: text, rays, anything that edits a finished program.

mod arena;
mod dump;
mod equations;
mod program;
mod scene;
mod validate;
mod view;

pub use arena::{Arena, Handle};
pub use dump::{dump_arenas, dump_arenas_json, dump_commands, dump_commands_json};
pub use equations::{EquationId, Equations};
pub use program::{Command, Origins, Program};
pub use scene::{Cylinder, Light, Sphere, Surface};
pub use validate::{Valid, Violation, validate};
pub use view::{Registers, SceneView};
