//! A request to watch a source, and how its frames are processed.

use std::ffi::OsStr;
use std::path::PathBuf;

use crate::acquire::{AcquireOptions, SourceName};
use crate::frame::{Processing, SetRule};
use crate::recognition::Noise;
use crate::storage::Existing;
use crate::storage::ModelChoice;
use crate::tui::live::history::HISTORY_BYTES;

/// A source of frames and the settings that the page begins with.
#[derive(Clone, Debug)]
pub struct WatchRequest {
    /// The name of the source.
    pub source: SourceName,
    /// The options for reading the source.
    pub options: AcquireOptions,
    /// Whether the bits per second were given for this source.
    pub baud_named: bool,
    /// The processing of frames: crop, flip, turn, mask and gain.
    pub processing: Processing,
    /// The threshold; None takes the threshold of the recording, if it has one.
    pub rule: Option<SetRule>,
    /// The number of first frames that a tare is made of; 0 for no tare.
    pub tare: u64,
    /// Whether the tare in the recording's own metadata is used if `tare` is 0.
    pub own_tare: bool,
    /// The file that all frames are recorded in from the start.
    pub write: Option<(PathBuf, Existing)>,
    /// The set of shapes that imprints are compared with.
    pub model: Option<ModelChoice>,
    /// The noise for that comparison: how often a taxel flips.
    pub noise: Option<Noise>,
    /// The memory for the frames that can be scrubbed through, in bytes.
    pub history_bytes: usize,
}

impl PartialEq for WatchRequest {
    /// Returns true if both are the same object in memory; a request never changes.
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl WatchRequest {
    /// Creates a request for a source with default settings.
    pub fn new(source: impl AsRef<OsStr>) -> Self {
        Self {
            source: SourceName::new(source),
            options: AcquireOptions::default(),
            baud_named: false,
            processing: Processing::default(),
            rule: None,
            tare: 0,
            own_tare: true,
            write: None,
            model: None,
            noise: None,
            history_bytes: HISTORY_BYTES,
        }
    }

    /// Returns a request with the same settings for another source.
    #[must_use]
    pub fn for_source(&self, source: impl AsRef<OsStr>) -> Self {
        Self {
            source: SourceName::new(source),
            ..self.clone()
        }
    }

    /// Returns the noise, without the dead cells of the mask.
    pub fn noise(&self) -> Option<Noise> {
        let noise = self.noise?;
        Some(match self.processing.view.mask {
            Some(mask) => noise.with_dead(mask),
            None => noise,
        })
    }

    /// Returns the name of the source for display, without folders.
    pub fn name(&self) -> String {
        self.source.short()
    }
}
