//! `taxel recognise`, and the names of frames: which shape left an imprint, or many of them.
//!
//! [`Namer`] makes every answer of recognition; `output/answer` says it in words and in JSON. Lines of JSON are answered
//! by a line each, with or without `--json`. Keys that tell where a touch comes from are copied to the beginning of the
//! answer.

use std::ffi::OsString;
use std::io::{self, BufRead, BufReader, Cursor, Read};

use serde::de::IgnoredAny;
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;
use taxel_core::imprint::Imprint;
use taxel_core::index::wide;
use taxel_core::progress::ToTheEnd;
use taxel_core::recognition::{Answer, Model, Noise, NoiseError};
use taxel_files::ReadError;
use taxel_files::formats::file::without_mark;
use taxel_files::formats::{Content, json};
use taxel_files::memory::MemoryGuard;
use taxel_files::storage::FoundModel;

use crate::cli::Context;
use crate::cli::arguments::flags::{name_or_path, parse_number, parse_probability, whole};
use crate::cli::arguments::parameters::PitchFlag;
use crate::cli::commands::model;
use crate::cli::failure::{Failure, Named};
use crate::cli::input::content::Input;
use crate::cli::input::lines::{self, MAX_LINE};
use crate::cli::input::shapes::{Located, Shelf};
use crate::cli::output::answer::{PoseReport, Recognition};
use crate::naming::Terms;

const EXAMPLES: &str = r#"Reads an imprint in any format that 'taxel describe' reads, or lines of JSON:
  {"imprint":["..##",...]}              one touch
  {"touches":[[...],[...]]}             several touches of one shape
Each line gets one line as its answer, with a copy of the line's frame number,
label, time and channel; other keys are ignored.

The likeliest shapes are moved and turned until they leave nearly the imprint.
The one that fits best is the answer, unless more taxels differ than --tolerance
allows: then it is none of these. The search may miss a better fit. The place of
a fit is that of 'taxel figure' and 'taxel picture': x0, y0, angle. An imprint
at the rim may be cut off, so it is never 'certain'. With --noise 0, nothing is
fitted: the answer is a shape that leaves just this imprint in a trained pose.

Built-in models: 'library', all shapes of the library; 'shapes', those that come
with taxel; 'figures', the seven figures at their default sizes; 'figures-30',
the same figures at about 30 cells each.

Examples:
  taxel recognise touch.txt --model figures-30 --pose
  taxel recognise washer --model shipped.npz --top 3
  taxel batch < poses.jsonl | taxel recognise - --model parts
  taxel recognise imprint.txt --model parts --noise 0.02 --mask dead.txt"#;

/// Name the shape that left an imprint
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, mut_arg("pitch_mm", |pitch| pitch.requires("pose")))]
pub(crate) struct Recognise {
    /// Imprint: shape of the library, or file; '-' for standard input
    #[arg(value_name = "NAME|FILE", value_parser = name_or_path())]
    what: OsString,
    /// Name or file of a model; built in are library (default), figures, figures-30 and shapes
    #[arg(long, value_name = "MODEL", value_parser = name_or_path())]
    model: Option<OsString>,
    /// Show only the K likeliest shapes
    #[arg(long, value_name = "K", value_parser = whole(1_u32..))]
    top: Option<u32>,
    /// Reject answers less probable than P (0 to 1)
    #[arg(long, value_name = "P", value_parser = parse_probability)]
    reject: Option<f64>,
    #[command(flatten)]
    terms: TermsFlags,
    /// Imprint whose active taxels are dead, stuck on or off
    #[arg(long, value_name = "NAME|FILE", value_parser = name_or_path())]
    mask: Option<OsString>,
    /// Say where the shape lies and how it is turned
    #[arg(long)]
    pose: bool,
    #[command(flatten)]
    pitch: PitchFlag,
    /// Threads; default all cores
    #[arg(long, value_name = "N", value_parser = whole(1_u16..=1024))]
    jobs: Option<u16>,
    /// Print JSON, one line per answer
    #[arg(long)]
    json: bool,
}

