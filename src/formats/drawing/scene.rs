//! The elements of a page: paths and texts, in points from its top left corner, y down.

/// A point of the page, or of the plane in cell sides.
pub(super) type Position = (f64, f64);

/// A piece of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Segment {
    /// Begins a new piece.
    Move(Position),
    /// A straight line.
    Line(Position),
    /// A cubic curve: two control points, the end.
    Curve(Position, Position, Position),
    /// Back to where the piece began.
    Close,
}

impl Segment {
    /// The step with each of its points moved by a function.
    pub(super) fn map(self, place: impl Fn(Position) -> Position) -> Self {
        match self {
            Self::Move(to) => Self::Move(place(to)),
            Self::Line(to) => Self::Line(place(to)),
            Self::Curve(a, b, to) => Self::Curve(place(a), place(b), place(to)),
            Self::Close => Self::Close,
        }
    }
}

/// A rectangle's path.
pub(super) fn rectangle((left, top): Position, (right, bottom): Position) -> Vec<Segment> {
    vec![
        Segment::Move((left, top)),
        Segment::Line((right, top)),
        Segment::Line((right, bottom)),
        Segment::Line((left, bottom)),
        Segment::Close,
    ]
}

/// A circle's path.
pub(super) fn circle((x, y): Position, radius: f64) -> Vec<Segment> {
    ellipse((x, y), (radius, 0.0), (0.0, radius))
}

/// The path of an ellipse, the image of the unit circle: its centre, and where the circle's two axes go. Eight cubic
/// curves, which stray from it by 4·10⁻⁶ of its size.
pub(super) fn ellipse(centre: Position, across: Position, along: Position) -> Vec<Segment> {
    const PARTS: u8 = 8;
    let part = std::f64::consts::TAU / f64::from(PARTS);
    // The usual length of a circle's control arms.
    let arm = 4.0 / 3.0 * libm::tan(part / 4.0);
    let image = |u: f64, v: f64| {
        (
            centre.0 + across.0 * u + along.0 * v,
            centre.1 + across.1 * u + along.1 * v,
        )
    };
    let mut steps = vec![Segment::Move(image(1.0, 0.0))];
    for index in 0..PARTS {
        let (sin, cos) = libm::sincos(f64::from(index) * part);
        let (next_sin, next_cos) = libm::sincos(f64::from(index + 1) * part);
        steps.push(Segment::Curve(
            image(cos - arm * sin, sin + arm * cos),
            image(next_cos + arm * next_sin, next_sin - arm * next_cos),
            image(next_cos, next_sin),
        ));
    }
    steps.push(Segment::Close);
    steps
}

/// How a line is drawn; with round ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stroke {
    /// Points.
    pub(super) width: f64,
    /// 0 black, 255 white.
    pub(super) grey: u8,
    /// Lengths of a dash and of the gap behind it.
    pub(super) dash: Option<[f64; 2]>,
}

impl Stroke {
    /// An unbroken black line.
    pub(super) const fn black(width: f64) -> Self {
        Self {
            width,
            grey: 0,
            dash: None,
        }
    }
}

/// Which point of a text stands at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TextAnchor {
    /// Where it begins.
    Start,
    /// The middle.
    Middle,
    /// Where it ends.
    End,
}

/// A thing on the page; later ones lie on earlier ones.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Element {
    /// Rectangles that do not overlap, by two corners each, filled.
    Fill {
        /// What it is, in a word.
        what: &'static str,
        rectangles: Vec<(Position, Position)>,
        /// 0 black, 255 white.
        grey: u8,
    },
    /// A path's line. A clipped one is cut off at the plane's edge.
    Line {
        /// What it is, in a word.
        what: &'static str,
        steps: Vec<Segment>,
        line: Stroke,
        clipped: bool,
    },
    /// A line of text; the place is on its base line. An upright one runs upwards.
    Text {
        text: String,
        place: Position,
        anchor: TextAnchor,
        upright: bool,
    },
}
