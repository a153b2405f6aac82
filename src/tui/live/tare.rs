//! The tare of the live page. At the start it is made of the first frames if that is requested, otherwise it is the
//! tare of the recording. A key makes it of the last frames.

use std::sync::Arc;

use taxel_core::frame::{Frame, FrameError, Processing, Rule, Tare, TareFrames};
use taxel_files::formats::recording::ChannelInfo;
use taxel_files::formats::value::{counted, fitting, measured};

use crate::tui::live::message::WatchRequest;
use crate::tui::live::reading::{nine_digits, round_up};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TareOrigin {
    pub frames: u64,
    /// The number of the last of these frames; None for a tare of another recording, or from before the source was
    /// watched again.
    pub number: Option<u64>,
    /// The time of the last of these frames, in seconds.
    pub time: Option<f64>,
}

#[derive(Clone, Debug)]
pub(super) struct LiveTare {
    /// The number of first frames that a tare was requested of, until a key makes or removes a tare; 0 for none.
    wanted: u64,
    first: Option<TareFrames>,
    /// The origin of the tare; None if nothing is subtracted.
    origin: Option<TareOrigin>,
    takes_own: bool,
    error: Option<FrameError>,
}

impl LiveTare {
    pub(super) fn new(request: &WatchRequest) -> Self {
        Self {
            wanted: request.tare,
            first: (request.tare > 0).then(|| TareFrames::new(request.tare)),
            origin: None,
            takes_own: request.own_tare && request.tare == 0,
            error: None,
        }
    }

    /// Returns the origin of the tare; None without one.
    pub(super) fn origin(&self) -> Option<TareOrigin> {
        self.origin
    }

    /// Returns how many frames have come for the tare, and how many it needs; None if no tare is being made.
    pub(super) fn progress(&self) -> Option<(u64, u64)> {
        let first = self.first.as_ref()?;
        Some((first.wanted() - first.missing(), first.wanted()))
    }

    pub(super) fn error(&self) -> Option<&FrameError> {
        self.error.as_ref()
    }

    pub(super) fn take_own(&mut self, channel: &ChannelInfo, processing: &mut Processing) {
        let takes_own = std::mem::take(&mut self.takes_own);
        if let Some(tare) = channel.tare_for(&processing.view).filter(|_| takes_own) {
            processing.tare = Some(tare.clone());
            self.origin = Some(TareOrigin {
                frames: tare.frames(),
                number: None,
                time: None,
            });
        }
    }

    /// Adds one of the first frames, and uses the tare after the last of them. A frame whose size does not fit is left
    /// out, as [`TareFrames`] describes; the error says so until one that fits.
    pub(super) fn add(&mut self, frame: &Frame, processing: &mut Processing) {
        let Some(mut first) = self.first.take() else {
            return;
        };
        let added = first.add(frame, &processing.view);
        self.error = match added {
            Ok(_) if first.missing() == 0 => match first.finish() {
                Ok(tare) => {
                    self.end(tare, frame, processing);
                    None
                }
                Err(error) => Some(error),
            },
            Err(error) if !error.is_of_size() => Some(error),
            added => {
                self.first = Some(first);
                added.err()
            }
        };
    }

    /// Notes that no more frames will come. Returns true if a tare was being made, which cannot be finished any more.
    pub(super) fn end_of_source(&mut self) -> bool {
        let Some(first) = self.first.take() else {
            return false;
        };
        self.error = first.finish().err();
        true
    }

    pub(super) fn of_last(
        &mut self,
        frames: &[Arc<Frame>],
        processing: &mut Processing,
    ) -> Result<(), FrameError> {
        let Some(last) = frames.first() else {
            return Ok(());
        };
        let mut tare = TareFrames::new(frames.len() as u64);
        for frame in frames.iter().rev() {
            tare.add(frame, &processing.view)?;
        }
        self.end(tare.finish()?, last, processing);
        (self.first, self.error, self.wanted) = (None, None, 0);
        Ok(())
    }

    fn end(&mut self, tare: Tare, last: &Frame, processing: &mut Processing) {
        self.origin = Some(TareOrigin {
            frames: tare.frames(),
            number: Some(last.number),
            time: last.time,
        });
        processing.tare = Some(tare);
    }

    /// Removes the tare, and stops making one. Returns false if there was none and none was being made.
    pub(super) fn give_up(&mut self, processing: &mut Processing) -> bool {
        let was = self.origin.is_some() || self.first.is_some();
        (self.origin, self.first, self.error, self.wanted) = (None, None, None, 0);
        processing.tare = None;
        was
    }

    /// Notes that the source is watched again, which counts its frames from 0: an existing tare stays without its
    /// age. A tare that was being made, or that lacked frames, begins anew.
    pub(super) fn restart(&mut self) {
        self.origin = self.origin.map(|origin| TareOrigin {
            number: None,
            time: None,
            ..origin
        });
        let begins = self.origin.is_none() && self.wanted > 0;
        self.first = begins.then(|| TareFrames::new(self.wanted));
        self.error = None;
    }
}

/// Formats how many frames have come for a tare, and how many it needs: `3 of 30 frames`.
pub(super) fn progress_text((taken, wanted): (u64, u64)) -> String {
    format!("{taken} of {}", counted(wanted, "frame"))
}

