//! What to watch, and how to process its frames.

use std::ffi::OsString;
use std::path::PathBuf;

use crate::acquire::AcquireOptions;
use crate::frame::{Processing, SetRule};
use crate::recognition::Noise;
use crate::storage::Existing;
use crate::storage::ModelChoice;
use crate::tui::live::history::HISTORY_BYTES;

/// A source of frames and the settings that the page begins with.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct WatchRequest {
    /// Its name: a path, `tcp://HOST:PORT`, or `-` for standard input.
    pub source: OsString,
    /// How it is read.
    pub options: AcquireOptions,
    /// Crop, flip, turn, mask and gain.
    pub processing: Processing,
    /// The threshold; without one that of the recording, if it has one.
    pub rule: Option<SetRule>,
    /// How many of the first frames a tare is made of; 0 for none.
    pub tare: u64,
    /// Whether the tare of a recording's own description is taken, where `tare` is 0.
    pub own_tare: bool,
    /// The file that all frames are recorded in from the start.
    pub write: Option<(PathBuf, Existing)>,
    /// The set of shapes that imprints are compared with.
    pub model: Option<ModelChoice>,
    /// How often a taxel flips, for that.
    pub noise: Option<Noise>,
    /// The memory for the frames that can be scrubbed through, in bytes.
    pub history_bytes: usize,
}

impl PartialEq for WatchRequest {
    /// Whether they are one: they are never changed.
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl WatchRequest {
    /// A source, looked at as it is.
    pub fn new(source: impl Into<OsString>) -> Self {
        Self {
            source: source.into(),
            options: AcquireOptions::default(),
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

    /// The same settings for another source.
    #[must_use]
    pub fn for_source(&self, source: impl Into<OsString>) -> Self {
        Self {
            source: source.into(),
            ..self.clone()
        }
    }

    /// The noise, with the dead cells of the mask left out.
    pub fn noise(&self) -> Option<Noise> {
        let noise = self.noise?;
        Some(match self.processing.view.mask {
            Some(mask) => noise.without(mask),
            None => noise,
        })
    }

    /// The source's name for people, without the folders that it is in.
    pub fn name(&self) -> String {
        let name = self.source.to_string_lossy();
        match &*name {
            "-" => "standard input".to_owned(),
            tcp if tcp.starts_with("tcp://") => tcp.to_owned(),
            path => path.rsplit('/').next().unwrap_or(path).to_owned(),
        }
    }
}
