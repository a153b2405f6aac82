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
use crate::values::Values;

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

/// All that tells the kinds apart; forms, files, flags and checks follow from it.
struct Kind {
    /// The sizes, then position, angle and thickness.
    parameters: &'static [Parameter],
    /// 0 for an ellipse.
    corners: u8,
}

/// The kinds in the order of [`FigureKind`].
const KINDS: [Kind; 7] = {
    use Parameter::{Angle, Length, RadiusX, RadiusY, Side, Thickness, Width, X0, Y0};
    const fn regular(corners: u8) -> Kind {
        Kind {
            parameters: &[Side, X0, Y0, Angle, Thickness],
            corners,
        }
    }
    [
        Kind {
            parameters: &[RadiusX, RadiusY, X0, Y0, Angle, Thickness],
            corners: 0,
        },
        Kind {
            parameters: &[Length, Width, X0, Y0, Angle, Thickness],
            corners: 4,
        },
        regular(3),
        regular(5),
        regular(6),
        regular(7),
        regular(8),
    ]
};

impl FigureKind {
    fn row(self) -> &'static Kind {
        &KINDS[self as usize]
    }

    /// Returns the names of all kinds, in the same order.
    pub fn names() -> Vec<&'static str> {
        Self::ALL.iter().map(|kind| kind.name()).collect()
    }

    /// Returns the parameters of the kind in the order of forms: sizes, position, angle, thickness. A figure may lack
    /// the thickness.
    pub fn parameters(self) -> &'static [Parameter] {
        self.row().parameters
    }

    /// Returns the one or two parameters that give the figure's size.
    pub fn sizes(self) -> &'static [Parameter] {
        let own = self.parameters();
        &own[..own.len() - 4]
    }
}

named!(
    FigureKind,
    "figure",
    [
        Ellipse "ellipse",
        Rectangle "rectangle",
        Triangle "triangle",
        Pentagon "pentagon",
        Hexagon "hexagon",
        Heptagon "heptagon",
        Octagon "octagon",
    ]
);

