//! Frames of real sensors: recordings, thresholds, live streams.

use std::fs::File;
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

use numpy::prelude::*;
use numpy::{PyArray1, PyArrayDyn, PyReadonlyArray3};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use pythonize::{depythonize, pythonize};
use rayon::prelude::*;
use taxel_core::frame::{Frame, FrameError, FrameSize, Processing, Rule, TareFrames, View};
use taxel_core::lock::locked;
use taxel_core::progress::stop_if;
use taxel_files::acquire::{
    AcquireEvent, AcquireOptions, FrameSource, Playback, acquire, metadata_beside,
};
use taxel_files::formats::recording::{
    ChannelChoice, ChannelInfo, Format, RecordingEvent, read as read_recording,
};

use crate::arrays::{TICK, filled, interruptible, shaped, write};
use crate::failure::{Failure, Result};

/// How frames are read, by the keywords of `read` and `watch`.
#[derive(serde::Deserialize)]
struct Reading {
    channel: Option<String>,
    rows: Option<u16>,
    columns: Option<u16>,
    time: Option<String>,
    label: Option<String>,
}

impl Reading {
    fn options(given: &Bound<'_, PyAny>) -> Result<AcquireOptions> {
        fn column<T: FromStr<Err = String>>(key: &str, text: Option<&str>) -> Result<Option<T>> {
            let parsed = text.map(str::parse).transpose();
            parsed.map_err(|error| Failure::new(format!("{key}_column: {error}")))
        }
        let own: Self = depythonize(given)?;
        let size = match (own.rows, own.columns) {
            (None, None) => None,
            (Some(rows), Some(columns)) => Some(FrameSize::new(columns, rows)?),
            _ => return Err(Failure::new("rows and columns are given together")),
        };
        Ok(AcquireOptions {
            size,
            channel: own.channel,
            time_column: column("time", own.time.as_deref())?,
            label_column: column("label", own.label.as_deref())?,
            ..AcquireOptions::default()
        })
    }
}

/// Why the frames of a channel cannot be told, if one must be chosen or is missing.
fn unchosen(options: &AcquireOptions, choice: &ChannelChoice) -> Option<String> {
    let names = &choice.names;
    if options.channel.is_none() && names.len() > 1 {
        let (count, names) = (names.len(), names.join(", "));
        return Some(format!(
            "{count} channels, choose one with channel=: {names}"
        ));
    }
    choice.missing()
}

/// Returns the parts of a Recording, notes, and the error at which it is damaged.
#[pyfunction]
pub(crate) fn read<'py>(path: PathBuf, reading: &Bound<'py, PyAny>) -> Result<Bound<'py, PyTuple>> {
    let (py, options) = (reading.py(), Reading::options(reading)?);
    let refused = |why: String| Failure::new(format!("{}: {why}", path.display()));
    let file = File::open(&path).map_err(|error| Failure::of(&path, error))?;
    let (metadata, mut notes) = match metadata_beside(&path) {
        Ok(metadata) => (metadata, Vec::new()),
        Err(error) => (None, vec![error.to_string()]),
    };
    let mut choice = ChannelChoice::new(options.channel.as_deref());
    let (mut info, mut size, mut misfit) = (ChannelInfo::default(), None, None);
    let (mut values, mut times, mut labels) = (Vec::new(), Vec::new(), Vec::new());
    let done = interruptible(py, |stopped| {
        read_recording(&file, &options.of_recording(), &mut |event| {
            match event {
                RecordingEvent::Channel(own) if choice.add(own) => {
                    info = own.completed(metadata.as_ref());
                }
                RecordingEvent::Frame(frame) if choice.takes(frame.channel) => {
                    let (own, first) = (frame.size(), *size.get_or_insert(frame.size()));
                    if own != first {
                        let number = frame.number;
                        misfit = Some(format!("frame {number} is {own}, the first one {first}"));
                    }
                    values.extend_from_slice(frame.values());
                    times.push(frame.time.unwrap_or(f64::NAN));
                    labels.push(frame.label.clone());
                }
                RecordingEvent::Note(note) if !note.is_plain() => notes.push(note.to_string()),
                _ => {}
            }
            stop_if(misfit.is_some() || stopped.load(Ordering::Relaxed))
        })
    })?;
    if let Some(why) = misfit.or(unchosen(&options, &choice)) {
        return Err(refused(why));
    }
    if times.is_empty() && done.is_ok() {
        return Err(refused("no frames".to_owned()));
    }
    let sides = size.map_or([0; 2], |own| [own.rows(), own.columns()].map(usize::from));
    let has_times = times.iter().any(|time| !time.is_nan());
    let has_labels = labels.iter().any(Option::is_some);
    let parts = (
        shaped(py, values, &[times.len(), sides[0], sides[1]])?,
        has_times.then(|| PyArray1::from_vec(py, times)),
        has_labels.then(|| pythonize(py, &labels)).transpose()?,
        info.name,
        info.unit,
        info.pitch_mm.map(|[x, y]| (x, y)),
        info.threshold,
        notes,
        done.err().map(|error| Failure::of(&path, error).0),
    );
    Ok(parts.into_pyobject(py)?)
}

