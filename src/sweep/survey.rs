//! A sweep itself: goes through the tasks of a shard on all threads and puts together what they find.
//!
//! Tasks are gone through in portions. Inside of a portion they run side by side, each with a census of its own; then
//! these are added to the atlas one after the other, in the order of the grid, so an imprint's number is that of its
//! first occurrence whatever the threads did. New imprints are described once. rayon's current thread pool is used:
//! run it inside of `ThreadPool::install` for another number of threads. No I/O; whoever calls shows the progress.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use crate::atlas::Atlas;
use crate::atlas::statistics::{Statistic, statistics};
use crate::atlas::values::Table;
use crate::atlas::variance::{Spread, TurnSums};
use crate::pose::grid::Grid;
use crate::sweep::ideal::Ideal;
use crate::sweep::plan::{Shard, Task, tasks};
use crate::sweep::runs;
use crate::sweep::runs::Found;

/// Takes a row: its number in the grid, and the atlas numbers of its poses.
pub type TakeRow<'a> = dyn FnMut(u64, &[u32]) + Send + 'a;

/// What a caller wants to see while a sweep runs.
pub struct Watch<'a> {
    /// Called now and then, from any thread, with the number of poses done since the last call; the sweep stops once it
    /// answers `false`.
    pub progress: &'a (dyn Fn(u64) -> bool + Sync),
    /// Given each row of what is complete once; in an order that is not that of the grid where turns look the same.
    pub rows: Option<&'a mut TakeRow<'a>>,
}

impl std::fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Watch")
            .field("rows", &self.rows.is_some())
            .finish_non_exhaustive()
    }
}

impl Watch<'_> {
    /// Nothing; the sweep runs to its end.
    pub fn nothing() -> Self {
        Self {
            progress: &|_| true,
            rows: None,
        }
    }
}

/// All that a sweep found.
///
/// ```
/// use taxel::figure::{Figure, FigureKind};
/// use taxel::parameter::Parameter;
/// use taxel::sensor::Sensor;
/// use taxel::source::Source;
/// use taxel::pose::grid::{Anchor, Grid, Ranges};
/// use taxel::sweep::plan::Shard;
/// use taxel::sweep::survey::{Survey, Watch};
///
/// // The paper's ring: over one cell of positions it leaves 393 different imprints.
/// let ring = Figure::new(FigureKind::Ellipse, 16, |parameter| match parameter {
///     Parameter::RadiusX | Parameter::RadiusY => Some(4.0),
///     Parameter::Thickness => Some(2.0),
///     _ => Some(0.0),
/// }).unwrap();
/// let ranges = Ranges { x0: "1:1.99:0.01".parse()?, y0: "1:1.99:0.01".parse()?, angle: "0".parse()?, ..Ranges::default() };
/// let grid = Grid::new(Source::Figure(ring), Sensor::default(), Anchor::Corner, ranges).unwrap();
/// let survey = Survey::of(&grid, Shard::WHOLE, Watch::nothing());
/// assert_eq!((survey.poses, survey.atlas.len()), (10_000, 393));
/// # Ok::<(), taxel::pose::range::RangeError>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Survey {
    /// The grid.
    pub grid: Grid,
    /// Which part of it was to be gone through; [`Shard::WHOLE`] after a merge of all.
    pub shard: Shard,
    /// Poses gone through: fewer than there are where the sweep was stopped.
    pub poses: u64,
    /// Poses that reach beyond the sensor.
    pub partly_off: u64,
    /// The distinct imprints.
    pub atlas: Atlas,
    /// Of each quantity of [`crate::atlas::feature::quantities`].
    pub statistics: Vec<Statistic>,
    pub(crate) spread: Spread,
}

impl Survey {
    /// Goes through a shard of a grid. Where it is stopped early, what is complete is kept: whole turns or parts of them,
    /// and all that is said of these. What was under way is not, some seconds' work at most.
    pub fn of(grid: &Grid, shard: Shard, watch: Watch<'_>) -> Self {
        let rows = shard.rows(grid.rows());
        let (width, height) = (grid.ranges().x0.count(), grid.ranges().y0.count());
        let sensor = grid.sensor();
        let mut under_way = UnderWay {
            grid,
            atlas: Atlas::new(sensor.columns(), sensor.rows()),
            table: Table::default(),
            spread: Spread::new(width * height),
            poses: 0,
            partly_off: 0,
            stopped: AtomicBool::new(false),
            watch,
        };
        let block_rows = grid.ranges().angle.count() * height;
        'all: for block in rows.start / block_rows..rows.end.div_ceil(block_rows) {
            let mut tasks = tasks(grid, &rows, block).peekable();
            while tasks.peek().is_some() {
                under_way.portion(&portion(&mut tasks, width));
                if under_way.stopped.load(Ordering::Relaxed) {
                    break 'all;
                }
            }
        }
        under_way.finished(shard)
    }

    /// Whether nothing of the shard is missing.
    pub fn complete(&self) -> bool {
        let rows = self.shard.rows(self.grid.rows());
        self.poses == (rows.end - rows.start) * self.grid.ranges().x0.count()
    }

    pub(crate) fn new(
        grid: Grid,
        shard: Shard,
        (poses, partly_off): (u64, u64),
        atlas: Atlas,
        table: &Table,
        spread: Spread,
    ) -> Self {
        let ideal = Ideal::of(grid.source());
        let counts: Vec<u64> = atlas.counts().collect();
        let statistics = statistics(table, &counts, &spread, |key| ideal?.get(key));
        Self {
            grid,
            shard,
            poses,
            partly_off,
            atlas,
            statistics,
            spread,
        }
    }
}

