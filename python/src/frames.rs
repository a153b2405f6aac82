//! Frames of real sensors: recordings, thresholds, live streams.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;
use taxel_core::frame::{
    Frame as CoreFrame, FrameError, FrameSize, Label, Processing, Rule, TareFrames, View,
};
use taxel_core::lock::locked;
use taxel_core::progress::stop_if;
use taxel_files::acquire::{
    AcquireEvent, AcquireOptions, FrameSource, Playback, acquire, metadata_beside,
};
use taxel_files::formats::recording::{
    ChannelChoice, ChannelInfo, Column, Format, ReadOptions, RecordingEvent, TimeColumn,
    read as read_recording,
};
use taxel_files::{ReadError, ReadErrorKind};

use crate::arrays::{TICK, interruptible, numbers, shaped, unread, warn, write, wrong, zeros};

/// The number or the text of a label.
#[derive(Clone, Debug, IntoPyObject)]
pub(crate) enum PyLabel {
    Number(i64),
    Text(String),
}

fn label(label: Label) -> PyLabel {
    match label {
        Label::Number(number) => PyLabel::Number(number),
        Label::Text(text) => PyLabel::Text(text),
    }
}

/// The size of frames, if it is given.
fn size(rows: Option<u16>, columns: Option<u16>) -> PyResult<Option<FrameSize>> {
    match (rows, columns) {
        (None, None) => Ok(None),
        (Some(rows), Some(columns)) => FrameSize::new(columns, rows).map(Some).map_err(wrong),
        _ => Err(wrong("rows and columns are given together")),
    }
}

fn parsed<T: std::str::FromStr<Err = String>>(
    text: Option<&str>,
    key: &str,
) -> PyResult<Option<T>> {
    let parsed = text.map(str::parse).transpose();
    parsed.map_err(|error| wrong(format!("{key}: {error}")))
}

/// Why a channel must be chosen among these.
fn several(names: &[String]) -> String {
    format!(
        "{} channels, choose one with channel=: {}",
        names.len(),
        names.join(", ")
    )
}

/// A recording of a real sensor; made by taxel.read.
#[pyclass(frozen, get_all, module = "taxel")]
#[derive(Debug)]
pub(crate) struct Recording {
    /// The values in the recording's unit: a float64 array, frames × rows × columns, NaN where there is no cell.
    frames: Py<PyArrayDyn<f64>>,
    /// The times in seconds: a float64 array, NaN for a frame without one; None if the recording has none.
    times: Option<Py<PyArray1<f64>>>,
    /// The labels: a list of int, str or None; None if the recording has none.
    labels: Option<Vec<Option<PyLabel>>>,
    /// The name of the channel, or None.
    channel: Option<String>,
    /// The unit of the values, or None.
    unit: Option<String>,
    /// The distance between cells along x and y in mm, or None.
    pitch: Option<(f64, f64)>,
    /// The recording's own threshold, or None.
    threshold: Option<f64>,
}

#[pymethods]
impl Recording {
    fn __len__(&self, py: Python<'_>) -> usize {
        self.frames.bind(py).shape()[0]
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let shape = self.frames.bind(py).shape().iter().map(usize::to_string);
        format!(
            "<taxel.Recording: {}>",
            shape.collect::<Vec<_>>().join(" × ")
        )
    }
}

/// The frames of one channel while they are read.
#[derive(Default)]
struct Gathered {
    info: ChannelInfo,
    size: Option<FrameSize>,
    values: Vec<f64>,
    times: Vec<f64>,
    labels: Vec<Option<Label>>,
    notes: Vec<String>,
}

impl Gathered {
    fn add(&mut self, frame: &CoreFrame) -> Result<(), String> {
        let (own, number) = (*self.size.get_or_insert(frame.size()), frame.number);
        if frame.size() != own {
            return Err(format!(
                "frame {number} is {}, the first one {own}",
                frame.size()
            ));
        }
        self.values.extend_from_slice(frame.values());
        self.times.push(frame.time.unwrap_or(f64::NAN));
        self.labels.push(frame.label.clone());
        Ok(())
    }

