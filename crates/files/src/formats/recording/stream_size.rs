//! The rows and columns of a stream of text: the given ones, or those of its first frame.
//!
//! A frame of another size is dropped and counted, like a torn one. However, the first frame may have been something
//! else, such as a version number, or the sensor may have been reconfigured: if no size was given, a size that
//! arrives three times in succession becomes the size.

use crate::formats::recording::side::{changed, other_than};
use crate::frame::FrameSize;

/// The number of successive frames after which another size becomes the size, if none was given.
const AGAIN: u8 = 3;

/// The size of the frames of a stream.
#[derive(Clone, Debug)]
pub(in crate::formats) struct StreamSize {
    /// The current rows and columns: the given ones, otherwise those of the first whole frame, until others arrive
    /// repeatedly.
    present: Option<FrameSize>,
    /// Whether rows and columns were given.
    is_named: bool,
    /// Another size, and the number of successive frames that have had it.
    other: Option<(FrameSize, u8)>,
}

impl StreamSize {
    /// Starts with the given rows and columns, if any.
    pub(in crate::formats) fn new(named: Option<FrameSize>) -> Self {
        Self {
            present: named,
            is_named: named.is_some(),
            other: None,
        }
    }

    /// Sets the rows and columns, if none are known yet.
    pub(in crate::formats) fn begin(&mut self, own: FrameSize) {
        self.present.get_or_insert(own);
    }

    /// Returns the current rows and columns; None before the first frame if none were given.
    pub(in crate::formats) fn present(&self) -> Option<FrameSize> {
        self.present
    }

    /// Returns the rows and columns if they were given.
    pub(in crate::formats) fn named(&self) -> Option<FrameSize> {
        self.present.filter(|_| self.is_named)
    }

    /// Notes a whole frame of these rows and columns.
    ///
    /// # Errors
    /// Returns why the frame is none of the stream, such as `found 3 rows of 2, expected 2 of 2`.
    pub(in crate::formats) fn admit(&mut self, own: FrameSize) -> Result<(), String> {
        let size = *self.present.get_or_insert(own);
        if own == size {
            self.other = None;
            return Ok(());
        }
        if self.is_named {
            self.other = None;
            return Err(other_than(own, size));
        }
        let times = match self.other {
            Some((other, times)) if other == own => times + 1,
            _ => 1,
        };
        if times < AGAIN {
            self.other = Some((own, times));
            return Err(changed(own, size));
        }
        (self.present, self.other) = (Some(own), None);
        Ok(())
    }

    /// Notes a frame that is not whole, which interrupts a succession of frames of another size.
    pub(in crate::formats) fn pass_torn(&mut self) {
        self.other = None;
    }
}
