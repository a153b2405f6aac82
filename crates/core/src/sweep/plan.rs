//! Divides a grid: into shards for several machines, and into tasks for the threads of one.
//!
//! A shard is a contiguous part of the list of rows. Orientations (an angle and a pair of zooms) at which the shape
//! looks the same form a *group*, and only one of them is swept. A task is some rows of a group, together with the
//! group at which the shape is its mirror image. The result does not depend on how the work is divided into tasks.

use std::cmp::Ordering;
use std::collections::HashMap;
use std::fmt;
use std::ops::Range;
use std::str::FromStr;
use std::sync::Arc;

use crate::pose::{AngleClasses, Axis, PoseGrid};
use crate::quote::shortened;
use crate::sweep::point_symmetry::PointSymmetry;

/// A shard of a grid: piece `number` of `of` nearly equal pieces, counted from 1; as text, `2/3`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Shard {
    number: u32,
    of: u32,
}

impl Shard {
    /// The whole grid as the only piece.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Creates piece `number` of `of`, counted from 1.
    ///
    /// # Errors
    /// Returns an error if `number` is not from 1 to `of`.
    pub fn new(number: u32, of: u32) -> Result<Self, ShardError> {
        if (1..=of).contains(&number) {
            Ok(Self { number, of })
        } else {
            Err(ShardError {
                text: format!("{number}/{of}"),
            })
        }
    }

    /// Returns the number of the shard, from 1.
    pub fn number(&self) -> u32 {
        self.number
    }

    /// Returns the number of shards.
    pub fn of(&self) -> u32 {
        self.of
    }

    /// Returns the rows of this shard in a grid with `rows` rows. The shards of a grid differ by one row at most.
    pub fn rows(&self, rows: u64) -> Range<u64> {
        let cut = |piece: u32| {
            // rows · piece / of, rounded down, without a product beyond 64 bits.
            let (piece, of) = (u64::from(piece), u64::from(self.of));
            rows / of * piece + rows % of * piece / of
        };
        cut(self.number - 1)..cut(self.number)
    }

    /// Checks that a merge can take this shard after the one that it took last: the first, then the second, and so on.
    pub(crate) fn check_after(self, last: Option<Self>) -> Result<(), ShardOrderError> {
        let (number, of) = (last.map_or(1, |last| last.number + 1), self.of);
        match self.number.cmp(&number) {
            Ordering::Less => Err(ShardOrderError::Twice { shard: self }),
            Ordering::Greater => Err(ShardOrderError::Missing { number, of }),
            Ordering::Equal => Ok(()),
        }
    }

    pub(crate) fn check_last(self) -> Result<(), ShardOrderError> {
        if self.number == self.of {
            return Ok(());
        }
        let (number, of) = (self.number + 1, self.of);
        Err(ShardOrderError::Missing { number, of })
    }

    /// Returns the number of poses of this shard in a grid.
    pub fn poses(&self, grid: &PoseGrid) -> u64 {
        let rows = self.rows(grid.rows());
        (rows.end - rows.start) * grid.row_length()
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let error = || ShardError {
            text: shortened(text),
        };
        let (number, of) = text.split_once('/').ok_or_else(error)?;
        let read = |text: &str| text.trim().parse().map_err(|_| error());
        Self::new(read(number)?, read(of)?).map_err(|_| error())
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

/// The error for text that is not a shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("\"{text}\" is not a shard, {}", self.expected())]
pub struct ShardError {
    /// The text, shortened.
    pub text: String,
}

impl ShardError {
    /// Returns the part of the message that says what was expected, for a place that shows the text itself.
    #[must_use]
    pub fn expected(&self) -> &'static str {
        "expected K/N with K from 1 to N and N up to 4294967295"
    }
}

/// The error for shards that are not all those of one sweep or training, in their order.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ShardOrderError {
    /// There are no shards.
    #[error("no shards to merge")]
    Nothing,
    /// A shard that is given twice.
    #[error("shard {shard} is given twice")]
    Twice {
        /// The shard.
        shard: Shard,
    },
    /// A missing shard.
    #[error("shard {number}/{of} is missing")]
    Missing {
        /// The number of the missing shard, from 1.
        number: u32,
        /// The number of shards.
        of: u32,
    },
}

/// The detail in which a sweep reports each row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SweepDetail {
    Counts,
    /// The runs of poses with the same imprint, too.
    Runs,
}

/// Some rows of a group of orientations, and of the group of their mirror images.
#[derive(Clone, Debug)]
pub(crate) struct Task {
    /// One group, or two groups that are mirror images of each other, with right and left exchanged.
    pub(crate) groups: Arc<[Arc<[u64]>]>,
    pub(crate) rows: Range<u64>,
    pub(crate) detail: SweepDetail,
}

