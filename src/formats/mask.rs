//! Which of two values a taxel has: masks of other programs are 0 and 1, 0 and 255, or 0 and any other number.

/// The values of a mask as they come: 0 for an inactive taxel, one other value for an active one.
pub(crate) struct Mask<T> {
    /// The value other than 0, once there was one.
    other: Option<T>,
    /// Whether there was a 0.
    zero: bool,
}

impl<T: Copy + PartialEq> Mask<T> {
    /// Nothing was seen yet.
    pub(crate) fn new() -> Self {
        Self {
            other: None,
            zero: false,
        }
    }

    /// Returns whether the taxel of the next value is active; `None` is the value 0.
    ///
    /// # Errors
    /// For a third value; the second one, which is not 0.
    pub(crate) fn take(&mut self, value: Option<T>) -> Result<bool, T> {
        let Some(value) = value else {
            self.zero = true;
            return Ok(false);
        };
        let other = *self.other.get_or_insert(value);
        if value == other { Ok(true) } else { Err(other) }
    }

    /// The only value, where none is 0 and it is not one of those that are known to mean active.
    pub(crate) fn unclear(&self, active: &[T]) -> Option<T> {
        self.other
            .filter(|other| !self.zero && !active.contains(other))
    }
}
