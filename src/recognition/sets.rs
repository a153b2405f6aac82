//! Sets of shapes that are at hand, and the grid of poses that suits a set.

use crate::figure::{Figure, FigureKind};
use crate::parameter::Parameter;
use crate::pose::{Anchor, Axis, DecimalRange, GivenRanges, Ranges, smallest_sensor};
use crate::recognition::model::NamedShape;
use crate::recognition::training::{Training, TrainingError};
use crate::sensor::Sensor;
use crate::source::Source;

/// Returns the seven figures at the sizes that forms propose. They cover 7 to 77 cells, so that a touch tells them
/// apart by their size already.
pub fn default_figures() -> Vec<NamedShape> {
    let sensor = Sensor::default();
    let figure = |kind: FigureKind| NamedShape::new(kind.name(), Figure::default_of(kind, &sensor));
    FigureKind::ALL.map(figure).to_vec()
}

/// Sizes at which each of the seven figures covers about 30 cells.
const EQUAL: [(FigureKind, &[(Parameter, f64)]); 7] = [
    (
        FigureKind::Ellipse,
        &[(Parameter::RadiusX, 3.09), (Parameter::RadiusY, 3.09)],
    ),
    (
        FigureKind::Rectangle,
        &[(Parameter::Length, 6.0), (Parameter::Width, 5.0)],
    ),
    (FigureKind::Triangle, &[(Parameter::Side, 8.32)]),
    (FigureKind::Pentagon, &[(Parameter::Side, 4.18)]),
    (FigureKind::Hexagon, &[(Parameter::Side, 3.4)]),
    (FigureKind::Heptagon, &[(Parameter::Side, 2.87)]),
    (FigureKind::Octagon, &[(Parameter::Side, 2.49)]),
];

/// Returns the seven figures, each of about 30 cells: only their form tells them apart.
pub fn equal_figures() -> Vec<NamedShape> {
    let sensor = Sensor::default();
    let shape = |(kind, sizes): (FigureKind, &[(Parameter, f64)])| {
        let mut sizes = sizes.iter();
        let default = Figure::default_of(kind, &sensor);
        let figure = sizes.try_fold(default, |figure, &(parameter, value)| {
            figure.with(parameter, value, &sensor)
        });
        Some(NamedShape::new(kind.name(), figure.ok()?))
    };
    EQUAL.into_iter().filter_map(shape).collect()
}

/// The steps of a grid of poses: one cell of positions, all angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridSteps {
    /// Steps of a cell in each direction; a divisor of 100.
    pub positions: u8,
    /// Degrees from one angle to the next; a divisor of 360.
    pub degrees: u16,
}

impl GridSteps {
    /// Hundredths of a cell and whole degrees, as a sweep has.
    pub const FINE: Self = Self {
        positions: 100,
        degrees: 1,
    };
}

impl GridSteps {
    /// Returns the same cell of positions, as a range of hundredths begins, in these steps.
    pub fn cell(self, fine: &DecimalRange) -> DecimalRange {
        let hundredths = 100 / u32::from(self.positions.clamp(1, 100));
        let (first, step) = (fine.value(0), f64::from(hundredths) / 100.0);
        let text = format!("{first:.2}:{:.2}:{step:.2}", first + 1.0 - step);
        text.parse().unwrap_or(*fine)
    }
}

impl Training<'_> {
    /// A training on the smallest square sensor, at least 16 × 16, that cuts off none of the shapes in any of the poses:
    /// one cell of positions around its middle, all angles.
    ///
    /// # Errors
    /// [`TrainingError::Large`] if no sensor is large enough, and those of [`Training::new`].
    pub fn fitting(shapes: Vec<NamedShape>, steps: GridSteps) -> Result<Self, TrainingError> {
        let angles = format!("0:{}:{}", 360 - steps.degrees.clamp(1, 360), steps.degrees);
        let mut given = GivenRanges::default();
        given[Axis::Angle] = angles.parse().ok();
        let sources: Vec<&Source> = shapes.iter().map(|shape| &shape.source).collect();
        let fit = smallest_sensor(sources, Anchor::Centre, &given, 16);
        let fit = fit.map_err(|error| TrainingError::Grid {
            name: "the set".to_owned(),
            error,
        })?;
        let (sensor, fine) = fit.ok_or(TrainingError::Large)?;
        Self::new(shapes, sensor, Anchor::Centre, coarser(&fine, steps))
    }
}

/// The same cell of positions in other steps.
fn coarser(fine: &Ranges, steps: GridSteps) -> Ranges {
    let mut ranges = *fine;
    for axis in [Axis::X0, Axis::Y0] {
        ranges[axis] = steps.cell(&fine[axis]);
    }
    ranges
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::Evaluation;

    #[test]
    fn equal_figures_cover_thirty_cells_and_are_hard_to_tell_apart() {
        let steps = GridSteps {
            positions: 10,
            degrees: 5,
        };
        // All of the sizes are in range, so none is left out.
        assert_eq!(equal_figures().len(), FigureKind::ALL.len());
        let training = Training::fitting(equal_figures(), steps).expect("they fit");
        let grid = &training.grids()[0];
        assert_eq!(grid.sensor().columns(), 16);
        assert_eq!(grid.ranges()[Axis::X0].to_string(), "7:7.9:0.1");
        assert_eq!(grid.ranges()[Axis::Angle].to_string(), "0:355:5");
        let model = training.run().expect("not stopped");
        assert_eq!((model.poses(), model.cut()), (7200, &[0; 7][..]));
        let error = Evaluation::of(&model).error();
        assert!((0.3..0.35).contains(&error), "{error}");
        for shape in model.shapes() {
            let grid = Training::fitting(vec![shape.clone()], steps).expect("it fits");
            let grid = &grid.grids()[0];
            let mut plane = crate::touch::Plane::new(*grid.sensor());
            plane.touch(&grid.placed(grid.pose(0)));
            let area: f64 = plane.coverages().iter().sum();
            assert!((area - 30.0).abs() < 0.2, "{}: {area}", shape.name);
        }
    }

    #[test]
    fn figures_of_default_sizes_are_told_apart_by_any_touch() {
        let steps = GridSteps {
            positions: 20,
            degrees: 3,
        };
        let training = Training::fitting(default_figures(), steps).expect("they fit");
        let model = training.run().expect("not stopped");
        assert_eq!(Evaluation::of(&model).error(), 0.0);
    }
}
