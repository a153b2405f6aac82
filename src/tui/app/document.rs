//! The document on the matrix, and everything that follows from it.
//!
//! A [`Document`] is a sensor, the source that touched it, and the taxels set by hand since then. Everything else
//! follows from it and is a [`Reading`].

use taxel_core::description::{Description, Region, main_region, regions};
use taxel_core::imprint::Imprint;
use taxel_core::matrix::Matrix;
use taxel_core::outline::OutlineError;
use taxel_core::parameter::Parameter;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_core::touch::{Plane, reaches_beyond};
use taxel_files::formats::{Name, StoredShape};
use taxel_files::storage::UNNAMED;

/// The content of the matrix. It is plain and small, so that a list of earlier documents is the undo history.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    pub sensor: Sensor,
    pub source: Option<Source>,
    /// The taxels switched by hand since then.
    pub edits: Imprint,
}

impl Document {
    pub fn empty(sensor: Sensor) -> Self {
        Self::drawn(sensor, Imprint::empty(sensor.size()))
    }

    pub fn touched(sensor: Sensor, source: Source) -> Self {
        Self {
            source: Some(source),
            ..Self::empty(sensor)
        }
    }

    /// Places a stored shape. A sensor whose pitch is not set takes that of an outline in mm; otherwise the outline gets
    /// the size that it has on the sensor.
    pub fn placed(mut sensor: Sensor, source: Source) -> Result<Self, OutlineError> {
        if let Source::Outline(outline) = &source
            && let Some(pitch) = outline.pitch_mm().filter(|_| sensor.pitch_mm() == 1.0)
        {
            sensor = sensor.with(Parameter::Pitch, pitch).unwrap_or(sensor);
        }
        let source = source.at_pitch(Some(sensor.pitch_mm()))?;
        source.check_size(&sensor)?;
        Ok(Self::touched(sensor, source))
    }

    pub fn drawn(sensor: Sensor, imprint: Imprint) -> Self {
        Self {
            sensor,
            source: None,
            edits: imprint,
        }
    }

    /// The sensor does not count.
    pub fn is_empty(&self) -> bool {
        self.source.is_none() && self.edits.is_empty()
    }

    pub fn of_shape(shape: &StoredShape) -> Self {
        let source = match &shape.source {
            Some(Source::Outline(_)) if shape.name.as_str() != UNNAMED => {
                Some(shape.touched_again())
            }
            source => source.clone(),
        };
        let mut document = Self {
            source,
            ..Self::empty(shape.sensor)
        };
        let touched = Reading::of(&document).imprint;
        document.edits = touched.differing(&shape.imprint);
        document
    }

    pub fn to_shape(&self, name: Name) -> StoredShape {
        StoredShape {
            name,
            sensor: self.sensor,
            imprint: Reading::of(self).imprint,
            source: self.source.clone(),
        }
    }

    /// A source whose values this sensor does not allow becomes a drawing. An outline in mm follows the pitch.
    #[must_use]
    pub fn on(&self, sensor: Sensor) -> Self {
        let allowed = |source: &Source| {
            source.parameters().iter().all(|&parameter| {
                let value = source.get(parameter);
                value.is_none_or(|value| sensor.check(parameter, value).is_ok())
            })
        };
        let source = self.source.clone();
        let source = source.and_then(|source| source.at_pitch(Some(sensor.pitch_mm())).ok());
        match source.filter(allowed) {
            Some(source) => Self {
                sensor,
                source: Some(source),
                edits: self.edits.resized(sensor.size()),
            },
            None => Self::drawn(sensor, Reading::of(self).imprint.resized(sensor.size())),
        }
    }
}

/// Everything that follows from a document. It is computed here and nowhere else, once per change.
#[derive(Clone, Debug)]
pub struct Reading {
    pub imprint: Imprint,
    pub coverages: Option<Matrix<f64>>,
    pub regions: Vec<Region<'static>>,
    /// The index of the region that is described unless another one was chosen.
    pub main: Option<usize>,
    pub beyond: bool,
}

impl Reading {
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
        let source = document.source.as_ref();
        Self {
            imprint,
            coverages,
            main: main_region(&regions),
            regions,
            beyond: source.is_some_and(|source| reaches_beyond(source, &document.sensor)),
        }
    }

    pub fn coverage(&self, column: u8, row: u8) -> Option<f64> {
        self.coverages.as_ref()?.get(column, row)
    }

    pub fn region(&self, chosen: Option<usize>) -> Option<(usize, &Region<'_>)> {
        let chosen = chosen.filter(|&index| index < self.regions.len());
        let index = chosen.or(self.main)?;
        Some((index, &self.regions[index]))
    }

    pub fn description(&self, chosen: Option<usize>) -> Option<Description> {
        let (_, region) = self.region(chosen)?;
        Some(Description::of(region))
    }
}
