//! The effects that `update` returns: requests to the runtime or the terminal.

use std::path::PathBuf;
use std::sync::Arc;

use taxel_files::formats::recording::{RecordedView, RecordingMetadata};
use taxel_files::storage::Existing;

use crate::tui::live::message::WatchRequest;

#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    Frames(FrameWork),
    Terminal(TerminalEffect),
}

#[derive(Clone, Debug, PartialEq)]
pub enum TerminalEffect {
    Redraw,
    Suspend,
    Copy(String),
}

#[derive(Clone, Debug, PartialEq)]
pub enum FrameWork {
    Watch {
        number: u64,
        request: Arc<WatchRequest>,
        /// The file that all frames are recorded in; None to record nothing, as when a source is watched again: a
        /// finished recording is left alone.
        write: Option<(PathBuf, Existing)>,
    },
    StopWatching,
    Record(Box<RecordingMetadata>),
    StopRecording,
    WriteMetadata(Box<RecordedView>),
}
