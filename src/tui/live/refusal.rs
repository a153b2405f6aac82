//! Why something cannot be done with the frame that is shown.

use crate::frame::FrameError;

/// Why a frame is not marked, no tare made of frames, no imprint taken, or nothing recorded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LiveRefusal {
    /// No frame has come.
    #[error("no frame yet")]
    NoFrame,
    /// Later frames have taken the memory of the one that is shown.
    #[error("this frame is no longer in the history")]
    LeftHistory,
    /// The frame came before the source was left and watched again.
    #[error("frame {0} came before the source was watched again; frames since then can be marked")]
    EarlierWatch(u64),
    /// The frames cannot be processed together.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// No frame can come any more.
    #[error("the source has ended, so there is nothing to record")]
    SourceEnded,
    /// Nothing says which values are active.
    #[error("no threshold, so no imprint")]
    NoThreshold,
    /// The threshold needs a tare, which is being made.
    #[error("no imprint before the tare: {taken} of {wanted} frames")]
    TareIsMade {
        /// Frames that have come.
        taken: u64,
        /// Frames that it will be made of.
        wanted: u64,
    },
    /// The frame cannot be made into an imprint.
    #[error("no imprint: {0}")]
    NoImprint(FrameError),
}
