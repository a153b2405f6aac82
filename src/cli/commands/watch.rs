//! `taxel watch`: prints a line of JSON for each frame of a source, and records all frames if a file is given. On a
//! terminal, the screen's live page opens instead.
//!
//! ```text
//! acquire -> one channel -> Recording: each frame as it came
//!                        -> Pipeline; the first frames wait, if a tare is made -> LineWriter -> standard output
//!         -> what is odd or wrong -> standard error, a line each
//! ```
//! A live source that is recorded is never held up: if the reader of the answers is slow, some frames get no answer, and
//! their number is reported. If the reader is gone, or answers cannot be written, a recording continues; without one
//! the command ends. If the recording fails, as on a full disk, the answers go on; the error is reported at once, and is
//! that of the command at its end.

use std::ffi::OsString;
use std::fmt::Display;
use std::io::{self, IsTerminal, Write};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use clap::Arg;
use taxel_core::frame::{Frame, TareFrames};
use taxel_core::imprint::Imprint;
use taxel_core::quote::as_argument;
use taxel_files::acquire::{
    AcquireEvent, FrameRecorder, FrameSource, Playback, RecorderError, acquire,
};
use taxel_files::formats::json;
use taxel_files::formats::recording::{
    ChannelChoice, ChannelInfo, FrameAnswer, StreamCounts, no_channel,
};
use taxel_files::formats::value::counted;
use taxel_files::{ReadError, ReadErrorKind};

use crate::cli::arguments::flags::{file_of, name_or_path};
use crate::cli::arguments::parameters::Given;
use crate::cli::commands::export::replacing;
use crate::cli::commands::frame_flags::WatchFlags;
use crate::cli::commands::model;
use crate::cli::commands::recognise::{FoundNamer, Namer, NamingFlags};
use crate::cli::commands::screen::{self, Look};
use crate::cli::input::recording::{RecordingFile, damaged, refused};
use crate::cli::signals::Signals;
use crate::cli::{Context, Failure, Named};
use crate::frames::recording::Recording;
use crate::frames::{Pipeline, Taring, WatchRequest};
use crate::tui::live::source::check as check_source;

#[derive(Debug, clap::Args)]
#[command(about = "Show or describe the frames of a sensor, live or played back")]
#[command(after_help = EXAMPLES, mut_args(of_screen))]
pub(crate) struct Watch {
    #[arg(value_name = "SOURCE", value_parser = name_or_path())]
    #[arg(help = "Serial line, FIFO, tcp://HOST:PORT, recording or file; '-' for\nstandard input")]
    source: OsString,
    /// Record all frames, for numpy and 'taxel frames'
    #[arg(long, value_name = "FILE.npy", value_parser = file_of("npy"))]
    write: Option<PathBuf>,
    /// Replace an existing file
    #[arg(long, requires = "write")]
    force: bool,
    /// Print JSON, one line per answer
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    flags: WatchFlags,
    #[command(flatten)]
    look: Look,
}

const EXAMPLES: &str = "\
On a terminal, a page shows the frames; it stays open when the source has ended,
even with --once. With --json, or in a pipeline, taxel prints a line for each
frame, like 'taxel frames --all --json'; without a threshold, the imprint in it
is null. A stream consists of lines of numbers, JSON lines, the output of
'ros2 topic echo', or the bytes of FlexiTac or MatSense; taxel recognises the
format from the content. A recording is played at its own rate. If a serial line
or connection is lost, taxel tries again every second, unless --once is given;
on a terminal, it also waits for one that does not exist yet. Torn, short, long
and garbled frames are dropped and counted.

--write records every frame, shown or not; numpy can open the file at any time.
A .json file of the same name describes the values. The source's own labels are
not recorded; the lines of --json have them.

Examples:
  taxel watch recording.csv --once --at-least 10
  taxel watch - --format lines --percent 50 --write touch.npy < rows.txt
  taxel watch touch.npy --speed 10 --at-least 9
  taxel watch recording.csv --once --percent 40 --model parts
  taxel watch touch.npy --once --at-least 9 | taxel recognise - --model parts";

fn of_screen(arg: Arg) -> Arg {
    match arg.get_id().as_str() {
        "color" | "theme" | "no_mouse" => arg.conflicts_with("json"),
        _ => arg,
    }
}

