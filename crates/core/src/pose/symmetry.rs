//! The symmetries of shapes: the angles at which a shape looks the same, or like its mirror image.
//!
//! (x0, y0) locates the corner of a figure *before* rotation, so its centre stays where it is under rotation. Two
//! angles show the same shape if they differ by a symmetry of the figure: 180° for rectangles and ellipses, 90° for
//! squares, 360°/n for regular polygons if that is a whole number of degrees (not for the heptagon), and any angle for
//! circles. A picture has 180° if a half turn maps it onto itself; in sweeps, this is so even if a quarter turn does,
//! since its zooms may differ. Angles are compared as exact decimals.
//!
//! Upright figures are left-right symmetric. So a figure at minus an angle is the mirror image of itself at that angle,
//! about the vertical line through its centre. The same holds for some pictures. Others are top-bottom symmetric: their
//! mirror image is at 180° minus the angle.

use crate::pose::axis::{Axis, Ranges};
use crate::pose::range::{DecimalRange, ONE};
use crate::source::Source;

/// Returns the smallest rotation in whole degrees after which a shape looks the same under any zooms (360 for a
/// heptagon); None if it looks the same at every angle.
pub(crate) fn period(source: &Source) -> Option<u32> {
    let rotations = source.rotations(false)?;
    Some(if 360 % rotations == 0 {
        360 / rotations
    } else {
        360
    })
}

/// Returns the smallest rotation in degrees after which a shape in the poses of a grid looks the same: 360/7 for a
/// heptagon, and 90 for a picture that a quarter turn maps onto itself, if both zooms have the same single value. None
/// if it looks the same at every angle.
pub(crate) fn exact_period(source: &Source, ranges: &Ranges) -> Option<f64> {
    let zooms = [ranges[Axis::ZoomX], ranges[Axis::ZoomY]];
    let one_zoom = zooms[0] == zooms[1] && zooms[0].count() == 1;
    Some(360.0 / f64::from(source.rotations(one_zoom)?))
}

/// The angles of a range, in classes. The angles of a class show the same shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AngleClasses {
    angles: DecimalRange,
    period: Option<u32>,
    mirror: Option<u32>,
}

impl AngleClasses {
    pub(crate) fn of(source: &Source, angles: DecimalRange) -> Self {
        Self {
            angles,
            period: period(source),
            mirror: source.mirror(),
        }
    }

    /// Returns the class of an angle: the angle modulo the period, exactly.
    pub(crate) fn class(&self, index: u64) -> i128 {
        let [start, step] = self.angles.exact();
        self.period.map_or(0, |period| {
            (start + i128::from(index) * step).rem_euclid(i128::from(period) * ONE)
        })
    }

    /// Returns the class that shows the mirror image of a class, with right and left exchanged; None if there is none,
    /// or if it is the class itself.
    pub(crate) fn mirrored(&self, class: i128) -> Option<i128> {
        let (mirror, period) = (i128::from(self.mirror?), i128::from(self.period?));
        let image = (mirror * ONE - class).rem_euclid(period * ONE);
        (image != class).then_some(image)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Figure, FigureKind};
    use crate::picture::Picture;
    use crate::sensor::Sensor;

    fn classes(source: &Source, angles: &str) -> AngleClasses {
        AngleClasses::of(source, angles.parse().expect("a range"))
    }

    /// Returns the index of the angle that shows the mirror image of angle `index`.
    fn image(source: &Source, angles: &str, index: u64) -> Option<u64> {
        let classes = classes(source, angles);
        let image = classes.mirrored(classes.class(index))?;
        (0..classes.angles.count()).find(|&other| classes.class(other) == image)
    }

    #[test]
    fn figures_mirror_each_other_at_opposite_angles() {
        let figure = |kind| Source::Figure(Figure::default_of(kind, &Sensor::default()));
        let heptagon = figure(FigureKind::Heptagon);
        assert_eq!(image(&heptagon, "0:359:1", 1), Some(359));
        assert_eq!(image(&heptagon, "0:359:1", 180), None);
        assert_eq!(image(&heptagon, "-0.5:0.5:0.25", 0), Some(4));
        assert_eq!(image(&heptagon, "1:10:1", 4), None);
        let hexagon = figure(FigureKind::Hexagon);
        assert_eq!(image(&hexagon, "0:359:1", 1), Some(59));
        assert_eq!(image(&hexagon, "0:359:1", 30), None);
        // The default ellipse is a circle, whose angles are all one class.
        assert_eq!(image(&figure(FigureKind::Ellipse), "0:359:1", 7), None);
    }

    #[test]
    fn symmetric_pictures_mirror_each_other() {
        let picture = |rows: &str| {
            let rows = rows.parse().expect("rows");
            Source::Picture(Picture::at_home(rows))
        };
        assert_eq!(image(&picture(".#.\n###"), "0:359:1", 90), Some(270));
        assert_eq!(image(&picture(".#\n##\n.#"), "0:359:1", 60), Some(120));
        assert_eq!(image(&picture("##\n.#\n.#"), "0:359:1", 60), None);
        assert_eq!(image(&picture("..\n.."), "0:359:1", 60), None);
    }

    #[test]
    fn a_quarter_turn_is_a_symmetry_only_if_both_zooms_are_always_equal() {
        let rows = ".#.\n###\n.#.".parse().expect("rows");
        let plus = Source::Picture(Picture::at_home(rows));
        let period = |zoom_x: &str, zoom_y: &str| {
            let zoom = |text: &str| text.parse().expect("a range");
            let ranges = Ranges::default().with(Axis::ZoomX, zoom(zoom_x));
            exact_period(&plus, &ranges.with(Axis::ZoomY, zoom(zoom_y)))
        };
        assert_eq!(period("2", "2"), Some(90.0));
        assert_eq!(period("2", "1"), Some(180.0));
        // With two values for each zoom, the zooms differ in some poses.
        assert_eq!(period("1:2:1", "1:2:1"), Some(180.0));
    }
}
