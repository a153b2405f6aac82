//! The result of a sweep: the atlas of distinct imprints, the statistics of their features, and the numbers that its
//! file holds.

use std::ops::Range;
use std::sync::Arc;

use crate::atlas::{Atlas, ImprintCounter, Statistic, Table, VarianceParts, statistics};
use crate::imprint::Imprint;
use crate::index::{index, wide};
use crate::pose::{Axis, PoseGrid, PoseIndex};
use crate::progress::ToTheEnd;
use crate::sweep::ideal::Ideal;
use crate::sweep::plan::{Shard, SweepDetail, Task};
use crate::sweep::runs;

/// The result of a sweep.
///
/// ```
/// use taxel_core::prelude::*;
///
/// // The paper's ring: over one cell of positions it leaves 393 different imprints.
/// let sensor = Sensor::default();
/// let ring = Figure::ellipse(4.0, 4.0).thickness(2.0).on(&sensor).expect("in range");
/// let cell: DecimalRange = "1:1.99:0.01".parse()?;
/// let upright = Ranges::default().with(Axis::Angle, "0".parse()?);
/// let ranges = upright.with(Axis::X0, cell).with(Axis::Y0, cell);
/// let grid = PoseGrid::new(ring.into(), sensor, Anchor::Corner, ranges).unwrap();
/// let result = Sweep::new(&grid).run();
/// assert_eq!((result.poses(), result.atlas().len()), (10_000, 393));
/// # Ok::<(), taxel_core::pose::RangeError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SweepResult {
    /// The grid that was swept.
    pub grid: PoseGrid,
    /// The part of the grid that was to be swept; [`Shard::WHOLE`] after a merge.
    pub shard: Shard,
    /// The number of poses swept. If the sweep was stopped, it is less than the number of poses of the shard.
    pub poses: u64,
    /// The number of poses that reach beyond the sensor.
    pub partly_off: u64,
    /// The distinct imprints.
    pub atlas: Atlas,
    /// The statistics of each descriptor, in the order of [`crate::atlas::features`].
    pub statistics: Vec<Statistic>,
    pub(crate) variance_parts: VarianceParts,
}

impl PartialEq for SweepResult {
    fn eq(&self, other: &Self) -> bool {
        // Statistics follow from the atlas and the parts of the variance.
        (&self.grid, self.shard, self.poses, self.partly_off)
            == (&other.grid, other.shard, other.poses, other.partly_off)
            && self.atlas == other.atlas
            && self.variance_parts == other.variance_parts
    }
}

impl SweepResult {
    /// Returns the grid.
    pub fn grid(&self) -> &PoseGrid {
        &self.grid
    }

    /// Returns the part of the grid that was to be swept; [`Shard::WHOLE`] after a merge.
    pub fn shard(&self) -> Shard {
        self.shard
    }

    /// Returns the number of poses swept. If the sweep was stopped, it is less than the number of poses of the shard.
    pub fn poses(&self) -> u64 {
        self.poses
    }

    /// Returns the number of poses that reach beyond the sensor.
    pub fn partly_off(&self) -> u64 {
        self.partly_off
    }

    /// Returns the distinct imprints.
    pub fn atlas(&self) -> &Atlas {
        &self.atlas
    }

    /// Returns the statistics of each feature, in the order of [`crate::atlas::features`].
    pub fn statistics(&self) -> &[Statistic] {
        &self.statistics
    }

    /// Returns true if every pose of the shard was swept.
    pub fn complete(&self) -> bool {
        self.poses == self.shard.poses(&self.grid)
    }

    pub(crate) fn new(
        grid: PoseGrid,
        shard: Shard,
        (poses, partly_off): (u64, u64),
        atlas: Atlas,
        table: &Table,
        variance_parts: VarianceParts,
    ) -> Self {
        let ideal = Ideal::of(grid.source());
        let counts: Vec<u64> = atlas.counts().collect();
        let statistics = statistics(table, &counts, &variance_parts, |key| ideal?.get(key));
        Self {
            grid,
            shard,
            poses,
            partly_off,
            atlas,
            statistics,
            variance_parts,
        }
    }

