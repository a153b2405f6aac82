//! The live page: the frames of a sensor, live or played back, as a heat map with a description.
//!
//! ```text
//! source           the thread that reads a source, and the recording
//! feed             the frames of the source that the page has not taken yet
//! history          the most recent frames, as many as fit into a given amount of memory
//! reading          values, imprint and descriptors of one frame
//! names            the shapes that leave the imprints, by a model
//! state            the state of the page: how the shown frame is processed
//! trend            force and contact over the history
//! heat             the heat map, with the edge of the imprint
//! view             draws the page: the heat map, and beside it the numbers
//! update           handles messages
//! ```

pub mod source;

pub mod feed;

pub mod history;

pub mod reading;

pub(crate) mod names;

pub mod state;

mod heat;

pub mod trend;

pub mod view;

pub mod update;

pub use feed::*;
pub use reading::*;
pub use state::*;

use std::sync::Arc;

use taxel_core::frame::{FrameSize, Rule};
use taxel_files::acquire::FrameSource;

use crate::cli::commands::frame_flags::WatchFlags;
pub use crate::frames::WatchRequest;
use crate::naming::Terms;
use crate::tui::keys::Arrow;

/// Requests by keys and commands.
#[derive(Clone, Debug, PartialEq)]
pub enum LiveMessage {
    Open,
    /// Watches the source of the page again: a recording that does not grow from its start, any other source after its
    /// end.
    Again,
    Watch(Arc<WatchRequest>),
    Source(Box<NamedSource>),
    Tare,
    NoTare,
    Threshold(i8),
    AtLeast(Rule),
    /// Watches the source again, with this size of a frame.
    Size(FrameSize),
    Percent,
    Freeze,
    /// Go on by this many seconds; negative goes back.
    Second(i8),
    /// Go to the begin of the touch this many further on; negative goes back.
    Touch(i8),
    /// Shows the next layer: raw values, tared values or imprint.
    NextLayer,
    /// Plots contact instead of force over the history, or force again.
    Plot,
    Numbers,
    OwnRange,
    Window(Arrow),
    FollowContact,
    Record,
    Mark,
    NameShape,
    Terms(Terms),
}

/// What follows `:watch`: a source, whose name may contain spaces, then flags as on the command line:
/// `grip 2.csv --rows 4 --columns 5 --at-least 10`.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct NamedSource {
    /// The words of the name: a path, `tcp://HOST:PORT`, or `-` for standard input.
    #[arg(value_name = "SOURCE")]
    pub(crate) name: Vec<String>,
    #[command(flatten)]
    flags: WatchFlags,
}

impl PartialEq for NamedSource {
    /// What was typed never changes.
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl NamedSource {
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: vec![name.into()],
            ..Self::default()
        }
    }

    pub fn source(&self) -> FrameSource {
        FrameSource::named(self.name.join(" "))
    }

    /// Returns the request for this source; `settings` provides what is not given. Reads files.
    pub fn request(self, settings: &WatchRequest) -> Result<WatchRequest, String> {
        if self.flags.frames.reads_standard() {
            return Err("a mask or gain from standard input is for the command line".to_owned());
        }
        let request = self.flags.request(self.name.join(" "), settings);
        request.map_err(|failure| failure.text)
    }
}

#[cfg(test)]
mod tests {
    use clap::{Args, FromArgMatches};

    use super::*;

    #[test]
    fn a_name_may_have_spaces_and_flags_follow_it() {
        let settings = WatchRequest::new("");
        let request = |text: &str| {
            let command =
                NamedSource::augment_args(clap::Command::new("watch").no_binary_name(true));
            let matches = command.try_get_matches_from(text.split_whitespace());
            let matches = matches.map_err(|error| error.to_string())?;
            let source = NamedSource::from_arg_matches(&matches).expect("read");
            source.request(&settings)
        };
        let whole = request("my run.csv --rows 4 --columns=5 --baud 9600 --speed 0.5");
        let whole = whole.expect("flags");
        assert_eq!(whole.source, FrameSource::named("my run.csv"));
        let size = FrameSize::new(5, 4).expect("an allowed size");
        let options = &whole.options;
        assert_eq!((options.size, options.baud), (Some(size), Some(9600)));
        let plain = request("a--b.csv").expect("no flags");
        assert_eq!(plain.source.name(), "a--b.csv");
        for wrong in ["x --rows 4", "x --percent 200", "x --baud", "x --at-last 3"] {
            assert!(request(wrong).is_err(), "{wrong}");
        }
    }
}
