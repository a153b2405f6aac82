//! The processing of a recording's frames: the part given by flags, and the steps that need all frames first.

use std::ops::ControlFlow;

use crate::cli::arguments::frames::ProcessingArguments;
use crate::cli::error::{CliError, frame_advice};
use crate::cli::input::recording::{RecordingFile, dead_cells};
use crate::cli::output::recording_list::ListedChannel;
use crate::formats::recording::{ChannelInfo, ReadOptions, RecordingError, RecordingEvent};
use crate::frame::{FrameError, Peak, Processing, Rule, SetRule, TareFrames, View};
use crate::matrix::Matrix;
use crate::sensor::MatrixSize;

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
fn gain(path: &std::path::Path) -> Result<Matrix<f64>, CliError> {
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
        Err(error) if error.is_of_size() || matches!(error, RecordingError::Unknown) => {
            match file.read_table(&mut take) {
                Err(RecordingError::Unknown) => Err(error),
                read => read,
            }
        }
        read => read.map(drop),
    };
    read.map_err(|error| match error {
        error if error.is_of_size() => file.refused(&"expected a table: a line for each row"),
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
        frames.add_frame(frame, view)?;
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
