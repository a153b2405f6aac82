//! A recording, played back at its own rate, another one, or as fast as it goes.

use std::fs::File;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::acquire::event::{AcquireError, AcquireEvent, AcquireOptions};
use crate::acquire::recorder::description_beside;
use crate::acquire::stream::Consumer;
use crate::formats::recording::{
    ChannelInfo, ReadOptions, RecordingEvent, RecordingMetadata, RecordingNote, read,
};
use crate::formats::stream::StreamCounts;

/// The rate of a recording that does not say its own: ten frames a second.
const STEP: f64 = 0.1;

/// A wait is cut into pieces of this length, so that it can be broken off.
const MOMENT: Duration = Duration::from_millis(100);

/// No recording is waited for longer than a day.
const LONGEST: f64 = 86_400.0;

/// When the next frame is due.
struct Pace {
    begun: Instant,
    /// Seconds from one frame to the next, where frames have no time.
    step: f64,
    speed: f64,
    frames: u32,
}

impl Pace {
    /// Waits for a frame; `Break` if no more is wanted.
    fn wait(
        &mut self,
        time: Option<f64>,
        stop: &AtomicBool,
        consumer: &mut Consumer<'_>,
    ) -> ControlFlow<()> {
        let own = f64::from(self.frames) * self.step;
        self.frames = self.frames.saturating_add(1);
        let seconds = (time.unwrap_or(own) / self.speed).clamp(0.0, LONGEST);
        let due = self.begun + Duration::from_secs_f64(seconds);
        loop {
            let left = due.saturating_duration_since(Instant::now());
            if stop.load(Ordering::Relaxed) {
                return ControlFlow::Break(());
            }
            if left.is_zero() {
                return ControlFlow::Continue(());
            }
            consumer(AcquireEvent::Tick(&StreamCounts::default()))?;
            std::thread::sleep(left.min(MOMENT));
        }
    }
}

/// Plays a recording.
pub(super) fn run(
    path: &Path,
    options: &AcquireOptions,
    stop: &AtomicBool,
    consumer: &mut Consumer<'_>,
) -> Result<(), AcquireError> {
    let mut file = File::open(path).map_err(|error| AcquireError::Io {
        doing: "open it",
        error,
    })?;
    let reading = ReadOptions {
        shape: options.shape,
    };
    let ControlFlow::Continue(description) = description_of(path, consumer) else {
        return Ok(());
    };
    let mut round = 0;
    loop {
        let mut pace = Pace {
            begun: Instant::now(),
            step: STEP,
            speed: options.speed,
            frames: 0,
        };
        let mut flow = ControlFlow::Continue(());
        read(&mut file, reading, &mut |event| {
            flow = match event {
                RecordingEvent::Channel(info) => {
                    let info = completed(info, description.as_ref());
                    pace.step = info.seconds_per_frame.unwrap_or(STEP);
                    match round {
                        0 => consumer(AcquireEvent::Channel(&info)),
                        _ => ControlFlow::Continue(()),
                    }
                }
                RecordingEvent::Frame(frame) => {
                    let time = frame.time;
                    let given_up = !options.once && pace.wait(time, stop, consumer).is_break();
                    if given_up || stop.load(Ordering::Relaxed) {
                        ControlFlow::Break(())
                    } else {
                        consumer(AcquireEvent::Frame { frame, time })
                    }
                }
                RecordingEvent::Note(note) => consumer(AcquireEvent::Note(note)),
            };
            flow
        })?;
        round += 1;
        if flow.is_break() || !options.repeat || consumer(AcquireEvent::Again).is_break() {
            return Ok(());
        }
    }
}

/// The description beside a recording. If something is wrong with it, that is noted, and it is left out; `Break` if no
/// more is wanted.
fn description_of(
    path: &Path,
    consumer: &mut Consumer<'_>,
) -> ControlFlow<(), Option<RecordingMetadata>> {
    match description_beside(path).transpose() {
        Ok(description) => ControlFlow::Continue(description),
        Err(complaint) => {
            let note = RecordingNote::Description { complaint };
            consumer(AcquireEvent::Note(&note))?;
            ControlFlow::Continue(None)
        }
    }
}

/// What a recording says of a channel, with what the description beside it says.
fn completed(info: &ChannelInfo, description: Option<&RecordingMetadata>) -> ChannelInfo {
    let mut info = info.clone();
    if let Some(description) = description {
        info.complete(description);
    }
    info
}
