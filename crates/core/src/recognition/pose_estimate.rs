use crate::atlas::ImprintKey;
use crate::imprint::Imprint;
use crate::index::narrow;
use crate::pose::{Axis, PoseGrid, Ranges, exact_period};
use crate::progress::Progress;
use crate::recognition::fit::thinned;
use crate::recognition::model::{Model, float};
use crate::sweep::{Shard, Sweep};
use crate::touch::Plane;

/// A summary of the poses in which a shape leaves an imprint.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseEstimate {
    /// The number of poses that leave the imprint, of those that were tried.
    pub poses: u64,
    /// The mean position x, y of the centre, about which the shape turns, in cells on the matrix of the imprint.
    pub position: [f64; 2],
    /// The standard deviations of x and y, in cells.
    pub standard_deviation: [f64; 2],
    /// The angle; None if the shape looks the same at any angle, like a disc.
    pub angle: Option<AngleEstimate>,
}

/// The angles at which a shape leaves an imprint, up to its symmetry.
#[derive(Clone, Debug, PartialEq)]
pub struct AngleEstimate {
    /// Degrees after which the shape looks the same again; 360/7 for a heptagon.
    pub period: f64,
    /// Circular mean in degrees, from 0 to below the period. None if the angles point equally in all directions.
    pub mean: Option<f64>,
    /// Circular standard deviation in degrees. None if the mean is None.
    pub standard_deviation: Option<f64>,
    /// The fewest neighbouring whole degrees that hold 95 % of the poses: the first degree, and the number of
    /// degrees.
    pub shortest_arc: (u32, u32),
}

impl AngleEstimate {
    /// Returns mean and standard deviation. None if the angles spread as far as if they were unknown: as far as
    /// equally likely angles of one period, whose standard deviation is the period divided by √12. The mean lies
    /// between the [`ends`](Self::ends), so it may be below 0.
    #[must_use]
    pub fn known(&self) -> Option<(f64, f64)> {
        let (mean, deviation) = (self.mean?, self.standard_deviation?);
        if deviation >= self.period / 12_f64.sqrt() {
            return None;
        }
        let begun = self.ends().0 < 0 && mean >= f64::from(self.shortest_arc.0);
        Some((if begun { mean - self.period } else { mean }, deviation))
    }

    /// Returns the first and the last of the fewest whole degrees that hold 95 % of the poses. If they pass the end
    /// of the period, the first is below 0.
    #[must_use]
    pub fn ends(&self) -> (i64, i64) {
        let (first, count) = self.shortest_arc;
        let (first, count) = (i64::from(first), i64::from(count));
        let (last, degrees) = (first + count - 1, i64::from(whole_degrees(self.period)));
        if last < degrees {
            (first, last)
        } else {
            (first - degrees, last - degrees)
        }
    }
}

/// Returns the number of whole degrees in a period, counting one that is cut short: 52 for a heptagon.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "1 to 360"
)]
fn whole_degrees(period: f64) -> u32 {
    period.ceil() as u32
}

/// The largest steps between the poses that are tried for an imprint that no pose of the model leaves, and how far
/// they go: a whole cell further, the keys repeat.
const FINE_STEPS: [(Axis, f64, f64); 3] = [
    (Axis::X0, 0.05, 1.0),
    (Axis::Y0, 0.05, 1.0),
    (Axis::Angle, 1.0, 360.0),
];

impl Model {
    /// Finds the poses in which a shape leaves an imprint, by touching with the shape in every pose of the model. If it
    /// leaves the imprint in none of them, finer poses of the same ranges are tried: at most 0.05 cells and 1° apart, up
    /// to just before the value after the last one, but within a cell. Of a shard, only its own poses count, and none in
    /// between. `progress` is called as by [`Sweep::with_progress`]. None if there is no such shape, if it leaves the
    /// imprint in none of these poses, if the imprint is empty, or if it was stopped.
    pub fn pose_of(
        &self,
        shape: usize,
        imprint: &Imprint,
        progress: &dyn Progress,
    ) -> Option<PoseEstimate> {
        let own = *self.ranges();
        self.pose_within(own, shape, imprint, progress).or_else(|| {
            let mut ranges = own;
            for (axis, most, span) in FINE_STEPS {
                ranges[axis] = thinned(ranges[axis].divided(most)?, most, span)?;
            }
            let is_finer = ranges != own && self.shard() == Shard::WHOLE;
            is_finer.then(|| self.pose_within(ranges, shape, imprint, progress))?
        })
    }