impl Watch {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        let usual = cx.settings.watch_request();
        let naming = self.flags.naming.clone();
        let mut request = self.flags.request(&self.source, &usual)?;
        let source = FrameSource::new(&self.source);
        request.write = self.write.map(|path| (path, replacing(self.force)));
        let on_screen = !self.json && io::stdout().is_terminal();
        // The user's terminal would be set up as a serial line, on which Ctrl-C is only a byte.
        if on_screen || matches!(source, FrameSource::Serial(_)) {
            check_source(&source).map_err(|why| refused(&source.name(), why))?;
        }
        if !on_screen {
            request.source = source;
            return watch(&request, &naming, cx);
        }
        check(&source, &request)?;
        // The recording is created and dropped again: no file appears before the first frame.
        drop(recording(&source, &request)?);
        if let Some(model) = request.model {
            request.model = Some(model::models(&cx.shelf).locate(model)?);
        }
        let settings = cx.settings.with(&self.look, &Given::default())?;
        screen::open(cx, &settings, None, None, Some(request))
    }
}

/// Answers the frames of a source until it ends, or a signal stops it.
fn watch(request: &WatchRequest, naming: &NamingFlags, cx: &Context) -> Result<(), Failure> {
    let source = &request.source;
    let signals = Signals::catch()?;
    check(source, request)?;
    // Errors in these are reported before a recording begins. Training shows no progress: standard error is for
    // oddities of the source.
    let namer = naming.find(request.pipeline.processing.view.mask.as_ref(), &cx.shelf)?;
    let lines = LineWriter::start(&signals.stopped, namer)?;
    let recording = recording(source, request)?;
    let mut watcher = Watcher {
        request,
        cx,
        name: source.name(),
        channels: ChannelChoice::new(request.options.channel.as_deref()),
        names: Vec::new(),
        has_frame: false,
        pipeline: request.pipeline.clone(),
        waiting: Vec::new(),
        may_give_up: source.arrives(request.options.playback) && recording.is_some(),
        recording,
        unrecorded: None,
        lines: Some(lines),
        unwritten: None,
        answered: 0,
        unfit: 0,
        dropped: 0,
        reported: None,
    };
    let mut failed = None;
    let acquired = acquire(
        source,
        &request.options,
        &signals.stopped,
        &mut |event| match watcher.on(event) {
            Ok(()) => ControlFlow::Continue(()),
            Err(failure) => {
                failed = Some(failure);
                ControlFlow::Break(())
            }
        },
    );
    let stopped = !signals.goes_on();
    watcher.finish(failed, acquired, stopped)?;
    if stopped {
        return Err(Failure::silent(signals.status()));
    }
    Ok(())
}

/// Refuses flags that have no effect for a source: those of serial lines for others, those of playing for a stream,
/// and a channel that a recording does not have, which would be played to its end without an answer.
fn check(source: &FrameSource, request: &WatchRequest) -> Result<(), Failure> {
    let options = &request.options;
    if let Some(why) = source.unused_baud().filter(|_| request.baud_named) {
        return Err(Failure::usage(format!("--baud has no effect {why}")));
    }
    // A source that cannot be read is reported when it is watched.
    if let Playback::Paced { repeat, .. } = options.playback
        && source.is_recording(options) == Ok(false)
    {
        let flag = if repeat { "loop" } else { "speed" };
        let why = "has no effect on a stream: it is for recordings";
        return Err(Failure::usage(format!("--{flag} {why}")));
    }
    let (FrameSource::File(path), None, Some(wanted)) = (source, options.format, &options.channel)
    else {
        return Ok(());
    };
    let mut recording = RecordingFile::open(path, options.of_recording())?;
    let (names, is_whole) = recording.channel_names(wanted);
    // A damage is reported when the source is watched.
    if names.contains(wanted) || !is_whole {
        return Ok(());
    }
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    Err(refused(&source.name(), no_channel(wanted, &names)))
}

fn recording(source: &FrameSource, request: &WatchRequest) -> Result<Option<Recording>, Failure> {
    Recording::asked(source, request).map_err(|error| unrecorded(&error))
}

fn unrecorded(error: &RecorderError) -> Failure {
    let exists = matches!(error, RecorderError::Exists(_));
    Failure::new(error.to_string()).with_hint(if exists { "; --force replaces it" } else { "" })
}

/// The shortest time between two reports of dropped frames.
const REPORT: Duration = Duration::from_secs(1);

struct Watcher<'a> {
    request: &'a WatchRequest,
    cx: &'a Context,
    /// The name of the source.
    name: String,
    channels: ChannelChoice,
    /// The names of all channels.
    names: Vec<Option<String>>,
    has_frame: bool,
    pipeline: Pipeline,
    /// The frames that wait for the tare.
    waiting: Vec<Frame>,
    recording: Option<Recording>,
    unrecorded: Option<Failure>,
    /// None once nothing can be written any more.
    lines: Option<LineWriter>,
    unwritten: Option<Failure>,
    /// Whether frames may be left unanswered if the reader is slow.
    may_give_up: bool,
    answered: u64,
    /// The number of frames not answered because crop, tare, mask or gain do not fit their size.
    unfit: u64,
    dropped: u64,
    reported: Option<Instant>,
}

