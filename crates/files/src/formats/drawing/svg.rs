//! A page as SVG: one element per mark, with text as text.
//!
//! Each kind of mark is a group with a class (`outline`, `cg`, `legend`, …), so that a style sheet can address it.
//! Colours are greys, and dashes and hatching distinguish the marks as well, so a drawing can be printed in black.
//! Equal subjects give equal bytes.

use crate::formats::drawing::scene::{
    DrawingPage, Element, Position, Segment, Stroke, TEXT, TextAnchor, rectangle,
};
use crate::formats::value::decimal;
use crate::formats::xml::escaped;

/// Returns the content of the file.
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
            } => label(text, *place, *anchor, *upright),
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
fn label(text: &str, (x, y): Position, anchor: TextAnchor, upright: bool) -> String {
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

/// Returns the attribute `d` of a path, in points with at most three decimals.
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

/// Returns the attributes of a line.
fn stroke(line: Stroke) -> String {
    let dash = line.dash.map_or(String::new(), |[dash, gap]| {
        format!(" stroke-dasharray=\"{dash} {gap}\"")
    });
    let (grey, width) = (paint(line.grey), line.width);
    format!(" stroke=\"{grey}\" stroke-width=\"{width}\"{dash}")
}

/// Returns a grey as `#rrggbb`.
fn paint(grey: u8) -> String {
    format!("#{grey:02x}{grey:02x}{grey:02x}")
}

/// Formats a number of points; a thousandth of a point is finer than any printer.
fn number(value: f64) -> String {
    decimal(value, 3)
}
