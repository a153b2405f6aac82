//! The heat map: the values of all taxels in shades or as numbers, and the edge of the imprint.
//!
//! ```text
//! ░░▒▒▒•▓•        two columns a taxel: the second column of a taxel at the edge of the imprint has a mark; or two
//!                 lines of four columns, and so on
//! ░▒▓•            half a character a taxel: the larger of two is drawn; with colours, both are. The mark stands beside
//!                 the imprint, so that no value of a touch is hidden
//!      6     7
//! 12  12   45•    numbers, with rulers
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use ratatui::style::Style;
use taxel_core::imprint::Imprint;
use taxel_core::matrix::Matrix;
use taxel_files::formats::value::measured;

use crate::tui::grid::{RULER, Window};
use crate::tui::keys::key::Arrow;
use crate::tui::live::reading::{HeatLayer, LiveReading};
use crate::tui::live::state::Live;
use crate::tui::live::trend;
use crate::tui::widget::shades;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write::{self, below, right_of};

pub(super) struct HeatMap<'a> {
    theme: &'a Theme,
    reading: &'a LiveReading,
    layer: HeatLayer,
    range: (f64, f64),
    grid: HeatGrid,
}

impl<'a> HeatMap<'a> {
    pub(super) fn of(live: &Live, reading: &'a LiveReading, theme: &'a Theme, area: Rect) -> Self {
        let size = (reading.values.columns(), reading.values.rows());
        Self {
            theme,
            reading,
            layer: live.layer,
            range: live.ends(),
            grid: HeatGrid::of(area, size, live.numbers, looked_at(live, reading)),
        }
    }

    /// Returns the taxel to look at to see hidden ones in a direction; None if none are hidden there.
    pub(super) fn beyond(&self, towards: Arrow, live: &Live) -> Option<(u8, u8)> {
        self.grid.beyond(towards, looked_at(live, self.reading))
    }

    /// Returns the legend of the mark on taxels; None if no taxel can have one.
    pub(super) fn legend(&self) -> Option<String> {
        let marked = match (self.layer, self.grid.form) {
            (_, CellForm::Number) => "active taxel",
            (HeatLayer::Imprint, _) => return None,
            (_, CellForm::Wide(_)) => "imprint edge",
            (_, CellForm::Half) => "near imprint",
        };
        let imprint = self.reading.imprint.as_ref()?;
        let any = !imprint.is_empty();
        any.then(|| format!("{} {marked}", shades::edge(self.theme)))
    }

    /// Returns the visible columns and rows, counted from 0; None if all are visible.
    pub(super) fn window(&self) -> Option<String> {
        let span = |axis: Window| {
            let last = axis.first + axis.count.saturating_sub(1);
            format!("{}-{last}", axis.first)
        };
        let (columns, rows) = (self.grid.columns, self.grid.rows);
        let is_whole = columns.is_whole() && rows.is_whole();
        (!is_whole && columns.count > 0 && rows.count > 0)
            .then(|| format!("columns {}, rows {}", span(columns), span(rows)))
    }

    pub(super) fn draw(&self, buffer: &mut Buffer, area: Rect) {
        let area = area.intersection(*buffer.area());
        self.draw_rulers(buffer, area);
        let (left, above) = self.grid.rulers;
        let area = below(right_of(area, area.x.saturating_add(left)), above);
        for (x, column) in self.grid.columns.visible() {
            for (y, row) in self.grid.rows.visible() {
                match self.grid.form {
                    CellForm::Wide(times) => {
                        let at = (2 * times * x, times * y);
                        self.wide(buffer, area, at, times, (column, row));
                    }
                    CellForm::Half if y % 2 == 0 => {
                        self.half(buffer, area, (x, y / 2), (column, row));
                    }
                    CellForm::Half => {}
                    CellForm::Number => self.number(buffer, area, (NUMBER * x, y), (column, row)),
                }
            }
        }
    }

