//! Opens recordings: files, or standard input; a pipe is copied to a temporary file because a recording is read
//! several times.

use std::fmt::{self, Debug};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::ops::ControlFlow;
use std::os::fd::AsFd;
use std::os::unix::fs::FileExt;
use std::path::Path;

use taxel_core::frame::{Frame, FrameError, Peak, Processing, Rule, SetRule, TareFrames, View};
use taxel_core::imprint::Imprint;
use taxel_core::matrix::Matrix;
use taxel_core::sensor::MatrixSize;
use taxel_files::acquire::metadata_beside;
use taxel_files::formats::file::system_reason;
use taxel_files::formats::recording::{
    ChannelInfo, Format, ReadOptions, RecordingEvent, RecordingMetadata, format_of, read, read_rows,
};
use taxel_files::storage::FileId;
use taxel_files::{ReadError, ReadErrorKind};

use crate::cli::arguments::frames::ProcessingArguments;
use crate::cli::error::{CliError, frame_advice};
use crate::cli::input::content::{self, Input, InputSource};
use crate::cli::output::recording_list::ListedChannel;

/// The most bytes that are read of a table. A table of 64 × 64 factors is much smaller.
const LARGEST_TABLE: u64 = 1 << 20;

#[derive(Debug)]
pub(crate) struct RecordingFile {
    name: String,
    file: Box<dyn ReadAgain>,
    /// The file that holds the content, so that it is not replaced.
    id: FileId,
    options: ReadOptions,
    metadata: Option<RecordingMetadata>,
    complaint: Option<String>,
    /// Whether the recording is known to be damaged, so that the damage is not reported again.
    is_damaged: bool,
}

