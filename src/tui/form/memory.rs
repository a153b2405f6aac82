//! The values that were accepted last in forms: the next form begins with them.
//!
//! A figure fits the sensor on which it was placed, and is used only for a sensor with the same columns and rows.
//! Ranges of x0 and y0 fit one shape on one sensor; they are kept only if they were typed, and used only for a shape
//! of the same kind on a sensor of the same size.

use crate::figure::{Figure, FigureKind};
use crate::pose::{Anchor, Axis, DecimalRange};
use crate::sensor::{MatrixSize, Sensor};

#[derive(Clone, Debug, Default)]
pub struct FormMemory {
    figures: Vec<(Figure, MatrixSize)>,
    pub ranges: Option<RememberedRanges>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct RememberedRanges {
    pub of: String,
    pub size: MatrixSize,
    pub anchor: Anchor,
    pub ranges: Vec<(Axis, DecimalRange)>,
}

impl RememberedRanges {
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
    pub fn note_figure(&mut self, figure: &Figure, sensor: &Sensor) {
        self.figures
            .retain(|(other, _)| other.kind() != figure.kind());
        self.figures.push((*figure, sensor.size()));
    }

    pub fn last_kind(&self) -> Option<FigureKind> {
        self.figures.last().map(|(figure, _)| figure.kind())
    }

    pub fn figure(&self, kind: FigureKind, sensor: &Sensor) -> Option<Figure> {
        let mut own = self.figures.iter().filter(|(own, _)| own.kind() == kind);
        own.find(|(_, size)| *size == sensor.size())
            .map(|(figure, _)| *figure)
    }
}
