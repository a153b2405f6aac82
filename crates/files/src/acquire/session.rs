//! What an acquisition knows while it runs. The input and the reader's sink take turns with it.

use std::cell::Cell;
use std::fs::File;
use std::io;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime};

use taxel_core::frame::Frame;

use crate::ReadError;
use crate::acquire::clock::{Pace, SilenceWatch, TICK};
use crate::acquire::event::{AcquireEvent, AcquireOptions, AcquireSink, Playback};
use crate::acquire::source::FrameSource;
use crate::formats::recording::{
    ChannelChoice, ChannelInfo, RecordingEvent, RecordingMetadata, StreamCounts, unshaped,
};
use crate::formats::seconds::to_nanoseconds;

/// The time without a change after which a file is complete, if it has not grown since it was opened.
const UNCHANGED: Duration = Duration::from_secs(2);

/// Whether a file grows while it is read.
struct Growth {
    file: File,
    /// The length at first.
    length: u64,
    has_grown: bool,
    /// Whether more is waited for even if it does not grow.
    is_endless: bool,
    /// Whether everything that was in the file has been read, so that frames now arrive as they are written.
    has_caught_up: bool,
}

impl Growth {
    fn has_grown(&mut self) -> bool {
        self.has_grown = self.has_grown
            || self
                .file
                .metadata()
                .is_ok_and(|found| found.len() > self.length);
        self.has_grown
    }

    /// Whether more may come: the file has grown, or was changed just now.
    fn may_go_on(&mut self) -> bool {
        if self.is_endless || self.has_grown() {
            return true;
        }
        let changed = self.file.metadata().and_then(|found| found.modified());
        let age = changed.map(|changed| SystemTime::now().duration_since(changed));
        matches!(age, Ok(Ok(age)) if age < UNCHANGED)
    }
}

pub(super) struct Session<'a, 'b> {
    pub(super) options: &'a AcquireOptions,
    pub(super) counts: StreamCounts,
    source: &'a FrameSource,
    stop: &'a AtomicBool,
    /// Whether the consumer wants no more.
    is_done: &'a Cell<bool>,
    consumer: &'a mut AcquireSink<'b>,
    ticked: Instant,
    silence: SilenceWatch,
    /// When the first frame without a time of its own arrived.
    first: Option<Instant>,
    /// The pace of a recording; None if its frames are wanted at once.
    pace: Option<Pace>,
    /// The channel that is watched.
    channel: ChannelChoice,
    /// The number of its values, if its rows and columns are unknown.
    unshaped: Option<u64>,
    metadata: Option<RecordingMetadata>,
    growth: Option<Growth>,
    is_repeated: bool,
    has_followed: bool,
    /// The error that ends the reading.
    failure: Option<ReadError>,
}

impl<'a, 'b> Session<'a, 'b> {
    pub(super) fn new(
        source: &'a FrameSource,
        options: &'a AcquireOptions,
        stop: &'a AtomicBool,
        is_done: &'a Cell<bool>,
        consumer: &'a mut AcquireSink<'b>,
    ) -> Self {
        let now = Instant::now();
        Self {
            options,
            counts: StreamCounts::default(),
            source,
            stop,
            is_done,
            consumer,
            ticked: now,
            silence: SilenceWatch::new(now),
            first: None,
            pace: None,
            channel: ChannelChoice::new(options.channel.as_deref()),
            unshaped: None,
            metadata: None,
            growth: None,
            is_repeated: false,
            has_followed: false,
            failure: None,
        }
    }

    /// Lets the frames of a recording come at their own pace, unless they are wanted at once.
    pub(super) fn play(&mut self, metadata: Option<RecordingMetadata>) {
        self.metadata = metadata;
        if self.options.playback != Playback::Once {
            self.pace = Some(Pace::new(self.options.playback, Instant::now()));
        }
    }

    /// Watches whether a file grows, so that reading waits for more at its end.
    pub(super) fn follow(&mut self, file: &File) -> io::Result<()> {
        self.growth = Some(Growth {
            length: file.metadata()?.len(),
            file: file.try_clone()?,
            has_grown: false,
            is_endless: self.options.format.is_some(),
            has_caught_up: false,
        });
        Ok(())
    }

    pub(super) fn report(&mut self, event: AcquireEvent<'_>) -> ControlFlow<()> {
        (self.consumer)(event)
    }

    pub(super) fn report_end(&mut self) {
        let _ = (self.consumer)(AcquireEvent::Ended(&self.counts));
    }

    /// Whether no more is wanted.
    pub(super) fn is_stopped(&self) -> bool {
        self.is_done.get() || self.stop.load(Ordering::Relaxed)
    }

    /// The error that ended the reading, if the sink has met one.
    pub(super) fn check(&mut self) -> Result<(), ReadError> {
        self.failure.take().map_or(Ok(()), Err)
    }

