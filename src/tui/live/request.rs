//! A request to watch a source, and how its frames are processed.

use std::ffi::OsStr;
use std::path::PathBuf;

use crate::acquire::{AcquireOptions, SourceName};
use crate::frame::{Processing, SetRule};
use crate::recognition::Noise;
use crate::storage::Existing;
use crate::storage::ModelChoice;
use crate::tui::live::history::HISTORY_BYTES;

#[derive(Clone, Debug)]
pub struct WatchRequest {
    pub source: SourceName,
    pub options: AcquireOptions,
    pub baud_named: bool,
    /// The processing of frames: crop, flip, turn, mask and gain.
    pub processing: Processing,
    /// The threshold; None takes the threshold of the recording, if it has one.
    pub rule: Option<SetRule>,
    /// The number of first frames that a tare is made of; 0 for no tare.
    pub tare: u64,
    pub own_tare: bool,
    pub write: Option<(PathBuf, Existing)>,
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

    #[must_use]
    pub fn for_source(&self, source: impl AsRef<OsStr>) -> Self {
        Self {
            source: SourceName::new(source),
            ..self.clone()
        }
    }

    pub fn noise(&self) -> Option<Noise> {
        let noise = self.noise?;
        Some(match self.processing.view.mask {
            Some(mask) => noise.with_dead(mask),
            None => noise,
        })
    }

    pub fn name(&self) -> String {
        self.source.short()
    }
}
