//! The source of an imprint: a figure or a picture. An imprint drawn by hand has no source.

use std::fmt;

use crate::figure::{Figure, FigureKind};
use crate::geometry::{Pen, Real, Solid};
use crate::parameter::{Parameter, ParameterError};
use crate::picture::{PICTURE_PARAMETERS, Picture};
use crate::sensor::Sensor;

/// A figure or a picture, including its position, angle and zoom.
#[derive(Clone, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "there is one at a time, and a picture is plain data"
)]
pub enum Source {
    /// One of the seven figures.
    Figure(Figure),
    /// A stored imprint, placed on the plane.
    Picture(Picture),
}

impl Source {
    /// Returns "figure" or "picture".
    pub fn noun(&self) -> &'static str {
        match self {
            Self::Figure(_) => "figure",
            Self::Picture(_) => "picture",
        }
    }

    /// Returns the parameters of the shape, in the order of forms.
    pub fn parameters(&self) -> &'static [Parameter] {
        match self {
            Self::Figure(figure) => figure.kind().parameters(),
            Self::Picture(_) => PICTURE_PARAMETERS,
        }
    }

    /// Returns the value of a parameter; None for one that the shape does not have or that has no value.
    pub fn get(&self, parameter: Parameter) -> Option<f64> {
        match self {
            Self::Figure(figure) => figure.get(parameter),
            Self::Picture(picture) => picture.get(parameter),
        }
    }

    /// Returns the same shape with one parameter changed to `value`, in the parameter's unit.
    ///
    /// # Errors
    /// Returns an error if the value is out of range on the sensor, or the shape does not have the parameter.
    pub fn with(
        mut self,
        parameter: Parameter,
        value: f64,
        sensor: &Sensor,
    ) -> Result<Self, ParameterError> {
        self.set(parameter, value, sensor)?;
        Ok(self)
    }

    pub(crate) fn set(
        &mut self,
        parameter: Parameter,
        value: f64,
        sensor: &Sensor,
    ) -> Result<(), ParameterError> {
        match self {
            Self::Figure(figure) => figure.set(parameter, value, sensor),
            Self::Picture(picture) => picture.set(parameter, value, sensor),
        }
    }

    /// Returns the kind of figure; None for a picture.
    pub fn kind(&self) -> Option<FigureKind> {
        match self {
            Self::Figure(figure) => Some(figure.kind()),
            Self::Picture(_) => None,
        }
    }

    /// Returns the name of the kind of figure, or "picture".
    pub fn kind_name(&self) -> &'static str {
        self.kind().map_or("picture", FigureKind::name)
    }

    /// Returns the sense in which the shape turns as its angle grows, as seen: +1 for clockwise, −1 for
    /// counter-clockwise.
    pub fn sense(&self) -> f64 {
        match self {
            Self::Figure(_) => 1.0,
            Self::Picture(_) => -1.0,
        }
    }
}

impl From<Figure> for Source {
    fn from(figure: Figure) -> Self {
        Self::Figure(figure)
    }
}

impl From<Picture> for Source {
    fn from(picture: Picture) -> Self {
        Self::Picture(picture)
    }
}

impl Solid for Source {
    fn draw<T: Real>(&self, pen: &mut impl Pen<T>) {
        match self {
            Self::Figure(figure) => figure.draw(pen),
            Self::Picture(picture) => picture.draw(pen),
        }
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Figure(figure) => figure.fmt(f),
            Self::Picture(picture) => picture.fmt(f),
        }
    }
}