/// The frames between two looks at whether to stop.
const CHUNK: usize = 256;

/// The rule is `at_least`, percent, low, high, deviations.
#[pyfunction]
pub(crate) fn threshold<'py>(
    py: Python<'py>,
    frames: PyReadonlyArray3<'py, f64>,
    rule: [Option<f64>; 5],
    least: u32,
    tare: Option<PyReadonlyArray3<'py, f64>>,
) -> Result<Bound<'py, PyArrayDyn<bool>>> {
    let (size, values) = (frame_size(&frames)?, frames.as_slice()?);
    let mut processing = Processing::default();
    processing.least = least;
    processing.rule = Some(match rule {
        [Some(least), None, None, None, None] => Rule::at_least(least)?,
        [None, Some(percent), None, None, None] => Rule::percent(percent)?,
        [None, None, Some(low), Some(high), None] => Rule::hysteresis(low, high)?,
        [None, None, None, None, Some(deviations)] => Rule::noise(deviations)?,
        _ => {
            let text = "expected one rule: at_least, percent, both low and high, or deviations";
            return Err(Failure::new(text));
        }
    });
    if let Some(tare) = tare {
        let (size, values) = (frame_size(&tare)?, tare.as_slice()?);
        let mut made = TareFrames::new((values.len() / size.cells()) as u64);
        for values in values.chunks(size.cells()) {
            made.add(&Frame::from_values(size, values)?, &View::default())?;
        }
        processing.tare = Some(made.finish()?);
    }
    filled(py, frames.shape(), |cells| {
        let own = size.cells();
        interruptible(py, |stopped| {
            let start = || (processing.clone(), Frame::new(size));
            let chunks = cells.par_chunks_mut(CHUNK * own);
            let chunks = chunks.zip(values.par_chunks(CHUNK * own));
            chunks.try_for_each_init(start, |(processing, frame), (cells, values)| {
                for (cells, values) in cells.chunks_mut(own).zip(values.chunks(own)) {
                    frame.set_values(values)?;
                    if let Some(imprint) = processing.run(frame)?.imprint {
                        write(&imprint, cells);
                    }
                }
                let goes_on = !stopped.load(Ordering::Relaxed);
                let stopped = || FrameError::Invalid("stopped".to_owned());
                goes_on.then_some(()).ok_or_else(stopped)
            })
        })??;
        Ok(())
    })
}

/// The size of the frames in an array.
fn frame_size(frames: &PyReadonlyArray3<'_, f64>) -> Result<FrameSize> {
    let [rows, columns] = [1, 2].map(|axis| u16::try_from(frames.shape()[axis]));
    Ok(FrameSize::new(columns?, rows?)?)
}

/// The most frames that wait until they are taken.
const WAITING: usize = 256;

/// What a Watch holds.
#[pyclass(frozen)]
pub(crate) struct Watch {
    /// None once it is closed.
    arrived: Mutex<Option<Receiver<Result<Frame>>>>,
    thread: Mutex<Option<JoinHandle<()>>>,
    stop: Arc<AtomicBool>,
    dropped: Arc<AtomicU64>,
}

