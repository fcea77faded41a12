//! Helpers of the whole-workspace tests.
