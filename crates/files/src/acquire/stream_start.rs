//! Tells a stream from a recording that only a file can be, by the start of a source.

use crate::acquire::event::{AcquireError, AcquireOptions};
use crate::acquire::source::FrameSource;
use crate::formats::recording::{StartKind, StartSearch};
use crate::formats::stream::StreamCounts;

/// The start of a source, as long as it may be that of a recording that only a file can be. With its first frame, a
/// source is a stream.
pub(super) struct StreamStart {
    /// The search; None once it has ended.
    search: Option<StartSearch>,
    /// The number of frames before the first byte.
    frames: u64,
}

impl StreamStart {
    /// Prepares for the first byte of a source, given the counts before it. Where the bytes may begin anywhere, they do
    /// not show a recording, and a format that the user names is not doubted.
    pub(super) fn new(
        source: &FrameSource,
        options: &AcquireOptions,
        counts: &StreamCounts,
    ) -> Self {
        let is_searched = source.begins() && options.format.is_none();
        Self {
            search: is_searched.then(StartSearch::default),
            frames: counts.frames,
        }
    }

    /// Examines the next bytes, after those that gave these counts. Returns the number of those after which the kind of
    /// the source is certain, and the kind; None if it is not certain yet, or was before.
    pub(super) fn push(
        &mut self,
        bytes: &[u8],
        counts: &StreamCounts,
    ) -> Option<(usize, StartKind)> {
        self.search.take_if(|_| counts.frames > self.frames);
        let found = self.search.as_mut()?.push(bytes)?;
        self.search = None;
        Some(found)
    }

    /// Checks that a source with these counts is a stream, if it is of this kind according to its start.
    ///
    /// # Errors
    /// Returns [`AcquireError::NotStream`].
    pub(super) fn check(&self, kind: StartKind, counts: &StreamCounts) -> Result<(), AcquireError> {
        match kind {
            StartKind::Recording(format) if counts.frames == self.frames => {
                Err(AcquireError::NotStream { format })
            }
            _ => Ok(()),
        }
    }

    /// Checks that a source that has ended with these counts is a stream.
    ///
    /// # Errors
    /// Returns [`AcquireError::NotStream`].
    pub(super) fn finish(&self, counts: &StreamCounts) -> Result<(), AcquireError> {
        let search = self.search.as_ref();
        search.map_or(Ok(()), |search| self.check(search.finish(), counts))
    }
}
