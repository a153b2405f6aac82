//! `taxel watch`: prints a line of JSON for each frame of a source, and records all frames if a file is given.
//!
//! Every frame is recorded before it is answered. A live source that is recorded is never held up: if the reader of the
//! answers is slow, some frames get no answer, and their number is reported. Otherwise answers wait, as in any
//! pipeline. If the reader is gone, as in `| head -1`, or answers cannot be written, a recording continues; without a
//! recording the command ends. If the recording fails, as on a full disk, the answers go on; the error is reported at
//! once, and is that of the command at its end.
//!
//! ```text
//! $ taxel watch /dev/ttyUSB0 --at-least 20 --write grip.npy | jq .na
//! $ taxel watch - --format lines --percent 50 < rows.txt
//! {"frame":0,"label":null,"time":null,"channel":null,"sum":42,"max":9,"rule":{"at_least":3,"from":"flag"},"imprint":[…
//! ```
//! Without a threshold, frames are answered with `"imprint":null`. With a tare, the first frames wait until it is
//! complete and are then answered together. Oddities go to standard error, a line each, with the name of the source:
//! `warning: /dev/ttyUSB0: 12 frames dropped so far (torn, short, long or garbled), the last: \x00\x07\xff`. On a
//! terminal, the screen's live page opens instead ([`request`]).
//!
//! ```text
//! acquire -> ChannelGate -> FrameRecorder: each frame of the channel
//!                        -> the first frames wait, if a tare is made -> Answers -> standard output
//!         -> SourceReports: oddities, errors -> standard error
//! ```

mod answers;

mod recording;

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use taxel_core::frame::{Frame, FrameError, FrameSize, Processing, TareFrames};
use taxel_core::quote::as_argument;
use taxel_files::acquire::{
    AcquireEvent, FrameRecorder, FrameSource, Playback, RecorderError, acquire,
};
use taxel_files::formats::recording::{ChannelChoice, ChannelInfo, StreamCounts, no_channel};
use taxel_files::formats::value::counted;
use taxel_files::storage::ModelChoice;
use taxel_files::{ReadError, ReadErrorKind};

use crate::cli::arguments::frames::WatchArguments;
use crate::cli::commands::model;
use crate::cli::commands::watch::answers::Answers;
use crate::cli::commands::watch::recording::SourceReports;
use crate::cli::error::CliError;
use crate::cli::input::recording::{self as input_recording, RecordingFile};
use crate::cli::input::shapes::Shelf;
use crate::cli::output::charset::Charset;
use crate::cli::output::line_writer::LineWriter;
use crate::cli::signals::Signals;
use crate::frames::{Pipeline, WatchRequest};
use crate::tui::runtime::check_source;

struct Watcher<'a> {
    asked: &'a WatchArguments,
    reports: SourceReports<'a>,
    gate: ChannelGate<'a>,
    processing: Processing,
    /// The tare that is made of the first frames, and these frames; None if none is made any more.
    tare: Option<(TareFrames, Vec<Frame>)>,
    recording: Option<FrameRecorder>,
    unrecorded: Option<CliError>,
    answers: Answers,
    frame: Frame,
    /// Rows and columns of the last frame; None before the first.
    size: Option<FrameSize>,
    failure: Option<CliError>,
}

/// Answers the frames of a source until it ends. Returns the exit status: 0, or that of the signal that stopped it.
pub(crate) fn watch(
    asked: &WatchArguments,
    shelf: &Shelf,
    note: &mut dyn FnMut(&str),
) -> Result<u8, CliError> {
    let source = FrameSource::new(&asked.source);
    if matches!(source, FrameSource::Serial(_)) {
        // The user's terminal would be set up as a serial line, on which Ctrl-C is only a byte.
        check_readable(&source)?;
    }
    let signals = Signals::catch()?;
    let processing = input_recording::processing(&asked.processing)?;
    check(&source, asked)?;
    // Errors in these are reported before a recording begins.
    let lines = line_writer(asked, &processing, shelf, &signals.stopped)?;
    let recording = recording::begin(&source, asked).map_err(CliError::Recorder)?;
    let wanted_tare = asked.processing.tare.filter(|&frames| frames > 0);
    let wanted_tare = wanted_tare.map(|frames| (TareFrames::new(frames), Vec::new()));
    let is_live = source.arrives(asked.options.playback);
    let mut watcher = Watcher {
        asked,
        reports: SourceReports::new(&source, &asked.options, note),
        gate: ChannelGate::new(&source, asked),
        processing,
        tare: wanted_tare,
        answers: Answers::new(lines, is_live, recording.is_some()),
        recording,
        unrecorded: None,
        frame: Frame::default(),
        size: None,
        failure: None,
    };
    let rule = asked.processing.set_rule();
    watcher.processing.apply_rule(rule);
    let acquired = acquire(&source, &asked.options, &signals.stopped, &mut |event| {
        watcher.on(event)
    });
    let stopped = !signals.goes_on();
    watcher.finish(acquired, stopped)?;
    Ok(if stopped { signals.status() } else { 0 })
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
    let found = asked.naming.find(processing.view.mask.as_ref(), shelf)?;
    LineWriter::start(stopped, move |lines| {
        let Some(found) = found else {
            return lines.write(&mut |_, _| ());
        };
        let namer = found.ready(true, Charset::Ascii)?;
        lines.write(&mut |line, imprint| namer.extend(line, imprint))
    })
}

