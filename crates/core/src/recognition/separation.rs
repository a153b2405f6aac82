//! Shows which sensor tells a set of shapes apart: the limit of one touch as a function of the size of the shapes in
//! cells, and of the threshold.

use crate::figure::Figure;
use crate::parameter::number::to_decimals;
use crate::parameter::{Parameter, ParameterError, named};
use crate::pose::{Anchor, Axis, DecimalRange, GivenRanges, GridError, PoseGrid, Ranges, Reach};
use crate::progress::Progress;
use crate::recognition::evaluation::Evaluation;
use crate::recognition::model::{NamedShape, check_shapes};
use crate::recognition::training::{
    GridSteps, LEAST_SIDE, Training, TrainingError, angles_only, fit,
};
use crate::sensor::Sensor;
use crate::source::Source;

const FINER: u8 = 10;

/// The quantity that is varied to change the size of the shapes in cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SizeAxis {
    /// Sizes are in cells; a value multiplies them. A scale of 2 makes every length of every shape twice as long in
    /// cells, as a sensor with half the pitch does.
    Scale,
    /// Sizes are in mm; a value is the pitch of a sensor in mm, so the scale is 1 divided by it.
    Pitch,
}

impl SizeAxis {
    /// Returns the values of a range, from the smallest size to the largest. Pitches are reversed: the largest pitch
    /// gives the smallest size.
    pub fn smallest_first(self, values: &DecimalRange) -> Vec<f64> {
        let mut values: Vec<f64> = values.values().collect();
        if self == Self::Pitch {
            values.reverse();
        }
        values
    }

    /// Returns the scale for a value above 0.
    pub fn scale(self, value: f64) -> f64 {
        match self {
            Self::Scale => value,
            Self::Pitch => 1.0 / value,
        }
    }
}

named!(SizeAxis, "axis", [Scale "scale", Pitch "pitch_mm"]);

/// A set of shapes whose limit is computed at several sizes and thresholds.
///
/// As in a training, each shape is touched with its centre in one cell and at the given angles, on a sensor that cuts
/// nothing off.
#[derive(Clone, Debug)]
pub struct Separation {
    shapes: Vec<NamedShape>,
    /// The positions and angles; [`GridSteps::FINE`] unless they are set.
    pub steps: GridSteps,
}

/// The limit of one touch for one size and one threshold.
#[derive(Clone, Debug, PartialEq)]
pub struct SeparationPoint {
    /// The value on the axis: a scale, or a pitch in mm.
    pub value: f64,
    /// Cells per unit of the given sizes.
    pub scale: f64,
    /// The threshold of the sensor.
    pub threshold: f64,
    /// The side of the smallest square sensor, at least 16, that cuts nothing off.
    pub side: u8,
    /// The limit.
    pub limit: Evaluation,
}

/// The smallest size that reaches a wanted error, among those that a search has tried.
#[derive(Clone, Debug, PartialEq)]
pub struct SmallestSize {
    /// The point that was found.
    pub point: SeparationPoint,
    /// The step of the search there. 0 if the first value of the scan reaches the error: smaller ones were not tried.
    pub step: f64,
    /// The number of larger sizes of the scan that miss the error again.
    pub missed_again: usize,
}

impl Separation {
    /// Creates a set with positions in hundredths of a cell and whole degrees, as models are trained.
    ///
    /// # Errors
    /// Returns [`TrainingError::Set`] for an invalid set.
    pub fn new(shapes: Vec<NamedShape>) -> Result<Self, TrainingError> {
        check_shapes(&shapes)?;
        Ok(Self {
            shapes,
            steps: GridSteps::FINE,
        })
    }

    /// Returns the number of touches of one point, for reports of progress.
    pub fn touches(&self) -> u64 {
        let cell = u64::from(self.steps.positions.get()).pow(2);
        cell * self.steps.angles.count() * self.shapes.len() as u64
    }

