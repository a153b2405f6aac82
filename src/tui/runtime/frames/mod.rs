//! The frames of a source.
//!
//! ```text
//! source      the source that a name refers to, and whether it can be watched
//! watcher     a source that is watched and recorded
//! feed        frames that have come and are not on the screen yet, and their recording
//! pending     the frames and the state of the source that the screen takes next
//! no_frame    the reasons why a source gives no frame
//! script      a source that is read frame by frame, for a script
//! recording   the file that frames are recorded in
//! ```

pub(super) mod source;

pub(super) mod watcher;

pub(super) mod feed;

mod pending;

mod no_frame;

pub(super) mod script;

pub(super) mod recording;
