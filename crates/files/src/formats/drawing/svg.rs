//! Writes a drawing as SVG: a plane with what lies on it, its axes around it, a title above and a legend below.
//! ```text
//!      title              title
//!   y +-------+           title of x
//!     |-+---+-|           y  0   1   2
//!     |-+---+-|             +---------+
//!     +-------+             |         |
//!       0   1               +---------+
//!   title of x
//!   -- legend             outside: the marks of a matrix or map, x above
//!
//!   grid: the marks of a plot, x below
//! ```
//! Lengths are points (1/72 inch), y down, from the plane's top left corner. Texts around the plane are placed next to
//! what is there already, and the page is as large as all of it plus a margin.
//!
//! Each kind of element has a class (`outline`, `cg`, `legend`, …), so that a style sheet can address it. Colours are
//! greys, and dashes and hatching distinguish the elements as well. Equal subjects give equal bytes.

use crate::formats::value::{decimal, escaped};

/// A point in points from the plane's top left corner.
pub(super) type Position = (f64, f64);

pub(super) const TEXT: f64 = 8.0;
/// The width of a character in a monospaced font, as a share of its size.
const ADVANCE: f64 = 0.6;
/// How far a text reaches below its base line.
const DESCENT: f64 = TEXT * 0.3;
/// The distance of a text from what is beside it.
const GAP: f64 = 4.0;
const MARGIN: f64 = 8.0;
/// The most characters of a title; more would make the page wider than paper.
const LONGEST: usize = 100;
/// The width of a sign of the legend.
pub(super) const SIGN: f64 = 24.0;

/// The style of a line; its ends are round.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    width: f64,
    grey: u8,
    dash: &'static str,
}

impl Stroke {
    pub(super) const fn black(width: f64) -> Self {
        Self::grey(width, 0)
    }

    /// A grey line; 0 is black, 255 white.
    pub(super) const fn grey(width: f64, grey: u8) -> Self {
        let dash = "";
        Self { width, grey, dash }
    }

    /// The same line in dashes: the lengths of a dash and of the gap after it.
    pub(super) const fn dashed(self, dash: &'static str) -> Self {
        Self { dash, ..self }
    }
}

/// Thin lines around cells.
pub(super) const CELLS: Stroke = Stroke::grey(0.4, 150);
const GRID: Stroke = Stroke::grey(0.4, 200);

/// The point of a text that lies at its place.
#[derive(Clone, Copy, Debug)]
pub(super) enum TextAnchor {
    Start,
    Middle,
    End,
}

/// The marks of the axes of a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AxisMarks {
    /// Lines across the plane; those of x have their labels below.
    Grid,
    /// Short lines outside; those of x are above, so that y runs downwards from them.
    Outside,
}

/// An axis: its marks are places in its unit, with labels.
pub(super) struct Axis {
    pub(super) title: String,
    /// Two places in the axis's unit, and where they lie on the plane.
    pub(super) ends: Position,
    pub(super) span: Position,
    pub(super) marks: Vec<(f64, String)>,
}

impl Axis {
    pub(super) fn place(&self, value: f64) -> f64 {
        let ((low, high), (from, to)) = (self.ends, self.span);
        if low == high {
            return from;
        }
        from + (value - low) / (high - low) * (to - from)
    }

    /// Whether a label is wider than the distance between marks, so that they have to be written upwards.
    fn is_crowded(&self) -> bool {
        let [one, other, ..] = &self.marks[..] else {
            return false;
        };
        let gap = (self.place(other.0) - self.place(one.0)).abs();
        self.marks.iter().any(|(_, label)| width(label) + GAP > gap)
    }
}

/// A drawing that is being written.
pub(super) struct Svg {
    elements: String,
    plane: Position,
    /// The corners of everything so far.
    low: Position,
    high: Position,
}

impl Svg {
    /// Begins a drawing on a plane of this size.
    pub(super) fn new(plane: Position) -> Self {
        Self {
            elements: String::new(),
            plane,
            low: (0.0, 0.0),
            high: plane,
        }
    }

    /// Fills a path with a grey: 0 is black, 255 white. An empty path leaves no element.
    pub(super) fn fill(&mut self, class: &str, path: &str, grey: u8) {
        if !path.is_empty() {
            let fill = paint(grey);
            self.elements += &format!("<path class=\"{class}\" fill=\"{fill}\" d=\"{path}\"/>\n");
        }
    }

    /// Draws a path as a line. An empty path leaves no element.
    pub(super) fn line(&mut self, class: &str, path: &str, stroke: Stroke) {
        if path.is_empty() {
            return;
        }
        let (paint, width) = (paint(stroke.grey), stroke.width);
        let dash = match stroke.dash {
            "" => String::new(),
            dash => format!(" stroke-dasharray=\"{dash}\""),
        };
        self.elements += &format!(
            "<path class=\"{class}\" fill=\"none\" stroke=\"{paint}\" stroke-width=\"{width}\"{dash} d=\"{path}\"/>\n"
        );
    }