impl RecordingFile {
    pub(crate) fn open(path: &Path, options: ReadOptions) -> Result<Self, CliError> {
        let source = InputSource::of(path);
        let name = source.name();
        let opened = || -> io::Result<(FileId, Box<dyn ReadAgain>)> {
            if source == InputSource::Standard {
                let input = content::standard()?;
                let file = File::from(input.as_fd().try_clone_to_owned()?);
                let id = FileId::of(&file)?;
                // A file is read again from its beginning, so that must be where the shell has it.
                let is_whole = file.metadata()?.is_file() && (&file).stream_position()? == 0;
                return Ok((
                    id,
                    if is_whole {
                        Box::new(file)
                    } else {
                        spooled(input)?
                    },
                ));
            }
            let file = File::open(path)?;
            let id = FileId::of(&file)?;
            // A pipe cannot be read twice.
            if file.metadata()?.is_file() || file.metadata()?.is_dir() {
                Ok((id, Box::new(file)))
            } else {
                Ok((id, spooled(file)?))
            }
        };
        let (metadata, complaint) = match metadata_beside(path) {
            Ok(metadata) => {
                let complaint = metadata.as_ref().and_then(|own| unended(path, own));
                (metadata, complaint)
            }
            Err(error) => (None, Some(error.to_string())),
        };
        match opened() {
            Ok((id, file)) => Ok(Self {
                name,
                file,
                id,
                options,
                metadata,
                complaint,
                is_damaged: false,
            }),
            Err(error) => Err(CliError::Input {
                name,
                error: error.into(),
            }),
        }
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Refuses to write to the recording, under any path: a recording cannot be made again.
    pub(crate) fn refuse_as_target(&self, target: &Path) -> Result<(), CliError> {
        match FileId::behind(target) {
            Ok(id) if id == self.id => Err(CliError::Frames {
                name: target.to_string_lossy().into_owned(),
                message: "is the recording being read; export to another file".to_owned(),
            }),
            _ => Ok(()),
        }
    }

    pub(crate) fn prefix_name(&mut self, flag: &str) {
        self.name.insert_str(0, flag);
    }

    pub(crate) fn complaint(&self) -> Option<&str> {
        self.complaint.as_deref()
    }

    pub(crate) fn read(
        &mut self,
        sink: &mut dyn FnMut(RecordingEvent<'_>) -> ControlFlow<()>,
    ) -> Result<&'static Format, ReadError> {
        let metadata = self.metadata.as_ref();
        read(&mut self.file, &self.options, &mut |event| match event {
            RecordingEvent::Channel(info) => {
                sink(RecordingEvent::Channel(&info.completed(metadata)))
            }
            event => sink(event),
        })
    }

    pub(crate) fn read_table(
        &mut self,
        sink: &mut dyn FnMut(RecordingEvent<'_>) -> ControlFlow<()>,
    ) -> Result<(), ReadError> {
        self.file.seek(SeekFrom::Start(0))?;
        let mut bytes = Vec::new();
        Read::by_ref(&mut self.file)
            .take(LARGEST_TABLE)
            .read_to_end(&mut bytes)?;
        read_rows(&bytes, sink)
    }

    pub(crate) fn remember_damage(&mut self) {
        self.is_damaged = true;
    }

    /// Reads the frames of a channel from the beginning of the recording again, until `take` breaks or fails. The
    /// inner result has the error of `take`.
    pub(crate) fn frames_again<E>(
        &mut self,
        channel: usize,
        mut take: impl FnMut(&Frame) -> Result<ControlFlow<()>, E>,
    ) -> Result<Result<(), E>, CliError> {
        let mut taken = Ok(());
        let read = self.read(&mut |event| match event {
            RecordingEvent::Frame(frame) if frame.channel == channel => {
                take(frame).unwrap_or_else(|error| {
                    taken = Err(error);
                    ControlFlow::Break(())
                })
            }
            _ => ControlFlow::Continue(()),
        });
        match read {
            Err(error) if taken.is_ok() && !self.is_damaged => Err(self.damaged(error)),
            _ => Ok(taken),
        }
    }

    pub(crate) fn channel_names(&mut self, up_to: Option<&str>) -> (Vec<String>, bool) {
        let mut names = Vec::new();
        let read = self.read(&mut |event| {
            if let RecordingEvent::Channel(info) = event {
                names.push(info.shown_name().to_owned());
                if up_to == Some(info.shown_name()) {
                    return ControlFlow::Break(());
                }
            }
            ControlFlow::Continue(())
        });
        (names, read.is_ok())
    }

    pub(crate) fn format(&mut self) -> Option<&'static Format> {
        self.file.seek(SeekFrom::Start(0)).ok()?;
        format_of(&mut self.file, &self.options).ok()
    }

    pub(crate) fn damaged(&self, error: ReadError) -> CliError {
        CliError::Recording {
            name: self.name.clone(),
            error,
        }
    }

    pub(crate) fn refused(&self, message: &(impl ToString + ?Sized)) -> CliError {
        CliError::Frames {
            name: self.name.clone(),
            message: message.to_string(),
        }
    }
}

pub(crate) fn dead_cells(path: &Path) -> Result<Imprint, CliError> {
    let mut input = Input::open(path).map_err(|failure| failure.of_flag("--mask"))?;
    input.name.insert_str(0, "--mask ");
    Ok(*input.content()?.imprint())
}

fn unended(path: &Path, metadata: &RecordingMetadata) -> Option<String> {
    let beside = path.with_extension("json");
    let beside = beside.display();
    if metadata.ended == Some(false) {
        return Some(format!(
            "{beside}: has no end: still being recorded, or the program was killed; the last half second may be missing"
        ));
    }
    let reason = metadata.ended_by.as_ref()?;
    Some(format!("{beside}: the recording ended early: {reason}"))
}

trait ReadAgain: Read + Seek + Debug {}

impl<T: Read + Seek + Debug> ReadAgain for T {}

fn spooled(input: impl Read + 'static) -> io::Result<Box<dyn ReadAgain>> {
    Ok(Box::new(SpooledInput::new(input)?))
}

/// The most that is copied, in bytes, so that an endless input does not fill the disk.
const MOST: u64 = 4 << 30;

pub(crate) struct SpooledInput {
    /// The input that has not been read yet; None at its end.
    rest: Option<Box<dyn Read>>,
    copy: File,
    /// The length of the copy, in bytes.
    length: u64,
    /// The position at which reading continues, in bytes.
    place: u64,
    /// The most that is copied, in bytes.
    most: u64,
}

impl SpooledInput {
    pub(crate) fn new(input: impl Read + 'static) -> io::Result<Self> {
        Ok(Self {
            rest: Some(Box::new(input)),
            copy: tempfile::tempfile().map_err(|error| not_copied(&error))?,
            length: 0,
            place: 0,
            most: MOST,
        })
    }

