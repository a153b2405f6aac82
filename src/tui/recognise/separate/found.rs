//! What the worker finds about sizes.

use crate::recognition::{SeparationPoint, SmallestSize};
use crate::tui::recognise::confused::ConfusedPair;

/// What was found of one size.
#[derive(Clone, Debug, PartialEq)]
pub struct SizeFound {
    /// The limit of one touch.
    pub point: SeparationPoint,
    /// The shape that is taken most often for another one; None if none is.
    pub worst: Option<ConfusedPair>,
}

/// Some sizes, or the end of the work.
#[derive(Clone, Debug, PartialEq)]
pub struct SizesFound {
    /// The number of the work.
    pub number: u64,
    /// Sizes, in their order.
    pub sizes: Vec<SizeFound>,
    /// At the end of the work: the smallest size that reaches the wanted error, or why the work ended too early.
    pub end: Option<Result<Option<SmallestSize>, String>>,
}
