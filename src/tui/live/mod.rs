//! The live page: the frames of a sensor, live or played back, as a heat map with a description.
//!
//! ```text
//! request          the source to watch, and how its frames are processed
//! named_source     the text after `:watch`: a source and flags
//! message          requests by keys and commands, and reports from the source
//! history          the most recent frames, as many as fit into a given amount of memory
//! cursor           which frame is shown: the newest one, or one that the user stays at
//! naming           what a model says about the imprint
//! names            the sets of shapes that name imprints
//! reading          values, imprint and descriptors of one frame
//! marks            the marked frames
//! refusal          why something cannot be done with the shown frame
//! tare             the values that are subtracted, and how they are determined
//! threshold        how keys change the threshold
//! range            the range of values that the shades cover
//! display          how a frame is laid out, as chosen by keys
//! recording_state  whether frames are recorded, and if not, why
//! state            the state of the page: how the shown frame is processed
//! layout           the places of taxels and numbers on the screen
//! heat             the heat map, with the edge of the imprint
//! title            the title: which frame of which source is shown, and how
//! view             draws the page: the heat map, and beside it the numbers
//! watch            the watched source and its page: opened, set aside, and opened again
//! taken_imprint    the imprint of the shown frame, which Enter puts onto the matrix
//! report           handles the reports of the source
//! update           handles messages
//! ```

pub mod request;

pub mod named_source;

pub mod message;

pub mod history;

pub mod naming;

pub mod names;

pub mod reading;

mod marks;

pub mod refusal;

mod cursor;

pub mod tare;

mod threshold;

mod range;

pub mod display;

pub mod recording_state;

pub mod state;

mod layout;

mod heat;

mod title;

pub mod view;

pub mod watch;

mod taken_imprint;

pub mod report;

pub mod update;
