//! The first frames of a source, which wait for the tare that is made of them.

use crate::frame::{FirstFrames, Frame, FrameError, Tare, View};

pub(super) struct TareQueue {
    tare: FirstFrames,
    waiting: Vec<Frame>,
    /// The last frames, of one other size: the tare begins again with them if enough of them come.
    others: Vec<Frame>,
}

pub(super) type LeftOut = (u64, FrameError);

impl TareQueue {
    pub(super) fn new(frames: u64) -> Option<Self> {
        (frames > 0).then(|| Self {
            tare: FirstFrames::new(frames),
            waiting: Vec::new(),
            others: Vec::new(),
        })
    }

    pub(super) fn is_complete(&self) -> bool {
        self.tare.missing() == 0
    }

    /// Adds a frame. Returns the frames, perhaps this one, of which it is certain now that they do not wait for the
    /// tare: their size is another one.
    pub(super) fn add(&mut self, frame: Frame, view: &View) -> Result<Vec<LeftOut>, FrameError> {
        let left_out = match self.tare.add(&frame, view) {
            Ok(goes_on) => {
                self.tare.check_memory(frame.values().len())?;
                if !goes_on {
                    std::mem::swap(&mut self.waiting, &mut self.others);
                }
                self.waiting.push(frame);
                std::mem::take(&mut self.others)
            }
            Err(error) if error.is_of_size() && !self.waiting.is_empty() => {
                let others = self.tare.others();
                let mut left_out = Vec::new();
                if others <= 1 {
                    left_out.append(&mut self.others);
                }
                if others == 0 {
                    left_out.push(frame);
                } else {
                    self.others.push(frame);
                }
                left_out
            }
            Err(error) => return Err(error),
        };
        let with_reason = |frame: Frame| Some((frame.number, self.tare.refusal(&frame, view)?));
        Ok(left_out.into_iter().filter_map(with_reason).collect())
    }

    pub(super) fn incomplete(&self) -> FrameError {
        let wanted = self.tare.wanted();
        let frames = wanted - self.tare.missing();
        FrameError::Tare { frames, wanted }
    }

    pub(super) fn finish(self) -> Result<(Tare, Vec<Frame>), FrameError> {
        Ok((self.tare.finish()?, self.waiting))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::FrameSize;

    /// Returns the numbers of the frames that a tare of this many frames leaves out, and of those that wait until it is
    /// complete. The frames have these sides.
    fn queued(wanted: u64, sides: &[u16]) -> Result<(Vec<u64>, Vec<u64>), FrameError> {
        let mut queue = TareQueue::new(wanted).expect("at least one");
        let mut left_out = Vec::new();
        for (number, &side) in (0..).zip(sides) {
            let mut frame = Frame::new(FrameSize::new(side, side).expect("an allowed size"));
            frame.number = number;
            left_out.extend(queue.add(frame, &View::default())?);
        }
        let numbers = left_out.iter().map(|(number, _)| *number).collect();
        let (_, waiting) = queue.finish()?;
        Ok((numbers, waiting.iter().map(|frame| frame.number).collect()))
    }

    #[test]
    fn each_frame_is_left_out_or_waits_for_the_tare() {
        for (wanted, sides, left_out, waiting) in [
            (3, &[2, 6, 2, 2][..], &[1][..], &[0, 2, 3][..]),
            // The tare begins again with the frames of the other size, the first of them, too.
            (3, &[2, 6, 6, 6], &[0], &[1, 2, 3]),
            (3, &[2, 2, 6, 6, 6], &[0, 1], &[2, 3, 4]),
            // Only successive frames count.
            (4, &[2, 6, 4, 6, 4, 2, 2, 2], &[1, 2, 3, 4], &[0, 5, 6, 7]),
            (4, &[2, 6, 2, 6, 6, 6, 6], &[1, 0, 2], &[3, 4, 5, 6]),
        ] {
            let found = queued(wanted, sides).expect("complete");
            assert_eq!(found, (left_out.to_vec(), waiting.to_vec()), "{sides:?}");
        }
    }
}
