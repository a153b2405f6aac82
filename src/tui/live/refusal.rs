//! Why something cannot be done with the frame that is shown.

use crate::frame::FrameError;

/// Why a frame is not marked, no tare made of frames, or no imprint taken.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LiveRefusal {
    /// No frame has come.
    #[error("no frame yet")]
    NoFrame,
    /// The frame came before the source was left and watched again.
    #[error("frame {0} came before the source was watched again; frames since then can be marked")]
    EarlierWatch(u64),
    /// The frames cannot be processed together.
    #[error(transparent)]
    Frame(#[from] FrameError),
}
