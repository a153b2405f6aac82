//! The matrix with its rulers.
//!
//! ```text
//!    0   2   4   6           column ruler
//!  0 · · · · · · · ·         row ruler, then two characters for each taxel
//!  1 · · ████████· ·
//!  2 · · ██[ ████· ·         the cursor is the first character of its taxel; the second still shows its state
//! ```
//! A taxel of the described region, another active taxel, one of a described hole and an inactive one differ in their
//! characters, not only in colour. A matrix that is larger than its pane scrolls with the cursor; one that is much
//! smaller is drawn larger, a whole number of times. Coverage is shown in five shades or in percent: two digits
//! where a taxel has room for a space beside them, else the tens alone, so that numbers do not run together.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::description::{Region, RegionKind};
use crate::imprint::Imprint;
use crate::source::Source;
use crate::tui::app::document::Reading;
use crate::tui::app::page::Page;
use crate::tui::app::state::{App, Display};
use crate::tui::matrix::layers::{Layers, Overlay};
use crate::tui::matrix::layout::TaxelGrid;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

/// What is drawn of the matrix.
#[derive(Clone, Copy, Debug)]
pub struct MatrixView<'a> {
    /// What is read off the document.
    pub reading: &'a Reading,
    /// The millimetres of a cell side.
    pub pitch_mm: f64,
    /// The taxel under the cursor: column, row.
    pub cursor: (u8, u8),
    /// The index of the chosen region, None for the main one.
    pub chosen: Option<usize>,
    /// How taxels are shown.
    pub display: Display,
    /// The imprint that it is compared with, None for no comparison.
    pub compared: Option<&'a Imprint>,
    /// What touches, where something does.
    pub source: Option<&'a Source>,
    /// What is shown over the taxels.
    pub layers: Layers,
}

impl<'a> MatrixView<'a> {
    /// What is drawn of the present state.
    pub fn of(app: &'a App) -> Self {
        Self {
            reading: app.reading(),
            pitch_mm: app.history.present().sensor.pitch_mm(),
            cursor: app.cursor(),
            chosen: app.chosen(),
            display: app.display,
            compared: app.pane().and_then(Page::compared_with),
            source: app.shown().source.as_ref(),
            layers: app.layers,
        }
    }

    /// Draws the matrix. Returns where the cursor is, None where it is not visible.
    pub fn draw(&self, theme: &Theme, buffer: &mut Buffer, area: Rect) -> Option<Position> {
        let seen = self.reading;
        let grid = TaxelGrid::of(area, &seen.imprint, self.cursor);
        let (cell, columns, rows) = (grid.cell, grid.columns, grid.rows);
        // A number wants four characters with the space before the next one.
        let every = match cell {
            1 => 5,
            2 => 2,
            _ => 1,
        };
        for (index, column) in columns.visible().filter(|(_, column)| column % every == 0) {
            let middle = (cell.max(2) - 2) / 2;
            let place = write::right_of(write::row(area, 0), grid.x + index * cell + middle);
            write::line(
                buffer,
                place,
                theme,
                [(column.to_string().as_str(), Role::Quiet)],
            );
        }
        let chosen = seen.region(self.chosen).map(|(_, region)| region);
        let mut cursor = None;
        for (index, row) in rows.visible() {
            let top = index * grid.lines;
            let middle = top + (grid.lines - 1) / 2;
            let line = write::row(area, usize::from(middle) + 1);
            write::line(
                buffer,
                line,
                theme,
                [(format!("{row:>2}").as_str(), Role::Quiet)],
            );
            for (index, column) in columns.visible() {
                let place = Rect {
                    x: grid.x + index * cell,
                    y: grid.y + top,
                    width: cell,
                    height: grid.lines,
                };
                let here = (column, row) == self.cursor;
                let role = self.difference(column, row);
                let role = role.unwrap_or_else(|| role_of(seen, chosen, column, row));
                self.draw_taxel(theme, role, (column, row), buffer, place);
                if here {
                    cursor = Some(Position::new(place.x, grid.y + middle));
                }
            }
        }
        self.draw_layers(theme, &grid, buffer, cursor);
        cursor
    }

    /// The layers that are shown, the cursor's character free.
    fn draw_layers(
        &self,
        theme: &Theme,
        grid: &TaxelGrid,
        buffer: &mut Buffer,
        cursor: Option<Position>,
    ) {
        let active = |column, row| self.reading.imprint.get(column, row);
        let overlay = Overlay {
            outline: self
                .source
                .filter(|_| Layers::shown(self.layers.outline, grid)),
            region: (self.reading.description(self.chosen))
                .filter(|_| Layers::shown(self.layers.rectangle, grid)),
        };
        overlay.draw(grid, theme, buffer, active, cursor);
    }

    /// How a taxel differs from the imprint that the matrix is compared with; None if it does not.
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

    /// A taxel: two characters, or more of the same where it is drawn larger. The cursor stands on its left, on a large one
    /// on its right, too; what is between still tells the state: a blank is an inactive taxel.
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
        let here = (column, row) == self.cursor;
        let style = theme.style(role);
        // Full cells are filled, a sign or a number stands in the middle.
        let fill = if first == second && !first.is_ascii_digit() {
            first
        } else {
            ' '
        };
        let sign = ((place.width.max(2) - 2) / 2, (place.height.max(1) - 1) / 2);
        for position in place.intersection(*buffer.area()).positions() {
            let (x, y) = (position.x - place.x, position.y - place.y);
            let last = place.width - 1;
            let (character, style) = match x {
                0 if here && y == sign.1 && last == 0 => (first, theme.style(Role::Cursor)),
                0 if here && y == sign.1 => ('[', theme.style(Role::Cursor)),
                // Of two columns the second one still tells the state.
                _ if here && y == sign.1 && x == last && last > 1 => {
                    (']', theme.style(Role::Cursor))
                }
                _ if (x, y) == sign => (first, style),
                _ if (x, y) == (sign.0 + 1, sign.1) => (second, style),
                _ => (fill, style),
            };
            buffer[position].set_char(character).set_style(style);
        }
    }
}

/// What a taxel is to the region that is described.
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

/// Two digits, cut rather than rounded so that 49.9 % is not shown as 50; full and empty cells by their signs.
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
