//! The effects that `update` returns: requests to the runtime or the terminal.

use std::path::PathBuf;
use std::sync::Arc;

use crate::formats::recording::{RecordedView, RecordingMetadata};
use crate::imprint::Imprint;
use crate::pose::{PoseGrid, PoseIndex};
use crate::storage::Existing;
use crate::storage::ModelChoice;
use crate::tui::app::library::LibraryRequest;
use crate::tui::explore::message::Findings;
use crate::tui::live::naming::NamingRequest;
use crate::tui::live::request::WatchRequest;
use crate::tui::recognise::message::PoseSearch;
use crate::tui::recognise::trained::TrainedModel;

/// A request of `update` to the runtime or the terminal.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// A request to the library; its answer is a message, perhaps much later: a disk may hang.
    Library(LibraryRequest),
    /// Recover the offered unsaved work.
    Recover,
    /// Move the offered unsaved work to the trash.
    GiveUp,
    /// A request about files; its answer is a message, perhaps much later, too.
    File(FileRequest),
    /// Work for a worker.
    Work(Work),
    /// Work about a source of frames.
    Frames(FrameWork),
    /// Something that only the terminal can do.
    Terminal(TerminalEffect),
}

/// A request about files.
#[derive(Clone, Debug, PartialEq)]
pub enum FileRequest {
    /// Open a file that holds an imprint or a shape.
    Open(String),
    /// Write a file, given its name, its content, and the rule for a file that exists.
    Write(String, Vec<u8>, Existing),
    /// Check whether a source of frames can be read.
    Source(Arc<WatchRequest>),
    /// List the paths that begin like this.
    Paths(String),
}

/// An effect on the terminal.
#[derive(Clone, Debug, PartialEq)]
pub enum TerminalEffect {
    /// Redraw the whole screen.
    Redraw,
    /// Stop, as Ctrl-Z does, until the shell continues the program.
    Suspend,
    /// Copy a text to the clipboard of the user's terminal.
    Copy(String),
}

/// Work for a worker. Its number distinguishes its events from those of earlier work.
#[derive(Clone, Debug, PartialEq)]
pub enum Work {
    /// Estimate the time that a sweep takes.
    Measure(Box<PoseGrid>),
    /// Sweep a grid.
    Sweep(u64, Box<PoseGrid>),
    /// Find the imprints of each angle at the zooms of a place.
    Angles(Arc<Findings>, PoseIndex),
    /// Write the result of a sweep to a file.
    Write(u64, Arc<Findings>, String, Existing),
    /// Stop the work in progress.
    Stop,
    /// Train a model, or read it; the model of the set so far stays if its file was not written again.
    Prepare(u64, ModelChoice, Option<Arc<TrainedModel>>),
    /// Stop preparing a model.
    StopPreparing,
    /// Search a model for the nearest imprint, and for the poses of the named shape, or of the nearest imprint's
    /// shape.
    FindPoses(u64, Box<PoseSearch>),
    /// Stop the search.
    StopFindingPoses,
}

/// Work about a source of frames.
#[derive(Clone, Debug, PartialEq)]
pub enum FrameWork {
    /// Watch a source of frames, recorded from the start or not, and name their imprints or not.
    Watch {
        /// The number of this work.
        number: u64,
        /// The source, and how it is read.
        request: Arc<WatchRequest>,
        /// The file that all frames are recorded in; None to record nothing, as when a source is watched again: a
        /// finished recording is left alone.
        write: Option<(PathBuf, Existing)>,
        /// The request to name imprints; None to name none.
        naming: Option<Box<NamingRequest>>,
    },
    /// Stop watching.
    StopWatching,
    /// Record all frames of the source that is watched.
    Record(Box<RecordingMetadata>),
    /// Stop recording.
    StopRecording,
    /// Write threshold, tare and marks into the metadata of the recording.
    WriteMetadata(Box<RecordedView>),
    /// Name the imprints of the source of that number; None to stop naming them.
    NameBy(u64, Option<Box<NamingRequest>>),
    /// Name an imprint.
    Name(Box<Imprint>),
}
