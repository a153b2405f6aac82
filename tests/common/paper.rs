//! Facts about the ring of the paper's Fig. 1 (circles of 4 and 2 cells). Each is kept here once, for several tests.

/// The number of distinct imprints over all positions in one cell, in steps of 0.01.
pub(crate) const RING_IMPRINTS: usize = 393;
