//! Reasons why something cannot be done with the shown frame.

use crate::frame::FrameError;

/// The reason why a frame is not marked, no tare made, no imprint taken, or nothing recorded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LiveRefusal {
    /// No frame has come.
    #[error("no frame yet")]
    NoFrame,
    /// Later frames have displaced the shown one from memory.
    #[error("this frame is no longer in the history")]
    LeftHistory,
    /// The frame, of this number, came before the source was left and watched again.
    #[error("frame {0} came before the source was watched again; frames since then can be marked")]
    EarlierWatch(u64),
    /// The frames cannot be processed together.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// No frame can come any more.
    #[error("the source has ended, so there is nothing to record")]
    SourceEnded,
    /// The source is standard input, whose bytes are gone once they are read.
    #[error("standard input cannot be read twice")]
    ReadOnce,
    /// The source is still watched.
    #[error("the source has not ended yet")]
    NotEnded,
    /// There is no threshold, so it is unknown which values are active.
    #[error("no threshold, so no imprint")]
    NoThreshold,
    /// The threshold needs a tare, which is being made.
    #[error("no imprint before the tare: {taken} of {wanted} frames")]
    TareIsMade {
        /// The number of frames that have come.
        taken: u64,
        /// The number of frames that the tare will be made of.
        wanted: u64,
    },
    /// The frame cannot be made into an imprint.
    #[error("no imprint: {0}")]
    NoImprint(FrameError),
}
