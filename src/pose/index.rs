//! Poses by their places along the ranges of a grid, and as shapes that can be touched by themselves.

use crate::parameter::{Parameter, ParameterError};
use crate::pose::grid::{Anchor, Pose, PoseGrid, PoseIndex, centre};
use crate::sensor::Sensor;
use crate::source::Source;

impl PoseGrid {
    /// The number of the pose at a place; of a place beyond the grid, that of the nearest one in it.
    pub fn number(&self, place: PoseIndex) -> u64 {
        let values = place.into_iter().zip(self.counts());
        values.rev().fold(0, |number, (index, count)| {
            number * count + index.min(count - 1)
        })
    }

    /// So many values of each range from a place on, as a grid of their own; none where it would leave this one.
    pub fn part(&self, from: PoseIndex, counts: PoseIndex) -> Option<Self> {
        let mut ranges = *self.ranges();
        let all = [
            &mut ranges.x0,
            &mut ranges.y0,
            &mut ranges.angle,
            &mut ranges.zoom_x,
            &mut ranges.zoom_y,
        ];
        for ((range, from), count) in all.into_iter().zip(from).zip(counts) {
            *range = range.part(from..from.checked_add(count)?)?;
        }
        Self::new(self.source().clone(), *self.sensor(), self.anchor(), ranges).ok()
    }

    /// The shape of a pose with its corner where that has it, whatever the anchor: what forms and files can say. With
    /// the anchor at the centre the corner is given to nine decimals, and may leave other taxels where one is covered
    /// just at the threshold.
    ///
    /// # Errors
    /// Where the corner lies outside of what a shape's corner may be.
    ///
    /// ```
    /// use taxel::prelude::*;
    /// // 6 × 3, its centre at 5, 5.
    /// let rectangle = Source::Figure(Figure::default_of(FigureKind::Rectangle, &Sensor::default()));
    /// let grid = PoseGrid::new(rectangle, Sensor::default(), Anchor::Centre, Ranges::default())?;
    /// let first = grid.source_at(grid.pose(0))?;
    /// assert_eq!((first.get(Parameter::X0), first.get(Parameter::Y0)), (Some(2.0), Some(3.5)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn source_at(&self, pose: Pose) -> Result<Source, ParameterError> {
        // Only pictures have zooms.
        let own = self.source().parameters();
        let with = |source: Source, values: &[(Parameter, f64)]| {
            values
                .iter()
                .filter(|(parameter, _)| own.contains(parameter))
                .try_fold(source, |source, &(parameter, value)| {
                    source.with(parameter, value, self.sensor())
                })
        };
        let zooms = [
            (Parameter::ZoomX, pose.zoom_x),
            (Parameter::ZoomY, pose.zoom_y),
        ];
        let zoomed = with(self.source().clone(), &zooms)?;
        let (x0, y0) = match self.anchor() {
            Anchor::Corner => (pose.x0, pose.y0),
            Anchor::Centre => {
                let upright = [Parameter::X0, Parameter::Y0, Parameter::Angle];
                let upright = with(zoomed.clone(), &upright.map(|parameter| (parameter, 0.0)))?;
                let centre = centre::<f64>(&upright);
                let zoom = |parameter| zoomed.get(parameter).unwrap_or(1.0);
                (
                    tidy((pose.x0 - centre.x) / zoom(Parameter::ZoomX)),
                    tidy((pose.y0 - centre.y) / zoom(Parameter::ZoomY)),
                )
            }
        };
        let place = [
            (Parameter::X0, x0),
            (Parameter::Y0, y0),
            (Parameter::Angle, pose.angle),
        ];
        with(zoomed, &place)
    }

    /// Whether this is a grid of that shape on that sensor, wherever the shape itself is.
    pub fn is_of(&self, source: &Source, sensor: &Sensor) -> bool {
        let own = self.sensor();
        let same_sensor = (own.columns(), own.rows(), own.threshold())
            == (sensor.columns(), sensor.rows(), sensor.threshold());
        // Both in the same pose: what is left to differ is the shape.
        let posed = |source: &Source| {
            let rows = self.ranges().by_parameter();
            let mut values = rows
                .iter()
                .map(|(parameter, _)| *parameter)
                .filter(|parameter| source.parameters().contains(parameter));
            values.try_fold(source.clone(), |source, parameter| {
                source.with(parameter, own.default_value(parameter), own)
            })
        };
        same_sensor
            && matches!((posed(self.source()), posed(source)), (Ok(one), Ok(other)) if one == other)
    }
}

