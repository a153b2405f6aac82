//! Long work: sweeps and exports. It runs on threads of its own if there is a receiver for its events, otherwise at
//! once, before the next message, as scripts want it.
//!
//! ```text
//! Measure(grid)        -> Estimate         best of several short runs, stopped by the next piece of work
//! Sweep(number, grid)  -> Progress …, then Swept, also after Stop, with what is complete
//! Angles(results, …)   -> Angles: what was found, or why that failed
//! Write(number, …)     -> Progress …, then Written, Exists or Failed; after Stop no file stays
//! ```
//! When the program ends, a running sweep ends with it; an export is stopped first, so that no partial file stays. A
//! panic of a worker becomes an event, too.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use taxel_core::pose::{PoseGrid, PoseIndex};
use taxel_core::progress::Progress;
use taxel_core::sweep::{Sweep, SweepResult, TimingSample};
use taxel_files::memory::MemoryGuard;
use taxel_files::storage::{Existing, FileError, PoseFile, atlas_path, is_poses, write_atlas};

use crate::tui::app::message::WorkerEvent;
use crate::tui::explore::angles::AngleCurve;
use crate::tui::explore::message::Findings;
use crate::tui::live::message::WatchRequest;
use crate::tui::recognise::state::{PoseSearch, PoseSearchResult, RecognitionEvent};
use crate::tui::runtime::disk::files::{WriteAccess, absolute};
use crate::tui::runtime::effect::Work;
use crate::tui::runtime::frames::FrameWatcher;
use crate::tui::runtime::work::execution::{
    Execution, PoseLimit, ProgressReporter, StopFlag, WorkProgress, WorkerEventSink, caught,
    guarded, on_a_thread, start, wait_until_finished,
};
use crate::tui::runtime::work::models::{ModelStore, ModelWorker};

const WRITING: Duration = Duration::from_millis(400);

const MEASURED: Duration = Duration::from_millis(30);

#[derive(Debug, Default)]
pub(crate) struct Workers {
    execution: Execution,
    working: StopFlag,
    measuring: StopFlag,
    finding_poses: StopFlag,
    writing: Option<JoinHandle<()>>,
    pub(crate) models: ModelWorker,
    pub(crate) frames: FrameWatcher,
    pub(crate) access: Arc<WriteAccess>,
}

impl Workers {
    pub(crate) fn with(models: ModelStore) -> Self {
        let mut workers = Self::default();
        workers.models.store = models;
        workers
    }

    pub(crate) fn post_to(&mut self, post: WorkerEventSink) {
        self.execution = Execution::OnThreads(post);
    }

    pub(crate) fn stop_after(&mut self, poses: u64) {
        self.execution = Execution::AtOnce(PoseLimit(Some(poses)));
    }

    pub(crate) fn perform(&mut self, work: Work) -> Option<WorkerEvent> {
        match work {
            Work::Stop => {
                self.working.stop();
                None
            }
            Work::Measure(grid) => self.measure(grid),
            Work::Sweep(number, grid) => self.sweep(number, grid),
            Work::Angles(findings, place) => self.angles(findings, place),
            Work::Write(number, findings, name, existing) => {
                match self.access.path(&name, existing) {
                    Ok(path) => self.write(number, findings, (name, path), existing),
                    Err(refused) => Some(WorkerEvent::Failed(number, refused)),
                }
            }
            Work::Prepare(number, choice, known) => {
                self.finding_poses.stop();
                (self.models).prepare(number, choice, known, &self.execution)
            }
            Work::StopPreparing => {
                self.models.stop();
                None
            }
            Work::FindPoses(number, search) => {
                find(number, search, &mut self.finding_poses, &self.execution)
            }
            Work::StopFindingPoses => {
                self.finding_poses.stop();
                None
            }
        }
    }

    pub(crate) fn watch(
        &mut self,
        number: u64,
        request: Arc<WatchRequest>,
        write: Option<(PathBuf, Existing)>,
    ) {
        self.frames.watch(number, request, write, &self.execution);
    }

    /// Estimates the time of a sweep on a thread of its own. Does nothing without a receiver, as nobody waits for it.
    fn measure(&mut self, grid: Box<PoseGrid>) -> Option<WorkerEvent> {
        let stop = self.measuring.renew();
        let Execution::OnThreads(post) = &self.execution else {
            return None;
        };
        let post = Arc::clone(post);
        let work = move || {
            if let Some(time) = measure(&grid, &stop) {
                post(WorkerEvent::Estimate(grid, time));
            }
        };
        let reason = start(work).err()?;
        Some(WorkerEvent::Refused(format!(
            "the time of the sweep cannot be measured: {reason}"
        )))
    }

