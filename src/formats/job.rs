//! One line of `taxel batch`: a figure, a picture or a whole matrix, and perhaps a sensor of its own.

use crate::formats::json::message;
use crate::formats::record::{Record, RecordError};
use crate::imprint::Imprint;
use crate::sensor::Sensor;
use crate::source::Source;
use crate::touch::Plane;

/// What a line asks for.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Job {
    /// To touch something with a sensor.
    Touch(Sensor, Source),
    /// To describe a matrix as it is.
    Describe(Imprint),
}

/// The error for a line without an answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JobError {
    /// Not JSON, or not an object with known keys.
    #[error("column {column}: {message}")]
    Json {
        /// Where, counted from 1.
        column: usize,
        /// What is wrong.
        message: String,
    },
    /// A value without a meaning.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// An invalid sensor.
    #[error("sensor: {0}")]
    Sensor(RecordError),
}

impl Job {
    /// Reads a line. The sensor is `sensor`, changed as the line says; `lookup` finds pictures given by name. A whole
    /// matrix is not touched, and has no sensor.
    ///
    /// # Errors
    /// If the line has no answer; the message is one sentence.
    pub fn read(
        line: &[u8],
        sensor: Sensor,
        lookup: &dyn Fn(&str) -> Result<Imprint, String>,
    ) -> Result<Self, JobError> {
        let record: Record<'_> = serde_json::from_slice(line).map_err(|error| JobError::Json {
            column: error.column().max(1),
            message: message(&error),
        })?;
        let sensor = match &record.sensor {
            Some(own) => own.sensor(sensor).map_err(JobError::Sensor)?,
            None => sensor,
        };
        match &record {
            Record {
                figure: None,
                picture: None,
                imprint: Some(content),
                values,
                ..
            } => {
                values.only("imprint", &[])?;
                record.no_sensor("imprint")?;
                let no_name = |_: &str| Err("expected rows of '#' and '.'".to_owned());
                Ok(Self::Describe(content.imprint("imprint", &no_name)?))
            }
            _ => Ok(Self::Touch(sensor, record.source(&sensor, lookup)?)),
        }
    }

    /// The imprint to describe. `plane` is reused if it has the right sensor.
    pub fn imprint(&self, plane: &mut Plane) -> Imprint {
        match self {
            Self::Describe(imprint) => *imprint,
            Self::Touch(sensor, source) => {
                if plane.sensor() != sensor {
                    *plane = Plane::new(*sensor);
                }
                plane.touch(source)
            }
        }
    }
}
