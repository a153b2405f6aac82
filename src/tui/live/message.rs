//! Requests to the live page, and reports from its source.

use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;
use std::sync::Arc;

use taxel_core::frame::{FrameError, FrameSize, Rule, RuleOrigin, SetRule};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::number;
use taxel_core::quote::shortened;
use taxel_core::recognition::{AnswerState, Evidence, Model, Noise, UnexplainedDifference};
use taxel_files::acquire::{AcquireOptions, FrameSource, Playback};
use taxel_files::formats::recording::Format;
use taxel_files::storage::ModelChoice;

pub use crate::frames::WatchRequest;
pub use crate::frames::recording::RecordedFrames;
use crate::tui::keys::key::Arrow;
pub use crate::tui::live::feed::{FeedStatus, FrameBatch, SourceGaps, SourceState};
use crate::tui::prompt::read;

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
    Named(u64, Box<NamedImprint>),
    /// The number of the work that would name imprints, and the reason why there is no model.
    NotNamed(u64, String),
}

#[derive(Clone, Debug, PartialEq)]
pub struct NamedImprint {
    pub imprint: Imprint,
    pub state: AnswerState,
    /// The likeliest shapes: one, several in a tie, or none for an imprint that no shape leaves.
    pub names: Vec<String>,
    pub probability: Option<f64>,
    pub nearest: Option<(String, u32)>,
    pub unexplained: Option<UnexplainedDifference>,
}

impl NamedImprint {
    /// Computes the answer of a model about an imprint, under a noise if one is given. A single touch is the
    /// evidence, because the frames of a source may show different shapes.
    pub fn new(model: &Model, imprint: &Imprint, noise: Option<&Noise>) -> Self {
        let touches = [*imprint];
        let evidence = Evidence::of(&touches).under(noise);
        let answer = model.recognise(evidence);
        let name = |shape: usize| model.shapes()[shape].name.clone();
        let shapes = match answer.state {
            AnswerState::Tied => answer.tied,
            _ => answer.shape.into_iter().collect(),
        };
        let nearest = model.nearest_of(evidence);
        let distance = nearest.as_ref().map_or(0, |nearest| nearest.distance);
        let unexplained = noise.and_then(|noise| noise.unexplained(imprint, distance));
        Self {
            imprint: *imprint,
            state: answer.state,
            names: shapes.into_iter().map(name).collect(),
            probability: answer.ranking.first().map(|&(_, probability)| probability),
            nearest: nearest.map(|nearest| (name(nearest.shape), nearest.distance)),
            unexplained: unexplained.filter(|_| !answer.ranking.is_empty()),
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct NamingRequest {
    /// The number of this request. Answers carry it, so late ones of an earlier model can be dropped.
    pub number: u64,
    pub choice: ModelChoice,
    /// The noise: how often a taxel flips.
    pub noise: Option<Noise>,
}

#[derive(Clone, Debug)]
pub struct Naming {
    pub request: NamingRequest,
    pub answer: Option<Box<NamedImprint>>,
    pub failure: Option<String>,
    asked: bool,
}

impl Naming {
    pub fn new(request: NamingRequest) -> Self {
        Self {
            request,
            answer: None,
            failure: None,
            asked: false,
        }
    }

    pub fn ask(&mut self, imprint: &Imprint) -> bool {
        let known = self
            .answer
            .as_ref()
            .is_some_and(|own| own.imprint == *imprint);
        let asks = !self.asked && !known && self.failure.is_none() && !imprint.is_empty();
        self.asked |= asks;
        asks
    }

    pub fn take(&mut self, answer: NamedImprint) {
        self.asked = false;
        self.answer = Some(Box::new(answer));
    }

    pub fn fail(&mut self, reason: String) {
        self.asked = false;
        self.failure = Some(reason);
    }
}

/// The text after `:watch`: a source, whose name may contain spaces, then flags as on the command line:
/// `grip 2.csv --rows 4 --columns 5 --at-least 10`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NamedSource {
    /// The name: a path, `tcp://HOST:PORT`, or `-` for standard input.
    name: String,
    rows: Option<u16>,
    columns: Option<u16>,
    format: Option<&'static Format>,
    baud: Option<u32>,
    channel: Option<String>,
    speed: Option<f64>,
    rule: Option<Rule>,
    model: Option<ModelChoice>,
}

impl NamedSource {
    const FLAGS: [(&'static str, Take); 9] = [
        ("--rows", |source, value| {
            source.rows = Some(value.side()?);
            Ok(())
        }),
        ("--columns", |source, value| {
            source.columns = Some(value.side()?);
            Ok(())
        }),
        ("--format", |source, value| {
            let format = Format::of_stream(value.text);
            source.format = Some(format.map_err(|error| error.to_string())?);
            Ok(())
        }),
        ("--baud", |source, value| {
            source.baud = Some(value.within(&AcquireOptions::BAUDS, "a number")?);
            Ok(())
        }),
        ("--channel", |source, value| {
            source.channel = Some(value.text.to_owned());
            Ok(())
        }),
        ("--speed", |source, value| {
            let speed = number::read(value.text).filter(|&speed| Playback::allows(speed));
            source.speed = Some(speed.ok_or_else(|| value.refused(&Playback::SPEEDS))?);
            Ok(())
        }),
        ("--at-least", |source, value| {
            source.set_rule(value, Rule::at_least)
        }),
        ("--percent", |source, value| {
            source.set_rule(value, Rule::percent)
        }),
        ("--model", |source, value| {
            source.model = Some(ModelChoice::from_text(value.text));
            Ok(())
        }),
    ];

    pub fn flags() -> [&'static str; 9] {
        Self::FLAGS.map(|(name, _)| name)
    }

    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            ..Self::default()
        }
    }

    pub fn read(text: &str) -> Result<Self, String> {
        let (name, rest) = text.split_at(flags_start(text).unwrap_or(text.len()));
        let mut source = Self::new(name.trim());
        let words: Vec<&str> = rest.split_whitespace().collect();
        let known = |flag: &str| Self::FLAGS.iter().position(|(name, _)| *name == flag);
        for (flag, index, text) in read::read_flags(&words, &Self::flags(), known)? {
            if let Some((_, take)) = Self::FLAGS.get(index) {
                take(&mut source, &FlagValue { flag, text })?;
            }
        }
        if source.rows.is_some() != source.columns.is_some() {
            return Err("--rows and --columns go together".to_owned());
        }
        Ok(source)
    }

    /// Takes the value of a threshold, unless there is one already.
    fn set_rule(
        &mut self,
        value: &FlagValue,
        rule: fn(f64) -> Result<Rule, FrameError>,
    ) -> Result<(), String> {
        if self.rule.is_some() {
            return Err("--at-least and --percent do not go together".to_owned());
        }
        let threshold = number::read(value.text).ok_or_else(|| value.refused(&"a number"))?;
        self.rule = Some(rule(threshold).map_err(|error| match error {
            FrameError::Rule { allowed, .. } => value.refused(&format!("a number {allowed}")),
            error => format!("{}: {error}", value.flag),
        })?);
        Ok(())
    }

    /// Returns the request for this source; `settings` provides what is not given.
    pub fn request(&self, settings: &WatchRequest) -> WatchRequest {
        let mut request = settings.clone();
        request.source = FrameSource::named(&self.name);
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
        if let Some(rule) = self.rule {
            let processing = &mut request.pipeline.processing;
            let (least, from) = (processing.least, RuleOrigin::Flag);
            processing.apply_rule(Some(SetRule { rule, least, from }));
        }
        request
    }
}

type Take = fn(&mut NamedSource, &FlagValue) -> Result<(), String>;

struct FlagValue<'a> {
    flag: &'a str,
    text: &'a str,
}

