//! The drawings and worked values of the glossary, one block for each of its sections.
//!
//! Drawings have one character pair for a taxel. Where a line or a point lies between taxels, a drawing has twice the
//! resolution: four columns and two lines for a taxel, whose centre is in the middle.

use taxel_core::description::{DESCRIPTORS, Description, Region, regions};
use taxel_core::imprint::Imprint;
use taxel_core::sensor::Sensor;
use taxel_core::touch::Plane;
use taxel_files::formats::value;

use crate::common;
use crate::docs::{Block, document};

pub(crate) const BLOCKS: &[Block] = &[
    ("taxels", taxels),
    ("sums", sums),
    ("outline-length", outline_length),
    ("form", form),
    ("rectangle", rectangle),
    ("centres", centres),
];

/// An imprint with one region to describe.
struct Example {
    region: Region<'static>,
    described: Description,
}

impl Example {
    fn new(imprint: &Imprint) -> Self {
        let region = regions(imprint).remove(0);
        let described = Description::of(&region);
        Self { region, described }
    }

    /// The ring of the paper's Fig. 1.
    fn fig_1() -> Self {
        let text = "ellipse radius_x=4 radius_y=4 x0=1.99 y0=1.47 thickness=2";
        Self::new(&Plane::new(Sensor::default()).touch(&common::figure(text, 16)))
    }

    /// The value of a descriptor as people read it.
    fn value(&self, key: &str) -> String {
        let row = DESCRIPTORS.iter().find(|row| row.key == key);
        let row = row.expect("a descriptor");
        value::text((row.measure)(&self.described), row.dimension).unwrap_or_else(|| "–".to_owned())
    }

    /// Text with values for the keys and sides in braces.
    fn says(&self, worked: &str) -> String {
        let mut text = worked.to_owned();
        for row in DESCRIPTORS {
            text = text.replace(&format!("{{{}}}", row.key), &self.value(row.key));
        }
        let (rect, (width, height)) = (self.described.rect, self.sides());
        for (key, value) in [
            ("{left}", rect.left),
            ("{right}", rect.right),
            ("{top}", rect.top),
            ("{bottom}", rect.bottom),
            ("{width}", width),
            ("{height}", height),
        ] {
            text = text.replace(key, &value.to_string());
        }
        text
    }

    fn sides(&self) -> (u8, u8) {
        let rect = self.described.rect;
        (rect.right - rect.left, rect.bottom - rect.top)
    }

    fn active(&self, column: u8, row: u8) -> bool {
        self.region.taxels().get(column, row)
    }

    fn filled(&self, column: u8, row: u8) -> bool {
        let size = self.region.filled();
        column < size.columns() && row < size.rows() && size.get(column, row)
    }

    /// Returns true for an outline taxel: filled, with at least one of its four neighbours outside.
    fn outline(&self, x: u8, y: u8) -> bool {
        let beside = || [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)].into_iter();
        self.filled(x, y) && !beside().all(|(x, y)| self.filled(x, y))
    }

    fn canvas(&self) -> Canvas {
        let rect = self.described.rect;
        let (left, top) = (rect.left, rect.top);
        let (columns, rows) = self.sides();
        let lines = vec![vec![' '; usize::from(columns) * 4 + 1]; usize::from(rows) * 2 + 1];
        let mut canvas = Canvas { left, top, lines };
        for row in top..top + rows {
            for column in left..left + columns {
                let sign = if self.active(column, row) { '#' } else { '·' };
                canvas.at(f64::from(column) + 0.5, f64::from(row) + 0.5, sign);
            }
        }
        canvas
    }

    /// Returns the canvas with the edges of the upright rectangle.
    fn boxed(&self) -> Canvas {
        let mut canvas = self.canvas();
        let rect = self.described.rect;
        let [left, top, right, bottom] =
            [rect.left, rect.top, rect.right, rect.bottom].map(f64::from);
        for quarter in 0..=u16::from(self.sides().0) * 4 {
            let x = left + f64::from(quarter) / 4.0;
            canvas.at(x, top, '-');
            canvas.at(x, bottom, '-');
        }
        for half in 0..=u16::from(self.sides().1) * 2 {
            let y = top + f64::from(half) / 2.0;
            canvas.at(left, y, '|');
            canvas.at(right, y, '|');
        }
        for (x, y) in [(left, top), (right, top), (left, bottom), (right, bottom)] {
            canvas.at(x, y, '+');
        }
        canvas
    }
}

/// A drawing at twice the resolution, in the frame of the sensor.
struct Canvas {
    left: u8,
    top: u8,
    lines: Vec<Vec<char>>,
}