/// A figure on the sensory plane. Its values are always finite, and its sizes and its thickness are above 0.
///
/// A constructor for each kind starts a [`FigureBuilder`]; the sensor that the figure is placed on checks its values.
///
/// ```
/// use taxel_core::prelude::*;
/// let sensor = Sensor::default();
/// let ring = Figure::ellipse(4.0, 4.0).at(1.99, 1.47).thickness(2.0).on(&sensor)?;
/// assert_eq!(ring.to_string(), "ellipse rx 4.00 ry 4.00 at 1.99, 1.47, 0°, thickness 2.00");
///
/// let error = Figure::hexagon(16.5).on(&sensor).unwrap_err();
/// assert_eq!(error.to_string(), "side: 16.5 is above 16 (allowed: above 0, up to 16)");
/// # Ok::<(), ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    kind: FigureKind,
    pub(crate) values: Values,
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
        use Parameter::{Angle, X0, Y0};
        let mut values = Values::unchecked([(X0, 0.0), (Y0, 0.0), (Angle, 0.0)]);
        for (&parameter, size) in kind.sizes().iter().zip(sizes) {
            values.put(parameter, size);
        }
        Self(Figure { kind, values })
    }

    fn with(mut self, parameter: Parameter, value: f64) -> Self {
        self.0.values.put(parameter, value);
        self
    }

    /// Places the top left corner of the bounding rectangle before rotation; in cell sides.
    pub fn at(self, x0: f64, y0: f64) -> Self {
        self.with(Parameter::X0, x0).with(Parameter::Y0, y0)
    }

    /// Turns the figure about its centre, clockwise as seen; in degrees, from 0 to below 360.
    pub fn angle(self, degrees: f64) -> Self {
        self.with(Parameter::Angle, degrees)
    }

    /// Gives the figure a wall of this thickness around one concentric hole; in cell sides. The figure stays solid if
    /// there is no room for a hole.
    pub fn thickness(self, thickness: f64) -> Self {
        self.with(Parameter::Thickness, thickness)
    }

    /// Returns the figure, after checking its values against the ranges of a sensor.
    ///
    /// # Errors
    /// Returns the error of the first value that is out of range, in the order of [`FigureKind::parameters`].
    pub fn on(self, sensor: &Sensor) -> Result<Figure, ParameterError> {
        Figure::new(self.0.kind, sensor, |parameter| self.0.get(parameter))
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
        FigureBuilder::new(FigureKind::Triangle, [side; 2])
    }

    /// Starts a regular pentagon with this side.
    pub fn pentagon(side: f64) -> FigureBuilder {
        FigureBuilder::new(FigureKind::Pentagon, [side; 2])
    }

    /// Starts a regular hexagon with this side.
    pub fn hexagon(side: f64) -> FigureBuilder {
        FigureBuilder::new(FigureKind::Hexagon, [side; 2])
    }

    /// Starts a regular heptagon with this side.
    pub fn heptagon(side: f64) -> FigureBuilder {
        FigureBuilder::new(FigureKind::Heptagon, [side; 2])
    }

    /// Starts a regular octagon with this side.
    pub fn octagon(side: f64) -> FigureBuilder {
        FigureBuilder::new(FigureKind::Octagon, [side; 2])
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
        value: impl FnMut(Parameter) -> Option<f64>,
    ) -> Result<Self, ParameterError> {
        let values = Values::new(kind.parameters(), sensor, value)?;
        Ok(Self { kind, values })
    }

    /// Returns the figure that a new form shows: solid, with every other parameter at its default. On a small sensor
    /// the figure is moved up and to the left by whole cells, so that as much of it as possible is on the sensor.
    pub fn default_of(kind: FigureKind, sensor: &Sensor) -> Self {
        let mut builder = FigureBuilder::new(kind, [1.0; 2]);
        for &parameter in kind.sizes() {
            builder = builder.with(parameter, sensor.default_value(parameter));
        }
        let ends = Extent::of(&builder.0).map_or([0.0; 2], |extent| [extent.right, extent.bottom]);
        let place = |parameter: Parameter, side: u8, end: f64| {
            let room = (f64::from(side) - end).floor().max(0.0);
            sensor.default_value(parameter).min(room)
        };
        let x0 = place(Parameter::X0, sensor.columns(), ends[0]);
        let y0 = place(Parameter::Y0, sensor.rows(), ends[1]);
        builder.at(x0, y0).0
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
        let (owner, own) = (self.kind.name(), self.kind.parameters());
        let value = sensor.check_own(owner, own, parameter, value)?;
        self.values.put(parameter, value);
        Ok(self)
    }

    /// Returns the kind of the figure.
    pub fn kind(&self) -> FigureKind {
        self.kind
    }

    /// Returns the value of a parameter; None for one that the figure does not have, and for the thickness of a solid
    /// figure.
    pub fn get(&self, parameter: Parameter) -> Option<f64> {
        self.values.get(parameter)
    }

    /// The values of `kind.sizes()`; the second is that of the first if there is only one.
    pub(crate) fn sizes(&self) -> [f64; 2] {
        let sizes = self.kind.sizes();
        [sizes[0], sizes[sizes.len() - 1]].map(|size| self.values.of(size))
    }

    /// The number of rotations within a full turn that map the figure onto itself; None if all do.
    pub(crate) fn rotations(&self) -> Option<u32> {
        let [one, other] = self.sizes();
        match self.kind.row().corners {
            _ if one != other => Some(2),
            0 => None,
            corners => Some(corners.into()),
        }
    }

    /// The sides of the bounding rectangle before rotation; None for a regular polygon, whose sides are no decimals.
    pub(crate) fn box_sides(&self) -> Option<[f64; 2]> {
        match self.kind.row().corners {
            0 => Some(self.sizes().map(|radius| 2.0 * radius)),
            4 => Some(self.sizes()),
            _ => None,
        }
    }

    /// Returns true if the figure has a hole, that is, a thickness that leaves room for one.
    pub fn has_hole(&self) -> bool {
        self.hole(self.sizes()).is_some()
    }

    /// The thickness of a figure of these sizes, if it leaves room for a hole, and the least thickness that does not.
    fn hole<T: Real>(&self, [one, other]: [T; 2]) -> Option<(T, T)> {
        let thickness = T::decimal(self.get(Parameter::Thickness)?);
        let most = match self.kind.row().corners {
            0 => one.min(other),
            4 => one.min(other) * T::HALF,
            corners => {
                T::from_double(RegularPolygon::with_corners(corners).inradius) * (one * T::HALF)
            }
        };
        (thickness < most).then_some((thickness, most))
    }

    /// Draws an ellipse or a rectangle. Half of its width and height are smaller by the thickness in the hole.
    fn draw_in_box<T: Real>(&self, [x0, y0, angle]: [T; 3], pen: &mut impl Pen<T>) {
        let sizes = self.sizes().map(T::decimal);
        let round = self.kind == FigureKind::Ellipse;
        let [half_width, half_height] = sizes.map(|size| if round { size } else { size * T::HALF });
        let half = Point::new(half_width, half_height);
        let centre = Point::new(x0, y0).moved(half);
        let turn = Turn::clockwise(angle);
        let mut draw = |half: Point<T>, material: Side| {
            let [across, along] = turn.of_axes(half);
            if round {
                let ellipse = Ellipse {
                    centre,
                    across,
                    along,
                };
                return pen.ellipse(&ellipse, material);
            }
            let corner = |u: Point<T>, v: Point<T>| centre.moved(u).moved(v);
            let back = Point::new(-across.x, -across.y);
            let up = Point::new(-along.x, -along.y);
            let (top_left, top_right) = (corner(back, up), corner(across, up));
            let (bottom_right, bottom_left) = (corner(across, along), corner(back, along));
            pen.ring(&[top_left, top_right, bottom_right, bottom_left], material);
        };
        draw(half, Side::Inside);
        if let Some((thickness, _)) = self.hole(sizes) {
            let inner = Point::new(half.x - thickness, half.y - thickness);
            draw(inner, Side::Outside);
        }
    }

    /// Draws a regular polygon; a hole is the same polygon about the same centre, its inradius smaller by the
    /// thickness.
    fn draw_regular<T: Real>(&self, corners: u8, [x0, y0, angle]: [T; 3], pen: &mut impl Pen<T>) {
        let polygon = RegularPolygon::with_corners(corners);
        let side = T::decimal(self.sizes()[0]);
        let half_side = side * T::HALF;
        let scaled = |of: Point<Double>| {
            Point::new(
                T::from_double(of.x) * half_side,
                T::from_double(of.y) * half_side,
            )
        };
        let top_left = scaled(polygon.top_left);
        let centre = Point::new(x0 - top_left.x, y0 - top_left.y);
        let turn = Turn::clockwise(angle);
        let mut ring = [centre; MOST_CORNERS];
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
        if let Some((thickness, inradius)) = self.hole([side; 2]) {
            draw((inradius - thickness) / inradius, Side::Outside);
        }
    }

    /// Returns the kind and the sizes, with which the summary begins: `hexagon side 4.00`.
    pub fn kind_and_sizes(&self) -> String {
        let sizes = self.kind.sizes().iter().map(|&size| {
            let value = size.format(self.values.of(size));
            format!(" {} {value}", size.row().short)
        });
        self.kind.name().to_owned() + &sizes.collect::<String>()
    }
}

impl Solid for Figure {
    fn draw<T: Real>(&self, pen: &mut impl Pen<T>) {
        use Parameter::{Angle, X0, Y0};
        let place = [X0, Y0, Angle].map(|parameter| T::decimal(self.values.of(parameter)));
        match self.kind.row().corners {
            0 | 4 => self.draw_in_box(place, pen),
            corners => self.draw_regular(corners, place, pen),
        }
    }
}

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use Parameter::{Angle, Thickness, X0, Y0};
        let [x0, y0, angle] = [X0, Y0, Angle].map(|own| own.format(self.values.of(own)));
        write!(f, "{} at {x0}, {y0}, {angle}°", self.kind_and_sizes())?;
        let Some(thickness) = self.get(Thickness) else {
            return Ok(());
        };
        write!(f, ", thickness {}", Thickness.format(thickness))?;
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
    fn a_figure_has_the_parameters_of_its_kind_and_a_hole_only_if_there_is_room()
    -> Result<(), Box<dyn std::error::Error>> {
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