/// Sends the frames of a source until it ends or is closed, and says why it has failed.
fn watched(
    source: &FrameSource,
    options: &AcquireOptions,
    sender: &SyncSender<Result<Frame>>,
    (stop, dropped): (&AtomicBool, &AtomicU64),
) -> Result<()> {
    let mut choice = ChannelChoice::new(options.channel.as_deref());
    let (mut refused, mut has_frame) = (None, false);
    let done = acquire(source, options, stop, &mut |event| {
        match event {
            AcquireEvent::Channel(info) => {
                choice.add(info);
                refused = unchosen(options, &choice).filter(|_| options.channel.is_none());
            }
            AcquireEvent::Frame { frame, time } if choice.takes(frame.channel) => {
                has_frame = true;
                let mut frame = frame.clone();
                frame.time = time;
                return stop_if(sender.send(Ok(frame)).is_err());
            }
            AcquireEvent::Tick(counts) | AcquireEvent::Ended(counts) => {
                dropped.store(counts.dropped, Ordering::Relaxed);
            }
            _ => {}
        }
        stop_if(refused.is_some())
    });
    let name = source.name();
    done.map_err(|error| Failure::of(&name, error))?;
    if !has_frame && !stop.load(Ordering::Relaxed) {
        refused = refused
            .or(choice.missing())
            .or(Some("no frames".to_owned()));
    }
    let refused = refused.map(|why| Failure::new(format!("{name}: {why}")));
    refused.map_or(Ok(()), Err)
}

#[pymethods]
impl Watch {
    #[new]
    fn new(
        source: PathBuf,
        reading: &Bound<'_, PyAny>,
        format: Option<&str>,
        baud: Option<u32>,
        once: bool,
    ) -> Result<Self> {
        let format = format.filter(|name| *name != "auto");
        let options = AcquireOptions {
            format: format.map(Format::of_stream).transpose()?,
            baud,
            playback: if once { Playback::Once } else { Playback::Live },
            ..Reading::options(reading)?
        };
        let source = FrameSource::new(&source);
        if let Some(why) = baud.and_then(|_| source.unused_baud()) {
            return Err(Failure::new(format!("baud has no effect {why}")));
        }
        let checked = source.check();
        checked.map_err(|error| Failure::of(source.name(), error))?;
        let (stop, dropped) = (Arc::<AtomicBool>::default(), Arc::<AtomicU64>::default());
        let (sender, arrived) = sync_channel(WAITING);
        let own = (Arc::clone(&stop), Arc::clone(&dropped));
        let thread = std::thread::Builder::new().spawn(move || {
            if let Err(failure) = watched(&source, &options, &sender, (&own.0, &own.1)) {
                // It may be that nobody waits any more.
                let _ = sender.send(Err(failure));
            }
        })?;
        Ok(Self {
            arrived: Mutex::new(Some(arrived)),
            thread: Mutex::new(Some(thread)),
            stop,
            dropped,
        })
    }

    /// Returns the parts of a Frame; None at the end.
    fn next<'py>(&self, py: Python<'py>) -> Result<Option<Bound<'py, PyTuple>>> {
        loop {
            let next = || {
                let arrived = locked(&self.arrived);
                arrived.as_ref().map(|own| own.recv_timeout(TICK))
            };
            match py.detach(next) {
                Some(Ok(arrived)) => {
                    let frame = arrived?;
                    let sides = [frame.rows(), frame.columns()].map(usize::from);
                    let values = shaped(py, frame.values().to_vec(), &sides)?;
                    let label = pythonize(py, &frame.label)?;
                    let parts = (values, frame.time, frame.number, label);
                    return Ok(Some(parts.into_pyobject(py)?));
                }
                Some(Err(RecvTimeoutError::Timeout)) => py.check_signals()?,
                Some(Err(RecvTimeoutError::Disconnected)) | None => return Ok(None),
            }
        }
    }

    fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }

    fn close(&self, py: Python<'_>) {
        py.detach(|| {
            self.stop.store(true, Ordering::Relaxed);
            *locked(&self.arrived) = None;
            // It has nothing left to say.
            let _ = locked(&self.thread).take().map(JoinHandle::join);
        });
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}
