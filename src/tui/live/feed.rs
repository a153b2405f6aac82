//! The frames of a source that the screen has not taken yet.
//!
//! ```text
//! acquire -> Recording: every frame
//!         -> what has not been taken yet, bounded in bytes -> take -> FrameBatch
//! ```
//! The thread that reads the source adds frames, and the screen's thread takes them; neither waits for the other. A
//! slow disk holds up the source and nothing else.

use std::mem::take;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use taxel_core::frame::Frame;
use taxel_core::lock::locked;
use taxel_core::progress::stop_if;
use taxel_files::acquire::{
    AcquireEvent, AcquireOptions, FrameRecorder, FrameSource, Playback, RecorderError, acquire,
};
use taxel_files::formats::file::system_reason;
use taxel_files::formats::recording::{ChannelChoice, ChannelInfo, StreamCounts};
use taxel_files::formats::value::{counted, decimal};
use taxel_files::{ReadError, ReadErrorKind};

use crate::frames::WatchRequest;
use crate::frames::recording::{RecordedFrames, Recording};
use crate::tui::live::history::bytes_of;

#[derive(Clone, Debug, Default)]
pub struct FrameBatch {
    pub frames: Vec<Arc<Frame>>,
    pub status: FeedStatus,
}

#[derive(Clone, Debug, Default)]
pub struct FeedStatus {
    pub state: SourceState,
    /// The channel that is watched; without any content until it is known.
    pub channel: Arc<ChannelInfo>,
    /// The number of channels; 0 for a stream.
    pub channels: usize,
    /// Whether the source is a recording that is still being written.
    pub follows: bool,
    pub counts: StreamCounts,
    pub gaps: SourceGaps,
    /// The number of frames that were dropped because nobody took them and there was no memory for more.
    pub overflowed: u64,
    /// The frames of the recording; None without a recording.
    pub recorded: Option<RecordedFrames>,
    pub record_error: Option<String>,
    pub note: Option<String>,
    /// The number of notes so far.
    pub notes: u64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SourceGaps {
    pub count: u64,
    /// The total time until the source was back, in seconds.
    pub waited: f64,
    /// The total time between the last frame before each gap and the first one after it, in seconds.
    pub missing: f64,
}

impl SourceGaps {
    /// A sentence about the gaps after earlier ones; None if there are none.
    pub fn sentence_since(self, before: Self) -> Option<String> {
        let seconds = [self.missing - before.missing, self.waited - before.waited];
        let [missing, waited] = seconds.map(|seconds| decimal(seconds, 1));
        let gaps = match self.count.saturating_sub(before.count) {
            0 => return None,
            1 => String::new(),
            several => format!(" in {several} gaps"),
        };
        Some(format!(
            "no frames for {missing} s{gaps}, of which the connection was lost for {waited} s"
        ))
    }
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum SourceState {
    /// Frames come, or the first one is waited for.
    #[default]
    Live,
    /// No frame has come for two seconds or longer, or the source is gone or not there yet, and why.
    Silent(String),
    Ended,
    /// The source cannot be read, and why.
    Failed(String),
}

impl SourceState {
    pub fn is_final(&self) -> bool {
        matches!(self, Self::Ended | Self::Failed(_))
    }
}

#[derive(Debug)]
pub struct Feed {
    pub request: Arc<WatchRequest>,
    pub stop: AtomicBool,
    /// Locked while frames are added or taken, never while a file is written.
    pending: Mutex<Pending>,
    recording: Mutex<Option<Arc<Recording>>>,
}

#[derive(Debug, Default)]
struct Pending {
    batch: FrameBatch,
    bytes: usize,
    is_new: bool,
    channels: ChannelChoice,
    /// The number of frames that were taken by an earlier reading.
    skipped: usize,
    has_frame: bool,
    no_frame_reason: Option<String>,
    last_time: Option<f64>,
    /// The time for which the source has been lost since the last frame.
    gap: Option<Duration>,
}

impl Feed {
    pub fn new(request: Arc<WatchRequest>) -> Arc<Self> {
        Arc::new(Self {
            stop: AtomicBool::new(false),
            pending: Mutex::new(Pending::of(&request, 0)),
            recording: Mutex::default(),
            request,
        })
    }

    /// The recording, if there is one.
    pub fn recording(&self) -> Option<Arc<Recording>> {
        locked(&self.recording).clone()
    }

    /// Records frames from now on. Returns the recording before.
    pub fn record(&self, recording: Arc<Recording>) -> Option<Arc<Recording>> {
        let mut pending = locked(&self.pending);
        pending.batch.status.record_error = None;
        pending.batch.status.recorded = Some(RecordedFrames::default());
        locked(&self.recording).replace(recording)
    }

