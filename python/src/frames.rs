//! Frames of real sensors: recordings, thresholds, live streams.

use std::fs::File;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex};

use numpy::prelude::*;
use numpy::{PyArray1, PyReadonlyArray3, PyReadwriteArray3};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use pythonize::pythonize;
use taxel_core::frame::{Frame, FrameSize, Processing, Rule, TareFrames, View};
use taxel_core::lock::locked;
use taxel_core::progress::stop_if;
use taxel_files::ReadError;
use taxel_files::acquire::{
    AcquireEvent, AcquireOptions, FrameSource, Playback, acquire, metadata_beside,
};
use taxel_files::formats::recording::{
    ChannelChoice, ChannelInfo, Format, RecordingEvent, read as read_recording,
};

use crate::arrays::{TICK, fill_each, interruptible, shaped, write};
use crate::failure::{Failure, Result};

/// How frames are read, by the keywords of `read` and `watch`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Reading {
    channel: Option<String>,
    rows: Option<u16>,
    columns: Option<u16>,
    time_column: Option<String>,
    label_column: Option<String>,
}

impl Reading {
    fn options(self) -> Result<AcquireOptions> {
        if self.rows.is_some() != self.columns.is_some() {
            return Err("rows and columns are given together".into());
        }
        let size = self.columns.zip(self.rows);
        let size = size.map(|(columns, rows)| FrameSize::new(columns, rows));
        Ok(AcquireOptions {
            size: size.transpose()?,
            channel: self.channel,
            time_column: self.time_column.map(|own| own.parse()).transpose()?,
            label_column: self.label_column.map(|own| own.parse()).transpose()?,
            ..AcquireOptions::default()
        })
    }
}

/// Why the frames of a channel cannot be told, if one must be chosen or is missing.
fn unchosen(options: &AcquireOptions, choice: &ChannelChoice) -> Option<String> {
    let (count, names) = (choice.names.len(), choice.names.join(", "));
    let several = format!("{count} channels, choose one with channel=: {names}");
    let is_chosen = options.channel.is_some() || count < 2;
    choice.missing().or((!is_chosen).then_some(several))
}

