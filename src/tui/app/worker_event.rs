//! The events that workers report.

use std::sync::Arc;
use std::time::Duration;

use crate::pose::{PoseGrid, PoseIndex};
use crate::tui::explore::angles::curve::AngleCurve;
use crate::tui::explore::message::{Findings, SweepProgress};
use crate::tui::live::message::LiveEvent;
use crate::tui::recognise::message::RecognitionEvent;

/// An event of a worker. It carries the number of its work; events of work that is no longer waited for are dropped.
#[derive(Clone, Debug, PartialEq)]
pub enum WorkerEvent {
    /// The progress of the work.
    Progress(u64, SweepProgress),
    /// An estimate of the time that a grid will take.
    Estimate(Box<PoseGrid>, Duration),
    /// The disk has answered a request.
    Answered,
    /// The request to the disk that the user waits for; None if there is none.
    Waiting(Option<String>),
    /// The request to the disk that the user no longer waits for, in a few words.
    GivenUp(String),
    /// A sweep is over, at its end or because it was stopped.
    Swept(u64, Arc<Findings>),
    /// The imprints of each angle of these results at a place, or the reason why they were not found.
    Angles(Arc<Findings>, PoseIndex, Result<Arc<AngleCurve>, String>),
    /// A file was written.
    Written(u64, String),
    /// The file was not written, because a file of that name exists.
    Exists(u64, String),
    /// The work failed, and why.
    Failed(u64, String),
    /// An event of recognition.
    Recognition(RecognitionEvent),
    /// An event of the frames that the work of that number watches.
    Live(u64, LiveEvent),
    /// A request that belongs to no piece of work was refused, and why.
    Refused(String),
}
