//! Two imprints side by side: where they differ, their descriptors, and the differences between these.
//!
//! ```text
//! 5 taxels differ   A: washer   B: the matrix        how many taxels differ | what is compared, the earlier one first
//!    0   2   4   6       A   B   B-A
//!  0 · · a █ b ·    NA   40  52  +12                 █ in both, a b in one only | descriptors of the main regions
//! ```
//! On a wide screen A and B stand beside the view of their differences; elsewhere Tab shows one after the other. If
//! there is no room for the descriptors beside a view, they are a view of their own. Parts that do not fit scroll;
//! arrows show where there is more.

pub mod page;

pub mod update;
