//! A curve in an area of the screen: a share of touches over sizes, with its axes, a level and a cursor.
//!
//! ```text
//!  60 % |⠉⠢⢄               the end of the axis, and its middle
//!  30 % |   ⠈⠑⠢⢄⡀
//!   0 % |.........⠈⠉⠒⠤     dots at the level
//!        0.5  1  1.5  2
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::formats::value::decimal;
use crate::tui::widget::dots::{DotCanvas, Place, glyph};
use crate::tui::widget::number::narrow;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

/// Columns beside the plane: a share in percent and the axis.
const MARGIN: u16 = 8;

/// A curve.
#[derive(Clone, Copy, Debug)]
pub struct Curve<'a> {
    /// Its points: a value and a share, in the order of the line.
    pub points: &'a [Place],
    /// The values along the axis, in ascending order, where marks may stand.
    pub values: &'a [f64],
    /// A share that is marked.
    pub level: f64,
    /// The value under the cursor.
    pub at: Option<f64>,
}

impl Curve<'_> {
    /// Draws it. Nothing where there is no room.
    pub fn draw(&self, theme: &Theme, buffer: &mut Buffer, area: Rect) {
        let (Some(&first), Some(&last)) = (self.values.first(), self.values.last()) else {
            return;
        };
        if area.width <= MARGIN + 4 || area.height < 3 {
            return;
        }
        let plane = Rect {
            height: area.height - 1,
            ..write::right_of(area, area.x + MARGIN)
        };
        let most = self.points.iter().map(|point| point.1).fold(0.0, f64::max);
        let top = rounded_up(most.max(self.level));
        let canvas = || DotCanvas::new(plane.width, plane.height);
        let (width, height) = canvas().size();
        let span = if last > first { last - first } else { 1.0 };
        let place = |(value, share): Place| {
            (
                (value - first) / span * (width - 1.0) + 0.5,
                (1.0 - share / top) * (height - 1.0) + 0.5,
            )
        };
        let mut marks = canvas();
        let (left, right) = (
            place((first, self.level)),
            place((first + span, self.level)),
        );
        marks.dashed(left, right, |step| step % 4 == 0);
        if let Some(at) = self.at {
            marks.dashed(place((at, top)), place((at, 0.0)), |step| step % 2 == 0);
        }
        put(theme, &marks, Role::Quiet, buffer, plane);
        let mut line = canvas();
        for pair in self.points.windows(2) {
            line.line(place(pair[0]), place(pair[1]));
        }
        if let [only] = self.points {
            line.set(place(*only));
        }
        put(theme, &line, Role::Chosen, buffer, plane);
        shares(theme, top, buffer, area, plane.height);
        let column = |value: f64| {
            let share = (value - first) / span;
            plane.x + narrow_of(share * f64::from(plane.width - 1))
        };
        let row = write::row(area, usize::from(plane.height));
        marks_below(theme, self.values, &column, buffer, row);
    }
}

/// The number of a column.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "saturates"
)]
fn narrow_of(columns: f64) -> u16 {
    columns.round() as u16
}

/// The next share of one digit, at most 1; above 0.
fn rounded_up(share: f64) -> f64 {
    if share <= 0.0 {
        return 1.0;
    }
    let step = 10_f64.powf(share.log10().floor());
    // A hair for the roundings of the logarithm.
    ((share / step - 1e-9).ceil() * step).min(1.0)
}

/// The dots of a canvas over what is there.
fn put(theme: &Theme, canvas: &DotCanvas, role: Role, buffer: &mut Buffer, plane: Rect) {
    for (column, row, dots) in canvas.characters() {
        if let Some(cell) = buffer.cell_mut(Position::new(plane.x + column, plane.y + row)) {
            cell.reset();
            cell.set_char(glyph(theme, dots))
                .set_style(theme.style(role));
        }
    }
}

/// The axis of shares: its top, its middle and 0.
fn shares(theme: &Theme, top: f64, buffer: &mut Buffer, area: Rect, lines: u16) {
    let last = lines - 1;
    for line in 0..lines {
        let share = match line {
            0 => Some(top),
            _ if line == last => Some(0.0),
            // Where the middle is that of a line.
            _ if 2 * line == last => Some(top / 2.0),
            _ => None,
        };
        let label = share.map(|share| format!("{} %", decimal(100.0 * share, 3)));
        let label = label.map_or(String::new(), |label| label);
        let text = format!("{label:>6} |");
        let row = Rect {
            width: MARGIN,
            ..write::row(area, line.into())
        };
        write::line(buffer, row, theme, [(text.as_str(), Role::Quiet)]);
    }
}

/// The values below the plane, as many as have room.
fn marks_below(
    theme: &Theme,
    values: &[f64],
    column: &dyn Fn(f64) -> u16,
    buffer: &mut Buffer,
    row: Rect,
) {
    let labels: Vec<String> = values.iter().map(|&value| decimal(value, 6)).collect();
    let longest = labels.iter().map(String::len).fold(1, usize::max);
    let room = usize::from(row.width.saturating_sub(MARGIN)) / (longest + 2);
    let step = values.len().div_ceil(room.max(1)).max(1);
    for (value, label) in values.iter().zip(&labels).step_by(step) {
        let width = narrow(label.len());
        let x = column(*value).saturating_sub(width / 2);
        let x = x.min(row.right().saturating_sub(width));
        let place = write::right_of(row, x);
        write::line(buffer, place, theme, [(label.as_str(), Role::Quiet)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_ends_at_a_share_of_one_digit() {
        for (share, top) in [
            (0.62, 0.7),
            (0.6, 0.6),
            (0.013, 0.02),
            (0.0, 1.0),
            (1.0, 1.0),
        ] {
            assert!((rounded_up(share) - top).abs() < 1e-12, "{share}");
        }
    }

    #[test]
    fn a_falling_curve_has_axes_a_level_and_a_cursor() {
        let area = Rect::new(0, 0, 30, 6);
        let mut buffer = Buffer::empty(area);
        let curve = Curve {
            points: &[(0.5, 0.6), (1.0, 0.3), (2.0, 0.0)],
            values: &[0.5, 1.0, 1.5, 2.0],
            level: 0.3,
            at: Some(1.5),
        };
        curve.draw(&Theme::plain(true), &mut buffer, area);
        let rows: Vec<String> = (0..area.height)
            .map(|y| (0..area.width).map(|x| buffer[(x, y)].symbol()).collect())
            .collect();
        assert!(rows[0].starts_with("  60 % |\\"), "{rows:#?}");
        assert!(rows[2].starts_with("  30 % |"), "{rows:#?}");
        assert!(rows[4].starts_with("   0 % |"), "{rows:#?}");
        assert_eq!(
            rows[5].split_whitespace().collect::<Vec<_>>(),
            ["0.5", "1", "1.5", "2"]
        );
        for small in [Rect::new(0, 0, 5, 5), Rect::new(0, 0, 30, 2)] {
            let mut empty = Buffer::empty(small);
            curve.draw(&Theme::plain(true), &mut empty, small);
            assert_eq!(empty, Buffer::empty(small));
        }
    }
}