    fn draw_rulers(&self, buffer: &mut Buffer, area: Rect) {
        let (left, above) = self.grid.rulers;
        if above > 0 {
            // The number of a column ends where its values end.
            let width = usize::from(NUMBER - 2);
            let columns = self.grid.columns.visible();
            let columns = columns.map(|(_, column)| format!("{column:>width$}  "));
            let text = " ".repeat(left.into()) + &columns.collect::<String>();
            let pieces = [(text.trim_end(), Role::Quiet)];
            write::line(buffer, write::row(area, 0), self.theme, pieces);
        }
        if left > 0 {
            for (y, row) in self.grid.rows.visible() {
                let place = write::row(area, usize::from(y + above));
                let text = format!("{row:>2}");
                write::text(buffer, place, self.theme, &text, Role::Quiet);
            }
        }
    }

    /// Returns the value of a taxel as a share of the range; NaN if there is no cell.
    fn share(&self, column: u8, row: u8) -> f64 {
        let value = self.reading.values.get(column, row);
        let (low, high) = self.range;
        value.map_or(f64::NAN, |value| (value - low) / (high - low))
    }

    fn taxel(&self, column: u8, row: u8) -> (char, Style) {
        let share = self.share(column, row);
        match (self.layer, &self.reading.imprint) {
            (HeatLayer::Imprint, Some(imprint)) => {
                let role = match (imprint.get(column, row), self.reading.main.get(column, row)) {
                    (true, true) => Role::Chosen,
                    (true, false) => Role::Active,
                    (false, _) => Role::Inactive,
                };
                let [sign, _] = self.theme.taxel(role);
                let sign = if share.is_nan() { ' ' } else { sign };
                (sign, self.theme.style(role))
            }
            _ => (
                shades::shade(self.theme, share),
                shades::style(self.theme, share),
            ),
        }
    }

    /// Returns true if a taxel is marked because it is at the edge of the imprint. The imprint layer has no marks.
    fn is_marked(&self, column: u8, row: u8) -> bool {
        let imprint = self.reading.imprint.as_ref();
        self.layer != HeatLayer::Imprint
            && imprint.is_some_and(|imprint| is_edge(imprint, column, row))
    }

    fn is_beside(&self, column: u8, row: u8) -> bool {
        let Some(imprint) = &self.reading.imprint else {
            return false;
        };
        let active = |column: Option<u8>, row: Option<u8>| {
            let inside = column
                .zip(row)
                .filter(|&(column, row)| column < imprint.columns() && row < imprint.rows());
            inside.is_some_and(|(column, row)| imprint.get(column, row))
        };
        let both =
            |column: Option<u8>| active(column, Some(row)) || active(column, row.checked_add(1));
        let near = both(column.checked_sub(1))
            || both(column.checked_add(1))
            || active(Some(column), row.checked_sub(1))
            || active(Some(column), row.checked_add(2));
        near && !both(Some(column))
    }

    /// Draws a taxel that is two columns wide, or a multiple of that in several lines. All characters are the same,
    /// except the mark of the edge in the middle. A low taxel is a single character, so that an area without touch
    /// looks less dense than a touch.
    fn wide(
        &self,
        buffer: &mut Buffer,
        area: Rect,
        at: (u16, u16),
        times: u16,
        (column, row): (u8, u8),
    ) {
        let (sign, style) = self.taxel(column, row);
        let is_single = matches!(sign, '·' | '.') && self.is_low(column, row);
        let filled = if is_single { ' ' } else { sign };
        let middle = (at.0 + times, at.1 + times / 2);
        for y in 0..times {
            for x in 0..2 * times {
                put(buffer, area, (at.0 + x, at.1 + y), filled, style);
            }
        }
        put(buffer, area, (middle.0 - 1, middle.1), sign, style);
        if self.is_marked(column, row) {
            put(buffer, area, middle, shades::edge(self.theme), style);
        }
    }

    /// Returns true if a taxel counts as low: not active in the imprint layer, otherwise at most at the lower end of
    /// the range.
    fn is_low(&self, column: u8, row: u8) -> bool {
        match (self.layer, &self.reading.imprint) {
            (HeatLayer::Imprint, Some(imprint)) => !imprint.get(column, row),
            _ => self.share(column, row) <= 0.0,
        }
    }