    /// Finds the poses within these ranges.
    fn pose_within(
        &self,
        ranges: Ranges,
        shape: usize,
        imprint: &Imprint,
        progress: &dyn Progress,
    ) -> Option<PoseEstimate> {
        let bounds = imprint.bounds()?;
        let key = ImprintKey::of(imprint);
        let source = self.shapes().get(shape)?.source.clone();
        let period = exact_period(&source, &ranges);
        let grid = PoseGrid::new(source, *self.sensor(), self.anchor(), ranges).ok()?;
        let wanted = |other: &Imprint| ImprintKey::of(other) == key;
        let sweep = Sweep::new(&grid)
            .with_shard(self.shard())
            .with_progress(progress);
        let runs = sweep.poses_where(&wanted)?;
        let mut plane = Plane::new(*grid.sensor());
        let mut sums = PoseMoments::default();
        let mut degrees = vec![0; period.map_or(1, whole_degrees) as usize];
        for run in runs {
            // All poses of a run leave one imprint, in one place.
            let there = plane.touch(&grid.placed(run.first)).bounds()?;
            let by = [
                f64::from(bounds.left) - f64::from(there.left),
                f64::from(bounds.top) - f64::from(there.top),
            ];
            let last = grid.centre(run.first + run.poses - 1)[0];
            let [x, y] = grid.centre(run.first);
            let weight = run.poses * run.orientations;
            sums.add(weight, (x + by[0], last + by[0]), run.poses, y + by[1]);
            if let Some(period) = period {
                let angle = grid.pose(run.first)[Axis::Angle].rem_euclid(period);
                sums.add_direction(weight, angle / period);
                degrees[whole(angle, period)] += weight;
            }
        }
        sums.finish(period.map(|period| (period, degrees)))
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "0 to 359"
)]
fn whole(angle: f64, period: f64) -> usize {
    (angle as usize).min(whole_degrees(period) as usize - 1)
}

#[derive(Debug, Default)]
struct PoseMoments {
    poses: u64,
    /// The first position. The others are measured from it, because rounding errors of large squares would look like a
    /// spread.
    origin: Option<[f64; 2]>,
    position: [f64; 2],
    squares: [f64; 2],
    /// The first angle, as a part of a full turn. The others are measured from it, for the same reason.
    first_part: Option<f64>,
    cosine: f64,
    sine: f64,
}

impl PoseMoments {
    fn add(&mut self, weight: u64, (from, to): (f64, f64), count: u64, y: f64) {
        let (poses, number) = (float(weight), float(count));
        let middle = f64::midpoint(from, to);
        let origin = *self.origin.get_or_insert([middle, y]);
        let (x, y) = (middle - origin[0], y - origin[1]);
        // The variance of `count` equally spaced values between two ends.
        let own = if count > 1 {
            (to - from).powi(2) * (number + 1.0) / (12.0 * (number - 1.0))
        } else {
            0.0
        };
        self.poses += weight;
        self.position[0] += poses * x;
        self.position[1] += poses * y;
        self.squares[0] += poses * (x * x + own);
        self.squares[1] += poses * y * y;
    }

    fn add_direction(&mut self, weight: u64, part: f64) {
        let first = *self.first_part.get_or_insert(part);
        let (sine, cosine) = libm::sincos((part - first) * std::f64::consts::TAU);
        self.cosine += float(weight) * cosine;
        self.sine += float(weight) * sine;
    }

    fn finish(self, angles: Option<(f64, Vec<u64>)>) -> Option<PoseEstimate> {
        let origin = self.origin?;
        let all = float(self.poses);
        let from_origin = self.position.map(|sum| sum / all);
        let standard_deviation = [0, 1].map(|axis| {
            let variance: f64 = self.squares[axis] / all - from_origin[axis] * from_origin[axis];
            variance.max(0.0).sqrt()
        });
        let angle = angles.map(|(period, degrees)| {
            let length = libm::hypot(self.cosine, self.sine) / all;
            let directed = length > 1e-9;
            let from_first = libm::atan2(self.sine, self.cosine) / std::f64::consts::TAU;
            let mean = self.first_part.unwrap_or_default() + from_first;
            let deviation =
                (-2.0 * libm::log(length.min(1.0))).max(0.0).sqrt() / std::f64::consts::TAU;
            AngleEstimate {
                period,
                mean: directed.then(|| within_period(mean * period, period)),
                standard_deviation: directed.then_some(deviation * period),
                shortest_arc: fewest(&degrees, self.poses),
            }
        });
        Some(PoseEstimate {
            poses: self.poses,
            position: [0, 1].map(|axis| origin[axis] + from_origin[axis]),
            standard_deviation,
            angle,
        })
    }
}