    fn recording(self, py: Python<'_>) -> PyResult<Recording> {
        let sides = self
            .size
            .map_or([0; 2], |own| [own.rows(), own.columns()].map(usize::from));
        let frames = shaped(py, self.values, &[self.times.len(), sides[0], sides[1]])?;
        let has_times = self.times.iter().any(|time| !time.is_nan());
        let has_labels = self.labels.iter().any(Option::is_some);
        Ok(Recording {
            frames: frames.unbind(),
            times: has_times.then(|| PyArray1::from_vec(py, self.times).unbind()),
            labels: has_labels.then(|| self.labels.into_iter().map(|own| own.map(label)).collect()),
            channel: self.info.name,
            unit: self.info.unit,
            pitch: self.info.pitch_mm.map(Into::into),
            threshold: self.info.threshold,
        })
    }
}

/// Reads a recording in any format of `taxel frames`: a Recording.
///
/// channel is the name of one of several channels; rows and columns are for a recording that does not state them;
/// time_column ("X" or "X:ms") and label_column name columns of a table, or count them from 1. Warns of oddities.
///
/// Raises OSError if the file cannot be read, ValueError if it is no recording, has several channels and none is chosen,
/// or is damaged; then the frames before the damage are error.recording.
#[pyfunction]
#[pyo3(signature = (path, *, channel=None, rows=None, columns=None, time_column=None, label_column=None))]
pub(crate) fn read(
    py: Python<'_>,
    path: PathBuf,
    channel: Option<&str>,
    rows: Option<u16>,
    columns: Option<u16>,
    time_column: Option<&str>,
    label_column: Option<&str>,
) -> PyResult<Recording> {
    let options = ReadOptions {
        size: size(rows, columns)?,
        time_column: parsed::<TimeColumn>(time_column, "time_column")?,
        label_column: parsed::<Column>(label_column, "label_column")?,
        ..ReadOptions::default()
    };
    let file = File::open(&path).map_err(|error| unread(&path, &error.into()))?;
    let metadata = metadata_beside(&path);
    let (metadata, complaint) =
        metadata.map_or_else(|error| (None, Some(error.to_string())), |own| (own, None));
    let mut gathered = Gathered::default();
    let mut choice = ChannelChoice::new(channel);
    let mut misfit = None;
    let done = interruptible(py, |stopped| {
        read_recording(&file, &options, &mut |event| {
            match event {
                RecordingEvent::Channel(info) => {
                    if choice.add(info) {
                        gathered.info = info.completed(metadata.as_ref());
                    }
                }
                RecordingEvent::Frame(frame) if choice.takes(frame.channel) => {
                    misfit = gathered.add(frame).err();
                }
                RecordingEvent::Note(note) if !note.is_plain() => {
                    gathered.notes.push(note.to_string())
                }
                _ => {}
            }
            stop_if(misfit.is_some() || stopped.load(Ordering::Relaxed))
        })
    })?;
    let name = path.display();
    if channel.is_none() && choice.names.len() > 1 {
        misfit = Some(several(&choice.names));
    }
    if let Some(why) = misfit.or(choice.missing()) {
        return Err(wrong(format!("{name}: {why}")));
    }
    for note in complaint.iter().chain(&gathered.notes) {
        warn(py, &format!("{name}: {note}"))?;
    }
    let is_empty = gathered.times.is_empty();
    let recording = gathered.recording(py)?;
    match done {
        Ok(_) if is_empty => Err(wrong(format!("{name}: no frames"))),
        Ok(_) => Ok(recording),
        Err(error) => {
            let refused = unread(&path, &sized(error));
            refused.value(py).setattr("recording", recording)?;
            Err(refused)
        }
    }
}

/// The same error, and what helps if the size of frames is not stated.
fn sized(mut error: ReadError) -> ReadError {
    if error.kind == ReadErrorKind::Unsized {
        error.message += "; give rows= and columns=";
    }
    error
}

/// The frames between two looks at whether to stop.
const CHUNK: usize = 256;

