//! `taxel recognise`: names the shape that left an imprint, or the shapes that left many.
//!
//! An imprint is answered in words or by a JSON object. Lines of JSON are answered by a line each, with or without
//! `--json`. Keys that tell where a touch comes from are copied to the beginning of the answer.

use std::ffi::OsStr;
use std::io::{self, BufRead, BufReader, Cursor, Read, Write};
use std::sync::atomic::{AtomicU64, Ordering};

use serde::de::IgnoredAny;
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;
use taxel_core::imprint::Imprint;
use taxel_core::progress::ToTheEnd;
use taxel_core::quote::did_you_mean;
use taxel_core::recognition::{Answer, AnswerState, Evidence, Model, NamedShape, Noise};
use taxel_core::sensor::Sensor;
use taxel_files::ReadError;
use taxel_files::formats::file::without_mark;
use taxel_files::formats::job::{FrameRows, RuleRecord};
use taxel_files::formats::value::counted;
use taxel_files::formats::{Content, json};
use taxel_files::memory::MemoryGuard;
use taxel_files::storage::FoundModel;

use crate::cli::arguments::frames::NamingArguments;
use crate::cli::arguments::recognise::RecogniseArguments;
use crate::cli::commands::model;
use crate::cli::error::CliError;
use crate::cli::input::content;
use crate::cli::input::lines::{self, LineInput, MAX_LINE};
use crate::cli::input::shapes::{Located, Shelf};
use crate::cli::output::answer::{AnswerJson, AnswerText, PoseReport};
use crate::cli::output::charset::{Charset, note};
use crate::cli::output::progress::ProgressDisplay;

pub(crate) fn recognise(
    asked: &RecogniseArguments,
    shelf: &Shelf,
    charset: Charset,
    output: &mut dyn Write,
) -> Result<(), CliError> {
    let model = model::find(&asked.model, shelf)?;
    let noise = noise(asked, shelf)?;
    let input = input(&asked.what, shelf)?;
    if let Some(expected) = &asked.expect {
        check_expected(expected, model.shapes())?;
    }
    let model = model::ready(model, &|poses| ProgressDisplay::new(poses, false, charset))?;
    let recogniser = Recogniser {
        asked,
        model: &model,
        noise,
    };
    match input {
        RecogniseInput::Touch(content) => {
            if let Some(text) = recogniser.other_threshold(&content) {
                note(&text, charset);
            }
            recogniser.answer_imprint(content.imprint(), charset, output)
        }
        RecogniseInput::Lines(input) => recogniser.answer_lines(input, output),
    }
}

const MOST_LISTED: usize = 10;

fn check_expected(name: &str, shapes: &[NamedShape]) -> Result<(), CliError> {
    if shapes.iter().any(|shape| shape.name == name) {
        return Ok(());
    }
    let names = shapes.iter().map(|shape| shape.name.as_str());
    let mut listed: Vec<&str> = names.clone().take(MOST_LISTED).collect();
    if listed.len() < shapes.len() {
        listed.push("…");
    }
    Err(CliError::NotInModel {
        name: name.to_owned(),
        shapes: listed.join(", "),
        near: did_you_mean(name, names),
    })
}

struct Recogniser<'a> {
    asked: &'a RecogniseArguments,
    model: &'a Model,
    noise: Option<Noise>,
}