impl Watcher<'_> {
    fn say(&self, text: impl Display) {
        self.cx.note(&format!("{}: {text}", self.name));
    }

    fn warn(&self, text: impl Display) {
        self.cx.note(&format!("warning: {}: {text}", self.name));
    }

    fn refused(&self, why: impl Display) -> Failure {
        refused(&self.name, why)
    }

    fn on(&mut self, event: AcquireEvent<'_>) -> Result<(), Failure> {
        match event {
            AcquireEvent::Channel(info) => return self.add_channel(info),
            AcquireEvent::Frame { frame, time } => return self.add_frame(frame, time),
            AcquireEvent::Tick(counts) => {
                self.record(FrameRecorder::tick)?;
                if self
                    .lines
                    .as_ref()
                    .is_some_and(|own| own.thread.is_finished())
                {
                    self.end_lines()?;
                }
                if self.reported.is_none_or(|last| last.elapsed() >= REPORT) {
                    self.report_dropped(counts);
                }
            }
            AcquireEvent::Ended(counts) => return self.end_stream(counts),
            AcquireEvent::Silent { reason, .. } => self.say(reason),
            AcquireEvent::Lost(error) => self.say(AcquireEvent::lost(error)),
            AcquireEvent::Back { gap } => self.say(AcquireEvent::back_after(gap)),
            AcquireEvent::Note(note) if !note.is_plain() => self.warn(note),
            _ => {}
        }
        Ok(())
    }

    fn add_channel(&mut self, info: &ChannelInfo) -> Result<(), Failure> {
        self.names.push(info.name.clone());
        let is_chosen = self.channels.add(info);
        if let (None, [first, .., other]) =
            (&self.request.options.channel, &self.channels.names[..])
        {
            let flag = as_argument(other);
            self.say(format!(
                "channel {other} is left out, since {first} came first; --channel {flag} takes it"
            ));
        }
        if !is_chosen {
            return Ok(());
        }
        if let Some(unused) = self.pipeline.begin(info) {
            self.warn(unused);
        }
        let (tare, rule) = (self.pipeline.processing.tare.clone(), self.pipeline.rule());
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

    fn add_frame(&mut self, frame: &Frame, time: Option<f64>) -> Result<(), Failure> {
        if !self.channels.takes(frame.channel) {
            return Ok(());
        }
        if !std::mem::replace(&mut self.has_frame, true)
            && let Some(wanted) = &self.request.options.channel
            && self.names.is_empty()
        {
            self.say(format!(
                "no channel named {wanted:?}: a stream has none, and all frames are taken"
            ));
        }
        self.record(|recorder| recorder.add(frame, time))?;
        let mut frame = frame.clone();
        frame.time = time;
        // A sensor that was lost may come back with another size: then the tare begins again with its frames.
        let taring = self.pipeline.add_to_tare(&frame);
        match taring.map_err(|error| self.refused(error))? {
            Taring::Done => return self.answer(&frame),
            Taring::LeftOut(error) if self.waiting.is_empty() => return Err(self.refused(error)),
            Taring::Again => {
                let size = frame.size();
                self.waiting.retain(|own| own.size() == size);
            }
            Taring::LeftOut(_) | Taring::Added | Taring::Made => {}
        }
        if let Some((_, wanted)) = self.pipeline.progress() {
            let fits = TareFrames::new(wanted).check_memory(frame.values().len());
            fits.map_err(|error| self.refused(error))?;
            self.waiting.push(frame);
            return Ok(());
        }
        self.waiting.push(frame);
        let tare = self.pipeline.processing.tare.clone();
        self.record(|recorder| recorder.describe(|metadata| metadata.tare = tare))?;
        if let Some(unknown) = self.pipeline.unknown_step() {
            self.warn(unknown);
        }
        let waiting = std::mem::take(&mut self.waiting);
        waiting.iter().try_for_each(|frame| self.answer(frame))
    }

    /// Answers a frame. One whose size does not fit crop, tare, mask or gain is left out if others did fit: the sensor
    /// continues.
    fn answer(&mut self, frame: &Frame) -> Result<(), Failure> {
        let Some(lines) = &mut self.lines else {
            return Ok(());
        };
        let processed = match self.pipeline.processing.run(frame) {
            Ok(processed) => processed,
            Err(error) if self.answered > 0 && error.is_of_size() => {
                self.unfit += 1;
                if self.unfit == 1 {
                    self.say(format!("frame {} is not printed: {error}", frame.number));
                }
                return Ok(());
            }
            Err(error) => return Err(self.refused(error)),
        };
        self.answered += 1;
        let answer = FrameAnswer {
            frame,
            channel: self.names.get(frame.channel).and_then(Option::as_deref),
            processed,
        };
        let line = json::ascii(&answer) + "\n";
        let line = (line.into_bytes(), processed.imprint);
        if lines.send(line, self.may_give_up) {
            Ok(())
        } else {
            self.end_lines()
        }
    }

    fn record(
        &mut self,
        write: impl FnOnce(&mut FrameRecorder) -> Result<(), RecorderError>,
    ) -> Result<(), Failure> {
        let Some(Err(error)) = self.recording.as_ref().map(|own| own.write(write)) else {
            return Ok(());
        };
        self.recording = None;
        if self.lines.is_none() {
            return Err(unrecorded(&error));
        }
        self.say(format!("{error}; the answers go on"));
        self.may_give_up = false;
        self.unrecorded = Some(unrecorded(&error));
        Ok(())
    }

    /// Ends the answers. If they cannot be written while frames are recorded, the watch goes on.
    fn end_lines(&mut self) -> Result<(), Failure> {
        let Some(lines) = self.lines.take() else {
            return Ok(());
        };
        let given_up = lines.given_up;
        let Err(error) = lines.finish()? else {
            if given_up > 0 {
                let frames = counted(given_up, "frame");
                self.say(format!("{frames} recorded but not printed"));
            }
            return Ok(());
        };
        let is_closed = error.kind() == io::ErrorKind::BrokenPipe;
        let failure = Failure::of_output(error);
        if self.recording.is_none() {
            return Err(failure);
        }
        if is_closed {
            self.say("standard output is closed; the recording continues");
        } else {
            self.say(format!("{}; the recording continues", failure.text));
            self.unwritten = Some(failure);
        }
        Ok(())
    }

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
        self.warn(text);
    }

    /// Reports dropped frames at the end of a stream, and that there was no frame at all.
    fn end_stream(&mut self, counts: &StreamCounts) -> Result<(), Failure> {
        self.report_dropped(counts);
        let Some(why) = counts.no_frame() else {
            return Ok(());
        };
        if counts.bytes == 0 {
            return Err(self.refused("empty, expected frames of a sensor"));
        }
        let advice = counts
            .reason
            .is_none()
            .then_some("; check --rows, --columns and --format");
        let advice = advice.unwrap_or_default();
        Err(self.refused(format!("{why}{advice}")))
    }

    /// The failure that ended the source. If a stream cannot be decoded without more flags, it says which of them
    /// help.
    fn damage(&self, error: &ReadError) -> Failure {
        let advice = match (error.kind, &self.request.source) {
            (_, FrameSource::File(_)) => return damaged(&self.name, error),
            (ReadErrorKind::UnknownFormat, _) => "; --format names one",
            (ReadErrorKind::Unsized, _) => "; give --rows and --columns",
            _ => return damaged(&self.name, error),
        };
        self.refused(format!("{error}{advice}"))
    }

    /// Ends recording and answers. Returns the first error in this order: of recording, of writing answers, of the
    /// frames, of the source.
    fn finish(
        mut self,
        mut failed: Option<Failure>,
        acquired: Result<(), ReadError>,
        stopped: bool,
    ) -> Result<(), Failure> {
        let ended_well = acquired.is_ok() && !stopped;
        let is_unreadable =
            (acquired.as_ref()).is_err_and(|error| matches!(error.kind, ReadErrorKind::Io(_)));
        let damage = acquired.err().map(|error| self.damage(&error));
        if let (Some(failure), Some(recording)) =
            (failed.as_ref().or(damage.as_ref()), &self.recording)
        {
            // Nothing is written yet.
            let _ = recording.write(|recorder: &mut FrameRecorder| {
                recorder.note_reason(&failure.text);
                Ok(())
            });
        }
        if ended_well {
            failed = failed.or_else(|| self.unfinished());
        }
        let recorded = self.end_recording(is_unreadable);
        if self.unfit > 1 {
            let frames = counted(self.unfit, "frame");
            self.say(format!("{frames} of another size not printed"));
        }
        let written = self.end_lines();
        recorded?;
        self.unrecorded.map_or(Ok(()), Err)?;
        written?;
        self.unwritten.map_or(Ok(()), Err)?;
        failed.or(damage).map_or(Ok(()), Err)
    }

    /// The error of a source that has ended before a tare was complete, or without a frame of the channel. For a
    /// stream, the latter is an error already.
    fn unfinished(&self) -> Option<Failure> {
        if let Some(lacking) = self.pipeline.lacking() {
            return Some(self.refused(self.pipeline.explained(&lacking)));
        }
        let missing = || self.channels.missing().unwrap_or("no frames".to_owned());
        (!self.has_frame).then(|| self.refused(missing()))
    }

    /// Ends the recording, and reports the frames that are not in it. That no frame came is no news if the source
    /// cannot be read.
    fn end_recording(&mut self, is_unreadable: bool) -> Result<(), Failure> {
        let Some(recording) = &self.recording else {
            return Ok(());
        };
        let Some(recorded) = recording.finish().map_err(|error| unrecorded(&error))? else {
            return Ok(());
        };
        if recorded.left_out > 0 {
            let frames = counted(recorded.left_out, "frame");
            self.say(format!("{frames} of another size not recorded"));
        }
        if recorded.frames == 0 && !is_unreadable {
            let path = recording.path.display();
            self.say(format!("no frame came, so {path} was not written"));
        }
        Ok(())
    }
}