/// The imprints of frames: a bool array of their shape.
///
/// frames is an array of numbers, rows × columns up to 64 × 64, or frames × rows × columns; NaN is no cell, which is
/// never active. One rule: at_least, a value; percent of each frame's largest value; low and high, so that values of low
/// joined to one of high are active; or deviations of the tare's noise. Pieces of fewer than least taxels are dropped.
/// tare is taken off first: the median of each cell over these frames, or over the first ones if it is an int.
///
/// Raises ValueError without a rule or with two, and for numbers or sizes out of range.
#[pyfunction]
#[pyo3(signature = (frames, *, at_least=None, percent=None, low=None, high=None, deviations=None, least=0, tare=None))]
pub(crate) fn threshold<'py>(
    frames: &Bound<'py, PyAny>,
    at_least: Option<f64>,
    percent: Option<f64>,
    low: Option<f64>,
    high: Option<f64>,
    deviations: Option<f64>,
    least: u32,
    tare: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArrayDyn<bool>>> {
    let py = frames.py();
    let frames = numbers(frames, "frames")?;
    let (size, values) = (frame_size(frames.shape())?, frames.as_slice()?);
    let rule = match (at_least, percent, low, high, deviations) {
        (Some(least), None, None, None, None) => Rule::at_least(least),
        (None, Some(percent), None, None, None) => Rule::percent(percent),
        (None, None, Some(low), Some(high), None) => Rule::hysteresis(low, high),
        (None, None, None, None, Some(deviations)) => Rule::noise(deviations),
        _ => {
            return Err(wrong(
                "expected one rule: at_least, percent, both low and high, or deviations",
            ));
        }
    };
    let mut processing = Processing::default();
    processing.rule = Some(rule.map_err(wrong)?);
    processing.least = least;
    processing.tare = match tare {
        None => None,
        Some(tare) => match tare.extract::<u64>() {
            Ok(0) => None,
            Ok(count) => Some(tare_of(size, values, count)?),
            Err(_) => {
                let tare = numbers(tare, "tare")?;
                let (own, tare) = (frame_size(tare.shape())?, tare.as_slice()?);
                Some(tare_of(own, tare, (tare.len() / own.cells()) as u64)?)
            }
        },
    };
    let imprints = zeros::<bool>(py, frames.shape().to_vec())?;
    let mut cells = imprints.try_readwrite()?;
    let (cells, chunk) = (cells.as_slice_mut()?, CHUNK * size.cells());
    let done = interruptible(py, |stopped| {
        let start = || (processing.clone(), CoreFrame::new(size));
        let chunks = cells.par_chunks_mut(chunk).zip(values.par_chunks(chunk));
        chunks.try_for_each_init(start, |(processing, frame), (cells, values)| {
            for (cells, values) in cells
                .chunks_mut(size.cells())
                .zip(values.chunks(size.cells()))
            {
                frame.set_values(values)?;
                if let Some(imprint) = processing.run(frame)?.imprint {
                    write(&imprint, cells);
                }
            }
            let stopped = stopped.load(Ordering::Relaxed);
            if stopped {
                Err(FrameError::Invalid("stopped".to_owned()))
            } else {
                Ok(())
            }
        })
    });
    done?.map_err(wrong)?;
    Ok(imprints)
}

/// The size of frames in an array of this shape.
fn frame_size(shape: &[usize]) -> PyResult<FrameSize> {
    let side = |side: usize| u16::try_from(side).ok();
    let size = match shape {
        [rows, columns] | [_, rows, columns] => FrameSize::of_sides(side(*columns), side(*rows)),
        _ => None,
    };
    let expected = "expected frames × rows × columns, or rows × columns, of 1 to 512";
    size.ok_or_else(|| wrong(format!("an array shaped {shape:?}, {expected}")))
}

fn tare_of(size: FrameSize, values: &[f64], count: u64) -> PyResult<taxel_core::frame::Tare> {
    let mut tare = TareFrames::new(count);
    for values in values.chunks_exact(size.cells()) {
        if tare.missing() == 0 {
            break;
        }
        let frame = CoreFrame::from_values(size, values).map_err(wrong)?;
        tare.add(&frame, &View::default()).map_err(wrong)?;
    }
    tare.finish().map_err(wrong)
}

