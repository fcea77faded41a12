//! Synthetic scans of scenes with known planes: a table, a furnished room, a corridor