pub(super) fn text(rule: Rule, unit: &str) -> String {
    match rule {
        Rule::AtLeast(threshold) => format!("{}{unit}", measured(threshold, 7)),
        Rule::Percent(percent) => format!("{} % of max", fitting(percent, 5)),
        Rule::Hysteresis { low, high } => {
            format!("{} to {}{unit}", measured(low, 7), measured(high, 7))
        }
        Rule::Noise(deviations) => format!("{} × noise", fitting(deviations, 5)),
    }
}

/// Moves the threshold up or down by a step: a hundredth of the top of the range, in round numbers. In percent the
/// step is 5 %, in deviations of the noise it is 1. Without a threshold, it becomes half of the top of the range: above
/// the noise of most sensors, and below most touches.
pub(super) fn step(rule: Option<Rule>, direction: i8, top: f64) -> Result<Rule, FrameError> {
    let by = f64::from(direction);
    let step = round_up(top / 100.0) * by;
    match rule {
        None => Rule::at_least(nine_digits(top / 2.0)),
        Some(Rule::Percent(percent)) => Rule::percent(stepped(percent, 5.0 * by, (5.0, 100.0))),
        Some(Rule::Hysteresis { low, high }) => {
            Rule::hysteresis(nine_digits(low + step), nine_digits(high + step))
        }
        Some(Rule::Noise(deviations)) => Rule::noise(stepped(deviations, by, (1.0, 1000.0))),
        Some(Rule::AtLeast(threshold)) => Rule::at_least(nine_digits(threshold + step)),
    }
}

/// Returns a value after a step within bounds. A value already beyond a bound stays if the step would lead further
/// away: a step down never goes up, and a step up never down.
fn stepped(value: f64, step: f64, (least, most): (f64, f64)) -> f64 {
    let next = value + step;
    if step < 0.0 {
        next.max(least).min(value)
    } else {
        next.min(most).max(value)
    }
}

pub(super) fn other_unit(rule: Option<Rule>, largest: f64) -> Result<Rule, FrameError> {
    match rule {
        Some(Rule::Percent(percent)) => {
            Rule::at_least(nine_digits(Rule::percent_of(percent, largest)))
        }
        Some(Rule::AtLeast(threshold)) => {
            Rule::percent((100.0 * threshold / largest).round().clamp(1.0, 100.0))
        }
        _ => Rule::percent(50.0),
    }
}

#[cfg(test)]
mod tests {
    use taxel_core::frame::FrameSize;

    use super::*;

    #[test]
    fn frames_of_another_size_are_left_out_of_a_tare() {
        let mut request = WatchRequest::new("none");
        request.tare = 3;
        let (mut tare, mut processing) = (LiveTare::new(&request), Processing::default());
        let mut add = |side| {
            let frame = Frame::new(FrameSize::new(side, side).expect("an allowed size"));
            tare.add(&frame, &mut processing);
            (tare.progress(), tare.error().is_some())
        };
        assert_eq!(add(2), (Some((1, 3)), false));
        assert_eq!(add(6), (Some((1, 3)), true));
        assert_eq!(add(2), (Some((2, 3)), false));
        assert_eq!(add(2), (None, false));
        assert_eq!(processing.tare.map(|tare| tare.frames()), Some(3));
    }

    #[test]
    fn a_tare_that_lacked_frames_is_made_when_the_source_is_watched_again() {
        let mut request = WatchRequest::new("none");
        request.tare = 2;
        let (mut tare, mut processing) = (LiveTare::new(&request), Processing::default());
        let frame = Frame::new(FrameSize::new(2, 2).expect("an allowed size"));
        tare.add(&frame, &mut processing);
        assert!(tare.end_of_source() && tare.error().is_some());
        tare.restart();
        assert_eq!((tare.progress(), tare.error()), (Some((0, 2)), None));
        for _ in 0..2 {
            tare.add(&frame, &mut processing);
        }
        assert_eq!((tare.progress(), processing.tare.is_some()), (None, true));
        // An existing tare stays; a removed one does not come back.
        tare.restart();
        assert!(tare.progress().is_none() && processing.tare.is_some());
        assert!(tare.give_up(&mut processing));
        tare.restart();
        assert_eq!(tare.progress(), None);
    }

    #[test]
    fn a_step_never_goes_the_other_way() {
        let percent = |value, direction| step(Some(Rule::Percent(value)), direction, 1.0);
        for (before, direction, after) in [
            (3.0, -1, 3.0),
            (3.0, 1, 8.0),
            (7.0, -1, 5.0),
            (98.0, 1, 100.0),
            (50.0, -1, 45.0),
            (100.0, 1, 100.0),
        ] {
            assert_eq!(percent(before, direction), Ok(Rule::Percent(after)));
        }
        let noise = |value, direction| step(Some(Rule::Noise(value)), direction, 1.0);
        assert_eq!(noise(0.5, -1), Ok(Rule::Noise(0.5)));
        assert_eq!(noise(0.5, 1), Ok(Rule::Noise(1.5)));
        assert_eq!(noise(2.0, -1), Ok(Rule::Noise(1.0)));
    }
}
