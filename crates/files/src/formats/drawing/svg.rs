//! A page as SVG: one element per mark, with text as text.
//!
//! Each kind of mark is a group with a class (`outline`, `cg`, `legend`, …), so that a style sheet can address it.
//! Colours are greys, and dashes and hatching distinguish the marks as well, so a drawing can be printed in black.
//! Equal subjects give equal bytes.

use crate::formats::value::{decimal, escaped};

/// A point on the page, or on the plane in cell sides.
pub(super) type Position = (f64, f64);

pub(super) const TEXT: f64 = 8.0;
/// The width of a character in a monospaced font, as a share of its size.
const ADVANCE: f64 = 0.6;
pub(super) const MARGIN: f64 = 8.0;
/// The height of a line of the title or the legend.
pub(super) const ROW: f64 = 13.0;
/// The most characters of a title; more would make the page wider than paper.
const LONGEST: usize = 100;

/// A page: its size in points, the place of the plane, and the marks.
pub(super) struct DrawingPage {
    pub(super) size: Position,
    /// The top left and the bottom right corner of the sensory plane.
    pub(super) plane: (Position, Position),
    /// The name of the drawing for those who cannot see it, as read by screen readers.
    pub(super) title: String,
    pub(super) marks: Vec<Element>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Segment {
    Move(Position),
    Line(Position),
    /// A cubic curve: its two control points and its end.
    Curve(Position, Position, Position),
    /// A straight line back to the start of the piece.
    Close,
}

impl Segment {
    pub(super) fn map(self, place: impl Fn(Position) -> Position) -> Self {
        match self {
            Self::Move(to) => Self::Move(place(to)),
            Self::Line(to) => Self::Line(place(to)),
            Self::Curve(a, b, to) => Self::Curve(place(a), place(b), place(to)),
            Self::Close => Self::Close,
        }
    }
}

pub(super) fn rectangle((left, top): Position, (right, bottom): Position) -> Vec<Segment> {
    vec![
        Segment::Move((left, top)),
        Segment::Line((right, top)),
        Segment::Line((right, bottom)),
        Segment::Line((left, bottom)),
        Segment::Close,
    ]
}

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
    pub(super) width: f64,
    /// The grey: 0 is black, 255 white.
    pub(super) grey: u8,
    /// The lengths of a dash and of the gap after it.
    pub(super) dash: Option<[f64; 2]>,
}

impl Stroke {
    pub(super) const fn black(width: f64) -> Self {
        Self {
            width,
            grey: 0,
            dash: None,
        }
    }
}

pub(super) const CELLS: Stroke = Stroke {
    width: 0.4,
    grey: 150,
    dash: None,
};

/// The point of a text that lies at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TextAnchor {
    Start,
    Middle,
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

pub(super) fn path_of(what: &'static str, steps: Vec<Segment>, line: Stroke) -> Element {
    Element::Line {
        what,
        steps,
        line,
        clipped: false,
    }
}

pub(super) fn label(text: &str, place: Position, anchor: TextAnchor) -> Element {
    Element::Text {
        text: text.to_owned(),
        place,
        anchor,
        upright: false,
    }
}

pub(super) fn upright_title(title: &str, y: f64) -> Element {
    Element::Text {
        text: title.to_owned(),
        place: (MARGIN + TEXT, y),
        anchor: TextAnchor::Middle,
        upright: true,
    }
}

pub(super) fn cut(text: &str) -> String {
    text.chars().take(LONGEST).collect()
}

#[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 characters")]
pub(super) fn width(characters: usize) -> f64 {
    TEXT * ADVANCE * characters as f64
}

pub(super) fn write(page: &DrawingPage) -> String {
    let (width, height) = (number(page.size.0), number(page.size.1));
    let title = escaped(&page.title);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}pt\" height=\"{height}pt\" \
         viewBox=\"0 0 {width} {height}\">\n\
         <title>{title}</title>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n\
         <g font-family=\"'Noto Sans Mono', 'DejaVu Sans Mono', monospace\" font-size=\"{TEXT}\" \
         stroke-linecap=\"round\" stroke-linejoin=\"round\">\n"
    );
    for mark in &page.marks {
        svg += &match mark {
            Element::Fill {
                what,
                rectangles,
                grey,
            } => {
                let steps = rectangles
                    .iter()
                    .flat_map(|&(low, high)| rectangle(low, high));
                let data = data(&steps.collect::<Vec<_>>());
                let fill = paint(*grey);
                format!("<path class=\"{what}\" fill=\"{fill}\" d=\"{data}\"/>\n")
            }
            Element::Line {
                what,
                steps,
                line,
                clipped,
            } => {
                let (stroke, data) = (stroke(*line), data(steps));
                let path = format!("<path class=\"{what}\" fill=\"none\"{stroke} d=\"{data}\"/>\n");
                if *clipped {
                    cut_off(&path, page.plane)
                } else {
                    path
                }
            }
            Element::Text {
                text,
                place,
                anchor,
                upright,
            } => text_of(text, *place, *anchor, *upright),
        };
    }
    svg + "</g>\n</svg>\n"
}

/// Clips an element to a rectangle of the page. An inner viewport needs no name, which could clash with the name in
/// another drawing on the same web page.
fn cut_off(inner: &str, ((left, top), (right, bottom)): (Position, Position)) -> String {
    let (x, y) = (number(left), number(top));
    let (width, height) = (number(right - left), number(bottom - top));
    format!(
        "<svg x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"{x} {y} {width} {height}\" overflow=\"hidden\">\n{inner}</svg>\n"
    )
}

/// Returns a text, rotated by a quarter turn counter-clockwise if it is upright. Special characters are escaped.
fn text_of(text: &str, (x, y): Position, anchor: TextAnchor, upright: bool) -> String {
    let (x, y) = (number(x), number(y));
    let anchor = match anchor {
        TextAnchor::Start => "start",
        TextAnchor::Middle => "middle",
        TextAnchor::End => "end",
    };
    let turned = if upright {
        format!(" transform=\"rotate(-90 {x} {y})\"")
    } else {
        String::new()
    };
    let text = escaped(text);
    format!("<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\"{turned}>{text}</text>\n")
}

fn data(steps: &[Segment]) -> String {
    let at = |(x, y): Position| format!("{} {}", number(x), number(y));
    let steps = steps.iter().map(|step| match step {
        Segment::Move(to) => format!("M{}", at(*to)),
        Segment::Line(to) => format!("L{}", at(*to)),
        Segment::Curve(a, b, to) => format!("C{} {} {}", at(*a), at(*b), at(*to)),
        Segment::Close => "Z".to_owned(),
    });
    steps.collect()
}

fn stroke(line: Stroke) -> String {
    let dash = line.dash.map_or(String::new(), |[dash, gap]| {
        format!(" stroke-dasharray=\"{dash} {gap}\"")
    });
    let (grey, width) = (paint(line.grey), line.width);
    format!(" stroke=\"{grey}\" stroke-width=\"{width}\"{dash}")
}

fn paint(grey: u8) -> String {
    format!("#{grey:02x}{grey:02x}{grey:02x}")
}

/// Formats a number of points; a thousandth of a point is finer than any printer.
fn number(value: f64) -> String {
    decimal(value, 3)
}
