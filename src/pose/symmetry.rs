//! The angles at which a shape looks the same.
//!
//! (x0, y0) places the corner of the figure *before* it is turned, so the centre stays where it is, and two angles give
//! the same shape when they differ by a symmetry of the figure: 180° for rectangles and ellipses, 90° for squares,
//! 360°/n for regular polygons where that is a whole number of degrees (not the heptagon's), and any angle for circles.
//! A picture that a half turn maps onto itself has 180°. Angles are compared as exact decimals.

use crate::figure::FigureKind;
use crate::parameter::Parameter;
use crate::source::Source;

/// The rotation, in degrees, after which a shape looks the same; None if it looks the same at every angle.
pub(crate) fn period(source: &Source) -> Option<u32> {
    let figure = match source {
        Source::Figure(figure) => figure,
        Source::Picture(picture) => {
            let imprint = picture.imprint();
            let half_turned = imprint.bounds().is_some_and(|bounds| {
                let turned = |column: u8, row: u8| {
                    imprint.get(
                        bounds.left + bounds.right - 1 - column,
                        bounds.top + bounds.bottom - 1 - row,
                    )
                };
                imprint.active().all(|(column, row)| turned(column, row))
            });
            return Some(if half_turned { 180 } else { 360 });
        }
    };
    let equal = |one: Parameter, other: Parameter| figure.get(one) == figure.get(other);
    match figure.kind() {
        FigureKind::Ellipse if equal(Parameter::RadiusX, Parameter::RadiusY) => None,
        FigureKind::Rectangle if equal(Parameter::Length, Parameter::Width) => Some(90),
        FigureKind::Ellipse | FigureKind::Rectangle => Some(180),
        FigureKind::Triangle => Some(120),
        FigureKind::Pentagon => Some(72),
        FigureKind::Hexagon => Some(60),
        FigureKind::Heptagon => Some(360),
        FigureKind::Octagon => Some(45),
    }
}
