//! The result of reading a recording once: its channels, its oddities, and the damage at which it ends.
//!
//! ```text
//! recording -> Scan -> the listing of `taxel frames`, or the channel that is answered
//! ```

use std::ops::ControlFlow;

use serde::Serialize;
use taxel_core::frame::{FlipCounter, FlipReport, FrameError, FrameSize, Processing, View};
use taxel_core::imprint::Imprint;
use taxel_core::matrix::Matrix;
use taxel_files::ReadError;
use taxel_files::formats::json;
use taxel_files::formats::recording::{Format, RecordingEvent, RecordingNote, no_channel};
use taxel_files::formats::value::{counted, grouped};

use crate::cli::error::{CliError, note_advice};
use crate::cli::input::recording::RecordingFile;
use crate::cli::output::recording_list::ListedChannel;

const MOST_WARNINGS: usize = 20;

#[derive(Debug, Default)]
pub(crate) struct Scan {
    /// The format; None if a damage comes before the format is certain.
    pub(super) format: Option<&'static Format>,
    pub(super) channels: Vec<ListedChannel>,
    /// How the recording is read: what its times, labels and cells are.
    pub(super) plain: Vec<String>,
    notes: Vec<RecordingNote>,
    more_notes: u64,
    pub(super) error: Option<ReadError>,
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
                RecordingEvent::Note(note) if note.is_plain() => {
                    scan.plain.push(note.to_string());
                }
                RecordingEvent::Note(note) => {
                    if scan.notes.len() < MOST_WARNINGS {
                        scan.notes.push(note.clone());
                    } else {
                        scan.more_notes += 1;
                    }
                }
                RecordingEvent::Damage { .. }
                | RecordingEvent::Provisional(_)
                | RecordingEvent::Withdrawn => {}
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

#[derive(Serialize)]
struct NoiseJson {
    frames: u64,
    cells: u32,
    noise: Option<f64>,
    standard_error: Option<f64>,
    flips: u64,
    repeated: u64,
    stuck_on: Vec<[u8; 2]>,
    stuck_off: Vec<[u8; 2]>,
    mask: Vec<String>,
}

pub(crate) fn gather(
    recording: &mut RecordingFile,
    channel: usize,
    processing: &mut Processing,
) -> Result<Option<FlipReport>, CliError> {
    let mut counter: Option<FlipCounter> = None;
    let counted = recording.frames_again(channel, |frame| {
        let processed = processing.run(frame)?;
        let counter = counter.get_or_insert_with(|| {
            let values = processed.raw;
            let mut cells = Imprint::empty(values.size());
            for row in 0..values.rows() {
                for (column, value) in (0..values.columns()).zip(values.row(row)) {
                    cells.set(column, row, !value.is_nan());
                }
            }
            FlipCounter::new(cells)
        });
        if let Some(imprint) = &processed.imprint {
            counter.add(imprint);
        }
        Ok::<_, FrameError>(ControlFlow::Continue(()))
    })?;
    counted.map_err(|error| recording.refused(&error))?;
    Ok(counter.map(|counter| counter.finish()))
}

fn taxels(imprint: &Imprint) -> Vec<[u8; 2]> {
    let rows = 0..imprint.rows();
    let all = rows.flat_map(|row| (0..imprint.columns()).map(move |column| [column, row]));
    all.filter(|&[column, row]| imprint.get(column, row))
        .collect()
}

pub(crate) fn json(found: &FlipReport) -> String {
    let line = json::text(&NoiseJson {
        frames: found.frames,
        cells: found.cells,
        noise: found.noise,
        standard_error: found.standard_error,
        flips: found.flips,
        repeated: found.repeated,
        stuck_on: taxels(&found.stuck_on),
        stuck_off: taxels(&found.stuck_off),
        mask: found.mask().lines().collect(),
    });
    line + "\n"
}

pub(crate) fn text(found: &FlipReport) -> String {
    let frames = counted(found.frames, "frame");
    let mut text = format!("{frames} of {}\n", counted(found.cells, "taxel"));
    match (found.noise, found.standard_error) {
        (Some(noise), Some(error)) => {
            text += &format!(
                "noise {noise:.5} ± {error:.5}: a taxel changed for a single frame in {} of {} cases\n",
                grouped(found.flips),
                grouped(found.repeated)
            );
        }
        _ if found.repeated == 0 => text += "too few frames to tell how often taxels flip\n",
        _ => {
            text += &format!(
                "noise 0.5 or more: a taxel changed for a single frame in {} of {} cases\n",
                grouped(found.flips),
                grouped(found.repeated)
            );
        }
    }
    for (what, stuck) in [
        ("stuck on", &found.stuck_on),
        ("stuck off or dead", &found.stuck_off),
    ] {
        let taxels: Vec<String> = taxels(stuck)
            .iter()
            .map(|[column, row]| format!("{column},{row}"))
            .collect();
        let taxels = if taxels.is_empty() {
            "none".to_owned()
        } else {
            taxels.join("  ")
        };
        text += &format!("{what}: {taxels}\n");
    }
    text
}
