//! What a shape is chosen for.

/// What a shape is chosen for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// To be brought onto the matrix.
    Load,
    /// To be removed.
    Delete,
    /// To be moved about.
    Picture,
}