/// Without the noise of the last digits; never a negative zero.
fn tidy(value: f64) -> f64 {
    (value * 1e9).round() / 1e9 + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Figure, FigureKind};
    use crate::imprint::Imprint;
    use crate::picture::Picture;
    use crate::pose::grid::Ranges;
    use crate::touch::Plane;

    fn grid(source: Source, anchor: Anchor) -> PoseGrid {
        let range = |text: &str| text.parse().expect("a range");
        let zoomed = source.kind().is_none();
        let zoom = if zoomed { "0.5:1.5:0.25" } else { "1" };
        let ranges = Ranges {
            // No place where a cell is covered just by half.
            x0: range("5.013:5.913:0.3"),
            y0: range("6.007:6.507:0.1"),
            angle: range("0:350:50"),
            zoom_x: range(zoom),
            zoom_y: range(zoom),
        };
        PoseGrid::new(source, Sensor::default(), anchor, ranges).expect("in range")
    }

    fn picture() -> Source {
        let imprint = Imprint::from_rows([".##.", ".#..", "####"]).expect("rows");
        Source::Picture(Picture::at_home(imprint))
    }

    #[test]
    fn numbers_and_places_are_the_same_poses() {
        let grid = grid(picture(), Anchor::Corner);
        assert_eq!(grid.counts(), [4, 6, 8, 5, 5]);
        for number in [0, 1, 4, 23, 24, 191, 192, 4000, grid.poses() - 1] {
            let place = grid.place(number);
            assert_eq!(grid.number(place), number);
            let [x0, _, angle, ..] = place;
            let pose = grid.pose(number);
            assert_eq!(pose.x0, grid.ranges().x0.value(x0));
            assert_eq!(pose.angle, grid.ranges().angle.value(angle));
        }
        assert_eq!(grid.number([u64::MAX; 5]), grid.poses() - 1);
    }

    #[test]
    fn a_part_has_the_poses_of_the_whole() {
        let whole = grid(picture(), Anchor::Corner);
        let part = whole.part([1, 2, 3, 4, 0], [2, 3, 1, 1, 2]);
        let part = part.expect("it lies inside");
        assert_eq!(part.poses(), 12);
        for number in 0..part.poses() {
            let [x, y, angle, zoom_x, zoom_y] = part.place(number);
            let inside = whole.number([x + 1, y + 2, angle + 3, zoom_x + 4, zoom_y]);
            assert_eq!(part.pose(number), whole.pose(inside));
        }
        assert_eq!(whole.part([3, 0, 0, 0, 0], [2, 1, 1, 1, 1]), None);
        assert_eq!(whole.part([0; 5], [0, 1, 1, 1, 1]), None);
        assert_eq!(whole.part([u64::MAX; 5], [1; 5]), None);
    }

    /// Wherever the anchor is, the shape by itself leaves the imprint of its pose.
    #[test]
    fn a_pose_can_be_touched_by_itself() {
        let triangle = Source::Figure(Figure::default_of(FigureKind::Triangle, &Sensor::default()));
        for (source, anchor) in [
            (triangle.clone(), Anchor::Corner),
            (triangle, Anchor::Centre),
            (picture(), Anchor::Corner),
            (picture(), Anchor::Centre),
        ] {
            let grid = grid(source, anchor);
            let mut plane = Plane::new(*grid.sensor());
            for number in (0..grid.poses()).step_by(7) {
                let pose = grid.pose(number);
                let source = grid.source_at(pose).expect("inside of the sensor");
                let expected = plane.touch(&grid.placed(pose));
                assert_eq!(plane.touch(&source), expected, "{anchor:?} {pose:?}");
                assert!(grid.is_of(&source, grid.sensor()));
            }
        }
    }

    #[test]
    fn another_shape_is_none_of_the_grid() {
        let sensor = Sensor::default();
        let hexagon = Figure::default_of(FigureKind::Hexagon, &Sensor::default());
        let grid = grid(Source::Figure(hexagon), Anchor::Corner);
        let with = |parameter, value| {
            Source::Figure(hexagon.with(parameter, value, &sensor).expect("in range"))
        };
        assert!(grid.is_of(&with(Parameter::X0, 1.5), &sensor));
        assert!(grid.is_of(&with(Parameter::Angle, 77.0), &sensor));
        assert!(!grid.is_of(&with(Parameter::Side, 1.5), &sensor));
        assert!(!grid.is_of(&with(Parameter::Thickness, 1.0), &sensor));
        assert!(!grid.is_of(&picture(), &sensor));
        let octagon = Source::Figure(Figure::default_of(FigureKind::Octagon, &Sensor::default()));
        assert!(!grid.is_of(&octagon, &sensor));
        let coarse = sensor.with(Parameter::Threshold, 0.7).expect("in range");
        assert!(!grid.is_of(grid.source(), &coarse));
        let pitch = sensor.with(Parameter::Pitch, 2.5).expect("in range");
        assert!(
            grid.is_of(grid.source(), &pitch),
            "the imprints are the same"
        );
    }
}
