//! What the program says on standard output.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write, stdout};

/// As `print!`, for an output that may be closed at any time: `terrace info scan.ply | head -3`.
macro_rules! out {
    ($($said:tt)*) => { $crate::output::say(format_args!($($said)*)) };
}

/// As `println!`, likewise.
macro_rules! outln {
    ($($said:tt)*) => { $crate::output::say(format_args!("{}\n", format_args!($($said)*))) };
}

/// Who reads no further has seen enough: nothing more is said, and the work goes on. Where what is said is to be kept and cannot be, the
/// program ends.
pub(crate) fn say(said: Arguments<'_>) {
    if let Err(error) = stdout().lock().write_fmt(said)
        && error.kind() != ErrorKind::BrokenPipe
    {
        eprintln!("terrace: standard output: {error}");
        terrace_io::abandon_outputs();
        std::process::exit(1);
    }
}
