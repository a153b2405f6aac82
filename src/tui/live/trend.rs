//! Force and contact over the history, as bars below the taxels.
//!
//! ```text
//! force  0 to 5000 kPa
//!       ▄██▄
//! ▄▄▄▄█████████▄      a column a frame; if not all fit, a column for the most of 2, 4, 8, … frames
//! ```

use std::collections::VecDeque;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use taxel_core::frame::Processed;
use taxel_files::formats::value::measured;

use crate::tui::live::{Live, round_up};
use crate::tui::widget::write::{self, narrow, whole};
use crate::tui::widget::{Role, Theme};

/// The lines of the least plot: its title and two lines of bars.
pub(super) const LEAST: u16 = 3;

/// Force and contact of the newest frames; NaN for a frame that cannot be processed.
#[derive(Clone, Debug, Default)]
pub struct Trend(pub(crate) VecDeque<[f64; 2]>);

impl Trend {
    pub fn push(&mut self, processed: Option<&Processed<'_>>) {
        let numbers = processed.map(|own| [own.force, own.contact.into()]);
        self.0.push_back(numbers.unwrap_or([f64::NAN; 2]));
    }

    /// Forgets the oldest frames beyond this number of the newest ones.
    pub fn keep(&mut self, frames: u64) {
        while self.0.len() as u64 > frames {
            self.0.pop_front();
        }
    }

    /// Returns the numbers of the frames in which a touch begins; the next frame has the number `next`.
    pub fn touches(&self, next: u64) -> Vec<u64> {
        let first = next - (self.0.len() as u64).min(next);
        let is_touched = |index: usize| self.0[index][1] > 0.0;
        let begins = |&index: &usize| is_touched(index) && !is_touched(index - 1);
        let begun = (1..self.0.len()).filter(begins);
        begun.map(|index| first + index as u64).collect()
    }

    /// Returns the most of each column (of the force, 0, or the contact, 1), the number of the first frame in the history, and the frames of a column. Columns
    /// begin at multiples of these, so that bars stay as they are while frames come.
    fn columns(&self, plotted: usize, next: u64, width: u16) -> (Vec<f64>, u64, u64) {
        let first = next - (self.0.len() as u64).min(next);
        let mut each = 1;
        while next.saturating_sub(1) / each - first / each >= u64::from(width) {
            each *= 2;
        }
        let mut columns: Vec<f64> = Vec::new();
        for (number, values) in (first..).zip(&self.0) {
            let value = values[plotted];
            match columns.last_mut() {
                Some(last) if !number.is_multiple_of(each) => *last = last.max(value),
                _ => columns.push(value),
            }
        }
        (columns, first, each)
    }
}

/// Draws the bars, with the column of a frozen frame reversed.
pub fn draw(live: &Live, theme: &Theme, buffer: &mut Buffer, area: Rect) {
    let next = live.history.numbers().end;
    let (columns, first, each) = live.trend.columns(live.plotted, next, area.width);
    let top = round_up(columns.iter().copied().fold(0.0, f64::max));
    let (name, unit) = match live.plotted {
        0 => ("force", live.unit()),
        _ => ("contact", " taxels".to_owned()),
    };
    let scale = format!("  0 to {}{unit}", measured(top, 9));
    let pieces = [(name, Role::Key), (&*scale, Role::Quiet)];
    write::line(buffer, write::row(area, 0), theme, pieces);
    let bars = write::below(area, 1);
    let frozen = live.history.behind();
    let frozen = frozen.map(|back| next.saturating_sub(back + 1));
    let frozen = frozen.and_then(|shown| (shown / each).checked_sub(first / each));
    for (x, value) in (0..).zip(columns) {
        let style = theme.style(if frozen == Some(x) {
            Role::Focus
        } else {
            Role::Text
        });
        let halves = height(value / top, bars.height);
        for line in 0..bars.height {
            let below = 2 * (bars.height - 1 - line);
            let sign = match halves.saturating_sub(below) {
                0 => ' ',
                1 => theme.half(false, true),
                _ => theme.half(true, true),
            };
            let at = (bars.x + narrow(x), bars.y + line);
            write::sign(buffer, at, sign, style);
        }
    }
}

/// Returns the height of a bar in half lines: at least one for any value above 0.
fn height(share: f64, lines: u16) -> u16 {
    let halves = whole((share * 2.0 * f64::from(lines)).round());
    halves.max(u16::from(share > 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_stay_while_frames_come_and_hold_the_most_of_their_frames() {
        let mut trend = Trend::default();
        let mut add = |value: f64| trend.0.push_back([value, 1.0]);
        for value in [1.0, f64::NAN, 5.0, 2.0, 0.0, 7.0, 3.0] {
            add(value);
        }
        // Frames 3 to 9, of which two at a time share a column: 3, 4 5, 6 7, 8 9.
        let found = trend.columns(0, 10, 4);
        assert_eq!(found, (vec![1.0, 5.0, 2.0, 7.0], 3, 2));
        assert_eq!(trend.columns(1, 10, 7).0, [1.0; 7]);
        assert_eq!(
            [0.0, 0.01, 0.5, 1.0].map(|share| height(share, 4)),
            [0, 1, 4, 8]
        );
        trend.keep(2);
        assert_eq!(trend.columns(0, 10, 4), (vec![7.0, 3.0], 8, 1));
    }
}