/// The most lines that may wait; for frames of 64 × 64 they take about 5 MB.
const WAITING: usize = 1000;

/// The time after which a line is sent again if too many are waiting, and a signal is looked for.
const PAUSE: Duration = Duration::from_millis(1);

/// The time that a reader has, after a signal, to read what is waiting.
const PATIENCE: Duration = Duration::from_secs(1);

/// A line, with the imprint of its frame.
type Line = (Vec<u8>, Option<Imprint>);

/// Writes lines to standard output on a thread of its own, so that a slow reader does not hold up a recording. With a
/// model, that thread also names each imprint.
struct LineWriter {
    lines: SyncSender<Line>,
    /// Fails if the model cannot be trained; the inner error is that of standard output.
    thread: JoinHandle<Result<io::Result<()>, Failure>>,
    stopped: Arc<AtomicBool>,
    /// The number of lines dropped because too many were waiting.
    given_up: u64,
}

impl LineWriter {
    fn start(stopped: &Arc<AtomicBool>, namer: Option<FoundNamer>) -> Result<Self, Failure> {
        let (lines, waiting) = sync_channel(WAITING);
        let thread = std::thread::Builder::new().spawn(move || {
            let namer = namer.map(FoundNamer::ready);
            Ok(write_lines(&waiting, namer.transpose()?.as_ref()))
        });
        Ok(Self {
            lines,
            thread: thread.named("cannot start a thread")?,
            stopped: Arc::clone(stopped),
            given_up: 0,
        })
    }