/// The next tasks that run side by side: enough to keep all threads busy till the end of them, few enough for the
/// memory, which holds what each of them found. `width` is the number of poses in a row.
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

/// A sweep under way.
struct UnderWay<'a, 'w> {
    grid: &'a Grid,
    atlas: Atlas,
    table: Table,
    spread: Spread,
    poses: u64,
    partly_off: u64,
    stopped: AtomicBool,
    watch: Watch<'w>,
}

impl UnderWay<'_, '_> {
    fn finished(self, shard: Shard) -> Survey {
        let poses = (self.poses, self.partly_off);
        Survey::new(
            self.grid.clone(),
            shard,
            poses,
            self.atlas,
            &self.table,
            self.spread,
        )
    }

    fn portion(&mut self, tasks: &[Task]) {
        let width = self.grid.ranges().x0.count();
        let (grid, layout, stopped) = (self.grid, self.atlas.layout(), &self.stopped);
        let (keep_runs, progress) = (self.watch.rows.is_some(), self.watch.progress);
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
                let ids = self.atlas.add(&found.census, task.turns.len() as u64);
                Some((task, found, ids))
            })
            .collect();
        self.atlas.describe();
        self.table.extend(self.atlas.notes());
        let table = &self.table;
        let sums: Vec<TurnSums> = done
            .par_iter()
            .map(|(task, found, ids)| {
                let counts = found.census.tallies().iter().map(|tally| tally.count);
                let counted = ids.iter().copied().zip(counts);
                TurnSums::of(table, task.turns.len() as u64, counted)
            })
            .collect();
        for ((task, found, ids), sums) in done.iter().zip(sums) {
            let times = task.turns.len() as u64;
            self.spread.add(task.turns[0], sums);
            self.poses += (task.rows.end - task.rows.start) * width * times;
            self.partly_off += found.partly_off * times;
            if let Some(rows) = &mut self.watch.rows {
                show_rows(grid, task, found, ids, rows);
            }
        }
    }
}

/// Spells out the runs of a task, for each of its turns.
fn show_rows(grid: &Grid, task: &Task, found: &Found, ids: &[u32], show: &mut TakeRow<'_>) {
    let (width, height) = (grid.ranges().x0.count(), grid.ranges().y0.count());
    let width = usize::try_from(width).unwrap_or(usize::MAX);
    let mut row = Vec::with_capacity(width);
    for (index, y) in task.rows.clone().enumerate() {
        row.clear();
        for &(index, length) in found.runs.row(index) {
            let [index, length] = [index, length].map(|n| usize::try_from(n).unwrap_or(0));
            row.extend(std::iter::repeat_n(ids[index], length));
        }
        for &turn in task.turns.iter() {
            show(turn * height + y, &row);
        }
    }
}

impl Survey {
    /// All shards of one grid as one survey, the same as that of the whole grid.
    ///
    /// # Errors
    /// Where a shard is missing, there twice, incomplete, or of another grid.
    pub fn merge(surveys: impl IntoIterator<Item = Self>) -> Result<Self, MergeError> {
        let mut surveys: Vec<Self> = surveys.into_iter().collect();
        surveys.sort_by_key(|survey| survey.shard.number());
        let first = surveys.first().ok_or(MergeError::Nothing)?;
        let (grid, of) = (first.grid.clone(), first.shard.of());
        let turn = grid.ranges().x0.count() * grid.ranges().y0.count();
        let mut atlas = Atlas::new(grid.sensor().columns(), grid.sensor().rows());
        let (mut spread, mut poses, mut partly_off) = (Spread::new(turn), 0, 0);
        let mut expected = 1..=of;
        for survey in surveys {
            let number = expected.next();
            if survey.grid != grid || survey.shard.of() != of {
                return Err(MergeError::Foreign {
                    shard: survey.shard,
                });
            }
            if number != Some(survey.shard.number()) {
                return Err(MergeError::Count {
                    shard: survey.shard,
                });
            }
            if !survey.complete() {
                return Err(MergeError::Incomplete {
                    shard: survey.shard,
                });
            }
            // Shards follow on each other in the order of the grid, so first occurrences stay the first.
            atlas.add_all(&survey.atlas);
            spread.merge(survey.spread);
            poses += survey.poses;
            partly_off += survey.partly_off;
        }
        if let Some(number) = expected.next() {
            return Err(MergeError::Missing { number, of });
        }
        let mut table = Table::default();
        table.extend(atlas.notes());
        let poses = (poses, partly_off);
        Ok(Self::new(grid, Shard::WHOLE, poses, atlas, &table, spread))
    }
}

/// Why surveys cannot be put together.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// There are none.
    #[error("no shards to merge")]
    Nothing,
    /// Of another grid than the first one, or cut in another number of pieces.
    #[error("shard {shard} is of another grid than the first one")]
    Foreign {
        /// Which one.
        shard: Shard,
    },
    /// There twice, or after one that is missing.
    #[error("shard {shard} comes out of turn: another one is missing or there twice")]
    Count {
        /// Which one.
        shard: Shard,
    },
    /// Stopped early.
    #[error("shard {shard} was stopped early, run it again")]
    Incomplete {
        /// Which one.
        shard: Shard,
    },
    /// The last ones are not there.
    #[error("shard {number}/{of} is missing")]
    Missing {
        /// The first of them.
        number: u32,
        /// Out of so many.
        of: u32,
    },
}
