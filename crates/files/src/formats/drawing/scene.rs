//! A page and its elements, paths and texts: in points from its top left corner, y down.

/// A point on the page, or on the plane in cell sides.
pub(super) type Position = (f64, f64);

/// The size of all text, in points.
pub(super) const TEXT: f64 = 8.0;
/// The width of a character in a monospaced font, as a share of its size.
const ADVANCE: f64 = 0.6;
/// The margin on all sides.
pub(super) const MARGIN: f64 = 8.0;
/// The height of a line of the title or the legend.
pub(super) const ROW: f64 = 13.0;
/// The most characters of a title; more would make the page wider than paper.
const LONGEST: usize = 100;

/// A page: its size in points, the place of the plane, and the marks.
pub(super) struct DrawingPage {
    /// The width and the height.
    pub(super) size: Position,
    /// The top left and the bottom right corner of the sensory plane.
    pub(super) plane: (Position, Position),
    /// The name of the drawing for those who cannot see it, as read by screen readers.
    pub(super) title: String,
    /// The marks, in drawing order.
    pub(super) marks: Vec<Element>,
}

/// A step of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Segment {
    /// Begins a new piece at a point.
    Move(Position),
    /// A straight line to a point.
    Line(Position),
    /// A cubic curve: its two control points and its end.
    Curve(Position, Position, Position),
    /// A straight line back to the start of the piece.
    Close,
}

impl Segment {
    /// Returns the step with each of its points mapped by a function.
    pub(super) fn map(self, place: impl Fn(Position) -> Position) -> Self {
        match self {
            Self::Move(to) => Self::Move(place(to)),
            Self::Line(to) => Self::Line(place(to)),
            Self::Curve(a, b, to) => Self::Curve(place(a), place(b), place(to)),
            Self::Close => Self::Close,
        }
    }
}

/// Returns the path of a rectangle.
pub(super) fn rectangle((left, top): Position, (right, bottom): Position) -> Vec<Segment> {
    vec![
        Segment::Move((left, top)),
        Segment::Line((right, top)),
        Segment::Line((right, bottom)),
        Segment::Line((left, bottom)),
        Segment::Close,
    ]
}

/// Returns the path of a circle.
pub(super) fn circle((x, y): Position, radius: f64) -> Vec<Segment> {
    ellipse((x, y), (radius, 0.0), (0.0, radius))
}

/// Returns the path of an ellipse, the image of the unit circle, from its centre and the images of the circle's two
/// axes. It has eight cubic curves, which differ from the ellipse by 4·10⁻⁶ of its size.
pub(super) fn ellipse(centre: Position, across: Position, along: Position) -> Vec<Segment> {
    const PARTS: u8 = 8;
    let part = std::f64::consts::TAU / f64::from(PARTS);
    // The usual length of the control arms for a circle.
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

/// The style of a line; its ends are round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stroke {
    /// The width in points.
    pub(super) width: f64,
    /// The grey: 0 is black, 255 white.
    pub(super) grey: u8,
    /// The lengths of a dash and of the gap after it.
    pub(super) dash: Option<[f64; 2]>,
}

impl Stroke {
    /// Returns the stroke of an unbroken black line.
    pub(super) const fn black(width: f64) -> Self {
        Self {
            width,
            grey: 0,
            dash: None,
        }
    }
}

/// The lines between cells.
pub(super) const CELLS: Stroke = Stroke {
    width: 0.4,
    grey: 150,
    dash: None,
};

/// The point of a text that lies at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TextAnchor {
    /// The start of the text.
    Start,
    /// The middle of the text.
    Middle,
    /// The end of the text.
    End,
}

/// An element of the page; later ones lie on top of earlier ones.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Element {
    /// Filled rectangles that do not overlap, each given by two corners.
    Fill {
        /// The kind of element in a word; the class in SVG.
        what: &'static str,
        rectangles: Vec<(Position, Position)>,
        /// The grey: 0 is black, 255 white.
        grey: u8,
    },
    /// A path that is drawn as a line. A clipped one is cut off at the plane's edge.
    Line {
        /// The kind of element in a word; the class in SVG.
        what: &'static str,
        steps: Vec<Segment>,
        line: Stroke,
        clipped: bool,
    },
    /// A line of text whose place lies on its base line. An upright one runs upwards.
    Text {
        text: String,
        place: Position,
        anchor: TextAnchor,
        upright: bool,
    },
}

/// Makes a line on the page; `what` is the kind of line.
pub(super) fn path_of(what: &'static str, steps: Vec<Segment>, line: Stroke) -> Element {
    Element::Line {
        what,
        steps,
        line,
        clipped: false,
    }
}

/// Makes a text on the page.
pub(super) fn label(text: &str, place: Position, anchor: TextAnchor) -> Element {
    Element::Text {
        text: text.to_owned(),
        place,
        anchor,
        upright: false,
    }
}

/// Makes the title of the upright axis; `y` is the middle of the axis.
pub(super) fn upright_title(title: &str, y: f64) -> Element {
    Element::Text {
        text: title.to_owned(),
        place: (MARGIN + TEXT, y),
        anchor: TextAnchor::Middle,
        upright: true,
    }
}

/// Returns as much of a text as fits onto a page.
pub(super) fn cut(text: &str) -> String {
    text.chars().take(LONGEST).collect()
}

/// Returns the width of a text of that many characters.
#[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 characters")]
pub(super) fn width(characters: usize) -> f64 {
    TEXT * ADVANCE * characters as f64
}
