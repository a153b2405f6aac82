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
//! a margin. Marks are in drawing order.

use std::collections::VecDeque;

use taxel_core::description::{Description, Region, RegionKind, Value, main_region, regions};
use taxel_core::geometry::{Ellipse, Pen, Point, Side, Solid};
use taxel_core::imprint::Imprint;
use taxel_core::matrix::Matrix;
use taxel_core::parameter::Parameter;
use taxel_core::sensor::Sensor;

use crate::formats::drawing::plots::{AxisMarks, Ticks, axes, left_of};
use crate::formats::drawing::svg::{
    self, CELLS, DrawingPage, Element, MARGIN, Position, ROW, Segment, Stroke, TEXT, TextAnchor,
    circle, cut, label, path_of, rectangle, width,
};
use crate::formats::value::{self, fitting, shade};

/// The larger side of the plane, unless its cells would become too large.
const PLANE: f64 = 288.0;
/// The largest side of a cell, for small matrices.
const LARGEST_CELL: f64 = 24.0;
const SWATCH: f64 = 16.0;

const DESCRIBED: u8 = 168;
const OTHER: u8 = 220;
/// The hatching of taxels of other regions: a shade alone is lost on a bad printer.
const HATCH: Stroke = Stroke {
    width: 0.5,
    grey: 110,
    dash: None,
};
const OUTLINE: Stroke = Stroke::black(1.3);
/// The edge around active taxels when shades show values.
const EDGE: Stroke = Stroke::black(2.0);
const RECTANGLE: Stroke = Stroke {
    width: 0.9,
    grey: 0,
    dash: Some([4.0, 2.5]),
};
const POINT: Stroke = Stroke::black(1.1);

/// The least pitch in mm: smaller than any atom.
const LEAST_PITCH: f64 = 1e-9;

/// A drawing of an imprint. One region is described: the main one, unless another is chosen.
#[derive(Clone, Debug)]
pub struct Drawing {
    imprint: Imprint,
    regions: Vec<Region<'static>>,
    chosen: Option<usize>,
    /// The outline of the shape, in cell sides.
    outline: Vec<Segment>,
    pitch_mm: Option<f64>,
    title: Option<String>,
    heat: Option<Matrix<f64>>,
}

impl Drawing {
    /// Makes a drawing of the matrix with the rectangle, CG and CD of its main region, in cell sides.
    pub fn new(imprint: &Imprint) -> Self {
        let regions = regions(imprint);
        Self {
            imprint: *imprint,
            chosen: main_region(&regions),
            regions,
            outline: Vec::new(),
            pitch_mm: None,
            title: None,
            heat: None,
        }
    }

    /// Adds the outline of the solid that touched; parts beyond the sensor are cut off. Curves are drawn as cubic
    /// ones that differ from the true ellipse by less than a hundred-thousandth of its size.
    #[must_use]
    pub fn with_outline(mut self, solid: &impl Solid) -> Self {
        self.outline = steps(solid);
        self
    }

    /// Draws axes and values in mm, for cells of this side. A value that a sensor cannot have as its pitch changes
    /// nothing, nor does one below a picometre (1e-9 mm), whose axis could not be labelled.
    #[must_use]
    pub fn with_pitch(mut self, mm: f64) -> Self {
        if let Ok(mm) = Sensor::LARGEST.check(Parameter::Pitch, mm)
            && mm >= LEAST_PITCH
        {
            self.pitch_mm = Some(mm);
        }
        self
    }

    /// Adds the values of all cells as shades, white for 0 and less, black for the largest, and a bold edge around
    /// active taxels. A NaN means that there is no cell. A matrix of another size changes nothing.
    #[must_use]
    pub fn with_heat(mut self, values: &Matrix<f64>) -> Self {
        if values.size() == self.imprint.size() {
            self.heat = Some(values.clone());
        }
        self
    }

    /// Adds a title above; only its first 100 characters are kept.
    #[must_use]
    pub fn with_title(mut self, title: &str) -> Self {
        self.title = Some(cut(title));
        self
    }

