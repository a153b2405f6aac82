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

use crate::pose::{Anchor, AngleClasses, Axis, DecimalRange, ONE, PoseGrid, period};
use crate::quote::shortened;

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
            Err(ShardError(format!("{number}/{of}")))
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
    pub(crate) fn check_after(self, last: Option<Self>) -> Result<(), MergeError> {
        let next = last.map_or(1, |last| last.number + 1);
        match self.number.cmp(&next) {
            Ordering::Less => Err(MergeError(format!("shard {self} is given twice"))),
            Ordering::Greater => Err(self.missing(next)),
            Ordering::Equal => Ok(()),
        }
    }

    pub(crate) fn check_last(self) -> Result<(), MergeError> {
        let is_last = self.number == self.of;
        is_last
            .then_some(())
            .ok_or_else(|| self.missing(self.number + 1))
    }

    fn missing(self, number: u32) -> MergeError {
        MergeError(format!("shard {number}/{} is missing", self.of))
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
        let error = || ShardError(shortened(text));
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
#[error("\"{0}\" is not a shard, {expected}", expected = self.expected())]
pub struct ShardError(String);

impl ShardError {
    /// Returns the part of the message that says what was expected, for a place that shows the text itself.
    #[must_use]
    pub fn expected(&self) -> &'static str {
        "expected K/N with K from 1 to N and N up to 4294967295"
    }
}

/// The error for shards that are not all those of one sweep or training, in their order; the message says which is
/// wrong.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct MergeError(pub(crate) String);

impl MergeError {
    pub(crate) fn nothing() -> Self {
        Self("no shards to merge".to_owned())
    }
}

/// Some rows of a group of orientations, and of the group of their mirror images.
#[derive(Clone, Debug)]
pub(crate) struct Task {
    /// One group, or two groups that are mirror images of each other, with right and left exchanged.
    pub(crate) groups: Arc<[Arc<[u64]>]>,
    pub(crate) rows: Range<u64>,
    /// Whether the runs of poses with the same imprint are wanted, not only counts.
    pub(crate) with_runs: bool,
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
    with_runs: bool,
) -> impl Iterator<Item = Task> + use<> {
    let (angles, height) = (
        grid.ranges()[Axis::Angle].count(),
        grid.rows_per_orientation(),
    );
    let first_row = block * angles * height;
    let clipped = |row: u64| row.clamp(first_row, first_row + angles * height) - first_row;
    let rows = clipped(shard.start)..clipped(shard.end);
    let pieces = pieces(grid, rows, with_runs);
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
            with_runs,
        })
    })
}

/// One or two groups of angles, and the values of y0 to sweep for them.
type Piece = (Vec<Vec<u64>>, Range<u64>);