    /// Reports a tick, if one is due. `Break` if no more is wanted.
    pub(super) fn beat(&mut self) -> ControlFlow<()> {
        if self.is_stopped() {
            return ControlFlow::Break(());
        }
        if self.ticked.elapsed() < TICK {
            return ControlFlow::Continue(());
        }
        self.ticked = Instant::now();
        (self.consumer)(AcquireEvent::Tick(&self.counts))
    }

    /// Reports a tick, if one is due, and whether the source is silent.
    pub(super) fn tick(&mut self) -> ControlFlow<()> {
        let before = self.ticked;
        self.beat()?;
        // The frames of a recording come when they are due, and a file that does not grow is not waited for.
        let growth = self.growth.as_ref();
        let is_complete = growth.is_some_and(|growth| !growth.has_grown && !growth.is_endless);
        if self.ticked == before || self.pace.is_some() || is_complete {
            return ControlFlow::Continue(());
        }
        let StreamCounts { frames, bytes, .. } = self.counts;
        let Some(rate) = self.silence.look(frames, bytes, self.ticked) else {
            return ControlFlow::Continue(());
        };
        let has_baud = self.source.unused_baud().is_none();
        let reason = self.counts.silence(rate, has_baud);
        (self.consumer)(AcquireEvent::Silent {
            counts: &self.counts,
            reason: &reason,
        })
    }

    /// Notes that the source is open, perhaps again: the wait for it was no silence.
    pub(super) fn begin(&mut self) {
        self.silence.begin(self.counts.bytes, Instant::now());
    }

    /// Begins a recording again, if it is to be repeated. A recording without frames is not: it would be read again and
    /// again without a pause.
    pub(super) fn begins_again(&mut self) -> bool {
        let has_frames = self.pace.as_mut().is_some_and(Pace::begin_again);
        self.is_repeated = true;
        self.options.playback.repeats() && has_frames && self.wait_until_due().is_continue()
    }

    /// Whether the end of the input is that of its last line.
    pub(super) fn is_read_to_its_end(&self) -> bool {
        match self.source {
            FrameSource::File(_) => true,
            source => self.options.playback == Playback::Once && !source.comes_back(),
        }
    }

    /// Whether reading waits at the end of a file: for ever if it is a stream, else as long as it grows.
    pub(super) fn may_go_on(&mut self) -> bool {
        let Some(growth) = &mut self.growth else {
            return false;
        };
        if !growth.may_go_on() {
            return false;
        }
        growth.has_caught_up = true;
        if growth.has_grown
            && !growth.is_endless
            && !std::mem::replace(&mut self.has_followed, true)
        {
            let _ = (self.consumer)(AcquireEvent::Follows);
        }
        true
    }

    /// Takes an event of the reader, and reports what it means.
    pub(super) fn take(&mut self, event: RecordingEvent<'_>) -> ControlFlow<()> {
        self.counts.note(&event);
        match event {
            RecordingEvent::Channel(info) => self.take_channel(info),
            RecordingEvent::Frame(frame) => self.take_frame(frame),
            RecordingEvent::Note(note) => self.report(AcquireEvent::Note(note)),
            RecordingEvent::Damage { .. } => ControlFlow::Continue(()),
        }
    }

    fn take_channel(&mut self, info: &ChannelInfo) -> ControlFlow<()> {
        if self.is_repeated {
            return ControlFlow::Continue(());
        }
        let info = info.completed(self.metadata.as_ref());
        if self.channel.add(&info) {
            self.unshaped = info.values.filter(|_| info.size.is_none());
            if let (Some(pace), Some(step)) = (&mut self.pace, info.seconds_per_frame) {
                pace.set_step(step);
            }
        }
        self.report(AcquireEvent::Channel(&info))
    }

    fn take_frame(&mut self, frame: &Frame) -> ControlFlow<()> {
        if self.channel.takes(frame.channel) {
            if let Some(values) = self.unshaped {
                self.failure = Some(unshaped(values, self.options.size));
                return ControlFlow::Break(());
            }
            if let Some(pace) = &mut self.pace {
                pace.take(frame);
            }
            self.wait_until_due()?;
        }
        // Also if playback lags behind and does not wait.
        self.tick()?;
        // The present content of a file has arrived at some other time.
        let arrives = self.source.arrives(self.options.playback)
            || self
                .growth
                .as_ref()
                .is_some_and(|growth| growth.has_caught_up);
        let arrival = arrives.then(|| {
            let now = Instant::now();
            to_nanoseconds((now - *self.first.get_or_insert(now)).as_secs_f64())
        });
        let time = frame.time.or(arrival);
        self.report(AcquireEvent::Frame { frame, time })
    }

    /// Waits until the last frame is due, unless the file has grown: then frames are wanted as they come.
    fn wait_until_due(&mut self) -> ControlFlow<()> {
        while let Some(pace) = &self.pace {
            if self.growth.as_mut().is_some_and(Growth::has_grown) {
                self.pace = None;
                break;
            }
            let left = pace.left(Instant::now());
            if left.is_zero() {
                break;
            }
            self.beat()?;
            std::thread::sleep(left.min(TICK));
        }
        ControlFlow::Continue(())
    }
}
