//! The text after `:watch`: a source, then flags as on the command line.
//!
//! ```text
//! watch /dev/ttyACM0 --baud 921600
//! watch grip 2.csv --rows 4 --columns 5 --at-least 10     a name may contain spaces
//! ```

use std::fmt;
use std::ops::RangeInclusive;

use crate::acquire::{AcquireOptions, Playback};
use crate::formats::stream::StreamFormat;
use crate::frame::{FrameError, FrameSize, Rule, RuleOrigin, SetRule};
use crate::parameter::{UnknownName, number};
use crate::quote::shortened;
use crate::storage::ModelChoice;
use crate::tui::live::request::WatchRequest;
use crate::tui::prompt::flags;

/// A source of frames and how to read it. The user's settings apply to what is not given.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NamedSource {
    /// The name: a path, `tcp://HOST:PORT`, or `-` for standard input.
    name: String,
    rows: Option<u16>,
    columns: Option<u16>,
    format: Option<StreamFormat>,
    baud: Option<u32>,
    channel: Option<String>,
    speed: Option<f64>,
    rule: Option<Rule>,
    model: Option<ModelChoice>,
}

impl NamedSource {
    /// The flags, for completion.
    pub const FLAGS: [&'static str; 9] = [
        "--rows",
        "--columns",
        "--format",
        "--baud",
        "--channel",
        "--speed",
        "--at-least",
        "--percent",
        "--model",
    ];

    /// Creates a source without flags.
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            ..Self::default()
        }
    }

    /// Reads a name, and the flags after it, each followed by its value.
    ///
    /// # Errors
    /// Returns a sentence that says what is wrong with the text.
    pub fn read(text: &str) -> Result<Self, String> {
        let (name, rest) = text.split_at(flags_start(text).unwrap_or(text.len()));
        let mut source = Self::new(name.trim());
        let words: Vec<&str> = rest.split_whitespace().collect();
        let known = |flag: &str| Self::FLAGS.into_iter().find(|own| *own == flag);
        for (flag, _, value) in flags::read(&words, &Self::FLAGS, known)? {
            source.take(flag, value)?;
        }
        if source.rows.is_some() != source.columns.is_some() {
            return Err("--rows and --columns go together".to_owned());
        }
        Ok(source)
    }

    /// Takes the value of one flag.
    fn take(&mut self, flag: &str, text: &str) -> Result<(), String> {
        let refused = |expected: &dyn fmt::Display| {
            format!("{flag} takes {expected}, found {}", shortened(text))
        };
        let side = || {
            let side = text.parse().ok();
            let side = side.filter(|side| FrameSize::SIDES.contains(side));
            side.ok_or_else(|| refused(&format!("a whole number {}", bounds(&FrameSize::SIDES))))
        };
        match flag {
            "--rows" => self.rows = Some(side()?),
            "--columns" => self.columns = Some(side()?),
            "--format" => {
                let format = text.parse();
                self.format = Some(format.map_err(|error: UnknownName| error.to_string())?);
            }
            "--baud" => {
                let baud = text.parse().ok();
                let bauds = AcquireOptions::BAUDS;
                let baud = baud.filter(|baud| bauds.contains(baud));
                let expected = || refused(&format!("a number {}", bounds(&bauds)));
                self.baud = Some(baud.ok_or_else(expected)?);
            }
            "--channel" => self.channel = Some(text.to_owned()),
            "--model" => self.model = Some(ModelChoice::from_text(text)),
            "--speed" => {
                let speed = number::read(text).filter(|&speed| Playback::allows(speed));
                self.speed = Some(speed.ok_or_else(|| refused(&Playback::SPEEDS))?);
            }
            _ if self.rule.is_some() => {
                return Err("--at-least and --percent do not go together".to_owned());
            }
            _ => {
                let value = number::read(text).ok_or_else(|| refused(&"a number"))?;
                let rule = match flag {
                    "--percent" => Rule::percent(value),
                    _ => Rule::at_least(value),
                };
                self.rule = Some(rule.map_err(|error| match error {
                    FrameError::Rule { allowed, .. } => refused(&format!("a number {allowed}")),
                    error => format!("{flag}: {error}"),
                })?);
            }
        }
        Ok(())
    }

    /// Returns the request for this source; `settings` provides what is not given.
    pub fn request(&self, settings: &WatchRequest) -> WatchRequest {
        let mut request = settings.for_source(&self.name);
        request.baud_named = self.baud.is_some();
        let options = &mut request.options;
        options.size = FrameSize::of_sides(self.columns, self.rows).or(options.size);
        options.format = self.format.or(options.format);
        options.baud = self.baud.unwrap_or(options.baud);
        options.channel = self.channel.clone().or(options.channel.take());
        if let Some(speed) = self.speed {
            options.playback = Playback::paced(speed, options.playback.repeats());
        }
        request.model = self.model.clone().or(request.model);
        if let Some(rule) = self.rule {
            let least = request.rule.as_ref().map_or(0, |set| set.least);
            let from = RuleOrigin::Flag;
            request.rule = Some(SetRule { rule, least, from });
        }
        request
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
    use crate::acquire::SourceName;

    #[test]
    fn a_name_may_have_spaces_and_flags_follow_it() {
        let settings = WatchRequest::new("");
        let request = |text: &str| NamedSource::read(text).map(|source| source.request(&settings));
        let whole = request(
            "my run.csv --rows 4 --columns=5 --baud 9600 --at-least 10 --channel left --speed 0.5 --model figures-30",
        );
        let whole = whole.expect("flags");
        assert_eq!(whole.source, SourceName::new("my run.csv"));
        let options = &whole.options;
        assert_eq!(
            (options.size, options.baud),
            (Some(FrameSize::of(5, 4)), 9600)
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
        let rule = whole.rule.expect("a rule");
        assert_eq!(rule.rule, Rule::at_least(10.0).expect("in range"));
        let plain = request("a--b.csv").expect("no flags");
        assert_eq!(
            (plain.source.to_string(), plain.rule),
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
                "format \"line\" is unknown, expected one of lines, jsonl, ros2, flexitac, matsense",
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
