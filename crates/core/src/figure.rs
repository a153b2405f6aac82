//! The seven figures of the paper, each solid or with one concentric hole of the same kind.
//!
//! A figure is given by its sizes, by the top left corner (`x0`, `y0`) of its bounding rectangle before rotation, by a
//! clockwise angle about its centre, and by the thickness of its wall. Regular polygons stand on a horizontal side
//! before rotation; their centre is that of the circumscribed circle. Source: Purcaru and Niculescu; the direction of
//! rotation and the form of the hole are conventions of this project.

use std::fmt;

use crate::geometry::{
    Double, Ellipse, Extent, MOST_CORNERS, Pen, Point, Real, RegularPolygon, Side, Solid, Turn,
};
use crate::parameter::{Parameter, ParameterError, named};
use crate::sensor::Sensor;

/// The note that is shown if a thickness leaves no room for a hole.
pub const NO_ROOM: &str = "no room for a hole: solid";

/// The kinds of figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FigureKind {
    /// An ellipse with its axes along x and y before rotation; a circle if its radii are equal.
    Ellipse,
    /// A rectangle with its sides along x and y before rotation.
    Rectangle,
    /// An equilateral triangle.
    Triangle,
    /// A regular pentagon.
    Pentagon,
    /// A regular hexagon.
    Hexagon,
    /// A regular heptagon.
    Heptagon,
    /// A regular octagon.
    Octagon,
}

impl FigureKind {
    /// All seven kinds, in the paper's order.
    pub const ALL: &'static [Self] = &[
        Self::Ellipse,
        Self::Rectangle,
        Self::Triangle,
        Self::Pentagon,
        Self::Hexagon,
        Self::Heptagon,
        Self::Octagon,
    ];

    /// Returns the names of all kinds, in the same order.
    pub fn names() -> Vec<&'static str> {
        Self::ALL.iter().map(|kind| kind.name()).collect()
    }

    /// Returns the name of the kind, as in files, in flags and on the screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ellipse => "ellipse",
            Self::Rectangle => "rectangle",
            Self::Triangle => "triangle",
            Self::Pentagon => "pentagon",
            Self::Hexagon => "hexagon",
            Self::Heptagon => "heptagon",
            Self::Octagon => "octagon",
        }
    }

    /// Returns a hint for a word that means a figure but is not its name: "circle" or "square".
    pub fn of_other_name(word: &str) -> Option<&'static str> {
        match word.to_ascii_lowercase().as_str() {
            "circle" => Some("a circle is an ellipse with equal radii"),
            "square" => Some("a square is a rectangle with equal sides"),
            _ => None,
        }
    }

    /// Returns the parameters of the kind in the order of forms: sizes, position, angle, thickness. A figure may lack
    /// the thickness.
    pub fn parameters(self) -> &'static [Parameter] {
        use Parameter::{Angle, Length, RadiusX, RadiusY, Side, Thickness, Width, X0, Y0};
        match self {
            Self::Ellipse => &[RadiusX, RadiusY, X0, Y0, Angle, Thickness],
            Self::Rectangle => &[Length, Width, X0, Y0, Angle, Thickness],
            _ => &[Side, X0, Y0, Angle, Thickness],
        }
    }

    /// Returns the parameters that give the figure's size.
    pub fn sizes(self) -> &'static [Parameter] {
        let own = self.parameters();
        &own[..own.len() - 4]
    }

    /// Returns the number of corners of a regular polygon; None for an ellipse or a rectangle.
    fn corners(self) -> Option<u8> {
        match self {
            Self::Ellipse | Self::Rectangle => None,
            Self::Triangle => Some(3),
            Self::Pentagon => Some(5),
            Self::Hexagon => Some(6),
            Self::Heptagon => Some(7),
            Self::Octagon => Some(8),
        }
    }
}

named!(FigureKind, "figure", FigureKind::ALL);

