//! `taxel watch`: prints a line of JSON for each frame of a source, and records all frames if a file is given.
//!
//! Every frame is recorded before it is answered. A live source that is recorded is never held up: if the reader of the
//! answers is slow, some frames get no answer, and their number is reported. Otherwise answers wait, as in any
//! pipeline. If the reader is gone, as in `| head -1`, or answers cannot be written, a recording continues; without a
//! recording the command ends.
//!
//! ```text
//! $ taxel watch /dev/ttyUSB0 --at-least 20 --write grip.npy | jq .na
//! $ taxel watch - --format lines --percent 50 < rows.txt
//! {"frame":0,"label":null,"time":null,"channel":null,"sum":42,"max":9,"rule":{"at_least":3,"from":"flag"},"imprint":[…
//! ```
//! Without a threshold, frames are answered with `"imprint":null`. With a tare, the first frames wait until it is
//! complete and are then answered together. Oddities go to standard error, a line each, after the name of the source:
//! `/dev/ttyUSB0: 12 frames dropped so far (torn, short, long or garbled), the last: \x00\x07\xff`. On a terminal,
//! the screen's live page opens instead ([`request`]). The file is long because a frame is recorded, kept for the
//! tare, named and answered in one pass.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::acquire::{AcquireError, AcquireEvent, FrameRecorder, FrameSource, Playback, acquire};
use crate::cli::arguments::watch::WatchArguments;
use crate::cli::commands::model;
use crate::cli::commands::naming::FrameNamer;
use crate::cli::error::{CliError, note_advice, stream_advice};
use crate::cli::input::processing;
use crate::cli::input::recording::RecordingFile;
use crate::cli::input::shapes::Shelf;
use crate::cli::output::charset::Charset;
use crate::cli::output::line_writer::LineWriter;
use crate::cli::output::progress::Progress;
use crate::cli::signals::Signals;
use crate::formats::json;
use crate::formats::recording::{
    ChannelChoice, ChannelInfo, FrameAnswer, ReadOptions, RecordingError, RecordingMetadata,
    no_channel,
};
use crate::formats::stream::{StreamCounts, StreamRefusal};
use crate::formats::value::counted;
use crate::frame::{Frame, FrameError, FrameSize, Processing, SetRule, Tare, TareFrames};
use crate::quote::as_argument;
use crate::tui::live::request::WatchRequest;
use crate::tui::runtime::check_source;

/// The shortest time between two reports of dropped frames.
const REPORT: Duration = Duration::from_secs(1);

/// The state of a watched source, which handles its frames as they come.
struct Watcher<'a> {
    /// The flags.
    asked: &'a WatchArguments,
    /// The name of the source in notes and errors.
    name: String,
    /// The processing from values to the imprint; tare and rule of the recording are set when they become known.
    processing: Processing,
    /// The threshold in use; None if neither a flag nor a recording has set one yet.
    rule: Option<SetRule>,
    /// The frames of the tare, and those that wait for it.
    tare: Option<(TareFrames, Vec<Frame>)>,
    /// The file of `--write`.
    recorder: Option<FrameRecorder>,
    /// The content of the `.json` file beside the recording, which is written again when something new becomes known.
    metadata: RecordingMetadata,
    /// All channels so far, in the order in which they came.
    channels: Vec<ChannelInfo>,
    /// The choice of the channel that is answered.
    choice: ChannelChoice,
    /// The first frame of a recording, held back until it is clear that there is no other channel.
    held: Option<(Frame, Option<f64>)>,
    begun: bool,
    /// The writer of standard output, on a thread of its own; None once its reader is gone while frames are recorded.
    lines: Option<LineWriter>,
    /// Why answers cannot be written any more, while frames are still recorded.
    unwritten: Option<CliError>,
    /// The memory of a frame, reused for the next one.
    frame: Frame,
    /// Rows and columns of the last frame; None before the first.
    size: Option<FrameSize>,
    /// The number of frames answered.
    answered: u64,
    /// The number of frames not answered because crop, tare, mask or gain do not fit their size.
    unfit: u64,
    /// Whether frames may be left unanswered.
    live: bool,
    /// The number of dropped frames reported so far.
    dropped: u64,
    /// The time of the last report.
    reported: Option<Instant>,
    /// The function that writes a line on standard error.
    note: &'a mut dyn FnMut(&str),
    /// The first error; it ends the reading and is returned at the end.
    failure: Option<CliError>,
}

