//! The layout of a drawing: the plane with its axes, the descriptors shown on it, and the legend below.
//! ```text
//!  title
//!             x / cells
//!          0   4   8   12          the plane, its larger side 288 points, cells at most 24:
//!        0 +---------------+       taxels in two greys, lines between cells, outline,
//!  y /   4 |   ▒▒▒▒        |       rectangle, CG and CD of the region described
//!  cells 8 +---------------+
//!  ▒ active taxels: 36             a row of the legend for each of these that is there
//! ```
//! Lengths are points (1/72 inch), y down, from the page's top left corner. The page is as large as its content plus
//! a margin. Marks are in drawing order; SVG and PNG draw the same ones.

use crate::description::{Description, RegionKind, Value};
use crate::formats::drawing::axis::Ticks;
use crate::formats::drawing::heat;
use crate::formats::drawing::plane::{AxisMarks, axes, left_of};
use crate::formats::drawing::scene::{
    CELLS, DrawingPage, Element, MARGIN, Position, ROW, Segment, Stroke, TEXT, TextAnchor, circle,
    label, path_of, rectangle, width,
};
use crate::formats::value;
use crate::imprint::Imprint;
use crate::matrix::Matrix;

/// The larger side of the plane, unless its cells would become too large.
const PLANE: f64 = 288.0;
/// The largest side of a cell, for small matrices.
const LARGEST_CELL: f64 = 24.0;
/// The width of a sign in the legend.
const SWATCH: f64 = 16.0;

/// The grey of taxels of the described region.
const DESCRIBED: u8 = 168;
/// The grey of taxels of other regions.
const OTHER: u8 = 220;
/// The hatching of taxels of other regions: a shade alone is lost on a bad printer.
const HATCH: Stroke = Stroke {
    width: 0.5,
    grey: 110,
    dash: None,
};
/// The true outline of the shape.
const OUTLINE: Stroke = Stroke::black(1.3);
/// The edge around active taxels when shades show values.
const EDGE: Stroke = Stroke::black(2.0);
/// The rectangle around the region.
const RECTANGLE: Stroke = Stroke {
    width: 0.9,
    grey: 0,
    dash: Some([4.0, 2.5]),
};
/// The signs of CG and CD.
const POINT: Stroke = Stroke::black(1.1);

/// The content of a page.
pub(super) struct Subject<'a> {
    /// The active taxels.
    pub(super) imprint: &'a Imprint,
    /// The taxels of the described region, and its description.
    pub(super) described: Option<(&'a Imprint, Description)>,
    /// The outline of the shape, in cell sides.
    pub(super) outline: &'a [Segment],
    /// The side of a cell in mm; if it is given, axes and legend are in mm.
    pub(super) pitch_mm: Option<f64>,
    /// The title above the plane.
    pub(super) title: Option<&'a str>,
    /// The values of all cells, drawn as shades.
    pub(super) heat: Option<&'a Matrix<f64>>,
}

/// A page while it is being laid out.
struct PageLayout<'a> {
    /// The content of the page.
    subject: &'a Subject<'a>,
    /// The marks so far.
    marks: Vec<Element>,
    /// The top left corner of the plane.
    corner: Position,
    /// The side of a cell.
    cell: f64,
    /// The right and the lower end of everything so far.
    end: Position,
}

impl DrawingPage {
    /// Lays out a page.
    pub(super) fn of(subject: &Subject<'_>) -> Self {
        let (columns, rows) = (subject.imprint.columns(), subject.imprint.rows());
        let pitch = subject.pitch_mm.unwrap_or(1.0);
        // In cells, marks stand at whole numbers only.
        let least = subject.pitch_mm.map_or(1.0, |_| 0.0);
        let marks = |side: u8| Ticks::new((0.0, f64::from(side) * pitch), least);
        let (across, along) = (marks(columns), marks(rows));
        let title = subject.title.map_or(0.0, |_| ROW);
        let corner = (left_of(&along), MARGIN + title + TEXT * 3.0 + 4.0);
        let mut layout = PageLayout {
            subject,
            marks: Vec::new(),
            corner,
            cell: LARGEST_CELL.min(PLANE / f64::from(columns.max(rows))),
            end: corner,
        };
        let plane = (corner, layout.position((columns.into(), rows.into())));
        layout.end = plane.1;
        if let Some(title) = subject.title {
            layout.text(title, (corner.0, MARGIN + TEXT), TextAnchor::Start);
        }
        layout.taxels();
        layout.cells();
        layout.axes(&across, &along, plane);
        layout.outline();
        layout.described();
        layout.legend();
        Self {
            size: (layout.end.0 + MARGIN, layout.end.1 + MARGIN),
            plane,
            title: subject.title.unwrap_or("imprint").to_owned(),
            marks: layout.marks,
        }
    }
}

