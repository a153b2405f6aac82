//! Runs a sweep: shares the tasks of a shard among all threads and puts together what they find.
//!
//! Tasks are worked off in portions. The tasks of a portion run side by side, each with a counter of its own; then
//! these counters are added to the atlas one after the other, in the order of the grid. So the number of an imprint is
//! that of its first occurrence, for any number of threads.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use crate::atlas::{Atlas, OrientationSums, Table, VarianceParts};
use crate::index::{index, wide};
use crate::pose::{Axis, PoseGrid};
use crate::sweep::plan::{Shard, Task, tasks};
use crate::sweep::result::SweepResult;
use crate::sweep::runs;
use crate::sweep::runs::Found;

/// Takes a row: its number in the grid, and the atlas number of each of its poses.
pub type TakeRow<'a> = dyn FnMut(u64, &[u32]) + Send + 'a;

/// A sweep to run: a grid of poses, and what else is wanted.
///
/// It uses rayon's current thread pool; run it inside [`rayon::ThreadPool::install`] for another number of threads. The
/// result is the same for any number of them.
///
/// ```
/// use taxel::prelude::*;
///
/// let hexagon = Source::Figure(Figure::default_of(FigureKind::Hexagon, &Sensor::default()));
/// let grid = PoseGrid::new(hexagon, Sensor::default(), Anchor::Centre, Ranges::default())?;
/// // Stops after a million poses: what is complete by then is kept.
/// let done = std::sync::atomic::AtomicU64::new(0);
/// let go_on = |poses| done.fetch_add(poses, std::sync::atomic::Ordering::Relaxed) < 1_000_000;
/// let result = Sweep::new(&grid).progress(&go_on).run();
/// assert!(result.poses <= grid.poses());
/// # Ok::<(), taxel::pose::GridError>(())
/// ```
pub struct Sweep<'a> {
    pub(super) grid: &'a PoseGrid,
    pub(super) shard: Shard,
    pub(super) progress: &'a (dyn Fn(u64) -> bool + Sync),
    rows: Option<&'a mut TakeRow<'a>>,
}

impl fmt::Debug for Sweep<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Sweep")
            .field("grid", &self.grid)
            .field("shard", &self.shard)
            .field("rows", &self.rows.is_some())
            .finish_non_exhaustive()
    }
}

impl<'a> Sweep<'a> {
    /// A sweep of a whole grid, to its end.
    pub fn new(grid: &'a PoseGrid) -> Self {
        Self {
            grid,
            shard: Shard::WHOLE,
            progress: &|_| true,
            rows: None,
        }
    }

    /// Sweeps one shard of the grid only.
    #[must_use]
    pub fn shard(mut self, shard: Shard) -> Self {
        self.shard = shard;
        self
    }

    /// Calls `progress` from time to time, from any thread, with the number of poses done since the last call. The
    /// sweep stops when it returns `false`.
    #[must_use]
    pub fn progress(mut self, progress: &'a (dyn Fn(u64) -> bool + Sync)) -> Self {
        self.progress = progress;
        self
    }

    /// Calls `rows` once for each complete row. Rows do not come in the order of the grid where several orientations
    /// show the same shape.
    #[must_use]
    pub fn rows(mut self, rows: &'a mut TakeRow<'a>) -> Self {
        self.rows = Some(rows);
        self
    }

    /// Runs it. If it is stopped early, the result holds what is complete: whole orientations or parts of them, and
    /// everything about these. What was under way is lost, a few seconds of work at most.
    pub fn run(self) -> SweepResult {
        let Self {
            grid,
            shard,
            progress,
            rows,
        } = self;
        let shard_rows = shard.rows(grid.rows());
        let (width, height) = (grid.row_length(), grid.rows_per_orientation());
        let sensor = grid.sensor();
        let mut under_way = UnderWay {
            grid,
            atlas: Atlas::new(sensor.columns(), sensor.rows()),
            table: Table::default(),
            spread: VarianceParts::new(width * height),
            poses: 0,
            partly_off: 0,
            stopped: AtomicBool::new(false),
            progress,
            rows,
        };
        let block_rows = grid.ranges()[Axis::Angle].count() * height;
        'all: for block in shard_rows.start / block_rows..shard_rows.end.div_ceil(block_rows) {
            let mut tasks = tasks(grid, &shard_rows, block).peekable();
            while tasks.peek().is_some() {
                under_way.portion(&portion(&mut tasks, width));
                if under_way.stopped.load(Ordering::Relaxed) {
                    break 'all;
                }
            }
        }
        under_way.finished(shard)
    }
}

