use std::collections::HashSet;

use crate::pose::{AngleClasses, Axis, PoseGrid, PoseIndex};

/// The number of poses that are enough to measure.
const POSES: u64 = 20_000;

/// A part of a grid, and how much larger the whole is.
#[derive(Clone, Debug)]
pub struct TimingSample {
    /// The part: neighbouring poses at one angle and one pair of zooms, from the middle of their ranges.
    pub grid: PoseGrid,
    /// The number of poses of the whole grid, as a multiple of those of the part. Only angles at which the shape looks
    /// different count. The time of the whole grid is less than this multiple of the part's time: mirror images are
    /// swept together, and known imprints are not described again.
    pub factor: f64,
}

impl TimingSample {
    /// Returns the sample of a grid.
    #[expect(clippy::cast_precision_loss, reason = "an estimate")]
    pub fn of(grid: &PoseGrid) -> Self {
        let [width, height, angles, zooms_x, zooms_y] = grid.counts().into_array();
        let width = width.min(POSES);
        let height = height.min(POSES / width).max(1);
        let middle = PoseIndex::new([0, 0, angles / 2, zooms_x / 2, zooms_y / 2]);
        let part = grid.part(middle, PoseIndex::new([width, height, 1, 1, 1]));
        let part = part.unwrap_or_else(|| grid.clone());
        let distinct = distinct_angles(grid) as f64 / angles as f64;
        Self {
            factor: grid.poses() as f64 * distinct / part.poses() as f64,
            grid: part,
        }
    }
}

/// Returns the number of angles at which the shape looks different.
fn distinct_angles(grid: &PoseGrid) -> u64 {
    let angles = grid.ranges()[Axis::Angle];
    let classes = AngleClasses::of(grid.source(), angles);
    let distinct: HashSet<i128> = (0..angles.count())
        .map(|index| classes.class(index))
        .collect();
    distinct.len() as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Figure, FigureKind};
    use crate::pose::{Anchor, Axis, Ranges};
    use crate::sensor::Sensor;
    use crate::source::Source;

    fn sample(kind: FigureKind, ranges: Ranges) -> (u64, f64) {
        let source = Source::Figure(Figure::default_of(kind, &Sensor::default()));
        let grid = PoseGrid::new(source, Sensor::default(), Anchor::Corner, ranges);
        let sample = TimingSample::of(&grid.expect("in range"));
        (sample.grid.poses(), sample.factor)
    }

    #[test]
    fn a_sample_is_small_and_symmetries_count() {
        let default = Ranges::default();
        assert_eq!(sample(FigureKind::Heptagon, default), (10_000, 360.0));
        assert_eq!(sample(FigureKind::Octagon, default), (10_000, 45.0));
        // The default ellipse is a circle.
        assert_eq!(sample(FigureKind::Ellipse, default), (10_000, 1.0));
        let range = |text: &str| text.parse().expect("a range");
        let long = default
            .with(Axis::X0, range("0:10:0.001"))
            .with(Axis::Y0, range("0:10:0.001"));
        let (poses, times) = sample(FigureKind::Heptagon, long);
        assert_eq!((poses, times), (10_001, 360.0 * 10_001.0));
        let single = default
            .with(Axis::X0, range("5"))
            .with(Axis::Y0, range("5"))
            .with(Axis::Angle, range("0"));
        assert_eq!(sample(FigureKind::Triangle, single), (1, 1.0));
    }
}
