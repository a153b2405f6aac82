//! Reasons why something cannot be done with the shown frame.

use crate::frame::FrameError;

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LiveRefusal {
    #[error("no frame yet")]
    NoFrame,
    #[error("this frame is no longer in the history")]
    LeftHistory,
    #[error("frame {0} came before the source was watched again; frames since then can be marked")]
    EarlierWatch(u64),
    /// The frames cannot be processed together.
    #[error(transparent)]
    Frame(#[from] FrameError),
    #[error("the source has ended, so there is nothing to record")]
    SourceEnded,
    /// The source is standard input, whose bytes are gone once they are read.
    #[error("standard input cannot be read twice")]
    ReadOnce,
    #[error("the source has not ended yet")]
    NotEnded,
    /// There is no threshold, so it is unknown which values are active.
    #[error("no threshold, so no imprint")]
    NoThreshold,
    #[error("no imprint before the tare: {taken} of {wanted} frames")]
    TareIsMade { taken: u64, wanted: u64 },
    /// The frame cannot be made into an imprint.
    #[error("no imprint: {0}")]
    NoImprint(FrameError),
}