impl FlagValue<'_> {
    fn refused(&self, expected: &dyn fmt::Display) -> String {
        let found = shortened(self.text);
        format!("{} takes {expected}, found {found}", self.flag)
    }

    /// Returns the value as a number in this range; `what` names such numbers.
    fn within<N: FromStr + PartialOrd + fmt::Display>(
        &self,
        range: &RangeInclusive<N>,
        what: &str,
    ) -> Result<N, String> {
        let number = self.text.parse().ok();
        let number = number.filter(|number| range.contains(number));
        number.ok_or_else(|| self.refused(&format!("{what} {}", bounds(range))))
    }

    fn side(&self) -> Result<u16, String> {
        self.within(&FrameSize::SIDES, "a whole number")
    }
}

/// Returns the index of the first flag in the text after `:watch`; None without flags.
pub(in crate::tui) fn flags_start(text: &str) -> Option<usize> {
    text.find(" --").map(|blank| blank + 1)
}

/// Returns the bounds of a number: `from 1 to 512`.
fn bounds(range: &RangeInclusive<impl fmt::Display>) -> String {
    format!("from {} to {}", range.start(), range.end())
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn a_name_may_have_spaces_and_flags_follow_it() {
        let settings = WatchRequest::new("");
        let request = |text: &str| NamedSource::read(text).map(|source| source.request(&settings));
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
        for (text, error) in [
            ("x --rows 4", "--rows and --columns go together"),
            (
                "x --rows 0 --columns 4",
                "--rows takes a whole number from 1 to 512, found 0",
            ),
            (
                "x --at-least 1 --percent 2",
                "--at-least and --percent do not go together",
            ),
            (
                "x --percent 200",
                "--percent takes a number above 0, up to 100, found 200",
            ),
            (
                "x --speed 0",
                "--speed takes a number above 0, up to 1000000, found 0",
            ),
            ("x --baud", "--baud needs a value"),
            (
                "x --format line",
                "format \"line\" is unknown, expected one of jsonl, ros2, flexitac, matsense, lines; did you mean \"lines\"?",
            ),
        ] {
            assert_eq!(request(text).expect_err(text), error);
        }
        let unknown = request("x --at-last 3").expect_err("unknown");
        assert!(
            unknown.ends_with("did you mean \"--at-least\"?"),
            "{unknown}"
        );
    }
}
