//! The matrix with its rulers.
//!
//! ```text
//!    0   2   4   6           column ruler
//!  0 · · · · · · · ·         row ruler, then two characters for each taxel
//!  1 · · ████████· ·
//!  2 · · ██·[·]██· ·         the cursor between brackets, which hide second characters only
//! ```
//! A taxel of the described region, another active taxel, a taxel of a described hole and an inactive one differ in
//! their characters, not only in colour. If a matrix is larger than its pane, two of its rows share a line, by half
//! blocks; if that is not enough, it scrolls with the cursor and the described region. A matrix that is much smaller
//! than its pane is drawn larger, by a whole factor. Coverage is shown in five shades or in percent: two digits if a
//! taxel has room for a space beside them, otherwise the tens alone, so that numbers do not run together.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::description::{Region, RegionKind};
use taxel_core::imprint::{Bounds, Imprint};
use taxel_core::source::Source;

use crate::tui::app::document::Reading;
use crate::tui::app::page::{Page, PoseLayer};
use crate::tui::app::state::{App, Display};
use crate::tui::matrix::layers::{Layers, Overlay};
use crate::tui::matrix::layout::{TaxelGrid, TaxelSize};
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write::{self, narrow};

#[derive(Clone, Copy, Debug)]
pub struct MatrixView<'a> {
    pub reading: &'a Reading,
    pub pitch_mm: f64,
    pub cursor: (u8, u8),
    pub seen: Bounds,
    pub chosen: Option<usize>,
    pub display: Display,
    pub compared: Option<&'a Imprint>,
    pub source: Option<&'a Source>,
    pub layers: Layers,
    pub poses: PoseLayer<'a>,
}

impl<'a> MatrixView<'a> {
    pub fn of(app: &'a App) -> Self {
        Self {
            reading: app.reading(),
            pitch_mm: app.shown().sensor.pitch_mm(),
            cursor: app.cursor(),
            seen: app.seen(),
            chosen: app.chosen(),
            display: app.display,
            compared: app.pane().and_then(Page::compared_with),
            source: app.shown().source.as_ref(),
            layers: app.layers,
            poses: app.pane().map_or(PoseLayer::default(), Page::poses),
        }
    }

    fn grid(&self, area: Rect) -> TaxelGrid {
        let halves = self.display == Display::Imprint && self.compared.is_none();
        TaxelGrid::of(area, &self.reading.imprint, self.seen, halves)
    }

    pub fn draw(&self, theme: &Theme, buffer: &mut Buffer, area: Rect) -> Option<Position> {
        let grid = self.grid(area);
        draw(theme, &grid, buffer, area);
        let chosen = self.reading.region(self.chosen).map(|(_, region)| region);
        let role = |column, row| {
            let role = self.difference(column, row);
            role.unwrap_or_else(|| role_of(self.reading, chosen, column, row))
        };
        let rows = if grid.size == TaxelSize::Half { 2 } else { 1 };
        let mut cursor = None;
        for (y, row) in grid.rows.visible().step_by(rows) {
            for (x, column) in grid.columns.visible() {
                let place = grid.cell_rect(x, y);
                if grid.taxels(place.x, place.y).any(|at| at == self.cursor) {
                    cursor = Some(place);
                }
                let upper = role(column, row);
                if rows == 2 {
                    let (sign, role) = theme.two_taxels(upper, role(column, row + 1));
                    if let Some(cell) = buffer.cell_mut(place.as_position()) {
                        cell.set_char(sign).set_style(theme.style(role));
                    }
                } else {
                    self.draw_taxel(theme, upper, (column, row), buffer, place);
                }
            }
        }
        self.draw_layers(theme, &grid, buffer);
        cursor.map(|place| self.draw_cursor(theme, grid.size, buffer, place))
    }

    /// Marks the cursor's taxel on both sides, and returns the position of the cursor. A taxel of two columns shows
    /// its state in the first one; so one mark stands on its second column, the other on the second column of the
    /// taxel before it or on the ruler. A taxel of a single column has no room for marks, so the taxel itself is
    /// marked; of two that share a character, the other one is hidden.
    fn draw_cursor(
        &self,
        theme: &Theme,
        size: TaxelSize,
        buffer: &mut Buffer,
        place: Rect,
    ) -> Position {
        let before = u16::from(size == TaxelSize::Square(1));
        let at = Position::new(
            place.x.saturating_sub(before),
            place.y + (place.height - 1) / 2,
        );
        let (column, row) = self.cursor;
        // Brackets are plain, so that little is sent when the cursor moves. The terminal's own cursor is on the first
        // one.
        let style = match size {
            TaxelSize::Square(_) => theme.style(Role::Text),
            TaxelSize::Half | TaxelSize::Narrow => theme.style(Role::Cursor),
        };
        let mut mark = |x: u16, sign: Option<char>| {
            if let Some(cell) = buffer.cell_mut(Position::new(x, at.y)) {
                let sign = sign.map_or_else(|| cell.symbol().to_owned(), String::from);
                cell.reset();
                cell.set_symbol(&sign).set_style(style);
            }
        };
        match size {
            TaxelSize::Half => {
                let active = self.reading.imprint.get(column, row);
                mark(at.x, Some(theme.half_cursor(row % 2 == 1, active)));
            }
            TaxelSize::Narrow => mark(at.x, None),
            TaxelSize::Square(_) => {
                mark(at.x, Some('['));
                mark(place.right() - 1, Some(']'));
            }
        }
        at
    }

