//! The formats in which imprints, poses and answers leave the program and come back.
//!
//! Every reader is strict and total: it accepts any bytes, and returns either a value in range or one error that says
//! what was found, where, and what was expected.
//!
//! JSON is written with serde: [`DescribedImprint`], `StoredShape`, `FrameAnswer`, `AtlasLine`, `Sensor`, `Source` and
//! `SetRule` implement `Serialize`. Which values are in range depends on other keys, such as the sensor, so files and
//! lines are read as a whole, by `StoredShape::read`, `Job::read` and `named_shape`. Their errors name the line, the
//! column or the key.

pub mod atlas;
mod drawing;
pub mod file;
mod header;
pub mod imprint_file;
pub mod job;
pub mod json;
mod model;
pub mod name;
mod named_shape;
pub mod numpy;
mod outline;
mod record;
pub mod recording;
pub(crate) mod seconds;
pub mod shape;
pub(crate) mod table;
pub mod value;

pub use json::DescribedImprint;

pub use drawing::{ConfusionMap, Drawing, Plot};
pub use imprint_file::{Content, ExportFormat, read as read_imprint, read_content};
pub use name::Name;

pub use job::Job;

pub use shape::StoredShape;

pub use outline::{
    FLATNESS, MAX_DRAWING_BYTES, OutlineOptions, OutlineUnit, ReadOutline, is_svg, read_outline,
};

pub use numpy::archive::kind_of as archive_kind;

pub use header::MODEL_FORMAT;

pub use model::{header as model_header, read as read_model, write as write_model};

pub use named_shape::{ShapeLookup, named_shape};