    /// Describes another region, given by its index in [`regions`]; an index beyond them changes nothing.
    #[must_use]
    pub fn with_region(mut self, index: usize) -> Self {
        if index < self.regions.len() {
            self.chosen = Some(index);
        }
        self
    }

    /// The drawing as SVG 1.1. Equal drawings are equal texts.
    pub fn svg(&self) -> String {
        svg::write(&self.page())
    }

    fn described(&self) -> Option<&Region<'static>> {
        self.chosen.and_then(|index| self.regions.get(index))
    }

    fn page(&self) -> DrawingPage {
        let (columns, rows) = (self.imprint.columns(), self.imprint.rows());
        let pitch = self.pitch_mm.unwrap_or(1.0);
        // In cells, marks stand at whole numbers only.
        let least = self.pitch_mm.map_or(1.0, |_| 0.0);
        let marks = |side: u8| Ticks::new((0.0, f64::from(side) * pitch), least);
        let (across, along) = (marks(columns), marks(rows));
        let title = self.title.as_ref().map_or(0.0, |_| ROW);
        let corner = (left_of(&along), MARGIN + title + TEXT * 3.0 + 4.0);
        let mut layout = PageLayout {
            drawing: self,
            description: self.described().map(Description::of),
            marks: Vec::new(),
            corner,
            cell: LARGEST_CELL.min(PLANE / f64::from(columns.max(rows))),
            end: corner,
        };
        let plane = (corner, layout.position((columns.into(), rows.into())));
        layout.end = plane.1;
        if let Some(title) = &self.title {
            layout.text(title, (corner.0, MARGIN + TEXT), TextAnchor::Start);
        }
        layout.taxels();
        layout.cells();
        layout.axes(&across, &along, plane);
        layout.outline();
        layout.described();
        layout.legend();
        DrawingPage {
            size: (layout.end.0 + MARGIN, layout.end.1 + MARGIN),
            plane,
            title: self.title.as_deref().unwrap_or("imprint").to_owned(),
            marks: layout.marks,
        }
    }
}

struct PageLayout<'a> {
    drawing: &'a Drawing,
    description: Option<Description>,
    marks: Vec<Element>,
    corner: Position,
    cell: f64,
    /// The right and the lower end of everything so far.
    end: Position,
}