impl Recogniser<'_> {
    fn other_threshold(&self, content: &Content) -> Option<String> {
        let Content::Shape(shape) = content else {
            return None;
        };
        let [trained, own] = [self.model.sensor(), &shape.sensor].map(Sensor::threshold);
        (shape.source.is_some() && own != trained).then(|| {
            format!(
                "{}: touched at threshold {own}, but the model was trained at {trained}",
                shape.name
            )
        })
    }

    fn answer_imprint(
        &self,
        imprint: &Imprint,
        charset: Charset,
        output: &mut dyn Write,
    ) -> Result<(), CliError> {
        let touches = [*imprint];
        let answer = self.answer(&touches)?;
        let text = if self.asked.json {
            json::ascii(&self.json(&touches, &answer, None)?) + "\n"
        } else {
            let text = AnswerText {
                model: self.model,
                touch: imprint,
                answer: &answer,
                top: self.asked.top,
                noise: self.noise,
            };
            let pose = match self.pose(&touches, &answer)? {
                Some(pose) => pose.text(imprint, charset),
                None if self.asked.pose && imprint.is_empty() => {
                    "no pose: an empty imprint does not tell where the shape lies\n".to_owned()
                }
                None if self.asked.pose && answer.shape.is_some() => {
                    "no pose: the shape leaves this imprint in no pose of the model\n".to_owned()
                }
                None => String::new(),
            };
            text.text(charset) + &pose
        };
        output.write_all(text.as_bytes()).map_err(CliError::Write)?;
        output.flush().map_err(CliError::Write)?;
        match &self.asked.expect {
            Some(expected) if !self.is_expected(&answer) => Err(CliError::Unexpected {
                expected: expected.clone(),
                found: self.found(&answer),
            }),
            _ => Ok(()),
        }
    }

    fn answer_lines(&self, input: LineInput, output: &mut dyn Write) -> Result<(), CliError> {
        let (all, others) = (AtomicU64::new(0), AtomicU64::new(0));
        let answer = |line: &[u8], text: &mut Vec<u8>| {
            let line = RecogniseLine::read(line).map_err(|error| error.to_string())?;
            let answer = self.answer(&line.touches);
            let answer = answer.map_err(|error| error.to_string())?;
            all.fetch_add(1, Ordering::Relaxed);
            if !self.is_expected(&answer) {
                others.fetch_add(1, Ordering::Relaxed);
            }
            let json = self.json(&line.touches, &answer, Some(&line));
            let json = json.map_err(|error| error.to_string())?;
            json::extend_ascii(text, &json);
            Ok(())
        };
        lines::answer_all(self.asked.jobs, input, output, "touch", || answer)?;
        match (&self.asked.expect, others.into_inner()) {
            (Some(expected), others @ 1..) => {
                let all = counted(all.into_inner(), "line");
                Err(CliError::Unexpected {
                    expected: expected.clone(),
                    found: format!("another answer or none for {others} of {all}"),
                })
            }
            _ => Ok(()),
        }
    }

    fn evidence<'b>(&'b self, touches: &'b [Imprint]) -> Evidence<'b> {
        Evidence::of(touches).under(self.noise.as_ref())
    }

    fn answer(&self, touches: &[Imprint]) -> Result<Answer, CliError> {
        let mut evidence = self.evidence(touches);
        if let Some(mask) = self.noise.as_ref().and_then(Noise::dead)
            && let Some(other) = touches.iter().find(|touch| touch.size() != mask.size())
        {
            return Err(CliError::Mask {
                mask: mask.size(),
                imprint: other.size(),
            });
        }
        evidence.reject_below = self.asked.reject;
        Ok(self.model.recognise(evidence))
    }

    fn json<'b>(
        &'b self,
        touches: &[Imprint],
        answer: &'b Answer,
        line: Option<&'b RecogniseLine>,
    ) -> Result<AnswerJson<'b>, CliError> {
        Ok(AnswerJson {
            model: self.model,
            answer,
            noise: self.asked.noise,
            nearest: self.model.nearest_of(self.evidence(touches)),
            top: self.asked.top,
            asks_pose: self.asked.pose,
            pose: self.pose(touches, answer)?,
            copied: line.map(RecogniseLine::copied).unwrap_or_default(),
        })
    }

    /// Returns where the shape of an answer lies in the last touch, if this is asked for. None without an answer, and
    /// if the shape does not leave this imprint.
    fn pose(&self, touches: &[Imprint], answer: &Answer) -> Result<Option<PoseReport>, CliError> {
        let (true, Some(shape), Some(touch)) = (self.asked.pose, answer.shape, touches.last())
        else {
            return Ok(None);
        };
        let memory = MemoryGuard::new(None, "train the model in coarser steps to see poses");
        let estimate = memory.limit(&ToTheEnd, |progress| {
            self.model.pose_of(shape, touch, progress)
        });
        let estimate = estimate.map_err(CliError::Memory)?;
        Ok(estimate.and_then(|estimate| {
            PoseReport::new(self.model, shape, touch, estimate, self.asked.pitch_mm)
        }))
    }

    fn is_expected(&self, answer: &Answer) -> bool {
        let Some(expected) = &self.asked.expect else {
            return true;
        };
        let named = answer.shape.map(|shape| &self.model.shapes()[shape].name);
        answer.state != AnswerState::Tied && named == Some(expected)
    }

    fn found(&self, answer: &Answer) -> String {
        let name = |shape: usize| format!("{:?}", self.model.shapes()[shape].name);
        let named = match answer.shape {
            _ if answer.state == AnswerState::Tied => {
                let names = answer.tied.iter().map(|&shape| name(shape));
                names.collect::<Vec<_>>().join(" or ")
            }
            Some(shape) => name(shape),
            None => "no shape".to_owned(),
        };
        format!("{named} ({})", answer.state.name())
    }
}

