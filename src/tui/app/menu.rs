//! The first line: the paper's seven options, and help.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::tui::app::layout::menu;
use crate::tui::app::state::App;
use crate::tui::widget::theme::Role;
use crate::tui::widget::write;

/// Draws the options: key and name, from the table of keys.
pub fn draw(app: &App, buffer: &mut Buffer, area: Rect) {
    for item in menu(area, app.keymap()) {
        let label = item.binding.short_labels();
        let pieces = if item.with_key {
            [
                (label.as_str(), Role::Key),
                (" ", Role::Text),
                (item.name, Role::Text),
            ]
        } else if label.is_empty() {
            [(item.name, Role::Text), ("", Role::Text), ("", Role::Text)]
        } else {
            // The key is the first letter.
            let (first, rest) = item.name.split_at(1);
            [(first, Role::Key), (rest, Role::Text), ("", Role::Text)]
        };
        write::line(buffer, item.area, app.theme(), pieces);
    }
}