impl PageLayout<'_> {
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

    fn filled(&mut self, what: &'static str, rectangles: Vec<(Position, Position)>, grey: u8) {
        self.marks.push(Element::Fill {
            what,
            rectangles,
            grey,
        });
    }

    fn line(&mut self, what: &'static str, steps: Vec<Segment>, line: Stroke) {
        self.marks.push(path_of(what, steps, line));
    }

    /// Draws the active taxels, darker in the described region; or the values of all cells and the edge of the active
    /// ones.
    fn taxels(&mut self) {
        let drawing = self.drawing;
        let imprint = &drawing.imprint;
        if let Some(values) = &drawing.heat {
            for (grey, cells) in shades(values) {
                let cell =
                    |(x, y): Position| (self.position((x, y)), self.position((x + 1.0, y + 1.0)));
                let cells = cells.into_iter().map(cell).collect();
                self.filled("heat", cells, grey);
            }
            let edges = edges(imprint).into_iter();
            let edges = edges.map(|step| step.map(|place| self.position(place)));
            self.line("imprint", edges.collect(), EDGE);
            return;
        }
        let none = Imprint::empty(imprint.size());
        let described = drawing.described().map_or(&none, Region::taxels);
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

    fn cells(&mut self) {
        let imprint = &self.drawing.imprint;
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

    fn axes(&mut self, across: &Ticks, along: &Ticks, plane: (Position, Position)) {
        let scale = self.cell / self.drawing.pitch_mm.unwrap_or(1.0);
        let place = |(x, y): Position| (plane.0.0 + x * scale, plane.0.1 + y * scale);
        let titles = ["x", "y"].map(|axis| format!("{axis} / {}", self.unit()));
        let titles = titles.each_ref().map(String::as_str);
        let marks = axes(AxisMarks::Outside, titles, (across, along), plane, place);
        self.marks.extend(marks);
    }

    /// Draws the outline of the shape, cut off at the edge of the plane; nothing if the shape is not known.
    fn outline(&mut self) {
        let place = |place| self.position(place);
        let steps = self.drawing.outline.iter().map(|step| step.map(place));
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
        let Some(description) = &self.description else {
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

    fn unit(&self) -> &'static str {
        self.drawing.pitch_mm.map_or("cells", |_| "mm")
    }

    /// Draws the legend below the plane: the meaning of each sign, with the values of the described region.
    fn legend(&mut self) {
        let mut y = self.end.1 + ROW * 1.4;
        self.legend_of_taxels(&mut y);
        if !self.drawing.outline.is_empty() {
            self.legend_row(&mut y, "outline", |layout, place| {
                layout.line("legend", stretch(place), OUTLINE);
            });
        }
        let Some(description) = self.description else {
            return;
        };
        let (pitch, unit) = (self.drawing.pitch_mm.unwrap_or(1.0), self.unit());
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

    fn legend_of_taxels(&mut self, y: &mut f64) {
        let all = self.drawing.imprint.count();
        let described = self.description.as_ref().map(|it| (it.kind, it.na));
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
        if let Some(values) = &self.drawing.heat {
            self.legend_row(y, &legend_of_shades(values), |layout, place| {
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

fn box_of((x, y): Position) -> (Position, Position) {
    ((x - 6.0, y - 4.0), (x + 6.0, y + 4.0))
}

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

fn cross((x, y): Position, arm: f64) -> Vec<Segment> {
    vec![
        Segment::Move((x - arm, y)),
        Segment::Line((x + arm, y)),
        Segment::Move((x, y - arm)),
        Segment::Line((x, y + arm)),
    ]
}

const SHADES: u8 = 16;

/// Returns the largest value; None if no value is above 0.
fn largest(values: &Matrix<f64>) -> Option<f64> {
    let largest = values.values().iter().copied().fold(0.0, f64::max);
    (largest > 0.0).then_some(largest)
}

/// Returns each grey except white with its cells, given by their top left corners.
fn shades(values: &Matrix<f64>) -> Vec<(u8, Vec<Position>)> {
    let Some(largest) = largest(values) else {
        return Vec::new();
    };
    let mut shades = vec![Vec::new(); usize::from(SHADES)];
    for row in 0..values.rows() {
        for (column, &value) in (0..values.columns()).zip(values.row(row)) {
            let shade = shade(value / largest, shades.len());
            if shade > 0 {
                shades[shade].push((f64::from(column), f64::from(row)));
            }
        }
    }
    let grey = |shade: u8| 255 - shade * (255 / (SHADES - 1));
    let all = (0..SHADES).map(grey).zip(shades);
    all.filter(|(_, cells)| !cells.is_empty()).collect()
}

/// Returns the lines between active and inactive taxels, in cell sides.
fn edges(imprint: &Imprint) -> Vec<Segment> {
    let mut edges = Vec::new();
    let mut line = |from: (u8, u8), to: (u8, u8)| {
        let place = |(x, y): (u8, u8)| (f64::from(x), f64::from(y));
        edges.extend([Segment::Move(place(from)), Segment::Line(place(to))]);
    };
    for (x, y) in imprint.active() {
        if y == 0 || !imprint.get(x, y - 1) {
            line((x, y), (x + 1, y));
        }
        if x == 0 || !imprint.get(x - 1, y) {
            line((x, y), (x, y + 1));
        }
        if !imprint.get(x, y + 1) {
            line((x, y + 1), (x + 1, y + 1));
        }
        if !imprint.get(x + 1, y) {
            line((x + 1, y), (x + 1, y + 1));
        }
    }
    edges
}

fn legend_of_shades(values: &Matrix<f64>) -> String {
    match largest(values) {
        Some(largest) => format!("values from 0 (white) to {} (black)", fitting(largest, 9)),
        None => "no value above 0".to_owned(),
    }
}

/// Returns the whole boundary. Edges that follow each other form one piece, so that the corners between them are
/// drawn whole.
fn steps(solid: &impl Solid) -> Vec<Segment> {
    let mut tracer = Tracer::default();
    solid.draw(&mut tracer);
    tracer.end(false);
    tracer.steps
}

#[derive(Debug, Default)]
struct Tracer {
    steps: Vec<Segment>,
    /// The corners of the current piece. It grows at its end, or at its start if a ring is drawn backwards.
    piece: VecDeque<Position>,
}

impl Tracer {
    fn end(&mut self, closed: bool) {
        let mut corners = self.piece.drain(..);
        self.steps.extend(corners.next().map(Segment::Move));
        self.steps.extend(corners.map(Segment::Line));
        if closed {
            self.steps.push(Segment::Close);
        }
    }
}

impl Pen<f64> for Tracer {
    fn edge(&mut self, from: Point<f64>, to: Point<f64>) {
        let (from, to) = ((from.x, from.y), (to.x, to.y));
        let follows = self.piece.back() == Some(&from);
        let leads = self.piece.front() == Some(&to);
        match (follows, leads) {
            (true, true) => self.end(true),
            (true, false) => self.piece.push_back(to),
            (false, true) => self.piece.push_front(from),
            (false, false) => {
                self.end(false);
                self.piece.extend([from, to]);
            }
        }
    }

    /// Adds the curves of an ellipse. As a single cubic curve, a quarter of an ellipse would be off by 0.03 %; an
    /// eighth is off by far less than a printer can show.
    fn ellipse(&mut self, ellipse: &Ellipse<f64>, _material: Side) {
        let pair = |point: Point<f64>| (point.x, point.y);
        self.end(false);
        self.steps.extend(svg::ellipse(
            pair(ellipse.centre),
            pair(ellipse.across),
            pair(ellipse.along),
        ));
    }
}

#[cfg(test)]
mod tests {
    use taxel_core::figure::Figure;
    use taxel_core::sensor::Sensor;

    use super::*;

    #[test]
    fn rings_are_closed_pieces_in_either_sense() {
        let frame = Figure::rectangle(6.0, 3.0)
            .thickness(1.0)
            .on(&Sensor::default())
            .expect("in range");
        let steps = steps(&frame);
        let count = |wanted: fn(&Segment) -> bool| steps.iter().filter(|step| wanted(step)).count();
        assert_eq!(
            count(|step| matches!(step, Segment::Move(_))),
            2,
            "{steps:?}"
        );
        assert_eq!(
            count(|step| matches!(step, Segment::Line(_))),
            6,
            "{steps:?}"
        );
        assert_eq!(count(|step| matches!(step, Segment::Close)), 2, "{steps:?}");
    }

    #[test]
    fn the_curves_of_an_ellipse_stay_close_to_it() {
        let circle = svg::ellipse((1.0, 2.0), (3.0, 0.0), (0.0, 3.0));
        let mut from = (4.0, 2.0);
        for step in circle {
            let Segment::Curve(a, b, to) = step else {
                continue;
            };
            for part in 0..=10 {
                let ahead = f64::from(part) / 10.0;
                let mix = |p: f64, q: f64| p + (q - p) * ahead;
                // De Casteljau's algorithm: interpolate between the corners, then between these points, then again.
                let bend = |corners: [f64; 4]| {
                    let [start, first, second, end] = corners;
                    let middle = mix(first, second);
                    mix(
                        mix(mix(start, first), middle),
                        mix(middle, mix(second, end)),
                    )
                };
                let (x, y) = (
                    bend([from.0, a.0, b.0, to.0]),
                    bend([from.1, a.1, b.1, to.1]),
                );
                let strays = (libm::hypot(x - 1.0, y - 2.0) - 3.0).abs();
                assert!(strays < 3.0 * 1e-5, "{strays}");
            }
            from = to;
        }
    }
}
