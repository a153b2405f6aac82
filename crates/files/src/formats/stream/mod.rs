//! Decodes live streams of frames: bytes in, whole frames out. Broken frames are counted, with a sample.
//!
//! A decoder takes bytes in pieces of any size, never waits, and keeps at most a few frames. Everything before the
//! first boundary between frames is dropped, unless the stream is known to begin with a frame. Torn, short, long and
//! garbled frames are dropped and counted; they are never joined or padded.
//!
//! ```
//! use taxel_files::formats::stream::{StreamDecoder, StreamEvent, StreamOptions};
//! let mut decoder = StreamDecoder::new(StreamOptions::default().from_start());
//! let mut sums = Vec::new();
//! let mut sink = |event: StreamEvent<'_>| {
//!     if let StreamEvent::Frame(frame) = event {
//!         sums.push(frame.values().iter().sum::<f64>());
//!     }
//! };
//! for piece in [&b"1 2\n3 "[..], b"4\n\n5 6\n7 x\n\n", b"1 1\n1 1\n\n"] {
//!     decoder.push(piece, &mut sink);
//! }
//! decoder.finish(&mut sink);
//! assert_eq!(sums, [10.0, 4.0]);
//! assert_eq!((decoder.counts().frames, decoder.counts().dropped), (2, 1));
//! ```

mod event;

mod old;

mod row_block;

mod lines;

mod documents;

mod boards;

mod format_search;

mod decoder;

pub(in crate::formats) use boards::MARKER as FLEXITAC_MARKER;
pub use decoder::StreamDecoder;
pub use event::{
    NoFrameReason, Silence, StreamCounts, StreamEvent, StreamFormat, StreamOptions, StreamRefusal,
    StreamSink,
};
