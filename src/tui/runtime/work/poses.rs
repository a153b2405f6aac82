//! Searches a model for an imprint: the nearest imprint of the set, and the poses that leave it.
//!
//! ```text
//! FindPoses(number, search)  -> Searched, also after StopFindingPoses: the screen begins the next one after it
//! ```
//! The nearest imprint is found soon. Its poses take a sweep of the whole grid, and are not kept in the model.

use std::sync::Arc;

use crate::memory::MemoryGuard;
use crate::tui::app::worker_event::WorkerEvent;
use crate::tui::recognise::message::{PoseSearch, PoseSearchResult, RecognitionEvent};
use crate::tui::runtime::work::execution::{Execution, StopFlag, WorkProgress, caught, start};

/// The largest number of poses whose outlines are drawn; more cannot be told apart over a matrix.
const POSES: usize = 13;

/// Begins a search on a thread of its own, in place of the one before; or searches at once and returns the event.
pub(in crate::tui::runtime) fn find(
    number: u64,
    request: Box<PoseSearch>,
    stop: &mut StopFlag,
    execution: &Execution,
) -> Option<WorkerEvent> {
    let stop = stop.renew();
    let event = move |found: Result<PoseSearchResult, String>| {
        let searched = RecognitionEvent::Searched(number, found.map(Box::new));
        WorkerEvent::Recognition(searched)
    };
    let run = move |progress: &WorkProgress<'_>| {
        search(&request, &MemoryGuard::of_pose_search(), progress)
    };
    let post = match execution {
        Execution::AtOnce(limit) => return Some(event(Ok(run(&WorkProgress::up_to(*limit))))),
        Execution::OnThreads(post) => Arc::clone(post),
    };
    let work = move || {
        let progress = WorkProgress::until(&stop, None);
        post(event(caught(|| run(&progress))));
    };
    let thread = start(work);
    thread.err().map(|reason| event(Err(reason)))
}

/// Searches, and stops the sweep when `progress` says so.
fn search(
    request: &PoseSearch,
    memory: &MemoryGuard,
    progress: &WorkProgress<'_>,
) -> PoseSearchResult {
    let model = &request.trained.model;
    let nearest = model.nearest(&request.imprint);
    let found = progress.within(memory, |progress| {
        let nearest = nearest.as_ref()?;
        let shape = request.named.unwrap_or(nearest.shape);
        let (pose, poses) = model.poses_of(shape, &nearest.imprint, POSES, progress)?;
        Some(((shape, pose), poses))
    });
    let (pose, poses, refused) = match found {
        Ok(Some((pose, poses))) => (Some(pose), poses, None),
        Ok(None) => (None, Vec::new(), None),
        Err(refused) => (None, Vec::new(), Some(refused)),
    };
    PoseSearchResult {
        nearest,
        pose,
        poses,
        refused,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;
    use std::time::Duration;

    use super::*;
    use crate::storage::ModelChoice;
    use crate::tui::recognise::trained::TrainedModel;
    use crate::tui::runtime::work::execution::PoseLimit;

    fn request() -> PoseSearch {
        let touch = "........\n.######.\n.######.\n........";
        PoseSearch {
            trained: Arc::new(TrainedModel::of_a_bar(ModelChoice::Figures)),
            imprint: touch.parse().expect("an imprint"),
            named: Some(0),
        }
    }

    fn found(event: Option<WorkerEvent>) -> PoseSearchResult {
        match event {
            Some(WorkerEvent::Recognition(RecognitionEvent::Searched(7, Ok(found)))) => *found,
            event => panic!("{event:?}"),
        }
    }

    #[test]
    fn a_stopped_search_answers_without_poses() {
        let searched = |limit| {
            let execution = Execution::AtOnce(PoseLimit(limit));
            let request = Box::new(request());
            found(find(7, request, &mut StopFlag::default(), &execution))
        };
        let whole = searched(None);
        assert!(whole.pose.is_some() && whole.refused.is_none());
        let stopped = searched(Some(0));
        assert_eq!((stopped.pose, stopped.nearest), (None, whole.nearest));
    }

    #[test]
    fn a_replaced_search_answers_too() {
        let (post, events) = channel();
        let execution = Execution::OnThreads(Arc::new(move |event| {
            // The test may be over.
            let _ = post.send(event);
        }));
        let mut stop = StopFlag::default();
        for _ in 0..2 {
            assert_eq!(find(7, Box::new(request()), &mut stop, &execution), None);
        }
        for _ in 0..2 {
            let event = events.recv_timeout(Duration::from_secs(60));
            assert!(found(event.ok()).nearest.is_some());
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_search_that_needs_too_much_memory_keeps_the_nearest_imprint_and_says_why() {
        let small = MemoryGuard::new(Some(crate::memory::MemorySize(1)), "less");
        let found = search(&request(), &small, &WorkProgress::up_to(PoseLimit(None)));
        assert!(found.pose.is_none() && found.nearest.is_some());
        assert!(found.refused.is_some_and(|why| why.contains("more memory")));
    }
}
