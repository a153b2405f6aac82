//! What is swept: a figure or a picture, a sensor, and a range for each parameter of the pose.
//!
//! **Order of poses.** x0 runs fastest, then y0, then the angle, then zoom x, then zoom y (only pictures have zooms). A
//! *row* is all x0 at one y0, a *turn* all rows at one angle and one pair of zooms. Poses, rows and turns are
//! numbered from 0 in this order.
//!
//! **Anchor.** The ranges of x0 and y0 place the shape's corner, as everywhere in the program, or its centre: of a
//! figure the centre that it turns about, of a picture that of its scaled bounding rectangle, which then lies
//! *at* the given point, whatever the zoom. Cells, degrees. Convention of this project.

use crate::geometry::Real;
use crate::geometry::{Moving, Pen, Point, Solid};
use crate::parameter::{Parameter, ParameterError};
use crate::pose::boundary::Boundary;
use crate::pose::range::DecimalRange;
use crate::sensor::Sensor;
use crate::source::Source;

/// The most poses that a grid may have.
pub const MAX_POSES: u64 = 1_000_000_000_000;

/// Which point of the shape the ranges of x0 and y0 place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Anchor {
    /// The top left corner of the bounding rectangle before rotation.
    #[default]
    Corner,
    /// The centre of rotation.
    Centre,
}

/// A range for each parameter of a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ranges {
    /// Runs fastest; cells.
    pub x0: DecimalRange,
    /// Cells.
    pub y0: DecimalRange,
    /// Degrees.
    pub angle: DecimalRange,
    /// Of pictures only.
    pub zoom_x: DecimalRange,
    /// Of pictures only; runs slowest.
    pub zoom_y: DecimalRange,
}

impl Default for Ranges {
    /// The paper's grid: x0 and y0 over one cell from 5 in hundredths, every whole degree, no zoom.
    fn default() -> Self {
        Self {
            x0: DecimalRange::from_units(500, 2, 100),
            y0: DecimalRange::from_units(500, 2, 100),
            angle: DecimalRange::from_units(0, 0, 360),
            zoom_x: DecimalRange::whole(1),
            zoom_y: DecimalRange::whole(1),
        }
    }
}

impl Ranges {
    /// Each range with its parameter, from the fastest to the slowest.
    pub fn by_parameter(&self) -> [(Parameter, DecimalRange); 5] {
        [
            (Parameter::X0, self.x0),
            (Parameter::Y0, self.y0),
            (Parameter::Angle, self.angle),
            (Parameter::ZoomX, self.zoom_x),
            (Parameter::ZoomY, self.zoom_y),
        ]
    }
}

/// A shape, a sensor and the poses to go through; all of them in range.
///
/// ```
/// use taxel::prelude::*;
/// let rectangle = Source::Figure(Figure::default_of(FigureKind::Rectangle, &Sensor::default()));
/// let grid = PoseGrid::new(rectangle, Sensor::default(), Anchor::Corner, Ranges::default())?;
/// assert_eq!(grid.poses(), 3_600_000);
/// let pose = grid.pose(10_203);
/// assert_eq!((pose.x0, pose.y0, pose.angle), (5.03, 5.02, 1.0));
/// # Ok::<(), taxel::pose::GridError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PoseGrid {
    source: Source,
    sensor: Sensor,
    anchor: Anchor,
    ranges: Ranges,
}

impl PoseGrid {
    /// The grid; the position, angle and zoom that `source` itself has do not matter: it is put into the first pose.
    ///
    /// # Errors
    /// A range that leaves its parameter's, zooms for a figure, or more than [`MAX_POSES`] poses.
    pub fn new(
        source: Source,
        sensor: Sensor,
        anchor: Anchor,
        ranges: Ranges,
    ) -> Result<Self, GridError> {
        let (mut source, mut poses) = (source, 1_u128);
        for (parameter, range) in ranges.by_parameter() {
            let zoom = matches!(parameter, Parameter::ZoomX | Parameter::ZoomY);
            if zoom && source.kind().is_some() {
                if range != DecimalRange::whole(1) {
                    return Err(GridError::Zoom {
                        noun: source.noun(),
                    });
                }
                continue;
            }
            sensor.check(parameter, range.last())?;
            source = source.with(parameter, range.value(0), &sensor)?;
            poses *= u128::from(range.count());
        }
        if poses > u128::from(MAX_POSES) {
            return Err(GridError::Poses { poses });
        }
        Ok(Self {
            source,
            sensor,
            anchor,
            ranges,
        })
    }

    /// The shape.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// The sensor.
    pub fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    /// What the ranges of x0 and y0 place.
    pub fn anchor(&self) -> Anchor {
        self.anchor
    }

    /// The ranges.
    pub fn ranges(&self) -> &Ranges {
        &self.ranges
    }

    /// Number of poses.
    pub fn poses(&self) -> u64 {
        self.rows() * self.ranges.x0.count()
    }

    /// Number of rows: of all y0 at all turns.
    pub fn rows(&self) -> u64 {
        self.turns() * self.ranges.y0.count()
    }

    /// Number of turns: of angles times zooms.
    fn turns(&self) -> u64 {
        self.ranges.angle.count() * self.ranges.zoom_x.count() * self.ranges.zoom_y.count()
    }