    /// Records no more. Returns the recording, which is to be finished.
    pub fn end_recording(&self) -> Option<Arc<Recording>> {
        locked(&self.pending).batch.status.recorded = None;
        locked(&self.recording).take()
    }

    /// Takes the pending frames and the state; None if nothing is new.
    pub fn take(&self) -> Option<FrameBatch> {
        let mut pending = locked(&self.pending);
        if !take(&mut pending.is_new) {
            return None;
        }
        pending.bytes = 0;
        Some(FrameBatch {
            frames: take(&mut pending.batch.frames),
            status: pending.batch.status.clone(),
        })
    }

    pub fn has_new(&self) -> bool {
        locked(&self.pending).is_new
    }

    /// Reads the source to its end, or until `stop` is set. `news` is called when there is something to take and there
    /// was nothing before.
    pub fn run(
        &self,
        source: &FrameSource,
        options: &AcquireOptions,
        news: &mut dyn FnMut() -> ControlFlow<()>,
    ) {
        let mut wanted = ControlFlow::Continue(());
        let ended = acquire(source, options, &self.stop, &mut |event| {
            let is_time = matches!(event, AcquireEvent::Tick(_) | AcquireEvent::Silent { .. });
            // A script has no clock: the time between its frames is its own, not a silence of the source.
            if !(is_time && options.playback == Playback::Once) && self.take_in(event, source) {
                wanted = news();
            }
            wanted
        });
        if wanted.is_break() {
            return;
        }
        let ended = ended.map_err(|error| failure(source, &error));
        let is_new = self.change(|pending| match ended {
            Ok(()) => pending.end(self.stop.load(Ordering::Relaxed)),
            Err(reason) => pending.batch.status.state = SourceState::Failed(reason),
        });
        if is_new {
            let _ = news();
        }
        // Nothing comes any more that would make the recording write its rest, and the page may stay open for long.
        let written = self.write(FrameRecorder::flush);
        if matches!(written, Some(Err(_))) && self.change(|pending| pending.note_recorded(written))
        {
            let _ = news();
        }
    }

    /// Reads the next frames for a script, up to `count` after those `taken` before. A file that has ended is read from
    /// its start, because it may have grown.
    pub fn next(&self, source: &FrameSource, taken: usize, count: usize) -> Vec<FrameBatch> {
        let mut pending = locked(&self.pending);
        let recorded = pending.batch.status.recorded;
        *pending = Pending::of(&self.request, taken);
        pending.batch.status.recorded = recorded;
        drop(pending);
        let options = AcquireOptions {
            playback: Playback::Once,
            ..self.request.options.clone()
        };
        let (mut frames, mut batches) = (0, Vec::new());
        self.run(source, &options, &mut || {
            let batch = self.take().unwrap_or_default();
            frames += batch.frames.len();
            batches.push(batch);
            stop_if(frames >= count)
        });
        batches
    }

    /// Notes that the source cannot be read, and why.
    pub fn fail(&self, reason: String) {
        self.change(|pending| pending.batch.status.state = SourceState::Failed(reason));
    }

    pub fn fail_recording(&self, reason: String) {
        self.change(|pending| pending.note_recorded(Some(Err(reason))));
    }

    /// Writes to the recording; None if there is none. A failure ends it.
    fn write(
        &self,
        write: impl FnOnce(&mut FrameRecorder) -> Result<(), RecorderError>,
    ) -> Option<Result<RecordedFrames, String>> {
        let written = self.recording()?.write(write);
        written.map_err(|error| error.to_string()).transpose()
    }

    /// Changes what is to be taken. Returns true if there was nothing to take before.
    fn change(&self, change: impl FnOnce(&mut Pending)) -> bool {
        let mut pending = locked(&self.pending);
        change(&mut pending);
        !std::mem::replace(&mut pending.is_new, true)
    }

    /// Records a frame of the channel that is watched, and keeps it for the screen.
    fn take_frame(&self, frame: &Frame, time: Option<f64>) -> bool {
        let mut pending = locked(&self.pending);
        if !pending.channels.takes(frame.channel) {
            return false;
        }
        if pending.skipped > 0 {
            pending.skipped -= 1;
            pending.has_frame = true;
            return false;
        }
        drop(pending);
        let recorded = self.write(|recorder| recorder.add(frame, time));
        let mut own = frame.clone();
        own.time = time;
        self.change(|pending| {
            // An error ends the recording; the frames are still shown.
            pending.note_recorded(recorded);
            pending.push(Arc::new(own), self.request.history_bytes);
        })
    }

