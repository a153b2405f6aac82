//! Decides which of two values is active: masks of other programs consist of 0 and 1, 0 and 255, or 0 and any other
//! number.

/// The values of a mask seen so far: 0 for an inactive taxel, one other value for an active one.
pub(crate) struct Mask<T> {
    /// The value other than 0, once it has been seen.
    other: Option<T>,
    /// Whether a 0 has been seen.
    zero: bool,
}

impl<T: Copy + PartialEq> Mask<T> {
    /// Makes a mask before its first value.
    pub(crate) fn new() -> Self {
        Self {
            other: None,
            zero: false,
        }
    }

    /// Takes the next value and returns true if its taxel is active; `None` is the value 0.
    ///
    /// # Errors
    /// If this is a third value, returns the second one, which is not 0.
    pub(crate) fn take(&mut self, value: Option<T>) -> Result<bool, T> {
        let Some(value) = value else {
            self.zero = true;
            return Ok(false);
        };
        let other = *self.other.get_or_insert(value);
        if value == other { Ok(true) } else { Err(other) }
    }

    /// Returns the mask's only value, if it is not 0 and not among `active`, the values that are known to mean
    /// active.
    pub(crate) fn unclear(&self, active: &[T]) -> Option<T> {
        self.other
            .filter(|other| !self.zero && !active.contains(other))
    }
}
