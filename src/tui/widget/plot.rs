//! Two axes with numbers, around a field of dots.
//!
//! ```text
//! p                             the label of the upward axis
//! 24 ┤      ⣀⠤⠒⠉               its numbers; the field: lines of eight dots a character, or points,
//! 22 ┤  · o@O                   of which many may share a character: a mark says about how many
//!    └────┬────┬────
//!        18   20     na         the numbers of the other axis, and its label
//! ```
//! Numbers without room are left out. If the terminal has no Braille, lines are shown as strokes.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use ratatui::style::Style;
use taxel_files::formats::axis_marks;

use crate::tui::widget::write::{self, narrow, whole};
use crate::tui::widget::{Role, Theme};

const APART: u16 = 10;
const LINES: u16 = 2;

#[derive(Clone, Debug)]
pub struct PlotField {
    pub field: Rect,
    x: (f64, f64),
    y: (f64, f64),
    upwards: Vec<(f64, String)>,
    area: Rect,
}

impl PlotField {
    pub fn of(area: Rect, x: (f64, f64), y: (f64, f64)) -> Option<Self> {
        let height = area.height.checked_sub(3).filter(|&height| height > 0)?;
        let upwards = axis_marks(y, 0.0, (height / LINES).max(1));
        let labels = upwards.iter().map(|(_, label)| write::width(label));
        let indent = narrow(labels.fold(0, usize::max) + 2);
        let width = area.width.checked_sub(indent).filter(|&width| width > 0)?;
        Some(Self {
            field: Rect {
                x: area.x + indent,
                y: area.y + 1,
                width,
                height,
            },
            x,
            y,
            upwards,
            area,
        })
    }

    pub fn canvas(&self) -> DotCanvas {
        DotCanvas::new(self.field.width, self.field.height)
    }

    pub fn dot(&self, (x, y): (f64, f64)) -> DotPosition {
        let wide = f64::from(self.field.width) * f64::from(DOTS.0);
        let high = f64::from(self.field.height) * f64::from(DOTS.1);
        let share = |at: f64, (low, high): (f64, f64)| (at - low) / (high - low);
        (share(x, self.x) * wide, (1.0 - share(y, self.y)) * high)
    }

    pub fn character(&self, point: (f64, f64)) -> Option<Position> {
        let (x, y) = self.dot(point);
        let (x, y) = (x / f64::from(DOTS.0), y / f64::from(DOTS.1));
        let inside = (0.0..f64::from(self.field.width)).contains(&x)
            && (0.0..f64::from(self.field.height)).contains(&y);
        inside.then(|| Position::new(self.field.x + whole(x), self.field.y + whole(y)))
    }

    pub fn point(&self, at: Position) -> Option<(f64, f64)> {
        self.field.contains(at).then(|| {
            let middle =
                |at: u16, from: u16, length: u16| (f64::from(at - from) + 0.5) / f64::from(length);
            let right = middle(at.x, self.field.x, self.field.width);
            let down = middle(at.y, self.field.y, self.field.height);
            (
                self.x.0 + (self.x.1 - self.x.0) * right,
                self.y.1 - (self.y.1 - self.y.0) * down,
            )
        })
    }

    pub fn draw_axes(&self, theme: &Theme, buffer: &mut Buffer, [upward, right]: [&str; 2]) {
        write::text(buffer, self.area, theme, upward, Role::Key);
        let [across, down, corner] = theme.pick(['-', '|', '+'], ['─', '│', '└']);
        let (left, bottom) = (self.field.x - 1, self.field.bottom());
        let up = (self.field.y..bottom).map(|y| (left, y, down));
        let aside = (self.field.x..self.field.right()).map(|x| (x, bottom, across));
        for (x, y, sign) in up.chain(aside).chain([(left, bottom, corner)]) {
            write::sign(buffer, (x, y), sign, theme.style(Role::Quiet));
        }
        self.draw_upwards(theme, buffer);
        self.draw_across(theme, buffer, right);
    }

    /// Draws the marks and numbers of the upward axis; two numbers never share a line.
    fn draw_upwards(&self, theme: &Theme, buffer: &mut Buffer) {
        let left = self.field.x - 1;
        let middle = f64::midpoint(self.x.0, self.x.1);
        let mut last = None;
        for (value, text) in &self.upwards {
            let Some(at) = self.character((middle, *value)) else {
                continue;
            };
            let mark = theme.pick('+', '┤');
            write::sign(buffer, (left, at.y), mark, theme.style(Role::Quiet));
            if last != Some(at.y) {
                let room = usize::from(left - self.area.x).saturating_sub(1);
                let text = format!("{text:>room$}");
                let row = self.line_at(at.y);
                write::text(buffer, row, theme, &text, Role::Quiet);
            }
            last = Some(at.y);
        }
    }