/// Returns the parts of a Recording, notes, and the error at which it is damaged.
#[pyfunction]
pub(crate) fn read(py: Python<'_>, path: PathBuf, reading: Reading) -> Result<Bound<'_, PyTuple>> {
    let options = reading.options()?;
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
    let is_empty = times.is_empty() && done.is_ok();
    let refused = misfit.or(unchosen(&options, &choice));
    if let Some(why) = refused.or(is_empty.then(|| "no frames".to_owned())) {
        return Err(Failure::of(path, ReadError::new(why)));
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
        done.err()
            .map(|error| PyErr::from(Failure::of(&path, error))),
    );
    Ok(parts.into_pyobject(py)?)
}

/// The rule is `at_least`, percent, low, high, deviations.
#[pyfunction]
pub(crate) fn threshold(
    py: Python<'_>,
    frames: PyReadonlyArray3<'_, f64>,
    rule: [Option<f64>; 5],
    least: u32,
    tare: Option<PyReadonlyArray3<'_, f64>>,
    mut imprints: PyReadwriteArray3<'_, bool>,
) -> Result<()> {
    let (size, values) = (frame_size(&frames)?, frames.as_slice()?);
    let mut processing = Processing::default();
    processing.least = least;
    processing.rule = Some(match rule {
        [Some(least), None, None, None, None] => Rule::at_least(least)?,
        [None, Some(percent), None, None, None] => Rule::percent(percent)?,
        [None, None, Some(low), Some(high), None] => Rule::hysteresis(low, high)?,
        [None, None, None, None, Some(deviations)] => Rule::noise(deviations)?,
        _ => Err("expected one rule: at_least, percent, both low and high, or deviations")?,
    });
    if let Some(tare) = tare {
        let (size, values) = (frame_size(&tare)?, tare.as_slice()?);
        let mut made = TareFrames::new((values.len() / size.cells()) as u64);
        for values in values.chunks(size.cells()) {
            made.add(&Frame::from_values(size, values)?, &View::default())?;
        }
        processing.tare = Some(made.finish()?);
    }
    let start = || (processing.clone(), Frame::new(size));
    let parts = (imprints.as_slice_mut()?, size.cells());
    fill_each(py, parts, start, |(processing, frame), index, cells| {
        frame.set_values(&values[index * cells.len()..][..cells.len()])?;
        if let Some(imprint) = processing.run(frame)?.imprint {
            write(&imprint, cells);
        }
        Ok(())
    })
}

/// The size of the frames in an array.
fn frame_size(frames: &PyReadonlyArray3<'_, f64>) -> Result<FrameSize> {
    let [rows, columns] = [1, 2].map(|axis| u16::try_from(frames.shape()[axis]));
    Ok(FrameSize::new(columns?, rows?)?)
}

/// The frames of a source; those that arrive wait until they are taken.
#[pyclass(frozen, subclass, module = "taxel._taxel")]
pub(crate) struct Watch {
    arrived: Mutex<Receiver<Result<Frame>>>,
    /// Whether it is to end, and the number of frames that were dropped.
    state: Arc<(AtomicBool, AtomicU64)>,
}

/// Sends the frames of a source until it ends or is closed, and says why it has failed.
fn watched(
    source: &FrameSource,
    options: &AcquireOptions,
    sender: &SyncSender<Result<Frame>>,
    (stop, dropped): &(AtomicBool, AtomicU64),
) -> Result<()> {
    let mut choice = ChannelChoice::new(options.channel.as_deref());
    let (mut refused, mut has_frame) = (None, false);
    let done = acquire(source, options, stop, &mut |event| {
        match event {
            AcquireEvent::Channel(info) => {
                choice.add(info);
                // One that is asked for may come later.
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
    let is_empty = !has_frame && !stop.load(Ordering::Relaxed);
    let missing = is_empty.then(|| choice.missing().unwrap_or("no frames".to_owned()));
    let refused = refused.or(missing).map(ReadError::new);
    refused.map_or(Ok(()), |error| Err(Failure::of(name, error)))
}

#[pymethods]
impl Watch {
    #[new]
    fn new(
        source: PathBuf,
        reading: Reading,
        format: Option<&str>,
        baud: Option<u32>,
        once: bool,
    ) -> Result<Self> {
        let options = AcquireOptions {
            format: format.map(Format::of_stream).transpose()?,
            baud,
            playback: if once { Playback::Once } else { Playback::Live },
            ..reading.options()?
        };
        let source = FrameSource::new(&source);
        if let Some(why) = baud.and_then(|_| source.unused_baud()) {
            return Err(format!("baud has no effect {why}").into());
        }
        let checked = source.check();
        checked.map_err(|error| Failure::of(source.name(), error))?;
        let (sender, arrived) = sync_channel(256);
        let state = Arc::<(AtomicBool, AtomicU64)>::default();
        let own = Arc::clone(&state);
        std::thread::spawn(move || {
            if let Err(failure) = watched(&source, &options, &sender, &own) {
                // It may be that nobody waits any more.
                let _ = sender.send(Err(failure));
            }
        });
        let arrived = Mutex::new(arrived);
        Ok(Self { arrived, state })
    }

    /// Returns the parts of a Frame; None at the end.
    fn __next__<'py>(&self, py: Python<'py>) -> Result<Option<Bound<'py, PyTuple>>> {
        loop {
            match py.detach(|| locked(&self.arrived).recv_timeout(TICK)) {
                Ok(arrived) => {
                    let frame = arrived?;
                    let sides = [frame.rows(), frame.columns()].map(usize::from);
                    let values = shaped(py, frame.values().to_vec(), &sides)?;
                    let label = pythonize(py, &frame.label)?;
                    let parts = (values, frame.time, frame.number, label);
                    return Ok(Some(parts.into_pyobject(py)?));
                }
                Err(RecvTimeoutError::Timeout) => py.check_signals()?,
                Err(RecvTimeoutError::Disconnected) => return Ok(None),
            }
        }
    }

    /// The number of frames that were torn, short, long or garbled so far.
    #[getter]
    fn dropped(&self) -> u64 {
        self.state.1.load(Ordering::Relaxed)
    }

    /// Closes the source; the iteration ends.
    fn close(&self, py: Python<'_>) {
        self.state.0.store(true, Ordering::Relaxed);
        // The thread that sends lets go of the source, then of the channel.
        py.detach(|| while locked(&self.arrived).recv().is_ok() {});
    }
}
