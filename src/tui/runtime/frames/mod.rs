//! The frames of a source.
//!
//! ```text
//! source      the source that a name refers to, and whether it can be watched
//! watcher     a source that is watched and recorded
//! feed        frames that have come and are not on the screen yet, and their recording
//! recording   the file that frames are recorded in
//! ```

pub(super) mod source;

pub(super) mod watcher;

pub(super) mod feed;

pub(super) mod recording;
