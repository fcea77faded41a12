//! Helpers of the whole-program benches.
