//! Writing to a terminal or a pipe whose reader may go away (`stoss schema | head`): that is no reason to fail, and none to panic.

use std::io::{ErrorKind, Write};
use std::process::ExitCode;

/// Writes a line to standard error; whoever closed it does not want it.
macro_rules! say {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stderr(), $($text)*);
    }};
}
pub(crate) use say;

/// Writes text and a line feed to standard output. Fails with exit code 1 if that cannot be written, but not if the reader has gone away.
pub(crate) fn tell(text: &str) -> ExitCode {
    let mut out = std::io::stdout();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            say!("error: standard output: {error}");
            ExitCode::from(1)
        }
        _ => ExitCode::SUCCESS,
    }
}

/// Writes a line to standard output at once; a reader that has gone away does not want it.
pub(crate) fn tell_line(text: &str) {
    let mut out = std::io::stdout();
    let _ = writeln!(out, "{text}").and_then(|()| out.flush());
}
