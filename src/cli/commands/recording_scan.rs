//! The result of reading a recording once: its channels, its oddities, and the damage at which it ends.
//!
//! ```text
//! recording -> Scan -> the listing of `taxel frames`, or the channel that is answered
//! ```

use std::ops::ControlFlow;

use crate::cli::commands::watch::no_channel;
use crate::cli::error::CliError;
use crate::cli::input::recording::RecordingFile;
use crate::cli::output::recording_list::ListedChannel;
use crate::formats::recording::{RecordingError, RecordingEvent, RecordingFormat, RecordingNote};
use crate::formats::value::counted;
use crate::frame::{FrameError, View};
use crate::matrix::Matrix;

/// More warnings than these are only counted.
const MOST_WARNINGS: usize = 20;

/// What one reading of a recording finds.
#[derive(Debug, Default)]
pub(crate) struct Scan {
    /// None if damage comes before the format is certain.
    pub(super) format: Option<RecordingFormat>,
    /// In the order in which the recording names them; a frame's channel is an index here.
    pub(super) channels: Vec<ListedChannel>,
    /// The first [`MOST_WARNINGS`] oddities that are not damage, such as a line of the wrong length.
    notes: Vec<RecordingNote>,
    /// How many more there were.
    more_notes: u64,
    /// The damage at which it ended.
    pub(super) error: Option<RecordingError>,
    /// Why a frame could not be cropped as asked: the first such error.
    pub(super) misfit: Option<FrameError>,
}

impl Scan {
    /// Reads a recording; sums are those of what the view shows, or of the whole frame if that is too large.
    pub(super) fn of(recording: &mut RecordingFile, view: &View) -> Self {
        let mut scan = Self::default();
        let mut seen = Matrix::filled(1, 1, f64::NAN);
        let result = recording.read(&mut |event| {
            match event {
                RecordingEvent::Channel(info) => {
                    scan.channels.push(ListedChannel::new(info, view));
                }
                RecordingEvent::Frame(frame) => {
                    let values = match view.of(frame, &mut seen) {
                        Ok(()) => seen.values(),
                        Err(error) => {
                            if view.crop.is_some() {
                                scan.misfit.get_or_insert(error);
                            }
                            frame.values()
                        }
                    };
                    if let Some(channel) = scan.channels.get_mut(frame.channel) {
                        channel.add(frame, values);
                    }
                }
                RecordingEvent::Note(note) => {
                    if scan.notes.len() < MOST_WARNINGS {
                        scan.notes.push(note.clone());
                    } else {
                        scan.more_notes += 1;
                    }
                }
            }
            ControlFlow::Continue(())
        });
        match result {
            Ok(format) => scan.format = Some(format),
            Err(error) => {
                scan.format = recording.format();
                scan.error = Some(error);
                recording.remember_damage();
            }
        }
        scan
    }

    /// What is odd in the recording, for standard error.
    pub(super) fn warnings(&self, name: &str) -> Vec<String> {
        let lines = self.notes.iter().map(|note| format!("{name}: {note}"));
        let mut lines: Vec<String> = lines.collect();
        if self.more_notes > 0 {
            lines.push(format!("{name}: {} more of these", self.more_notes));
        }
        lines
    }

    /// That rows and columns were given for a recording that states its own, and others.
    pub(super) fn unused_shape(&self, given: Option<(u16, u16)>) -> Option<String> {
        let stated = self
            .channels
            .iter()
            .find_map(|channel| channel.info.shape)?;
        let (rows, columns) = stated;
        (given? != stated).then(|| {
            let (rows, columns) = (counted(rows, "row"), counted(columns, "column"));
            format!("it states {rows} and {columns}; --rows and --columns have no effect")
        })
    }

    /// The number of the channel that is asked for.
    /// Without `--channel` there must be one only; a channel without a name is called `unnamed`.
    ///
    /// # Errors
    /// If there is none of that name, or none is named and there are several. The message lists the names.
    pub(super) fn channel(
        &self,
        recording: &RecordingFile,
        asked: Option<&str>,
    ) -> Result<usize, CliError> {
        let names: Vec<&str> = self
            .channels
            .iter()
            .map(|channel| channel.info.shown_name())
            .collect();
        match (asked, &names[..]) {
            (None, [_]) => Ok(0),
            (None, names) => Err(recording.refused(&format!(
                "{} channels, choose one with --channel: {}",
                names.len(),
                names.join(", ")
            ))),
            (Some(asked), names) => {
                let found = names.iter().position(|name| *name == asked);
                found.ok_or_else(|| recording.refused(&no_channel(asked, names)))
            }
        }
    }
}
