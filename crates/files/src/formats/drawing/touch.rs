//! The drawing of a touch: the taxels of the plane in two greys, the lines between cells, the outline of the shape, and
//! the rectangle, CG and CD of the region described. A row of the legend tells what each of these means.

use std::collections::VecDeque;

use taxel_core::description::{Description, Region, RegionKind, Value, main_region, regions};
use taxel_core::geometry::{Ellipse, Pen, Point, Side, Solid};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::Parameter;
use taxel_core::sensor::Sensor;

use crate::formats::drawing::plot::axis_marks;
use crate::formats::drawing::svg::{
    Axis, AxisMarks, CELLS, Position, Stroke, Svg, circle, ellipse, line, polyline, rectangle,
};
use crate::formats::value;

/// The larger side of the plane, unless its cells would become too large.
const PLANE: f64 = 288.0;
/// The largest side of a cell, for small matrices.
const LARGEST_CELL: f64 = 24.0;

const DESCRIBED: u8 = 168;
const OTHER: u8 = 220;
/// The hatching of taxels of other regions: a shade alone is lost on a bad printer.
const HATCH: Stroke = Stroke::grey(0.5, 110);
const OUTLINE: Stroke = Stroke::black(1.3);
const RECTANGLE: Stroke = Stroke::black(0.9).dashed("4 2.5");
const POINT: Stroke = Stroke::black(1.1);
/// The radius of the circle at CD, and the arm of the cross at CG.
const ARM: f64 = 3.5;

/// The least pitch in mm: smaller than any atom.
const LEAST_PITCH: f64 = 1e-9;

/// A drawing of an imprint. One region is described: the main one, unless another is chosen.
#[derive(Clone, Debug)]
pub struct Drawing {
    pub(in crate::formats) imprint: Imprint,
    regions: Vec<Region<'static>>,
    /// The index of the region described, in [`regions`]; without one nothing is described.
    pub region: Option<usize>,
    /// The path of the shape's outline.
    outline: String,
    /// The side of a cell, for axes and values in mm. A value that a sensor cannot have as its pitch changes nothing,
    /// nor does one below a picometre (1e-9 mm), whose axis could not be labelled.
    pub pitch_mm: Option<f64>,
    /// What stands above; only its first 100 characters are drawn.
    pub title: String,
}

impl Drawing {
    /// Makes a drawing of the matrix with the rectangle, CG and CD of its main region, in cell sides.
    pub fn new(imprint: &Imprint) -> Self {
        let regions = regions(imprint);
        Self {
            imprint: *imprint,
            region: main_region(&regions),
            regions,
            outline: String::new(),
            pitch_mm: None,
            title: String::new(),
        }
    }

    /// Adds the outline of the solid that touched; parts beyond the sensor are cut off. Curves are drawn as cubic
    /// ones that differ from the true ellipse by less than a hundred-thousandth of its size.
    #[must_use]
    pub fn with_outline(mut self, solid: &impl Solid) -> Self {
        self.outline = outline(solid, self.cell());
        self
    }

    /// The side of a cell in points.
    fn cell(&self) -> f64 {
        let longer = self.imprint.columns().max(self.imprint.rows());
        LARGEST_CELL.min(PLANE / f64::from(longer))
    }

    /// The drawing as SVG 1.1. Equal drawings are equal texts.
    pub fn svg(&self) -> String {
        let cell = self.cell();
        let sides = [self.imprint.columns(), self.imprint.rows()].map(f64::from);
        let [width, height] = sides.map(|cells| cells * cell);
        let described = self.region.and_then(|index| self.regions.get(index));
        let description = described.map(Description::of);
        let is_pitch = |mm: &f64| Sensor::LARGEST.check(Parameter::Pitch, *mm).is_ok();
        let pitch = self
            .pitch_mm
            .filter(|mm| is_pitch(mm) && *mm >= LEAST_PITCH);
        let (unit, pitch, least) = match pitch {
            Some(pitch) => ("mm", pitch, 0.0),
            // Marks in cells stand at whole numbers only.
            None => ("cells", 1.0, 1.0),
        };
        let mut svg = Svg::new((width, height));
        self.taxels(&mut svg, described);
        let columns = (0..=self.imprint.columns()).map(|column| f64::from(column) * cell);
        let rows = (0..=self.imprint.rows()).map(|row| f64::from(row) * cell);
        let columns = columns.map(|x| line((x, 0.0), (x, height)));
        let rows = rows.map(|y| line((0.0, y), (width, y)));
        svg.line("cells", &columns.chain(rows).collect::<String>(), CELLS);
        let axis = |name: &str, cells: f64| Axis {
            title: format!("{name} / {unit}"),
            ends: (0.0, cells * pitch),
            span: (0.0, cells * cell),
            marks: axis_marks((0.0, cells * pitch), least, 8),
        };
        let [across, along] = [axis("x", sides[0]), axis("y", sides[1])];
        svg.axes(AxisMarks::Outside, &across, &along);
        if !self.outline.is_empty() {
            svg.clipped_line("outline", &self.outline, OUTLINE);
        }
        if let Some(description) = &description {
            let (rect, cg, cd) = (description.rect, description.cg(), description.cd());
            let place = |x: f64, y: f64| (x * cell, y * cell);
            let low = place(rect.left.into(), rect.top.into());
            let high = place(rect.right.into(), rect.bottom.into());
            svg.line("rectangle", &rectangle(low, high), RECTANGLE);
            svg.line("cd", &circle(place(cd.x, cd.y), ARM), POINT);
            svg.line("cg", &cross(place(cg.x, cg.y)), POINT);
        }
        self.legend_of_taxels(&mut svg, description.as_ref());
        if !self.outline.is_empty() {
            svg.legend_of_line("outline", OUTLINE);
        }
        if let Some(description) = &description {
            let text = |name: &str, value: Value| {
                let value = value::times(value, pitch, 4).unwrap_or_else(|| "–".to_owned());
                format!("{name} {value} {unit}")
            };
            let rect = Value::Rect(description.rect);
            svg.legend_of_line(&text("rectangle", rect), RECTANGLE);
            let sign = svg.legend(&text("CG", Value::Point(description.cg())));
            svg.line("legend", &cross(sign), POINT);
            let sign = svg.legend(&text("CD", Value::Point(description.cd())));
            svg.line("legend", &circle(sign, ARM), POINT);
        }
        svg.finish_named("imprint", &self.title)
    }

