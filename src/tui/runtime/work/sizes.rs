//! Computes the limit of one touch for each size of a set, the smallest first, then finds the smallest size that
//! reaches an error.

use std::sync::Arc;

use crate::formats::separation::size_label;
use crate::memory::MemoryGuard;
use crate::progress::Progress;
use crate::recognition::{SeparationPoint, SmallestSize, TrainingError};
use crate::tui::app::worker_event::WorkerEvent;
use crate::tui::recognise::confused::ConfusedPair;
use crate::tui::recognise::message::{RecognitionEvent, SizeFound, SizesFound};
use crate::tui::recognise::separate::request::SeparationRequest;
use crate::tui::runtime::work::execution::{Execution, StopFlag};
use crate::tui::runtime::work::progress::{ProgressReporter, WorkProgress, guarded, on_a_thread};

/// Computes the limits of the sizes that are not known yet, on a thread of its own in place of the work before; or at
/// once, and returns the event.
pub(in crate::tui::runtime) fn separate(
    number: u64,
    request: Arc<SeparationRequest>,
    known: Vec<SeparationPoint>,
    stop: &mut StopFlag,
    execution: &Execution,
) -> Option<WorkerEvent> {
    let stop = stop.renew();
    let post = match execution {
        Execution::AtOnce(limit) => {
            let mut sizes = Vec::new();
            let mut take = |size| sizes.push(size);
            let end = scan(&request, known, &mut take, &WorkProgress::up_to(*limit));
            return Some(event(number, sizes, Some(end)));
        }
        Execution::OnThreads(post) => post,
    };
    let thread = on_a_thread(number, post, move |post| {
        let clock = ProgressReporter::new(number, post);
        let progress = WorkProgress::until(&stop, Some(&clock));
        let last = guarded(number, || {
            let mut take = |size| post(event(number, vec![size], None));
            let end = scan(&request, known, &mut take, &progress);
            event(number, Vec::new(), Some(end))
        });
        post(last);
    });
    thread.err()
}

/// Returns the event with some sizes, or with the end.
fn event(
    number: u64,
    sizes: Vec<SizeFound>,
    end: Option<Result<Option<SmallestSize>, String>>,
) -> WorkerEvent {
    let found = SizesFound { number, sizes, end };
    WorkerEvent::Recognition(RecognitionEvent::Sizes(Box::new(found)))
}

/// Computes the limits of the sizes after those that are known, then searches for the wanted error.
fn scan(
    request: &SeparationRequest,
    known: Vec<SeparationPoint>,
    take: &mut dyn FnMut(SizeFound),
    progress: &WorkProgress<'_>,
) -> Result<Option<SmallestSize>, String> {
    let memory = MemoryGuard::new(None, "take fewer shapes, smaller sizes or coarser steps");
    progress.within(&memory, |progress| limits(request, known, take, progress))?
}

/// Does the same without a limit of memory.
fn limits(
    request: &SeparationRequest,
    known: Vec<SeparationPoint>,
    take: &mut dyn FnMut(SizeFound),
    progress: &dyn Progress,
) -> Result<Option<SmallestSize>, String> {
    let sentence = |place: String| {
        move |error: TrainingError| match error {
            TrainingError::Stopped => "stopped; what was found stays".to_owned(),
            error => format!("{place}: {error}"),
        }
    };
    let place = |value| sentence(size_label(request.axis, value));
    let set = request
        .separation()
        .map_err(sentence("the set".to_owned()))?;
    let mut points = known;
    for value in request.values().into_iter().skip(points.len()) {
        let found = set.model_at(request.axis, value, request.threshold, progress);
        let (point, model, evaluation) = found.map_err(place(value))?;
        points.push(point.clone());
        take(SizeFound {
            point,
            worst: ConfusedPair::worst(&model, &evaluation),
        });
    }
    let smallest = set.smallest(request.axis, &points, request.wanted, progress);
    smallest.map_err(sentence("between the sizes".to_owned()))
}