    /// Draws two taxels in one character: one above the other with colours; without colours only the larger one, so
    /// that no touch disappears. With an odd number of rows, the last character has an upper taxel only.
    fn half(&self, buffer: &mut Buffer, area: Rect, at: (u16, u16), (column, row): (u8, u8)) {
        let has_lower = row + 1 < self.reading.values.rows();
        let upper = self.share(column, row);
        let lower = if has_lower {
            self.share(column, row + 1)
        } else {
            f64::NAN
        };
        let larger = if lower > upper || upper.is_nan() && !lower.is_nan() {
            row + 1
        } else {
            row
        };
        let (sign, style) = self.taxel(column, larger);
        let marked = self.is_beside(column, row);
        if self.layer == HeatLayer::Imprint && self.reading.imprint.is_some() {
            let active =
                |row| (self.reading.imprint.as_ref()).is_some_and(|own| own.get(column, row));
            let style = if active(row) || active(row + 1) {
                self.theme.style(Role::Chosen)
            } else {
                self.theme.style(Role::Inactive)
            };
            let sign = self.theme.half(active(row), active(row + 1));
            return put(buffer, area, at, sign, style);
        }
        if marked {
            return put(buffer, area, at, shades::edge(self.theme), style);
        }
        if shades::has_halves(self.theme) {
            let colors = [upper, lower].map(|share| shades::color(self.theme, share));
            let (sign, style) = match colors {
                [Some(upper), Some(lower)] => ('▀', Style::new().fg(upper).bg(lower)),
                [Some(upper), None] => ('▀', Style::new().fg(upper)),
                [None, Some(lower)] => ('▄', Style::new().fg(lower)),
                [None, None] => (sign, style),
            };
            return put(buffer, area, at, sign, style);
        }
        put(buffer, area, at, sign, style);
    }

    /// Draws a taxel as a number. A number that is too wide becomes arrows, up or down by its sign; a cell without a
    /// value stays empty.
    fn number(&self, buffer: &mut Buffer, area: Rect, at: (u16, u16), (column, row): (u8, u8)) {
        let Some(value) = self.reading.values.get(column, row) else {
            return;
        };
        let width = usize::from(NUMBER - 2);
        let text = if value.is_nan() {
            String::new()
        } else {
            measured(value, width)
        };
        let text = if text.chars().count() > width {
            let arrows = if value > 0.0 { "^^^^" } else { "vvvv" };
            arrows.to_owned()
        } else {
            text
        };
        let mark = match &self.reading.imprint {
            Some(imprint) if imprint.get(column, row) => shades::edge(self.theme),
            _ => ' ',
        };
        let style = shades::style(self.theme, self.share(column, row));
        for (x, sign) in (at.0..).zip(format!("{text:>width$}{mark}").chars()) {
            put(buffer, area, (x, at.1), sign, style);
        }
    }
}

/// Returns the taxel that must be visible.
fn looked_at(live: &Live, reading: &LiveReading) -> (u8, u8) {
    live.looked_at.unwrap_or_else(|| near(reading))
}

/// Returns a taxel near the contact: the middle of the main region, or the largest value.
fn near(reading: &LiveReading) -> (u8, u8) {
    let middle = reading.main.bounds().map(|bounds| {
        let of = |side: std::ops::Range<u8>| side.start.midpoint(side.end);
        (of(bounds.columns()), of(bounds.rows()))
    });
    let largest = || reading.shown_max.map(|(_, at)| at);
    middle.or_else(largest).map_or((0, 0), |at| at)
}

fn is_edge(imprint: &Imprint, column: u8, row: u8) -> bool {
    let is_inside = column > 0
        && row > 0
        && imprint.get(column - 1, row)
        && imprint.get(column + 1, row)
        && imprint.get(column, row - 1)
        && imprint.get(column, row + 1);
    imprint.get(column, row) && !is_inside
}