impl Canvas {
    /// Puts a character at a point of the plane.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the drawing is small"
    )]
    fn at(&mut self, x: f64, y: f64, sign: char) {
        let x = (x - f64::from(self.left)) * 4.0;
        let y = (y - f64::from(self.top)) * 2.0;
        self.lines[y.round() as usize][x.round() as usize] = sign;
    }

    fn lines(self) -> Vec<String> {
        let line = |line: Vec<char>| line.into_iter().collect::<String>().trim_end().to_owned();
        self.lines.into_iter().map(line).collect()
    }
}

/// A drawing as a block of text, followed by lines of worked values.
fn block(drawing: &[String], worked: &str) -> String {
    let drawing = drawing.join("\n");
    let drawing = drawing.trim_end().trim_start_matches('\n');
    format!("\n```text\n{drawing}\n\n{worked}\n```\n\n")
}

fn taxels() -> String {
    let ring = Example::fig_1();
    let rect = ring.described.rect;
    let drawn = |x, y| match (ring.outline(x, y), ring.active(x, y)) {
        (true, _) => "C ",
        (false, true) => "# ",
        (false, false) if ring.filled(x, y) => "o ",
        (false, false) => "· ",
    };
    let row = |y| -> String { rect.columns().map(|x| drawn(x, y)).collect() };
    let rows = rect.rows();
    let drawing: Vec<String> = rows.map(|y| row(y).trim_end().to_owned()).collect();
    let counted = |sign| drawing.concat().matches(sign).count();
    let [outline, inner, hole] = ['C', '#', 'o'].map(counted);
    let d = &ring.described;
    let found = [d.ce, d.na, d.nae].map(|count| usize::try_from(count).expect("small"));
    assert_eq!(
        [outline, outline + inner, outline + inner + hole],
        found,
        "as counted"
    );
    let worked = format!(
        "Fig. 1: NA = {{na}}\n        NAE = {{na}} + {hole} = {{nae}}\n        CE = {{ce}}"
    );
    block(&drawing, &ring.says(&worked))
}

/// The counts in each column and row, with the coordinates that they are multiplied by.
fn sums() -> String {
    let ring = Example::fig_1();
    let (rect, cg) = (ring.described.rect, ring.described.cg());
    let columns: Vec<u8> = rect.columns().collect();
    let in_column = |x: &u8| rect.rows().filter(|y| ring.active(*x, *y)).count();
    let in_row = |y: &u8| rect.columns().filter(|x| ring.active(*x, *y)).count();
    let line = |head: &str, cell: &dyn Fn(&u8) -> String, end: &str| -> String {
        let cells: String = columns.iter().map(|x| format!("{:>5}", cell(x))).collect();
        format!("{head:>5}{cells}  {end:>5}")
    };
    let mut drawing = vec![line("y  x", &|x| format!("{x}.5"), "count")];
    for y in rect.rows() {
        let sign = |x: &u8| if ring.active(*x, y) { "#" } else { "·" }.to_owned();
        let mut row = line(&format!("{y}.5"), &sign, &in_row(&y).to_string());
        if (cg.y - f64::from(y) - 0.5).abs() < 0.5 {
            let between = columns.iter().filter(|x| f64::from(**x) < cg.x).count() * 5 + 7;
            let at = row.char_indices().nth(between).expect("in the row").0;
            row.replace_range(at..=at, "G");
        }
        drawing.push(row);
    }
    drawing.push(line(
        "count",
        &|x| in_column(x).to_string(),
        &ring.value("na"),
    ));
    let terms = |counts: Vec<(u8, usize)>| {
        let terms = counts.iter().map(|(at, count)| format!("{count}·{at}.5"));
        terms.collect::<Vec<_>>().join(" + ")
    };
    let of_x = terms(columns.iter().map(|x| (*x, in_column(x))).collect());
    let of_y = terms(rect.rows().map(|y| (y, in_row(&y))).collect());
    let worked = format!(
        "Fig. 1: NumX = {of_x} = {{num_x}}\n        NumY = {of_y} = {{num_y}}\n        CG = ({{num_x}} / {{na}}, {{num_y}} / {{na}}) = ({{cg}})"
    );
    block(&drawing, &ring.says(&worked))
}

