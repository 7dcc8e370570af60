//! Bounds against looking at every design.