    fn draw_across(&self, theme: &Theme, buffer: &mut Buffer, label: &str) {
        let bottom = self.field.bottom();
        let width = narrow(write::width(label));
        let end = self.area.right().saturating_sub(width);
        let below = self.line_at(bottom + 1);
        let place = write::right_of(below, end);
        write::text(buffer, place, theme, label, Role::Key);
        let middle = f64::midpoint(self.y.0, self.y.1);
        let mut free = self.area.x;
        for (value, text) in axis_marks(self.x, 0.0, self.field.width / APART) {
            let Some(at) = self.character((value, middle)) else {
                continue;
            };
            let mark = theme.pick('+', '┬');
            write::sign(buffer, (at.x, bottom), mark, theme.style(Role::Quiet));
            let width = narrow(write::width(&text));
            let from = at.x.saturating_sub(width / 2);
            if from >= free && from + width < end {
                let place = write::right_of(below, from);
                write::text(buffer, place, theme, &text, Role::Quiet);
                free = from + width + 1;
            }
        }
    }

    fn line_at(&self, y: u16) -> Rect {
        Rect {
            y,
            height: 1,
            ..self.area
        }
    }

    pub fn draw_lines(&self, theme: &Theme, buffer: &mut Buffer, canvas: &DotCanvas, style: Style) {
        for (column, row, dots) in canvas.characters() {
            let at = (self.field.x + column, self.field.y + row);
            write::sign(buffer, at, glyph(theme, dots), style);
        }
    }

    pub fn draw_points(
        &self,
        theme: &Theme,
        buffer: &mut Buffer,
        points: impl IntoIterator<Item = (f64, f64)>,
        style: Style,
    ) {
        let width = usize::from(self.field.width);
        let mut counts = vec![0_u32; width * usize::from(self.field.height)];
        for at in points.into_iter().filter_map(|point| self.character(point)) {
            let (column, row) = (at.x - self.field.x, at.y - self.field.y);
            counts[usize::from(row) * width + usize::from(column)] += 1;
        }
        let (one, to) = theme.pick(('.', '-'), ('·', '–'));
        for (at, count) in self.field.positions().zip(counts) {
            let mark = match count {
                0 => continue,
                1 => one,
                2..10 => 'o',
                10..100 => 'O',
                _ => '@',
            };
            write::sign(buffer, at.into(), mark, style);
        }
        let legend = format!("{one} 1   o 2{to}9   O 10{to}99   @ 100+");
        let width = narrow(write::width(&legend));
        // The label of the axis on the same line is only a word.
        if width < self.field.width {
            let place = write::right_of(self.line_at(self.area.y), self.area.right() - width);
            write::text(buffer, place, theme, &legend, Role::Quiet);
        }
    }
}

pub fn draw_no_room(theme: &Theme, buffer: &mut Buffer, page: Rect) {
    let text = "no room for the plot";
    write::text(buffer, write::row(page, 1), theme, text, Role::Quiet);
}

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

    fn shown(theme: Theme, area: Rect, points: &[(f64, f64)]) -> String {
        let mut buffer = Buffer::empty(area);
        let Some(field) = PlotField::of(area, (0.0, 10.0), (-1.0, 1.0)) else {
            return "no room".to_owned();
        };
        field.draw_axes(&theme, &mut buffer, ["up", "right"]);
        let style = theme.style(Role::Chosen);
        field.draw_points(&theme, &mut buffer, points.iter().copied(), style);
        let rows = area.rows().map(|row| {
            let cells = row.columns().map(|cell| buffer[(cell.x, cell.y)].symbol());
            cells.collect::<String>().trim_end().to_owned()
        });
        rows.collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn a_mark_shows_how_many_points_share_a_character() {
        let area = Rect::new(0, 0, 50, 9);
        let times = |count: usize, x: f64| std::iter::repeat_n((x, 0.0), count);
        let points: Vec<(f64, f64)> = [(1, 1.0), (9, 3.0), (10, 5.0), (99, 7.0), (100, 9.0)]
            .into_iter()
            .flat_map(|(count, x)| times(count, x))
            .collect();
        for (theme, marks, legend) in [
            (
                Theme::plain(true),
                ".oOO@",
                ". 1   o 2-9   O 10-99   @ 100+",
            ),
            (
                Theme::plain(false),
                "·oOO@",
                "· 1   o 2–9   O 10–99   @ 100+",
            ),
        ] {
            let plot = shown(theme, area, &points);
            let (head, field) = plot.split_once('\n').expect("lines");
            assert!(head.ends_with(legend), "{plot}");
            let found = field.chars().filter(|mark| marks.contains(*mark));
            assert_eq!(found.collect::<String>(), marks, "{plot}");
        }
    }

    #[test]
    fn characters_and_points_match_and_small_areas_are_safe() {
        let area = Rect::new(3, 2, 40, 12);
        let field = PlotField::of(area, (0.0, 10.0), (-1.0, 1.0)).expect("room");
        for place in field.field.positions() {
            let point = field.point(place).expect("inside");
            assert_eq!(field.character(point), Some(place));
        }
        assert_eq!(field.point(Position::new(0, 0)), None);
        assert_eq!(field.character((11.0, 0.0)), None);
        for width in 0..9 {
            for height in 0..9 {
                let shown = shown(
                    Theme::plain(false),
                    Rect::new(0, 0, width, height),
                    &[(1.0, 0.0)],
                );
                assert!(shown.lines().count() <= usize::from(height.max(1)));
            }
        }
    }

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