    /// Returns the atlas numbers of the poses with these indices of x0 and y0, row after row, at the angle and the
    /// zooms of `orientation` (its x0 and y0 do not matter).
    ///
    /// A number is None if the atlas does not have the imprint, because the sweep was stopped before. The result is
    /// empty if a range leaves the grid. It takes as long as sweeping these poses.
    pub fn ids(&self, orientation: PoseIndex, x0: Range<u64>, y0: Range<u64>) -> Vec<Option<u32>> {
        let rows = y0.end.saturating_sub(y0.start);
        let from = orientation
            .with(Axis::X0, x0.start)
            .with(Axis::Y0, y0.start);
        let columns = x0.end.saturating_sub(x0.start);
        let Some(part) = self
            .grid
            .part(from, PoseIndex::new([columns, rows, 1, 1, 1]))
        else {
            return Vec::new();
        };
        let task = Task {
            groups: Arc::from([Arc::from([0])]),
            rows: 0..rows,
            detail: SweepDetail::Runs,
        };
        let found = runs::sweep_task(&part, self.atlas.layout(), &task, &ToTheEnd);
        let Some(found) = found.as_deref().and_then(<[_]>::first) else {
            return Vec::new();
        };
        let counter = &found.counter;
        let ids: Vec<Option<u32>> = (0..counter.len())
            .map(|index| self.atlas.number(counter.key(index), counter.hash(index)))
            .collect();
        let rows = 0..index(rows);
        let runs = rows.flat_map(|row| found.runs.row(row));
        let runs = runs.flat_map(|&(imprint, length)| {
            let id = ids.get(wide(imprint)).copied().flatten();
            std::iter::repeat_n(id, wide(length))
        });
        runs.collect()
    }

    /// Returns the numbers that the result consists of.
    pub fn parts(&self) -> Parts {
        let mut parts = Parts {
            poses: self.poses,
            partly_off: self.partly_off,
            variance_words: self.variance_parts.words(),
            ..Parts::default()
        };
        for entry in self.atlas.entries() {
            parts.rows.extend_from_slice(entry.imprint.words());
            parts.counts.push(entry.count);
            parts.first_poses.push(entry.first_pose);
        }
        parts
    }

    /// Creates a result from its numbers; an error if they contradict each other or the grid.
    pub fn from_parts(grid: PoseGrid, shard: Shard, parts: &Parts) -> Result<Self, PartsError> {
        let check = |holds: bool, what: &'static str| holds.then_some(()).ok_or(PartsError(what));
        let size = grid.sensor().size();
        let height = usize::from(size.rows());
        let same = parts.counts.len() == parts.first_poses.len()
            && parts.counts.len().checked_mul(height) == Some(parts.rows.len());
        check(same, "arrays of different lengths")?;
        let sum = parts
            .counts
            .iter()
            .map(|&count| u128::from(count))
            .sum::<u128>();
        check(sum == u128::from(parts.poses), "counts that do not add up")?;
        let own = shard.rows(grid.rows());
        let width = grid.row_length();
        check(
            parts.poses <= shard.poses(&grid) && parts.partly_off <= parts.poses,
            "more poses than there are",
        )?;
        let ascending = parts.first_poses.windows(2).all(|pair| pair[0] < pair[1]);
        let (first, last) = (parts.first_poses.first(), parts.first_poses.last());
        let inside = first.is_none_or(|&first| first >= own.start * width)
            && last.is_none_or(|&last| last < own.end * width);
        check(ascending && inside, "first poses out of order")?;
        let mut atlas = Atlas::new(size);
        let mut counter = ImprintCounter::new(atlas.layout().words());
        let entries = parts.counts.iter().zip(&parts.first_poses);
        for (words, (&count, &first)) in parts.rows.chunks_exact(height).zip(entries) {
            let mut imprint = Imprint::empty(size);
            for (row, &word) in words.iter().enumerate() {
                imprint.set_word(row, word);
            }
            check(imprint.words() == words, "taxels beyond the sensor")?;
            check(count > 0, "an imprint that no pose leaves")?;
            let (key, hash) = atlas.layout().key(&imprint);
            let known = counter.len();
            counter.add(&key, hash, count, first);
            check(counter.len() > known, "an imprint that is there twice")?;
        }
        let variance_parts =
            VarianceParts::from_words(width * grid.rows_per_orientation(), &parts.variance_words)
                .ok_or(PartsError(
                "sums that contradict each other, or of another version",
            ))?;
        atlas.add(&counter, 1);
        atlas.describe();
        let mut table = Table::default();
        table.extend(atlas.summaries());
        let poses = (parts.poses, parts.partly_off);
        let result = Self::new(grid, shard, poses, atlas, &table, variance_parts);
        let is_possible = result.statistics.iter().all(Statistic::has_possible_parts);
        check(is_possible, "sums that contradict the imprints")?;
        Ok(result)
    }
}

