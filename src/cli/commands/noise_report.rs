//! `taxel frames FILE --noise-report`: how often taxels flip, and which are dead or stuck, according to a recording.

use std::ops::ControlFlow;

use serde::Serialize;

use crate::cli::error::CliError;
use crate::cli::input::recording::RecordingFile;
use crate::formats::json;
use crate::formats::value::{counted, grouped};
use crate::frame::{FlipCounter, FlipReport, FrameError, Processing};
use crate::imprint::Imprint;

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
