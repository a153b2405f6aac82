//! The events that workers report.

use std::sync::Arc;
use std::time::Duration;

use crate::pose::{PoseGrid, PoseIndex};
use crate::tui::explore::angles::curve::AngleCurve;
use crate::tui::explore::message::{Findings, SweepProgress};
use crate::tui::live::message::LiveEvent;
use crate::tui::recognise::state::RecognitionEvent;

/// An event of a worker. It carries the number of its work; events of work that is no longer waited for are dropped.
#[derive(Clone, Debug, PartialEq)]
pub enum WorkerEvent {
    Progress(u64, SweepProgress),
    Estimate(Box<PoseGrid>, Duration),
    Answered,
    Waiting(Option<String>),
    /// The request to the disk that the user no longer waits for, in a few words.
    GivenUp(String),
    /// A sweep is over, at its end or because it was stopped.
    Swept(u64, Arc<Findings>),
    Angles(Arc<Findings>, PoseIndex, Result<Arc<AngleCurve>, String>),
    Written(u64, String),
    /// The file was not written, because a file of that name exists.
    Exists(u64, String),
    Failed(u64, String),
    Recognition(RecognitionEvent),
    Live(u64, LiveEvent),
    Refused(String),
}
