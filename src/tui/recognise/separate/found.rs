//! The worker's results about sizes.

use crate::recognition::{SeparationPoint, SmallestSize};
use crate::tui::recognise::confused::ConfusedPair;

/// The result for one size.
#[derive(Clone, Debug, PartialEq)]
pub struct SizeFound {
    /// The limit of one touch.
    pub point: SeparationPoint,
    /// The pair that is confused most: a shape and the one for which it is taken; None if no shape is confused.
    pub worst: Option<ConfusedPair>,
}

/// The results for some sizes, or the end of the work.
#[derive(Clone, Debug, PartialEq)]
pub struct SizesFound {
    /// The number of the work.
    pub number: u64,
    /// Results for sizes, in the order of the sizes.
    pub sizes: Vec<SizeFound>,
    /// At the end of the work: the smallest size that reaches the wanted error, or the reason why the work ended
    /// early.
    pub end: Option<Result<Option<SmallestSize>, String>>,
}
