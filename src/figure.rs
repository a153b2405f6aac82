//! The seven figures of the paper, each solid or with one concentric hole of the same kind.
//!
//! A figure is given by its sizes, by the top left corner (`x0`, `y0`) of the bounding rectangle that it has before
//! it is turned, by a clockwise angle about its centre, and by the thickness of its wall. Polygons stand on a
//! horizontal side before they are turned; their centre is that of the circumscribed circle.
//! Source: Purcaru and Niculescu; the sense of rotation and the form of the hole are conventions of this project.

use crate::geometry::{Ellipse, Extent, Pen, Point, Real, Side, Solid, Turn};
use crate::parameter::{Parameter, ParameterError};

/// What is said of a thickness that leaves no room for a hole.
pub const NO_ROOM: &str = "no room for a hole: solid";

/// The kinds of figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FigureKind {
    /// Axes along x and y before rotation; a circle where its radii are equal.
    Ellipse,
    /// Sides along x and y before rotation.
    Rectangle,
    /// Equilateral.
    Triangle,
    /// Regular.
    Pentagon,
    /// Regular.
    Hexagon,
    /// Regular.
    Heptagon,
    /// Regular.
    Octagon,
}

impl FigureKind {
    /// All seven, in the paper's order.
    pub const ALL: [Self; 7] = [
        Self::Ellipse,
        Self::Rectangle,
        Self::Triangle,
        Self::Pentagon,
        Self::Hexagon,
        Self::Heptagon,
        Self::Octagon,
    ];

    /// Its name, in files, flags and on the screen.
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

    /// The kind of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// The parameters that give its size.
    pub fn sizes(self) -> &'static [Parameter] {
        match self {
            Self::Ellipse => &[Parameter::RadiusX, Parameter::RadiusY],
            Self::Rectangle => &[Parameter::Length, Parameter::Width],
            _ => &[Parameter::Side],
        }
    }

    /// All of its parameters, in the order of forms; the last one, the thickness, may be absent.
    pub fn parameters(self) -> impl Iterator<Item = Parameter> {
        let placement = [
            Parameter::X0,
            Parameter::Y0,
            Parameter::Angle,
            Parameter::Thickness,
        ];
        self.sizes().iter().copied().chain(placement)
    }

    /// Number of corners of a regular polygon; none of an ellipse or a rectangle.
    fn corners(self) -> Option<i32> {
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

/// A figure on the sensory plane. Its values are always finite, its sizes and its thickness above 0.
///
/// ```
/// use taxel::figure::{Figure, FigureKind};
/// use taxel::parameter::Parameter;
/// let ring = Figure::new(FigureKind::Ellipse, 16, |parameter| match parameter {
///     Parameter::RadiusX | Parameter::RadiusY => Some(4.0),
///     Parameter::X0 => Some(1.99),
///     Parameter::Y0 => Some(1.47),
///     Parameter::Thickness => Some(2.0),
///     _ => Some(0.0),
/// })?;
/// assert_eq!(ring.to_string(), "ellipse rx 4.00 ry 4.00 at 1.99, 1.47, 0°, wall 2.00");
/// # Ok::<(), taxel::parameter::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    kind: FigureKind,
    /// The values of `kind.sizes()`; the second is unused where there is one only.
    sizes: [f64; 2],
    x0: f64,
    y0: f64,
    angle: f64,
    thickness: Option<f64>,
}

impl Figure {
    /// A figure for a sensor whose larger side is `side`, its values asked for one by one.
    ///
    /// # Errors
    /// The first value that is out of range, or missing (the thickness may be).
    pub fn new(
        kind: FigureKind,
        side: u8,
        mut value: impl FnMut(Parameter) -> Option<f64>,
    ) -> Result<Self, ParameterError> {
        let mut figure = Self {
            kind,
            sizes: [1.0; 2],
            x0: 0.0,
            y0: 0.0,
            angle: 0.0,
            thickness: None,
        };
        for parameter in kind.parameters() {
            match value(parameter) {
                Some(value) => figure = figure.with(parameter, value, side)?,
                None if parameter == Parameter::Thickness => {}
                None => {
                    return Err(ParameterError::Missing {
                        parameter,
                        range: parameter.range(side),
                    });
                }
            }
        }
        Ok(figure)
    }

    /// The figure that a new form shows: every parameter at its default, solid; on a sensor whose larger side is `side`,
    /// 1 to 64. On a small one it begins further up and to the left, in whole cells, so that as much as fits is there.
    pub fn default_of(kind: FigureKind, side: u8) -> Self {
        let default = |parameter: Parameter| parameter.default(side);
        let size = |index: usize| {
            kind.sizes()
                .get(index)
                .map_or(1.0, |&parameter| default(parameter))
        };
        let at_origin = Self {
            kind,
            sizes: [size(0), size(1)],
            x0: 0.0,
            y0: 0.0,
            angle: default(Parameter::Angle),
            thickness: None,
        };
        let room = |end: f64| (f64::from(side) - end).floor().max(0.0);
        let (right, bottom) =
            Extent::of(&at_origin).map_or((0.0, 0.0), |extent| (extent.right, extent.bottom));
        Self {
            x0: default(Parameter::X0).min(room(right)),
            y0: default(Parameter::Y0).min(room(bottom)),
            ..at_origin
        }
    }

