//! Acquires frames: from a serial line, a pipe, a network connection, a growing file, or a recording played back.
//!
//! [`acquire`] reads a source until it ends or is stopped, and reports frames and problems, one after the other, on the
//! thread that calls it. A consumer that must see every frame, such as a [`FrameRecorder`], runs on that thread. A
//! screen takes the frames that have arrived whenever it draws; nothing waits for the screen.
//!
//! ```text
//! serial, tcp, FIFO, standard input, file -> StreamDecoder \
//! recording -> formats::recording, at its own rate          -> AcquireEvent -> FrameRecorder (every frame)
//! ```

mod source_name;

mod source;

mod serial;

mod byte_input;

mod growing_file;

mod followed_file;

mod frame_rate;

mod event;

mod arrival_clock;

mod silence;

mod ticker;

mod stream_start;

mod stream_report;

mod stream;

mod pace;

mod playback;

mod run;

mod recorder;

pub use event::{AcquireError, AcquireEvent, AcquireOptions, AcquireSink, Playback};
pub use frame_rate::FrameRate;
pub use growing_file::ReadAnew;
pub use recorder::PreparedMetadata;
pub use recorder::{FrameRecorder, MetadataFileError, RecorderError, metadata_beside};
pub use run::acquire;
pub use source::FrameSource;
pub use source_name::SourceName;
