//! A curve in an area of the screen: a share of touches against sizes, with axes, a level and a cursor.
//!
//! ```text
//! error in %
//! 60 ┤⠉⠢⢄
//! 30 ┤   ⠈⠑⠢⢄⡀
//!  0 ┤.........⠈⠉⠒⠤      dots at the level
//!    └┬────┬────┬───
//!    0.5   1   1.5  scale
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::formats::axis_ends;
use crate::tui::widget::plot::PlotField;
use crate::tui::widget::theme::{Role, Theme};

/// A curve.
#[derive(Clone, Copy, Debug)]
pub struct Curve<'a> {
    /// The labels of the upward axis and of the axis to the right.
    pub labels: [&'a str; 2],
    /// The points of the curve: a value and a share, in the order in which the line connects them.
    pub points: &'a [(f64, f64)],
    /// The values along the axis, in ascending order.
    pub values: &'a [f64],
    /// The share at which a dotted line is drawn.
    pub level: f64,
    /// The value under the cursor.
    pub at: Option<f64>,
}

impl Curve<'_> {
    /// Draws the curve, with shares in percent; draws nothing if there is no room.
    pub fn draw(&self, theme: &Theme, buffer: &mut Buffer, area: Rect) {
        let x = axis_ends(self.values.iter().copied());
        let percent = |(value, share): (f64, f64)| (value, 100.0 * share);
        let points = self.points.iter().map(|&point| percent(point));
        let points: Vec<(f64, f64)> = points.collect();
        let level = 100.0 * self.level;
        let shares = points.iter().map(|point| point.1);
        let y = axis_ends(shares.chain([0.0, level]));
        let Some(plot) = PlotField::of(area, x, y) else {
            return;
        };
        plot.draw_axes(theme, buffer, self.labels);
        let mut marks = plot.canvas();
        let dots = |ends: [(f64, f64); 2]| ends.map(|end| plot.dot(end));
        let [left, right] = dots([(x.0, level), (x.1, level)]);
        marks.dashed(left, right, |step| step % 4 == 0);
        if let Some(at) = self.at {
            let [top, foot] = dots([(at, y.1), (at, y.0)]);
            marks.dashed(top, foot, |step| step % 2 == 0);
        }
        let mut line = plot.canvas();
        for pair in points.windows(2) {
            line.line(plot.dot(pair[0]), plot.dot(pair[1]));
        }
        if let [only] = points[..] {
            line.set(plot.dot(only));
        }
        for (canvas, role) in [(&marks, Role::Quiet), (&line, Role::Chosen)] {
            let style = theme.style(role);
            plot.draw_lines(theme, buffer, canvas, style);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_falling_curve_has_axes_a_level_and_a_cursor() {
        let area = Rect::new(0, 0, 40, 12);
        let mut buffer = Buffer::empty(area);
        let curve = Curve {
            labels: ["error in %", "scale"],
            points: &[(0.5, 0.6), (1.0, 0.3), (2.0, 0.0)],
            values: &[0.5, 1.0, 1.5, 2.0],
            level: 0.3,
            at: Some(1.5),
        };
        curve.draw(&Theme::plain(true), &mut buffer, area);
        let rows: Vec<String> = (0..area.height)
            .map(|y| (0..area.width).map(|x| buffer[(x, y)].symbol()).collect())
            .collect();
        assert!(rows[0].starts_with("error in %"), "{rows:#?}");
        assert!(rows[1].contains('\\'), "{rows:#?}");
        assert!(rows.iter().any(|row| row.starts_with("40 +")), "{rows:#?}");
        assert!(rows.iter().any(|row| row.starts_with(" 0 +")), "{rows:#?}");
        assert!(rows[11].contains(" 1 ") && rows[11].trim_end().ends_with("scale"));
        for small in [Rect::new(0, 0, 3, 5), Rect::new(0, 0, 30, 2)] {
            let mut empty = Buffer::empty(small);
            curve.draw(&Theme::plain(true), &mut empty, small);
            assert_eq!(empty, Buffer::empty(small));
        }
    }
}