    /// Takes a report of the source. Returns whether the screen must be told.
    fn take_in(&self, event: AcquireEvent<'_>, source: &FrameSource) -> bool {
        let to = |state: SourceState| self.change(|pending| pending.batch.status.state = state);
        match event {
            AcquireEvent::Channel(info) => self.change(|pending| {
                let is_chosen = pending.channels.add(info);
                let status = &mut pending.batch.status;
                status.channels = pending.channels.names.len();
                if is_chosen {
                    status.channel = Arc::new(info.clone());
                }
            }),
            AcquireEvent::Frame { frame, time } => self.take_frame(frame, time),
            AcquireEvent::Tick(counts) => {
                let written = self.write(FrameRecorder::tick);
                let is_news = matches!(written, Some(Err(_)))
                    || locked(&self.pending).batch.status.counts.dropped != counts.dropped;
                is_news
                    && self.change(|pending| {
                        pending.batch.status.counts = counts.clone();
                        pending.note_recorded(written);
                    })
            }
            AcquireEvent::Silent { counts, reason } => {
                to(SourceState::Silent(silence(source, counts, reason)))
            }
            AcquireEvent::Absent(error) => {
                let (name, reason) = (source.name(), system_reason(error));
                to(SourceState::Silent(format!(
                    "waiting for {name}, trying again each second: {reason}"
                )))
            }
            AcquireEvent::Lost(error) => self.change(|pending| {
                pending.gap.get_or_insert_default();
                pending.batch.status.state = SourceState::Silent(AcquireEvent::lost(error));
            }),
            AcquireEvent::Back { gap } => self.change(|pending| pending.back_after(gap)),
            AcquireEvent::Note(note) if note.is_plain() => false,
            AcquireEvent::Note(note) => self.change(|pending| {
                let status = &mut pending.batch.status;
                if status.note.is_none() {
                    status.set_note(note.to_string());
                }
            }),
            AcquireEvent::Follows => self.change(|pending| pending.batch.status.follows = true),
            AcquireEvent::Ended(counts) => self.change(|pending| {
                pending.batch.status.counts = counts.clone();
                let hint = match counts.reason {
                    None if counts.bytes > 0 => "; rows, columns or format?",
                    _ => "",
                };
                pending.no_frame_reason = counts.no_frame().map(|reason| reason + hint);
            }),
        }
    }
}

impl FeedStatus {
    fn set_note(&mut self, note: String) {
        self.note = Some(note);
        self.notes += 1;
    }
}

impl Pending {
    fn of(request: &WatchRequest, skipped: usize) -> Self {
        Self {
            channels: ChannelChoice::new(request.options.channel.as_deref()),
            skipped,
            ..Self::default()
        }
    }

    fn back_after(&mut self, time: Duration) {
        self.batch.status.state = match &mut self.gap {
            None => SourceState::Live,
            Some(gap) => {
                *gap += time;
                let back = AcquireEvent::back_after(*gap);
                SourceState::Silent(format!("{back}; no frame yet"))
            }
        };
    }

    /// Notes the end of the source. One from which no frame came was not what the user expected: the state is the
    /// reason.
    fn end(&mut self, is_stopped: bool) {
        self.batch.status.state = if self.has_frame || is_stopped {
            SourceState::Ended
        } else {
            let reason = self.channels.missing().or(self.no_frame_reason.take());
            SourceState::Failed(reason.unwrap_or_else(|| "no frames".to_owned()))
        };
    }

    /// Adds a frame. If nobody takes the frames and they exceed `most` bytes, the older half is dropped at once, so
    /// that a full buffer does not move all frames for each new one. At least one stays.
    fn push(&mut self, frame: Arc<Frame>, most: usize) {
        self.has_frame = true;
        let before = std::mem::replace(&mut self.last_time, frame.time);
        let status = &mut self.batch.status;
        if let (Some(gap), Some((before, now))) = (self.gap.take(), before.zip(frame.time)) {
            status.gaps.count += 1;
            status.gaps.waited += gap.as_secs_f64();
            status.gaps.missing += now - before;
        }
        status.state = SourceState::Live;
        self.bytes += bytes_of(&frame);
        self.batch.frames.push(frame);
        if self.bytes > most && self.batch.frames.len() > 1 {
            let half = self.batch.frames.len() / 2;
            let dropped = self.batch.frames.drain(..half);
            self.bytes -= dropped.map(|frame| bytes_of(&frame)).sum::<usize>();
            status.overflowed += half as u64;
        }
    }

