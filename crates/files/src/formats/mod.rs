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

pub mod byte_order_mark;

pub mod ending;

pub mod system_error;

pub(crate) mod described;

pub mod json;

pub mod json_object;

pub mod record;

pub mod framed;

mod job;

pub mod name;

pub mod shape;

pub mod npy;

mod foreign;

mod mask;

pub mod text;

pub mod pbm;

pub mod table;

pub mod array;

pub mod imprint_file;

mod content;

pub(crate) mod seconds;

pub mod recording;

pub mod stream;

pub mod xml;

pub mod shade;

mod drawing;

pub mod atlas;

pub mod archive;

mod npz;

mod model;

mod named_shape;

pub mod separation;

pub mod pose_words;

pub use described::DescribedImprint;
pub use drawing::{axis_ends, axis_marks};

pub use drawing::{ConfusionMap, Drawing, DrawingFormat, LinePlot, PointPlot, PoseMap};
pub use imprint_file::{ImprintFormat, ImprintFormatError, read as read_imprint};
pub use name::{Name, NameError};

pub use job::{Job, JobError};

pub use record::RecordError;

pub use shape::{ShapeError, StoredShape};

pub use content::{Content, ContentError, read_content};

pub use npz::{ArchiveError, ArchiveKind, kind_of as archive_kind};

pub use model::{
    FORMAT as MODEL_FORMAT, header as model_header, read as read_model, write as write_model,
};

pub use named_shape::{NamedShapeError, ShapeLookup, named_shape, named_shape_of_words};
