//! The effects that `update` returns: requests to the runtime or the terminal.

use std::path::PathBuf;
use std::sync::Arc;

use taxel_core::pose::{PoseGrid, PoseIndex};
use taxel_files::formats::recording::{RecordedView, RecordingMetadata};
use taxel_files::storage::{Existing, ModelChoice};

use crate::tui::explore::message::Findings;
use crate::tui::live::message::WatchRequest;
use crate::tui::recognise::state::PoseSearch;
use crate::tui::recognise::trained::TrainedModel;

#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    Work(Work),
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
pub enum Work {
    Measure(Box<PoseGrid>),
    Sweep(u64, Box<PoseGrid>),
    Angles(Arc<Findings>, PoseIndex),
    Write(u64, Arc<Findings>, String, Existing),
    Stop,
    /// Train a model, or read it; the model of the set so far stays if its file was not written again.
    Prepare(u64, ModelChoice, Option<Arc<TrainedModel>>),
    StopPreparing,
    FindPoses(u64, Box<PoseSearch>),
    StopFindingPoses,
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
