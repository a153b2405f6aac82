//! The result of reading a recording once: its channels, its oddities, and the damage at which it ends.
//!
//! ```text
//! recording -> Scan -> the listing of `taxel frames`, or the channel that is answered
//! ```

use std::ops::ControlFlow;

use crate::cli::error::{CliError, note_advice};
use crate::cli::input::recording::RecordingFile;
use crate::cli::output::recording_list::ListedChannel;
use crate::formats::recording::{
    RecordingError, RecordingEvent, RecordingFormat, RecordingNote, no_channel,
};
use crate::formats::value::counted;
use crate::frame::{FrameError, FrameSize, View};
use crate::matrix::Matrix;

const MOST_WARNINGS: usize = 20;

#[derive(Debug, Default)]
pub(crate) struct Scan {
    /// The format; None if a damage comes before the format is certain.
    pub(super) format: Option<RecordingFormat>,
    pub(super) channels: Vec<ListedChannel>,
    notes: Vec<RecordingNote>,
    more_notes: u64,
    pub(super) error: Option<RecordingError>,
    pub(super) misfit: Option<FrameError>,
}

impl Scan {
    pub(super) fn of(recording: &mut RecordingFile, view: &View) -> Self {
        let mut scan = Self::default();
        let mut seen = Matrix::default();
        let result = recording.read(&mut |event| {
            match event {
                RecordingEvent::Channel(info) => {
                    scan.channels.push(ListedChannel::new(info, view));
                }
                RecordingEvent::Frame(frame) => {
                    let values = match view.apply_to(frame, &mut seen) {
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
                RecordingEvent::Damage { .. } => {}
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

    pub(super) fn warnings(&self, name: &str) -> Vec<String> {
        let line = |note| format!("{name}: {note}{}", note_advice(note));
        let lines = self.notes.iter().map(line);
        let mut lines: Vec<String> = lines.collect();
        if self.more_notes > 0 {
            lines.push(format!("{name}: {} more of these", self.more_notes));
        }
        lines
    }

    /// Returns a warning if the given rows and columns differ from those that the recording states, for the channel
    /// that is asked for if there is one.
    pub(super) fn unused_size(
        &self,
        given: Option<FrameSize>,
        asked: Option<&str>,
    ) -> Option<String> {
        let channels = self.channels.iter().map(|channel| &channel.info);
        let mut chosen =
            channels.filter(|info| asked.is_none_or(|asked| info.shown_name() == asked));
        let stated = chosen.find_map(|info| info.size)?;
        (given? != stated).then(|| {
            let rows = counted(stated.rows(), "row");
            let columns = counted(stated.columns(), "column");
            format!("it states {rows} and {columns}; --rows and --columns have no effect")
        })
    }

    /// Returns the index of the chosen channel. Without `--channel` there must be only one. A channel without a name
    /// is called `unnamed`.
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
