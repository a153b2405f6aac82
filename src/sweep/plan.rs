//! How a grid is cut up: shards for several machines, and tasks for the threads of one.
//!
//! A shard is a piece of the list of rows, in their order. A task is a piece of one orientation (an angle and a pair of
//! zooms); orientations at which the shape looks the same share it. The result does not depend on how tasks are cut.

use std::collections::HashMap;
use std::fmt;
use std::ops::Range;
use std::str::FromStr;
use std::sync::Arc;

use crate::pose::{Axis, PoseGrid, period};
use crate::quote::shortened;
use crate::sweep::point_symmetry::PointSymmetry;

/// One of `of` nearly equal pieces of a grid, `number` from 1.
///
/// ```
/// use taxel::sweep::Shard;
/// let shard: Shard = "2/3".parse().unwrap();
/// assert_eq!(shard.rows(10), 3..6);
/// assert!("4/3".parse::<Shard>().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    number: u32,
    of: u32,
}

impl Shard {
    /// The only piece.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Piece `number` of `of`, counted from 1.
    ///
    /// # Errors
    /// If `number` is not from 1 to `of`.
    pub fn new(number: u32, of: u32) -> Result<Self, ShardError> {
        if (1..=of).contains(&number) {
            Ok(Self { number, of })
        } else {
            Err(ShardError {
                text: format!("{number}/{of}"),
            })
        }
    }

    /// The number of the shard, from 1.
    pub fn number(&self) -> u32 {
        self.number
    }

    /// The number of shards.
    pub fn of(&self) -> u32 {
        self.of
    }

    /// The rows of this shard, of a grid with `rows` rows. The shards of a grid differ by one row at most.
    pub fn rows(&self, rows: u64) -> Range<u64> {
        let cut = |piece: u32| {
            // rows · piece / of, rounded down, without a product beyond 64 bits.
            let (piece, of) = (u64::from(piece), u64::from(self.of));
            rows / of * piece + rows % of * piece / of
        };
        cut(self.number - 1)..cut(self.number)
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
#[error("\"{text}\" is no shard, expected K/N with K from 1 to N")]
#[non_exhaustive]
pub struct ShardError {
    /// The text, shortened.
    pub text: String,
}

/// Some rows of an orientation, and of all orientations with the same imprints.
#[derive(Clone, Debug)]
pub(crate) struct Task {
    /// The orientations. The first of them is swept for all.
    pub(crate) turns: Arc<[u64]>,
    /// The indices of the values of y0.
    pub(crate) rows: Range<u64>,
}

/// The usual number of poses in a task: enough to outweigh its start, few enough to share the work among threads.
const TASK_POSES: u64 = 20_000;
/// The most poses in a task with rows that are images of each other. Both rows of a pair must be in the same task.
const HALVED_TASK_POSES: u64 = 1_000_000;
/// A block is cut into at least this many tasks, if it has as many rows.
const TASKS: u64 = 16;

/// The tasks of one block (all angles at one pair of zooms) within the rows of a shard, in the order in which they meet
/// new imprints. They are made one at a time, because a large grid has millions.
pub(crate) fn tasks(
    grid: &PoseGrid,
    shard: &Range<u64>,
    block: u64,
) -> impl Iterator<Item = Task> + use<> {
    let (angles, height) = (
        grid.ranges()[Axis::Angle].count(),
        grid.rows_per_orientation(),
    );
    let first_row = block * angles * height;
    let clipped = |row: u64| row.clamp(first_row, first_row + angles * height) - first_row;
    let pieces = pieces(grid, clipped(shard.start)..clipped(shard.end));
    let length = task_rows(grid, pieces.len() as u64);
    pieces.into_iter().flat_map(move |(members, rows)| {
        let turns = members.into_iter().map(|angle| block * angles + angle);
        let turns: Arc<[u64]> = turns.collect();
        let starts = (0..(rows.end - rows.start).div_ceil(length)).map(move |task| task * length);
        starts.map(move |start| Task {
            turns: Arc::clone(&turns),
            rows: rows.start + start..rows.end.min(rows.start + start + length),
        })
    })
}

/// Angles whose imprints are the same, and the values of y0 to sweep for the first of them.
type Piece = (Vec<u64>, Range<u64>);

/// The angles of a block, gathered by a period of the shape; `rows` are those of the block that a shard holds. Angles
/// that it holds only a part of are pieces of their own.
fn pieces(grid: &PoseGrid, rows: Range<u64>) -> Vec<Piece> {
    let height = grid.rows_per_orientation();
    let full = rows.start.div_ceil(height)..rows.end / height;
    let mut pieces: Vec<Piece> = Vec::new();
    let partial = |angle: u64| {
        let start = angle * height;
        let part = rows.start.max(start)..rows.end.min(start + height);
        (
            vec![angle],
            part.start.saturating_sub(start)..part.end.saturating_sub(start),
        )
    };
    if rows.start < full.start * height {
        pieces.push(partial(full.start - 1));
    }
    let mut classes: HashMap<i128, usize> = HashMap::new();
    let period = period(grid.source());
    for angle in full.clone() {
        let class = period.map_or(0, |period| {
            grid.ranges()[Axis::Angle].residue(angle, period)
        });
        let piece = *classes.entry(class).or_insert(pieces.len());
        if piece == pieces.len() {
            pieces.push((Vec::new(), 0..height));
        }
        pieces[piece].0.push(angle);
    }
    if full.start <= full.end && full.end * height < rows.end {
        pieces.push(partial(full.end));
    }
    pieces
}

/// How many rows make a task of a block with `count` pieces.
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
