//! The rows and columns of a stream of text: those that were named, or those of its first frame.
//!
//! A frame of another size is dropped and counted, like one that is torn. The first frame may have been something else,
//! such as the number of a version, or the sensor may have been set up anew: where no size was named, one that comes
//! three times in a row becomes the size.

/// Frames in a row that another size needs to become the size, where none was named.
const AGAIN: u8 = 3;

/// The size of the frames of a stream.
#[derive(Clone, Debug)]
pub(super) struct FrameSize {
    /// Rows and columns: as named, else those of the first whole frame, until other ones come again and again.
    present: Option<(u16, u16)>,
    /// Whether they were named.
    is_named: bool,
    /// Another size, and how many frames in a row have had it.
    other: Option<((u16, u16), u8)>,
}

impl FrameSize {
    /// The rows and columns that were named, if any.
    pub(super) fn new(named: Option<(u16, u16)>) -> Self {
        Self {
            present: named,
            is_named: named.is_some(),
            other: None,
        }
    }

    /// Begins with these rows and columns, where none are known yet.
    pub(super) fn begin(&mut self, own: (u16, u16)) {
        self.present.get_or_insert(own);
    }

    /// Rows and columns; None before the first frame where none were named.
    pub(super) fn present(&self) -> Option<(u16, u16)> {
        self.present
    }

    /// Rows and columns, if they were named.
    pub(super) fn named(&self) -> Option<(u16, u16)> {
        self.present.filter(|_| self.is_named)
    }

    /// Whether a whole frame of these rows and columns is one of the stream.
    pub(super) fn admits(&mut self, own: (u16, u16)) -> bool {
        let size = *self.present.get_or_insert(own);
        if own == size || self.is_named {
            self.other = None;
            return own == size;
        }
        let times = match self.other {
            Some((other, times)) if other == own => times + 1,
            _ => 1,
        };
        if times < AGAIN {
            self.other = Some((own, times));
            return false;
        }
        (self.present, self.other) = (Some(own), None);
        true
    }

    /// Notes a frame that is not whole, which ends a row of those of another size.
    pub(super) fn pass_torn(&mut self) {
        self.other = None;
    }
}
