//! The live page: the frames of a sensor, live or played back, as a heat map with a description.
//!
//! ```text
//! message          requests by keys and commands
//! source           the thread that reads a source, and the recording
//! feed             the frames of the source that the page has not taken yet
//! history          the most recent frames, as many as fit into a given amount of memory
//! reading          values, imprint and descriptors of one frame
//! names            the shapes that leave the imprints, by a model
//! threshold        the threshold, as keys change it
//! state            the state of the page: how the shown frame is processed
//! trend            force and contact over the history
//! heat             the heat map, with the edge of the imprint
//! view             draws the page: the heat map, and beside it the numbers
//! update           handles messages
//! ```

pub mod message;

pub mod source;

pub mod feed;

pub mod history;

pub mod reading;

pub(crate) mod names;

mod threshold;

pub mod state;

mod heat;

pub mod trend;

pub mod view;

pub mod update;

pub use feed::*;
pub use message::*;
pub use reading::*;
pub use state::*;
