//! Pictures without a window: labelled point clouds as PNG, staircase costs as SVG