    /// Returns the training for a scale and a threshold.
    ///
    /// # Errors
    /// Returns [`TrainingError::Large`] for shapes that do not fit on the largest sensor, or [`TrainingError::Grid`]
    /// for values out of range.
    pub fn training(&self, scale: f64, threshold: f64) -> Result<Training<'static>, TrainingError> {
        let (mut scaled, mut zooms) = (Vec::new(), Vec::new());
        let mut reach = Reach::default();
        for shape in &self.shapes {
            let (shape, given) = self.scaled(shape, scale)?;
            let own = Reach::of(&shape.source, Anchor::Centre, &given);
            reach.add(own.map_err(|error| TrainingError::grid(&shape.name, error))?);
            scaled.push(shape);
            zooms.push(given);
        }
        let sources: Vec<&Source> = scaled.iter().map(|shape| &shape.source).collect();
        let (sensor, ranges) = fit(&reach, &sources, self.steps, LEAST_SIDE)?;
        let grid = |(shape, zooms): (&NamedShape, &GivenRanges)| {
            let sensor = sensor.with(Parameter::Threshold, threshold);
            let sensor = sensor.map_err(|error| TrainingError::grid(&shape.name, error))?;
            let ranges = Ranges::from_fn(|axis| zooms[axis].unwrap_or(ranges[axis]));
            let grid = PoseGrid::new(shape.source.clone(), sensor, Anchor::Centre, ranges);
            grid.map_err(|error| TrainingError::grid(&shape.name, error))
        };
        let grids = scaled.iter().zip(&zooms).map(grid);
        let grids = grids.collect::<Result<_, _>>()?;
        Ok(Training::of_grids(scaled, grids))
    }

    /// Multiplies every length of a shape; a picture or an outline is zoomed instead; an outline in
    /// mm is put at another pitch. Returns the shape with its angles and zooms.
    fn scaled(
        &self,
        shape: &NamedShape,
        scale: f64,
    ) -> Result<(NamedShape, GivenRanges), TrainingError> {
        let refused = |error: GridError| TrainingError::grid(&shape.name, error);
        let mut given = angles_only(self.steps.angles);
        let mut scaled = shape.clone();
        if let Source::Figure(figure) = &shape.source {
            let figure = enlarged(figure, scale).ok_or(TrainingError::Large)?;
            scaled.source = figure.map_err(|error| refused(error.into()))?.into();
            return Ok((scaled, given));
        }
        let mut scale = scale;
        if let Source::Outline(outline) = &shape.source
            && let Some(pitch) = outline.pitch_mm()
        {
            // In mm, a scale is another pitch, which a zoom of nine decimals would only come near.
            let pitch = Some(to_decimals(pitch / scale, 9)).filter(|&own| own > 0.0);
            let finer = pitch.and_then(|own| outline.clone().at_pitch(own).ok());
            scaled.source = finer.ok_or(TrainingError::Large)?.into();
            scale = 1.0;
        }
        for axis in [Axis::ZoomX, Axis::ZoomY] {
            let zoom = shape.source.get(axis.parameter()).unwrap_or(1.0) * scale;
            // The zoom that makes one taxel as large as the largest sensor.
            if zoom > f64::from(Sensor::LARGEST.side()) {
                return Err(TrainingError::Large);
            }
            // If the zoom is out of range, the error names it.
            let zoom = Sensor::LARGEST.check(axis.parameter(), zoom);
            let zoom = zoom.map_err(|error| refused(error.into()))?;
            let range = DecimalRange::rounded(zoom, 9);
            given[axis] = Some(range.ok_or_else(|| refused(GridError::Digits(zoom)))?);
        }
        Ok((scaled, given))
    }

    /// Returns the limit for one value and one threshold. `progress` is called as by [`Training::with_progress`].
    ///
    /// # Errors
    /// Returns the errors of [`Self::training`], or [`TrainingError::Stopped`].
    pub fn at(
        &self,
        axis: SizeAxis,
        value: f64,
        threshold: f64,
        progress: &dyn Progress,
    ) -> Result<SeparationPoint, TrainingError> {
        let scale = axis.scale(value);
        let training = self.training(scale, threshold)?;
        let side = training.grids[0].sensor().side();
        let limit = Evaluation::of(&training.with_progress(progress).run()?);
        Ok(SeparationPoint {
            value,
            scale,
            threshold,
            side,
            limit,
        })
    }

    /// Returns the smallest size with at most this error. Takes the first such size of the scan, then tries nine values
    /// between it and the size before. None if every size of the scan has a larger error.
    ///
    /// The error is not monotonic: overall it falls with the size, but here and there it rises. Between the values that
    /// were tried, it may reach the wanted error unnoticed. So this is the smallest size *of those that were tried*.
    ///
    /// # Errors
    /// Returns the errors of [`Self::at`].
    pub fn smallest(
        &self,
        axis: SizeAxis,
        scan: &[SeparationPoint],
        error: f64,
        progress: &dyn Progress,
    ) -> Result<Option<SmallestSize>, TrainingError> {
        let Some(first) = scan.iter().position(|point| point.limit.error() <= error) else {
            return Ok(None);
        };
        let later = &scan[first + 1..];
        let mut found = SmallestSize {
            point: scan[first].clone(),
            step: 0.0,
            missed_again: later
                .iter()
                .filter(|point| point.limit.error() > error)
                .count(),
        };
        if first > 0 {
            let (from, to) = (scan[first - 1].value, scan[first].value);
            let step = (to - from) / f64::from(FINER);
            found.step = to_decimals(step.abs(), 9);
            for index in 1..FINER {
                let value = to_decimals(from + f64::from(index) * step, 9);
                let point = self.at(axis, value, scan[first].threshold, progress)?;
                if point.limit.error() <= error {
                    found.point = point;
                    break;
                }
            }
        }
        Ok(Some(found))
    }
}

