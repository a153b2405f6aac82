//! The first frames of a source, which wait for the tare that is made of them.

use crate::frame::{FirstFrames, Frame, FrameError, Tare, View};

/// The frames that wait, and the tare as far as it is made. The whole frames wait, not only their visible parts.
pub(super) struct TareQueue {
    tare: FirstFrames,
    waiting: Vec<Frame>,
    /// The number of frames that have waited, but whose size is not that of the tare.
    unfit: u64,
}

impl TareQueue {
    /// Begins a tare of this many frames; None for a tare of 0 frames.
    pub(super) fn new(frames: u64) -> Option<Self> {
        (frames > 0).then(|| Self {
            tare: FirstFrames::new(frames),
            waiting: Vec::new(),
            unfit: 0,
        })
    }

    /// Returns true before the first frame of the tare.
    pub(super) fn is_empty(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Adds a frame. Returns true once the tare is complete.
    ///
    /// # Errors
    /// Returns an error if the frame does not fit the view or the frames before it, or if the tare would take too much
    /// memory. After an error of its size, the tare is made of the frames that follow.
    pub(super) fn add(&mut self, frame: Frame, view: &View) -> Result<bool, FrameError> {
        let goes_on = self.tare.add(&frame, view)?;
        self.tare.check_memory(frame.values().len())?;
        if !goes_on {
            self.unfit += self.waiting.drain(..).len() as u64;
        }
        self.waiting.push(frame);
        Ok(self.tare.missing() == 0)
    }

    /// Returns the number of frames that have waited, but whose size is not that of the tare.
    pub(super) fn unfit(&self) -> u64 {
        self.unfit
    }

    /// Returns the error that the source has ended before the tare was complete.
    pub(super) fn incomplete(&self) -> FrameError {
        let wanted = self.tare.wanted();
        let frames = wanted - self.tare.missing();
        FrameError::Tare { frames, wanted }
    }

    /// Returns the tare, and the frames that have waited for it.
    ///
    /// # Errors
    /// Returns an error if the tare is not complete.
    pub(super) fn finish(self) -> Result<(Tare, Vec<Frame>), FrameError> {
        Ok((self.tare.finish()?, self.waiting))
    }
}