/// The model that names the shapes of frames.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Recognition")]
#[command(mut_arg("noise", |noise| noise.requires("model")))]
#[command(mut_arg("tolerance", |tolerance| tolerance.requires("model")))]
pub(crate) struct NamingFlags {
    /// Name the shape that left the imprint: name or file of a model; built in are library (default), figures, figures-30 and shapes
    #[arg(long, value_name = "MODEL", value_parser = name_or_path())]
    #[arg(num_args = 0..=1, default_missing_value = model::DEFAULT)]
    pub(crate) model: Option<OsString>,
    #[command(flatten)]
    pub(crate) terms: TermsFlags,
}

impl NamingFlags {
    /// What names frames, if it is asked for, once a built-in model is trained: [`FoundNamer::ready`]. The cells of
    /// `mask` are dead.
    pub(crate) fn find(
        &self,
        mask: Option<&Imprint>,
        shelf: &Shelf,
    ) -> Result<Option<FoundNamer>, Failure> {
        let terms = self.terms.terms()?;
        let found = self.model.as_ref().map(|model| model::find(model, shelf));
        Ok(found
            .transpose()?
            .map(|found| FoundNamer(found, terms, mask.copied())))
    }
}

#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct TermsFlags {
    /// Each taxel flips with this probability (below 0.5); 0 allows trained poses only
    #[arg(long, value_name = "E", value_parser = noise)]
    noise: Option<f64>,
    /// A shape fits if at most K taxels differ; default 2 or more, by outline and noise
    #[arg(long, value_name = "K", value_parser = whole(0_u32..))]
    tolerance: Option<u32>,
}

impl TermsFlags {
    pub(crate) fn terms(&self) -> Result<Terms, Failure> {
        if self.tolerance.is_some() && self.noise == Some(0.0) {
            return Err(Failure::usage(
                "the argument '--tolerance <K>' cannot be used with '--noise 0', which fits no shape",
            ));
        }
        Ok(Terms {
            noise: self.noise,
            tolerance: self.tolerance,
            reject_below: None,
        })
    }
}

pub(crate) fn noise(text: &str) -> Result<f64, String> {
    let noise = Noise::new(parse_number(text)?);
    let flip = noise.map(|noise| noise.flip());
    flip.map_err(|error: NoiseError| error.expected().to_owned())
}

/// A [`Namer`] whose model may have to be trained.
#[derive(Debug)]
pub(crate) struct FoundNamer(FoundModel, Terms, Option<Imprint>);

impl FoundNamer {
    /// Trains the shapes of a built-in model that are not in the cache.
    pub(crate) fn ready(self) -> Result<Namer, Failure> {
        Ok(Namer {
            model: model::ready(self.0, false)?,
            terms: self.1,
            mask: self.2,
            top: None,
            asks_pose: false,
            pitch_mm: None,
        })
    }
}

/// Names the shapes that left imprints.
#[derive(Debug)]
pub(crate) struct Namer {
    pub(crate) model: Model,
    pub(crate) terms: Terms,
    /// The dead taxels.
    mask: Option<Imprint>,
    /// The number of shapes of the ranking that are shown; None for the likely ones in words and all in JSON.
    pub(crate) top: Option<usize>,
    pub(crate) asks_pose: bool,
    /// The pitch for poses, if it is known.
    pub(crate) pitch_mm: Option<f64>,
}

