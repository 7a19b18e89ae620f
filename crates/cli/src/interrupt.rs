//! Ctrl-C and SIGTERM: the first one ends the run after the present step, a second one ends the program at once.

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How often the flag is checked in order to say that it was raised.
const LOOK: Duration = Duration::from_millis(50);

/// Watches for signals: from now on the first SIGINT or SIGTERM raises `stop`, and calls `raised` once from another thread; a second one ends the process
/// with the code 128 plus the number of the signal, as if it had not been caught. SIGHUP is left alone, so that `nohup` works.
///
/// # Errors
/// If the system refuses a handler.
pub fn watch(stop: &Arc<AtomicBool>, raised: impl FnOnce() + Send + 'static) -> io::Result<()> {
    for signal in [SIGINT, SIGTERM] {
        // In this order: the first signal finds the flag down, and raises it.
        flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(stop))?;
        flag::register(signal, Arc::clone(stop))?;
    }
    let stop = Arc::clone(stop);
    std::thread::Builder::new().name("interrupt".into()).spawn(move || {
        while !stop.load(Ordering::Relaxed) {
            std::thread::sleep(LOOK);
        }
        raised();
    })?;
    Ok(())
}
