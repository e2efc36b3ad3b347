//! What leaves the program: files, the viewer, the terminal.
//!
//! - [`write_atomically`], [`save_image`]: a file is either the old one or the new one, whatever happens in between.
//! - [`Checkpoint`]: a rendering, or a part of it, that can be continued and put together.
//! - [`RenderStats`]: what a render did, for scripts.
//! - [`Display`]: the image so far in the viewer tev.
//! - [`Progress`]: rate and time left, on terminals only.
//! - [`Interrupt`]: Ctrl-C asks to stop, a second one insists.

mod atomic;
mod checkpoint;
mod display;
mod image_file;
mod interrupt;
mod progress;
mod stats;

pub use atomic::{OutputError, check_writable, write_atomically};
pub use checkpoint::{Checkpoint, CheckpointError, Described};
pub use display::{Display, DisplayError};
pub use image_file::{ImageFormat, save_image};
pub use interrupt::{Interrupt, InterruptError};
pub use progress::Progress;
pub use stats::{RenderStats, peak_bytes, write_json};
