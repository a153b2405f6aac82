use crate::frame::error::FrameError;
use crate::frame::recorded::Frame;
use crate::frame::tare::{Tare, TareFrames};
use crate::frame::view::View;

/// The first frames of a source. A frame of another size is left out. If successive frames of one other size are more
/// than those so far, the tare begins again with them: the very first frame was cut, or the sensor was set up anew. So
/// a tare ends soon after a change of the size, too.
#[derive(Clone, Debug)]
pub struct FirstFrames {
    frames: TareFrames,
    other: Option<TareFrames>,
}

impl FirstFrames {
    /// Begins a tare of `wanted` frames, at least one.
    pub fn new(wanted: u64) -> Self {
        Self {
            frames: TareFrames::new(wanted),
            other: None,
        }
    }

    /// Returns the number of frames that the tare needs.
    pub fn wanted(&self) -> u64 {
        self.frames.wanted()
    }

    /// Returns the number of frames that are still missing.
    pub fn missing(&self) -> u64 {
        self.frames.missing()
    }

    /// Checks that the needed number of frames of this size fits into memory.
    pub fn check_memory(&self, values: usize) -> Result<(), FrameError> {
        self.frames.check_memory(values)
    }

    /// Returns why a frame is not in the tare, as far as it is made; None if it fits.
    pub fn refusal(&mut self, frame: &Frame, view: &View) -> Option<FrameError> {
        self.frames.check_frame(frame, view).err()
    }

    /// Returns how many of the last frames were left out, but are in the tare if it begins again with more of them.
    pub fn others(&self) -> u64 {
        self.other.as_ref().map_or(0, TareFrames::frames)
    }

    /// Adds the part of a frame that a view shows. Returns false if the tare begins again with it and the frames of its
    /// size just before it: those that were added before are not in the tare. After an error of its size, the frame is
    /// left out.
    pub fn add(&mut self, frame: &Frame, view: &View) -> Result<bool, FrameError> {
        let added = self.frames.add_frame(frame, view);
        let other = self.other.take();
        let Err(error) = added else {
            return Ok(true);
        };
        if !error.is_of_size() {
            return Err(error);
        }
        let wanted = self.wanted();
        let fresh = || TareFrames::new(wanted);
        let mut sets = other.into_iter().chain(std::iter::once_with(fresh));
        self.other = sets.find_map(|mut set| set.add_frame(frame, view).is_ok().then_some(set));
        let missing = self.missing();
        match self.other.take_if(|other| other.missing() < missing) {
            Some(frames) => {
                self.frames = frames;
                Ok(false)
            }
            None => Err(error),
        }
    }

    /// Computes the tare.
    ///
    /// # Errors
    /// Returns an error if frames are missing.
    pub fn finish(self) -> Result<Tare, FrameError> {
        self.frames.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::FrameSize;

    #[test]
    fn a_tare_begins_again_with_frames_of_another_size_if_no_others_come() {
        for (wanted, sides, columns) in [
            (5, &[2, 6, 6, 6, 6, 6][..], 6),
            (5, &[2, 2, 6, 6, 2, 6, 6, 6, 2, 2], 2),
            (2, &[2, 6, 6], 6),
            (3, &[2, 2, 6, 6, 6], 6),
            (4, &[2, 6, 4, 6, 4, 2, 2, 2], 2),
        ] {
            let mut first = FirstFrames::new(wanted);
            for &side in sides {
                assert!(first.missing() > 0, "{sides:?}");
                let _ = first.add(&Frame::new(FrameSize::of(side, side)), &View::default());
            }
            let tare = first.finish().expect("complete");
            let found = (tare.frames(), tare.baseline().columns());
            assert_eq!(found, (wanted, columns), "{sides:?}");
        }
    }
}