/// Answers the frames of a source until it ends. Returns the exit status: 0, or that of the signal that stopped it.
///
/// # Errors
/// Returns an error if the source, the recording or the answers fail.
pub(crate) fn watch(
    asked: &WatchArguments,
    shelf: &Shelf,
    note: &mut dyn FnMut(&str),
) -> Result<u8, CliError> {
    let source = FrameSource::new(&asked.source);
    let signals = Signals::catch().map_err(CliError::System)?;
    let processing = processing::processing(&asked.processing)?;
    let rule = asked.processing.set_rule();
    let metadata = RecordingMetadata {
        source: source.name(),
        rule,
        ..RecordingMetadata::default()
    };
    check(&source, asked)?;
    // Errors in these are reported before a recording begins.
    let lines = line_writer(asked, &processing, shelf, &signals.stopped)?;
    let recorder = asked.write.as_ref().map(|path| {
        source.refuse_as_target(path)?;
        FrameRecorder::create(path, asked.existing, &metadata)
    });
    let tare = asked.processing.tare.unwrap_or_default();
    let mut watcher = Watcher {
        asked,
        name: source.name(),
        processing,
        rule: None,
        tare: (tare > 0).then(|| (TareFrames::new(tare), Vec::new())),
        recorder: recorder.transpose().map_err(CliError::Recorder)?,
        metadata,
        channels: Vec::new(),
        choice: ChannelChoice::new(asked.processing.channel.as_deref()),
        held: None,
        begun: false,
        lines: Some(lines),
        unwritten: None,
        frame: Frame::default(),
        size: None,
        answered: 0,
        unfit: 0,
        live: asked.options.playback != Playback::Once && !matches!(source, FrameSource::File(_)),
        dropped: 0,
        reported: None,
        note,
        failure: None,
    };
    watcher.set_rule(rule);
    let acquired = acquire(&source, &asked.options, &signals.stopped, &mut |event| {
        watcher.on(event)
    });
    let stopped = signals.stopped.load(Ordering::Relaxed);
    watcher.finish(acquired, stopped)?;
    Ok(match signals.failure() {
        CliError::Stopped { status } if stopped => status,
        _ => 0,
    })
}

/// Refuses flags that have no effect for a source: those of serial lines for others, those of playing for a stream,
/// and a channel that a recording does not have.
fn check(source: &FrameSource, asked: &WatchArguments) -> Result<(), CliError> {
    if let Some(reason) = source.unused_baud().filter(|_| asked.baud_named) {
        let flag = "baud";
        return Err(CliError::Unused { flag, reason });
    }
    // A source that cannot be read is reported when it is watched.
    if let Playback::Paced { repeat, .. } = asked.options.playback
        && matches!(source.recording(&asked.options), Ok(None))
    {
        let flag = if repeat { "loop" } else { "speed" };
        let reason = "on a stream: it is for recordings".to_owned();
        return Err(CliError::Unused { flag, reason });
    }
    check_channel(source, asked)
}

/// Refuses a channel that a recording does not have, by reading the recording until the channel occurs. Otherwise the
/// recording would be played to its end without an answer.
fn check_channel(source: &FrameSource, asked: &WatchArguments) -> Result<(), CliError> {
    let (FrameSource::File(path), None, Some(wanted)) =
        (source, asked.options.format, &asked.processing.channel)
    else {
        return Ok(());
    };
    let (names, is_whole) = channels(path, asked, Some(wanted))?;
    // A stream, or a damage, which is reported when the source is watched.
    if names.contains(wanted) || !is_whole {
        return Ok(());
    }
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    Err(CliError::Frames {
        name: source.name(),
        message: no_channel(wanted, &names),
    })
}

/// Returns the names of a recording's channels, all or up to one of them; and whether it could be read that far.
///
/// # Errors
/// Returns an error if it cannot be opened.
fn channels(
    path: &Path,
    asked: &WatchArguments,
    up_to: Option<&str>,
) -> Result<(Vec<String>, bool), CliError> {
    let options = ReadOptions {
        size: asked.options.size,
        ..ReadOptions::default()
    };
    Ok(RecordingFile::open(path, options)?.channel_names(up_to))
}

