//! The drawings and worked values of the glossary, one block for each descriptor.
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

/// The block of every descriptor, by the descriptor's key.
pub(crate) const BLOCKS: &[Block] = &[
    ("na", || {
        let ring = Example::fig_1();
        block(&ring.taxels(|_, _| None), &ring.says("NA = {na}"))
    }),
    ("nae", || {
        let ring = Example::fig_1();
        let drawing = ring.taxels(|x, y| (ring.filled(x, y) && !ring.active(x, y)).then_some('o'));
        let hole = ring.described.nae - ring.described.na;
        block(
            &drawing,
            &ring.says(&format!("NAE = {{na}} + {hole} = {{nae}}")),
        )
    }),
    ("ce", || {
        let ring = Example::fig_1();
        let drawing = ring.taxels(|x, y| ring.outline(x, y).then_some('C'));
        let drawn = drawing.concat().matches('C').count().to_string();
        assert_eq!(drawn, ring.value("ce"), "the drawing shows what is counted");
        block(&drawing, &ring.says("CE = {ce}"))
    }),
    ("num_x", num_x),
    ("num_y", num_y),
    ("cg", || {
        let ring = Example::fig_1();
        let mut canvas = ring.canvas();
        let cg = ring.described.cg();
        canvas.at(cg.x, cg.y, 'G');
        let worked = "CG = ({num_x} / {na}, {num_y} / {na}) = ({cg})";
        block(&canvas.lines(), &ring.says(worked))
    }),
    ("p", p),
    ("f", || {
        block(
            &compared("f"),
            &Example::fig_1().says("F = {p}² / {nae} = {f}"),
        )
    }),
    ("roundness", || {
        let worked = "Round = 4π · {nae} / {p}² = {roundness}";
        block(&compared("roundness"), &Example::fig_1().says(worked))
    }),
    ("rect", || {
        let ring = Example::fig_1();
        let worked = "x from {left} to {right} and y from {top} to {bottom}, shown as {rect}";
        block(&ring.boxed().lines(), &ring.says(worked))
    }),
    ("cd", || {
        let ring = Example::fig_1();
        let mut canvas = ring.boxed();
        let cd = ring.described.cd();
        canvas.at(cd.x, cd.y, 'D');
        let worked = "CD = (({left} + {right}) / 2, ({top} + {bottom}) / 2) = ({cd})";
        block(&canvas.lines(), &ring.says(worked))
    }),
    ("area", || {
        let ring = Example::fig_1();
        let drawing = ring.taxels(|x, y| Some(if ring.in_rect(x, y) { 'A' } else { '·' }));
        block(&drawing, &ring.says("Area = {width} · {height} = {area}"))
    }),
    ("diagonals", diagonals),
    ("side_ratio", || {
        let ring = Example::fig_1();
        let (width, height) = ring.sides();
        assert!(width > height, "the worked value is width by height");
        let mut lines = ring.boxed().lines();
        let middle = lines.len() / 2;
        lines[middle] += &format!("   {height}");
        lines.push(format!("{:>1$}", width, usize::from(width) * 2 + 5));
        block(
            &lines,
            &ring.says("Ratio = {width} / {height} = {side_ratio}"),
        )
    }),
    ("filling", || {
        let ring = Example::fig_1();
        let empty = |x, y| ring.in_rect(x, y) && !ring.active(x, y);
        let drawing = ring.taxels(|x, y| empty(x, y).then_some('-'));
        block(&drawing, &ring.says("Fill = {na} / {area} = {filling}"))
    }),
    ("cg_cd", || {
        let (corner, drawing) = centres();
        let [cg, cd, distance] = ["cg", "cd", "cg_cd"].map(|key| corner.value(key));
        let of_ring = Example::fig_1().says("{cg_cd}");
        let drawn = format!("from CG ({cg}) to CD ({cd}), CG-CD = {distance}");
        block(&drawing, &format!("In the drawing: {drawn}. {of_ring}"))
    }),
    ("cg_cd_direction", || {
        let (corner, drawing) = centres();
        assert_eq!(Example::fig_1().value("cg_cd_direction"), "–");
        let direction = corner.value("cg_cd_direction");
        let of_ring = "Fig. 1: none, because CG and CD are the same point.";
        block(&drawing, &format!("In the drawing: {direction}. {of_ring}"))
    }),
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

    /// A worked value of Fig. 1, with values for the keys and sides in braces.
    fn says(&self, worked: &str) -> String {
        let mut text = format!("Fig. 1: {worked}.");
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

    /// Draws the taxels of the rectangle and a margin of one taxel around it: `sign` if it has one, else `#` for an
    /// active taxel.
    fn taxels(&self, sign: impl Fn(u8, u8) -> Option<char>) -> Vec<String> {
        let rect = self.described.rect;
        let usual = |x, y| if self.active(x, y) { '#' } else { '·' };
        let drawn = |x, y| sign(x, y).unwrap_or_else(|| usual(x, y));
        let row = |y| -> String {
            let columns = rect.left - 1..=rect.right;
            columns.map(|x| format!("{} ", drawn(x, y))).collect()
        };
        let rows = rect.top - 1..=rect.bottom;
        rows.map(|y| row(y).trim_end().to_owned()).collect()
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

    fn in_rect(&self, column: u8, row: u8) -> bool {
        let rect = self.described.rect;
        rect.columns().contains(&column) && rect.rows().contains(&row)
    }

    fn canvas(&self) -> Canvas {
        let rect = self.described.rect;
        let (left, top) = (rect.left - 1, rect.top - 1);
        let (columns, rows) = (rect.right + 1 - left, rect.bottom + 1 - top);
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

/// A drawing as a block of text, followed by the worked value.
fn block(drawing: &[String], worked: &str) -> String {
    let drawing = drawing.join("\n");
    let drawing = drawing.trim_end().trim_start_matches('\n');
    format!("\n```text\n{drawing}\n```\n\n{worked}\n\n")
}

fn num_x() -> String {
    let ring = Example::fig_1();
    let rect = ring.described.rect;
    let count = |x| rect.rows().filter(|y| ring.active(x, *y)).count();
    let line = |head: &str, cell: &dyn Fn(u8) -> String| -> String {
        let cells = rect.columns().map(|x| format!("{:>5}", cell(x)));
        format!("{head:<6}{}", cells.collect::<String>())
    };
    let sign = |x, y| if ring.active(x, y) { "#" } else { "·" };
    let mut drawing = vec![line("x", &|x| format!("{x}.5"))];
    drawing.extend(rect.rows().map(|y| line("", &|x| sign(x, y).to_owned())));
    drawing.push(line("count", &|x| count(x).to_string()));
    let terms: Vec<_> = rect
        .columns()
        .map(|x| format!("{} · {x}.5", count(x)))
        .collect();
    block(
        &drawing,
        &ring.says(&format!("NumX = {} = {{num_x}}", terms.join(" + "))),
    )
}

fn num_y() -> String {
    let ring = Example::fig_1();
    let rect = ring.described.rect;
    let count = |y| rect.columns().filter(|x| ring.active(*x, y)).count();
    let width = "  ".repeat(rect.columns().count() + 1);
    let mut drawing = vec![format!("  y  {width}count")];
    for y in rect.rows() {
        let taxels = rect
            .columns()
            .map(|x| if ring.active(x, y) { "# " } else { "· " });
        let taxels: String = taxels.collect();
        drawing.push(format!("{y}.5  {taxels}  {:>5}", count(y)));
    }
    let terms: Vec<_> = rect
        .rows()
        .map(|y| format!("{} · {y}.5", count(y)))
        .collect();
    block(
        &drawing,
        &ring.says(&format!("NumY = {} = {{num_y}}", terms.join(" + "))),
    )
}

/// Draws the length of the outline step by step: neighbouring outline taxels that share the outside are joined.
fn p() -> String {
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
    let worked = format!("P = {} + {} · √2 = {{p}}", steps.0, steps.1);
    block(&canvas.lines(), &ring.says(&worked))
}

/// Draws three shapes with about the same number of taxels, and writes the value of each below it.
fn compared(key: &str) -> Vec<String> {
    let shapes = [
        "..##../.####./######/######/.####./..##..",
        "#####/#####/#####/#####/#####",
        "############/############",
    ];
    let shapes = shapes.map(|rows| {
        let drawn = rows.replace('#', "# ").replace('.', "· ");
        let mut lines: Vec<String> = drawn.split('/').map(str::to_owned).collect();
        lines.resize(7, String::new());
        lines.push(Example::new(&common::grid(rows)).value(key));
        lines
    });
    let line = |line: usize| -> String {
        let cells = shapes.iter().map(|shape| format!("{:<17}", shape[line]));
        cells.collect::<String>().trim_end().to_owned()
    };
    (0..8).map(line).collect()
}

fn diagonals() -> String {
    let ring = Example::fig_1();
    let mut canvas = ring.boxed();
    let rect = ring.described.rect;
    let (width, height) = ring.sides();
    for half in 1..u16::from(height) * 2 {
        let down = f64::from(half) / 2.0;
        let along = down * f64::from(width) / f64::from(height);
        let y = f64::from(rect.top) + down;
        canvas.at(f64::from(rect.left) + along, y, '\\');
        canvas.at(f64::from(rect.right) - along, y, '/');
    }
    let values = ring.value("diagonals");
    let (first, second) = values.split_once(", ").expect("two directions");
    let angle = "atan({height} / {width})";
    let worked = format!("{angle} = {first}° and 180° − {angle} = {second}");
    block(&canvas.lines(), &ring.says(&worked))
}

/// Draws an imprint that is not symmetric with its two centres.
fn centres() -> (Example, Vec<String>) {
    let corner = "......../.##...../.##...../.##...../.######./........";
    let corner = Example::new(&common::grid(corner));
    let mut canvas = corner.boxed();
    let (cg, cd) = (corner.described.cg(), corner.described.cd());
    canvas.at(cg.x, cg.y, 'G');
    canvas.at(cd.x, cd.y, 'D');
    (corner, canvas.lines())
}

/// The table at the top of the glossary links to a section for each key; each section has its block.
#[test]
fn every_descriptor_has_a_section_with_a_drawing() {
    let text = document("docs/glossary.md");
    for row in DESCRIPTORS {
        let (key, name) = (row.key, row.name);
        let heading = text.find(&format!("<a id=\"{key}\"></a>"));
        let drawing = text.find(&format!("<!-- {key} -->"));
        let is_there = heading.is_some() && heading < drawing;
        assert!(is_there, "no section for {key} ({name})");
    }
    let keys = DESCRIPTORS.iter().map(|row| row.key);
    assert!(keys.eq(BLOCKS.iter().map(|(key, _)| *key)));
}