/// Multiplies every length of a figure. None if it is larger than the largest sensor.
fn enlarged(figure: &Figure, scale: f64) -> Option<Result<Figure, ParameterError>> {
    let length = |own| Some(to_decimals(figure.get(own)? * scale, 9));
    let mut lengths = figure.kind().sizes().iter().chain(&[Parameter::Thickness]);
    let is_large = |&own: &Parameter| length(own) > Some(Sensor::LARGEST.side().into());
    (!lengths.any(is_large)).then(|| {
        Figure::new(figure.kind(), &Sensor::LARGEST, |own| match own {
            Parameter::X0 | Parameter::Y0 | Parameter::Angle => Some(0.0),
            own => length(own),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Picture;
    use crate::pose::Ranges;
    use crate::progress::{ToTheEnd, stop_if};
    use crate::recognition::training::equal_figures;

    fn coarse(shapes: Vec<NamedShape>) -> Separation {
        let mut separation = Separation::new(shapes).expect("a set");
        separation.steps = GridSteps::of(10, "0:355:5");
        separation
    }

    fn scan(separation: &Separation, scales: &str) -> Vec<SeparationPoint> {
        let scales: DecimalRange = scales.parse().expect("a range");
        let at = |scale| separation.at(SizeAxis::Scale, scale, 0.5, &ToTheEnd);
        scales
            .values()
            .map(|scale| at(scale).expect("it fits"))
            .collect()
    }

    /// Shapes that are enlarged by hand and trained like any other set give the same touches and keys.
    #[test]
    fn a_point_is_a_training_of_larger_shapes() {
        let bar = |length: f64, width: f64| Figure::rectangle(length, width).on(&Sensor::LARGEST);
        let ring = |radius: f64, wall: f64| {
            let ring = Figure::ellipse(radius, radius).thickness(wall);
            ring.on(&Sensor::LARGEST)
        };
        let set = |scale: f64| {
            vec![
                NamedShape::new("bar", bar(3.0 * scale, 2.0 * scale).expect("in range")),
                NamedShape::new("ring", ring(2.0 * scale, 0.5 * scale).expect("in range")),
            ]
        };
        for (scale, threshold) in [(1.0, 0.5), (1.5, 0.5), (2.0, 0.3)] {
            let point = coarse(set(1.0)).at(SizeAxis::Scale, scale, threshold, &ToTheEnd);
            let point = point.expect("it fits");
            let sensor = Sensor::new(32, 32).and_then(|s| s.with(Parameter::Threshold, threshold));
            let cell: DecimalRange = "15:15.9:0.1".parse().expect("a range");
            let ranges = Ranges::default()
                .with(Axis::X0, cell)
                .with(Axis::Y0, cell)
                .with(Axis::Angle, "0:355:5".parse().expect("a range"));
            let by_hand = Training::new(
                set(scale),
                sensor.expect("in range"),
                Anchor::Centre,
                ranges,
            );
            let model = by_hand.and_then(Training::run).expect("not cut");
            let limit = Evaluation::of(&model);
            assert_eq!(point.limit, limit, "{scale} {threshold}");
        }
    }

    /// 7.5 cells of reach leave room for one cell of positions on 16 × 16, from 7.5 on.
    #[test]
    fn scale_1_is_a_training_of_the_set_itself() {
        let figure = |figure: crate::figure::FigureBuilder| figure.on(&Sensor::LARGEST);
        let shapes = vec![
            NamedShape::new("disc", figure(Figure::ellipse(7.5, 7.5)).expect("in range")),
            NamedShape::new("oval", figure(Figure::ellipse(7.5, 7.4)).expect("in range")),
            NamedShape::new("small", figure(Figure::triangle(4.0)).expect("in range")),
        ];
        for positions in [1, 5, 20, 25] {
            let steps = GridSteps::of(positions, "0:350:10");
            let training = Training::fitting(shapes.clone(), steps).expect("they fit");
            let side = training.grids[0].sensor().side();
            assert_eq!(side, 16);
            let limit = Evaluation::of(&training.run().expect("not stopped"));
            let mut separation = Separation::new(shapes.clone()).expect("a set");
            separation.steps = steps;
            let point = separation.at(SizeAxis::Scale, 1.0, 0.5, &ToTheEnd);
            let point = point.expect("it fits");
            assert_eq!((point.side, point.limit), (side, limit), "{positions}");
        }
    }

    #[test]
    fn pictures_are_zoomed_and_mix_with_figures() {
        let corner: crate::imprint::Imprint = "##\n#.".parse().expect("rows");
        let shapes = vec![
            NamedShape::new("corner", Picture::at_home(corner)),
            NamedShape::new(
                "square",
                Figure::rectangle(2.0, 2.0)
                    .on(&Sensor::default())
                    .expect("in range"),
            ),
        ];
        let separation = coarse(shapes);
        let points = scan(&separation, "1:3:1");
        let errors: Vec<f64> = points.iter().map(|point| point.limit.error()).collect();
        assert!(errors[0] > errors[2] && errors[2] < 0.01, "{errors:?}");
        // Half the pitch is twice the scale.
        let pitch = separation.at(SizeAxis::Pitch, 0.5, 0.5, &ToTheEnd);
        assert_eq!(pitch.expect("it fits").limit.error(), errors[1]);
        assert_eq!(
            separation
                .at(SizeAxis::Scale, 40.0, 0.5, &ToTheEnd)
                .expect_err("no sensor is that large"),
            TrainingError::Large
        );
    }

    #[test]
    fn the_smallest_size_is_the_first_of_those_tried() {
        let separation = coarse(equal_figures());
        let points = scan(&separation, "0.5:1.7:0.2");
        assert!(points[0].limit.error() > 0.5 && points[6].limit.error() < 0.1);
        let wanted = 0.2;
        let found = separation.smallest(SizeAxis::Scale, &points, wanted, &ToTheEnd);
        let found = found.expect("not stopped").expect("it is reached");
        assert_eq!(found.step, 0.02);
        assert!(found.point.limit.error() <= wanted);
        // Trying every size gives the same result.
        let fine = scan(&separation, "0.5:1.7:0.02");
        let first = fine.iter().find(|point| {
            let coarse = points.iter().find(|other| other.limit.error() <= wanted);
            point.limit.error() <= wanted && coarse.is_some_and(|it| it.value - point.value < 0.2)
        });
        assert_eq!(first.map(|point| point.value), Some(found.point.value));
        // An error that is just reached is small enough.
        let just = found.point.limit.error();
        let again = separation.smallest(SizeAxis::Scale, &points, just, &ToTheEnd);
        let again = again.expect("not stopped").expect("it is reached");
        assert_eq!((again.point, again.step), (found.point, found.step));
        let never = separation.smallest(SizeAxis::Scale, &points, 0.001, &ToTheEnd);
        assert_eq!(never, Ok(None));
        let at_once = separation.smallest(SizeAxis::Scale, &points[4..], 0.5, &ToTheEnd);
        let at_once = at_once.expect("not stopped").expect("it is reached");
        assert_eq!((at_once.point.value, at_once.step), (1.3, 0.0));
    }

    #[test]
    fn it_can_be_stopped() {
        let separation = coarse(equal_figures());
        let stopped = separation.at(SizeAxis::Scale, 1.0, 0.5, &|_| stop_if(true));
        assert_eq!(stopped, Err(TrainingError::Stopped));
        assert_eq!(separation.touches(), 7 * 100 * 72);
    }

    #[test]
    fn an_error_equal_to_the_wanted_one_is_small_enough() {
        let separation = coarse(equal_figures());
        let one = separation
            .at(SizeAxis::Scale, 0.5, 0.5, &ToTheEnd)
            .expect("it fits");
        let point = |value: f64, right: u128| {
            let mut point = SeparationPoint {
                value,
                ..one.clone()
            };
            (point.limit.touches, point.limit.right) = (10, right);
            point
        };
        let smallest = |scan: &[SeparationPoint]| {
            let found = separation.smallest(SizeAxis::Scale, scan, 0.1, &ToTheEnd);
            found.expect("nothing is computed")
        };
        let scan = [point(1.0, 9), point(2.0, 8), point(3.0, 9), point(4.0, 10)];
        let found = smallest(&scan).expect("the first one");
        assert_eq!((found.point.value, found.missed_again), (1.0, 1));
        assert_eq!(smallest(&scan[1..2]), None);
    }

    #[test]
    fn a_scale_multiplies_the_zoom_that_a_picture_has() {
        let ranges = |zoom: f64, scale: f64| {
            let rows = "##\n#.".parse().expect("rows");
            let mut source = Source::Picture(Picture::at_home(rows));
            for axis in [Axis::ZoomX, Axis::ZoomY] {
                let zoomed = source.with(axis.parameter(), zoom, &Sensor::LARGEST);
                source = zoomed.expect("in range");
            }
            let separation = coarse(vec![NamedShape::new("corner", source)]);
            let training = separation.training(scale, 0.5).expect("it fits");
            *training.grids[0].ranges()
        };
        assert_eq!(ranges(2.0, 1.5), ranges(1.0, 3.0));
        assert_eq!(ranges(2.0, 1.5)[Axis::ZoomX], DecimalRange::whole(3));
    }

    #[test]
    fn a_shape_may_be_as_large_as_the_largest_sensor() {
        let taxel: crate::imprint::Imprint = "#".parse().expect("rows");
        let square = Figure::rectangle(1.0, 1.0).on(&Sensor::default());
        let square = square.expect("in range");
        for source in [Source::Picture(Picture::at_home(taxel)), square.into()] {
            let shape = NamedShape::new("square", source.clone());
            let separation = coarse(vec![shape.clone()]);
            let is_there = |scale: f64| separation.scaled(&shape, scale).is_ok();
            assert!(is_there(64.0) && !is_there(64.01), "{source:?}");
        }
    }
}