/// Starts the writer of the answers. With a model, it also names each imprint, so that neither training nor search
/// delays a recording. A model in a file is read at once. Training shows no progress: standard error is for oddities
/// of the source.
fn line_writer(
    asked: &WatchArguments,
    processing: &Processing,
    shelf: &Shelf,
    stopped: &Arc<AtomicBool>,
) -> Result<LineWriter, CliError> {
    let noise = asked.naming.noise_with(processing.view.mask.as_ref());
    let found = asked.naming.find(shelf)?;
    LineWriter::start(stopped, move |lines| {
        let Some(found) = found else {
            return lines.write(&mut |_, _| ());
        };
        let model = found.ready(&|poses| Progress::new(poses, true, Charset::Ascii))?;
        let namer = FrameNamer::new(&model, noise.as_ref());
        lines.write(&mut |line, imprint| namer.extend(line, imprint))
    })
}

/// Returns the same request for the live page of the screen.
///
/// # Errors
/// Returns an error if the file, the mask or the gain cannot be read, if there is no such model or channel, or if the
/// recording cannot be started.
pub(crate) fn request(asked: &WatchArguments, shelf: &Shelf) -> Result<WatchRequest, CliError> {
    let source = FrameSource::new(&asked.source);
    check_source(&source).map_err(|message| CliError::Frames {
        name: source.name(),
        message,
    })?;
    check(&source, asked)?;
    if let Some(path) = &asked.write {
        // The recording is created and dropped again: no file appears before the first frame.
        let metadata = RecordingMetadata::default();
        let begun = source
            .refuse_as_target(path)
            .and_then(|()| FrameRecorder::create(path, asked.existing, &metadata));
        drop(begun.map_err(CliError::Recorder)?);
    }
    let mut request = WatchRequest::new(&asked.source);
    request.options = asked.options.clone();
    request.processing = processing::processing(&asked.processing)?;
    request.rule = asked.processing.set_rule();
    request.history_bytes = asked.history_bytes;
    request.processing.least = asked.processing.least;
    request.tare = asked.processing.tare.unwrap_or_default();
    request.own_tare = asked.processing.tare.is_none();
    let model = asked.naming.model.as_ref();
    request.model = model.map(|model| model::choice(model, shelf)).transpose()?;
    request.noise = asked.naming.noise;
    request.write = asked.write.clone().map(|path| (path, asked.existing));
    Ok(request)
}

