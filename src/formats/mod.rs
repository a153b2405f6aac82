//! The formats in which imprints, poses and answers leave the program and come back.
//!
//! Every reader is strict and total: it accepts any bytes, and returns either a value in range or one error that says
//! what was found, where, and what was expected.
//!
//! JSON is written with serde: [`DescribedImprint`], `StoredShape`, `FrameAnswer`, `AtlasLine`, `Sensor`, `Source` and
//! `SetRule` implement `Serialize`. None of them implements `Deserialize`: which values are in range depends on other
//! keys, such as the sensor, so files and lines are read as a whole, by `StoredShape::read`, `Job::read` and
//! `named_shape`. Their errors name the line, the column or the key.

pub mod value;

pub(crate) mod byte_order_mark;

pub(crate) mod ending;

#[cfg(any(feature = "frames", feature = "library", feature = "sweep"))]
pub(crate) mod system_error;

pub(crate) mod described;

#[cfg(feature = "json")]
pub(crate) mod json;

#[cfg(any(feature = "sweep", feature = "frames"))]
pub(crate) mod json_object;

#[cfg(feature = "json")]
pub(crate) mod record;

#[cfg(feature = "json")]
pub(crate) mod framed;

#[cfg(feature = "json")]
mod job;

pub mod name;

#[cfg(feature = "json")]
pub mod shape;

pub mod npy;

mod foreign;

mod mask;

pub mod text;

pub mod pbm;

pub mod table;

pub mod array;

pub mod imprint_file;

#[cfg(feature = "json")]
mod content;

#[cfg(feature = "frames")]
pub(crate) mod seconds;

#[cfg(feature = "frames")]
pub mod recording;

#[cfg(feature = "frames")]
pub mod stream;

pub(crate) mod xml;

pub(crate) mod shade;

mod drawing;

#[cfg(feature = "sweep")]
pub mod atlas;

#[cfg(feature = "sweep")]
pub mod archive;

#[cfg(feature = "sweep")]
mod npz;

#[cfg(feature = "recognition")]
mod model;

#[cfg(feature = "recognition")]
mod named_shape;

#[cfg(feature = "tui")]
pub(crate) mod separation;

#[cfg(feature = "tui")]
pub(crate) mod pose_words;

pub use described::DescribedImprint;
#[cfg(feature = "tui")]
pub(crate) use drawing::{axis_ends, axis_marks};

pub use drawing::{ConfusionMap, Drawing, DrawingFormat, LinePlot, PointPlot, PoseMap};
pub use imprint_file::{ImprintFormat, ImprintFormatError, read as read_imprint};
pub use name::{Name, NameError};

#[cfg(feature = "json")]
pub use job::{Job, JobError};

#[cfg(feature = "json")]
pub use record::RecordError;

#[cfg(feature = "json")]
pub use shape::{ShapeError, StoredShape};

#[cfg(feature = "json")]
pub use content::{Content, ContentError, read_content};

#[cfg(feature = "sweep")]
pub use npz::{ArchiveError, ArchiveKind, kind_of as archive_kind};

#[cfg(feature = "recognition")]
pub use model::{
    FORMAT as MODEL_FORMAT, header as model_header, read as read_model, write as write_model,
};

#[cfg(feature = "recognition")]
pub use named_shape::{NamedShapeError, ShapeLookup, named_shape, named_shape_of_words};