    fn note_recorded(&mut self, recorded: Option<Result<RecordedFrames, String>>) {
        let status = &mut self.batch.status;
        match recorded {
            Some(Ok(recorded)) => status.recorded = Some(recorded),
            Some(Err(error)) => (status.recorded, status.record_error) = (None, Some(error)),
            None => {}
        }
    }
}

/// Why a source cannot be read, and what helps.
fn failure(source: &FrameSource, error: &ReadError) -> String {
    let hint = match (error.kind, source) {
        (ReadErrorKind::UnknownFormat, FrameSource::Standard) => {
            "; start again in the shell, with --format lines"
        }
        (ReadErrorKind::UnknownFormat, source) if !matches!(source, FrameSource::File(_)) => {
            "; after Esc, add one to :watch, as in --format lines"
        }
        (ReadErrorKind::Unsized, FrameSource::Standard) => {
            "; start again in the shell, with --rows R --columns C"
        }
        (ReadErrorKind::Unsized, _) => "; :size COLUMNSxROWS sets them",
        _ => "",
    };
    format!("{error}{hint}")
}

/// Why no frame comes. It stays true while the silence lasts: a page on which nothing changes is told nothing.
fn silence(source: &FrameSource, counts: &StreamCounts, what: &str) -> String {
    // A file has no baud, and sends nothing.
    if let (FrameSource::File(_), 0, 1..) = (source, counts.frames, counts.bytes) {
        let bytes = counted(counts.bytes, "byte");
        return format!("no frame yet: none in {bytes}; rows, columns or format?");
    }
    format!("no frame for more than 2 s: {what}")
}

#[cfg(test)]
mod tests {
    use std::io;

    use taxel_core::frame::FrameSize;

    use super::*;
    use crate::tui::live::state::Live;

    fn frame(channel: usize) -> Frame {
        let mut frame = Frame::new(FrameSize::new(2, 2).expect("an allowed size"));
        frame.channel = channel;
        frame
    }

    #[test]
    fn the_gap_of_a_lost_connection_is_reported_with_the_first_frame_after_it() {
        let request = Arc::new(WatchRequest::new("none"));
        let (feed, mut page) = (Feed::new(Arc::clone(&request)), Live::new(request, 7));
        let mut after = |event: AcquireEvent<'_>| {
            feed.take_in(event, &FrameSource::Standard);
            if let Some(batch) = feed.take() {
                page.take(&batch);
            }
            page.trouble()
        };
        let (frame, gap) = (frame(0), Duration::from_secs(2));
        let at = |time| AcquireEvent::Frame {
            frame: &frame,
            time: Some(time),
        };
        let error = io::Error::other("cut");
        // The source was waited for before it was there at all: nothing is missing.
        after(AcquireEvent::Absent(&error));
        after(AcquireEvent::Back { gap });
        assert_eq!(after(at(0.0)), None);
        // The source is lost again before a frame came: one gap.
        let mut trouble = None;
        for _ in 0..2 {
            let lost = after(AcquireEvent::Lost(&error)).expect("it is lost");
            assert!(lost.starts_with("lost: cut;"), "{lost}");
            trouble = after(AcquireEvent::Back { gap });
        }
        assert_eq!(trouble.as_deref(), Some("back after 4 s; no frame yet"));
        let once = "no frames for 5.5 s, of which the connection was lost for 4 s";
        assert_eq!(after(at(5.5)).as_deref(), Some(once));
        // The text stays until the user has seen it.
        assert_eq!(after(at(5.6)).as_deref(), Some(once));
        after(AcquireEvent::Lost(&error));
        after(AcquireEvent::Back { gap });
        let twice = "no frames for 7.9 s in 2 gaps, of which the connection was lost for 6 s";
        assert_eq!(after(at(8.0)).as_deref(), Some(twice));
        page.see_notices();
        assert_eq!((page.trouble(), page.status.gaps.count), (None, 2));
    }

    #[test]
    fn a_script_takes_each_frame_once_and_those_that_a_file_has_grown_by() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.csv");
        let write = |frames: std::ops::Range<u32>| {
            let lines = frames.map(|number| format!("{number},{number}\n"));
            let text = "S0_0,S0_1\n".to_owned() + &lines.collect::<String>();
            std::fs::write(&path, text).expect("written");
        };
        write(0..6);
        let feed = Feed::new(Arc::new(WatchRequest::new(&path)));
        let mut taken: Vec<f64> = Vec::new();
        let mut next = |count| {
            let batches = feed.next(&FrameSource::new(&path), taken.len(), count);
            let frames = batches.iter().flat_map(|batch| &batch.frames);
            let values: Vec<f64> = frames.map(|frame| frame.values()[0]).collect();
            taken.extend(&values);
            (
                values.len(),
                batches.last().map(|batch| batch.status.state.clone()),
            )
        };
        assert_eq!(next(2).0, 2);
        assert_eq!(next(1).0, 1);
        assert_eq!(next(9), (3, Some(SourceState::Ended)));
        assert_eq!(next(1), (0, Some(SourceState::Ended)));
        write(0..8);
        assert_eq!([next(1).0, next(9).0], [1, 1]);
        assert_eq!(taken, (0..8).map(f64::from).collect::<Vec<_>>());
    }
}