/// The numbers that a result consists of.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Parts {
    /// The number of poses swept. If the sweep was stopped, it is less than the number of poses of the shard.
    pub poses: u64,
    /// The number of poses that reach beyond the sensor.
    pub partly_off: u64,
    /// The imprints one after another, a word per row of the sensor, bit `i` for column `i`.
    pub rows: Vec<u64>,
    /// How often each imprint occurs.
    pub counts: Vec<u64>,
    /// The number of the first pose of each imprint.
    pub first_poses: Vec<u64>,
    /// Sums over the orientations, in a form that may change between versions.
    pub variance_words: Vec<u64>,
}

/// The error for numbers that do not make a result.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct PartsError(&'static str);

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;
    use crate::atlas::features;
    use crate::figure::{Figure, FigureKind};
    use crate::picture::Picture;
    use crate::pose::{Anchor, Axis, DecimalRange, Ranges};
    use crate::progress::stop_if;
    use crate::sensor::Sensor;
    use crate::source::Source;
    use crate::sweep::run::Sweep;
    use crate::touch::Plane;

    #[test]
    fn first_poses_lie_in_the_shard() {
        let ranges = Ranges::default().with(Axis::Angle, DecimalRange::whole(0));
        let source = Source::Figure(Figure::default_of(FigureKind::Hexagon, &Sensor::default()));
        let grid =
            PoseGrid::new(source, Sensor::default(), Anchor::Corner, ranges).expect("a grid");
        let shard = Shard::new(2, 2).expect("a shard");
        let parts = Sweep::new(&grid).with_shard(shard).run().parts();
        let read = |first: u64| {
            let mut parts = parts.clone();
            parts.first_poses[0] = first;
            SweepResult::from_parts(grid.clone(), shard, &parts)
                .map(|result| result.parts() == parts)
        };
        assert_eq!(parts.first_poses[0], 5000);
        assert_eq!(read(5000), Ok(true));
        assert_eq!(read(4999), Err(PartsError("first poses out of order")));
        let first = Shard::new(1, 2).expect("a shard");
        let mut parts = Sweep::new(&grid).with_shard(first).run().parts();
        *parts.first_poses.last_mut().expect("some") = 5000;
        let read = SweepResult::from_parts(grid.clone(), first, &parts);
        assert_eq!(read.err(), Some(PartsError("first poses out of order")));
    }

    #[test]
    fn each_fault_of_the_numbers_has_its_own_reason() {
        let ranges = Ranges::default().with(Axis::Angle, DecimalRange::whole(0));
        let source = Source::Figure(Figure::default_of(FigureKind::Hexagon, &Sensor::default()));
        let grid =
            PoseGrid::new(source, Sensor::default(), Anchor::Corner, ranges).expect("a grid");
        let parts = Sweep::new(&grid).run().parts();
        let height = usize::from(grid.sensor().rows());
        let fault = |spoil: &dyn Fn(&mut Parts)| {
            let mut parts = parts.clone();
            spoil(&mut parts);
            let read = SweepResult::from_parts(grid.clone(), Shard::WHOLE, &parts);
            read.err().map(|PartsError(what)| what)
        };
        assert_eq!(fault(&|_| ()), None);
        let emptied = fault(&|parts| {
            parts.counts[0] += parts.counts[1];
            parts.counts[1] = 0;
        });
        assert_eq!(emptied, Some("an imprint that no pose leaves"));
        let more = Some("more poses than there are");
        assert_eq!(fault(&|parts| parts.partly_off = parts.poses + 1), more);
        let equal = fault(&|parts| parts.first_poses[1] = parts.first_poses[0]);
        assert_eq!(equal, Some("first poses out of order"));
        let doubled = fault(&|parts| parts.rows.copy_within(..height, height));
        assert_eq!(doubled, Some("an imprint that is there twice"));
        let sums = Some("sums that contradict each other, or of another version");
        assert_eq!(fault(&|parts| parts.variance_words.push(0)), sums);
        // An orientation with sums for more poses than it has.
        let orientation = 3 + 5 * features().len();
        let unsound = |parts: &mut Parts| parts.variance_words.extend(vec![u64::MAX; orientation]);
        assert_eq!(fault(&unsound), sums);
        // The first feature's sum over the orientations, too large and too small.
        for word in [u64::MAX >> 1, 0] {
            let other = fault(&|parts| parts.variance_words[..3].fill(word));
            assert_eq!(other, Some("sums that contradict the imprints"), "{word}");
        }
    }

    #[test]
    fn a_window_shows_what_touching_finds() {
        let range = |text: &str| text.parse().expect("a range");
        let imprint = Imprint::from_rows(["##.", ".##"]).expect("rows");
        let ellipse = Source::Figure(Figure::default_of(FigureKind::Ellipse, &Sensor::default()));
        for (source, zoom) in [
            (ellipse, "1"),
            (Source::Picture(Picture::at_home(imprint)), "1:2:0.5"),
        ] {
            let ranges = Ranges::default()
                .with(Axis::X0, range("3:5:0.1"))
                .with(Axis::Y0, range("4:6:0.1"))
                .with(Axis::Angle, range("0:40:20"))
                .with(Axis::ZoomX, range(zoom))
                .with(Axis::ZoomY, range("1"));
            let grid = PoseGrid::new(source, Sensor::default(), Anchor::Corner, ranges);
            let grid = grid.expect("in range");
            let result = Sweep::new(&grid).run();
            let mut plane = Plane::new(*grid.sensor());
            for angle in [0, 1, 2] {
                let zoom = angle.min(grid.counts()[Axis::ZoomX] - 1);
                let ids = result.ids(PoseIndex::new([9, 9, angle, zoom, 0]), 3..17, 2..9);
                assert_eq!(ids.len(), 14 * 7);
                for (index, id) in (0..).zip(ids) {
                    let index = [3 + index % 14, 2 + index / 14, angle, zoom, 0];
                    let pose = grid.number(PoseIndex::new(index));
                    let touched = plane.touch(&grid.placed(pose));
                    assert_eq!(id, result.atlas.find(&touched), "pose {pose}");
                    assert!(id.is_some());
                }
            }
            assert_eq!(result.ids(PoseIndex::new([0; 5]), 0..22, 0..1), []);
            assert_eq!(result.ids(PoseIndex::new([0; 5]), 4..4, 0..1), []);
            assert_eq!(result.ids(PoseIndex::new([0, 0, 3, 0, 0]), 0..1, 0..1), []);
        }
    }

    #[test]
    fn poses_that_were_not_swept_have_no_number() {
        let source = Source::Figure(Figure::default_of(
            FigureKind::Rectangle,
            &Sensor::default(),
        ));
        let grid = PoseGrid::new(source, Sensor::default(), Anchor::Corner, Ranges::default());
        let grid = grid.expect("in range");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let stopped = pool.expect("threads").install(|| {
            let done = AtomicU64::new(0);
            // Some orientations are complete by then, but far from all.
            let progress = |poses| stop_if(done.fetch_add(poses, Ordering::Relaxed) >= 1_000_000);
            Sweep::new(&grid).with_progress(&progress).run()
        });
        assert!(!stopped.complete() && stopped.poses > 0);
        assert_eq!(stopped.ids(PoseIndex::new([0; 5]), 0..1, 0..1), [Some(0)]);
        let ids = stopped.ids(PoseIndex::new([0, 0, 37, 0, 0]), 0..100, 0..100);
        assert!(ids.contains(&None));
    }

    #[test]
    fn examples() -> Result<(), Box<dyn std::error::Error>> {
        use crate::prelude::*;
        let square = Source::Figure(Figure::default_of(
            FigureKind::Rectangle,
            &Sensor::default(),
        ));
        let ranges = Ranges::default().with(Axis::Angle, "0".parse()?);
        let grid = PoseGrid::new(square, Sensor::default(), Anchor::Corner, ranges)?;
        let result = Sweep::new(&grid).run();
        // At x0 5.5 the columns at both ends are covered by half, and active.
        assert_eq!(
            result.ids(PoseIndex::new([0; 5]), 49..52, 0..1),
            [Some(0), Some(1), Some(2)]
        );
        Ok(())
    }
}