    fn sweep(&mut self, number: u64, grid: Box<PoseGrid>) -> Option<WorkerEvent> {
        let stop = self.begin();
        let post = match &self.execution {
            Execution::AtOnce(limit) => {
                return Some(sweep(number, &grid, &WorkProgress::up_to(*limit)));
            }
            Execution::OnThreads(post) => post,
        };
        let thread = on_a_thread(number, post, move |post| {
            let clock = ProgressReporter::new(number, post);
            let progress = WorkProgress::until(&stop, Some(&clock));
            post(guarded(number, || sweep(number, &grid, &progress)));
        });
        thread.err()
    }

    fn angles(&self, findings: Arc<Findings>, place: PoseIndex) -> Option<WorkerEvent> {
        let run = move || {
            let curve = caught(|| Arc::new(AngleCurve::of(&findings.sweep, place)));
            WorkerEvent::Angles(findings, place, curve)
        };
        if let Execution::OnThreads(post) = &self.execution {
            let (post, run) = (Arc::clone(post), run.clone());
            if start(move || post(run())).is_ok() {
                return None;
            }
        }
        Some(run())
    }

    fn write(
        &mut self,
        number: u64,
        findings: Arc<Findings>,
        (name, path): (String, PathBuf),
        existing: Existing,
    ) -> Option<WorkerEvent> {
        let stop = self.begin();
        let run = move |clock: Option<&ProgressReporter<'_>>| {
            let memory = MemoryGuard::new(None, COARSER);
            let to = (name.as_str(), path.as_path());
            write(number, &findings, to, existing, &memory, &stop, clock)
        };
        let Execution::OnThreads(post) = &self.execution else {
            return Some(run(None));
        };
        let thread = on_a_thread(number, post, move |post| {
            let clock = ProgressReporter::new(number, post);
            post(guarded(number, || run(Some(&clock))));
        });
        match thread {
            Ok(thread) => self.writing = Some(thread),
            Err(refused) => return Some(refused),
        }
        None
    }

    fn begin(&mut self) -> Arc<AtomicBool> {
        self.measuring.stop();
        self.working.renew()
    }
}

impl Drop for Workers {
    fn drop(&mut self) {
        self.working.stop();
        // Half-written files are removed, and models are written to the cache as a whole; but a disk may hang.
        let threads = [self.writing.take(), self.models.end()];
        let end = Instant::now() + WRITING;
        for thread in threads.into_iter().flatten() {
            wait_until_finished(&thread, end.saturating_duration_since(Instant::now()));
        }
    }
}

/// Estimates the time of a sweep; None if it was stopped.
fn measure(grid: &PoseGrid, stop: &AtomicBool) -> Option<Duration> {
    let sample = TimingSample::of(grid);
    let begun = Instant::now();
    let mut best = f64::INFINITY;
    while !best.is_finite() || begun.elapsed() < MEASURED {
        let start = Instant::now();
        Sweep::new(&sample.grid).run();
        best = best.min(start.elapsed().as_secs_f64());
        if stop.load(Ordering::Relaxed) {
            return None;
        }
    }
    Duration::try_from_secs_f64(best * sample.factor).ok()
}

fn sweep(number: u64, grid: &PoseGrid, progress: &WorkProgress<'_>) -> WorkerEvent {
    let swept = progress.within(&MemoryGuard::new(None, COARSER), |progress| {
        Sweep::new(grid).with_progress(progress).run()
    });
    match swept {
        Ok(result) => WorkerEvent::Swept(number, Arc::new(Findings::new(result))),
        Err(message) => WorkerEvent::Failed(number, message),
    }
}

fn write(
    number: u64,
    findings: &Findings,
    (name, path): (&str, &Path),
    existing: Existing,
    memory: &MemoryGuard,
    stop: &AtomicBool,
    clock: Option<&ProgressReporter<'_>>,
) -> WorkerEvent {
    let result = &findings.sweep;
    let written = if is_poses(path) {
        let progress = WorkProgress::until(stop, clock);
        let written = progress.within(memory, |progress| {
            write_poses(result, path, existing, progress)
        });
        match written {
            Ok(written) => written,
            Err(message) => return WorkerEvent::Failed(number, message),
        }
    } else {
        match atlas_path(path) {
            Ok(path) => write_atlas(&path, result, existing).and_then(|file| {
                // Dropped if it comes too late.
                let goes_on = !stop.load(Ordering::Relaxed);
                goes_on
                    .then(|| file.persist())
                    .transpose()
                    .map(|named| named.is_some())
            }),
            Err(expected) => return WorkerEvent::Failed(number, format!("{name}: {expected}")),
        }
    };
    match written {
        Ok(true) => WorkerEvent::Written(number, absolute(path)),
        Err(error) if error.exists() && existing == Existing::Kept => {
            WorkerEvent::Exists(number, name.to_owned())
        }
        Err(error) if !stop.load(Ordering::Relaxed) => {
            WorkerEvent::Failed(number, error.to_string())
        }
        _ => WorkerEvent::Failed(number, "stopped; nothing was written".to_owned()),
    }
}

