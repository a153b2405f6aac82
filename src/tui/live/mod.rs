//! The live page: the frames of a sensor, live or played back, as a heat map with a description.
//!
//! ```text
//! request          which source, and how its frames are looked at
//! named_source     what stands after `:watch`: a source and flags
//! message          what keys ask for, and what the source reports
//! history          the frames that have come, as many as fit into some memory
//! naming           what a model says of the imprint
//! reading          what is read off one frame: values, imprint, descriptors
//! marks            frames that were marked
//! refusal          why something cannot be done with the frame that is shown
//! tare             what is subtracted, and how it is made
//! threshold        what keys make of a threshold
//! range            between which values shades are spread
//! display          how a frame is laid out, as keys choose
//! recording_state  whether frames are recorded, and why not
//! state            which frame is shown and how
//! layout           where taxels and numbers stand
//! heat             the heat map, with the edge of the imprint
//! title            which frame of which source is shown, and how
//! view             the page: heat map, and beside it what can be said of the frame
//! update           what messages do
//! ```

pub mod request;

pub mod named_source;

pub mod message;

pub mod history;

pub mod naming;

pub mod reading;

mod marks;

pub mod refusal;

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

pub mod update;
