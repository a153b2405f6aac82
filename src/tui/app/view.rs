//! The view: reads the state and draws it.
//!
//! ```text
//! +--------------------------------------------------+
//! | menu: the paper's options, or those of a page    |
//! | title: sensor, name                              |
//! | column ruler                |                    |
//! | row   matrix                | descriptor panel,  |   or a page over the whole width
//! | ruler                       | or a form          |
//! |                             |                    |
//! | what made the imprint                            |
//! | the taxel under the cursor                       |
//! | notice, question or prompt                       |
//! | hints: other keys that mean something now        |
//! +--------------------------------------------------+
//! ```
//! A narrow screen shows one pane, matrix or panel. Where the panel beside the matrix may cut values, it can also
//! have the whole screen. On a low screen the lines below the matrix are left out first. A screen that is too small for
//! anything says so. Every pane accepts any rectangle, also an empty one.
//!
//! A page borrows its own state, `&Theme` and `&Keymap`. What surrounds the pages reads the whole state: this file, the
//! menu, the title, the matrix, the lines at the foot.

use ratatui::Frame;
use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::tui::app::layout::{Panes, SMALLEST};
use crate::tui::app::page::{Page, Slot};
use crate::tui::app::state::{App, NarrowPane};
use crate::tui::app::title::title;
use crate::tui::app::{menu, notice, status};
use crate::tui::matrix::panel;
use crate::tui::matrix::view::MatrixView;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

pub fn view(app: &App, frame: &mut Frame<'_>) {
    if let Some(position) = draw(app, frame.buffer_mut()) {
        frame.set_cursor_position(position);
    }
}

/// Returns the position of the terminal's cursor; None if it is hidden.
pub(in crate::tui) fn draw(app: &App, buffer: &mut Buffer) -> Option<Position> {
    let area = buffer.area;
    let theme = app.theme();
    let Some(panes) = Panes::of(area, &app.reading().imprint, app.halves()) else {
        too_small(theme, buffer, area);
        return None;
    };
    menu::draw(theme, buffer, &menu::menu(app, panes.menu));
    let matrix = MatrixView::of(app);
    let covers = |slot| matches!(slot, Slot::Screen | Slot::Body);
    if !app.pane().map(Page::slot).is_some_and(covers) {
        let title = title(app);
        write::text(buffer, panes.title, theme, &title, Role::Text);
    }
    let panel = |buffer: &mut Buffer, area: Rect| panel::draw(&matrix, theme, buffer, area);
    let mut cursor = None;
    match (app.pane(), panes.panel) {
        (Some(page), beside) if page.slot() == Slot::Panel => {
            if beside.is_some() || app.narrow_pane == NarrowPane::Matrix {
                cursor = matrix.draw(theme, buffer, panes.matrix);
            }
            if beside.is_some() || app.narrow_pane == NarrowPane::Panel {
                let area = panes.area(Slot::Panel);
                write::clear(buffer, area);
                cursor = page.draw(theme, app.keymap(), buffer, area).or(cursor);
            }
        }
        (Some(page), _) => {
            if page.slot() == Slot::Form {
                matrix.draw(theme, buffer, panes.matrix);
                if let Some(area) = panes.form_panel {
                    panel(buffer, area);
                }
            }
            let area = notice::page_area(app, &panes, page);
            write::clear(buffer, area);
            cursor = page.draw(theme, app.keymap(), buffer, area);
        }
        (None, Some(beside)) => {
            cursor = matrix.draw(theme, buffer, panes.matrix);
            panel(buffer, beside);
        }
        (None, None) if app.narrow_pane == NarrowPane::Panel => panel(buffer, panes.content),
        (None, None) => cursor = matrix.draw(theme, buffer, panes.matrix),
    }
    // A name and a command are typed in the line of notices.
    cursor = status::draw(app, buffer, &panes).or(cursor);
    // The terminal's own cursor shows the place where there are neither colours nor reversed characters.
    cursor.filter(|&position| area.contains(position))
}

fn too_small(theme: &Theme, buffer: &mut Buffer, area: Rect) {
    let (width, height) = SMALLEST;
    let text = theme.text("×");
    let text = format!("the screen is too small: {width} {text} {height} at least");
    write::wrapped(buffer, area, theme, &text, Role::Error);
}