/// Draws the length of the outline step by step: neighbouring outline taxels that share the outside are joined.
fn outline_length() -> String {
    let ring = Example::fig_1();
    let mut canvas = ring.canvas();
    let mut steps = (0, 0);
    let rect = ring.described.rect;
    // Every 2 × 2 window of taxels that the outline passes through holds one step of it, if the part is thick.
    for top in rect.top - 1..rect.bottom {
        for left in rect.left - 1..rect.right {
            let window =
                [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| ring.filled(left + x, top + y));
            let (dx, dy, sign) = match window {
                [true, true, false, false] => (0.0, -0.5, '-'),
                [false, false, true, true] => (0.0, 0.5, '-'),
                [true, false, true, false] => (-0.5, 0.0, '|'),
                [false, true, false, true] => (0.5, 0.0, '|'),
                [false, true, true, true] | [true, true, true, false] => (0.0, 0.0, '/'),
                [true, false, true, true] | [true, true, false, true] => (0.0, 0.0, '\\'),
                _ => continue,
            };
            let (x, y) = (f64::from(left) + 1.0 + dx, f64::from(top) + 1.0 + dy);
            canvas.at(x, y, sign);
            if sign == '-' {
                canvas.at(x - 0.25, y, sign);
                canvas.at(x + 0.25, y, sign);
            }
            match sign {
                '-' | '|' => steps.0 += 1,
                _ => steps.1 += 1,
            }
        }
    }
    let counted = ring.described.steps;
    let counted = (counted.straight, counted.diagonal);
    assert_eq!(steps, counted, "the drawing shows what is counted");
    let worked = format!("Fig. 1: P = {} + {} · √2 = {{p}}", steps.0, steps.1);
    block(&canvas.lines(), &ring.says(&worked))
}

/// Draws two shapes with 24 taxels each, and writes their values below them.
fn form() -> String {
    let shapes = [
        "..##../.####./######/######/.####./..##..",
        "############/############",
    ];
    let shapes = shapes.map(|rows| {
        let drawn = rows.replace('#', "# ").replace('.', "· ");
        let mut lines: Vec<String> = drawn.split('/').map(str::to_owned).collect();
        lines.resize(7, String::new());
        let example = Example::new(&common::grid(rows));
        lines.push(example.says("F {f}"));
        lines.push(example.says("Round {roundness}"));
        lines
    });
    let line = |line: usize| -> String {
        let cells = shapes.iter().map(|shape| format!("{:<17}", shape[line]));
        cells.collect::<String>().trim_end().to_owned()
    };
    let drawing: Vec<String> = (0..9).map(line).collect();
    let worked = "Fig. 1: F = {p}² / {nae} = {f}\n        Round = 4π · {nae} / {p}² = {roundness}";
    block(&drawing, &Example::fig_1().says(worked))
}

/// Draws the upright rectangle with its diagonals.
fn rectangle() -> String {
    let ring = Example::fig_1();
    let mut canvas = ring.boxed();
    let rect = ring.described.rect;
    let (width, height) = ring.sides();
    assert!(width > height, "the worked ratio is width by height");
    for half in 1..u16::from(height) * 2 {
        let down = f64::from(half) / 2.0;
        let along = down * f64::from(width) / f64::from(height);
        let y = f64::from(rect.top) + down;
        canvas.at(f64::from(rect.left) + along, y, '\\');
        canvas.at(f64::from(rect.right) - along, y, '/');
    }
    let cd = ring.described.cd();
    canvas.at(cd.x, cd.y, 'D');
    let diagonals = ring.value("diagonals").replace(", ", "° and ");
    let worked = [
        "Fig. 1: Rect = x from {left} to {right}, y from {top} to {bottom}, shown as {rect}",
        "CD = (({left} + {right}) / 2, ({top} + {bottom}) / 2) = ({cd})",
        "Area = {width} · {height} = {area}",
        &format!("Diag = atan({{height}} / {{width}}) and 180° − it = {diagonals}"),
        "Ratio = {width} / {height} = {side_ratio}",
        "Fill = {na} / {area} = {filling}",
    ];
    block(&canvas.lines(), &ring.says(&worked.join("\n        ")))
}

/// Draws an imprint that is not symmetric with its two centres.
fn centres() -> String {
    let corner = "......../.##...../.##...../.##...../.######./........";
    let corner = Example::new(&common::grid(corner));
    let mut canvas = corner.boxed();
    let (cg, cd) = (corner.described.cg(), corner.described.cd());
    canvas.at(cg.x, cg.y, 'G');
    canvas.at(cd.x, cd.y, 'D');
    assert_eq!(Example::fig_1().value("cg_cd_direction"), "–");
    let drawn = "From CG ({cg}) to CD ({cd}): CG-CD = {cg_cd}, dir = {cg_cd_direction}\n";
    let ring = Example::fig_1().says("Fig. 1: CG-CD = {cg_cd}, no direction");
    block(&canvas.lines(), &(corner.says(drawn) + &ring))
}

/// The table at the top of the glossary links to a section for each key; each section has its drawing.
#[test]
fn every_descriptor_has_a_section_with_a_drawing() {
    let text = document("docs/glossary.md");
    for row in DESCRIPTORS {
        let anchor = format!("id=\"{}\"></a>", row.key);
        let mut sections = text.split("\n<a ");
        let section = sections.find(|section| section.contains(&anchor));
        let is_drawn = section.is_some_and(|section| section.contains("```text"));
        assert!(is_drawn, "no section for {} ({})", row.key, row.name);
    }
}
