//! Work under way: what it is, and how far.

use crate::pose::PoseGrid;
use crate::tui::explore::message::SweepProgress;

/// What is done.
#[derive(Clone, Debug, PartialEq)]
pub enum WorkKind {
    /// A grid is gone through.
    Sweep(Box<PoseGrid>),
    /// A file of this name is written; of so many poses, where it holds all of them.
    Write(String, Option<u64>),
}

/// The work.
#[derive(Clone, Debug, PartialEq)]
pub struct Running {
    /// Its number.
    pub number: u64,
    /// What it is.
    pub job: WorkKind,
    /// How far it is; none before the first word of it.
    pub progress: Option<SweepProgress>,
    /// Whether it was told to stop.
    pub stopping: bool,
}

impl Running {
    /// Work that begins.
    pub fn new(number: u64, job: WorkKind) -> Self {
        Self {
            number,
            job,
            progress: None,
            stopping: false,
        }
    }

    /// How many poses there are in all, where it is about poses.
    pub fn poses(&self) -> Option<u64> {
        match &self.job {
            WorkKind::Sweep(grid) => Some(grid.poses()),
            WorkKind::Write(_, poses) => *poses,
        }
    }

    /// Poses a second; none before that can be told.
    #[expect(clippy::cast_precision_loss, reason = "for reading")]
    pub fn rate(&self) -> Option<f64> {
        let SweepProgress { poses, elapsed } = self.progress?;
        let seconds = elapsed.as_secs_f64();
        (seconds > 0.0 && poses > 0).then(|| poses as f64 / seconds)
    }

    /// Seconds that are left at that rate.
    #[expect(clippy::cast_precision_loss, reason = "for reading")]
    pub fn left(&self) -> Option<f64> {
        let rest = self.poses()?.saturating_sub(self.progress?.poses);
        Some(rest as f64 / self.rate()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn rate_and_rest_are_those_of_what_was_done() {
        let mut running = Running::new(1, WorkKind::Write("a.npy".to_owned(), Some(1000)));
        assert_eq!((running.rate(), running.left()), (None, None));
        let progress = |poses, millis| {
            let elapsed = Duration::from_millis(millis);
            Some(SweepProgress { poses, elapsed })
        };
        running.progress = progress(0, 100);
        assert_eq!((running.rate(), running.left()), (None, None));
        running.progress = progress(250, 500);
        assert_eq!((running.rate(), running.left()), (Some(500.0), Some(1.5)));
        running.progress = progress(250, 0);
        assert_eq!(running.rate(), None, "a clock that stands still");
        running.progress = progress(1200, 500);
        assert_eq!(running.left(), Some(0.0));
    }
}
