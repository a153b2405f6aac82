//! Lines of dots finer than characters: eight dots a character in Braille. If the terminal has no Braille, lines are
//! shown as strokes.

use crate::tui::widget::Theme;
use crate::tui::widget::write::{narrow, whole};

pub const DOTS: (u16, u16) = (2, 4);

const BITS: [[u8; 2]; 4] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];

pub type DotPosition = (f64, f64);

#[derive(Clone, Debug)]
pub struct DotCanvas {
    columns: u16,
    rows: u16,
    characters: Vec<u8>,
}

impl DotCanvas {
    pub fn new(columns: u16, rows: u16) -> Self {
        let count = usize::from(columns) * usize::from(rows);
        Self {
            columns,
            rows,
            characters: vec![0; count],
        }
    }

    pub fn size(&self) -> DotPosition {
        let (across, down) = DOTS;
        (
            f64::from(self.columns) * f64::from(across),
            f64::from(self.rows) * f64::from(down),
        )
    }

    pub fn set(&mut self, (x, y): DotPosition) {
        let (width, height) = self.size();
        if !(x >= 0.0 && y >= 0.0 && x < width && y < height) {
            return;
        }
        let (x, y) = (usize::from(whole(x)), usize::from(whole(y)));
        let (across, down) = (usize::from(DOTS.0), usize::from(DOTS.1));
        let index = y / down * usize::from(self.columns) + x / across;
        self.characters[index] |= BITS[y % down][x % across];
    }

    pub fn line(&mut self, from: DotPosition, to: DotPosition) {
        self.dashed(from, to, |_| true);
    }

    pub fn dashed(&mut self, from: DotPosition, to: DotPosition, shown: impl Fn(u32) -> bool) {
        let Some((from, to)) = clipped(from, to, self.size()) else {
            return;
        };
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let steps: u32 = whole(dx.abs().max(dy.abs()).ceil().max(1.0)).into();
        for step in (0..=steps).filter(|&step| shown(step)) {
            let share = f64::from(step) / f64::from(steps);
            self.set((from.0 + dx * share, from.1 + dy * share));
        }
    }

    pub fn characters(&self) -> impl Iterator<Item = (u16, u16, u8)> {
        let columns = usize::from(self.columns.max(1));
        let all = self.characters.iter().enumerate();
        all.filter(|(_, dots)| **dots != 0)
            .map(move |(index, &dots)| (narrow(index % columns), narrow(index / columns), dots))
    }
}

fn clipped(
    from: DotPosition,
    to: DotPosition,
    (width, height): DotPosition,
) -> Option<(DotPosition, DotPosition)> {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let (mut start, mut end) = (0.0_f64, 1.0_f64);
    // For each border: how fast the line leaves through it, and how far inside it starts.
    for (speed, inside) in [
        (-dx, from.0),
        (dx, width - from.0),
        (-dy, from.1),
        (dy, height - from.1),
    ] {
        if speed == 0.0 && inside >= 0.0 {
            continue;
        }
        let at = inside / speed;
        if speed < 0.0 {
            start = start.max(at);
        } else if speed > 0.0 {
            end = end.min(at);
        } else {
            return None;
        }
    }
    let at = |share: f64| (from.0 + dx * share, from.1 + dy * share);
    (start <= end).then(|| (at(start), at(end)))
}

pub fn glyph(theme: &Theme, dots: u8) -> char {
    if !theme.ascii && !theme.console {
        return char::from_u32(0x2800 + u32::from(dots)).unwrap_or(' ');
    }
    let rows =
        |column: usize| (0..4_u8).filter(move |&row| dots & BITS[usize::from(row)][column] != 0);
    let mean = |column: usize| {
        let count = rows(column).count();
        (count > 0).then(|| rows(column).map(f64::from).sum::<f64>() / f64::from(narrow(count)))
    };
    let lowest = rows(0).chain(rows(1)).min();
    let highest = rows(0).chain(rows(1)).max();
    match (mean(0), mean(1)) {
        (None, None) => ' ',
        (Some(row), None) | (None, Some(row)) => match (lowest == highest, row < 2.0) {
            (true, true) => '\'',
            (true, false) => '.',
            (false, _) => '|',
        },
        (Some(left), Some(right)) if left > right => '/',
        (Some(left), Some(right)) if left < right => '\\',
        (Some(row), Some(_)) if row > 2.5 => '_',
        (Some(_), Some(_)) if rows(0).count() > 2 => '#',
        (Some(_), Some(_)) => '-',
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(ascii: bool, from: DotPosition, to: DotPosition) -> String {
        let mut canvas = DotCanvas::new(3, 2);
        canvas.line(from, to);
        let mut text = vec![vec![' '; 3]; 2];
        for (column, row, dots) in canvas.characters() {
            text[usize::from(row)][usize::from(column)] = glyph(&Theme::plain(ascii), dots);
        }
        let rows = text.iter().map(|row| row.iter().collect::<String>());
        rows.collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn lines_are_drawn_as_dots_or_strokes() {
        assert_eq!(drawn(false, (0.0, 0.5), (5.9, 0.5)), "⠉⠉⠉\n   ");
        assert_eq!(drawn(true, (0.0, 1.5), (5.9, 1.5)), "---\n   ");
        assert_eq!(drawn(true, (0.0, 3.5), (5.9, 3.5)), "___\n   ");
        assert_eq!(drawn(false, (2.5, 0.0), (2.5, 7.9)), " ⡇ \n ⡇ ");
        assert_eq!(drawn(true, (2.5, 0.0), (2.5, 7.9)), " | \n | ");
        assert_eq!(drawn(true, (0.0, 3.9), (1.9, 0.0)), "/  \n   ");
        assert_eq!(drawn(true, (0.0, 0.0), (1.9, 3.9)), "\\  \n   ");
    }

    #[test]
    fn dots_outside_or_at_nan_are_not_set() {
        let beyond = drawn(false, (-1e9, 0.5), (1e9, 0.5));
        assert_eq!(beyond, "⠉⠉⠉\n   ", "the visible part of a long line");
        for far in [f64::NAN, f64::INFINITY, -1e9] {
            assert_eq!(drawn(false, (far, far), (far, 1.0)).trim(), "", "{far}");
        }
    }
}