    fn advance(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let Some(rest) = &mut self.rest else {
            return Ok(0);
        };
        let count = rest.read(bytes)?;
        if count == 0 && !bytes.is_empty() {
            self.rest = None;
        }
        let copied = self.copy.write_all_at(&bytes[..count], self.length);
        copied.map_err(|error| not_copied(&error))?;
        self.length += count as u64;
        if self.length > self.most {
            return Err(io::Error::other(
                "more than 4 GiB; save it to a file and read that, or use taxel watch for endless input",
            ));
        }
        Ok(count)
    }
}

fn not_copied(error: &io::Error) -> io::Error {
    let folder = std::env::temp_dir();
    let text = format!(
        "cannot keep a copy in {} (TMPDIR): {}",
        folder.display(),
        system_reason(error)
    );
    io::Error::new(error.kind(), text)
}

impl Debug for SpooledInput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SpooledInput")
            .field("length", &self.length)
            .field("place", &self.place)
            .finish_non_exhaustive()
    }
}

impl Read for SpooledInput {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = if self.place < self.length {
            self.copy.read_at(bytes, self.place)?
        } else {
            self.advance(bytes)?
        };
        self.place += count as u64;
        Ok(count)
    }
}

impl Seek for SpooledInput {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let present = self.place;
        let place = |length: u64| match to {
            SeekFrom::Start(place) => Some(place),
            SeekFrom::Current(by) => present.checked_add_signed(by),
            SeekFrom::End(by) => length.checked_add_signed(by),
        };
        let mut wanted = place(self.length);
        let mut bytes = vec![0; 1 << 16];
        while self.rest.is_some()
            && (matches!(to, SeekFrom::End(_)) || wanted.is_some_and(|to| to > self.length))
        {
            self.advance(&mut bytes)?;
            wanted = place(self.length);
        }
        self.place = wanted.ok_or(io::ErrorKind::InvalidInput)?;
        Ok(self.place)
    }
}

/// Returns the processing of the flags, without tare and rule, which need the recording. Crop, flips, turn and mask
/// are applied in this order, then the tare, then the gain.
pub(crate) fn processing(asked: &ProcessingArguments) -> Result<Processing, CliError> {
    let mut processing = Processing::default();
    processing.view = View {
        mask: asked.mask.as_deref().map(dead_cells).transpose()?,
        ..asked.view.clone()
    };
    if let Some(path) = &asked.gain {
        processing.gain = Some(gain(path)?);
    }
    Ok(processing)
}