/// Writes the poses of a sweep to a file. Sweeps the grid again, because the numbers of its poses are not kept, while
/// the first result stays in memory. Returns true if the sweep was completed.
fn write_poses(
    result: &SweepResult,
    path: &Path,
    existing: Existing,
    progress: &dyn Progress,
) -> Result<bool, FileError> {
    let mut file = PoseFile::new(path, &result.grid, existing)?;
    let sweep = Sweep::new(&result.grid).with_progress(progress);
    sweep.run_with_rows(&mut |row, ids| file.take(row, ids));
    let Some(whole) = file.finish()? else {
        return Ok(false);
    };
    whole.persist()?;
    Ok(true)
}

/// What helps a sweep, whose results are in memory.
const COARSER: &str =
    "take coarser steps, or sweep it in shards on the command line (taxel sweep --shard)";

/// What helps a search for poses, which keeps all poses of an imprint until they are counted.
const COARSER_MODEL: &str = "train the model in coarser steps to see poses";

/// The largest number of poses whose outlines are drawn; more cannot be told apart over a matrix.
const POSES: usize = 13;

/// Begins a search on a thread of its own, in place of the one before; or searches at once and returns the event.
pub(crate) fn find(
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
        search(&request, &MemoryGuard::new(None, COARSER_MODEL), progress)
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

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use taxel_core::figure::{Figure, FigureKind};
    use taxel_core::pose::{Anchor, Axis, Ranges};
    use taxel_core::sensor::Sensor;
    use taxel_core::source::Source;
    use taxel_files::memory::MemorySize;
    #[cfg(test)]
    #[cfg(test)]
    use taxel_files::storage::ModelChoice;

    use super::*;
    #[cfg(test)]
    use crate::tui::recognise::trained::TrainedModel;

    #[test]
    fn poses_that_need_too_much_memory_are_not_written_and_the_event_says_why() {
        let folder = tempfile::tempdir().expect("a folder");
        let source = Source::Figure(Figure::default_of(FigureKind::Hexagon, &Sensor::default()));
        let ranges = Ranges::default().with(Axis::Angle, "0".parse().expect("a range"));
        let grid = PoseGrid::new(source, Sensor::default(), Anchor::Corner, ranges);
        let findings = Findings::new(Sweep::new(&grid.expect("in range")).run());
        let path = folder.path().join("poses.npy");
        let to = ("poses.npy", path.as_path());
        let stop = AtomicBool::new(false);
        let written = |memory| write(7, &findings, to, Existing::Kept, &memory, &stop, None);
        let small = MemoryGuard::new(Some(MemorySize(1)), "take coarser steps");
        let refused = "stopped: needs more memory than the 1 byte allowed; take coarser steps";
        assert_eq!(written(small), WorkerEvent::Failed(7, refused.to_owned()));
        let left = std::fs::read_dir(folder.path()).expect("a folder").count();
        assert_eq!(left, 0, "nothing is left");
        let large = MemoryGuard::new(Some(MemorySize(1 << 50)), "");
        assert!(matches!(written(large), WorkerEvent::Written(7, _)));
    }

    #[cfg(test)]
    fn request() -> PoseSearch {
        let touch = "........\n.######.\n.######.\n........";
        PoseSearch {
            trained: Arc::new(TrainedModel::of_a_bar(ModelChoice::Figures)),
            imprint: touch.parse().expect("an imprint"),
            named: Some(0),
        }
    }

    #[cfg(test)]
    fn found(event: Option<WorkerEvent>) -> PoseSearchResult {
        match event {
            Some(WorkerEvent::Recognition(RecognitionEvent::Searched(7, Ok(found)))) => *found,
            event => panic!("{event:?}"),
        }
    }

    #[cfg(test)]
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

    #[cfg(test)]
    #[cfg(target_os = "linux")]
    #[test]
    fn a_search_that_needs_too_much_memory_keeps_the_nearest_imprint_and_says_why() {
        let small = MemoryGuard::new(Some(MemorySize(1)), "less");
        let found = search(&request(), &small, &WorkProgress::up_to(PoseLimit(None)));
        assert!(found.pose.is_none() && found.nearest.is_some());
        assert!(found.refused.is_some_and(|why| why.contains("more memory")));
    }
}
