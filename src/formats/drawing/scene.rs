//! What a page is made of: paths and texts, in points from its top left corner, y down.

/// A point of the page, or of the plane in cell sides.
pub(super) type Place = (f64, f64);

/// A piece of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    /// Begins a new piece.
    Move(Place),
    /// A straight line.
    Line(Place),
    /// A cubic curve: two control points, the end.
    Curve(Place, Place, Place),
    /// Back to where the piece began.
    Close,
}

impl Step {
    /// The step with each of its points moved by a function.
    pub(super) fn map(self, place: impl Fn(Place) -> Place) -> Self {
        match self {
            Self::Move(to) => Self::Move(place(to)),
            Self::Line(to) => Self::Line(place(to)),
            Self::Curve(a, b, to) => Self::Curve(place(a), place(b), place(to)),
            Self::Close => Self::Close,
        }
    }
}

/// A rectangle's path.
pub(super) fn rectangle((left, top): Place, (right, bottom): Place) -> Vec<Step> {
    vec![
        Step::Move((left, top)),
        Step::Line((right, top)),
        Step::Line((right, bottom)),
        Step::Line((left, bottom)),
        Step::Close,
    ]
}

/// A circle's path.
pub(super) fn circle((x, y): Place, radius: f64) -> Vec<Step> {
    ellipse((x, y), (radius, 0.0), (0.0, radius))
}

/// The path of an ellipse, the image of the unit circle: its centre, and where the circle's two axes go. Eight cubic
/// curves, which stray from it by 4·10⁻⁶ of its size.
pub(super) fn ellipse(centre: Place, across: Place, along: Place) -> Vec<Step> {
    const PARTS: u8 = 8;
    let part = std::f64::consts::TAU / f64::from(PARTS);
    // The usual length of a circle's control arms.
    let arm = 4.0 / 3.0 * (part / 4.0).tan();
    let image = |u: f64, v: f64| {
        (
            centre.0 + across.0 * u + along.0 * v,
            centre.1 + across.1 * u + along.1 * v,
        )
    };
    let mut steps = vec![Step::Move(image(1.0, 0.0))];
    for index in 0..PARTS {
        let (sin, cos) = (f64::from(index) * part).sin_cos();
        let (next_sin, next_cos) = (f64::from(index + 1) * part).sin_cos();
        steps.push(Step::Curve(
            image(cos - arm * sin, sin + arm * cos),
            image(next_cos + arm * next_sin, next_sin - arm * next_cos),
            image(next_cos, next_sin),
        ));
    }
    steps.push(Step::Close);
    steps
}

/// How a line is drawn; with round ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    /// Points.
    pub(super) width: f64,
    /// 0 black, 255 white.
    pub(super) grey: u8,
    /// Lengths of a dash and of the gap behind it.
    pub(super) dash: Option<[f64; 2]>,
}

impl Line {
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
pub(super) enum Anchor {
    /// Where it begins.
    Start,
    /// The middle.
    Middle,
    /// Where it ends.
    End,
}

/// A thing on the page; later ones lie on earlier ones.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Mark {
    /// Rectangles that do not overlap, by two corners each, filled.
    Fill {
        /// What it is, in a word.
        what: &'static str,
        rectangles: Vec<(Place, Place)>,
        /// 0 black, 255 white.
        grey: u8,
    },
    /// A path's line. A clipped one is cut off at the plane's edge.
    Line {
        /// What it is, in a word.
        what: &'static str,
        steps: Vec<Step>,
        line: Line,
        clipped: bool,
    },
    /// A line of text; the place is on its base line. An upright one runs upwards.
    Text {
        text: String,
        place: Place,
        anchor: Anchor,
        upright: bool,
    },
}