/// Reduces an angle to 0 up to below a period. For an angle just below 0, the remainder is rounded to the period
/// itself.
fn within_period(angle: f64, period: f64) -> f64 {
    let rest = angle.rem_euclid(period);
    if rest < period { rest } else { 0.0 }
}

/// Returns the fewest neighbours on a circle that hold 95 % of `all`: the first, and how many. Among equals, returns
/// the first.
fn fewest(degrees: &[u64], all: u64) -> (u32, u32) {
    let count = degrees.len();
    let needed = u128::from(all) * 95;
    let (mut best, mut end, mut held) = ((0, count), 0, 0_u128);
    for start in 0..count {
        while held * 100 < needed && end < start + count {
            held += u128::from(degrees[end % count]);
            end += 1;
        }
        if held * 100 >= needed && end - start < best.1 {
            best = (start, end - start);
        }
        held -= u128::from(degrees[start]);
    }
    (narrow(best.0), narrow(best.1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::ToTheEnd;
    use crate::recognition::model::ShapeCount;
    use crate::recognition::training::{GridSteps, Training, equal_figures};
    use crate::sensor::MatrixSize;

    #[test]
    fn the_poses_of_an_imprint_agree_with_its_count_and_with_a_sum_by_hand() {
        let steps = GridSteps::of(10, "0:355:5");
        let training = Training::fitting(equal_figures(), steps).expect("they fit");
        let grids = training.grids.clone();
        let model = training.run().expect("not stopped");
        for shape in [0, 1, 2, 5] {
            let grid = &grids[shape];
            let mut plane = Plane::new(*grid.sensor());
            let imprint = plane.touch(&grid.placed(4321));
            let key = ImprintKey::of(&imprint);
            let estimate = model.pose_of(shape, &imprint, &ToTheEnd).expect("it does");
            let bounds = imprint.bounds().expect("not empty");
            let (mut poses, mut x, mut square) = (0_u32, 0.0, 0.0);
            for number in 0..grid.poses() {
                let pose = grid.pose(number);
                let other = plane.touch(&grid.placed(number));
                if ImprintKey::of(&other) == key {
                    let there = other.bounds().expect("not empty");
                    let at = pose[Axis::X0] + f64::from(bounds.left) - f64::from(there.left);
                    poses += 1;
                    x += at;
                    square += at * at;
                }
            }
            let mean = x / f64::from(poses);
            let spread = (square / f64::from(poses) - mean * mean).max(0.0).sqrt();
            assert_eq!(estimate.poses, u64::from(poses));
            let own = model.counts_of(&imprint).iter();
            let own = own.filter(|count| usize::from(count.shape) == shape);
            assert_eq!(own.map(|count| count.poses).sum::<u64>(), estimate.poses);
            assert!((estimate.position[0] - mean).abs() < 1e-9);
            assert!((estimate.standard_deviation[0] - spread).abs() < 1e-6);
            assert_eq!(
                estimate.angle.is_none(),
                shape == 0,
                "only a disc has no angle"
            );
        }
        assert_eq!(
            model.pose_of(7, &Imprint::empty(MatrixSize::of(4, 4)), &ToTheEnd),
            None
        );
    }

    /// A grid of half cells and 15° holds few imprints; finer poses leave what it does not hold.
    #[test]
    fn an_imprint_between_the_poses_of_the_model_has_a_pose() {
        let training = |steps| Training::fitting(equal_figures(), steps).expect("they fit");
        let grid = training(GridSteps::of(20, "0:359:1")).grids[1].clone();
        let model = training(GridSteps::of(2, "0:345:15"))
            .run()
            .expect("not stopped");
        let fine = training(GridSteps::of(20, "0:359:1"))
            .run()
            .expect("not stopped");
        let mut plane = Plane::new(*grid.sensor());
        let (mut between, mut pose) = (0, 4321);
        while between < 5 {
            pose += 991;
            let imprint = plane.touch(&grid.placed(pose));
            if model.counts_of(&imprint).iter().any(|own| own.shape == 1) {
                continue;
            }
            between += 1;
            let [estimate, expected] = [&model, &fine].map(|model| {
                let pose = model.pose_of(1, &imprint, &ToTheEnd);
                pose.expect("a fine pose leaves it")
            });
            assert_eq!(estimate.poses, expected.poses);
            assert!((estimate.position[0] - expected.position[0]).abs() < 1e-9);
        }
    }

    #[test]
    fn a_shard_counts_its_own_poses_only() {
        let steps = GridSteps::of(4, "0:330:30");
        let training = Training::fitting(equal_figures(), steps).expect("they fit");
        let grid = training.grids[1].clone();
        let imprint = Plane::new(*grid.sensor()).touch(&grid.placed(21));
        let poses = |model: &Model| {
            let held: u64 = model.counts_of(&imprint).iter().map(own_poses).sum();
            let estimate = model.pose_of(1, &imprint, &ToTheEnd);
            assert_eq!(estimate.map_or(0, |estimate| estimate.poses), held);
            held
        };
        let shards = [1, 2, 3].map(|number| {
            let shard = Shard::new(number, 3).expect("one of three");
            poses(
                &training
                    .clone()
                    .with_shard(shard)
                    .run()
                    .expect("not stopped"),
            )
        });
        let whole = poses(&training.run().expect("not stopped"));
        assert_eq!(shards.iter().sum::<u64>(), whole);
        assert!(shards.iter().all(|&poses| poses < whole), "{shards:?}");
    }

    fn own_poses(count: &ShapeCount) -> u64 {
        if count.shape == 1 { count.poses } else { 0 }
    }

    /// Angles at which a heptagon looks alike count as one.
    #[test]
    fn a_heptagon_repeats_every_seventh_of_a_turn() {
        let steps = GridSteps::of(4, "0:359:1");
        let mut shapes = equal_figures();
        shapes.retain(|shape| shape.name == "heptagon");
        let training = Training::fitting(shapes, steps).expect("it fits");
        let grid = training.grids[0].clone();
        let model = training.run().expect("not stopped");
        let imprint = Plane::new(*grid.sensor()).touch(&grid.placed(21));
        let pose = model.pose_of(0, &imprint, &ToTheEnd).expect("it leaves it");
        let angle = pose.angle.expect("it has one");
        assert!((angle.period - 360.0 / 7.0).abs() < 1e-12, "{angle:?}");
        assert!(angle.shortest_arc.1 <= 52, "{angle:?}");
        let (mean, spread) = angle.known().expect("one of few");
        assert!((-26.0..52.0).contains(&mean) && spread < 15.0, "{angle:?}");
    }

    #[test]
    fn degrees_that_pass_the_period_begin_below_0_and_hold_the_mean() {
        let estimate = |period, mean, spread, shortest_arc| AngleEstimate {
            period,
            mean: Some(mean),
            standard_deviation: Some(spread),
            shortest_arc,
        };
        let over = estimate(120.0, 119.0, 5.0, (109, 23));
        assert_eq!((over.ends(), over.known()), ((-11, 11), Some((-1.0, 5.0))));
        let within = estimate(120.0, 17.0, 0.5, (16, 3));
        assert_eq!(
            (within.ends(), within.known()),
            ((16, 18), Some((17.0, 0.5)))
        );
        let all = estimate(360.0, 180.0, 140.8, (0, 310));
        assert_eq!((all.ends(), all.known()), ((0, 309), None));
    }

    #[test]
    fn poses_in_one_place_have_no_spread_and_angles_are_below_the_period() {
        let mut sums = PoseMoments::default();
        for x in [53.6, 53.6, 53.6] {
            sums.add(7, (x, x), 1, 50.2);
        }
        let estimate = sums.finish(None).expect("poses");
        assert_eq!(estimate.position, [53.6, 50.2]);
        assert_eq!(estimate.standard_deviation, [0.0, 0.0]);
        // The sine of 0.875 of a turn is rounded, so sums of it are, too.
        let mut sums = PoseMoments::default();
        for weight in [7, 1, 3] {
            sums.add(weight, (1.0, 1.0), 1, 1.0);
            sums.add_direction(weight, 0.875);
        }
        let estimate = sums.finish(Some((120.0, vec![0; 120]))).expect("poses");
        let angle = estimate.angle.expect("an angle");
        assert_eq!(
            (angle.mean, angle.standard_deviation),
            (Some(105.0), Some(0.0))
        );
        assert_eq!(within_period(-1e-17, 45.0), 0.0);
        assert_eq!(within_period(50.0, 45.0), 5.0);
    }

    #[test]
    fn the_fewest_degrees_may_pass_the_end_of_the_circle() {
        assert_eq!(fewest(&[10, 0, 0, 0, 0, 9, 1], 20), (5, 3));
        assert_eq!(fewest(&[0, 0, 4], 4), (2, 1));
        assert_eq!(fewest(&[1, 1, 1, 1], 4), (0, 4));
    }
}