impl PageLayout<'_> {
    /// Returns the position on the page of a point of the plane, given in cell sides.
    fn position(&self, (x, y): Position) -> Position {
        (self.corner.0 + x * self.cell, self.corner.1 + y * self.cell)
    }

    /// Adds a horizontal text; if it starts at `place`, its end may widen the page.
    fn text(&mut self, text: &str, place: Position, anchor: TextAnchor) {
        if anchor == TextAnchor::Start {
            let end = place.0 + width(text.chars().count());
            self.end.0 = self.end.0.max(end);
        }
        self.marks.push(label(text, place, anchor));
    }

    /// Adds rectangles in one grey; `what` is the class of the group in SVG.
    fn filled(&mut self, what: &'static str, rectangles: Vec<(Position, Position)>, grey: u8) {
        self.marks.push(Element::Fill {
            what,
            rectangles,
            grey,
        });
    }

    /// Adds a path with a line of that width, grey and dashes.
    fn line(&mut self, what: &'static str, steps: Vec<Segment>, line: Stroke) {
        self.marks.push(path_of(what, steps, line));
    }

    /// Draws the active taxels, darker in the described region; or the values of all cells and the edge of the active
    /// ones.
    fn taxels(&mut self) {
        let subject = self.subject;
        let imprint = subject.imprint;
        if let Some(values) = subject.heat {
            for (grey, cells) in heat::shades(values) {
                let cell =
                    |(x, y): Position| (self.position((x, y)), self.position((x + 1.0, y + 1.0)));
                let cells = cells.into_iter().map(cell).collect();
                self.filled("heat", cells, grey);
            }
            let edges = heat::edges(imprint).into_iter();
            let edges = edges.map(|step| step.map(|place| self.position(place)));
            self.line("imprint", edges.collect(), EDGE);
            return;
        }
        let none = Imprint::empty(imprint.size());
        let described = subject.described.as_ref();
        let described = described.map_or(&none, |(taxels, _)| *taxels);
        let mut others = *imprint;
        for (row, taxels) in described.words().iter().enumerate() {
            others.set_word(row, imprint.words()[row] & !taxels);
        }
        for (what, taxels, grey) in [
            ("other-taxels", &others, OTHER),
            ("described-taxels", described, DESCRIBED),
        ] {
            let cell = |(column, row): (u8, u8)| {
                let (x, y) = (f64::from(column), f64::from(row));
                (self.position((x, y)), self.position((x + 1.0, y + 1.0)))
            };
            let cells: Vec<_> = taxels.active().map(cell).collect();
            if !cells.is_empty() {
                let hatch = hatch(&cells);
                self.filled(what, cells, grey);
                if grey == OTHER {
                    self.line(what, hatch, HATCH);
                }
            }
        }
    }

    /// Draws the lines between all cells.
    fn cells(&mut self) {
        let imprint = self.subject.imprint;
        let (columns, rows) = (f64::from(imprint.columns()), f64::from(imprint.rows()));
        let mut lines = Vec::new();
        for column in 0..=imprint.columns() {
            let x = f64::from(column);
            lines.push(Segment::Move(self.position((x, 0.0))));
            lines.push(Segment::Line(self.position((x, rows))));
        }
        for row in 0..=imprint.rows() {
            let y = f64::from(row);
            lines.push(Segment::Move(self.position((0.0, y))));
            lines.push(Segment::Line(self.position((columns, y))));
        }
        self.line("cells", lines, CELLS);
    }

    /// Draws the frame, and both axes with their units.
    fn axes(&mut self, across: &Ticks, along: &Ticks, plane: (Position, Position)) {
        let scale = self.cell / self.subject.pitch_mm.unwrap_or(1.0);
        let place = |(x, y): Position| (plane.0.0 + x * scale, plane.0.1 + y * scale);
        let titles = ["x", "y"].map(|axis| format!("{axis} / {}", self.unit()));
        let titles = titles.each_ref().map(String::as_str);
        let marks = axes(AxisMarks::Outside, titles, (across, along), plane, place);
        self.marks.extend(marks);
    }

    /// Draws the outline of the shape, cut off at the edge of the plane; nothing if the shape is not known.
    fn outline(&mut self) {
        let place = |place| self.position(place);
        let steps = self.subject.outline.iter().map(|step| step.map(place));
        let steps: Vec<Segment> = steps.collect();
        if !steps.is_empty() {
            self.marks.push(Element::Line {
                what: "outline",
                steps,
                line: OUTLINE,
                clipped: true,
            });
        }
    }

    /// Draws the rectangle of the described region, a circle at its CD and a cross at its CG.
    fn described(&mut self) {
        let subject = self.subject;
        let Some((_, description)) = &subject.described else {
            return;
        };
        let rect = description.rect;
        let low = self.position((rect.left.into(), rect.top.into()));
        let high = self.position((rect.right.into(), rect.bottom.into()));
        let (cg, cd) = (description.cg(), description.cd());
        self.line("rectangle", rectangle(low, high), RECTANGLE);
        let (cg, cd) = (self.position((cg.x, cg.y)), self.position((cd.x, cd.y)));
        self.line("cd", circle(cd, 3.5), POINT);
        self.line("cg", cross(cg, 3.5), POINT);
    }

    /// Returns the unit of axes and legend.
    fn unit(&self) -> &'static str {
        self.subject.pitch_mm.map_or("cells", |_| "mm")
    }

    /// Draws the legend below the plane: the meaning of each sign, with the values of the described region.
    fn legend(&mut self) {
        let mut y = self.end.1 + ROW * 1.4;
        self.legend_of_taxels(&mut y);
        if !self.subject.outline.is_empty() {
            self.legend_row(&mut y, "outline", |layout, place| {
                layout.line("legend", stretch(place), OUTLINE);
            });
        }
        let Some((_, description)) = self.subject.described else {
            return;
        };
        let (pitch, unit) = (self.subject.pitch_mm.unwrap_or(1.0), self.unit());
        let formatted =
            |value: Value| value::times(value, pitch, 4).unwrap_or_else(|| "–".to_owned());
        let rect = formatted(Value::Rect(description.rect));
        self.legend_row(
            &mut y,
            &format!("rectangle {rect} {unit}"),
            |layout, place| {
                layout.line("legend", stretch(place), RECTANGLE);
            },
        );
        let cg = formatted(Value::Point(description.cg()));
        self.legend_row(&mut y, &format!("CG {cg} {unit}"), |layout, place| {
            layout.line("legend", cross(place, 3.5), POINT);
        });
        let cd = formatted(Value::Point(description.cd()));
        self.legend_row(&mut y, &format!("CD {cd} {unit}"), |layout, place| {
            layout.line("legend", circle(place, 3.5), POINT);
        });
    }

    /// Draws the legend's first rows: the taxels of the described region, and the other active ones.
    fn legend_of_taxels(&mut self, y: &mut f64) {
        let all = self.subject.imprint.count();
        let described = self
            .subject
            .described
            .as_ref()
            .map(|(_, it)| (it.kind, it.na));
        let (what, na, others) = match described {
            Some((RegionKind::Hole, na)) => {
                (format!("taxels of the hole described: {na}"), na, all)
            }
            Some((RegionKind::Exterior, na)) if na == all => {
                (format!("active taxels: {na}"), na, 0)
            }
            Some((RegionKind::Exterior, na)) => (
                format!("active taxels of the region described: {na}"),
                na,
                all - na,
            ),
            None => ("no active taxels".to_owned(), 0, all),
        };
        if let Some(values) = self.subject.heat {
            self.legend_row(y, &heat::legend(values), |layout, place| {
                let (low, high) = box_of(place);
                let middle = f64::midpoint(low.0, high.0);
                layout.filled("legend", vec![((middle, low.1), high)], 0);
                layout.line("legend", rectangle(low, high), CELLS);
            });
            self.legend_row(y, &format!("active taxels: {all}"), |layout, place| {
                let (low, high) = box_of(place);
                layout.line("legend", rectangle(low, high), EDGE);
            });
            return;
        }
        self.legend_row(y, &what, |layout, place| {
            if na > 0 {
                layout.filled("legend", vec![box_of(place)], DESCRIBED);
            }
            let (low, high) = box_of(place);
            layout.line("legend", rectangle(low, high), CELLS);
        });
        if others > 0 {
            self.legend_row(
                y,
                &format!("other active taxels: {others}"),
                |layout, place| {
                    let (low, high) = box_of(place);
                    layout.filled("legend", vec![(low, high)], OTHER);
                    layout.line("legend", hatch(&[(low, high)]), HATCH);
                    layout.line("legend", rectangle(low, high), CELLS);
                },
            );
        }
    }

    /// Draws a row of the legend: `sign` draws at the given place, the text stands to its right. `y` moves to the
    /// next row.
    fn legend_row(&mut self, y: &mut f64, text: &str, sign: impl FnOnce(&mut Self, Position)) {
        sign(self, (self.corner.0 + SWATCH / 2.0, *y - TEXT * 0.35));
        let place = (self.corner.0 + SWATCH + 6.0, *y);
        self.text(text, place, TextAnchor::Start);
        self.end.1 = *y + TEXT * 0.3;
        *y += ROW;
    }
}

/// Returns the box of a sign in the legend.
fn box_of((x, y): Position) -> (Position, Position) {
    ((x - 6.0, y - 4.0), (x + 6.0, y + 4.0))
}

/// Returns a piece of line for the legend.
fn stretch((x, y): Position) -> Vec<Segment> {
    let half = SWATCH / 2.0;
    vec![Segment::Move((x - half, y)), Segment::Line((x + half, y))]
}

/// Returns a stroke through each cell, from its lower left corner to its upper right one.
fn hatch(cells: &[(Position, Position)]) -> Vec<Segment> {
    let stroke = |&((left, top), (right, bottom)): &(Position, Position)| {
        [Segment::Move((left, bottom)), Segment::Line((right, top))]
    };
    cells.iter().flat_map(stroke).collect()
}

/// Returns an upright cross.
fn cross((x, y): Position, arm: f64) -> Vec<Segment> {
    vec![
        Segment::Move((x - arm, y)),
        Segment::Line((x + arm, y)),
        Segment::Move((x, y - arm)),
        Segment::Line((x, y + arm)),
    ]
}
