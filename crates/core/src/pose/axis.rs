use std::ops::{Index, IndexMut};

use crate::parameter::{Parameter, named};
use crate::pose::range::DecimalRange;
use crate::source::Source;

/// An axis of a pose. In a grid, the first axis runs fastest and the last one slowest.
///
/// Figures have the first three; their zooms are 1. Pictures have all five.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Axis {
    /// The position to the right, in cells.
    X0,
    /// The position downwards, in cells.
    Y0,
    /// The rotation in degrees: clockwise for figures, counter-clockwise for pictures.
    Angle,
    /// The horizontal zoom of a picture.
    ZoomX,
    /// The vertical zoom of a picture.
    ZoomY,
}

impl Axis {
    /// All axes, the fastest first.
    pub const ALL: [Self; 5] = [Self::X0, Self::Y0, Self::Angle, Self::ZoomX, Self::ZoomY];

    /// Iterates over the axes that a shape has: all of them for a picture, all except the zooms for a figure.
    pub fn of(source: &Source) -> impl Iterator<Item = Self> + use<> {
        let own = source.parameters();
        let all = Self::ALL.into_iter();
        all.filter(move |axis| own.contains(&axis.parameter()))
    }

    /// Returns the parameter that this axis sets. It has the unit and the range of the axis.
    pub const fn parameter(self) -> Parameter {
        match self {
            Self::X0 => Parameter::X0,
            Self::Y0 => Parameter::Y0,
            Self::Angle => Parameter::Angle,
            Self::ZoomX => Parameter::ZoomX,
            Self::ZoomY => Parameter::ZoomY,
        }
    }

    /// Returns the name in files, which is the key of the parameter: `"zoom_x"`.
    pub fn name(self) -> &'static str {
        self.parameter().row().key
    }

    /// Returns true if only pictures have the axis.
    pub const fn is_zoom(self) -> bool {
        matches!(self, Self::ZoomX | Self::ZoomY)
    }
}

named!(Axis, "axis", &Axis::ALL);

/// A value for each axis, indexed by [`Axis`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PerAxis<T>([T; 5]);

/// The range of each axis; together they span a [`PoseGrid`](crate::pose::PoseGrid).
pub type Ranges = PerAxis<DecimalRange>;

/// The values of one pose: cells, degrees, and zooms, which are 1 for figures.
///
/// x0 and y0 locate the anchor. If the anchor of a picture is its corner, they are the position before zooming.
pub type Pose = PerAxis<f64>;

/// The position of a pose in a grid: for each axis, the index of its value in the range, from 0.
pub type PoseIndex = PerAxis<u64>;

impl<T> PerAxis<T> {
    /// Creates values from an array in the order of [`Axis::ALL`].
    pub const fn new(values: [T; 5]) -> Self {
        Self(values)
    }

    /// Creates values by calling `value` for each axis.
    pub fn from_fn(value: impl FnMut(Axis) -> T) -> Self {
        Self(Axis::ALL.map(value))
    }

    /// Returns the same values with another value on one axis.
    #[must_use]
    pub fn with(mut self, axis: Axis, value: T) -> Self {
        self[axis] = value;
        self
    }

    /// Returns the values in the order of [`Axis::ALL`].
    pub fn into_array(self) -> [T; 5] {
        self.0
    }

    /// Iterates over the axes and their values, the fastest axis first.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (Axis, &T)> + ExactSizeIterator {
        Axis::ALL.into_iter().zip(&self.0)
    }
}

impl<T> Index<Axis> for PerAxis<T> {
    type Output = T;
    fn index(&self, axis: Axis) -> &T {
        &self.0[axis as usize]
    }
}

impl<T> IndexMut<Axis> for PerAxis<T> {
    fn index_mut(&mut self, axis: Axis) -> &mut T {
        &mut self.0[axis as usize]
    }
}

impl Default for Ranges {
    fn default() -> Self {
        Self([
            DecimalRange::from_units(500, 1, 2, 100),
            DecimalRange::from_units(500, 1, 2, 100),
            DecimalRange::from_units(0, 1, 0, 360),
            DecimalRange::whole(1),
            DecimalRange::whole(1),
        ])
    }
}

impl<T> Default for PerAxis<Option<T>> {
    fn default() -> Self {
        Self([const { None }; 5])
    }
}

/// The point of a shape that x0 and y0 locate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Anchor {
    /// The top left corner of the bounding rectangle before rotation.
    #[default]
    Corner,
    /// The centre of rotation. For a picture, it lies at (x0, y0) under every zoom.
    Centre,
}

named!(Anchor, "anchor", [Corner "corner", Centre "centre"]);

#[cfg(test)]
mod tests {
    #[test]
    fn values_are_found_by_their_axis_and_axes_by_their_name()
    -> Result<(), Box<dyn std::error::Error>> {
        use crate::pose::{Anchor, Axis, PoseIndex, Ranges};
        use std::collections::HashMap;
        let ranges = Ranges::default().with(Axis::X0, "5:6:0.5".parse()?);
        assert_eq!(ranges[Axis::X0].count(), 3);
        assert_eq!(
            Axis::ALL.map(Axis::name),
            ["x0", "y0", "angle", "zoom_x", "zoom_y"]
        );
        let corner = PoseIndex::new([0; 5]).with(Axis::Angle, 90);
        assert_eq!(corner[Axis::Angle], 90);
        // Ranges and indices are keys of maps.
        let done = HashMap::from([(Ranges::default(), corner)]);
        assert_eq!(done.get(&Ranges::default()), Some(&corner));
        assert_eq!(Anchor::Centre.name(), "centre");
        assert_eq!("centre".parse(), Ok(Anchor::Centre));
        assert!("middle".parse::<Anchor>().is_err());
        Ok(())
    }
}