/// A frame of taxel.watch.
#[pyclass(frozen, get_all, module = "taxel")]
#[derive(Debug)]
pub(crate) struct Frame {
    /// The values in the sensor's unit: a float64 array, rows × columns, NaN where there is no cell.
    values: Py<PyArrayDyn<f64>>,
    /// The time in seconds: the frame's own, or that of its arrival since the first one; None if it is unknown.
    time: Option<f64>,
    /// The number of the frame, from 0.
    number: u64,
    /// The label, an int or a str, or None.
    label: Option<PyLabel>,
}

#[pymethods]
impl Frame {
    fn __repr__(&self, py: Python<'_>) -> String {
        let shape = self.values.bind(py).shape().iter().map(usize::to_string);
        format!(
            "<taxel.Frame {}: {}>",
            self.number,
            shape.collect::<Vec<_>>().join(" × ")
        )
    }
}

/// The most frames that wait until they are taken.
const WAITING: usize = 256;

type Arrived = Result<CoreFrame, PyErr>;

/// The frames of a source as they arrive; made by taxel.watch. It is an iterator, and a context that closes the source.
#[pyclass(frozen, module = "taxel")]
#[derive(Debug)]
pub(crate) struct Watch {
    name: String,
    arrived: Mutex<Receiver<Arrived>>,
    stop: Arc<AtomicBool>,
    dropped: Arc<AtomicU64>,
    thread: Mutex<Option<JoinHandle<()>>>,
}

/// Frames of a live sensor: an iterator of Frame.
///
/// source is a serial line, "tcp://HOST:PORT", a FIFO, a file that grows, or "-" for standard input; a recording is
/// played at its own rate. format is one of `taxel watch --format`, found by looking if not given; rows and columns are
/// for what does not state them; channel is one of several; baud is for serial lines (115200). With once, all that is
/// there is read as fast as possible; otherwise a connection that is lost is opened again. Frames that are torn or
/// garbled are left out and counted as dropped.
///
/// Waiting releases the interpreter and stops on Ctrl-C. Raises OSError if the source cannot be opened, ValueError if it
/// is of no known format or ends without a frame.
#[pyfunction]
#[pyo3(signature = (source, *, baud=None, format=None, rows=None, columns=None, channel=None, time_column=None, label_column=None, once=false))]
pub(crate) fn watch(
    source: PathBuf,
    baud: Option<u32>,
    format: Option<&str>,
    rows: Option<u16>,
    columns: Option<u16>,
    channel: Option<String>,
    time_column: Option<&str>,
    label_column: Option<&str>,
    once: bool,
) -> PyResult<Watch> {
    let options = AcquireOptions {
        format: match format {
            None | Some("auto") => None,
            Some(name) => Some(Format::of_stream(name).map_err(wrong)?),
        },
        size: size(rows, columns)?,
        time_column: parsed::<TimeColumn>(time_column, "time_column")?,
        label_column: parsed::<Column>(label_column, "label_column")?,
        channel,
        baud,
        playback: if once { Playback::Once } else { Playback::Live },
        ..AcquireOptions::default()
    };
    let found = FrameSource::new(&source);
    if let Some(baud) = baud.filter(|own| !AcquireOptions::BAUDS.contains(own)) {
        return Err(wrong(format!("baud {baud}: expected 50 to 20000000")));
    }
    if let Some(why) = baud.and_then(|_| found.unused_baud()) {
        return Err(wrong(format!("baud has no effect {why}")));
    }
    found.check().map_err(|error| unread(&source, &error))?;
    let (stop, dropped) = (
        Arc::new(AtomicBool::new(false)),
        Arc::new(AtomicU64::new(0)),
    );
    let (sender, arrived) = sync_channel(WAITING);
    let (name, own) = (found.name(), (Arc::clone(&stop), Arc::clone(&dropped)));
    let watched = move || watched(&found, &options, &sender, &own.0, &own.1);
    let thread = std::thread::Builder::new().spawn(watched)?;
    Ok(Watch {
        name,
        arrived: Mutex::new(arrived),
        stop,
        dropped,
        thread: Mutex::new(Some(thread)),
    })
}