fn noise(asked: &RecogniseArguments, shelf: &Shelf) -> Result<Option<Noise>, CliError> {
    Ok(match (asked.noise, &asked.mask) {
        (Some(noise), Some(mask)) => {
            let mask = shelf.find(mask).map_err(|error| error.of_flag("--mask"))?;
            Some(noise.with_dead(*mask.imprint()))
        }
        (noise, _) => noise,
    })
}

#[expect(clippy::large_enum_variant, reason = "there is one of these at a time")]
enum RecogniseInput {
    Touch(Content),
    Lines(LineInput),
}

fn input(what: &OsStr, shelf: &Shelf) -> Result<RecogniseInput, CliError> {
    let LineInput { name, read } = match shelf.locate(what)? {
        Located::Shape(shape) => return Ok(RecogniseInput::Touch(Content::Shape(shape))),
        Located::File(path, file) => LineInput::of_file(path, file),
        Located::Standard => LineInput::standard()?,
    };
    let refused = |error: content::InputError| CliError::Input {
        name: name.clone(),
        error,
    };
    let mut input = BufReader::new(read);
    let (mut blank, mut start) = (0, Vec::new());
    loop {
        let length = line(&mut input, &mut start).map_err(|error| refused(error.into()))?;
        if length == 0 || !start.trim_ascii().is_empty() {
            break;
        }
        start.clear();
        blank += 1;
    }
    // Blank lines are not kept, since there may be many, but they count.
    let blank = io::repeat(b'\n').take(blank);
    let is_line = is_line(&start);
    let whole = blank.chain(Cursor::new(start)).chain(input);
    if is_line {
        let read = Box::new(whole);
        return Ok(RecogniseInput::Lines(LineInput { name, read }));
    }
    Ok(RecogniseInput::Touch(
        content::read_from(whole).map_err(refused)?,
    ))
}

fn line(input: &mut impl BufRead, start: &mut Vec<u8>) -> io::Result<usize> {
    let mut limited = Read::by_ref(input).take(MAX_LINE as u64);
    limited.read_until(b'\n', start)
}

/// Returns true if the first line of a text is a question: a whole JSON object that is not a stored shape, even if it
/// is wrong. An object that does not end in this line is a stored shape.
fn is_line(text: &[u8]) -> bool {
    #[derive(Deserialize)]
    struct FormatKey {
        format: Option<IgnoredAny>,
    }
    let text = without_mark(text);
    if !text.trim_ascii_start().starts_with(b"{") {
        return false;
    }
    match serde_json::from_slice::<FormatKey>(text) {
        Ok(keys) => keys.format.is_none(),
        Err(error) => !error.is_eof(),
    }
}

const ONE_KEY: &str = "expected exactly one of the keys frame (with values), imprint, touches";

const NO_IMPRINT: &str = "imprint: null, as of a frame without a threshold; set one where the frame is read, such as --at-least";

#[derive(Deserialize)]
#[serde(expecting = "an object with an imprint, touches or a frame")]
struct LineKeys {
    /// The inner value is None for `null`, as of a frame without a threshold.
    #[serde(default, deserialize_with = "given")]
    #[expect(
        clippy::option_option,
        reason = "a missing key and null have messages of their own"
    )]
    imprint: Option<Option<Imprint>>,
    touches: Option<Vec<Imprint>>,
    frame: Option<Box<RawValue>>,
    #[serde(default, deserialize_with = "given")]
    label: Option<Box<RawValue>>,
    #[serde(default, deserialize_with = "given")]
    time: Option<Box<RawValue>>,
    #[serde(default, deserialize_with = "given")]
    channel: Option<Box<RawValue>>,
}

/// Returns the message about a line with none of the keys of a touch, or several of them. If another command reads
/// such lines, the message names it.
fn no_touch(line: &[u8]) -> String {
    match content::line_of_sources(line) {
        Some((what, command)) => format!("{ONE_KEY}; if this is {what}, use taxel {command}"),
        None => ONE_KEY.to_owned(),
    }
}

fn given<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    T::deserialize(deserializer).map(Some)
}

fn framed(line: &[u8], frame: Option<&RawValue>) -> Result<Option<Imprint>, ReadError> {
    let Some(frame) = frame.filter(|frame| frame.get().starts_with('[')) else {
        return Ok(None);
    };
    let rows: FrameRows = serde_json::from_str(frame.get())
        .map_err(|error| ReadError::new(json::message(&error)).of_key("frame"))?;
    let rule: RuleRecord = json::of_line(line)?;
    rule.imprint(&rows).map(Some)
}

