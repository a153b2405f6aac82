//! The source of an imprint: a figure, a picture or an outline. An imprint drawn by hand has no source.
//!
//! All that tells the kinds of shapes apart is asked here; what uses a shape asks it to draw itself ([`Solid`]).

use std::fmt;

use crate::figure::{Figure, FigureKind};
use crate::geometry::{Pen, Real, Solid};
use crate::outline::{Outline, OutlineError};
use crate::parameter::number::to_decimals;
use crate::parameter::{Parameter, ParameterError};
use crate::picture::{PICTURE_PARAMETERS, Picture};
use crate::sensor::Sensor;
use crate::values::Values;

/// A figure, a picture or an outline, including its position, angle and zoom.
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
    /// Rings, placed like a picture.
    Outline(Outline),
}

impl Source {
    /// Returns "figure", "picture" or "outline".
    pub fn noun(&self) -> &'static str {
        match self {
            Self::Figure(_) => "figure",
            Self::Picture(_) => "picture",
            Self::Outline(_) => "outline",
        }
    }

    /// Returns the parameters of the shape, in the order of forms.
    pub fn parameters(&self) -> &'static [Parameter] {
        match self {
            Self::Figure(figure) => figure.kind().parameters(),
            Self::Picture(_) | Self::Outline(_) => PICTURE_PARAMETERS,
        }
    }

    fn values(&self) -> &Values {
        match self {
            Self::Figure(figure) => &figure.values,
            Self::Picture(picture) => &picture.values,
            Self::Outline(outline) => &outline.values,
        }
    }

    /// Changes a value without a check.
    pub(crate) fn put(&mut self, parameter: Parameter, value: f64) {
        match self {
            Self::Figure(figure) => figure.values.put(parameter, value),
            Self::Picture(picture) => picture.values.put(parameter, value),
            Self::Outline(outline) => outline.values.put(parameter, value),
        }
    }

    /// Returns the value of a parameter; None for one that the shape does not have or that has no value.
    pub fn get(&self, parameter: Parameter) -> Option<f64> {
        self.values().get(parameter)
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
        let (owner, own) = (self.kind_name(), self.parameters());
        let value = sensor.check_own(owner, own, parameter, value)?;
        self.put(parameter, value);
        Ok(self)
    }

    /// Returns the same shape, placed by the values that `value` returns for its parameters, each in range on the
    /// sensor.
    ///
    /// # Errors
    /// Returns the error of the first value that is missing or out of range.
    pub fn placed(
        mut self,
        sensor: &Sensor,
        value: impl FnMut(Parameter) -> Option<f64>,
    ) -> Result<Self, ParameterError> {
        let values = Values::new(self.parameters(), sensor, value)?;
        match &mut self {
            Self::Figure(figure) => figure.values = values,
            Self::Picture(picture) => picture.values = values,
            Self::Outline(outline) => outline.values = values,
        }
        Ok(self)
    }

    /// Returns the same shape with the name under which it is stored; a figure has none.
    #[must_use]
    pub fn named(self, name: &str) -> Self {
        match self {
            Self::Figure(figure) => Self::Figure(figure),
            Self::Picture(picture) => Self::Picture(picture.named(name)),
            Self::Outline(outline) => Self::Outline(outline.named(name)),
        }
    }

    /// Returns a picture or an outline in its own place, as a new one is; a figure as it is.
    #[must_use]
    pub fn at_home(self) -> Self {
        match self {
            Self::Figure(figure) => Self::Figure(figure),
            Self::Picture(mut picture) => {
                picture.values = Picture::at_home(*picture.imprint()).values;
                Self::Picture(picture)
            }
            Self::Outline(outline) => Self::Outline(outline.at_home()),
        }
    }

    /// Returns the same shape on a sensor of this pitch, if one is given: an outline in mm then has another size in
    /// cells.
    ///
    /// # Errors
    /// Returns an error if it is then larger than 1,000,000 cells.
    pub fn at_pitch(self, pitch_mm: Option<f64>) -> Result<Self, OutlineError> {
        match (self, pitch_mm) {
            (Self::Outline(outline), Some(pitch)) => outline.at_pitch(pitch).map(Self::Outline),
            (other, _) => Ok(other),
        }
    }

    /// Refuses an outline that is longer than the larger side of the sensor, with its zooms but not turned.
    ///
    /// # Errors
    /// Returns an error that says by how much, also in mm if the outline is in mm.
    pub fn check_size(&self, sensor: &Sensor) -> Result<(), OutlineError> {
        let Self::Outline(outline) = self else {
            return Ok(());
        };
        let zoomed = |side: f64, zoom| side * outline.values.of(zoom);
        let [width, height] = outline.size();
        let length = zoomed(width, Parameter::ZoomX).max(zoomed(height, Parameter::ZoomY));
        let longer = length - f64::from(sensor.side());
        if longer <= 0.0 {
            return Ok(());
        }
        let said = |cells: f64| {
            let mm = outline
                .pitch_mm()
                .map(|pitch| to_decimals(cells * pitch, 3));
            let mm = mm.map_or(String::new(), |mm| format!(" ({mm} mm)"));
            format!("{} cells{mm}", to_decimals(cells, 3))
        };
        let (length, longer) = (said(length), said(longer));
        let text = format!("{length} long, {longer} longer than the sensor");
        Err(OutlineError(text))
    }

    /// Returns the kind of figure; None for another shape.
    pub fn kind(&self) -> Option<FigureKind> {
        match self {
            Self::Figure(figure) => Some(figure.kind()),
            Self::Picture(_) | Self::Outline(_) => None,
        }
    }

    /// Returns the name under which a picture or an outline is stored; None if it was not given, and for a figure.
    pub fn stored_name(&self) -> Option<&str> {
        match self {
            Self::Figure(_) => None,
            Self::Picture(picture) => picture.name.as_deref(),
            Self::Outline(outline) => outline.name.as_deref(),
        }
    }

    /// Returns true if both are the same shape but for its values: figures of the same kind, pictures of the same
    /// imprint, outlines of the same rings.
    pub fn is_alike(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Figure(own), Self::Figure(other)) => own.kind() == other.kind(),
            (Self::Picture(own), Self::Picture(other)) => own.imprint() == other.imprint(),
            (Self::Outline(own), Self::Outline(other)) => own.same_rings(other),
            _ => false,
        }
    }

    /// Returns the name of the kind of figure, or "picture" or "outline".
    pub fn kind_name(&self) -> &'static str {
        self.kind().map_or(self.noun(), FigureKind::name)
    }

    /// Returns the sense in which the shape turns as its angle grows, as seen: +1 for clockwise, −1 for
    /// counter-clockwise.
    pub fn sense(&self) -> f64 {
        if self.kind().is_some() { 1.0 } else { -1.0 }
    }

    /// The number of rotations within a full turn that map the shape onto itself; None if all do. `equal_zooms` says
    /// that both zooms are always the same.
    pub(crate) fn rotations(&self, equal_zooms: bool) -> Option<u32> {
        match self {
            Self::Figure(figure) => figure.rotations(),
            Self::Picture(picture) => Some(picture.rotations(equal_zooms)),
            Self::Outline(outline) => outline.rotations(equal_zooms),
        }
    }

    /// The sum in degrees of two angles at which the shape shows its mirror image, with right and left exchanged; None
    /// if there are no such angles. Every upright figure is its own mirror image.
    pub(crate) fn mirror(&self) -> Option<u32> {
        match self {
            Self::Figure(_) => Some(0),
            Self::Picture(picture) => picture.mirror(),
            Self::Outline(outline) => outline.mirror(),
        }
    }

    /// The sides of the bounding rectangle before zoom and rotation; None if they are no decimals.
    pub(crate) fn box_sides(&self) -> Option<[f64; 2]> {
        match self {
            Self::Figure(figure) => figure.box_sides(),
            Self::Picture(picture) => picture.box_sides(),
            Self::Outline(outline) => outline.box_sides(),
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

impl From<Outline> for Source {
    fn from(outline: Outline) -> Self {
        Self::Outline(outline)
    }
}

impl Solid for Source {
    fn draw<T: Real>(&self, pen: &mut impl Pen<T>) {
        match self {
            Self::Figure(figure) => figure.draw(pen),
            Self::Picture(picture) => picture.draw(pen),
            Self::Outline(outline) => outline.draw(pen),
        }
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Self::Figure(figure) = self {
            return figure.fmt(f);
        }
        f.write_str(self.noun())?;
        if let Some(name) = self.stored_name() {
            write!(f, " of {name}")?;
        }
        let text = |own: Parameter| own.format(self.values().of(own));
        let [x0, y0, angle, zoom_x, zoom_y] = PICTURE_PARAMETERS.map(text);
        write!(f, " at {x0}, {y0}, {angle}°, zoom {zoom_x} × {zoom_y}")
    }
}
