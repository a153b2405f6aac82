//! The matrix with its rulers.
//!
//! ```text
//!    0   2   4   6           column ruler
//!  0 · · · · · · · ·         row ruler, then two characters for each taxel
//!  1 · · ████████· ·
//!  2 · · ██·[·]██· ·         the cursor between brackets, which hide second characters only
//! ```
//! A taxel of the described region, another active taxel, a taxel of a described hole and an inactive one differ in
//! their characters, not only in colour. Coverage is shown in five shades or in percent: two digits if a taxel has
//! room for a space beside them, otherwise the tens alone, so that numbers do not run together.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::description::{Region, RegionKind};
use taxel_core::imprint::Imprint;

use crate::tui::app::{App, Display, Reading};
use crate::tui::grid::{CellSize, Grid, Look, beside_rulers};
use crate::tui::matrix::layers;
use crate::tui::widget::{Glyphs, Role, Theme};

/// Returns the places of the taxels in an area. The window follows the cursor, or the described region if that was
/// changed last.
pub fn grid(app: &App, area: Rect) -> Grid {
    let imprint = &app.reading().imprint;
    let (cells, inner) = ((imprint.columns(), imprint.rows()), beside_rulers(area));
    let size = CellSize::fitting(cells, inner, app.halves());
    Grid::new(inner, size, cells, app.seen())
}

/// Returns the position of the cursor.
pub fn draw(app: &App, buffer: &mut Buffer, area: Rect) -> Option<Position> {
    let (theme, reading, grid) = (&app.theme, app.reading(), grid(app, area));
    let chosen = reading.region(app.chosen()).map(|(_, region)| region);
    let compared = app.recognising().and_then(|own| own.compared_with());
    let role = |column, row| role_of(reading, chosen, compared, column, row);
    grid.draw_rulers(theme, buffer);
    grid.draw(buffer, |column, row| {
        let own = role(column, row);
        let (signs, own) = match app.display {
            _ if grid.size == CellSize::Half => {
                let (sign, both) = theme.two_taxels(own, role(column, row + 1));
                ([sign; 2], both)
            }
            Display::Imprint => (theme.taxel(own), own),
            _ if matches!(own, Role::Surplus | Role::Missing) => (theme.taxel(own), own),
            Display::Shades => (theme.shade(coverage(reading, column, row)), own),
            Display::Percent => {
                let coverage = coverage(reading, column, row);
                (percent(theme, coverage, grid.size.is_large()), own)
            }
        };
        // Full cells are filled; a sign or a number stands in the middle.
        let is_full = signs[0] == signs[1] && !signs[0].is_ascii_digit();
        let fill = if is_full { signs[0] } else { ' ' };
        let style = theme.style(own);
        Look { signs, fill, style }
    });
    layers::draw(app, &grid, buffer);
    let (column, row) = app.cursor();
    let place = grid.place(column, row)?;
    Some(draw_cursor(app, grid.size, buffer, place))
}

/// Marks the cursor's taxel on both sides, and returns the position of the cursor. A taxel of two columns shows its
/// state in the first one; so one mark stands on its second column, the other on the second column of the taxel before
/// it or on the ruler. A taxel of a single column is marked itself; of two that share a character, the other one is
/// hidden.
fn draw_cursor(app: &App, size: CellSize, buffer: &mut Buffer, place: Rect) -> Position {
    let (theme, (column, row)) = (&app.theme, app.cursor());
    let before = u16::from(size == CellSize::Square(1));
    let y = place.y + (place.height - 1) / 2;
    let at = Position::new(place.x.saturating_sub(before), y);
    // Brackets are plain, so that little is sent when the cursor moves. The terminal's own cursor is on the first one.
    let is_single = size.columns() == 1;
    let role = if is_single { Role::Cursor } else { Role::Text };
    let active = app.reading().imprint.get(column, row);
    let marks = match size {
        CellSize::Half => [theme.half_cursor(row % 2 == 1, active); 2],
        CellSize::Narrow => {
            let taxel = buffer
                .cell(at)
                .and_then(|cell| cell.symbol().chars().next());
            [taxel.unwrap_or(' '); 2]
        }
        _ => ['[', ']'],
    };
    for (x, mark) in [at.x, place.right() - 1].into_iter().zip(marks) {
        if let Some(cell) = buffer.cell_mut(Position::new(x, y)) {
            cell.reset();
            cell.set_char(mark).set_style(theme.style(role));
        }
    }
    at
}

fn role_of(
    reading: &Reading,
    chosen: Option<&Region<'_>>,
    compared: Option<&Imprint>,
    column: u8,
    row: u8,
) -> Role {
    let active = reading.imprint.get(column, row);
    let other = compared.map_or(active, |other| {
        column < other.columns() && row < other.rows() && other.get(column, row)
    });
    let in_region = chosen.filter(|region| region.taxels().get(column, row));
    match (active, other, in_region.map(Region::kind)) {
        (true, false, _) => Role::Surplus,
        (false, true, _) => Role::Missing,
        (true, _, Some(_)) => Role::Chosen,
        (true, _, None) => Role::Active,
        (false, _, Some(RegionKind::Hole)) => Role::Hole,
        (false, ..) => Role::Inactive,
    }
}

/// A drawn taxel counts as covered.
fn coverage(reading: &Reading, column: u8, row: u8) -> f64 {
    let drawn = f64::from(u8::from(reading.imprint.get(column, row)));
    reading.coverage(column, row).unwrap_or(drawn)
}

/// Returns the coverage in percent as two digits, rounded down so that 49.9 % is not shown as 50; full and empty
/// cells have their own signs.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "0 to 99"
)]
fn percent(theme: &Theme, coverage: f64, wide: bool) -> Glyphs {
    if coverage <= 0.0 || coverage >= 1.0 {
        return theme.shade(coverage);
    }
    let percent = (coverage * 100.0) as u8;
    let [tens, units] = [percent / 10, percent % 10].map(|digit| char::from(b'0' + digit));
    [tens, if wide { units } else { ' ' }]
}
