//! Requests to the live page, and reports from its source.

use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;
use std::sync::Arc;

use taxel_core::frame::{FrameError, FrameSize, Rule, RuleOrigin, SetRule};
use taxel_core::parameter::number;
use taxel_files::acquire::{AcquireOptions, FrameSource, Playback};
use taxel_files::formats::recording::Format;
use taxel_files::storage::ModelChoice;

pub use crate::frames::WatchRequest;
pub use crate::frames::recording::RecordedFrames;
use crate::tui::keys::key::Arrow;
pub use crate::tui::live::feed::{FeedStatus, FrameBatch, SourceGaps, SourceState};

#[derive(Clone, Debug, PartialEq)]
pub enum LiveMessage {
    Open,
    /// Watches the source of the page again: a recording that does not grow from its start, any other source after its
    /// end.
    Again,
    Watch(Arc<WatchRequest>),
    Source(NamedSource),
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
    PeakHold,
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
}

#[derive(Clone, Debug, PartialEq)]
pub enum LiveEvent {
    Waiting,
    /// Everything that has come since the last time.
    Arrived(Arc<FrameBatch>),
    Recording(String),
    /// The recording has ended; the file, and the frames in it and not in it.
    Recorded(String, RecordedFrames),
    /// The reason why the recording cannot be begun.
    NotRecorded(String),
    NotFinished(String),
}

/// What follows `:watch`: a source, whose name may contain spaces, then flags as on the command line:
/// `grip 2.csv --rows 4 --columns 5 --at-least 10`.
#[derive(Clone, Debug, Default, PartialEq, clap::Args)]
pub struct NamedSource {
    /// The words of the name: a path, `tcp://HOST:PORT`, or `-` for standard input.
    #[arg(value_name = "SOURCE")]
    name: Vec<String>,
    #[arg(long, requires = "columns", value_parser = side)]
    rows: Option<u16>,
    #[arg(long, requires = "rows", value_parser = side)]
    columns: Option<u16>,
    #[arg(long, value_parser = Format::of_stream)]
    format: Option<&'static Format>,
    #[arg(long, value_parser = |text: &str| within(text, &AcquireOptions::BAUDS))]
    baud: Option<u32>,
    #[arg(long)]
    channel: Option<String>,
    #[arg(long, value_parser = speed)]
    speed: Option<f64>,
    #[arg(long, value_parser = |text: &str| rule(text, Rule::at_least), allow_hyphen_values = true)]
    at_least: Option<Rule>,
    #[arg(long, value_parser = |text: &str| rule(text, Rule::percent), conflicts_with = "at_least")]
    percent: Option<Rule>,
    #[arg(long, value_parser = |text: &str| Ok::<_, String>(ModelChoice::from_text(text)))]
    model: Option<ModelChoice>,
}

fn within<N: FromStr + PartialOrd + fmt::Display>(
    text: &str,
    range: &RangeInclusive<N>,
) -> Result<N, String> {
    let number = text.parse().ok().filter(|number| range.contains(number));
    let (first, last) = (range.start(), range.end());
    number.ok_or_else(|| format!("expected a whole number from {first} to {last}"))
}

fn side(text: &str) -> Result<u16, String> {
    within(text, &FrameSize::SIDES)
}

fn speed(text: &str) -> Result<f64, String> {
    let speed = number::read(text).filter(|&speed| Playback::allows(speed));
    speed.ok_or_else(|| format!("expected {}", Playback::SPEEDS))
}

fn rule(text: &str, of: fn(f64) -> Result<Rule, FrameError>) -> Result<Rule, String> {
    let value = number::read(text).ok_or_else(|| number::complaint(text))?;
    of(value).map_err(|error| error.to_string())
}

impl NamedSource {
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: vec![name.into()],
            ..Self::default()
        }
    }

    pub fn is_unnamed(&self) -> bool {
        self.name.is_empty()
    }

    /// Returns the request for this source; `settings` provides what is not given.
    pub fn request(&self, settings: &WatchRequest) -> WatchRequest {
        let mut request = settings.clone();
        request.source = FrameSource::named(&self.name.join(" "));
        request.baud_named = self.baud.is_some();
        let options = &mut request.options;
        options.size = FrameSize::of_sides(self.columns, self.rows).or(options.size);
        options.format = self.format.or(options.format);
        options.baud = self.baud.or(options.baud);
        options.channel = self.channel.clone().or(options.channel.take());
        if let Some(speed) = self.speed {
            options.playback = Playback::paced(speed, options.playback.repeats());
        }
        request.model = self.model.clone().or(request.model);
        if let Some(rule) = self.at_least.or(self.percent) {
            let processing = &mut request.pipeline.processing;
            let (least, from) = (processing.least, RuleOrigin::Flag);
            processing.apply_rule(Some(SetRule { rule, least, from }));
        }
        request
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
            matches.map(|found| {
                NamedSource::from_arg_matches(&found)
                    .expect("read")
                    .request(&settings)
            })
        };
        let whole = request(
            "my run.csv --rows 4 --columns=5 --baud 9600 --at-least 10 --channel left --speed 0.5 --model figures-30",
        );
        let whole = whole.expect("flags");
        assert_eq!(whole.source, FrameSource::named("my run.csv"));
        let options = &whole.options;
        assert_eq!(
            (options.size, options.baud),
            (
                Some(FrameSize::new(5, 4).expect("an allowed size")),
                Some(9600)
            )
        );
        assert_eq!(
            (options.channel.as_deref(), options.playback),
            (
                Some("left"),
                Playback::Paced {
                    speed: 0.5,
                    repeat: false
                }
            )
        );
        assert_eq!(whole.model, Some(ModelChoice::EqualFigures));
        let rule = whole.pipeline.processing.rule;
        assert_eq!(rule, Some(Rule::at_least(10.0).expect("in range")));
        let plain = request("a--b.csv").expect("no flags");
        assert_eq!(
            (plain.source.name(), plain.pipeline.processing.rule),
            ("a--b.csv".to_owned(), None)
        );
        for wrong in [
            "x --rows 4",
            "x --rows 0 --columns 4",
            "x --at-least 1 --percent 2",
            "x --percent 200",
            "x --speed 0",
            "x --baud",
            "x --format line",
            "x --at-last 3",
        ] {
            assert!(request(wrong).is_err(), "{wrong}");
        }
    }
}