/// The next tasks that run side by side: enough to keep all threads busy till the end of them, few enough for the
/// memory, which holds what each of them found. `width` is the number of poses in a row.
pub(super) fn portion(tasks: &mut impl Iterator<Item = Task>, width: u64) -> Vec<Task> {
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

/// A sweep under way.
struct UnderWay<'a, 'w> {
    grid: &'a PoseGrid,
    atlas: Atlas,
    table: Table,
    spread: VarianceParts,
    poses: u64,
    partly_off: u64,
    stopped: AtomicBool,
    progress: &'w (dyn Fn(u64) -> bool + Sync),
    rows: Option<&'w mut TakeRow<'w>>,
}

impl UnderWay<'_, '_> {
    fn finished(self, shard: Shard) -> SweepResult {
        let poses = (self.poses, self.partly_off);
        SweepResult::new(
            self.grid.clone(),
            shard,
            poses,
            self.atlas,
            &self.table,
            self.spread,
        )
    }

    fn portion(&mut self, tasks: &[Task]) {
        let width = self.grid.row_length();
        let (grid, layout, stopped) = (self.grid, self.atlas.layout(), &self.stopped);
        let (keep_runs, progress) = (self.rows.is_some(), self.progress);
        let found: Vec<Option<Found>> = tasks
            .par_iter()
            .map(|task| {
                if stopped.load(Ordering::Relaxed) {
                    return None;
                }
                let turns = task.turns.len() as u64;
                let tell = |poses: u64| {
                    if !progress(poses * turns) {
                        stopped.store(true, Ordering::Relaxed);
                    }
                    !stopped.load(Ordering::Relaxed)
                };
                runs::go(grid, layout, task, keep_runs, tell)
            })
            .collect();
        // Nothing of a portion that was stopped: describing what there is of it would take its time.
        if self.stopped.load(Ordering::Relaxed) {
            return;
        }
        let done: Vec<(&Task, Found, Vec<u32>)> = tasks
            .iter()
            .zip(found)
            .filter_map(|(task, found)| {
                let found = found?;
                let ids = self.atlas.add(&found.counter, task.turns.len() as u64);
                Some((task, found, ids))
            })
            .collect();
        self.atlas.describe();
        self.table.extend(self.atlas.summaries());
        let table = &self.table;
        let sums: Vec<OrientationSums> = done
            .par_iter()
            .map(|(task, found, ids)| {
                let counts = found.counter.tallies().iter().map(|tally| tally.count);
                let counted = ids.iter().copied().zip(counts);
                OrientationSums::of(table, task.turns.len() as u64, counted)
            })
            .collect();
        for ((task, found, ids), sums) in done.iter().zip(sums) {
            let times = task.turns.len() as u64;
            self.spread.add(task.turns[0], sums);
            self.poses += (task.rows.end - task.rows.start) * width * times;
            self.partly_off += found.partly_off * times;
            if let Some(rows) = &mut self.rows {
                show_rows(grid, task, found, ids, rows);
            }
        }
    }
}

/// Spells out the runs of a task, for each of its turns.
fn show_rows(grid: &PoseGrid, task: &Task, found: &Found, ids: &[u32], show: &mut TakeRow<'_>) {
    let (width, height) = (grid.row_length(), grid.rows_per_orientation());
    let mut row = Vec::with_capacity(index(width));
    for (nth, y) in task.rows.clone().enumerate() {
        row.clear();
        for &(imprint, length) in found.runs.row(nth) {
            row.extend(std::iter::repeat_n(ids[wide(imprint)], wide(length)));
        }
        for &turn in task.turns.iter() {
            show(turn * height + y, &row);
        }
    }
}