    /// Draws the active taxels, darker in the described region.
    fn taxels(&self, svg: &mut Svg, described: Option<&Region<'_>>) {
        let none = Imprint::empty(self.imprint.size());
        let described = described.map_or(&none, Region::taxels);
        let others = self.imprint.without(described);
        let cells = |taxels: &Imprint, of: fn(Position, Position) -> String| -> String {
            let cell = self.cell();
            let place = |column: u8, row: u8| (f64::from(column) * cell, f64::from(row) * cell);
            let taxels = taxels.active();
            taxels
                .map(|(x, y)| of(place(x, y), place(x + 1, y + 1)))
                .collect()
        };
        svg.fill("other-taxels", &cells(&others, rectangle), OTHER);
        svg.line("other-taxels", &cells(&others, hatch), HATCH);
        svg.fill("described-taxels", &cells(described, rectangle), DESCRIBED);
    }

    fn legend_of_taxels(&self, svg: &mut Svg, description: Option<&Description>) {
        let all = self.imprint.count();
        let (kind, na) = description.map_or((RegionKind::Exterior, 0), |own| (own.kind, own.na));
        let what = match kind {
            _ if description.is_none() => "no active taxels".to_owned(),
            RegionKind::Hole => format!("taxels of the hole described: {na}"),
            RegionKind::Exterior if na == all => format!("active taxels: {na}"),
            RegionKind::Exterior => format!("active taxels of the region described: {na}"),
        };
        let others = if kind == RegionKind::Hole {
            all
        } else {
            all - na
        };
        let (low, high) = sign_box(svg.legend(&what));
        if na > 0 {
            svg.fill("legend", &rectangle(low, high), DESCRIBED);
        }
        svg.line("legend", &rectangle(low, high), CELLS);
        if others > 0 {
            let (low, high) = sign_box(svg.legend(&format!("other active taxels: {others}")));
            svg.fill("legend", &rectangle(low, high), OTHER);
            svg.line("legend", &hatch(low, high), HATCH);
            svg.line("legend", &rectangle(low, high), CELLS);
        }
    }
}

/// The corners of a cell as a sign of the legend.
fn sign_box((x, y): Position) -> (Position, Position) {
    ((x - 6.0, y - 4.0), (x + 6.0, y + 4.0))
}

/// A stroke through a cell, from its lower left corner to its upper right one.
fn hatch((left, top): Position, (right, bottom): Position) -> String {
    line((left, bottom), (right, top))
}

fn cross((x, y): Position) -> String {
    line((x - ARM, y), (x + ARM, y)) + &line((x, y - ARM), (x, y + ARM))
}

/// The path of the whole boundary. Edges that follow each other form one piece, so that the corners between them are
/// drawn whole.
fn outline(solid: &impl Solid, cell: f64) -> String {
    let mut tracer = Tracer {
        cell,
        path: String::new(),
        piece: VecDeque::new(),
    };
    solid.draw(&mut tracer);
    tracer.end("");
    tracer.path
}

struct Tracer {
    cell: f64,
    path: String,
    /// The corners of the current piece. It grows at its end, or at its start if a ring is drawn backwards.
    piece: VecDeque<Position>,
}

impl Tracer {
    fn place(&self, point: Point<f64>) -> Position {
        (point.x * self.cell, point.y * self.cell)
    }

    fn end(&mut self, how: &str) {
        if !self.piece.is_empty() {
            self.path += &polyline(self.piece.drain(..));
            self.path += how;
        }
    }
}

impl Pen<f64> for Tracer {
    fn edge(&mut self, from: Point<f64>, to: Point<f64>) {
        let (from, to) = (self.place(from), self.place(to));
        let follows = self.piece.back() == Some(&from);
        let leads = self.piece.front() == Some(&to);
        match (follows, leads) {
            (true, true) => self.end("Z"),
            (true, false) => self.piece.push_back(to),
            (false, true) => self.piece.push_front(from),
            (false, false) => {
                self.end("");
                self.piece.extend([from, to]);
            }
        }
    }

    fn ellipse(&mut self, own: &Ellipse<f64>, _material: Side) {
        self.end("");
        let [centre, across, along] =
            [own.centre, own.across, own.along].map(|point| self.place(point));
        self.path += &ellipse(centre, across, along);
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
        let path = outline(&frame, 1.0);
        let count = ['M', 'L', 'Z'].map(|command| path.matches(command).count());
        assert_eq!(count, [2, 6, 2], "{path}");
    }
}