impl Task {
    pub(crate) fn orientations(&self) -> u64 {
        self.groups.iter().map(|group| group.len() as u64).sum()
    }
}

/// The usual number of poses in a task: enough to outweigh the cost of starting it, few enough to share the work
/// among threads.
const TASK_POSES: u64 = 20_000;
/// The largest number of poses in a task with rows that are images of each other. Both rows of a pair must be in the
/// same task.
const HALVED_TASK_POSES: u64 = 1_000_000;
/// The least number of tasks of a block, if it has as many rows.
const TASKS: u64 = 16;

/// Iterates over the tasks of one block (all angles at one pair of zooms) within the rows of a shard, in the order of
/// the first of their orientations. They are made one at a time, because a large grid has millions. If only counts are
/// wanted, groups that are mirror images share tasks; rows then come far out of order.
pub(crate) fn tasks(
    grid: &PoseGrid,
    shard: &Range<u64>,
    block: u64,
    detail: SweepDetail,
) -> impl Iterator<Item = Task> + use<> {
    let (angles, height) = (
        grid.ranges()[Axis::Angle].count(),
        grid.rows_per_orientation(),
    );
    let first_row = block * angles * height;
    let clipped = |row: u64| row.clamp(first_row, first_row + angles * height) - first_row;
    let rows = clipped(shard.start)..clipped(shard.end);
    let pieces = pieces(grid, rows, detail);
    let length = task_rows(grid, pieces.len() as u64);
    pieces.into_iter().flat_map(move |(groups, rows)| {
        let orientations = |group: Vec<u64>| {
            let all = group.into_iter().map(|angle| block * angles + angle);
            all.collect()
        };
        let groups: Arc<[Arc<[u64]>]> = groups.into_iter().map(orientations).collect();
        let starts = (0..(rows.end - rows.start).div_ceil(length)).map(move |task| task * length);
        starts.map(move |start| Task {
            groups: Arc::clone(&groups),
            rows: rows.start + start..rows.end.min(rows.start + start + length),
            detail,
        })
    })
}

/// One or two groups of angles, and the values of y0 to sweep for them.
type Piece = (Vec<Vec<u64>>, Range<u64>);

/// Gathers the angles of a block by the symmetries of the shape. `rows` are the rows of the block that a shard holds.
/// Angles of which it holds only a part are pieces of their own.
fn pieces(grid: &PoseGrid, rows: Range<u64>, detail: SweepDetail) -> Vec<Piece> {
    let height = grid.rows_per_orientation();
    let full = rows.start.div_ceil(height)..rows.end / height;
    let mut pieces: Vec<Piece> = Vec::new();
    let partial = |angle: u64| {
        let start = angle * height;
        let part = rows.start.max(start)..rows.end.min(start + height);
        (
            vec![vec![angle]],
            part.start.saturating_sub(start)..part.end.saturating_sub(start),
        )
    };
    if rows.start < full.start * height {
        pieces.push(partial(full.start - 1));
    }
    let classes = AngleClasses::of(grid.source(), grid.ranges()[Axis::Angle]);
    // The piece that the group of a class belongs to, and the group's index in it.
    let mut places: HashMap<i128, (usize, usize)> = HashMap::new();
    for angle in full.clone() {
        let class = classes.class(angle);
        let image = classes.mirrored(class);
        let image = image.filter(|_| detail == SweepDetail::Counts);
        let (piece, group) = match (
            places.get(&class),
            image.and_then(|image| places.get(&image)),
        ) {
            (Some(&place), _) => place,
            (None, Some(&(piece, _))) => (piece, 1),
            (None, None) => {
                pieces.push((Vec::new(), 0..height));
                (pieces.len() - 1, 0)
            }
        };
        places.insert(class, (piece, group));
        let groups = &mut pieces[piece].0;
        groups.resize(groups.len().max(group + 1), Vec::new());
        groups[group].push(angle);
    }
    if full.start <= full.end && full.end * height < rows.end {
        pieces.push(partial(full.end));
    }
    pieces
}

fn task_rows(grid: &PoseGrid, count: u64) -> u64 {
    let (width, height) = (grid.row_length(), grid.rows_per_orientation());
    // Rows can be images of each other only within a task.
    let halved = width * height <= HALVED_TASK_POSES && PointSymmetry::of(grid).is_some();
    let most = if halved {
        HALVED_TASK_POSES
    } else {
        TASK_POSES
    };
    (most / width).min(height * count / TASKS).max(1)
}

#[cfg(test)]
mod tests {
    #[test]
    fn examples() {
        use crate::sweep::Shard;
        let shard: Shard = "2/3".parse().unwrap();
        assert_eq!(shard.rows(10), 3..6);
        assert!("4/3".parse::<Shard>().is_err());
    }
}
