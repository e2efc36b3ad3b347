//! Ctrl-C.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use thiserror::Error;

/// The handler for Ctrl-C cannot be set.
#[derive(Debug, Error)]
#[error("cannot listen to Ctrl-C: {0}")]
pub struct InterruptError(#[from] ctrlc::Error);

/// The wish to stop. Renderers ask for it between tiles, and keep what is there.
///
/// The first Ctrl-C (or a polite request to terminate) sets it; the second one ends the process at once with exit
/// status 130.
///
/// ```
/// use lichtwerk::output::Interrupt;
///
/// let interrupt = Interrupt::inactive();
/// let (mut tiles, limit) = (0, 10);
/// while tiles < limit && !interrupt.is_requested() {
///     tiles += 1;
///     if tiles == 4 {
///         interrupt.request();
///     }
/// }
/// assert_eq!(tiles, 4);
/// ```
#[derive(Clone, Debug, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Nobody listens to Ctrl-C: only [`request`](Self::request) sets it.
    pub fn inactive() -> Self {
        Self::default()
    }

    /// Listens to Ctrl-C from now on. Once per process.
    ///
    /// # Errors
    /// [`InterruptError`] if the process listens already, or the system refuses.
    pub fn install() -> Result<Self, InterruptError> {
        let interrupt = Self::default();
        let requested = interrupt.clone();
        ctrlc::try_set_handler(move || {
            if requested.0.swap(true, Ordering::SeqCst) {
                std::process::exit(130);
            }
        })?;
        Ok(interrupt)
    }

    /// Whether to stop.
    pub fn is_requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Asks to stop, as Ctrl-C does.
    pub fn request(&self) {
        self.0.store(true, Ordering::SeqCst);
    }
}