/// Sets a character at a place counted from the corner of the area; does nothing outside of the area.
fn put(buffer: &mut Buffer, area: Rect, (x, y): (u16, u16), sign: char, style: Style) {
    let position = Position::new(area.x.saturating_add(x), area.y.saturating_add(y));
    if area.contains(position) {
        buffer[position].set_char(sign).set_style(style);
    }
}

/// Returns the scale of the shades: the lower end of the range, the shades, the upper end and the unit.
pub(super) fn scale(theme: &Theme, (low, high): (f64, f64), unit: &str) -> String {
    let shades: String = shades::shades(theme).iter().skip(1).collect();
    format!("{} {shades} {}{unit}", measured(low, 7), measured(high, 7))
}

pub(super) fn cells(values: &Matrix<f64>) -> usize {
    values
        .values()
        .iter()
        .filter(|value| !value.is_nan())
        .count()
}

const PANEL: u16 = 26;

const NARROW_PANEL: u16 = 18;

/// The number of columns for the numbers that must remain if taxels are enlarged.
const WIDE_PANEL: u16 = 44;

const GAP: u16 = 2;

/// The number of lines for the numbers below the heat map; at most half of all lines.
const LOW_PANEL: u16 = 7;

pub(super) const NUMBER: u16 = 6;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CellForm {
    Wide(u16),
    Half,
    Number,
}

