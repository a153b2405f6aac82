//! The drawings and worked values of the glossary, one block for each descriptor.
//!
//! Drawings have one character pair for a taxel. Where a line or a point lies between taxels, a drawing has twice the
//! resolution: four columns and two lines for a taxel, whose centre is in the middle.

use taxel_core::description::{DESCRIPTORS, Description, Region, Value, regions};
use taxel_core::imprint::Imprint;
use taxel_core::sensor::Sensor;
use taxel_core::touch::Plane;
use taxel_files::formats::value;

use crate::common;
use crate::docs::{Block, document};

/// The block of every descriptor, by the descriptor's key.
pub(crate) const BLOCKS: &[Block] = &[
    ("na", na),
    ("nae", nae),
    ("ce", ce),
    ("num_x", num_x),
    ("num_y", num_y),
    ("cg", cg),
    ("p", p),
    ("f", f),
    ("roundness", roundness),
    ("rect", rect),
    ("cd", cd),
    ("area", area),
    ("diagonals", diagonals),
    ("side_ratio", side_ratio),
    ("filling", filling),
    ("cg_cd", cg_cd),
    ("cg_cd_direction", cg_cd_direction),
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

    /// An imprint that is not symmetric.
    fn corner() -> Self {
        Self::new(&common::grid(
            "......../.##...../.##...../.##...../.######./........",
        ))
    }

    /// Formats the value of a descriptor as people read it.
    fn value(&self, key: &str) -> String {
        let row = DESCRIPTORS
            .iter()
            .find(|row| row.key == key)
            .expect("a descriptor");
        value::text((row.measure)(&self.described), row.dimension).unwrap_or_else(|| "–".to_owned())
    }

    /// Draws the taxels of the rectangle and a margin of one taxel around it, one character each.
    fn taxels(&self, sign: impl Fn(u8, u8) -> char) -> Vec<String> {
        let rect = self.described.rect;
        let columns = || rect.left - 1..=rect.right;
        let row = |row| {
            columns()
                .map(|column| format!("{} ", sign(column, row)))
                .collect::<String>()
        };
        (rect.top - 1..=rect.bottom)
            .map(|number| row(number).trim_end().to_owned())
            .collect()
    }

    fn active(&self, column: u8, row: u8) -> bool {
        self.region.taxels().get(column, row)
    }

    fn filled(&self, column: u8, row: u8) -> bool {
        let size = self.region.filled();
        column < size.columns() && row < size.rows() && size.get(column, row)
    }

    /// Returns true for an outline taxel: filled, with at least one of its four neighbours outside.
    fn outline(&self, column: u8, row: u8) -> bool {
        self.filled(column, row)
            && !(self.filled(column - 1, row)
                && self.filled(column + 1, row)
                && self.filled(column, row - 1)
                && self.filled(column, row + 1))
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
                canvas.put(f64::from(column) + 0.5, f64::from(row) + 0.5, sign);
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
        let mut x = left;
        while x <= right {
            canvas.put(x, top, '-');
            canvas.put(x, bottom, '-');
            x += 0.25;
        }
        let mut y = top;
        while y <= bottom {
            canvas.put(left, y, '|');
            canvas.put(right, y, '|');
            y += 0.5;
        }
        for (x, y) in [(left, top), (right, top), (left, bottom), (right, bottom)] {
            canvas.put(x, y, '+');
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
    fn put(&mut self, x: f64, y: f64, sign: char) {
        let (x, y) = (
            (x - f64::from(self.left)) * 4.0,
            (y - f64::from(self.top)) * 2.0,
        );
        self.lines[y.round() as usize][x.round() as usize] = sign;
    }

    fn lines(self) -> Vec<String> {
        let line = |line: Vec<char>| line.into_iter().collect::<String>().trim_end().to_owned();
        self.lines.into_iter().map(line).collect()
    }
}

/// Formats a drawing as a block of text, followed by the worked value.
fn block(drawing: &[String], worked: &str) -> String {
    let empty = |line: &&String| line.trim().is_empty();
    let first = drawing.iter().take_while(empty).count();
    let last = drawing.len() - drawing.iter().rev().take_while(empty).count();
    format!(
        "\n```text\n{}\n```\n\n{worked}\n\n",
        drawing[first..last].join("\n")
    )
}

fn na() -> String {
    let ring = Example::fig_1();
    let drawing = ring.taxels(|x, y| if ring.active(x, y) { '#' } else { '·' });
    block(&drawing, &format!("Fig. 1: NA = {}.", ring.value("na")))
}

fn nae() -> String {
    let ring = Example::fig_1();
    let drawing = ring.taxels(|x, y| match (ring.active(x, y), ring.filled(x, y)) {
        (true, _) => '#',
        (_, true) => 'o',
        _ => '·',
    });
    let (na, nae) = (ring.described.na, ring.described.nae);
    block(
        &drawing,
        &format!("Fig. 1: NAE = {na} + {} = {}.", nae - na, ring.value("nae")),
    )
}

fn ce() -> String {
    let ring = Example::fig_1();
    let drawing = ring.taxels(|x, y| match (ring.outline(x, y), ring.active(x, y)) {
        (true, _) => 'C',
        (_, true) => '#',
        _ => '·',
    });
    let drawn = drawing.concat().matches('C').count();
    assert_eq!(
        drawn.to_string(),
        ring.value("ce"),
        "the drawing shows what is counted"
    );
    block(&drawing, &format!("Fig. 1: CE = {}.", ring.value("ce")))
}

fn num_x() -> String {
    let ring = Example::fig_1();
    let rect = ring.described.rect;
    let count = |column| rect.rows().filter(|row| ring.active(column, *row)).count();
    let cell = |text: String| format!("{text:>5}");
    let columns = || rect.columns();
    let mut drawing = vec![format!(
        "x     {}",
        columns()
            .map(|x| cell(format!("{x}.5")))
            .collect::<String>()
    )];
    for row in rect.rows() {
        let sign = |column| if ring.active(column, row) { "#" } else { "·" };
        drawing.push(format!(
            "      {}",
            columns()
                .map(|x| cell(sign(x).to_owned()))
                .collect::<String>()
        ));
    }
    drawing.push(format!(
        "count {}",
        columns()
            .map(|x| cell(count(x).to_string()))
            .collect::<String>()
    ));
    let terms: Vec<_> = columns().map(|x| format!("{} · {x}.5", count(x))).collect();
    block(
        &drawing,
        &format!(
            "Fig. 1: NumX = {} = {}.",
            terms.join(" + "),
            ring.value("num_x")
        ),
    )
}

fn num_y() -> String {
    let ring = Example::fig_1();
    let rect = ring.described.rect;
    let count = |row| {
        rect.columns()
            .filter(|column| ring.active(*column, row))
            .count()
    };
    let mut drawing = vec![format!(
        "  y  {}count",
        "  ".repeat(rect.columns().count() + 1)
    )];
    for row in rect.rows() {
        let taxels: String = rect
            .columns()
            .map(|x| if ring.active(x, row) { "# " } else { "· " })
            .collect();
        drawing.push(format!("{row}.5  {taxels}  {:>5}", count(row)));
    }
    let terms: Vec<_> = rect
        .rows()
        .map(|y| format!("{} · {y}.5", count(y)))
        .collect();
    block(
        &drawing,
        &format!(
            "Fig. 1: NumY = {} = {}.",
            terms.join(" + "),
            ring.value("num_y")
        ),
    )
}

fn cg() -> String {
    let ring = Example::fig_1();
    let mut canvas = ring.canvas();
    let point = ring.described.cg();
    canvas.put(point.x, point.y, 'G');
    let [x, y, na] = ["num_x", "num_y", "na"].map(|key| ring.value(key));
    block(
        &canvas.lines(),
        &format!(
            "Fig. 1: CG = ({x} / {na}, {y} / {na}) = ({}).",
            ring.value("cg")
        ),
    )
}

/// Draws the length of the outline step by step: neighbouring outline taxels that share the outside are joined.
fn p() -> String {
    let ring = Example::fig_1();
    let mut canvas = ring.canvas();
    let mut steps = (0_u32, 0_u32);
    let rect = ring.described.rect;
    // Every 2 × 2 window of taxels that the outline passes through holds one step of it, if the part is thick.
    for top in rect.top - 1..rect.bottom {
        for left in rect.left - 1..rect.right {
            let (x, y) = (f64::from(left) + 1.0, f64::from(top) + 1.0);
            let window = [
                (left, top),
                (left + 1, top),
                (left, top + 1),
                (left + 1, top + 1),
            ];
            match window.map(|(column, row)| ring.filled(column, row)) {
                [true, true, false, false] => canvas.step(&mut steps.0, x, y - 0.5, '-'),
                [false, false, true, true] => canvas.step(&mut steps.0, x, y + 0.5, '-'),
                [true, false, true, false] => canvas.step(&mut steps.0, x - 0.5, y, '|'),
                [false, true, false, true] => canvas.step(&mut steps.0, x + 0.5, y, '|'),
                [false, true, true, true] | [true, true, true, false] => {
                    canvas.step(&mut steps.1, x, y, '/');
                }
                [true, false, true, true] | [true, true, false, true] => {
                    canvas.step(&mut steps.1, x, y, '\\');
                }
                _ => {}
            }
        }
    }
    let counted = ring.described.steps;
    assert_eq!(
        steps,
        (counted.straight, counted.diagonal),
        "the drawing shows what is counted"
    );
    let worked = format!(
        "Fig. 1: P = {} + {} · √2 = {}.",
        steps.0,
        steps.1,
        ring.value("p")
    );
    block(&canvas.lines(), &worked)
}

impl Canvas {
    fn step(&mut self, count: &mut u32, x: f64, y: f64, sign: char) {
        *count += 1;
        self.put(x, y, sign);
        if sign == '-' {
            self.put(x - 0.25, y, sign);
            self.put(x + 0.25, y, sign);
        }
    }
}

/// Draws three shapes with about the same number of taxels, and writes the value of each below it.
fn compared(key: &str) -> Vec<String> {
    let shapes = [
        "..##../.####./######/######/.####./..##..",
        "#####/#####/#####/#####/#####",
        "############/############",
    ];
    let shapes = shapes.map(|rows| {
        let imprint = common::grid(rows);
        let mut lines: Vec<String> = imprint
            .lines()
            .map(|line| {
                line.chars()
                    .map(|sign| if sign == '#' { "# " } else { "· " })
                    .collect()
            })
            .collect();
        lines.resize(6, String::new());
        lines.push(String::new());
        lines.push(Example::new(&imprint).value(key));
        lines
    });
    (0..8)
        .map(|line| {
            shapes
                .iter()
                .map(|shape| format!("{:<17}", shape[line]))
                .collect::<String>()
                .trim_end()
                .to_owned()
        })
        .collect()
}

fn f() -> String {
    let ring = Example::fig_1();
    let [p, nae, f] = ["p", "nae", "f"].map(|key| ring.value(key));
    block(&compared("f"), &format!("Fig. 1: F = {p}² / {nae} = {f}."))
}

fn roundness() -> String {
    let ring = Example::fig_1();
    let [p, nae, round] = ["p", "nae", "roundness"].map(|key| ring.value(key));
    block(
        &compared("roundness"),
        &format!("Fig. 1: Round = 4π · {nae} / {p}² = {round}."),
    )
}

fn rect() -> String {
    let ring = Example::fig_1();
    let rect = ring.described.rect;
    let worked = format!(
        "Fig. 1: x from {} to {} and y from {} to {}, shown as {}.",
        rect.left,
        rect.right,
        rect.top,
        rect.bottom,
        ring.value("rect")
    );
    block(&ring.boxed().lines(), &worked)
}

fn cd() -> String {
    let ring = Example::fig_1();
    let rect = ring.described.rect;
    let mut canvas = ring.boxed();
    let point = ring.described.cd();
    canvas.put(point.x, point.y, 'D');
    let worked = format!(
        "Fig. 1: CD = (({} + {}) / 2, ({} + {}) / 2) = ({}).",
        rect.left,
        rect.right,
        rect.top,
        rect.bottom,
        ring.value("cd")
    );
    block(&canvas.lines(), &worked)
}

fn area() -> String {
    let ring = Example::fig_1();
    let drawing = ring.taxels(|x, y| if ring.in_rect(x, y) { 'A' } else { '·' });
    let (width, height) = sides(&ring);
    block(
        &drawing,
        &format!(
            "Fig. 1: Area = {width} · {height} = {}.",
            ring.value("area")
        ),
    )
}

fn sides(example: &Example) -> (u8, u8) {
    let rect = example.described.rect;
    (rect.right - rect.left, rect.bottom - rect.top)
}

fn diagonals() -> String {
    let ring = Example::fig_1();
    let mut canvas = ring.boxed();
    let rect = ring.described.rect;
    let (width, height) = sides(&ring);
    for half in 1..u16::from(height) * 2 {
        let down = f64::from(half) / 2.0;
        let along = down * f64::from(width) / f64::from(height);
        let y = f64::from(rect.top) + down;
        canvas.put(f64::from(rect.left) + along, y, '\\');
        canvas.put(f64::from(rect.right) - along, y, '/');
    }
    let values = ring.value("diagonals");
    let (first, second) = values.split_once(", ").expect("two directions");
    let worked = format!(
        "Fig. 1: atan({height} / {width}) = {first}° and 180° − atan({height} / {width}) = {second}.",
    );
    block(&canvas.lines(), &worked)
}

fn side_ratio() -> String {
    let ring = Example::fig_1();
    let (width, height) = sides(&ring);
    let mut lines = ring.boxed().lines();
    let middle = lines.len() / 2;
    lines[middle] += &format!("   {height}");
    lines.push(format!("{:>1$}", width, usize::from(width) * 2 + 5));
    let (long, short) = (width.max(height), width.min(height));
    block(
        &lines,
        &format!(
            "Fig. 1: Ratio = {long} / {short} = {}.",
            ring.value("side_ratio")
        ),
    )
}

fn filling() -> String {
    let ring = Example::fig_1();
    let drawing = ring.taxels(|x, y| match (ring.active(x, y), ring.in_rect(x, y)) {
        (true, _) => '#',
        (_, true) => '-',
        _ => '·',
    });
    let [na, area, filling] = ["na", "area", "filling"].map(|key| ring.value(key));
    block(
        &drawing,
        &format!("Fig. 1: Fill = {na} / {area} = {filling}."),
    )
}

/// Draws the corner with its two centres.
fn centres() -> (Example, Vec<String>) {
    let corner = Example::corner();
    let mut canvas = corner.boxed();
    let (cg, cd) = (corner.described.cg(), corner.described.cd());
    canvas.put(cg.x, cg.y, 'G');
    canvas.put(cd.x, cd.y, 'D');
    (corner, canvas.lines())
}

fn cg_cd() -> String {
    let (corner, drawing) = centres();
    let worked = format!(
        "In the drawing: from CG ({}) to CD ({}), CG-CD = {}. Fig. 1: {}.",
        corner.value("cg"),
        corner.value("cd"),
        corner.value("cg_cd"),
        Example::fig_1().value("cg_cd")
    );
    block(&drawing, &worked)
}

fn cg_cd_direction() -> String {
    let (corner, drawing) = centres();
    let ring = Example::fig_1();
    assert_eq!(ring.value("cg_cd_direction"), "–");
    let worked = format!(
        "In the drawing: {}. Fig. 1: none, because CG and CD are the same point.",
        corner.value("cg_cd_direction")
    );
    block(&drawing, &worked)
}

/// The table at the top of the glossary links to a section for each key; each section has its block.
#[test]
fn every_descriptor_has_a_section_with_a_drawing() {
    let text = document("docs/glossary.md");
    for row in DESCRIPTORS {
        let (key, name) = (row.key, row.name);
        let heading = text.find(&format!("<a id=\"{key}\"></a>"));
        let drawing = text.find(&format!("<!-- {key} -->"));
        assert!(
            heading.is_some() && heading < drawing,
            "no section for {key} ({name})"
        );
        assert!(
            BLOCKS.iter().any(|(block, _)| *block == key),
            "no drawing for {key}"
        );
    }
    assert_eq!(BLOCKS.len(), DESCRIPTORS.len());
    assert!(!matches!(
        (DESCRIPTORS[0].measure)(&Example::fig_1().described),
        Value::None
    ));
}
