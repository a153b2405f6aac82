//! Runs a sweep: distributes the tasks of a shard among all threads and combines their results.
//!
//! Tasks run in portions. The tasks of a portion run in parallel, each with its own counters; then the counters are
//! added to the atlas one after the other, while the next portion is being swept. At the end the imprints are sorted by
//! their first poses, so their numbers are the same for any number of threads.
//!
//! With [`Sweep::run_with_rows`], imprints are numbered as they are found. So tasks come in the order of their first
//! orientations, mirror images are swept separately, and the rows of a group come together.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use crate::atlas::{ImprintCounter, Layout, OrientationSums, Table};
use crate::imprint::Imprint;
use crate::index::{index, wide};
use crate::pose::{Axis, PoseGrid};
use crate::progress::{Progress, ToTheEnd, stop_if};
use crate::sweep::plan::{Shard, Task, tasks};
use crate::sweep::result::SweepResult;
use crate::sweep::runs::{self, GroupResult};

/// A function that takes a row: its number in the grid, and the atlas number of each of its poses. It stops the sweep by
/// returning `Break`.
pub type TakeRow<'a> = dyn FnMut(u64, &[u32]) -> ControlFlow<()> + Send + 'a;

/// A sweep to run: a grid of poses, and options.
///
/// It uses rayon's current thread pool; run it inside [`rayon::ThreadPool::install`] for another number of threads. The
/// result is the same for any number of them.
///
/// ```
/// use taxel_core::prelude::*;
///
/// let hexagon = Source::Figure(Figure::default_of(FigureKind::Hexagon, &Sensor::default()));
/// let grid = PoseGrid::new(hexagon, Sensor::default(), Anchor::Centre, Ranges::default())?;
/// let result = Sweep::new(&grid).run();
/// assert_eq!(result.poses, grid.poses());
/// # Ok::<(), taxel_core::pose::GridError>(())
/// ```
#[must_use = "nothing is swept before `run` or `run_with_rows`"]
pub struct Sweep<'a> {
    grid: &'a PoseGrid,
    shard: Shard,
    progress: &'a dyn Progress,
}

impl fmt::Debug for Sweep<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Sweep")
            .field("grid", &self.grid)
            .field("shard", &self.shard)
            .finish_non_exhaustive()
    }
}

impl<'a> Sweep<'a> {
    /// Creates a sweep of a whole grid, to its end.
    pub fn new(grid: &'a PoseGrid) -> Self {
        Self {
            grid,
            shard: Shard::WHOLE,
            progress: &ToTheEnd,
        }
    }

    /// Sweeps only one shard of the grid.
    pub fn with_shard(mut self, shard: Shard) -> Self {
        self.shard = shard;
        self
    }

    /// Reports to `progress` from time to time, from any thread, the number of poses done since the last report, which
    /// is 0 within a long row. The sweep stops when it returns `Break`.
    pub fn with_progress(mut self, progress: &'a dyn Progress) -> Self {
        self.progress = progress;
        self
    }

    /// Runs the sweep. If it is stopped early, the result holds what is complete: whole orientations or parts of
    /// them, with all their numbers. Unfinished work is lost, a few seconds at most.
    pub fn run(self) -> SweepResult {
        self.run_to(None)
    }

    /// Runs the sweep as [`Self::run`] does, and calls `take` once for each complete row: one y0 at one angle and one
    /// pair of zooms. Rows do not come in the order of the grid if several orientations show the same shape. After a
    /// `Break`, `take` is not called again.
    pub fn run_with_rows(self, take: &mut TakeRow<'_>) -> SweepResult {
        self.run_to(Some(take))
    }

    fn run_to(self, mut rows: Option<&mut TakeRow<'_>>) -> SweepResult {
        let with_runs = rows.is_some();
        let mut result = SweepResult::empty(self.grid.clone(), self.shard);
        let mut table = Table::default();
        let layout = result.atlas.layout().clone();
        self.each_portion(&layout, with_runs, |portion| {
            let ids = portion
                .iter()
                .map(|found| result.atlas.add(&found.counter, found.multiplicity()));
            let ids: Vec<Vec<u32>> = ids.collect();
            result.atlas.describe();
            table.extend(result.atlas.summaries());
            let sums = portion.par_iter().zip(&ids).map(|(found, ids)| {
                let counts = found.counter.tallies().iter().map(|tally| tally.count);
                let counted = ids.iter().copied().zip(counts);
                OrientationSums::of(&table, found.multiplicity(), counted)
            });
            let sums: Vec<OrientationSums> = sums.collect();
            let mut flow = ControlFlow::Continue(());
            for ((found, ids), sums) in portion.iter().zip(&ids).zip(sums) {
                result.variance_parts.add(found.orientations[0], sums);
                result.poses += found.poses(&result.grid);
                result.partly_off += found.partly_off * found.multiplicity();
                if let Some(rows) = &mut rows
                    && flow.is_continue()
                {
                    flow = show_rows(&result.grid, found, ids, rows);
                }
            }
            flow
        });
        let mut result = result.with_statistics(&table);
        if !with_runs {
            result.atlas.sort_by_first_pose();
        }
        result
    }