pub(crate) fn request(asked: &WatchArguments, shelf: &Shelf) -> Result<WatchRequest, CliError> {
    let source = FrameSource::new(&asked.source);
    check_readable(&source)?;
    check(&source, asked)?;
    // The recording is created and dropped again: no file appears before the first frame.
    drop(recording::begin(&source, asked).map_err(CliError::Recorder)?);
    let mut request = WatchRequest::new(&asked.source);
    request.options = asked.options.clone();
    let mut processing = input_recording::processing(&asked.processing)?;
    processing.least = asked.processing.least;
    processing.apply_rule(asked.processing.set_rule());
    let (tare, from) = (asked.processing.tare, asked.processing.tare_from);
    request.pipeline = Pipeline::new(processing, tare, from);
    request.history_bytes = asked.history_bytes;
    if let Some(model) = &asked.naming.model {
        let choice = model::models(shelf).locate(ModelChoice::from_text(model));
        request.model = Some(choice.map_err(CliError::Archive)?);
    }
    request.noise = asked.naming.noise;
    request.write = asked.write.clone().map(|path| (path, asked.existing));
    Ok(request)
}

impl Watcher<'_> {
    /// Handles one event of the source. After an error nothing more is read.
    fn on(&mut self, event: AcquireEvent<'_>) -> ControlFlow<()> {
        let done = match event {
            AcquireEvent::Channel(info) => self.add_channel(info),
            AcquireEvent::Frame { frame, time } => self.add_frame(frame, time),
            AcquireEvent::Tick(counts) => self.tick(counts),
            AcquireEvent::Ended(counts) => self.reports.end(counts),
            event => {
                self.reports.remark(event);
                Ok(())
            }
        };
        match done {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                self.failure = Some(error);
                ControlFlow::Break(())
            }
        }
    }

    /// Adds a channel. With the watched channel come unit and pitch, and threshold and tare unless flags set them.
    fn add_channel(&mut self, info: &ChannelInfo) -> Result<(), CliError> {
        if !self.gate.add(info, &mut self.reports)? {
            return Ok(());
        }
        if self.processing.rule.is_none() {
            let own = info.own_rule(self.asked.processing.least);
            self.processing.apply_rule(own);
        }
        if self.asked.processing.tare.is_none() {
            let view = &self.processing.view;
            self.processing.tare = info.tare_for(view).cloned();
            if let Some(unused) = input_recording::unused_tare(&self.asked.processing, info, view) {
                self.reports.warn(&unused);
            }
        }
        let (tare, rule) = (self.processing.tare.clone(), self.processing.applied_rule());
        self.record(|recorder| {
            recorder.describe(|metadata| {
                metadata.tare = tare;
                metadata.seconds_per_frame = info.seconds_per_frame;
                metadata.unit.clone_from(&info.unit);
                metadata.pitch_mm = info.pitch_mm;
                metadata.rule = rule;
            })
        })
    }

    fn record(
        &mut self,
        write: impl FnOnce(&mut FrameRecorder) -> Result<(), RecorderError>,
    ) -> Result<(), CliError> {
        let Some(recording) = &mut self.recording else {
            return Ok(());
        };
        let error = match write(recording).map_err(CliError::Recorder) {
            Err(error) if self.answers.go_on_alone() => error,
            written => return written,
        };
        self.reports.say(&format!("{error}; the answers go on"));
        // Any error here follows from the first one, which is reported.
        let _ = self.end_recording(true);
        self.unrecorded = Some(error);
        Ok(())
    }

    fn add_frame(&mut self, frame: &Frame, time: Option<f64>) -> Result<(), CliError> {
        if !self.gate.admits(frame, time, &mut self.reports) {
            return Ok(());
        }
        self.release()?;
        self.take(frame, time)
    }

    fn release(&mut self) -> Result<(), CliError> {
        match self.gate.release() {
            Some((frame, time)) => self.take(&frame, time),
            None => Ok(()),
        }
    }

    fn take(&mut self, frame: &Frame, time: Option<f64>) -> Result<(), CliError> {
        let size = frame.size();
        let before = self.size.replace(size);
        let is_new_size = before.is_some_and(|before| before != size);
        // In a recording, each frame may have a size of its own.
        if is_new_size && !self.gate.has_channels() {
            let (number, size) = (frame.number, size.in_words());
            self.reports
                .say(&format!("{size} cells from frame {number} on"));
        }
        self.record(|recorder| recorder.add(frame, time))?;
        let mut own = std::mem::take(&mut self.frame);
        own.copy_from(frame);
        own.time = time;
        let Some((mut tare, mut waiting)) = self.tare.take() else {
            let answered = self.answer(&own);
            self.frame = own;
            return answered;
        };
        // A sensor that was lost may come back with another size: then the tare begins again with its frames.
        let added = match tare.add(&own, &self.processing.view) {
            Err(error) if error.is_of_size() && !waiting.is_empty() => Ok(()),
            Err(error) => Err(error),
            Ok(goes_on) => {
                if !goes_on {
                    waiting.retain(|frame: &Frame| frame.size() == size);
                }
                tare.check_memory(own.values().len())
            }
        };
        added.map_err(|error| self.reports.refused(&error))?;
        waiting.push(own);
        if tare.missing() > 0 {
            self.tare = Some((tare, waiting));
            return Ok(());
        }
        let tare = tare
            .finish()
            .map_err(|error| self.reports.refused(&error))?;
        self.record(|recorder| recorder.describe(|metadata| metadata.tare = Some(tare.clone())))?;
        self.processing.tare = Some(tare);
        if let Some(unknown) = input_recording::unknown_step(&self.processing) {
            self.reports.warn(unknown);
        }
        waiting.iter().try_for_each(|frame| self.answer(frame))
    }

    fn answer(&mut self, frame: &Frame) -> Result<(), CliError> {
        let channel = self.gate.name(frame.channel);
        let (processing, reports) = (&mut self.processing, &mut self.reports);
        self.answers.add((frame, channel), processing, reports)
    }

    fn tick(&mut self, counts: &StreamCounts) -> Result<(), CliError> {
        self.record(FrameRecorder::tick)?;
        self.answers.tick(&mut self.reports)?;
        self.reports.tick(counts);
        Ok(())
    }

    /// Ends the recording, and reports the frames that are not in it. `explained` tells whether the error of the watch
    /// explains a missing file: the file could not be created, or the source could not be read.
    fn end_recording(&mut self, explained: bool) -> Result<(), CliError> {
        let (Some(recorder), Some(path)) = (self.recording.take(), &self.asked.write) else {
            return Ok(());
        };
        let left_out = recorder.left_out();
        if left_out > 0 {
            let frames = counted(left_out, "frame");
            self.reports
                .say(&format!("{frames} of another size not recorded"));
        }
        let frames = recorder.finish().map_err(CliError::Recorder)?;
        if frames == 0 && !explained {
            let path = path.display();
            self.reports
                .say(&format!("no frame came, so {path} was not written"));
        }
        Ok(())
    }

    /// Ends the recording and the answers. Returns the first error in this order: of recording, of writing answers,
    /// of the frames, of the source. A tare that lacks frames is an error of the frames, unless the source has
    /// failed.
    fn finish(mut self, acquired: Result<(), ReadError>, stopped: bool) -> Result<(), CliError> {
        let mut failure = self.failure.take().or_else(|| self.release().err());
        let ended_well = acquired.is_ok() && !stopped;
        let error = acquired.err();
        let is_unreadable =
            (error.as_ref()).is_some_and(|error| matches!(error.kind, ReadErrorKind::Io(_)));
        let damage = error.map(|error| self.reports.damage(error));
        if let (Some(error), Some(recording)) =
            (failure.as_ref().or(damage.as_ref()), &mut self.recording)
        {
            recording.note_reason(&error.to_string());
        }
        if ended_well {
            failure = failure.or_else(|| self.unfinished());
        }
        // That no frame came is no news if the source cannot be read.
        let explained = is_unreadable || matches!(failure, Some(CliError::Recorder(_)));
        let recorded = self.end_recording(explained);
        let written = self.answers.finish(&mut self.reports);
        recorded?;
        self.unrecorded.map_or(Ok(()), Err)?;
        written?;
        failure.or(damage).map_or(Ok(()), Err)
    }

    /// Returns the error of a source that has ended before a tare was complete, or without a frame of the channel. For
    /// a stream, the latter is an error already.
    fn unfinished(&self) -> Option<CliError> {
        if let Some((tare, _)) = &self.tare {
            let wanted = tare.wanted();
            let frames = wanted - tare.missing();
            let lacks = FrameError::Tare { frames, wanted };
            let reason = self.asked.processing.tare_refused(&lacks);
            return Some(self.reports.refused(&reason));
        }
        let reason = self.gate.no_frame_reason()?;
        Some(self.reports.refused(&reason))
    }
}

