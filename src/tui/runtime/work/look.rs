//! Searches a model for an imprint: the nearest imprint of the set, and the poses that leave it.
//!
//! ```text
//! Look(number, search)  -> Looked, also after StopLooking: the screen waits for it before it begins the next
//! ```
//! The nearest imprint is found soon. Its poses take a sweep of the whole grid, and are not kept in the model.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use crate::memory::MemoryGuard;
use crate::tui::app::worker_event::WorkerEvent;
use crate::tui::recognise::message::{Look, PoseSearch, RecognitionEvent};
use crate::tui::runtime::work::execution::{Execution, StopFlag};
use crate::tui::runtime::work::progress::caught;
use crate::tui::runtime::work::threads;

/// The largest number of poses whose outlines are drawn; more cannot be told apart over a matrix.
const POSES: usize = 13;

/// Begins a search on a thread of its own, in place of the one before; or searches at once and returns the event.
pub(in crate::tui::runtime) fn look(
    number: u64,
    search: Box<PoseSearch>,
    stop: &mut StopFlag,
    execution: &Execution,
) -> Option<WorkerEvent> {
    let stop = stop.renew();
    let looked = move |found: Result<Look, String>| {
        let event = RecognitionEvent::Looked(number, found.map(Box::new));
        WorkerEvent::Recognition(event)
    };
    let find = move |progress: &(dyn Fn(u64) -> bool + Sync)| {
        find(&search, &MemoryGuard::of_pose_search(), progress)
    };
    let post = match execution {
        Execution::AtOnce(limit) => return Some(looked(Ok(find(&limit.count())))),
        Execution::OnThreads(post) => Arc::clone(post),
    };
    let work = move || {
        let progress = |_: u64| !stop.load(Ordering::Relaxed);
        post(looked(caught(|| find(&progress))));
    };
    let thread = threads::start(move || threads::run(work));
    thread.err().map(|reason| looked(Err(reason)))
}

/// Searches, and stops the sweep when `progress` says so.
fn find(
    search: &PoseSearch,
    memory: &MemoryGuard,
    progress: &(dyn Fn(u64) -> bool + Sync),
) -> Look {
    let model = &search.trained.model;
    let nearest = model.nearest(&search.imprint);
    let within = |poses| progress(poses) && memory.allows();
    let found = nearest.as_ref().and_then(|nearest| {
        let shape = search.named.unwrap_or(nearest.shape);
        let (pose, poses) = model.poses_of(shape, &nearest.imprint, POSES, &within)?;
        Some(((shape, pose), poses))
    });
    let (pose, poses) = match found {
        Some((pose, poses)) => (Some(pose), poses),
        None => (None, Vec::new()),
    };
    Look {
        nearest,
        pose,
        poses,
        refused: memory.exceeded().then(|| memory.message()),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;
    use std::time::Duration;

    use super::*;
    use crate::storage::ModelChoice;
    use crate::tui::recognise::trained::TrainedModel;
    use crate::tui::runtime::work::progress::PoseLimit;

    fn search() -> PoseSearch {
        let touch = "........\n.######.\n.######.\n........";
        PoseSearch {
            trained: Arc::new(TrainedModel::of_a_bar(ModelChoice::Figures)),
            imprint: touch.parse().expect("an imprint"),
            named: Some(0),
        }
    }

    fn found(event: Option<WorkerEvent>) -> Look {
        match event {
            Some(WorkerEvent::Recognition(RecognitionEvent::Looked(7, Ok(look)))) => *look,
            event => panic!("{event:?}"),
        }
    }

    #[test]
    fn a_stopped_search_answers_without_poses() {
        let searched = |limit| {
            let execution = Execution::AtOnce(PoseLimit(limit));
            let search = Box::new(search());
            found(look(7, search, &mut StopFlag::default(), &execution))
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
            assert_eq!(look(7, Box::new(search()), &mut stop, &execution), None);
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
        let look = find(&search(), &small, &|_| true);
        assert!(look.pose.is_none() && look.nearest.is_some());
        assert!(look.refused.is_some_and(|why| why.contains("more memory")));
    }
}
