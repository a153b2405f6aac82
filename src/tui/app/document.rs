//! What is on the matrix, what follows from it, and its history.
//!
//! A [`Document`] is a sensor, what touched it, and the taxels set by hand since then. Everything else follows from it
//! and is a [`Reading`].
//!
//! ```
//! use taxel::prelude::*;
//! use taxel::tui::app::document::{Document, Reading};
//!
//! let mut drawn = Document::empty(Sensor::default());
//! drawn.edits.toggle(3, 4);
//! assert_eq!(Reading::of(&drawn).imprint.count(), 1);
//! ```

use crate::description::{Description, Region, main_region, regions};
use crate::formats::{Name, StoredShape};
use crate::imprint::Imprint;
use crate::sensor::Sensor;
use crate::source::Source;
use crate::touch::{Plane, reaches_beyond};

/// What is on the matrix. Plain and small, so that a list of earlier documents is the undo history.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// The sensor.
    pub sensor: Sensor,
    /// What touched it; nothing on a matrix that is only drawn on.
    pub source: Option<Source>,
    /// The taxels switched by hand since then.
    pub edits: Imprint,
}

impl Document {
    /// An empty matrix.
    pub fn empty(sensor: Sensor) -> Self {
        Self::drawn(sensor, Imprint::empty(sensor.columns(), sensor.rows()))
    }

    /// A matrix touched by a figure or a picture.
    pub fn touched(sensor: Sensor, source: Source) -> Self {
        Self {
            source: Some(source),
            ..Self::empty(sensor)
        }
    }
}

impl Document {
    /// A matrix that an imprint was drawn on, which has as many columns and rows.
    pub fn drawn(sensor: Sensor, imprint: Imprint) -> Self {
        Self {
            sensor,
            source: None,
            edits: imprint,
        }
    }

    /// Whether nothing is on the matrix: no touch, and no taxel set by hand. Its sensor alone is no work.
    pub fn is_empty(&self) -> bool {
        self.source.is_none() && self.edits.is_empty()
    }

    /// The document of a stored shape: touched by its source, and by hand what differs from that.
    pub fn of_shape(shape: &StoredShape) -> Self {
        let mut document = Self {
            source: shape.source.clone(),
            ..Self::empty(shape.sensor)
        };
        let touched = Reading::of(&document).imprint;
        document.edits = touched.differing(&shape.imprint);
        document
    }

    /// The shape to store under a name; `reading` is that of this document.
    pub fn to_shape(&self, name: Name, reading: &Reading) -> StoredShape {
        let imprint = reading.imprint;
        StoredShape {
            name,
            sensor: self.sensor,
            imprint,
            source: self.source.clone(),
        }
    }

    /// The same on another sensor. A source whose values this sensor does not allow becomes a drawing.
    #[must_use]
    pub fn on(&self, sensor: Sensor) -> Self {
        let allowed = |source: &Source| {
            let mut values = source
                .parameters()
                .iter()
                .filter_map(|&p| Some((p, source.get(p)?)));
            values.all(|(parameter, value)| sensor.check(parameter, value).is_ok())
        };
        let (columns, rows) = (sensor.columns(), sensor.rows());
        match &self.source {
            Some(source) if allowed(source) => Self {
                sensor,
                source: Some(source.clone()),
                edits: self.edits.resized(columns, rows),
            },
            _ => Self::drawn(sensor, Reading::of(self).imprint.resized(columns, rows)),
        }
    }
}

/// What can be read off a document. Computed here and nowhere else, once per change: see [`ReadDocument`].
#[derive(Clone, Debug)]
pub struct Reading {
    /// The active taxels.
    pub imprint: Imprint,
    /// How much of each cell is covered, in reading order; none of a matrix that is only drawn on.
    pub coverages: Option<Vec<f64>>,
    /// Pieces and holes.
    pub regions: Vec<Region<'static>>,
    /// What is described unless another region was chosen.
    pub main: Option<usize>,
    /// Whether the source reaches beyond the sensor.
    pub beyond: bool,
}

impl Reading {
    /// What can be seen of a document.
    pub fn of(document: &Document) -> Self {
        let mut imprint = document.edits;
        let mut coverages = None;
        if let Some(source) = &document.source {
            let mut plane = Plane::new(document.sensor);
            let touched = plane.touch(source);
            imprint = imprint.differing(&touched);
            coverages = Some(plane.coverages());
        }
        let regions = regions(&imprint);
        let main = main_region(&regions);
        let beyond = document
            .source
            .as_ref()
            .is_some_and(|source| reaches_beyond(source, &document.sensor));
        Self {
            imprint,
            coverages,
            regions,
            main,
            beyond,
        }
    }

    /// How much of a cell is covered; none on a matrix that is only drawn on.
    pub fn coverage(&self, column: u8, row: u8) -> Option<f64> {
        let index = usize::from(row) * usize::from(self.imprint.columns()) + usize::from(column);
        self.coverages.as_ref()?.get(index).copied()
    }

    /// A region with its number, counted from 0: the chosen one where it exists, else the main one.
    pub fn region(&self, chosen: Option<usize>) -> Option<(usize, &Region<'_>)> {
        let index = chosen
            .filter(|&index| index < self.regions.len())
            .or(self.main)?;
        Some((index, self.regions.get(index)?))
    }

    /// Counts and sums of that region.
    pub fn description(&self, chosen: Option<usize>) -> Option<Description> {
        self.region(chosen)
            .map(|(_, region)| Description::of(region))
    }
}

/// A document with its reading: the only place where the screen keeps one.
#[derive(Clone, Debug)]
pub struct ReadDocument {
    /// What was read.
    document: Document,
    reading: Reading,
}

impl ReadDocument {
    /// Reads a document.
    pub fn new(document: Document) -> Self {
        Self {
            reading: Reading::of(&document),
            document,
        }
    }

    /// The document.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// Its reading.
    pub fn reading(&self) -> &Reading {
        &self.reading
    }
}