    /// Sweeps portion after portion. `take` receives the results of each portion while the next one is being swept;
    /// `with_runs`, the portions come in the order of the grid. If `progress` stops a portion, its results are
    /// lost; `take` stops the sweep, too. Returns true if nothing did.
    fn each_portion(
        self,
        layout: &Layout,
        with_runs: bool,
        mut take: impl FnMut(&Portion) -> ControlFlow<()> + Send,
    ) -> bool {
        let Self {
            grid,
            shard,
            progress,
        } = self;
        let rows = shard.rows(grid.rows());
        let stopped = AtomicBool::new(false);
        let stop = |flow: ControlFlow<()>| {
            if flow.is_break() {
                stopped.store(true, Ordering::Relaxed);
            }
            stop_if(stopped.load(Ordering::Relaxed))
        };
        let report = |poses: u64| stop(progress.add(poses));
        let found = |task: Task| {
            (!stopped.load(Ordering::Relaxed))
                .then(|| runs::sweep_task(grid, layout, &task, &report))
                .flatten()
        };
        let block_rows = grid.ranges()[Axis::Angle].count() * grid.rows_per_orientation();
        let blocks = rows.start / block_rows..rows.end.div_ceil(block_rows);
        let mut tasks = blocks.flat_map(|block| tasks(grid, &rows, block, with_runs));
        let mut before = Portion::new();
        loop {
            let next = portion(&mut tasks, grid.row_length());
            if next.is_empty() {
                return take(&before).is_continue();
            }
            let sweep =
                || -> Option<Vec<Vec<GroupResult>>> { next.into_par_iter().map(found).collect() };
            let (swept, taken) = rayon::join(sweep, || stop(take(&before)));
            match swept {
                Some(swept) if taken.is_continue() => {
                    before = swept.into_iter().flatten().collect();
                }
                _ => return false,
            }
        }
    }
}

/// The results of the groups of some tasks.
type Portion = Vec<GroupResult>;

/// Takes the next tasks that run side by side: enough to keep all threads busy to the end, few enough for the memory
/// that their results take. `width` is the number of poses in a row.
fn portion(tasks: &mut impl Iterator<Item = Task>, width: u64) -> Vec<Task> {
    const POSES: u64 = 4_000_000;
    let threads = rayon::current_num_threads();
    let mut poses = 0;
    let mut portion = Vec::new();
    while portion.len() < threads || poses < POSES && portion.len() < 16 * threads {
        let Some(task) = tasks.next() else { break };
        poses += (task.rows.end - task.rows.start) * width;
        portion.push(task);
    }
    portion
}

/// Calls `show` for each row of a group, in each of its orientations, until it stops.
fn show_rows(
    grid: &PoseGrid,
    found: &GroupResult,
    ids: &[u32],
    show: &mut TakeRow<'_>,
) -> ControlFlow<()> {
    let (width, height) = (grid.row_length(), grid.rows_per_orientation());
    let mut row = Vec::with_capacity(index(width));
    for (nth, y) in found.rows.clone().enumerate() {
        row.clear();
        for &(imprint, length) in found.runs.row(nth) {
            row.extend(std::iter::repeat_n(ids[wide(imprint)], wide(length)));
        }
        for &orientation in found.orientations.iter() {
            show(orientation * height + y, &row)?;
        }
    }
    ControlFlow::Continue(())
}

/// The distinct imprints of a grid, counted without describing them.
#[derive(Clone, Debug)]
pub(crate) struct CountedImprints {
    layout: Layout,
    counter: ImprintCounter,
    pub(crate) poses: u64,
    /// The number of poses that reach beyond the sensor.
    pub(crate) partly_off: u64,
}

impl CountedImprints {
    pub(crate) fn len(&self) -> usize {
        self.counter.len()
    }

    /// An imprint, counted from 0, and the number of poses in which it occurs.
    pub(crate) fn get(&self, index: usize) -> (Imprint, u64) {
        let imprint = self.layout.imprint(self.counter.key(index));
        (imprint, self.counter.tallies()[index].count)
    }
}

/// A run of neighbouring poses of one row that leave the same imprint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PoseRun {
    /// The number of the first pose in the grid.
    pub(crate) first: u64,
    pub(crate) poses: u64,
    /// The number of orientations that show the same because of symmetry, including this one; the numbers of the
    /// others are not given.
    pub(crate) orientations: u64,
}