/// Reads a table of factors, in any format of recordings with one frame. Reading stops at a second frame, which is an
/// error. The table must have the size of the cropped frames, which is checked when the first of them is processed.
fn gain(path: &Path) -> Result<Matrix<f64>, CliError> {
    let opened = RecordingFile::open(path, ReadOptions::default());
    let mut file = opened.map_err(|error| error.of_flag("--gain"))?;
    file.prefix_name("--gain ");
    let mut gain = Matrix::filled(MatrixSize::SMALLEST, 1.0);
    let (mut found, mut is_recording) = (None, false);
    let mut take = |event: RecordingEvent<'_>| {
        if let RecordingEvent::Frame(frame) = event {
            // Of a second frame, only its existence matters.
            is_recording = found.is_some();
            found.get_or_insert_with(|| View::default().apply_to(frame, &mut gain));
        }
        if is_recording {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let read = match file.read(&mut take) {
        // Either each line was read as a frame; or the file did not look like a table, because a single column has no
        // separators. In both cases it is one table of factors.
        Err(error)
            if matches!(
                error.kind,
                ReadErrorKind::Unsized | ReadErrorKind::UnknownFormat
            ) =>
        {
            match file.read_table(&mut take) {
                Err(table) if table.kind == ReadErrorKind::UnknownFormat => Err(error),
                read => read,
            }
        }
        read => read.map(drop),
    };
    read.map_err(|error| match error {
        error if error.kind == ReadErrorKind::Unsized => {
            file.refused(&"expected a table: a line for each row")
        }
        error => file.damaged(error),
    })?;
    if is_recording {
        return Err(file.refused(&"a recording of several frames, expected a table of factors"));
    }
    let found = found.ok_or_else(|| file.refused(&"no frame, expected a table of factors"))?;
    found.map_err(|error| file.refused(&error))?;
    Ok(gain)
}

/// Returns the rule of the flags, or else that of the recording. A recording's threshold is the one with which its
/// maker's program draws pictures; values that reach it are active. There is no default: the meaning of values differs from
/// sensor to sensor.
pub(crate) fn rule(
    recording: &RecordingFile,
    asked: &ProcessingArguments,
    info: &ChannelInfo,
) -> Result<SetRule, CliError> {
    let own = asked.set_rule().or_else(|| info.own_rule(asked.least));
    own.ok_or_else(|| {
        recording.refused(
            "the recording has no threshold of its own: set one with --at-least, --percent, \
             --low and --high, or --deviations",
        )
    })
}

/// Returns the message that the recording's tare is not used, because its size differs from that of the visible part
/// of the frames. None if it is used, if the flags set a tare, or if the recording has none.
pub(crate) fn unused_tare(
    asked: &ProcessingArguments,
    info: &ChannelInfo,
    view: &View,
) -> Option<String> {
    if asked.tare.is_some() || info.tare_for(view).is_some() {
        return None;
    }
    let tare = info.tare.as_ref()?;
    let baseline = tare.baseline();
    Some(format!(
        "the recording's tare of {} × {} cells is not used; to use it, give the --crop and --turn of the recording",
        baseline.columns(),
        baseline.rows()
    ))
}

/// Returns the warning that the threshold is one of noise, but the tare shows neither noise nor a step of the values,
/// so that 1 is used; None otherwise.
pub(crate) fn unknown_step(processing: &Processing) -> Option<&'static str> {
    let tare = processing.tare.as_ref();
    let is_noise = matches!(processing.rule, Some(Rule::Noise(_)));
    tare.filter(|tare| is_noise && tare.step().is_none())
        .map(|_| {
        "all values of the tare are equal, so their step is unknown; a cell counts as active if it exceeds its tare by 1 \
         in the sensor's unit"
    })
}

/// Computes the tare from the channel's first frames. The median of each cell over these frames is its value at rest,
/// which is subtracted from then on.
pub(crate) fn tare(
    recording: &mut RecordingFile,
    (channel, wanted): (usize, u64),
    asked: &ProcessingArguments,
    processing: &mut Processing,
) -> Result<(), CliError> {
    let mut frames = TareFrames::new(wanted);
    let view = &processing.view;
    // Damage after the tare's frames does not matter here.
    let added = recording.frames_again(channel, |frame| {
        frames.add(frame, view)?;
        Ok::<_, FrameError>(match frames.missing() {
            0 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        })
    })?;
    let tare = added.and_then(|()| frames.finish());
    let refused = |error| recording.refused(&asked.tare_refused(&error));
    processing.tare = Some(tare.map_err(refused)?);
    Ok(())
}