    /// How many values each range has.
    pub fn counts(&self) -> PoseIndex {
        self.ranges.by_parameter().map(|(_, range)| range.count())
    }

    /// Where the pose of that number is; beyond the last one, the places begin again.
    pub fn place(&self, number: u64) -> PoseIndex {
        let mut rest = number;
        self.counts().map(|count| {
            let index = rest % count;
            rest /= count;
            index
        })
    }

    /// The pose of that number; beyond the last one, the poses begin again.
    pub fn pose(&self, number: u64) -> Pose {
        let [x0, y0, angle, zoom_x, zoom_y] = self.place(number);
        Pose {
            x0: self.ranges.x0.value(x0),
            y0: self.ranges.y0.value(y0),
            angle: self.ranges.angle.value(angle),
            zoom_x: self.ranges.zoom_x.value(zoom_x),
            zoom_y: self.ranges.zoom_y.value(zoom_y),
        }
    }

    /// The shape in a pose. A value out of its parameter's range is ignored.
    pub fn placed(&self, pose: Pose) -> Placed {
        let (x0, y0) = match self.anchor {
            Anchor::Corner => (pose.x0, pose.y0),
            Anchor::Centre => (0.0, 0.0),
        };
        let set = |angle: f64| {
            let values = [
                (Parameter::X0, x0),
                (Parameter::Y0, y0),
                (Parameter::Angle, angle),
                (Parameter::ZoomX, pose.zoom_x),
                (Parameter::ZoomY, pose.zoom_y),
            ];
            values
                .into_iter()
                .fold(self.source.clone(), |source, (parameter, value)| {
                    // The ranges were checked; a value that is none of them changes nothing.
                    let set = source.clone().with(parameter, value, &self.sensor);
                    set.unwrap_or(source)
                })
        };
        Placed {
            turned: set(pose.angle),
            centred: (self.anchor == Anchor::Centre).then(|| (set(0.0), pose.x0, pose.y0)),
        }
    }

    /// The pose that starts a turn.
    fn turned(&self, turn: u64) -> Pose {
        self.pose(turn * self.ranges.y0.count() * self.ranges.x0.count())
    }

    /// The shape of a turn with its anchor at the origin.
    pub(crate) fn boundary<T: Real>(&self, turn: u64) -> Boundary<T> {
        let (x0, y0) = (0.0, 0.0);
        Boundary::of(&self.placed(Pose {
            x0,
            y0,
            ..self.turned(turn)
        }))
    }

    /// Where the anchor lies in the plane at values `x` and `y` of x0 and y0.
    pub(crate) fn offset<T: Real>(&self, turn: u64, x: u64, y: u64) -> Point<T> {
        let place = Point::new(
            T::decimal(self.ranges.x0.value(x)),
            T::decimal(self.ranges.y0.value(y)),
        );
        if self.anchor == Anchor::Centre || self.source.kind().is_some() {
            return place;
        }
        let Pose { zoom_x, zoom_y, .. } = self.turned(turn);
        Point::new(place.x * T::decimal(zoom_x), place.y * T::decimal(zoom_y))
    }
}

/// Which value of each range, counted from 0, from the fastest: x0, y0, angle, zoom x, zoom y.
pub type PoseIndex = [u64; 5];

/// Values of one pose: cells, degrees, ratios.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Where the anchor lies from the left; of a picture's corner, before it is zoomed.
    pub x0: f64,
    /// Where the anchor lies from the top.
    pub y0: f64,
    /// As the figure or the picture turns.
    pub angle: f64,
    /// 1 for figures.
    pub zoom_x: f64,
    /// 1 for figures.
    pub zoom_y: f64,
}

/// A shape in a pose of a grid.
#[derive(Clone, Debug)]
pub struct Placed {
    turned: Source,
    /// With the anchor at the centre: the shape before it is turned, and where its centre goes. Both shapes then lie
    /// with their corner at the origin.
    centred: Option<(Source, f64, f64)>,
}

impl Solid for Placed {
    fn draw<T: Real>(&self, pen: &mut impl Pen<T>) {
        let Some((upright, x, y)) = &self.centred else {
            return self.turned.draw(pen);
        };
        let centre = centre::<T>(upright);
        let by = Point::new(T::decimal(*x) - centre.x, T::decimal(*y) - centre.y);
        self.turned.draw(&mut Moving { by, pen });
    }
}

/// Where the centre of a shape lies that is not turned.
pub(crate) fn centre<T: Real>(upright: &Source) -> Point<T> {
    let boundary = Boundary::of(upright);
    match upright {
        Source::Figure(_) => boundary.mean(),
        Source::Picture(_) => boundary.middle(),
    }
}

/// Why there is no such grid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GridError {
    /// A range beyond that of its parameter.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Zooms for something that has none.
    #[error("zoom_x, zoom_y: a {noun} has none, only pictures have")]
    Zoom {
        /// What was to be swept.
        noun: &'static str,
    },
    /// Too many poses.
    #[error("{poses} poses, expected at most {MAX_POSES}")]
    Poses {
        /// How many it would be.
        poses: u128,
    },
}