/// A figure on the sensory plane. Its values are always finite, and its sizes and its thickness are above 0.
///
/// A constructor for each kind starts a [`FigureBuilder`]; the sensor that the figure is placed on checks its values.
///
/// ```
/// use taxel_core::prelude::*;
/// let sensor = Sensor::default();
/// let ring = Figure::ellipse(4.0, 4.0).at(1.99, 1.47).thickness(2.0).on(&sensor)?;
/// assert_eq!(ring.to_string(), "ellipse rx 4.00 ry 4.00 at 1.99, 1.47, 0°, wall 2.00");
/// let hexagon = Figure::hexagon(3.0).on(&sensor)?;
/// assert!(format!("{hexagon:?}").contains("sizes: [3.0], x0: 0.0"));
///
/// let error = Figure::hexagon(16.5).on(&sensor).unwrap_err();
/// assert_eq!(error.to_string(), "side: 16.5 is above 16 (allowed: above 0, up to 16)");
/// # Ok::<(), ParameterError>(())
/// ```
#[derive(Clone, Copy, PartialEq)]
pub struct Figure {
    kind: FigureKind,
    /// The values of `kind.sizes()`; the second is unused if there is only one.
    sizes: [f64; 2],
    x0: f64,
    y0: f64,
    angle: f64,
    thickness: Option<f64>,
}

/// A figure whose values are not checked yet; [`Self::on`] checks them all.
///
/// Without [`Self::at`] its bounding rectangle starts at the sensor's top left corner; without [`Self::angle`] it is
/// upright; without [`Self::thickness`] it is solid.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use = "only `on` makes a figure of it"]
pub struct FigureBuilder(Figure);

impl FigureBuilder {
    fn new(kind: FigureKind, sizes: [f64; 2]) -> Self {
        Self(Figure {
            kind,
            sizes,
            x0: 0.0,
            y0: 0.0,
            angle: 0.0,
            thickness: None,
        })
    }

    /// Places the top left corner of the bounding rectangle before rotation; in cell sides.
    pub fn at(self, x0: f64, y0: f64) -> Self {
        Self(Figure { x0, y0, ..self.0 })
    }

    /// Turns the figure about its centre, clockwise as seen; in degrees, from 0 to below 360.
    pub fn angle(self, degrees: f64) -> Self {
        Self(Figure {
            angle: degrees,
            ..self.0
        })
    }

    /// Gives the figure a wall of this thickness around one concentric hole; in cell sides. The figure stays solid if
    /// there is no room for a hole.
    pub fn thickness(self, wall: f64) -> Self {
        Self(Figure {
            thickness: Some(wall),
            ..self.0
        })
    }

    /// Returns the figure, after checking its values against the ranges of a sensor.
    ///
    /// # Errors
    /// Returns the error of the first value that is out of range, in the order of [`FigureKind::parameters`].
    pub fn on(self, sensor: &Sensor) -> Result<Figure, ParameterError> {
        let mut figure = self.0;
        for &parameter in figure.kind.parameters() {
            if let Some(value) = figure.get(parameter) {
                figure = figure.with(parameter, value, sensor)?;
            }
        }
        Ok(figure)
    }
}

/// Constructors for the seven kinds. Sizes are in cell sides.
impl Figure {
    /// Starts an ellipse with these radii along x and y, before rotation.
    pub fn ellipse(radius_x: f64, radius_y: f64) -> FigureBuilder {
        FigureBuilder::new(FigureKind::Ellipse, [radius_x, radius_y])
    }

    /// Starts a rectangle with these sides along x and y, before rotation.
    pub fn rectangle(length: f64, width: f64) -> FigureBuilder {
        FigureBuilder::new(FigureKind::Rectangle, [length, width])
    }

    /// Starts an equilateral triangle with this side.
    pub fn triangle(side: f64) -> FigureBuilder {
        FigureBuilder::new(FigureKind::Triangle, [side, 1.0])
    }

    /// Starts a regular pentagon with this side.
    pub fn pentagon(side: f64) -> FigureBuilder {
        FigureBuilder::new(FigureKind::Pentagon, [side, 1.0])
    }