/// Returns the frame with the greatest sum of tared values, the first one of several; None if no frame has a value.
/// Without tare and gain the listing has it already; otherwise the recording is read once more.
pub(crate) fn peak(
    recording: &mut RecordingFile,
    channel: usize,
    listed: &ListedChannel,
    processing: &mut Processing,
) -> Result<Option<u64>, CliError> {
    if processing.tare.is_none() && processing.gain.is_none() {
        return Ok(listed.peak.number());
    }
    let mut peak = Peak::default();
    let added = recording.frames_again(channel, |frame| {
        let processed = processing.run(frame)?;
        peak.add(frame.number, processed.tared_sum);
        Ok::<_, FrameError>(ControlFlow::Continue(()))
    })?;
    added.map_err(|error| recording.refused(&(error.to_string() + frame_advice(&error))))?;
    Ok(peak.number())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(
        text: &str,
        is_damaged: bool,
        fatal: f64,
    ) -> (Vec<f64>, Result<Result<(), f64>, String>) {
        let file = tempfile::NamedTempFile::new().expect("a temporary file");
        std::fs::write(file.path(), text).expect("written");
        let mut recording =
            RecordingFile::open(file.path(), ReadOptions::default()).expect("a file");
        if is_damaged {
            recording.remember_damage();
        }
        let mut values = Vec::new();
        let read = recording.frames_again(0, |frame| {
            let value = frame.values()[0];
            values.push(value);
            if value == fatal {
                Err(value)
            } else {
                Ok(ControlFlow::Continue(()))
            }
        });
        (values, read.map_err(|error| error.to_string()))
    }

    #[test]
    fn only_unknown_damage_is_an_error_when_frames_are_read_again() {
        let damaged = "r0c0,r0c1\n1,2\n3,4\n5,x\n";
        let (values, read) = taken(damaged, false, 9.0);
        assert_eq!(values, [1.0, 3.0]);
        let error = read.expect_err("damaged");
        assert!(
            error.contains("line 4, column 2: found \"x\", expected a number"),
            "{error}"
        );
        assert_eq!(taken(damaged, true, 9.0), (vec![1.0, 3.0], Ok(Ok(()))));
    }

    #[test]
    fn frames_are_not_read_beyond_a_failure() {
        let two_channels = "{\"channel\":\"a\",\"frame\":[[1]]}\n{\"channel\":\"b\",\"frame\":[[2]]}\n\
                            {\"channel\":\"a\",\"frame\":[[3]]}\n{\"channel\":\"a\",\"frame\":[[4]]}\nx\n";
        assert_eq!(
            taken(two_channels, false, 3.0),
            (vec![1.0, 3.0], Ok(Err(3.0)))
        );
    }

    /// Input that comes in pieces can be read again from any place, and no more is read than requested.
    #[test]
    fn input_can_be_read_again() {
        let input = (&b"abc"[..]).chain(&b"defg"[..]).chain(&b"hij"[..]);
        let mut input = SpooledInput::new(input).expect("a file");
        let mut read = |to: SeekFrom, count: usize| {
            let place = input.seek(to).expect("sought");
            let mut bytes = vec![0; count];
            input.read_exact(&mut bytes).expect("read");
            (place, String::from_utf8(bytes).expect("text"), input.length)
        };
        let start = SeekFrom::Start(0);
        assert_eq!(read(start, 2), (0, "ab".to_owned(), 2));
        assert_eq!(read(start, 4), (0, "abcd".to_owned(), 4));
        assert_eq!(read(SeekFrom::Current(-1), 2), (3, "de".to_owned(), 5));
        assert_eq!(read(SeekFrom::Start(8), 1), (8, "i".to_owned(), 10));
        assert_eq!(read(SeekFrom::End(-3), 3), (7, "hij".to_owned(), 10));
    }

    #[test]
    fn an_endless_input_is_refused() {
        let mut input = SpooledInput::new(io::repeat(b'1')).expect("a file");
        input.most = 1 << 20;
        let read = io::copy(&mut input, &mut io::sink());
        assert!(read.is_err_and(|error| error.to_string().contains("more than 4 GiB")));
    }
}