impl Namer {
    pub(crate) fn answer(&self, touches: &[Imprint]) -> Recognition<'_> {
        let dead = self.mask.as_ref();
        Recognition {
            namer: self,
            answer: self.terms.answer(&self.model, touches, dead),
            dead: dead.filter(|dead| !dead.is_empty()),
            pose: None,
            copied: Vec::new(),
        }
    }

    /// The answer to touches that may not fit the mask, with the pose if it is asked for.
    fn checked_answer(&self, touches: &[Imprint]) -> Result<Recognition<'_>, Failure> {
        let mask = self.mask.as_ref();
        for touch in touches.iter().map(Imprint::size) {
            if let Some(mask) = mask.map(Imprint::size).filter(|mask| *mask != touch) {
                let text = format!("--mask has {mask} taxels, the imprint {touch}");
                return Err(Failure::new(text));
            }
        }
        let mut answer = self.answer(touches);
        if let Some(touch) = touches.last().filter(|_| self.asks_pose) {
            answer.pose = self.pose(touch, &answer.answer)?;
        }
        Ok(answer)
    }

    /// Where the shape of an answer lies. None without an answer, and if the shape does not leave this imprint.
    fn pose(&self, touch: &Imprint, answer: &Answer) -> Result<Option<PoseReport>, Failure> {
        let Some(shape) = answer.shape else {
            return Ok(None);
        };
        let memory = MemoryGuard::new("train the model in coarser steps to see poses");
        let poses = memory.limit(&ToTheEnd, |progress| {
            self.model.pose_of(shape, touch, progress)
        });
        let found = poses.map_err(Failure::new)?.zip(touch.bounds());
        Ok(found.map(|(estimate, bounds)| PoseReport {
            name: self.model.shapes()[shape].name.clone(),
            estimate,
            corner: [bounds.left.into(), bounds.top.into()],
            pitch_mm: self.pitch_mm,
        }))
    }

    /// Adds the key `recognition` to the end of a frame's line of JSON: the answer of `taxel recognise` to the
    /// imprint, or null if no taxel is active.
    pub(crate) fn extend(&self, line: &mut Vec<u8>, imprint: Option<&Imprint>) {
        line.truncate(line.iter().rposition(|&byte| byte == b'}').unwrap_or(0));
        line.extend(b",\"recognition\":");
        match imprint.filter(|imprint| !imprint.is_empty()) {
            None => line.extend(b"null"),
            Some(&imprint) => json::extend_ascii(line, &self.answer(&[imprint])),
        }
        line.extend(b"}\n");
    }

    /// The answer to an imprint in words; empty if no taxel is active.
    pub(crate) fn text(&self, imprint: &Imprint) -> String {
        if imprint.is_empty() {
            return String::new();
        }
        self.answer(&[*imprint]).text(imprint)
    }
}

impl Recognise {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        let pitch_mm = self.pitch.pitch(&cx.settings)?.of(None);
        let model = self.model.clone().unwrap_or(model::DEFAULT.into());
        let found = model::find(model, &cx.shelf)?;
        let mut terms = self.terms.terms()?;
        terms.reject_below = self.reject;
        let mask = self.mask.as_ref().map(|mask| cx.shelf.find(mask));
        let mask = mask.transpose().map_err(|error| error.of_flag("--mask"))?;
        let input = self.input(cx)?;
        let namer = Namer {
            top: self.top.map(wide),
            asks_pose: self.pose,
            pitch_mm,
            ..FoundNamer(found, terms, mask.map(|mask| *mask.imprint())).ready()?
        };
        match input {
            Question::Touch(content) => self.answer_imprint(&content, &namer, cx),
            Question::Lines(input) => self.answer_lines(input, &namer),
        }
    }

    /// Finds out whether the input is lines: whether it begins with one, after any blank ones.
    fn input(&self, cx: &Context) -> Result<Question, Failure> {
        let Input { name, read } = match cx.shelf.locate(&self.what)? {
            Located::Shape(shape) => return Ok(Question::Touch(Content::Shape(shape))),
            Located::Input(input) => input,
        };
        let (mut input, mut start) = (BufReader::new(read), Vec::new());
        let mut lines = Read::by_ref(&mut input).take(MAX_LINE as u64);
        while start.trim_ascii().is_empty() {
            let read = lines.read_until(b'\n', &mut start);
            if read.map_err(ReadError::from).named(&name)? == 0 {
                break;
            }
        }
        let is_line = is_line(&start);
        let read = Box::new(Cursor::new(start).chain(input));
        let whole = Input { name, read };
        Ok(if is_line {
            Question::Lines(whole)
        } else {
            Question::Touch(whole.content()?)
        })
    }

    fn answer_imprint(
        &self,
        content: &Content,
        namer: &Namer,
        cx: &Context,
    ) -> Result<(), Failure> {
        let trained = namer.model.sensor().threshold();
        if let Content::Shape(shape) = content
            && shape.source.is_some()
            && shape.sensor.threshold() != trained
        {
            let (name, own) = (&shape.name, shape.sensor.threshold());
            cx.note(&format!(
                "{name}: touched at threshold {own}, but the model was trained at {trained}"
            ));
        }
        let touch = content.imprint();
        let named = namer.checked_answer(&[*touch])?;
        cx.print(&if self.json {
            json::ascii(&named) + "\n"
        } else {
            named.text(touch)
        })
    }

    fn answer_lines(&self, input: Input, namer: &Namer) -> Result<(), Failure> {
        let answer = |line: &[u8], text: &mut Vec<u8>| -> Result<(), Failure> {
            let (touches, copied) = read_line(line)?;
            let mut named = namer.checked_answer(&touches)?;
            named.copied = copied;
            json::extend_ascii(text, &named);
            Ok(())
        };
        let jobs = self.jobs.map_or(0, usize::from);
        lines::answer_all(jobs, input, io::stdout().lock(), "touch", || {
            |line: &[u8], text: &mut Vec<u8>| answer(line, text).map_err(|failure| failure.text)
        })
    }
}