    /// Starts a regular hexagon with this side.
    pub fn hexagon(side: f64) -> FigureBuilder {
        FigureBuilder::new(FigureKind::Hexagon, [side, 1.0])
    }

    /// Starts a regular heptagon with this side.
    pub fn heptagon(side: f64) -> FigureBuilder {
        FigureBuilder::new(FigureKind::Heptagon, [side, 1.0])
    }

    /// Starts a regular octagon with this side.
    pub fn octagon(side: f64) -> FigureBuilder {
        FigureBuilder::new(FigureKind::Octagon, [side, 1.0])
    }
}

impl Figure {
    /// Creates a figure from the values that `value` returns for the parameters of its kind, each in range on the
    /// sensor.
    ///
    /// # Errors
    /// Returns the error of the first value that is out of range or missing. Only the thickness may be missing.
    pub fn new(
        kind: FigureKind,
        sensor: &Sensor,
        mut value: impl FnMut(Parameter) -> Option<f64>,
    ) -> Result<Self, ParameterError> {
        let mut figure = FigureBuilder::new(kind, [1.0; 2]).0;
        for &parameter in kind.parameters() {
            match value(parameter) {
                Some(value) => figure = figure.with(parameter, value, sensor)?,
                None if parameter == Parameter::Thickness => {}
                None => {
                    return Err(ParameterError::Missing {
                        parameter,
                        range: sensor.range(parameter),
                    });
                }
            }
        }
        Ok(figure)
    }

    /// Returns the figure that a new form shows: solid, with every other parameter at its default. On a small sensor
    /// the figure is moved up and to the left by whole cells, so that as much of it as possible is on the sensor.
    pub fn default_of(kind: FigureKind, sensor: &Sensor) -> Self {
        let mut sizes = [1.0; 2];
        for (size, &parameter) in sizes.iter_mut().zip(kind.sizes()) {
            *size = sensor.default_value(parameter);
        }
        let at_origin = FigureBuilder::new(kind, sizes).0;
        let room = |side: u8, end: f64| (f64::from(side) - end).floor().max(0.0);
        let (right, bottom) =
            Extent::of(&at_origin).map_or((0.0, 0.0), |extent| (extent.right, extent.bottom));
        let (columns, rows) = (sensor.columns(), sensor.rows());
        Self {
            x0: sensor
                .default_value(Parameter::X0)
                .min(room(columns, right)),
            y0: sensor.default_value(Parameter::Y0).min(room(rows, bottom)),
            ..at_origin
        }
    }