impl Watcher<'_> {
    /// Sets the threshold for the next answers; None to answer without imprints.
    fn set_rule(&mut self, rule: Option<SetRule>) {
        self.rule = rule;
        SetRule::apply(rule, &mut self.processing);
    }

    /// Handles one event of the source. After an error nothing more is read.
    fn on(&mut self, event: AcquireEvent<'_>) -> ControlFlow<()> {
        let done = match event {
            AcquireEvent::Channel(info) => self.add_channel(info),
            AcquireEvent::Frame { frame, time } => self.add_frame(frame, time),
            AcquireEvent::Tick(counts) => self.tick(counts),
            AcquireEvent::Silent {
                bytes_per_second,
                counts,
            } => {
                self.say(&counts.silence(bytes_per_second));
                Ok(())
            }
            AcquireEvent::Lost(error) => {
                self.say(&AcquireEvent::lost(error));
                Ok(())
            }
            AcquireEvent::Back { gap } => {
                self.say(&AcquireEvent::back_after(gap));
                Ok(())
            }
            AcquireEvent::Note(note) => {
                self.say(&format!("warning: {note}{}", note_advice(note)));
                Ok(())
            }
            AcquireEvent::Anew(how) => {
                self.say(&how.to_string());
                Ok(())
            }
            AcquireEvent::Ended(counts) => self.ended(counts),
            _ => Ok(()),
        };
        match done {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                self.failure = Some(error);
                ControlFlow::Break(())
            }
        }
    }

    /// Notes a line about the source.
    fn say(&mut self, text: &str) {
        let line = format!("{}: {text}", self.name);
        (self.note)(&line);
    }

    /// Returns an error of the source with this reason.
    fn refused(&self, message: &str) -> CliError {
        CliError::Frames {
            name: self.name.clone(),
            message: message.to_owned(),
        }
    }

    /// Adds a channel. With the watched channel come unit and pitch, and threshold and tare unless flags set them.
    /// Other channels that appear once frames are answered are left out.
    ///
    /// # Errors
    /// Returns an error if there are several channels before that and none is chosen. It names all channels of a file;
    /// a pipe cannot be read again.
    fn add_channel(&mut self, info: &ChannelInfo) -> Result<(), CliError> {
        self.channels.push(info.clone());
        let is_chosen = self.choice.add(info);
        let names = self.choice.names();
        if self.asked.processing.channel.is_none() && names.len() > 1 {
            if self.begun && self.held.is_none() {
                let (own, other) = (&names[0], info.shown_name());
                let flag = as_argument(other);
                let text = format!(
                    "channel {other} is left out, since {own} came first; --channel {flag} takes it"
                );
                self.say(&text);
                return Ok(());
            }
            let all = match FrameSource::new(&self.asked.source) {
                FrameSource::File(path) => channels(&path, self.asked, None)?.0,
                _ => names.to_vec(),
            };
            let names = all.join(", ");
            let message = format!("several channels, choose one with --channel: {names}");
            return Err(self.refused(&message));
        }
        if !is_chosen {
            return Ok(());
        }
        if self.rule.is_none() {
            self.set_rule(info.own_rule(self.asked.processing.least));
        }
        if self.asked.processing.tare.is_none() {
            self.processing.tare = info.tare_for(&self.processing.view).cloned();
            let view = &self.processing.view;
            if let Some(unused) = processing::unused_tare(&self.asked.processing, info, view) {
                self.say(&format!("warning: {unused}"));
            }
            self.metadata.tare.clone_from(&self.processing.tare);
        }
        self.metadata.seconds_per_frame = info.seconds_per_frame;
        self.metadata.unit.clone_from(&info.unit);
        self.metadata.pitch_mm = info.pitch_mm;
        self.metadata.rule = self.rule;
        self.describe()
    }

    /// Writes the description beside the recording, if there is one.
    fn describe(&mut self) -> Result<(), CliError> {
        let recorder = self.recorder.as_mut();
        let described = recorder.map(|recorder| recorder.describe(&self.metadata));
        described.transpose().map(drop).map_err(CliError::Recorder)
    }

    /// Takes a frame of the watched channel: records it, and answers it at once or when the tare is complete. The
    /// first frame of a recording may be held back.
    fn add_frame(&mut self, frame: &Frame, time: Option<f64>) -> Result<(), CliError> {
        if !self.choice.takes(frame.channel) {
            return Ok(());
        }
        let asked = self.asked.processing.channel.as_deref();
        let is_first = !std::mem::replace(&mut self.begun, true);
        if let (true, Some(asked), true) = (is_first, asked, self.channels.is_empty()) {
            let text = format!(
                "no channel is called {asked:?}: a stream has none, and all frames are taken"
            );
            self.say(&text);
        }
        if is_first && !self.channels.is_empty() && self.asked.processing.channel.is_none() {
            self.held = Some((frame.clone(), time));
            return Ok(());
        }
        self.release()?;
        self.take(frame, time)
    }

    /// Takes the frame that was held back, if there is one.
    fn release(&mut self) -> Result<(), CliError> {
        match self.held.take() {
            Some((frame, time)) => self.take(&frame, time),
            None => Ok(()),
        }
    }

    /// Records a frame if a file is given. The first frame of another size is reported: such frames are left out of
    /// the recording.
    fn record(&mut self, frame: &Frame, time: Option<f64>) -> Result<(), CliError> {
        let Some(recorder) = &mut self.recorder else {
            return Ok(());
        };
        let before = recorder.left_out();
        recorder.add(frame, time).map_err(CliError::Recorder)?;
        if let (0, 1, Some(size)) = (before, recorder.left_out(), recorder.size()) {
            let text = format!(
                "frame {} has {} cells; the recording has frames of {} and leaves out others",
                frame.number,
                frame.size().in_words(),
                size.in_words()
            );
            self.say(&text);
        }
        Ok(())
    }

    /// Takes a frame of the channel: records it, and answers it or keeps it for the tare.
    fn take(&mut self, frame: &Frame, time: Option<f64>) -> Result<(), CliError> {
        let size = frame.size();
        let before = self.size.replace(size);
        let is_new_size = before.is_some_and(|before| before != size);
        // In a recording, each frame may have a size of its own.
        if is_new_size && self.channels.is_empty() {
            let (number, size) = (frame.number, size.in_words());
            self.say(&format!("{size} cells from frame {number} on"));
        }
        self.record(frame, time)?;
        let mut own = std::mem::take(&mut self.frame);
        own.copy_from(frame);
        own.time = time;
        let Some((tare, waiting)) = &mut self.tare else {
            let answered = self.answer(&own);
            self.frame = own;
            return answered;
        };
        // The whole frames wait, not only their visible parts.
        let added = tare.check_memory(own.values().len());
        let added = added.and_then(|()| tare.add_frame(&own, &self.processing.view));
        waiting.push(own);
        added.map_err(|error| self.refused(&error.to_string()))?;
        self.end_tare()
    }

    /// Answers the frames that waited for the tare, once it is complete.
    fn end_tare(&mut self) -> Result<(), CliError> {
        let Some((tare, waiting)) = self.tare.take_if(|(tare, _)| tare.missing() == 0) else {
            return Ok(());
        };
        let tare = tare
            .finish()
            .map_err(|error| self.refused(&error.to_string()))?;
        self.metadata.tare = Some(tare.clone());
        self.processing.tare = Some(tare);
        self.describe()?;
        waiting.iter().try_for_each(|frame| self.answer(frame))
    }

    /// Processes a frame and sends its line. A frame whose size does not fit crop, tare, mask or gain is left out if
    /// others did fit: the sensor continues.
    ///
    /// # Errors
    /// Returns an error if the first frame does not fit; [`CliError::Write`] once standard output is closed.
    fn answer(&mut self, frame: &Frame) -> Result<(), CliError> {
        let Some(lines) = &mut self.lines else {
            return Ok(());
        };
        let tare = self.processing.tare.as_ref().map_or(0, Tare::frames);
        let processed = match self.processing.run(frame) {
            Ok(processed) => processed,
            Err(error) if self.answered > 0 && error.is_of_size() => {
                self.unfit += 1;
                if self.unfit == 1 {
                    let number = frame.number;
                    self.say(&format!("frame {number} is not printed: {error}"));
                }
                return Ok(());
            }
            Err(error) => return Err(self.refused(&error.to_string())),
        };
        self.answered += 1;
        let channel = self.channels.get(frame.channel);
        let answer = FrameAnswer {
            frame,
            channel: channel.and_then(|channel| channel.name.as_deref()),
            processed,
            rule: self.rule,
            tare,
        };
        let line = json::ascii(&answer) + "\n";
        let may_give_up = self.live && self.recorder.is_some();
        if lines.send((line.into_bytes(), processed.imprint), may_give_up) {
            return Ok(());
        }
        self.end_answers()
    }

    /// Ends the answers, once no more can be written. A recording continues: its frames do not come again.
    ///
    /// # Errors
    /// Returns the reason why no more can be written, without a recording.
    fn end_answers(&mut self) -> Result<(), CliError> {
        let written = self.lines.take().map_or(Ok(()), LineWriter::finish);
        match written {
            Err(error @ CliError::Write(_)) if self.recorder.is_some() => {
                if error.is_closed_pipe() {
                    self.say("standard output is closed; the recording continues");
                } else {
                    self.say(&format!("{error}; the recording continues"));
                    self.unwritten = Some(error);
                }
                Ok(())
            }
            written => written,
        }
    }

    /// Handles a tick, ten times a second: flushes the recording, and reports dropped frames.
    fn tick(&mut self, counts: &StreamCounts) -> Result<(), CliError> {
        if let Some(recorder) = &mut self.recorder {
            recorder.tick().map_err(CliError::Recorder)?;
        }
        self.shaped(counts)?;
        // The reader of the answers is gone, or there is no model.
        if self.lines.as_ref().is_some_and(LineWriter::is_over) {
            self.end_answers()?;
        }
        if self.reported.is_none_or(|last| last.elapsed() >= REPORT) {
            self.report_dropped(counts);
        }
        Ok(())
    }

    /// Returns an error if the stream cannot be decoded without rows and columns.
    fn shaped(&self, counts: &StreamCounts) -> Result<(), CliError> {
        match counts.refusal() {
            // An echo that leaves out values of some messages is refused too, since the others are not all frames.
            None if counts.cut => Err(self.undecoded(StreamRefusal::Cut)),
            None => Ok(()),
            Some(StreamRefusal::Unknown) => Err(self.unknown()),
            Some(refusal) => Err(self.undecoded(refusal)),
        }
    }

    /// Returns the error of an unknown format: one of recordings for a file, one of streams for any other source.
    fn unknown(&self) -> CliError {
        if let FrameSource::File(_) = FrameSource::new(&self.asked.source) {
            let name = self.name.clone();
            let error = RecordingError::Unknown;
            return CliError::Recording { name, error };
        }
        self.undecoded(StreamRefusal::Unknown)
    }

    /// Returns the error for a stream that cannot be decoded without more flags; it says which flags help.
    fn undecoded(&self, refusal: StreamRefusal) -> CliError {
        self.refused(&format!("{refusal}{}", stream_advice(refusal)))
    }

    /// Reports the number of dropped frames if it has grown, with the bytes of the last one.
    fn report_dropped(&mut self, counts: &StreamCounts) {
        if counts.dropped <= self.dropped {
            return;
        }
        self.dropped = counts.dropped;
        self.reported = Some(Instant::now());
        let dropped = counted(counts.dropped, "frame");
        let mut text = format!("{dropped} dropped so far (torn, short, long or garbled)");
        if let Some(sample) = &counts.sample {
            text += &format!(", the last: {sample}");
        }
        if let Some(reason) = &counts.reason {
            text += &format!(" ({reason})");
        }
        self.say(&text);
    }

    /// Handles the end of a source.
    ///
    /// # Errors
    /// Returns an error if there was no frame at all: the format, or rows and columns, are wrong.
    fn ended(&mut self, counts: &StreamCounts) -> Result<(), CliError> {
        self.shaped(counts)?;
        self.report_dropped(counts);
        if counts.frames == 0 {
            if counts.bytes == 0 {
                let name = self.name.clone();
                return Err(CliError::Empty { name });
            }
            if counts.unknown {
                return Err(self.unknown());
            }
            let bytes = counted(counts.bytes, "byte");
            return Err(self.refused(&match &counts.reason {
                Some(reason) => format!("{bytes} but no frame; the last line: {reason}"),
                None => format!("{bytes} but no frame; check --rows, --columns and --format"),
            }));
        }
        Ok(())
    }

    /// Ends the recording and the answers. Returns the first error in this order: of recording, of writing answers,
    /// of the frames, of the source. A tare that lacks frames is an error of the frames, unless the source has
    /// failed.
    fn finish(mut self, acquired: Result<(), AcquireError>, stopped: bool) -> Result<(), CliError> {
        let mut failure = self.failure.take();
        if failure.is_none() {
            failure = self.release().err();
        }
        let ended_well = acquired.is_ok() && !stopped;
        let damage = acquired.err().map(|error| self.damage(error));
        if let (Some(error), Some(recorder)) =
            (failure.as_ref().or(damage.as_ref()), &mut self.recorder)
        {
            recorder.note_reason(&error.to_string());
        }
        if let (None, Some((tare, _)), true) = (&failure, &self.tare, ended_well) {
            let wanted = tare.wanted();
            let frames = wanted - tare.missing();
            let error = FrameError::Tare { frames, wanted };
            failure = Some(self.refused(&self.asked.processing.tare_refused(&error)));
        }
        // For a stream, this is already an error.
        if failure.is_none() && ended_well && !self.begun {
            let missing = self.choice.missing();
            failure = Some(self.refused(missing.as_deref().unwrap_or("no frames")));
        }
        let left_out = self.recorder.as_ref().map_or(0, FrameRecorder::left_out);
        if left_out > 0 {
            let frames = counted(left_out, "frame");
            self.say(&format!("{frames} of another size not recorded"));
        }
        if self.unfit > 0 {
            let frames = counted(self.unfit, "frame");
            self.say(&format!("{frames} of another size not printed"));
        }
        let recorded = self.recorder.take().map(FrameRecorder::finish);
        // If the file could not be created, the reason is not a lack of frames.
        let refused = matches!(failure, Some(CliError::Recorder(_)));
        if let (Some(Ok(0)), Some(path), false) = (&recorded, &self.asked.write, refused) {
            let path = path.display();
            self.say(&format!("no frame came, so {path} was not written"));
        }
        let given_up = self.lines.as_ref().map_or(0, |lines| lines.given_up);
        if given_up > 0 {
            let frames = counted(given_up, "frame");
            self.say(&format!("{frames} recorded but not printed"));
        }
        let written = self.lines.take().map_or(Ok(()), LineWriter::finish);
        let written = self.unwritten.take().map_or(written, Err);
        let recorded = recorded.transpose().map_err(CliError::Recorder)?;
        // A recording does not need a reader of the answers.
        written.or_else(|error| match error {
            error if recorded.is_some() && error.is_closed_pipe() => Ok(()),
            error => Err(error),
        })?;
        failure.or(damage).map_or(Ok(()), Err)
    }

    /// Returns the error of a source that cannot be read to its end.
    fn damage(&self, error: AcquireError) -> CliError {
        match error {
            AcquireError::Recording(error) => CliError::Recording {
                name: self.name.clone(),
                error,
            },
            error => self.refused(&error.to_string()),
        }
    }
}
