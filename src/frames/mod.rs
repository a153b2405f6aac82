//! From the frames of a sensor to imprints: what `taxel frames`, `taxel watch` and the live page share.
//!
//! ```text
//! acquire or a recording -> Recording: each frame as it came
//!                        -> Pipeline: tare of the first frames; crop, flip, turn, mask, tare, gain; threshold -> imprint
//! ```

pub mod recording;

use std::ffi::OsStr;
use std::path::PathBuf;

use taxel_core::frame::{Frame, FrameError, Processing, Rule, RuleOrigin, SetRule, TareFrames};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::Parameter;
use taxel_core::sensor::Sensor;
use taxel_files::acquire::{AcquireOptions, FrameSource};
use taxel_files::formats::recording::ChannelInfo;
use taxel_files::storage::{Existing, ModelChoice};

use crate::naming::Terms;

/// The memory for the frames that the live page can go back to, in bytes, unless another size is set.
pub const HISTORY_BYTES: usize = 32 << 20;

/// A source of frames, and what is to be done with them.
#[derive(Clone, Debug)]
pub struct WatchRequest {
    /// The source as it was named; what a path refers to is found when it is watched.
    pub source: FrameSource,
    pub options: AcquireOptions,
    pub baud_named: bool,
    pub pipeline: Pipeline,
    pub write: Option<(PathBuf, Existing)>,
    pub model: Option<ModelChoice>,
    /// On what terms the model names imprints.
    pub terms: Terms,
    pub history_bytes: usize,
}

impl PartialEq for WatchRequest {
    /// A request never changes.
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl WatchRequest {
    pub fn new(source: impl AsRef<OsStr>) -> Self {
        Self {
            source: FrameSource::named(source),
            options: AcquireOptions::default(),
            baud_named: false,
            pipeline: Pipeline::default(),
            write: None,
            model: None,
            terms: Terms::default(),
            history_bytes: HISTORY_BYTES,
        }
    }

    /// The name of the source for messages, without folders.
    pub fn name(&self) -> String {
        let name = self.source.name();
        match &self.source {
            FrameSource::File(_) => name.rsplit('/').next().unwrap_or(&name).to_owned(),
            _ => name,
        }
    }
}

/// How frames become imprints. A threshold or a tare that is not asked for is that of the recording, if it has one.
#[derive(Clone, Debug, Default)]
pub struct Pipeline {
    pub processing: Processing,
    /// The number of first frames that the tare is made of: 0 for none, None for the recording's own tare.
    pub(crate) wanted: Option<u64>,
    pub(crate) from_settings: bool,
    pub(crate) making: Option<TareFrames>,
    pub(crate) origin: Option<TareOrigin>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TareOrigin {
    pub frames: u64,
    /// Number and time of the last of these frames; None for the tare of a recording, or from before the source was
    /// watched again.
    pub last: Option<(u64, Option<f64>)>,
}

/// What became of a frame while a tare is made of the first ones.
#[derive(Clone, Debug, PartialEq)]
pub enum Taring {
    /// No tare is being made.
    Done,
    Added,
    /// The tare begins again with frames of this one's size.
    Again,
    /// It was the last of them: the tare is in use.
    Made,
    /// It is of another size.
    LeftOut(FrameError),
}

impl Pipeline {
    pub fn new(processing: Processing, tare: Option<u64>, from: RuleOrigin) -> Self {
        let mut pipeline = Self {
            processing,
            wanted: tare,
            from_settings: from == RuleOrigin::Settings,
            ..Self::default()
        };
        pipeline.restart();
        pipeline
    }

    pub fn rule(&self) -> Option<SetRule> {
        self.processing.applied_rule()
    }

    /// How many frames have come for the tare, and how many it needs; None if none is being made.
    pub fn progress(&self) -> Option<(u64, u64)> {
        let making = self.making.as_ref()?;
        Some((making.wanted - making.missing(), making.wanted))
    }

    /// The error that the tare lacks frames; None if none is being made.
    pub fn lacking(&self) -> Option<FrameError> {
        let (frames, wanted) = self.progress()?;
        Some(FrameError::Tare { frames, wanted })
    }

    /// Takes threshold and tare of a recording if others are not asked for. Returns the warning that its tare does not
    /// fit the visible part of the frames.
    pub fn begin(&mut self, info: &ChannelInfo) -> Option<String> {
        let processing = &mut self.processing;
        if processing.rule.is_none() {
            processing.apply_rule(info.own_rule(processing.least));
        }
        let (None, Some(own)) = (self.wanted, &info.tare) else {
            return None;
        };
        if let Some(tare) = info.tare_for(&processing.view) {
            let frames = tare.frames;
            self.origin = Some(TareOrigin { frames, last: None });
            processing.tare = Some(tare.clone());
            return None;
        }
        let size = own.baseline.size();
        Some(format!(
            "the recording's tare of {size} cells is not used; to use it, give the --crop and --turn of the recording"
        ))
    }

    /// Adds one of the first frames to the tare, if one is being made.
    pub fn add_to_tare(&mut self, frame: &Frame) -> Result<Taring, FrameError> {
        let Some(mut making) = self.making.take() else {
            return Ok(Taring::Done);
        };
        let taken = match making.add(frame, &self.processing.view) {
            Ok(_) if making.missing() == 0 => {
                self.set_tare(making, frame)?;
                return Ok(Taring::Made);
            }
            Ok(true) => Taring::Added,
            Ok(false) => Taring::Again,
            Err(error) if error.is_of_size() => Taring::LeftOut(error),
            Err(error) => return Err(error),
        };
        self.making = Some(making);
        Ok(taken)
    }