    /// Sends a line. If too many are waiting, it waits until there is room, or drops the line if `may_give_up`; after
    /// a signal, it drops the line, uncounted. Returns false once nothing can be written.
    fn send(&mut self, mut line: Line, may_give_up: bool) -> bool {
        loop {
            line = match self.lines.try_send(line) {
                Ok(()) => return true,
                Err(TrySendError::Disconnected(_)) => return false,
                Err(TrySendError::Full(_)) if may_give_up => {
                    self.given_up += 1;
                    return true;
                }
                Err(TrySendError::Full(_)) if self.stopped.load(Ordering::Relaxed) => return true,
                Err(TrySendError::Full(line)) => line,
            };
            std::thread::sleep(PAUSE);
        }
    }

    /// Waits until all lines are written; after a signal, for a second at most. Lines that nobody has read by then are
    /// lost.
    fn finish(self) -> Result<io::Result<()>, Failure> {
        drop(self.lines);
        let mut stopped_at = None;
        while !self.thread.is_finished() {
            if self.stopped.load(Ordering::Relaxed)
                && stopped_at.get_or_insert_with(Instant::now).elapsed() > PATIENCE
            {
                // The thread ends with the program.
                return Ok(Ok(()));
            }
            std::thread::sleep(PAUSE);
        }
        let ended = self.thread.join();
        ended.unwrap_or_else(|_| Err(Failure::new("the thread that writes has failed")))
    }
}

fn write_lines(waiting: &Receiver<Line>, namer: Option<&Namer>) -> io::Result<()> {
    let mut output = io::BufWriter::with_capacity(1 << 16, io::stdout().lock());
    loop {
        let next = match waiting.try_recv() {
            Err(TryRecvError::Empty) => {
                output.flush()?;
                waiting.recv().ok()
            }
            next => next.ok(),
        };
        let Some((mut line, imprint)) = next else {
            return output.flush();
        };
        if let Some(namer) = namer {
            namer.extend(&mut line, imprint.as_ref());
        }
        output.write_all(&line)?;
    }
}