/// Refuses a source that cannot be read even if one waits, and the user's own terminal.
fn check_readable(source: &FrameSource) -> Result<(), CliError> {
    check_source(source).map_err(|message| CliError::Frames {
        name: source.name(),
        message,
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
        && source.is_recording(&asked.options) == Ok(false)
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

fn channels(
    path: &Path,
    asked: &WatchArguments,
    up_to: Option<&str>,
) -> Result<(Vec<String>, bool), CliError> {
    Ok(RecordingFile::open(path, asked.processing.reading())?.channel_names(up_to))
}

/// A gate that lets the frames of one channel pass.
///
/// If no channel is named, the first frame of a recording is held back until the next one comes: a second channel
/// before that is an error, a later one is left out.
struct ChannelGate<'a> {
    asked: &'a WatchArguments,
    source: &'a FrameSource,
    choice: ChannelChoice,
    channels: Vec<ChannelInfo>,
    first: FirstFrame,
}

enum FirstFrame {
    Missing,
    Came { held: Option<(Frame, Option<f64>)> },
}

impl<'a> ChannelGate<'a> {
    fn new(source: &'a FrameSource, asked: &'a WatchArguments) -> Self {
        Self {
            asked,
            source,
            choice: ChannelChoice::new(asked.processing.channel.as_deref()),
            channels: Vec::new(),
            first: FirstFrame::Missing,
        }
    }

    fn wanted(&self) -> Option<&'a str> {
        self.asked.processing.channel.as_deref()
    }

    fn has_channels(&self) -> bool {
        !self.channels.is_empty()
    }

    fn name(&self, channel: usize) -> Option<&str> {
        self.channels.get(channel)?.name.as_deref()
    }

    /// Adds a channel. Returns true if it is the watched one. Other channels that appear once frames are answered are
    /// left out.
    fn add(
        &mut self,
        info: &ChannelInfo,
        reports: &mut SourceReports<'_>,
    ) -> Result<bool, CliError> {
        self.channels.push(info.clone());
        let is_chosen = self.choice.add(info);
        let names = self.choice.names();
        if self.wanted().is_some() || names.len() == 1 {
            return Ok(is_chosen);
        }
        if matches!(self.first, FirstFrame::Came { held: None }) {
            let (own, other) = (&names[0], info.shown_name());
            let flag = as_argument(other);
            reports.say(&format!(
                "channel {other} is left out, since {own} came first; --channel {flag} takes it"
            ));
            return Ok(false);
        }
        let all = match self.source {
            FrameSource::File(path) => channels(path, self.asked, None)?.0,
            _ => names.to_vec(),
        };
        let names = all.join(", ");
        let message = format!("several channels, choose one with --channel: {names}");
        Err(reports.refused(&message))
    }

    fn admits(
        &mut self,
        frame: &Frame,
        time: Option<f64>,
        reports: &mut SourceReports<'_>,
    ) -> bool {
        if !self.choice.takes(frame.channel) {
            return false;
        }
        if !matches!(self.first, FirstFrame::Missing) {
            return true;
        }
        let held = (self.wanted().is_none() && self.has_channels()).then(|| (frame.clone(), time));
        let passes = held.is_none();
        self.first = FirstFrame::Came { held };
        if let (Some(wanted), false) = (self.wanted(), self.has_channels()) {
            reports.say(&format!(
                "no channel named {wanted:?}: a stream has none, and all frames are taken"
            ));
        }
        passes
    }

    fn release(&mut self) -> Option<(Frame, Option<f64>)> {
        match &mut self.first {
            FirstFrame::Missing => None,
            FirstFrame::Came { held } => held.take(),
        }
    }

    fn no_frame_reason(&self) -> Option<String> {
        let is_missing = matches!(self.first, FirstFrame::Missing);
        let reason = || {
            self.choice
                .missing()
                .unwrap_or_else(|| "no frames".to_owned())
        };
        is_missing.then(reason)
    }
}
