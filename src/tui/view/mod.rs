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

pub mod write;

pub mod thumbnail;

pub mod menu;

pub mod matrix;

pub mod panel;

pub mod form;

pub mod list;

pub mod help;

pub mod explore;

pub mod status;

use ratatui::Frame;

use super::app::{App, Page};
use super::dialog::Dialog;
use super::layout::{Panes, SMALLEST};
use super::theme::Role;

/// Draws the whole screen.
pub fn view(app: &App, frame: &mut Frame<'_>) {
    let area = frame.area();
    let seen = app.seen();
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
        (Some(Dialog::List(dialog)), _) => cursor = list::draw(app, dialog, buffer, panes.body),
        (Some(Dialog::Form(dialog)), _) => {
            matrix::draw(app, &seen, buffer, panes.matrix);
            cursor = form::draw(app, dialog, buffer, panes.form);
        }
        (Some(Dialog::Ranges(form)), _) => {
            matrix::draw(app, &seen, buffer, panes.matrix);
            cursor = explore::ranges::draw(app, form, buffer, panes.form);
        }
        (Some(Dialog::Running(running)), _) => {
            explore::running::draw(app, running, buffer, panes.body);
        }
        (Some(Dialog::Results(results)), _) => {
            cursor = explore::draw(app, results, buffer, &panes);
        }
        (_, Some(panel)) => {
            cursor = matrix::draw(app, &seen, buffer, panes.matrix);
            panel::draw(app, &seen, buffer, panel);
        }
        (_, None) if app.page == Page::Panel => panel::draw(app, &seen, buffer, panes.body),
        (_, None) => cursor = matrix::draw(app, &seen, buffer, panes.matrix),
    }
    // A name and a command are typed in the line of notices.
    cursor = status::draw(app, &seen, buffer, &panes).or(cursor);
    // The terminal's own cursor shows the place where there are neither colours nor reversed characters.
    if let Some(position) = cursor.filter(|&position| area.contains(position)) {
        frame.set_cursor_position(position);
    }
}
