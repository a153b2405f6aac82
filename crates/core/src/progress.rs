//! The progress of long work: it reports what is done, and learns whether to go on.

use std::ops::ControlFlow;

/// A receiver of reports, from any thread, which can stop the work. Any function of what is done since the last report
/// is one.
///
/// Most work counts something, such as poses or touches; `Done` is another type where work has several parts.
///
/// ```
/// use std::sync::atomic::{AtomicU64, Ordering};
/// use taxel_core::prelude::*;
/// use taxel_core::progress::stop_if;
///
/// let hexagon = Source::Figure(Figure::default_of(FigureKind::Hexagon, &Sensor::default()));
/// let grid = PoseGrid::new(hexagon, Sensor::default(), Anchor::Centre, Ranges::default())?;
/// // Stops after a million poses: what is complete by then is kept.
/// let done = AtomicU64::new(0);
/// let progress = |poses| stop_if(done.fetch_add(poses, Ordering::Relaxed) >= 1_000_000);
/// let result = Sweep::new(&grid).with_progress(&progress).run();
/// assert!(result.poses <= grid.poses());
/// # Ok::<(), taxel_core::pose::GridError>(())
/// ```
pub trait Progress<Done = u64>: Sync {
    /// Takes the report of what is done since the last one. The work stops if this returns [`ControlFlow::Break`].
    fn add(&self, done: Done) -> ControlFlow<()>;
}

impl<Done, F: Fn(Done) -> ControlFlow<()> + Sync> Progress<Done> for F {
    fn add(&self, done: Done) -> ControlFlow<()> {
        self(done)
    }
}

/// The progress of work that nobody watches, and that goes on to its end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ToTheEnd;

impl<Done> Progress<Done> for ToTheEnd {
    fn add(&self, _: Done) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Returns [`ControlFlow::Break`] if work is to stop, otherwise [`ControlFlow::Continue`].
pub fn stop_if(stopped: bool) -> ControlFlow<()> {
    if stopped {
        ControlFlow::Break(())
    } else {
        ControlFlow::Continue(())
    }
}