    /// Draws a path as a line that is cut off at the plane's edge. An inner viewport needs no name, which could clash
    /// with the name in another drawing on the same web page.
    pub(super) fn clipped_line(&mut self, class: &str, path: &str, stroke: Stroke) {
        let (width, height) = (number(self.plane.0), number(self.plane.1));
        self.elements +=
            &format!("<svg width=\"{width}\" height=\"{height}\" overflow=\"hidden\">\n");
        self.line(class, path, stroke);
        self.elements += "</svg>\n";
    }

    /// Writes a line of text whose place lies on its base line.
    pub(super) fn text(&mut self, text: &str, place: Position, anchor: TextAnchor) {
        self.write(text, place, anchor, false);
    }

    fn write(&mut self, text: &str, (x, y): Position, anchor: TextAnchor, upwards: bool) {
        let width = width(text);
        let (anchor, before) = match anchor {
            TextAnchor::Start => ("start", 0.0),
            TextAnchor::Middle => ("middle", width / 2.0),
            TextAnchor::End => ("end", width),
        };
        if upwards {
            self.cover((x - TEXT, y + before - width), (x + DESCENT, y + before));
        } else {
            self.cover((x - before, y - TEXT), (x - before + width, y + DESCENT));
        }
        let (x, y, text) = (number(x), number(y), escaped(text));
        let turned = if upwards {
            format!(" transform=\"rotate(-90 {x} {y})\"")
        } else {
            String::new()
        };
        self.elements +=
            &format!("<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\"{turned}>{text}</text>\n");
    }

    fn cover(&mut self, low: Position, high: Position) {
        self.low = (self.low.0.min(low.0), self.low.1.min(low.1));
        self.high = (self.high.0.max(high.0), self.high.1.max(high.1));
    }

    /// The base line of a text above everything so far.
    fn above(&self) -> f64 {
        self.low.1 - GAP - DESCENT
    }

    /// The base line of a text below everything so far.
    pub(super) fn below(&self) -> f64 {
        self.high.1 + GAP + TEXT
    }

    /// Draws the frame of the plane, and its axes with their titles.
    pub(super) fn axes(&mut self, kind: AxisMarks, across: &Axis, along: &Axis) {
        let (width, height) = self.plane;
        // The ends of the lines at the marks, the base line of the labels of x, and their anchor if they run upwards.
        let (start, end, labels, anchor) = match kind {
            AxisMarks::Grid => (0.0, self.plane, height + TEXT + 3.0, TextAnchor::End),
            AxisMarks::Outside => (-3.0, (0.0, 0.0), -5.0, TextAnchor::Start),
        };
        let crowded = across.is_crowded();
        let mut lines = String::new();
        for (value, label) in &across.marks {
            let x = across.place(*value);
            lines += &line((x, start), (x, end.1));
            if crowded {
                self.write(label, (x + TEXT * 0.35, labels), anchor, true);
            } else {
                self.text(label, (x, labels), TextAnchor::Middle);
            }
        }
        for (value, label) in &along.marks {
            let y = along.place(*value);
            lines += &line((start, y), (end.0, y));
            self.text(label, (-5.0, y + TEXT * 0.35), TextAnchor::End);
        }
        let mut frame = rectangle((0.0, 0.0), self.plane);
        match kind {
            AxisMarks::Grid => self.line("grid", &lines, GRID),
            AxisMarks::Outside => frame += &lines,
        }
        self.line("axes", &frame, Stroke::black(0.6));
        let y = match kind {
            AxisMarks::Grid => self.below(),
            AxisMarks::Outside => self.above(),
        };
        self.text(&across.title, (width / 2.0, y), TextAnchor::Middle);
        let x = self.low.0 - GAP - DESCENT;
        self.write(&along.title, (x, height / 2.0), TextAnchor::Middle, true);
    }

    /// Adds a row to the legend. Returns the centre of its sign, which the caller draws.
    pub(super) fn legend(&mut self, text: &str) -> Position {
        let y = self.below();
        self.text(text, (SIGN + 6.0, y), TextAnchor::Start);
        (SIGN / 2.0, y - TEXT * 0.35)
    }

    /// Adds a row to the legend: a piece of a line, and what it means.
    pub(super) fn legend_of_line(&mut self, text: &str, stroke: Stroke) {
        let (x, y) = self.legend(text);
        let sign = line((x - SIGN / 2.0, y), (x + SIGN / 2.0, y));
        self.line("legend", &sign, stroke);
    }

    /// Ends the page like [`Self::finish`]; the title, if there is one, is the name.
    pub(super) fn finish_named(self, otherwise: &str, title: &str) -> String {
        let name = cut(if title.is_empty() { otherwise } else { title });
        self.finish(&name, title)
    }