struct RecogniseLine {
    touches: Vec<Imprint>,
    copied: Vec<(&'static str, Box<RawValue>)>,
}

impl RecogniseLine {
    /// Reads a line. Other keys are ignored, so that answers of `taxel frames` can be given as they are.
    fn read(line: &[u8]) -> Result<Self, ReadError> {
        let without_nan = json::WithoutNan::new(line);
        let keys: LineKeys = without_nan.object()?;
        let line = &*without_nan.line;
        let framed = framed(line, keys.frame.as_deref())?;
        let is_framed = framed.is_some();
        let touches = match (framed, keys.imprint, keys.touches) {
            (Some(framed), None | Some(None), None) => vec![framed],
            (Some(_), ..) => return Err(ReadError::new(ONE_KEY)),
            (None, Some(Some(imprint)), None) => vec![imprint],
            (None, Some(None), None) => return Err(ReadError::new(NO_IMPRINT)),
            (None, None, Some(touches)) if !touches.is_empty() => touches,
            (None, None, Some(_)) => {
                return Err(ReadError::new("touches: empty, expected at least one"));
            }
            _ => return Err(ReadError::new(no_touch(line))),
        };
        // Values of a frame are not copied.
        let copied = [
            ("frame", keys.frame.filter(|_| !is_framed)),
            ("label", keys.label),
            ("time", keys.time),
            ("channel", keys.channel),
        ];
        let copied = copied.into_iter();
        Ok(Self {
            touches,
            copied: copied
                .filter_map(|(key, value)| Some((key, value?)))
                .collect(),
        })
    }

    fn copied(&self) -> Vec<(&'static str, &RawValue)> {
        self.copied
            .iter()
            .map(|(key, value)| (*key, &**value))
            .collect()
    }
}

impl NamingArguments {
    pub(crate) fn find(&self, shelf: &Shelf) -> Result<Option<FoundModel>, CliError> {
        let model = self.model.as_ref();
        model.map(|model| model::find(model, shelf)).transpose()
    }
}

#[derive(Debug)]
pub(crate) struct FrameNamer<'a> {
    model: &'a Model,
    noise: Option<Noise>,
}

impl<'a> FrameNamer<'a> {
    pub(crate) fn new(model: &'a Model, noise: Option<&Noise>) -> Self {
        Self {
            model,
            noise: noise.copied(),
        }
    }

    fn evidence<'b>(&'b self, touches: &'b [Imprint]) -> Evidence<'b> {
        Evidence::of(touches).under(self.noise.as_ref())
    }

    /// Adds the key `recognition` to the end of a frame's line of JSON: the answer of `taxel recognise` to the
    /// imprint, or null if no taxel is active.
    pub(crate) fn extend(&self, line: &mut Vec<u8>, imprint: Option<&Imprint>) {
        let Some(end) = line.iter().rposition(|&byte| byte == b'}') else {
            return;
        };
        line.truncate(end);
        line.extend(b",\"recognition\":");
        match imprint.filter(|imprint| !imprint.is_empty()) {
            None => line.extend(b"null"),
            Some(imprint) => {
                let touches = [*imprint];
                let evidence = self.evidence(&touches);
                let answer = AnswerJson {
                    model: self.model,
                    answer: &self.model.recognise(evidence),
                    noise: self.noise,
                    nearest: self.model.nearest_of(evidence),
                    top: None,
                    asks_pose: false,
                    pose: None,
                    copied: Vec::new(),
                };
                json::extend_ascii(line, &answer);
            }
        }
        line.extend(b"}\n");
    }

    pub(crate) fn text(&self, imprint: &Imprint, charset: Charset) -> String {
        if imprint.is_empty() {
            return String::new();
        }
        let touches = [*imprint];
        let answer = self.model.recognise(self.evidence(&touches));
        let text = AnswerText {
            model: self.model,
            touch: imprint,
            answer: &answer,
            top: None,
            noise: self.noise,
        };
        text.text(charset)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_distinguished_from_stored_shapes() {
        assert!(is_line(b"{\"imprint\":[\"##\"]}\n"));
        assert!(is_line(b"{\"imprint\":}\n"));
        assert!(!is_line(b"{\"format\":\"taxel-shape/1\"}\n"));
        assert!(!is_line(b"##..\n"));
        assert!(!is_line(b"{\n"));
    }
}
