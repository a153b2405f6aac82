//! What an imprint is described by: its regions, and the paper's descriptors of each.
//!
//! The object is 8-connected and the background 4-connected, so that a diagonal line of taxels is one piece and does
//! enclose what is behind it. Everything here is integer arithmetic on the rows' words but for the last step.

pub mod region;

mod chain;

pub mod descriptor;