    /// Ends the page with a title above everything, unless it is empty. `name` is what screen readers read.
    pub(super) fn finish(mut self, name: &str, title: &str) -> String {
        if !title.is_empty() {
            self.text(&cut(title), (0.0, self.above()), TextAnchor::Start);
        }
        let size = |low: f64, high: f64| number(high - low + 2.0 * MARGIN);
        let (width, height) = (size(self.low.0, self.high.0), size(self.low.1, self.high.1));
        let (x, y) = (number(MARGIN - self.low.0), number(MARGIN - self.low.1));
        let (name, elements) = (escaped(name), self.elements);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}pt\" height=\"{height}pt\" \
             viewBox=\"0 0 {width} {height}\">\n\
             <title>{name}</title>\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n\
             <g transform=\"translate({x} {y})\" \
             font-family=\"'Noto Sans Mono', 'DejaVu Sans Mono', monospace\" font-size=\"{TEXT}\" \
             stroke-linecap=\"round\" stroke-linejoin=\"round\">\n\
             {elements}</g>\n</svg>\n"
        )
    }
}

/// The first characters of a title.
pub(super) fn cut(text: &str) -> String {
    text.chars().take(LONGEST).collect()
}

#[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 characters")]
pub(super) fn width(text: &str) -> f64 {
    TEXT * ADVANCE * text.chars().count() as f64
}

/// The path of a straight line.
pub(super) fn line(from: Position, to: Position) -> String {
    polyline([from, to])
}

/// The path of a line through points.
pub(super) fn polyline(points: impl IntoIterator<Item = Position>) -> String {
    let commands = std::iter::once("M").chain(std::iter::repeat("L"));
    let points = commands.zip(points);
    points
        .map(|(command, to)| command.to_owned() + &at(to))
        .collect()
}

pub(super) fn rectangle((left, top): Position, (right, bottom): Position) -> String {
    polyline([(left, top), (right, top), (right, bottom), (left, bottom)]) + "Z"
}

pub(super) fn circle(centre: Position, radius: f64) -> String {
    ellipse(centre, (radius, 0.0), (0.0, radius))
}

/// The path of an ellipse, the image of the unit circle, from its centre and the images of the circle's two axes. It
/// has eight cubic curves, which differ from the ellipse by 4·10⁻⁶ of its size.
pub(super) fn ellipse(centre: Position, across: Position, along: Position) -> String {
    const PARTS: u8 = 8;
    let part = std::f64::consts::TAU / f64::from(PARTS);
    // The usual length of the control arms for a circle.
    let arm = 4.0 / 3.0 * libm::tan(part / 4.0);
    let image = |u: f64, v: f64| {
        at((
            centre.0 + across.0 * u + along.0 * v,
            centre.1 + across.1 * u + along.1 * v,
        ))
    };
    let mut path = format!("M{}", image(1.0, 0.0));
    for index in 0..PARTS {
        let (sin, cos) = libm::sincos(f64::from(index) * part);
        let (next_sin, next_cos) = libm::sincos(f64::from(index + 1) * part);
        path += &format!(
            "C{} {} {}",
            image(cos - arm * sin, sin + arm * cos),
            image(next_cos + arm * next_sin, next_sin - arm * next_cos),
            image(next_cos, next_sin),
        );
    }
    path + "Z"
}

fn at((x, y): Position) -> String {
    format!("{} {}", number(x), number(y))
}

fn paint(grey: u8) -> String {
    format!("#{grey:02x}{grey:02x}{grey:02x}")
}

/// Formats a number of points; a thousandth of a point is finer than any printer.
fn number(value: f64) -> String {
    decimal(value, 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curves_of_an_ellipse_stay_close_to_it() {
        // Large, so that the decimals of the path do not count.
        const RADIUS: f64 = 1e6;
        let path = circle((0.0, 0.0), RADIUS);
        let numbers = path.split(['M', 'C', 'Z', ' ']);
        let numbers: Vec<f64> = numbers.filter_map(|number| number.parse().ok()).collect();
        assert_eq!(numbers.len(), 2 + 8 * 6);
        for corners in numbers.windows(8).step_by(6) {
            for part in 0..=10 {
                let ahead = f64::from(part) / 10.0;
                let mix = |p: f64, q: f64| p + (q - p) * ahead;
                // De Casteljau's algorithm: interpolate between the corners, then between these points, then again.
                let bend = |start: usize| {
                    let [a, b, c, d] = [0, 2, 4, 6].map(|index| corners[start + index]);
                    mix(mix(mix(a, b), mix(b, c)), mix(mix(b, c), mix(c, d)))
                };
                let strays = (libm::hypot(bend(0), bend(1)) - RADIUS).abs();
                assert!(strays < RADIUS * 1e-5, "{strays}");
            }
        }
    }
}
