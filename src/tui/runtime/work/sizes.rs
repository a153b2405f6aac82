//! Computes the limit of one touch for each size of a set, the smallest first, then finds the smallest size that
//! reaches an error.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::formats::separation::size_label;
use crate::memory::MemoryGuard;
use crate::recognition::{SeparationPoint, SmallestSize, TrainingError};
use crate::tui::app::worker_event::WorkerEvent;
use crate::tui::recognise::confused::ConfusedPair;
use crate::tui::recognise::message::RecognitionEvent;
use crate::tui::recognise::separate::found::{SizeFound, SizesFound};
use crate::tui::recognise::separate::request::SeparationRequest;
use crate::tui::runtime::work::progress::{
    PoseLimit, ProgressReporter, WorkerEventSink, guarded, on_a_thread, proceed,
};

/// The work in progress.
#[derive(Debug, Default)]
pub(in crate::tui::runtime) struct SizeWorker {
    /// Set to stop it.
    stop: Arc<AtomicBool>,
    /// When work that is done at once is stopped.
    pub(in crate::tui::runtime) limit: PoseLimit,
}

impl SizeWorker {
    /// Looks at the sizes that are not known yet, on a thread of its own, or at once if there is no receiver; then the
    /// event is returned.
    pub(in crate::tui::runtime) fn look(
        &mut self,
        number: u64,
        request: Arc<SeparationRequest>,
        known: Vec<SeparationPoint>,
        post: Option<WorkerEventSink>,
    ) -> Option<WorkerEvent> {
        self.stop();
        self.stop = Arc::default();
        let Some(post) = post else {
            let mut sizes = Vec::new();
            let progress = self.limit.count();
            let end = scan(&request, known, &mut |size| sizes.push(size), &progress);
            return Some(event(number, sizes, Some(end)));
        };
        let stop = Arc::clone(&self.stop);
        let thread = on_a_thread(number, &post, move |post| {
            let clock = ProgressReporter::new(number, post);
            let progress = |poses| proceed(poses, &stop, Some(&clock));
            let last = guarded(number, || {
                let mut take = |size| post(event(number, vec![size], None));
                let end = scan(&request, known, &mut take, &progress);
                event(number, Vec::new(), Some(end))
            });
            post(last);
        });
        thread.err()
    }

    /// Stops the work in progress.
    pub(in crate::tui::runtime) fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

impl Drop for SizeWorker {
    fn drop(&mut self) {
        self.stop();
    }
}

/// Some sizes, or the end.
fn event(
    number: u64,
    sizes: Vec<SizeFound>,
    end: Option<Result<Option<SmallestSize>, String>>,
) -> WorkerEvent {
    let found = SizesFound { number, sizes, end };
    WorkerEvent::Recognition(RecognitionEvent::Sizes(Box::new(found)))
}

/// Looks at the sizes after those that are known, then searches for the wanted error.
fn scan(
    request: &SeparationRequest,
    known: Vec<SeparationPoint>,
    take: &mut dyn FnMut(SizeFound),
    progress: &(dyn Fn(u64) -> bool + Sync),
) -> Result<Option<SmallestSize>, String> {
    let memory = MemoryGuard::new(None, "take fewer shapes, smaller sizes or coarser steps");
    let progress = &|poses| progress(poses) && memory.allows();
    let memory = &memory;
    let sentence = |place: String| {
        move |error: TrainingError| match error {
            TrainingError::Stopped if memory.exceeded() => memory.message(),
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
        let looked = set.model_at(request.axis, value, request.threshold, progress);
        let (point, model, evaluation) = looked.map_err(place(value))?;
        points.push(point.clone());
        take(SizeFound {
            point,
            worst: ConfusedPair::worst(&model, &evaluation),
        });
    }
    let smallest = set.smallest(request.axis, &points, request.wanted, progress);
    smallest.map_err(sentence("between the sizes".to_owned()))
}
