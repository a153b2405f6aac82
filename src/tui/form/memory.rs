//! The values that were accepted last in forms: the next form begins with them, also in the next run.
//!
//! There is a line for each kind of figure, the last accepted one last, and a line for the ranges of Explore:
//! ```text
//! figure ellipse columns 16 rows 16 radius_x 3 radius_y 4 x0 5 y0 5 angle 0
//! ranges picture centre columns 16 rows 16 angle 0:89:1 zoom_x 1
//! ```
//! A figure fits the sensor on which it was placed, and is used only for a sensor with the same columns and rows.
//! Ranges of x0 and y0 fit one shape on one sensor; they are kept only if they were typed, and used only for a shape
//! of the same kind on a sensor of the same size.

use std::collections::BTreeMap;

use crate::figure::{Figure, FigureKind};
use crate::parameter::Parameter;
use crate::pose::{Anchor, Axis, DecimalRange};
use crate::sensor::{MatrixSize, Sensor};

/// The word before a figure.
const FIGURE: &str = "figure";
/// The word before ranges.
const RANGES: &str = "ranges";
/// The parameters that give the size of a sensor.
const SIDES: [Parameter; 2] = [Parameter::Columns, Parameter::Rows];

/// The remembered values. The default remembers nothing: forms always begin with the defaults, as a script needs it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FormMemory {
    /// Whether values are remembered.
    keeps: bool,
    /// One figure of each kind, the last accepted one last.
    figures: Vec<RememberedFigure>,
    /// The ranges of the last sweep.
    ranges: Option<RememberedRanges>,
}

/// A figure as plain numbers; whether they are in range depends on the sensor.
#[derive(Clone, Debug, PartialEq)]
struct RememberedFigure {
    /// The kind of the figure.
    kind: FigureKind,
    /// Columns and rows of its sensor.
    size: MatrixSize,
    /// The values of its parameters.
    values: Vec<(Parameter, f64)>,
}

/// Ranges of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct RememberedRanges {
    /// The name of the kind of shape.
    pub of: String,
    /// Columns and rows of the sensor.
    pub size: MatrixSize,
    /// The point of the shape that x0 and y0 place.
    pub anchor: Anchor,
    /// The ranges that were typed, in the order of their fields.
    pub ranges: Vec<(Axis, DecimalRange)>,
}

impl RememberedRanges {
    /// Returns the range of an axis for a kind of shape on a sensor; None if no range is remembered, or if it does
    /// not fit.
    pub fn get(&self, of: &str, sensor: &Sensor, axis: Axis) -> Option<DecimalRange> {
        let place = matches!(axis, Axis::X0 | Axis::Y0);
        let suits = of == self.of && self.size == sensor.size();
        let mut known = self.ranges.iter().filter(|(own, _)| *own == axis);
        known
            .next()
            .filter(|_| !place || suits)
            .map(|(_, range)| *range)
    }
}

impl FormMemory {
    /// Creates a memory that remembers, with the values in the given lines; malformed lines are ignored.
    pub fn read(lines: &[String]) -> Self {
        let mut memory = Self {
            keeps: true,
            ..Self::default()
        };
        for line in lines {
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            match words[..] {
                [FIGURE, kind, ref pairs @ ..] => {
                    if let Some(figure) = figure_of(kind, pairs) {
                        memory.add(figure);
                    }
                }
                [RANGES, of, anchor, ref pairs @ ..] => {
                    memory.ranges = ranges_of(of, anchor, pairs).or(memory.ranges);
                }
                _ => {}
            }
        }
        memory
    }

    /// Returns the remembered values as lines.
    pub fn lines(&self) -> Vec<String> {
        let figure = |figure: &RememberedFigure| {
            let mut line = format!("{FIGURE} {}", figure.kind.name()) + &on(figure.size);
            for (parameter, value) in &figure.values {
                line += &format!(" {} {value}", parameter.row().key);
            }
            line
        };
        let ranges = |known: &RememberedRanges| {
            let mut line = format!("{RANGES} {} {}", known.of, known.anchor.name());
            line += &on(known.size);
            for (axis, range) in &known.ranges {
                line += &format!(" {} {range}", axis.name());
            }
            line
        };
        let figures = self.figures.iter().map(figure);
        figures.chain(self.ranges.iter().map(ranges)).collect()
    }

    /// Remembers a figure that was placed on a sensor.
    pub fn note_figure(&mut self, figure: &Figure, sensor: &Sensor) {
        let parameters = figure.kind().parameters().iter();
        let values = parameters.filter_map(|&own| Some((own, figure.get(own)?)));
        self.add(RememberedFigure {
            kind: figure.kind(),
            size: sensor.size(),
            values: values.collect(),
        });
    }

    /// Remembers the ranges of a sweep.
    pub fn note_ranges(&mut self, ranges: RememberedRanges) {
        if self.keeps {
            self.ranges = Some(ranges);
        }
    }

    /// Returns the kind of the last figure.
    pub fn last_kind(&self) -> Option<FigureKind> {
        self.figures.last().map(|figure| figure.kind)
    }

    /// Returns the last figure of a kind; None if there is none, or if it was placed on a sensor of another size.
    pub fn figure(&self, kind: FigureKind, sensor: &Sensor) -> Option<Figure> {
        let mut own = self.figures.iter().filter(|figure| figure.kind == kind);
        let own = own.find(|figure| figure.size == sensor.size())?;
        let value = |parameter: Parameter| {
            let mut values = own.values.iter();
            let known = values.find(|(own, _)| *own == parameter);
            known.map(|(_, value)| *value)
        };
        Figure::new(kind, sensor, value).ok()
    }