    fn draw_layers(&self, theme: &Theme, grid: &TaxelGrid, buffer: &mut Buffer) {
        let active = |column, row| self.reading.imprint.get(column, row);
        let overlay = Overlay {
            outline: self
                .source
                .filter(|_| Layers::shown(self.layers.outline, grid)),
            region: (self.reading.description(self.chosen))
                .filter(|_| Layers::shown(self.layers.rectangle, grid)),
            poses: if Layers::shown(self.poses.shown, grid) {
                self.poses.sources
            } else {
                &[]
            },
        };
        overlay.draw(grid, theme, buffer, active);
    }

    fn difference(&self, column: u8, row: u8) -> Option<Role> {
        let compared = self.compared?;
        let inside = column < compared.columns() && row < compared.rows();
        match (
            self.reading.imprint.get(column, row),
            inside && compared.get(column, row),
        ) {
            (true, false) => Some(Role::Surplus),
            (false, true) => Some(Role::Missing),
            _ => None,
        }
    }

    fn draw_taxel(
        &self,
        theme: &Theme,
        role: Role,
        (column, row): (u8, u8),
        buffer: &mut Buffer,
        place: Rect,
    ) {
        let seen = self.reading;
        let [first, second] = match self.display {
            _ if matches!(role, Role::Surplus | Role::Missing) => theme.taxel(role),
            Display::Imprint => theme.taxel(role),
            Display::Shades => theme.shade(coverage(seen, column, row)),
            Display::Percent => percent(theme, coverage(seen, column, row), place.width > 2),
        };
        let style = theme.style(role);
        // Full cells are filled; a sign or a number stands in the middle.
        let fill = if first == second && !first.is_ascii_digit() {
            first
        } else {
            ' '
        };
        let sign = ((place.width.max(2) - 2) / 2, (place.height.max(1) - 1) / 2);
        for position in place.intersection(*buffer.area()).positions() {
            let at = (position.x - place.x, position.y - place.y);
            let character = match at {
                _ if at == sign => first,
                _ if at == (sign.0 + 1, sign.1) => second,
                _ => fill,
            };
            buffer[position].set_char(character).set_style(style);
        }
    }
}

fn role_of(seen: &Reading, chosen: Option<&Region>, column: u8, row: u8) -> Role {
    let active = seen.imprint.get(column, row);
    let in_region = chosen
        .filter(|region| region.taxels().get(column, row))
        .map(Region::kind);
    match (active, in_region) {
        (true, Some(_)) => Role::Chosen,
        (true, None) => Role::Active,
        (false, Some(RegionKind::Hole)) => Role::Hole,
        (false, _) => Role::Inactive,
    }
}

/// A drawn taxel counts as covered.
fn coverage(seen: &Reading, column: u8, row: u8) -> f64 {
    let drawn = if seen.imprint.get(column, row) {
        1.0
    } else {
        0.0
    };
    seen.coverage(column, row).unwrap_or(drawn)
}

/// Returns the coverage in percent as two digits, rounded down so that 49.9 % is not shown as 50; full and empty
/// cells have their own signs.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "0 to 99"
)]
fn percent(theme: &Theme, coverage: f64, wide: bool) -> [char; 2] {
    if coverage <= 0.0 || coverage >= 1.0 {
        return theme.shade(coverage);
    }
    let percent = (coverage * 100.0) as u8;
    let units = if wide {
        char::from(b'0' + percent % 10)
    } else {
        ' '
    };
    [char::from(b'0' + percent / 10), units]
}

pub(super) fn draw(theme: &Theme, grid: &TaxelGrid, buffer: &mut Buffer, area: Rect) {
    let [above, below, left, right] = theme.more();
    let ((more_above, more_below), (more_left, more_right)) =
        (grid.rows.hidden(), grid.columns.hidden());
    let (width, height) = grid.characters();
    let before = grid.x.saturating_sub(1);
    // Numbers end before an arrow.
    let end = grid.x + width.saturating_sub(more_right.into());
    let line = write::left_of(write::row(area, 0), end);
    draw_columns(theme, grid, buffer, line);
    draw_rows(theme, grid, buffer, area);
    let marks = [
        (more_above, before, grid.y, above),
        (more_below, before, grid.y + height.max(1) - 1, below),
        (more_left, before, area.y, left),
        (more_right, grid.x + width.max(1) - 1, area.y, right),
    ];
    for (_, x, y, mark) in marks.into_iter().filter(|(more, ..)| *more) {
        let place = Rect::new(x, y, 1, 1).intersection(area);
        write::text(buffer, place, theme, &mark.to_string(), Role::Key);
    }
}

pub(in crate::tui) fn draw_columns(
    theme: &Theme,
    grid: &TaxelGrid,
    buffer: &mut Buffer,
    line: Rect,
) {
    let cell = grid.size.columns();
    let every = match cell {
        1 => 5,
        2 => 2,
        _ => 1,
    };
    for (index, column) in grid
        .columns
        .visible()
        .filter(|(_, column)| column % every == 0)
    {
        let x = grid.x + index * cell + (cell.max(2) - 2) / 2;
        let text = column.to_string();
        if x + narrow(text.len()) <= line.right() {
            let place = write::right_of(line, x);
            write::text(buffer, place, theme, &text, Role::Quiet);
        }
    }
}

pub(in crate::tui) fn draw_rows(theme: &Theme, grid: &TaxelGrid, buffer: &mut Buffer, area: Rect) {
    let rows = if grid.size == TaxelSize::Half { 2 } else { 1 };
    for (index, row) in grid.rows.visible().step_by(rows) {
        let place = grid.cell_rect(0, index);
        let y = place.y + (place.height - 1) / 2;
        let line = write::row(area, usize::from(y - area.y));
        let text = format!("{row:>2}");
        write::text(buffer, line, theme, &text, Role::Quiet);
    }
}
