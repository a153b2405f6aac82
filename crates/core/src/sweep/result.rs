//! The result of a sweep: the atlas of distinct imprints, the statistics of their features, and the numbers that its
//! file holds.

use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

use crate::atlas::{Atlas, ImprintCounter, Statistic, Table, VarianceParts, statistics};
use crate::geometry::{Ellipse, Pen, Point, Side, Solid};
use crate::imprint::Imprint;
use crate::index::{index, wide};
use crate::pose::{Axis, PoseGrid, PoseIndex};
use crate::progress::ToTheEnd;
use crate::source::Source;
use crate::sweep::plan::{MergeError, Shard, Task};
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
/// assert_eq!((result.poses, result.atlas.len()), (10_000, 393));
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
    /// Returns true if every pose of the shard was swept.
    pub fn complete(&self) -> bool {
        self.poses == self.shard.poses(&self.grid)
    }

    /// Creates the result of a sweep that has not begun.
    pub(crate) fn empty(grid: PoseGrid, shard: Shard) -> Self {
        let poses = grid.row_length() * grid.rows_per_orientation();
        Self {
            atlas: Atlas::new(grid.sensor().size()),
            variance_parts: VarianceParts::new(poses),
            grid,
            shard,
            poses: 0,
            partly_off: 0,
            statistics: Vec::new(),
        }
    }

    /// Computes the statistics. `table` holds the features of the imprints, in the order of the atlas.
    pub(crate) fn with_statistics(self, table: &Table) -> Self {
        let ideal = Ideal::of(self.grid.source());
        let counts: Vec<u64> = self.atlas.counts().collect();
        let ideal = |key: &str| ideal?.get(key);
        let statistics = statistics(table, &counts, &self.variance_parts, ideal);
        Self { statistics, ..self }
    }

    /// Computes the features of the imprints, and the statistics from them.
    fn described(self) -> Self {
        let mut table = Table::default();
        table.extend(self.atlas.summaries());
        self.with_statistics(&table)
    }

    /// Returns the atlas numbers of the poses with these indices of x0 and y0, row after row, at the angle and the
    /// zooms of `orientation` (its x0 and y0 do not matter).
    ///
    /// A number is None if the atlas does not have the imprint, because the sweep was stopped before. The result is
    /// empty if a range leaves the grid. It takes as long as sweeping these poses.
    pub fn ids(&self, orientation: PoseIndex, x0: Range<u64>, y0: Range<u64>) -> Vec<Option<u32>> {
        let [columns, rows] = [&x0, &y0].map(|range| range.end.saturating_sub(range.start));
        let from = orientation
            .with(Axis::X0, x0.start)
            .with(Axis::Y0, y0.start);
        let counts = PoseIndex::new([columns, rows, 1, 1, 1]);
        let Some(part) = self.grid.part(from, counts) else {
            return Vec::new();
        };
        let task = Task {
            groups: Arc::from([Arc::from([0])]),
            rows: 0..rows,
            with_runs: true,
        };
        let found = runs::sweep_task(&part, self.atlas.layout(), &task, &ToTheEnd);
        let Some(found) = found.as_deref().and_then(<[_]>::first) else {
            return Vec::new();
        };
        let counter = &found.counter;
        let ids: Vec<Option<u32>> = (0..counter.len())
            .map(|index| self.atlas.number(counter.key(index), counter.hash(index)))
            .collect();
        let runs = (0..index(rows)).flat_map(|row| found.runs.row(row));
        let numbers = runs.flat_map(|&(imprint, length)| {
            let id = ids.get(wide(imprint)).copied().flatten();
            std::iter::repeat_n(id, wide(length))
        });
        numbers.collect()
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

    /// Creates a result from its numbers.
    ///
    /// # Errors
    /// Returns an error if they contradict each other or the grid.
    pub fn from_parts(grid: PoseGrid, shard: Shard, parts: &Parts) -> Result<Self, PartsError> {
        let check = |holds: bool, what: &'static str| holds.then_some(()).ok_or(PartsError(what));
        let size = grid.sensor().size();
        let height = usize::from(size.rows());
        let same = parts.counts.len() == parts.first_poses.len()
            && parts.counts.len().checked_mul(height) == Some(parts.rows.len());
        check(same, "arrays of different lengths")?;
        let sum: u128 = parts.counts.iter().map(|&count| u128::from(count)).sum();
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
        let mut result = Self::empty(grid, shard);
        (result.poses, result.partly_off) = (parts.poses, parts.partly_off);
        let layout = result.atlas.layout();
        let mut counter = ImprintCounter::new(layout.words());
        let entries = parts.counts.iter().zip(&parts.first_poses);
        for (words, (&count, &first)) in parts.rows.chunks_exact(height).zip(entries) {
            let mut imprint = Imprint::empty(size);
            for (row, &word) in words.iter().enumerate() {
                imprint.set_word(row, word);
            }
            check(imprint.words() == words, "taxels beyond the sensor")?;
            check(count > 0, "an imprint that no pose leaves")?;
            let (key, hash) = layout.key(&imprint);
            let known = counter.len();
            counter.add(&key, hash, count, first);
            check(counter.len() > known, "an imprint that is there twice")?;
        }
        let orientation = width * result.grid.rows_per_orientation();
        result.variance_parts = VarianceParts::from_words(orientation, &parts.variance_words)
            .ok_or(PartsError(
                "sums that contradict each other, or of another version",
            ))?;
        result.atlas.add(&counter, 1);
        result.atlas.describe();
        let result = result.described();
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

// Merges the shards of a sweep.
//
// Shards are merged in the order of the grid, so first poses stay the first, and imprints have the same numbers as in
// a single sweep. Memory holds only what is already merged and one shard.

/// The shards of a sweep that were added so far: their result, with the last of them as its shard.
#[derive(Debug, Default)]
pub struct SweepMerge(Option<SweepResult>);

impl SweepMerge {
    /// Adds the next shard: the first, then the second, and so on.
    ///
    /// # Errors
    /// Returns an error if it is incomplete, not the next one, or of another grid than the first. The merge then
    /// stays unchanged.
    pub fn add(&mut self, result: SweepResult) -> Result<(), MergeError> {
        let shard = result.shard;
        // Everything is checked before anything changes: after a refusal, the right shard can still be added.
        if let Some(difference) = self.0.as_ref().and_then(|own| difference(&result, own)) {
            let text = format!("shard {shard} differs from the first one in {difference}");
            return Err(MergeError(text));
        }
        shard.check_after(self.0.as_ref().map(|merged| merged.shard))?;
        if !result.complete() {
            let text = format!("shard {shard} was stopped early, run it again");
            return Err(MergeError(text));
        }
        let Some(merged) = &mut self.0 else {
            self.0 = Some(result);
            return Ok(());
        };
        merged.shard = shard;
        merged.atlas.add_all(&result.atlas);
        merged.variance_parts.merge(result.variance_parts);
        merged.poses += result.poses;
        merged.partly_off += result.partly_off;
        Ok(())
    }

    /// Returns the result of all shards together.
    ///
    /// # Errors
    /// Returns an error if some are missing.
    pub fn finish(self) -> Result<SweepResult, MergeError> {
        let mut merged = self.0.ok_or_else(MergeError::nothing)?;
        merged.shard.check_last()?;
        merged.shard = Shard::WHOLE;
        Ok(merged.described())
    }
}

/// Returns what makes two results no shards of one sweep; None if they can be. The source lies where its ranges begin,
/// so it is compared last.
fn difference(one: &SweepResult, other: &SweepResult) -> Option<&'static str> {
    if one.shard.of() != other.shard.of() {
        return Some("the number of shards");
    }
    let (one, other) = (&one.grid, &other.grid);
    if one == other {
        None
    } else if one.sensor() != other.sensor() {
        Some("its sensor")
    } else if (one.ranges(), one.anchor()) != (other.ranges(), other.anchor()) {
        Some("its ranges or their anchor")
    } else {
        Some("its shape")
    }
}

// The descriptors that a figure would have on a sensor of infinitely many, infinitely small cells.
//
// Only some descriptors have such a value: `na` is the figure's area, `nae` its area with the hole, and `p` the length
// of its outer outline; `f` and `roundness` follow from these. Units are cells and cell sides. Pictures have none,
// because their pieces and zooms do not give a single value.

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Ideal {
    area: f64,
    filled: f64,
    outline: f64,
}

impl Ideal {
    /// Computes the ideal of a figure; None for a picture.
    pub(crate) fn of(source: &Source) -> Option<Self> {
        let Source::Figure(figure) = source else {
            return None;
        };
        let mut ideal = Self::default();
        figure.draw(&mut ideal);
        Some(ideal)
    }

    pub(crate) fn get(&self, key: &str) -> Option<f64> {
        match key {
            "na" => Some(self.area),
            "nae" => Some(self.filled),
            "p" => Some(self.outline),
            "f" => Some(self.outline * self.outline / self.filled),
            "roundness" => Some(4.0 * PI * self.filled / (self.outline * self.outline)),
            _ => None,
        }
    }

    fn add(&mut self, area: f64, outline: f64, material: Side) {
        if material == Side::Inside {
            self.area += area;
            self.filled += area;
            self.outline += outline;
        } else {
            self.area -= area;
        }
    }
}

impl Pen<f64> for Ideal {
    /// Does nothing: figures draw rings and ellipses only.
    fn edge(&mut self, _from: Point<f64>, _to: Point<f64>) {}

    fn ring(&mut self, points: &[Point<f64>], material: Side) {
        let next = points.iter().cycle().skip(1);
        let (mut doubled, mut length) = (0.0, 0.0);
        for (one, other) in points.iter().zip(next) {
            doubled += one.x * other.y - other.x * one.y;
            length += libm::hypot(other.x - one.x, other.y - one.y);
        }
        self.add(f64::abs(doubled) / 2.0, length, material);
    }

    fn ellipse(&mut self, ellipse: &Ellipse<f64>, material: Side) {
        let length = |vector: Point<f64>| libm::hypot(vector.x, vector.y);
        let (one, other) = (length(ellipse.across), length(ellipse.along));
        self.add(PI * one * other, perimeter(one, other), material);
    }
}

/// Returns the perimeter of an ellipse by the arithmetic-geometric mean (Gauss): with `c² = a² − b²` at each step,
/// `2π·(a₀² − Σ 2ⁿ⁻¹·cₙ²) / M`.
fn perimeter(one: f64, other: f64) -> f64 {
    let (mut a, mut b) = (one.max(other), one.min(other));
    let mut sum = a * a;
    let mut power = 0.5;
    while (a - b) > 1e-16 * a {
        sum -= power * (a - b) * (a + b);
        (a, b) = (f64::midpoint(a, b), (a * b).sqrt());
        power *= 2.0;
        if power > 64.0 {
            break;
        }
    }
    2.0 * PI * sum / a
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;
    use crate::atlas::features;
    use crate::figure::{Figure, FigureKind};
    use crate::picture::Picture;
    use crate::pose::{Anchor, DecimalRange, Ranges};
    use crate::progress::stop_if;
    use crate::sensor::Sensor;
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
}
