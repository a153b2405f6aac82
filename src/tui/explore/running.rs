//! A sweep or an export in progress.
//!
//! ```text
//! Exploring: hexagon                        what is being done
//! 1,200,000 of 3,600,000 poses, 33 %        how far it is
//! ████████████████░░░░░░░░░░░░░░░░          a gauge
//! 250,000 poses a second, about 10 seconds left
//! stopping keeps what is complete           what stopping leaves
//! ```
//! An export of a known number of poses has the same lines, any other only its title and what stopping leaves.

use std::time::Duration;

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::formats::value::{counted, grouped};
use crate::pose::PoseGrid;
use crate::tui::app::page::{Page, Slot};
use crate::tui::explore::message::{SweepProgress, name_of};
use crate::tui::explore::ranges::view::about;
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

#[derive(Clone, Debug, PartialEq)]
pub enum WorkKind {
    Sweep(Box<PoseGrid>),
    Write(String, Option<u64>),
}

#[derive(Clone, Debug, PartialEq)]
pub struct Running {
    pub number: u64,
    pub job: WorkKind,
    pub progress: Option<SweepProgress>,
    pub stopping: bool,
}

impl Running {
    pub fn new(number: u64, job: WorkKind) -> Self {
        Self {
            number,
            job,
            progress: None,
            stopping: false,
        }
    }

    pub fn poses(&self) -> Option<u64> {
        match &self.job {
            WorkKind::Sweep(grid) => Some(grid.poses()),
            WorkKind::Write(_, poses) => *poses,
        }
    }

    #[expect(clippy::cast_precision_loss, reason = "for reading")]
    pub fn rate(&self) -> Option<f64> {
        let SweepProgress { poses, elapsed } = self.progress?;
        let seconds = elapsed.as_secs_f64();
        (seconds > 0.0 && poses > 0).then(|| poses as f64 / seconds)
    }

    #[expect(clippy::cast_precision_loss, reason = "for reading")]
    pub fn left(&self) -> Option<f64> {
        let rest = self.poses()?.saturating_sub(self.progress?.poses);
        Some(rest as f64 / self.rate()?)
    }
}

const WIDEST: u16 = 60;

impl Page for Running {
    fn context(&self) -> Context {
        Context::Running
    }

    fn slot(&self) -> Slot {
        Slot::Body
    }

    fn draw(
        &self,
        theme: &Theme,
        _keymap: &Keymap,
        buffer: &mut Buffer,
        area: Rect,
    ) -> Option<Position> {
        let inner = write::right_of(area, area.x.saturating_add(2));
        let (title, end) = match &self.job {
            WorkKind::Sweep(grid) => (
                format!("Exploring: {}", name_of(grid.source())),
                "stopping keeps what is complete",
            ),
            WorkKind::Write(name, _) => {
                (format!("Writing {name}"), "stopping leaves no file behind")
            }
        };
        // On a low screen, there are no blank lines between them.
        let spaced = usize::from(area.height >= 9);
        let row = |index: usize| write::row(inner, index * (1 + spaced));
        write::text(buffer, row(0), theme, &title, Role::Title);
        let done = self.progress.map_or(0, |progress| progress.poses);
        if let Some(all) = self.poses() {
            let percent = u128::from(done) * 100 / u128::from(all.max(1));
            let all_of_them = counted(all, "pose");
            let text = format!("{} of {all_of_them}, {percent} %", grouped(done));
            write::text(buffer, row(1), theme, &text, Role::Text);
            gauge(theme, done, all, buffer, row(2));
        }
        let time = speed(self);
        write::text(buffer, row(3), theme, &time, Role::Text);
        let end = if self.stopping {
            "stopping; Ctrl-C quits at once"
        } else {
            end
        };
        write::text(buffer, row(4), theme, end, Role::Quiet);
        None
    }

    fn awaits_work(&self) -> bool {
        true
    }

    fn cancels_itself(&self) -> bool {
        true
    }
}

pub(in crate::tui) fn gauge(theme: &Theme, done: u64, all: u64, buffer: &mut Buffer, row: Rect) {
    let [full, _, empty] = theme.bar();
    let width = row.width.min(WIDEST);
    let filled = u128::from(done) * u128::from(width) / u128::from(all.max(1));
    let filled = u16::try_from(filled).unwrap_or(width).min(width);
    let text = |character: char, count: u16| character.to_string().repeat(count.into());
    let (done, rest) = (text(full, filled), text(empty, width - filled));
    let pieces = [(done.as_str(), Role::Chosen), (rest.as_str(), Role::Quiet)];
    write::line(buffer, row, theme, pieces);
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "saturates"
)]
fn speed(running: &Running) -> String {
    let Some(rate) = running.rate() else {
        return String::new();
    };
    let left = running
        .left()
        .and_then(|left| Duration::try_from_secs_f64(left).ok());
    let left = left.map_or(String::new(), |left| format!(", {} left", about(left)));
    format!("{} poses a second{left}", grouped(rate as u64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn rate_and_time_left_follow_the_progress() {
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