    /// Makes the tare of these frames, the last one first.
    pub fn tare_of<'f>(
        &mut self,
        frames: impl DoubleEndedIterator<Item = &'f Frame> + Clone,
    ) -> Result<(), FrameError> {
        let Some(last) = frames.clone().next() else {
            return Ok(());
        };
        let mut making = TareFrames::new(frames.clone().count() as u64);
        for frame in frames.rev() {
            making.add(frame, &self.processing.view)?;
        }
        self.set_tare(making, last)?;
        (self.making, self.wanted) = (None, Some(0));
        Ok(())
    }

    fn set_tare(&mut self, made: TareFrames, last: &Frame) -> Result<(), FrameError> {
        let tare = made.finish()?;
        self.origin = Some(TareOrigin {
            frames: tare.frames,
            last: Some((last.number, last.time)),
        });
        self.processing.tare = Some(tare);
        Ok(())
    }

    /// Gives up the tare, and making one. Returns false if there was none.
    pub fn drop_tare(&mut self) -> bool {
        let was = self.origin.is_some() || self.making.is_some();
        (self.origin, self.making, self.wanted) = (None, None, Some(0));
        self.processing.tare = None;
        was
    }

    /// Notes that the source is watched again, which counts its frames from 0: a tare stays without its age. One that
    /// was being made, or that lacked frames, begins anew.
    pub fn restart(&mut self) {
        if let Some(origin) = &mut self.origin {
            origin.last = None;
        }
        let wanted = self.wanted.filter(|&frames| frames > 0);
        let wanted = wanted.filter(|_| self.origin.is_none());
        self.making = wanted.map(TareFrames::new);
    }

    /// The end of the source: no tare is made any more. Returns why a tare that was being made is missing.
    pub fn end(&mut self) -> Option<FrameError> {
        let lacking = self.lacking();
        self.making = None;
        lacking
    }

    /// The error in words. If the settings ask for the tare that lacks frames, it names them.
    pub fn explained(&self, error: &FrameError) -> String {
        match error {
            FrameError::Tare { .. } if self.from_settings => {
                format!("{error} (tare under [frames] in the settings; --tare 0 turns it off)")
            }
            FrameError::NoTare => format!("{error}, such as --tare 30"),
            error => error.to_string(),
        }
    }

    /// The warning that the threshold is one of noise, but the tare shows neither noise nor a step of the values.
    pub fn unknown_step(&self) -> Option<&'static str> {
        let is_noise = matches!(self.processing.rule, Some(Rule::Noise(_)));
        let tare = self.processing.tare.as_ref().filter(|_| is_noise)?;
        tare.step.is_none().then_some(
            "all values of the tare are equal, so their step is unknown; a cell counts as active if it exceeds its \
             tare by 1 in the sensor's unit",
        )
    }
}

/// The unit of the values, with a space before it; empty if it is not known.
pub(crate) fn unit(info: &ChannelInfo) -> String {
    let unit = info.unit.as_ref();
    unit.map_or(String::new(), |unit| format!(" {unit}"))
}

/// A sensor with the taxels of an imprint, and with this pitch in mm if it is in range.
pub(crate) fn sensor(imprint: &Imprint, pitch: Option<f64>) -> Sensor {
    let sensor = Sensor::of_size(imprint.size());
    let with_pitch = pitch.and_then(|pitch| sensor.with(Parameter::Pitch, pitch).ok());
    with_pitch.unwrap_or(sensor)
}

#[cfg(test)]
mod tests {
    use taxel_core::frame::FrameSize;

    use super::*;

    fn frame(side: u16) -> Frame {
        Frame::new(FrameSize::new(side, side).expect("an allowed size"))
    }

    fn taring(frames: u64) -> Pipeline {
        Pipeline::new(Processing::default(), Some(frames), RuleOrigin::Flag)
    }

    #[test]
    fn frames_of_another_size_are_left_out_of_a_tare() {
        let mut pipeline = taring(3);
        let mut add = |side| {
            let taken = pipeline.add_to_tare(&frame(side)).expect("it fits");
            (pipeline.progress(), matches!(taken, Taring::LeftOut(_)))
        };
        assert_eq!(add(2), (Some((1, 3)), false));
        assert_eq!(add(6), (Some((1, 3)), true));
        assert_eq!(add(2), (Some((2, 3)), false));
        assert_eq!(add(2), (None, false));
        assert_eq!(pipeline.processing.tare.map(|tare| tare.frames), Some(3));
    }

    #[test]
    fn a_tare_that_lacked_frames_is_made_when_the_source_is_watched_again() {
        let mut pipeline = taring(2);
        pipeline.add_to_tare(&frame(2)).expect("it fits");
        assert!(pipeline.end().is_some());
        pipeline.restart();
        assert_eq!(pipeline.progress(), Some((0, 2)));
        for _ in 0..2 {
            pipeline.add_to_tare(&frame(2)).expect("it fits");
        }
        assert!(pipeline.progress().is_none() && pipeline.processing.tare.is_some());
        // An existing tare stays; a removed one does not come back.
        pipeline.restart();
        assert!(pipeline.progress().is_none() && pipeline.processing.tare.is_some());
        assert!(pipeline.drop_tare());
        pipeline.restart();
        assert_eq!(pipeline.progress(), None);
    }
}