    /// Returns the same figure with one parameter changed to `value`, in the parameter's unit.
    ///
    /// # Errors
    /// Returns an error if the value is out of range on the sensor, or the figure does not have the parameter.
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
        let slot = match parameter {
            Parameter::X0 => Some(&mut self.x0),
            Parameter::Y0 => Some(&mut self.y0),
            Parameter::Angle => Some(&mut self.angle),
            Parameter::Thickness => {
                self.thickness = Some(sensor.check(parameter, value)?);
                return Ok(());
            }
            _ => {
                let mut sizes = self.kind.sizes().iter().zip(&mut self.sizes);
                sizes.find_map(|(&own, size)| (own == parameter).then_some(size))
            }
        };
        let Some(slot) = slot else {
            return Err(ParameterError::Foreign {
                parameter,
                owner: self.kind.name(),
                expected: self.kind.parameters(),
            });
        };
        *slot = sensor.check(parameter, value)?;
        Ok(())
    }

    /// Returns the kind of the figure.
    pub fn kind(&self) -> FigureKind {
        self.kind
    }

    /// Returns the value of a parameter; None for one that the figure does not have, and for the thickness of a solid
    /// figure.
    pub fn get(&self, parameter: Parameter) -> Option<f64> {
        match parameter {
            Parameter::X0 => Some(self.x0),
            Parameter::Y0 => Some(self.y0),
            Parameter::Angle => Some(self.angle),
            Parameter::Thickness => self.thickness,
            _ => {
                let mut sizes = self.kind.sizes().iter().zip(self.sizes);
                sizes.find_map(|(&own, size)| (own == parameter).then_some(size))
            }
        }
    }

    /// Returns true if the figure has a hole, that is, a thickness that leaves room for one.
    pub fn has_hole(&self) -> bool {
        let mut pen = HolePen(false);
        self.draw(&mut pen);
        pen.0
    }

    /// Draws an ellipse or a rectangle; `half` is half of its width and height. Those of the hole are smaller by the
    /// wall.
    fn draw_round_or_square<T: Real>(&self, half: Point<T>, pen: &mut impl Pen<T>) {
        let centre = Point::new(T::decimal(self.x0), T::decimal(self.y0)).moved(half);
        let turn = Turn::clockwise(T::decimal(self.angle));
        let mut draw = |half: Point<T>, material: Side| {
            let [across, along] = turn.of_axes(half);
            if self.kind == FigureKind::Ellipse {
                return pen.ellipse(
                    &Ellipse {
                        centre,
                        across,
                        along,
                    },
                    material,
                );
            }
            let corner = |u: Point<T>, v: Point<T>| centre.moved(u).moved(v);
            let (back, up) = (
                Point::new(-across.x, -across.y),
                Point::new(-along.x, -along.y),
            );
            pen.ring(
                &[
                    corner(back, up),
                    corner(across, up),
                    corner(across, along),
                    corner(back, along),
                ],
                material,
            );
        };
        draw(half, Side::Inside);
        if let Some(wall) = self.thickness.map(T::decimal)
            && wall < half.x.min(half.y)
        {
            draw(Point::new(half.x - wall, half.y - wall), Side::Outside);
        }
    }

    /// Draws a regular polygon; a hole is the same polygon about the same centre, its inradius smaller by the wall.
    fn draw_regular<T: Real>(&self, corners: u8, pen: &mut impl Pen<T>) {
        let polygon = RegularPolygon::with_corners(corners);
        let half_side = T::decimal(self.sizes[0]) * T::HALF;
        let scaled = |of: Point<Double>| {
            Point::new(
                T::from_double(of.x) * half_side,
                T::from_double(of.y) * half_side,
            )
        };
        let top_left = scaled(polygon.top_left);
        let centre = Point::new(
            T::decimal(self.x0) - top_left.x,
            T::decimal(self.y0) - top_left.y,
        );
        let inradius = T::from_double(polygon.inradius) * half_side;
        let turn = Turn::clockwise(T::decimal(self.angle));
        let mut ring = [Point::new(T::ZERO, T::ZERO); MOST_CORNERS];
        let ring = &mut ring[..usize::from(corners)];
        for (slot, &corner) in ring.iter_mut().zip(&polygon.corners) {
            *slot = turn.of(scaled(corner));
        }
        let mut draw = |scale: T, material: Side| {
            let mut placed = [centre; MOST_CORNERS];
            for (to, from) in placed.iter_mut().zip(ring.iter()) {
                *to = centre.moved(Point::new(from.x * scale, from.y * scale));
            }
            pen.ring(&placed[..ring.len()], material);
        };
        draw(T::ONE, Side::Inside);
        if let Some(wall) = self.thickness.map(T::decimal)
            && wall < inradius
        {
            draw((inradius - wall) / inradius, Side::Outside);
        }
    }
}

impl Solid for Figure {
    fn draw<T: Real>(&self, pen: &mut impl Pen<T>) {
        let [first, second] = self.sizes.map(T::decimal);
        let half = Point::new(first * T::HALF, second * T::HALF);
        match (self.kind, self.kind.corners()) {
            (_, Some(corners)) => self.draw_regular(corners, pen),
            (FigureKind::Ellipse, None) => {
                self.draw_round_or_square(Point::new(first, second), pen);
            }
            (_, None) => self.draw_round_or_square(half, pen),
        }
    }
}

/// A pen that only notes whether a hole is drawn, so that [`Figure::has_hole`] agrees with the drawing.
struct HolePen(bool);

