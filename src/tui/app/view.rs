//! The view: reads the state and draws it, one pane per file.
//!
//! ```text
//! +--------------------------------------------------+
//! | menu: the paper's seven options                   |
//! | column ruler                |                     |
//! | row   matrix                | descriptor panel,   |
//! | ruler                       | or a form           |
//! |                             |                     |
//! | what made the imprint                             |
//! | the taxel under the cursor                        |
//! | notice, or a question                             |
//! | hints: keys that mean something now               |
//! +--------------------------------------------------+
//! ```
//! On a narrow screen matrix and panel are two pages; on a low one the lines below the matrix give way first. What
//! does not fit at all is said. Every pane takes any rectangle, an empty one too.

use crate::tui::app::{menu, status};
use crate::tui::keys::help;
use crate::tui::matrix::panel;
use crate::tui::widget::write;
use crate::tui::{explore, form, matrix, shapes};
use ratatui::Frame;

use crate::tui::app::dialog::Dialog;
use crate::tui::app::layout::{Panes, SMALLEST};
use crate::tui::app::state::{App, NarrowPage};
use crate::tui::widget::theme::Role;

/// Draws the whole screen.
pub fn view(app: &App, frame: &mut Frame<'_>) {
    let area = frame.area();
    let seen = app.reading();
    let theme = app.theme();
    let buffer = frame.buffer_mut();
    let Some(panes) = Panes::of(area, &seen.imprint) else {
        let (width, height) = SMALLEST;
        let needed = format!("{width} x {height}");
        for (index, text) in ["too small,", "need", &needed].into_iter().enumerate() {
            write::line(
                buffer,
                write::row(area, index),
                theme,
                [(text, Role::Error)],
            );
        }
        return;
    };
    menu::draw(app, buffer, panes.menu);
    let mut cursor = None;
    match (app.pane(), panes.panel) {
        (Some(Dialog::Help(help)), _) => help::draw(app, help, buffer, panes.body),
        (Some(Dialog::List(dialog)), _) => {
            cursor = shapes::view::draw(app, dialog, buffer, panes.body);
        }
        (Some(Dialog::Form(dialog)), _) => {
            matrix::view::draw(app, &seen, buffer, panes.matrix);
            cursor = form::view::draw(app, dialog, buffer, panes.form);
        }
        (Some(Dialog::Ranges(form)), _) => {
            matrix::view::draw(app, &seen, buffer, panes.matrix);
            cursor = explore::ranges::view::draw(app, form, buffer, panes.form);
        }
        (Some(Dialog::Running(running)), _) => {
            explore::running::view::draw(app, running, buffer, panes.body);
        }
        (Some(Dialog::Results(results)), _) => {
            cursor = explore::view::draw(app, results, buffer, &panes);
        }
        (_, Some(panel)) => {
            cursor = matrix::view::draw(app, &seen, buffer, panes.matrix);
            panel::draw(app, &seen, buffer, panel);
        }
        (_, None) if app.page == NarrowPage::Panel => panel::draw(app, &seen, buffer, panes.body),
        (_, None) => cursor = matrix::view::draw(app, &seen, buffer, panes.matrix),
    }
    // A name and a command are typed in the line of notices.
    cursor = status::draw(app, &seen, buffer, &panes).or(cursor);
    // The terminal's own cursor shows the place where there are neither colours nor reversed characters.
    if let Some(position) = cursor.filter(|&position| area.contains(position)) {
        frame.set_cursor_position(position);
    }
}