    /// Returns the last ranges.
    pub fn ranges(&self) -> Option<&RememberedRanges> {
        self.ranges.as_ref()
    }

    /// Adds a figure after the others, and removes the old one of its kind.
    fn add(&mut self, figure: RememberedFigure) {
        if self.keeps {
            self.figures.retain(|other| other.kind != figure.kind);
            self.figures.push(figure);
        }
    }
}

/// Returns the part of a line that states the size of a sensor.
fn on(size: MatrixSize) -> String {
    let (columns, rows) = (size.columns(), size.rows());
    let [across, down] = SIDES.map(|side| side.row().key);
    format!(" {across} {columns} {down} {rows}")
}

/// Reads the size of a sensor from the pairs of a line; None if it is missing or out of range.
fn size_of(pairs: &[&str]) -> Option<MatrixSize> {
    let side = |parameter: Parameter| {
        let mut pairs = pairs.chunks_exact(2);
        let pair = pairs.find(|pair| pair[0] == parameter.row().key)?;
        pair[1].parse().ok()
    };
    let [columns, rows] = SIDES;
    MatrixSize::new(side(columns)?, side(rows)?).ok()
}

/// Reads a figure from a line; None if the line is malformed.
fn figure_of(kind: &str, pairs: &[&str]) -> Option<RememberedFigure> {
    let kind = kind.parse::<FigureKind>().ok()?;
    let mut known = BTreeMap::new();
    for pair in pairs.chunks_exact(2) {
        let value: f64 = pair[1]
            .parse()
            .ok()
            .filter(|value: &f64| value.is_finite())?;
        known.insert(pair[0], value);
    }
    let parameters = kind.parameters().iter();
    let values = parameters.filter_map(|&own| Some((own, *known.get(own.row().key)?)));
    Some(RememberedFigure {
        kind,
        size: size_of(pairs)?,
        values: values.collect(),
    })
}

/// Reads ranges from a line; None if the line is malformed.
fn ranges_of(of: &str, anchor: &str, pairs: &[&str]) -> Option<RememberedRanges> {
    let anchor = anchor.parse().ok()?;
    let range = |pair: &[&str]| {
        let axis = Axis::ALL.into_iter().find(|axis| axis.name() == pair[0]);
        Some((axis?, pair[1].parse().ok()?))
    };
    let is_side = |pair: &&[&str]| SIDES.iter().any(|side| side.row().key == pair[0]);
    let axes = pairs.chunks_exact(2).filter(|pair| !is_side(pair));
    let ranges: Option<Vec<_>> = axes.map(range).collect();
    Some(RememberedRanges {
        of: of.to_owned(),
        size: size_of(pairs)?,
        anchor,
        ranges: ranges?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noted_values_are_read_back_and_malformed_lines_are_ignored() {
        let sensor = Sensor::default();
        let mut memory = FormMemory::read(&[]);
        let ellipse = Figure::ellipse(2.5, 1.005).at(-1.0, 3.0).on(&sensor);
        let ellipse = ellipse.expect("in range");
        let ring = Figure::default_of(FigureKind::Hexagon, &sensor);
        for figure in [&ellipse, &ring, &ellipse] {
            memory.note_figure(figure, &sensor);
        }
        let range = |text: &str| text.parse::<DecimalRange>().expect("a range");
        memory.note_ranges(RememberedRanges {
            of: "ellipse".to_owned(),
            size: sensor.size(),
            anchor: Anchor::Centre,
            ranges: vec![
                (Axis::X0, range("5:5.9:0.1")),
                (Axis::Angle, range("0:80:20")),
            ],
        });
        let mut lines = memory.lines();
        assert_eq!(lines.len(), 3, "{lines:?}");
        for nonsense in [
            "",
            "figure",
            "figure blob x0 1",
            "figure ellipse x0 much",
            "ranges",
            "ranges a b",
        ] {
            lines.push(nonsense.to_owned());
        }
        let read = FormMemory::read(&lines);
        assert_eq!(read, memory);
        assert_eq!(read.last_kind(), Some(FigureKind::Ellipse));
        assert_eq!(read.figure(FigureKind::Ellipse, &sensor), Some(ellipse));
        assert_eq!(read.figure(FigureKind::Octagon, &sensor), None);
        let ranges = read.ranges().expect("noted");
        let found = |of, sensor: &Sensor, axis| ranges.get(of, sensor, axis);
        let [place, angles] = [range("5:5.9:0.1"), range("0:80:20")];
        assert_eq!(found("ellipse", &sensor, Axis::X0), Some(place));
        assert_eq!(found("picture", &sensor, Axis::X0), None);
        assert_eq!(found("picture", &sensor, Axis::Angle), Some(angles));
        // Values that are in range on another sensor, too, would be in the wrong place there.
        let other = Sensor::new(16, 17).expect("in range");
        assert_eq!(read.figure(FigureKind::Ellipse, &other), None);
        assert_eq!(found("ellipse", &other, Axis::X0), None);
        assert_eq!(found("ellipse", &other, Axis::Angle), Some(angles));
        let mut none = FormMemory::default();
        none.note_figure(&ellipse, &sensor);
        assert_eq!(none, FormMemory::default());
    }
}