#[expect(clippy::large_enum_variant, reason = "there is one of these at a time")]
enum Question {
    Touch(Content),
    Lines(Input),
}

/// Whether a text begins with a question: a whole JSON object that is not a stored shape, even if it is wrong. An
/// object that does not end in its line is a stored shape.
fn is_line(start: &[u8]) -> bool {
    #[derive(Deserialize)]
    struct FormatKey {
        format: Option<IgnoredAny>,
    }
    let start = without_mark(start).trim_ascii();
    start.starts_with(b"{")
        && match serde_json::from_slice::<FormatKey>(start) {
            Ok(keys) => keys.format.is_none(),
            Err(error) => !error.is_eof(),
        }
}

const ONE_KEY: &str = "expected exactly one of the keys imprint (not null: set a threshold where the frame is read, such as --at-least) and touches";

#[derive(Deserialize)]
#[serde(expecting = "an object with an imprint or touches")]
struct LineKeys {
    imprint: Option<Imprint>,
    touches: Option<Vec<Imprint>>,
    frame: Option<Box<RawValue>>,
    #[serde(default, deserialize_with = "given")]
    label: Option<Box<RawValue>>,
    #[serde(default, deserialize_with = "given")]
    time: Option<Box<RawValue>>,
    #[serde(default, deserialize_with = "given")]
    channel: Option<Box<RawValue>>,
}

/// A `null` is copied, too.
fn given<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    T::deserialize(deserializer).map(Some)
}

/// A key of a line that its answer repeats.
type Copied = (&'static str, Box<RawValue>);

/// Reads the touches of a line, and what is copied. Other keys are ignored, so that answers of `taxel frames` can be
/// given as they are.
fn read_line(line: &[u8]) -> Result<(Vec<Imprint>, Vec<Copied>), ReadError> {
    let keys: LineKeys = json::of_line_with_nan(line)?;
    let touches = match (keys.imprint, keys.touches) {
        (Some(imprint), None) => vec![imprint],
        (None, Some(touches)) if !touches.is_empty() => touches,
        (None, Some(_)) => return Err(ReadError::new("touches: empty, expected at least one")),
        _ => return Err(ReadError::new(ONE_KEY)),
    };
    let copied = [
        ("frame", keys.frame),
        ("label", keys.label),
        ("time", keys.time),
        ("channel", keys.channel),
    ];
    let copied = copied.into_iter();
    let copied = copied.filter_map(|(key, value)| Some((key, value?)));
    Ok((touches, copied.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_distinguished_from_stored_shapes() {
        assert!(is_line(b"{\"imprint\":[\"##\"]}\n"));
        assert!(is_line(b"\n \n{\"imprint\":}\n"));
        assert!(!is_line(b"{\"format\":\"taxel-shape/1\"}\n"));
        assert!(!is_line(b"##..\n"));
        assert!(!is_line(b"{\n"));
    }
}