/// Gathers the angles of a block by the symmetries of the shape. `rows` are the rows of the block that a shard holds.
/// Angles of which it holds only a part are pieces of their own.
fn pieces(grid: &PoseGrid, rows: Range<u64>, with_runs: bool) -> Vec<Piece> {
    let height = grid.rows_per_orientation();
    let mut pieces: Vec<Piece> = Vec::new();
    let classes = AngleClasses::of(grid.source(), grid.ranges()[Axis::Angle]);
    // The piece that the group of a class belongs to, and the group's index in it.
    let mut places: HashMap<i128, (usize, usize)> = HashMap::new();
    for angle in rows.start / height..rows.end.div_ceil(height) {
        let start = angle * height;
        let part = rows.start.max(start) - start..rows.end.min(start + height) - start;
        if part != (0..height) {
            pieces.push((vec![vec![angle]], part));
            continue;
        }
        let class = classes.class(angle);
        let image = classes.mirrored(class).filter(|_| !with_runs);
        let place = |class: i128| places.get(&class).copied();
        let (piece, group) = match (place(class), image.and_then(place)) {
            (Some(place), _) => place,
            (None, Some((piece, _))) => (piece, 1),
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

// Poses that follow from others by a half turn of the plane.
//
// A half turn about a point whose coordinates are whole or half cells maps taxels onto taxels. It maps a shape with
// point symmetry onto the same shape elsewhere: its centre goes from `c` to `m − c`, with `m` a whole number. If the
// ranges of x0 and y0 cover whole cells, and contain with every centre its image up to whole cells, then each row of
// an orientation is the image of another one, and only half of the rows need to be swept.
//
// **Exactly.** Positions are compared as decimals, so what is mapped is equal in real arithmetic, ties included. For
// that, twice the distance from anchor to centre must be a decimal. It is 0 with the anchor at the centre. Otherwise
// it is the sides of the bounding rectangle, which are decimals for ellipses, rectangles and pictures that are not
// zoomed, but not for regular polygons. What the sensor cuts off has no image, so the shape must lie inside the
// sensor in all poses of the orientation.

/// A half turn that maps the poses of an orientation onto each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PointSymmetry {
    pub(crate) x: IndexReflection,
    pub(crate) y: IndexReflection,
}

impl PointSymmetry {
    /// Returns the symmetry of a grid; None if the shape or the ranges are not mapped onto themselves. The caller
    /// must check that the shape lies inside the sensor in every pose.
    pub(crate) fn of(grid: &PoseGrid) -> Option<Self> {
        if period(grid.source()).is_some_and(|period| 180 % period != 0) {
            return None;
        }
        let ranges = grid.ranges();
        let is_unzoomed = |axis: &Axis| ranges[*axis] == DecimalRange::whole(1);
        // Twice the distance from the anchor to the centre.
        let [width, height] = match grid.anchor() {
            Anchor::Centre => [0.0; 2],
            Anchor::Corner if [Axis::ZoomX, Axis::ZoomY].iter().all(is_unzoomed) => {
                grid.source().box_sides()?
            }
            Anchor::Corner => return None,
        };
        Some(Self {
            x: IndexReflection::of(&ranges[Axis::X0], width)?,
            y: IndexReflection::of(&ranges[Axis::Y0], height)?,
        })
    }
}

/// A mapping of the values of a range onto each other: value `i` to value `last − i`, or to `last − i + count` if
/// that would be negative, so that it wraps around.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct IndexReflection {
    pub(crate) count: u64,
    pub(crate) last: u64,
    /// The sum of the coordinates of a centre and its image, in cells, for values up to `last`, and for those after it.
    cells: [i32; 2],
}

impl IndexReflection {
    /// Returns the reflection of a range whose values lie `extent / 2` before the centre; None if the values are not
    /// mapped onto each other.
    fn of(range: &DecimalRange, extent: f64) -> Option<Self> {
        // The shortest decimal that reads back as the number is the one that was given.
        let [extent, _] = extent.to_string().parse::<DecimalRange>().ok()?.exact();
        let [start, step] = range.exact();
        let whole = i128::from(range.count()) * step;
        // Two centres that are images of each other sum up to a whole number of cells.
        let way = (-2 * start - extent).rem_euclid(whole);
        if whole % ONE != 0 || way % step != 0 {
            return None;
        }
        let cells = (2 * start + extent + way) / ONE;
        Some(Self {
            count: range.count(),
            last: u64::try_from(way / step).ok()?,
            cells: [
                i32::try_from(cells).ok()?,
                i32::try_from(cells + whole / ONE).ok()?,
            ],
        })
    }

    /// Returns the value whose image this one is, and whether this one comes after `last`.
    pub(crate) fn image(&self, index: u64) -> (u64, bool) {
        if index <= self.last {
            (self.last - index, false)
        } else {
            (self.last + self.count - index, true)
        }
    }

    /// Returns the sum of the coordinates of a centre and its image, in cells, for values up to `last` or after it.
    pub(crate) fn cells(&self, after: bool) -> i32 {
        self.cells[usize::from(after)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Figure, FigureKind};
    use crate::picture::Picture;
    use crate::pose::Ranges;
    use crate::sensor::Sensor;
    use crate::source::Source;

    #[test]
    fn a_shard_is_a_part_of_the_rows() {
        let shard: Shard = "2/3".parse().expect("a shard");
        assert_eq!(shard.rows(10), 3..6);
        assert!("4/3".parse::<Shard>().is_err());
    }

    fn has_images(source: Source, anchor: Anchor, zoom: &str) -> bool {
        let ranges = Ranges::default().with(Axis::ZoomX, zoom.parse().expect("a range"));
        let grid = PoseGrid::new(source, Sensor::default(), anchor, ranges).expect("a grid");
        PointSymmetry::of(&grid).is_some()
    }

    fn fold(range: &str, extent: f64) -> Option<IndexReflection> {
        IndexReflection::of(&range.parse().expect("a range"), extent)
    }

    #[test]
    fn a_centre_and_its_image_sum_up_to_whole_cells() {
        for (range, extent) in [
            ("5:5.99:0.01", 6.0),
            ("5:5.99:0.01", 0.7),
            ("-0.5:1.4:0.1", 3.1),
            ("2.125:3.1:0.025", 2.4),
            ("7", 3.0),
            ("7.5", 0.0),
            ("0:2.97:0.03", 0.0),
        ] {
            let fold = fold(range, extent).expect("a fold");
            let range: DecimalRange = range.parse().expect("a range");
            for index in 0..range.count() {
                let (image, after) = fold.image(index);
                assert_eq!(fold.image(image), (index, after));
                let sum = range.value(index) + range.value(image) + extent;
                let cells = f64::from(fold.cells(after));
                assert!(
                    (sum - cells).abs() < 1e-9,
                    "{range} {extent}: {sum}, {cells}"
                );
            }
        }
    }

    #[test]
    fn only_shapes_that_a_half_turn_maps_onto_themselves_have_images() {
        let halved = |kind: FigureKind, anchor| {
            has_images(
                Source::Figure(Figure::default_of(kind, &Sensor::default())),
                anchor,
                "1",
            )
        };
        let (corner, centre) = (Anchor::Corner, Anchor::Centre);
        assert!(halved(FigureKind::Rectangle, corner) && halved(FigureKind::Ellipse, corner));
        assert!(halved(FigureKind::Hexagon, centre) && halved(FigureKind::Octagon, centre));
        assert!(!halved(FigureKind::Hexagon, corner) && !halved(FigureKind::Octagon, corner));
        assert!(!halved(FigureKind::Triangle, centre) && !halved(FigureKind::Heptagon, centre));
        let picture = |rows: &str, anchor, zoom: &str| {
            let rows = rows.parse().expect("rows");
            has_images(Source::Picture(Picture::at_home(rows)), anchor, zoom)
        };
        assert!(picture("##.\n.##", corner, "1") && !picture("###\n.##", corner, "1"));
        assert!(!picture("##.\n.##", corner, "0.5") && picture("##.\n.##", centre, "0.5"));
    }

    #[test]
    fn other_ranges_have_no_image() {
        // A step more or less than whole cells; a width between the steps; a position off the half cells; not a
        // decimal.
        for (range, extent) in [
            ("5:6:0.01", 6.0),
            ("5:5.98:0.01", 6.0),
            ("5:5.99:0.01", 6.005),
            ("5.3", 6.0),
            ("5:5.99:0.01", 3.0 * 3_f64.sqrt()),
        ] {
            assert_eq!(fold(range, extent), None, "{range} {extent}");
        }
    }
}