impl Sweep<'_> {
    /// Counts the imprints without describing them. Returns None if the sweep was stopped.
    pub(crate) fn count(self) -> Option<CountedImprints> {
        let layout = Layout::new(self.grid.sensor().size());
        let mut counted = CountedImprints {
            counter: ImprintCounter::new(layout.words()),
            layout,
            poses: 0,
            partly_off: 0,
        };
        let grid = self.grid;
        let complete = self.each_portion(&counted.layout, false, |portion| {
            for found in portion {
                let own = &found.counter;
                for (index, tally) in own.tallies().iter().enumerate() {
                    let count = tally.count * found.multiplicity();
                    let (key, hash) = (own.key(index), own.hash(index));
                    counted.counter.add(key, hash, count, tally.first);
                }
                counted.poses += found.poses(grid);
                counted.partly_off += found.partly_off * found.multiplicity();
            }
            ControlFlow::Continue(())
        });
        counted.counter.sort_by_first_pose();
        complete.then_some(counted)
    }

    /// Finds the poses whose imprint satisfies `wanted`. Returns None if the sweep was stopped.
    ///
    /// The order of the runs does not depend on the number of threads.
    pub(crate) fn poses_where(
        self,
        wanted: &(dyn Fn(&Imprint) -> bool + Sync),
    ) -> Option<Vec<PoseRun>> {
        let (width, height) = (self.grid.row_length(), self.grid.rows_per_orientation());
        let layout = Layout::new(self.grid.sensor().size());
        let mut runs = Vec::new();
        self.each_portion(&layout, true, |portion| {
            for found in portion {
                let wanted: Vec<bool> = (0..found.counter.len())
                    .map(|index| wanted(&layout.imprint(found.counter.key(index))))
                    .collect();
                for (row, y) in found.rows.clone().enumerate() {
                    let mut first = (found.orientations[0] * height + y) * width;
                    for &(index, length) in found.runs.row(row) {
                        if wanted[wide(index)] {
                            runs.push(PoseRun {
                                first,
                                poses: u64::from(length),
                                orientations: found.multiplicity(),
                            });
                        }
                        first += u64::from(length);
                    }
                }
            }
            ControlFlow::Continue(())
        })
        .then_some(runs)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicU64;

    use super::*;
    use crate::figure::{Figure, FigureKind};
    use crate::pose::{Anchor, Ranges};
    use crate::sensor::Sensor;

    #[test]
    fn rows_that_are_not_taken_stop_the_sweep() {
        let sensor = Sensor::default();
        let source = Figure::default_of(FigureKind::Heptagon, &sensor).into();
        let grid = PoseGrid::new(source, sensor, Anchor::Corner, Ranges::default());
        let grid = grid.expect("in range");
        let mut rows = 0;
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let result = pool.expect("a thread").install(|| {
            Sweep::new(&grid).run_with_rows(&mut |_, _| {
                rows += 1;
                stop_if(rows == 150)
            })
        });
        assert_eq!(rows, 150);
        assert!(!result.complete() && result.poses >= 150 * grid.row_length());
    }

    #[test]
    fn runs_hold_each_pose_once_and_agree_with_the_counts() {
        for kind in [
            FigureKind::Triangle,
            FigureKind::Rectangle,
            FigureKind::Ellipse,
        ] {
            let sensor = Sensor::default();
            let coarse = |text: &str| text.parse().expect("a range");
            let ranges = Ranges::default()
                .with(Axis::X0, coarse("5:6:0.1"))
                .with(Axis::Y0, coarse("5:6:0.2"))
                .with(Axis::Angle, coarse("0:350:10"));
            let source = Figure::default_of(kind, &sensor).into();
            let grid = PoseGrid::new(source, sensor, Anchor::Corner, ranges).expect("in range");
            let counted = Sweep::new(&grid).count().expect("not stopped");
            let mut poses = 0;
            for (imprint, count) in (0..counted.len()).map(|index| counted.get(index)) {
                let same = |other: &Imprint| *other == imprint;
                let runs = Sweep::new(&grid).poses_where(&same).expect("not stopped");
                let found: u64 = runs.iter().map(|run| run.poses * run.orientations).sum();
                assert_eq!(found, count, "{imprint}");
                for run in runs {
                    let placed = grid.placed(run.first + run.poses - 1);
                    assert_eq!(crate::touch::Plane::new(sensor).touch(&placed), imprint);
                }
                poses += count;
            }
            assert_eq!((poses, counted.poses), (grid.poses(), grid.poses()));
        }
    }

    #[test]
    fn a_sweep_can_be_stopped_within_a_row() {
        let sensor = Sensor::default();
        let source = Figure::default_of(FigureKind::Rectangle, &sensor).into();
        let range = |text: &str| text.parse().expect("a range");
        // Half of a row of cells is covered: each of a million positions is decided exactly.
        let ranges = Ranges::default()
            .with(Axis::X0, range("4:4.999999:0.000001"))
            .with(Axis::Y0, range("4.5"))
            .with(Axis::Angle, range("0"));
        let grid = PoseGrid::new(source, sensor, Anchor::Corner, ranges).expect("in range");
        let done = AtomicU64::new(0);
        let progress = |poses| {
            done.fetch_add(poses, Ordering::Relaxed);
            ControlFlow::Break(())
        };
        assert!(Sweep::new(&grid).with_progress(&progress).count().is_none());
        assert_eq!(done.into_inner(), 0);
    }
}