/// Sends the frames of a source until it ends or is closed, and then the error, if there is one.
fn watched(
    source: &FrameSource,
    options: &AcquireOptions,
    sender: &SyncSender<Arrived>,
    stop: &AtomicBool,
    dropped: &AtomicU64,
) {
    let mut choice = ChannelChoice::new(options.channel.as_deref());
    let (mut refused, mut has_frame) = (None, false);
    let done = acquire(source, options, stop, &mut |event| {
        match event {
            AcquireEvent::Channel(info) => {
                choice.add(info);
                if options.channel.is_none() && choice.names.len() > 1 {
                    refused = Some(several(&choice.names));
                }
            }
            AcquireEvent::Frame { frame, time } if choice.takes(frame.channel) => {
                has_frame = true;
                let mut frame = frame.clone();
                frame.time = time;
                return stop_if(!send(sender, Ok(frame), stop));
            }
            AcquireEvent::Tick(counts) | AcquireEvent::Ended(counts) => {
                dropped.store(counts.dropped, Ordering::Relaxed);
                if matches!(event, AcquireEvent::Ended(_)) {
                    refused = counts.no_frame();
                }
            }
            _ => {}
        }
        stop_if(refused.is_some())
    });
    let name = source.name();
    let missing = || (!has_frame).then(|| choice.missing().unwrap_or("no frames".to_owned()));
    let error = match (done, refused) {
        (Err(error), _) => Some(unread(Path::new(&name), &sized(error))),
        (_, Some(why)) => Some(wrong(format!("{name}: {why}"))),
        _ if stop.load(Ordering::Relaxed) => None,
        _ => missing().map(|why| wrong(format!("{name}: {why}"))),
    };
    if let Some(error) = error {
        send(sender, Err(error), stop);
    }
}

/// Sends as soon as there is room. Returns false if nobody waits for it any more.
fn send(sender: &SyncSender<Arrived>, mut arrived: Arrived, stop: &AtomicBool) -> bool {
    loop {
        arrived = match sender.try_send(arrived) {
            Ok(()) => return true,
            Err(TrySendError::Full(arrived)) if !stop.load(Ordering::Relaxed) => arrived,
            Err(_) => return false,
        };
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[pymethods]
impl Watch {
    /// The number of frames that were torn, short, long or garbled so far.
    #[getter]
    fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }

    /// Closes the source; the iteration ends.
    fn close(&self, py: Python<'_>) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = locked(&self.thread).take() {
            // It has nothing left to say.
            let _ = py.detach(|| thread.join());
        }
    }

    fn __iter__(this: Bound<'_, Self>) -> Bound<'_, Self> {
        this
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Frame>> {
        loop {
            match py.detach(|| locked(&self.arrived).recv_timeout(TICK)) {
                Ok(arrived) => {
                    let frame = arrived?;
                    let sides = [frame.rows(), frame.columns()].map(usize::from);
                    return Ok(Some(Frame {
                        values: shaped(py, frame.values().to_vec(), &sides)?.unbind(),
                        time: frame.time,
                        number: frame.number,
                        label: frame.label.map(label),
                    }));
                }
                Err(RecvTimeoutError::Timeout) => py.check_signals()?,
                Err(RecvTimeoutError::Disconnected) => return Ok(None),
            }
        }
    }

    fn __enter__(this: Bound<'_, Self>) -> Bound<'_, Self> {
        this
    }

    fn __exit__(
        &self,
        py: Python<'_>,
        _kind: &Bound<'_, PyAny>,
        _value: &Bound<'_, PyAny>,
        _trace: &Bound<'_, PyAny>,
    ) {
        self.close(py);
    }

    fn __repr__(&self) -> String {
        format!("<taxel.Watch: {}>", self.name)
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}