impl CellForm {
    /// Returns the columns and lines of the screen that a taxel takes; one each for two taxels that share a
    /// character.
    fn size(self) -> (u16, u16) {
        match self {
            Self::Wide(times) => (2 * times, times),
            Self::Half => (1, 1),
            Self::Number => (NUMBER, 1),
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct HeatGrid {
    /// The form of all taxels; it is the same within a map.
    pub(super) form: CellForm,
    pub(super) columns: Window,
    pub(super) rows: Window,
    /// The columns of the row ruler and the lines of the column ruler, before the first taxel; 0 without a ruler.
    pub(super) rulers: (u16, u16),
}

impl HeatGrid {
    pub(super) fn of(area: Rect, (columns, rows): (u8, u8), numbers: bool, near: (u8, u8)) -> Self {
        let times = (area.width / (2 * u16::from(columns))).min(area.height / u16::from(rows));
        let form = match times {
            _ if numbers => CellForm::Number,
            0 => CellForm::Half,
            times => CellForm::Wide(times),
        };
        let (wide, high) = form.size();
        let rulers = if form == CellForm::Number {
            let across = ruler(u16::from(columns) * wide, area.width, RULER, wide);
            (across, ruler(u16::from(rows), area.height, 1, 1))
        } else {
            (0, 0)
        };
        let (width, lines) = (area.width - rulers.0, area.height - rulers.1);
        let columns = Window::showing(columns, width / wide, near.0..near.0 + 1, 1);
        // The same two taxels share a character while the window moves.
        let (step, lines) = match form {
            CellForm::Half => (2, lines.saturating_mul(2)),
            _ => (1, lines / high),
        };
        let rows = Window::showing(rows, lines, near.1..near.1 + 1, step);
        Self {
            form,
            columns,
            rows,
            rulers,
        }
    }

    /// Returns the nearest hidden taxel in a direction from a given one; None if there is none.
    pub(super) fn beyond(&self, towards: Arrow, (column, row): (u8, u8)) -> Option<(u8, u8)> {
        let next = |axis: Window| {
            let (before, after) = axis.hidden();
            let last = axis.first + axis.count;
            (before.then(|| axis.first - 1), after.then_some(last))
        };
        let (columns, rows) = (next(self.columns), next(self.rows));
        match towards {
            Arrow::Left => Some((columns.0?, row)),
            Arrow::Right => Some((columns.1?, row)),
            Arrow::Up => Some((column, rows.0?)),
            Arrow::Down => Some((column, rows.1?)),
        }
    }

    fn visible(&self) -> u16 {
        u16::from(self.columns.count) * u16::from(self.rows.count)
    }

    fn height(&self) -> u16 {
        let rows = u16::from(self.rows.count);
        self.rulers.1
            + match self.form {
                CellForm::Half => rows.div_ceil(2),
                _ => rows * self.form.size().1,
            }
    }

    fn width(&self) -> u16 {
        self.rulers.0 + u16::from(self.columns.count) * self.form.size().0
    }
}

/// Returns the columns or lines that a ruler takes: 0 if the ruler alone would hide a taxel, or if no taxel would
/// fit.
fn ruler(taxels: u16, side: u16, ruler: u16, taxel: u16) -> u16 {
    let hides = taxels <= side && side < taxels + ruler;
    if hides || side < ruler + taxel {
        0
    } else {
        ruler
    }
}

/// A taxel is two columns wide, or a multiple of that, if all fit; otherwise it is half a character, so that two stand
/// above each other. If not all fit even then, a window follows the contact until keys move it.
#[derive(Clone, Copy, Debug)]
pub(super) struct LivePanes {
    /// The title line: the source and the frame.
    pub(super) title: Rect,
    pub(super) map: Rect,
    /// The numbers; a low screen shows only the first of them.
    pub(super) panel: Rect,
    /// The lines below the title that the taxels take.
    pub(super) taxels: u16,
}

impl LivePanes {
    pub(super) fn of(area: Rect, size: Option<(u8, u8)>, numbers: bool) -> Self {
        let title = Rect {
            height: area.height.min(1),
            ..area
        };
        let rest = below(area, 1);
        let Some(size) = size else {
            let map = Rect { width: 0, ..rest };
            return Self {
                title,
                map,
                panel: rest,
                taxels: rest.height,
            };
        };
        let narrow = rest.width < 2 * PANEL;
        let least = if narrow { NARROW_PANEL } else { PANEL };
        let room = |panel: u16| Rect {
            width: rest.width.saturating_sub(GAP + panel),
            ..rest
        };
        let map_above = Rect {
            height: rest.height - LOW_PANEL.min(rest.height / 2),
            ..rest
        };
        let grid = |area: Rect| HeatGrid::of(area, size, numbers, (0, 0));
        let beside = grid(room(least));
        if narrow && grid(map_above).visible() >= beside.visible() {
            return Self {
                title,
                map: map_above,
                panel: below(rest, map_above.height),
                taxels: rest.height,
            };
        }
        let large = grid(room(WIDE_PANEL));
        let width = match (large.form, beside.form) {
            (CellForm::Wide(_), _) => large.width(),
            (_, CellForm::Wide(_)) => 2 * u16::from(size.0),
            _ => beside.width(),
        };
        let map = Rect { width, ..rest };
        Self {
            title,
            map,
            panel: right_of(rest, rest.x + width + GAP),
            taxels: grid(map).height(),
        }
    }

    /// Returns the part below the taxels for a plot, and the part that is left of the panel: the plot is as wide as the
    /// page if this number of lines fits beside the taxels. None if there is no room.
    pub(super) fn plot(&self, lines: usize) -> Option<(Rect, Rect)> {
        let below_taxels = below(self.map, self.taxels);
        if below_taxels.height < trend::LEAST {
            return None;
        }
        if lines > self.taxels.into() {
            return Some((below_taxels, self.panel));
        }
        let plot = Rect {
            width: self.title.width,
            ..below_taxels
        };
        let panel = Rect {
            height: self.taxels,
            ..self.panel
        };
        Some((plot, panel))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_row_of_an_odd_number_is_visible() {
        let area = Rect::new(0, 0, 40, 22);
        let visible = |near: u8| {
            let rows = HeatGrid::of(area, (40, 63), false, (0, near)).rows;
            (rows.first, rows.first + rows.count - 1)
        };
        assert_eq!(visible(62), (20, 62));
        assert!((0..63).all(|near| {
            let (first, last) = visible(near);
            first % 2 == 0 && (first..=last).contains(&near)
        }));
    }
}
