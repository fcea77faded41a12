//! Minimisers of staircase-shaped costs: controlled random search that never evaluates a known step twice
