//! What made an imprint: a figure or a picture. An imprint drawn by hand has no source.

use std::fmt;

use crate::figure::{Figure, FigureKind};
use crate::geometry::{Pen, Real, Solid};
use crate::parameter::{Parameter, ParameterError};
use crate::picture::{PICTURE_PARAMETERS, Picture};

/// A figure or a picture, where it is.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(
    clippy::large_enum_variant,
    reason = "there is one of these at a time, and a picture is plain data"
)]
pub enum Source {
    /// One of the seven figures.
    Figure(Figure),
    /// A stored imprint, moved.
    Picture(Picture),
}

impl Source {
    /// "figure" or the like: what it is called in a sentence.
    pub fn noun(&self) -> &'static str {
        match self {
            Self::Figure(_) => "figure",
            Self::Picture(_) => "picture",
        }
    }

    /// Its parameters, in the order of forms.
    pub fn parameters(&self) -> Vec<Parameter> {
        match self {
            Self::Figure(figure) => figure.kind().parameters().collect(),
            Self::Picture(_) => PICTURE_PARAMETERS.to_vec(),
        }
    }

    /// One of its values; none of a parameter that it does not have or that is absent.
    pub fn get(&self, parameter: Parameter) -> Option<f64> {
        match self {
            Self::Figure(figure) => figure.get(parameter),
            Self::Picture(picture) => picture.get(parameter),
        }
    }

    /// The same with one value changed; `value` in the parameter's unit. Unchanged by a parameter that it does not have,
    /// whose value is checked all the same.
    ///
    /// # Errors
    /// Where the value is out of range on a sensor whose larger side is `side`.
    pub fn with(self, parameter: Parameter, value: f64, side: u8) -> Result<Self, ParameterError> {
        match self {
            Self::Figure(figure) => figure.with(parameter, value, side).map(Self::Figure),
            Self::Picture(picture) => picture.with(parameter, value, side).map(Self::Picture),
        }
    }

    /// The kind of figure; none of a picture.
    pub fn kind(&self) -> Option<FigureKind> {
        match self {
            Self::Figure(figure) => Some(figure.kind()),
            Self::Picture(_) => None,
        }
    }

    /// Which way it turns as its angle grows, as seen: +1 clockwise, −1 counter-clockwise.
    pub fn sense(&self) -> f64 {
        match self {
            Self::Figure(_) => 1.0,
            Self::Picture(_) => -1.0,
        }
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