impl Pen<f64> for HolePen {
    fn edge(&mut self, _from: Point<f64>, _to: Point<f64>) {}

    fn ellipse(&mut self, _ellipse: &Ellipse<f64>, material: Side) {
        self.0 |= material == Side::Outside;
    }

    fn ring(&mut self, _points: &[Point<f64>], material: Side) {
        self.0 |= material == Side::Outside;
    }
}

impl Figure {
    /// Returns the kind and the sizes, with which the summary begins: `hexagon side 4.00`.
    pub fn kind_and_sizes(&self) -> String {
        let sizes = self.kind.sizes().iter().zip(self.sizes);
        let sizes = sizes.map(|(parameter, size)| {
            format!(" {} {}", parameter.row().short, parameter.format(size))
        });
        self.kind.name().to_owned() + &sizes.collect::<String>()
    }
}

impl fmt::Debug for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            kind,
            sizes,
            x0,
            y0,
            angle,
            thickness,
        } = self;
        f.debug_struct("Figure")
            .field("kind", kind)
            .field("sizes", &&sizes[..kind.sizes().len()])
            .field("x0", x0)
            .field("y0", y0)
            .field("angle", angle)
            .field("thickness", thickness)
            .finish()
    }
}

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.kind_and_sizes())?;
        let (x0, y0) = (Parameter::X0.format(self.x0), Parameter::Y0.format(self.y0));
        write!(
            f,
            " at {x0}, {y0}, {}°",
            Parameter::Angle.format(self.angle)
        )?;
        let Some(wall) = self.thickness else {
            return Ok(());
        };
        write!(f, ", wall {}", Parameter::Thickness.format(wall))?;
        if self.has_hole() {
            Ok(())
        } else {
            write!(f, " ({NO_ROOM})")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_negative_zero_becomes_zero() {
        let disc = Figure::ellipse(1.0, 1.0).at(-0.0, 2.0);
        let disc = disc.on(&Sensor::default()).expect("in range");
        assert_eq!(disc.get(Parameter::X0).map(f64::to_bits), Some(0));
    }

    #[test]
    fn a_new_figure_lies_on_a_sensor_of_any_size() {
        let sides = (1..=64).flat_map(|side| [(side, side), (side, 16), (16, side)]);
        for (columns, rows) in sides {
            for &kind in FigureKind::ALL {
                let sensor = Sensor::new(columns, rows).expect("in range");
                let figure = Figure::default_of(kind, &sensor);
                let extent = Extent::of(&figure).expect("it has a boundary");
                for (low, high, side) in [
                    (extent.left, extent.right, f64::from(columns)),
                    (extent.top, extent.bottom, f64::from(rows)),
                ] {
                    assert!(
                        low >= 0.0 && low + 0.5 < side,
                        "{figure} on {columns} × {rows}"
                    );
                    // If there is room, the whole figure lies on the sensor.
                    let fits = high - low <= side;
                    assert!(!fits || high <= side, "{figure} on {columns} × {rows}");
                }
            }
        }
    }

    #[test]
    fn examples_of_figure() -> Result<(), Box<dyn std::error::Error>> {
        use crate::prelude::*;
        let sensor = Sensor::default();
        let hexagon = Figure::default_of(FigureKind::Hexagon, &sensor);
        assert_eq!(
            hexagon.with(Parameter::Side, 2.5, &sensor)?,
            Figure::hexagon(2.5).at(4.0, 4.0).on(&sensor)?
        );
        let error = hexagon
            .with(Parameter::RadiusX, 2.5, &sensor)
            .expect_err("refused");
        assert_eq!(
            error.to_string(),
            "radius_x: a parameter that the hexagon does not have, expected side, x0, y0, angle or thickness"
        );
        let (square, sensor) = (Figure::rectangle(6.0, 6.0), Sensor::default());
        assert!(!square.on(&sensor)?.has_hole());
        assert!(square.thickness(2.99).on(&sensor)?.has_hole());
        assert!(!square.thickness(3.0).on(&sensor)?.has_hole());
        Ok(())
    }
}