    /// The same figure with one value changed; `value` in the parameter's unit. Unchanged by a parameter that it does not have,
    /// whose value is checked all the same.
    ///
    /// # Errors
    /// Where the value is out of range on a sensor whose larger side is `side`.
    pub fn with(
        mut self,
        parameter: Parameter,
        value: f64,
        side: u8,
    ) -> Result<Self, ParameterError> {
        let value = parameter.check(value, side)?;
        match parameter {
            Parameter::X0 => self.x0 = value,
            Parameter::Y0 => self.y0 = value,
            Parameter::Angle => self.angle = value,
            Parameter::Thickness => self.thickness = Some(value),
            size => {
                if let Some(index) = self.kind.sizes().iter().position(|&own| own == size) {
                    self.sizes[index] = value;
                }
            }
        }
        Ok(self)
    }

    /// Which kind of figure it is.
    pub fn kind(&self) -> FigureKind {
        self.kind
    }

    /// One of its values; none of a parameter that it does not have, and of the thickness of a solid figure.
    pub fn get(&self, parameter: Parameter) -> Option<f64> {
        match parameter {
            Parameter::X0 => Some(self.x0),
            Parameter::Y0 => Some(self.y0),
            Parameter::Angle => Some(self.angle),
            Parameter::Thickness => self.thickness,
            size => self
                .kind
                .sizes()
                .iter()
                .position(|&own| own == size)
                .map(|index| self.sizes[index]),
        }
    }

    /// Whether it has a hole: it has a thickness, and that leaves room for one.
    ///
    /// ```
    /// use taxel::figure::{Figure, FigureKind};
    /// use taxel::parameter::Parameter;
    /// let square = Figure::default_of(FigureKind::Rectangle, 16).with(Parameter::Width, 6.0, 16)?;
    /// assert!(!square.has_hole());
    /// assert!(square.with(Parameter::Thickness, 2.99, 16)?.has_hole());
    /// assert!(!square.with(Parameter::Thickness, 3.0, 16)?.has_hole());
    /// # Ok::<(), taxel::parameter::ParameterError>(())
    /// ```
    pub fn has_hole(&self) -> bool {
        let mut pen = HolePen(false);
        self.draw(&mut pen);
        pen.0
    }

    /// Draws an ellipse or a rectangle, given half of its extent, about the centre; a hole is smaller by the wall.
    fn draw_round_or_square<T: Real>(&self, half: Point<T>, pen: &mut impl Pen<T>) {
        let centre = Point::new(T::decimal(self.x0), T::decimal(self.y0)).moved(half);
        let turn = Turn::clockwise(T::decimal(self.angle));
        let mut draw = |half: Point<T>, material: Side| {
            let across = turn.of(Point::new(half.x, T::ZERO));
            let along = turn.of(Point::new(T::ZERO, half.y));
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
    fn draw_regular<T: Real>(&self, corners: i32, pen: &mut impl Pen<T>) {
        let (sin, cos) = (T::whole(180) / T::whole(corners)).sin_cos_degrees();
        let half_side = T::decimal(self.sizes[0]) * T::HALF;
        let inradius = half_side * cos / sin;
        // From the middle of the bottom side: half a side to the left, then a corner after another, clockwise.
        let mut ring = [Point::new(T::ZERO, T::ZERO); 8];
        let ring = &mut ring[..usize::try_from(corners).unwrap_or(0)];
        let (step_sin, step_cos) = (T::whole(2) * sin * cos, T::ONE - T::whole(2) * sin * sin);
        let mut corner = Point::new(-half_side, inradius);
        let (mut left, mut top) = (corner.x, corner.y);
        for slot in ring.iter_mut() {
            *slot = corner;
            (left, top) = (left.min(corner.x), top.min(corner.y));
            corner = Point::new(
                corner.x * step_cos - corner.y * step_sin,
                corner.x * step_sin + corner.y * step_cos,
            );
        }
        let centre = Point::new(T::decimal(self.x0) - left, T::decimal(self.y0) - top);
        let turn = Turn::clockwise(T::decimal(self.angle));
        for slot in ring.iter_mut() {
            *slot = turn.of(*slot);
        }
        let mut draw = |scale: T, material: Side| {
            let mut placed = [centre; 8];
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
                self.draw_round_or_square(Point::new(first, second), pen)
            }
            (_, None) => self.draw_round_or_square(half, pen),
        }
    }
}

/// Draws nothing and remembers whether there was a hole: so the rule for one is that of drawing.
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

impl std::fmt::Display for Figure {
    /// What made the imprint, in one line.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.kind.name())?;
        for (&parameter, size) in self.kind.sizes().iter().zip(self.sizes) {
            write!(f, " {} {}", parameter.row().short, parameter.format(size))?;
        }
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
    fn a_new_figure_lies_on_the_sensor_whatever_its_size() {
        for side in 0..=64 {
            for kind in FigureKind::ALL {
                let figure = Figure::default_of(kind, side);
                let extent = Extent::of(&figure).expect("it has a boundary");
                let side = f64::from(side.max(1));
                assert!(extent.left >= 0.0 && extent.left + 0.5 < side, "{figure}");
                assert!(extent.top >= 0.0 && extent.top + 0.5 < side, "{figure}");
                // Wholly, wherever there is room for it.
                let fits = extent.right - extent.left <= side && extent.bottom - extent.top <= side;
                assert!(!fits || extent.right.max(extent.bottom) <= side, "{figure}");
            }
        }
    }
}
