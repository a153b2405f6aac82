//! What workers report.

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
    /// How far it is.
    Progress(u64, SweepProgress),
    /// How long a grid will take, about.
    Estimate(Box<PoseGrid>, Duration),
    /// The disk has answered a request.
    Answered,
    /// What the disk is waited for; None if for nothing.
    Waiting(Option<String>),
    /// Something that the disk is no longer waited for, in a few words.
    GivenUp(String),
    /// A sweep is over, at its end or because it was stopped.
    Swept(u64, Arc<Findings>),
    /// The imprints of each angle of these results at a place, or why they were not found.
    Angles(Arc<Findings>, PoseIndex, Result<Arc<AngleCurve>, String>),
    /// A file was written.
    Written(u64, String),
    /// It was not written, because a file of that name exists.
    Exists(u64, String),
    /// The work failed, and why.
    Failed(u64, String),
    /// Something about models.
    Recognition(RecognitionEvent),
    /// Something about the frames that the work of that number watches.
    Live(u64, LiveEvent),
    /// Something that belongs to no piece of work cannot be done, and why.
    Refused(String),
}
